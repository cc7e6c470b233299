#pragma once

#include "core/dbm/solid.h"
#include "core/distance/body_distance.h"
#include "core/geom/mesh_features.h"

namespace core {

/// What a machinist can point at on a body of a set-up: exact for boxes, cylinders and cones, found
/// in the triangles of a mesh.
///
/// Frame:   the body's.
/// Cost:    that of features_of(Mesh); keep the result.
MeshFeatures features_of(const ExactBody& body);

/// The same for a raw stock, without its tolerance and its play.
MeshFeatures features_of(const Solid& solid);

} // namespace core
