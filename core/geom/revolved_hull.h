#pragma once

#include "core/geom/mesh.h"
#include "core/geom/profile.h"

namespace core {

/// The smallest body of revolution about Z that holds a mesh, as cones one upon the other from its
/// lowest point to its highest.
///
/// Result: nothing of the mesh stands out of it. It is wider than need be by at most `tolerance`
/// and
///         what the chord of an edge's way round the axis adds over a 400th of the height; where
///         the vertices have more than 400 heights also by what flanks widen over some of them.
/// Cost:   triangles times heights, at most 800 of them.
RevolvedProfile revolved_hull(const Mesh& mesh, double tolerance);

} // namespace core
