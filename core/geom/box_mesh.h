#pragma once

#include "core/geom/mesh.h"

namespace core {

/// The closed surface of a box, its faces looking outwards.
Mesh mesh_of(const Aabb& box);

} // namespace core
