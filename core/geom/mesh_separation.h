#pragma once

#include "core/geom/triangle_bvh.h"

namespace core {

/// The least distance between the surfaces of two meshes while B moves straight from its pose by
/// `sweep_of_b`.
///
/// Frame:  that of A.
/// Result: both bounds hold, rounding included; they are goal.tolerance and twice the rounding
///         apart at most (some 1e-10 mm within 1 m). Surfaces nearer than 1e-10 mm
///         touch: 0. `upper` is infinite when nothing is found within `goal.limit`, and `lower` at
///         most the limit. The inside of the meshes does not count.
/// Cost:   some thousand pairs of boxes and some ten pairs of triangles; ends at once where the
///         surfaces meet. A sweep costs more, for its triangles are compared by GJK.
Separation separation(const TriangleBvh& a, const TriangleBvh& b, const Transform& a_from_b,
                      const Vec3& sweep_of_b, const SeparationGoal& goal = {});

} // namespace core
