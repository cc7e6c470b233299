#include <random>

#include <gtest/gtest.h>

#include "core/dbm/cutter.h"
#include "tests/support/tilted_sweep.h"

namespace core {
namespace {

using test_support::argmin_convex;
using test_support::outside_tilted_sweep;
using test_support::random_rotation;

/// A moving cone, and a line that passes a point of its surface or axis at a tiny distance.
struct NearMiss {
    ElementSweep sweep;
    Mat3 orientation = Mat3(1.0);
    int axis = 0;
    double u = 0.0, v = 0.0;

    double outside(double along) const {
        Vec3 p;
        p[axis] = along;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v;
        return outside_tilted_sweep(sweep.element, orientation, sweep.from, sweep.to, p);
    }
    /// Depth of the line in the cone, at most.
    double depth() const {
        const Aabb box = bounds(sweep.element);
        const double size = glm::length(box.max) + glm::length(box.min) + 1.0;
        const double low = std::min(sweep.from[axis], sweep.to[axis]) - size;
        const double high = std::max(sweep.from[axis], sweep.to[axis]) + size;
        const auto f = [&](double along) { return outside(along); };
        return -f(argmin_convex(f, low, high));
    }
};

/// 0, or 1e-9 .. 1e-3 to either side.
double next_to_nothing(std::mt19937& rng) {
    const double size = std::pow(10.0, -3.0 - static_cast<double>(rng() % 7));
    return static_cast<double>(static_cast<int>(rng() % 3) - 1) * size;
}

ProfileElement cone_of(std::mt19937& rng) {
    std::uniform_real_distribution<double> size(0.2, 8.0);
    const double r = size(rng), height = size(rng);
    switch (rng() % 6) {
    case 0:
        return {0.0, 0.0, height, r, 0.0};
    case 1: // tip up
        return {0.0, r, height, 0.0, 0.0};
    case 2:
        return {0.0, r, height, r + size(rng), 0.0};
    case 3: // 45 degrees
        return {0.0, 0.0, height, height, 0.0};
    case 4:
        return {1.0, r + size(rng), 1.0 + height, r, 0.0};
    default: // a needle
        return {0.0, 0.001, 20.0, 0.5, 0.0};
    }
}

Mat3 orientation_of(std::mt19937& rng) {
    const auto quarter = [&] { return 90.0 * static_cast<double>(rng() % 4); };
    switch (rng() % 4) {
    case 0:
        return random_rotation(rng);
    case 1:
        return rotation_xyz_deg({quarter(), quarter(), 0.0});
    case 2:
        return rotation_xyz_deg({50.0 * next_to_nothing(rng), 50.0 * next_to_nothing(rng), 0.0});
    default:
        return Mat3(1.0);
    }
}

/// A move: none, along the tool axis, along the line, along the flank, across, or in any direction.
Vec3 move_of(const ProfileElement& e, const Mat3& tool, int axis, std::mt19937& rng) {
    std::uniform_real_distribution<double> step(-12.0, 12.0);
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    Vec3 line(0.0);
    line[axis] = 1.0;
    switch (rng() % 7) {
    case 0:
        return Vec3(0.0);
    case 1:
        return step(rng) * (tool[2] + next_to_nothing(rng) * tool[0]);
    case 2:
        return step(rng) * (line + next_to_nothing(rng) * tool[1]);
    case 3:
        return step(rng) * (slope * tool[0] + tool[2]);
    case 4:
        return step(rng) * (slope * tool[0] + tool[2] + next_to_nothing(rng) * (tool[1] + tool[2]));
    case 5:
        return step(rng) * tool[0] + step(rng) * tool[1];
    default:
        return {step(rng), step(rng), step(rng)};
    }
}

/// A point on the axis, on the flank, on a rim or at the end of the axis.
Vec3 aim_of(const ProfileElement& e, std::mt19937& rng) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    const double s = fraction(rng);
    const Vec3 positions[] = {{0.0, 0.0, e.z0},
                              {0.0, 0.0, e.z1},
                              {0.0, 0.0, e.z0 + s * (e.z1 - e.z0)},
                              {e.r0 + s * (e.r1 - e.r0), 0.0, e.z0 + s * (e.z1 - e.z0)},
                              {e.r0, 0.0, e.z0},
                              {e.r1, 0.0, e.z1}};
    return positions[rng() % 6]
           + Vec3(next_to_nothing(rng), next_to_nothing(rng), next_to_nothing(rng));
}

NearMiss near_miss(std::mt19937& rng) {
    std::uniform_real_distribution<double> position(-10.0, 10.0);
    NearMiss c;
    c.sweep.element = cone_of(rng);
    c.orientation = orientation_of(rng);
    c.axis = static_cast<int>(rng() % 3);
    if (rng() % 3) c.sweep.from = {position(rng), position(rng), position(rng)};
    const Vec3 by = move_of(c.sweep.element, c.orientation, c.axis, rng);
    c.sweep.to = c.sweep.from + by;
    const Vec3 p = c.orientation * aim_of(c.sweep.element, rng) + c.sweep.from
                   + 0.25 * static_cast<double>(rng() % 5) * by;
    c.u = p[(c.axis + 1) % 3];
    c.v = p[(c.axis + 2) % 3];
    return c;
}

struct Seen {
    int hit = 0, graze = 0;
};

void expect_true_interval(const NearMiss& c, const std::optional<Interval>& found, Seen& seen) {
    const double depth = c.depth();
    ++(depth > 1e-3 ? seen.hit : seen.graze);
    if (!found) {
        EXPECT_LE(depth, 1e-7);
        return;
    }
    // The interval is never longer than the volume; where the line runs along a surface it may end
    // early.
    EXPECT_LE(c.outside(found->lower), 1e-9);
    EXPECT_LE(c.outside(found->upper), 1e-9);
    EXPECT_GE(c.outside(found->lower - 1e-6), -1e-7);
    EXPECT_GE(c.outside(found->upper + 1e-6), -1e-7);
}

TEST(ConeLine, IsTrueNextToTipAxisAndFlankForAnyOrientation) {
    std::mt19937 rng(811);
    Seen seen;
    for (int i = 0; i < 8000 && !::testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE(i);
        const NearMiss c = near_miss(rng);
        expect_true_interval(c, tilted_line_interval(c.sweep, c.orientation, c.axis, c.u, c.v),
                             seen);
    }
    EXPECT_GT(seen.hit, 4000);
    EXPECT_GT(seen.graze, 400);
}

TEST(ConeLine, IsTrueNextToTipAxisAndFlankOfAnUprightTool) {
    std::mt19937 rng(812);
    Seen seen;
    for (int i = 0; i < 8000 && !::testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE(i);
        NearMiss c = near_miss(rng);
        if (!is_upright(c.orientation)) continue;
        expect_true_interval(c, line_interval(c.sweep, c.axis, c.u, c.v), seen);
    }
    EXPECT_GT(seen.hit, 800);
    EXPECT_GT(seen.graze, 80);
}

} // namespace
} // namespace core
