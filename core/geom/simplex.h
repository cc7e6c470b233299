#pragma once

#include <array>

#include "core/base/vec.h"

namespace core {

/// One to four points of the Minkowski difference A - B, with where they came from.
struct Simplex {
    struct Vertex {
        Vec3 difference; // on_a - on_b
        Vec3 on_a, on_b;
        double time_a;
        double weight; // barycentric coordinate of the point nearest to the origin
    };
    std::array<Vertex, 4> vertices;
    int count = 0;
};

/// Keeps the vertices whose hull holds the point nearest to the origin and sets their weights.
///
/// Result: that point; the origin itself when the simplex is a tetrahedron round it.
Vec3 reduce_to_nearest(Simplex& simplex);

} // namespace core
