#pragma once

#include <algorithm>
#include <vector>

#include "core/dbm/interval.h"
#include "core/geom/mesh.h"

namespace test_support {

/// The intersections of a line with a mesh by an independent method: the line is actually shifted,
/// by 2^-30 and 2^-50, and tested against every triangle with quadruple precision. The depth error
/// is the slope times 2^-30.
inline core::IntervalList line_oracle(const core::Mesh& mesh, int axis, double u, double v) {
    using Quad = __float128;
    const Quad p_u = Quad(u) + Quad(0x1p-30), p_v = Quad(v) + Quad(0x1p-70);
    const int at_u = (axis + 1) % 3, at_v = (axis + 2) % 3;
    std::vector<std::pair<double, int>> crossings;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const core::Triangle t = mesh.triangle(i);
        const auto area = [&](const core::Vec3& a, const core::Vec3& b) {
            return (Quad(a[at_u]) - p_u) * (Quad(b[at_v]) - p_v)
                   - (Quad(a[at_v]) - p_v) * (Quad(b[at_u]) - p_u);
        };
        const Quad a = area(t.b, t.c), b = area(t.c, t.a), c = area(t.a, t.b);
        const bool left = a > 0 && b > 0 && c > 0, right = a < 0 && b < 0 && c < 0;
        if (!left && !right) continue;
        const Quad depth = (a * t.a[axis] + b * t.b[axis] + c * t.c[axis]) / (a + b + c);
        crossings.emplace_back(static_cast<double>(depth), left ? 1 : 0); // entering sorts first
    }
    std::sort(crossings.begin(), crossings.end());
    core::IntervalList matter;
    int winding = 0;
    for (size_t i = 0; i + 1 < crossings.size(); ++i) {
        winding += crossings[i].second == 0 ? 1 : -1;
        if (winding >= 1) matter.add({crossings[i].first, crossings[i + 1].first});
    }
    return matter;
}

} // namespace test_support
