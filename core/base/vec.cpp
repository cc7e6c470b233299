#include "core/base/vec.h"

#include "core/base/math.h"
#include "core/base/units.h"

namespace core {
namespace {

double degrees_of(double sine, double cosine) {
    return angle_of(sine, cosine) * degrees_per_radian;
}

/// The same angle in -180 < angle <= 180, without -0.
double wrapped_deg(double angle_deg) {
    const double angle = std::remainder(angle_deg, 360.0);
    return angle == -180.0 ? 180.0 : angle + 0.0;
}

double rounded(double value, double steps) { return core::round(value * steps) / steps; }

/// The angles with the fewest decimals that give the rotation.
Vec3 with_few_decimals(const Vec3& angles_deg, const Mat3& rotation) {
    double steps = 1.0;
    for (int decimals = 0; decimals <= 10; ++decimals, steps *= 10.0) {
        Vec3 round;
        for (int k = 0; k < 3; ++k) round[k] = wrapped_deg(rounded(angles_deg[k], steps));
        const Mat3 off = rotation_xyz_deg(round) - rotation;
        double most = 0.0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(off[i][j]));
        if (most <= 1e-10) return round;
    }
    return angles_deg;
}

int zeros_of(const Vec3& v) { return (v.x == 0.0) + (v.y == 0.0) + (v.z == 0.0); }

} // namespace

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

Vec3 angles_xyz_deg(const Mat3& rotation) {
    const auto row = [&](int i, int j) { return rotation[j][i]; };
    // Close to Y = 90 only the sum or the difference of X and Z counts: X is 0 there.
    const bool locked = core::hypot(row(0, 0), row(1, 0)) < 1e-9;
    const double z = locked ? degrees_of(-row(0, 1), row(1, 1)) : degrees_of(row(1, 0), row(0, 0));
    // Without the rotation about Z that was chosen, the rest is one about X and then Y.
    const auto [s, c] = sin_cos_deg(z);
    const double y = degrees_of(-row(2, 0), c * row(0, 0) + s * row(1, 0));
    const double x = degrees_of(s * row(0, 2) - c * row(1, 2), c * row(1, 1) - s * row(0, 1));
    const Vec3 first = with_few_decimals({x, y, z}, rotation);
    const Vec3 second = with_few_decimals({x + 180.0, 180.0 - y, z + 180.0}, rotation);
    return zeros_of(second) > zeros_of(first) ? second : first;
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
