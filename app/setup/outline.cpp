#include "app/setup/outline.h"

#include <fmt/format.h>

namespace app {

core::Result<std::vector<core::ConeStep>>
cones_of_outline(const std::vector<std::vector<double>>& points) {
    using core::ErrorCode;
    if (points.size() < 2)
        return core::fail(ErrorCode::invalid_value, "needs at least two [r, z] points");
    if (points[0][1] != 0.0)
        return core::fail(ErrorCode::invalid_value,
                          "must begin at z = 0, the lower end of this part");
    std::vector<core::ConeStep> cones;
    for (size_t i = 0; i < points.size(); ++i) {
        const double r = points[i][0], z = points[i][1];
        if (r < 0.0) return core::fail(ErrorCode::invalid_value, "has an r below 0");
        if (i == 0) continue;
        const double r_below = points[i - 1][0], z_below = points[i - 1][1];
        if (z < z_below)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("must go up: z falls from {:g} to {:g}", z_below, z));
        if (z == z_below) continue;
        if (r == 0.0 && r_below == 0.0)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("encloses nothing from z = {:g} to {:g}", z_below, z));
        cones.push_back({2.0 * r_below, 2.0 * r, z - z_below});
    }
    if (cones.empty()) return core::fail(ErrorCode::invalid_value, "has no height");
    return cones;
}

std::vector<core::ConeStep> cones_of_profile(const core::RevolvedProfile& profile) {
    std::vector<core::ConeStep> cones;
    for (const core::ProfileElement& e : profile.elements)
        cones.push_back({2.0 * e.r0, 2.0 * e.r1, e.z1 - e.z0});
    return cones;
}

} // namespace app
