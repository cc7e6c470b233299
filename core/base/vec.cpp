#include "core/base/vec.h"

#include "core/base/units.h"

namespace core {

Mat3 rotation_xyz_deg(const Vec3& angles_deg) {
    const auto [sx, cx] = sin_cos_deg(angles_deg.x);
    const auto [sy, cy] = sin_cos_deg(angles_deg.y);
    const auto [sz, cz] = sin_cos_deg(angles_deg.z);
    // glm matrices are given column by column.
    const Mat3 about_x(1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx);
    const Mat3 about_y(cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy);
    const Mat3 about_z(cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0);
    return about_z * about_y * about_x;
}

double distortion(const Mat3& rotation) {
    const Mat3 product = glm::transpose(rotation) * rotation;
    double most = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const double off = std::abs(product[i][j] - (i == j));
            if (std::isnan(off)) return off;
            most = std::max(most, off);
        }
    return most;
}

} // namespace core
