#include <random>

#include <gtest/gtest.h>

#include "core/dbm/cutter.h"
#include "tests/support/profile_oracle.h"

namespace core {
namespace {

using test_support::argmin_convex;
using test_support::outside_sweep;

/// A sweep and a line, and the distance of points of the line from the swept volume.
struct Case {
    ElementSweep sweep;
    int axis;
    double u, v;

    Vec3 point(double along) const {
        Vec3 p;
        p[axis] = along;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v;
        return p;
    }
    double outside(double along) const {
        return outside_sweep(sweep.element, sweep.from, sweep.to, point(along));
    }
    Interval reach() const {
        const Aabb box = bounds(sweep.element);
        return {std::min(sweep.from[axis], sweep.to[axis]) + box.min[axis] - 1.0,
                std::max(sweep.from[axis], sweep.to[axis]) + box.max[axis] + 1.0};
    }
};

struct Seen {
    int hit = 0, miss = 0, graze = 0;
};

/// The ends of the interval must be in the swept volume and points 1e-6 beyond must not; if there
/// is no interval, the line must miss the volume.
void expect_true_interval(const Case& c, Seen& seen) {
    const auto found = line_interval(c.sweep, c.axis, c.u, c.v);
    const auto outside = [&](double along) { return c.outside(along); };
    if (!found) {
        const Interval reach = c.reach();
        const double deepest = outside(argmin_convex(outside, reach.lower, reach.upper, 60));
        EXPECT_GE(deepest, -1e-9);
        ++(deepest < 1e-6 ? seen.graze : seen.miss);
        return;
    }
    ASSERT_LT(found->lower, found->upper);
    EXPECT_LE(outside(found->lower), 1e-9);
    EXPECT_LE(outside(found->upper), 1e-9);
    EXPECT_GE(outside(found->lower - 1e-6), -1e-9);
    EXPECT_GE(outside(found->upper + 1e-6), -1e-9);
    ++(outside(0.5 * (found->lower + found->upper)) > -1e-6 ? seen.graze : seen.hit);
}

ProfileElement element_of(int kind, std::mt19937& rng) {
    std::uniform_real_distribution<double> size(0.2, 8.0);
    const double r = size(rng), s = size(rng), z = size(rng) - 4.0;
    switch (kind) {
    case 0:
        return {z, r, z + s, r, 0.0};
    case 1:
        return {z, r, z + s, r + size(rng), 0.0};
    case 2:
        return {z, r + size(rng), z + s, r, 0.0};
    case 3:
        return {0.0, 0.0, s, r, 0.0};
    case 4:
        return {z, r, z + s, 0.0, 0.0};
    case 5:
        return {r, 0.0, r, 0.0, r};
    case 6: // 45 degrees, with moves along its own flank
        return {0.0, 1.0, 4.0, 5.0, 0.0};
    default:
        return {s, r, s, r, 0.3 * s};
    }
}
constexpr int element_kinds = 8;

Vec3 move_of(int kind, std::mt19937& rng) {
    std::uniform_real_distribution<double> step(-12.0, 12.0);
    switch (kind) {
    case 0:
        return Vec3(0.0);
    case 1:
        return {0.0, 0.0, step(rng)};
    case 2:
        return {step(rng), 0.0, 0.0};
    case 3:
        return {0.0, step(rng), 0.0};
    case 4:
        return {step(rng), step(rng), 0.0};
    case 5: // 45 degrees in a coordinate plane
        return [](double s) { return Vec3(0.0, s, -s); }(step(rng));
    case 6:
        return [](double s) { return Vec3(s, 0.0, s); }(step(rng));
    case 7: // almost no motion along one axis
        return {step(rng), 1e-9 * step(rng), 1e-12 * step(rng)};
    case 8:
        return 20.0 * Vec3(step(rng), step(rng), step(rng));
    default:
        return {step(rng), step(rng), step(rng)};
    }
}
constexpr int move_kinds = 10;

class EveryElementMoveAndAxis : public ::testing::TestWithParam<int> {
protected:
    template <typename Act>
    void run(int repeats, const Act& act) {
        std::mt19937 rng(100 + GetParam());
        for (int move = 0; move < move_kinds; ++move)
            for (int axis = 0; axis < 3; ++axis)
                for (int i = 0; i < repeats; ++i) {
                    std::uniform_real_distribution<double> position(-10.0, 10.0);
                    Case c{{element_of(GetParam(), rng), {}, {}}, axis, 0.0, 0.0};
                    if (i % 3) c.sweep.from = {position(rng), position(rng), position(rng)};
                    if (i % 8 == 1) c.sweep.from += Vec3(1900.0, -1500.0, 700.0);
                    c.sweep.to = c.sweep.from + move_of(move, rng);
                    act(c, rng);
                    ASSERT_FALSE(HasFailure())
                        << "move " << move << " axis " << axis << " repeat " << i;
                }
    }
};

TEST_P(EveryElementMoveAndAxis, GivesTheLineInTheSweptVolume) {
    Seen seen;
    run(40, [&](Case& c, std::mt19937& rng) {
        const Aabb body = bounds(c.sweep.element);
        std::uniform_real_distribution<double> fraction(-0.05, 1.05);
        const auto somewhere = [&](int axis) {
            const double low = std::min(c.sweep.from[axis], c.sweep.to[axis]) + body.min[axis];
            const double high = std::max(c.sweep.from[axis], c.sweep.to[axis]) + body.max[axis];
            return low + fraction(rng) * (high - low);
        };
        c.u = somewhere((c.axis + 1) % 3);
        c.v = somewhere((c.axis + 2) % 3);
        expect_true_interval(c, seen);
    });
    EXPECT_GT(seen.hit, 300);
    EXPECT_GT(seen.miss, 40);
}

TEST_P(EveryElementMoveAndAxis, HoldsForLinesThroughTheAxisAndOnTheRims) {
    Seen seen;
    run(40, [&](Case& c, std::mt19937& rng) {
        const ProfileElement& e = c.sweep.element;
        const double radii[] = {0.0, e.r0, e.r1, e.r0 + e.margin, e.margin};
        const double heights[] = {e.z0, e.z1, e.z0 - e.margin, e.z1 + e.margin,
                                  0.5 * (e.z0 + e.z1)};
        const auto special = [&](int axis) {
            const double from = c.sweep.from[axis], to = c.sweep.to[axis];
            const double base = rng() % 3 == 0 ? 0.5 * (from + to) : rng() % 2 ? from : to;
            return base
                   + (axis == 2 ? heights[rng() % 5] : radii[rng() % 5] * (rng() % 2 ? 1 : -1));
        };
        c.u = special((c.axis + 1) % 3);
        c.v = special((c.axis + 2) % 3);
        expect_true_interval(c, seen);
    });
    EXPECT_GT(seen.hit, 200);
    EXPECT_GT(seen.graze, 20);
}

INSTANTIATE_TEST_SUITE_P(LineInterval, EveryElementMoveAndAxis, ::testing::Range(0, element_kinds));

TEST(LineInterval, FollowsAChamferDownItsOwnFlank) {
    // The square of the chord is linear here, so there is no quadratic to solve.
    const ElementSweep sweep{{0.0, 1.0, 4.0, 5.0, 0.0}, {0, 0, 0}, {3, 10, -10}};
    Seen seen;
    for (double y = -1.0; y < 16.0; y += 0.37)
        for (double z = -10.0; z < 4.5; z += 0.41) expect_true_interval({sweep, 0, y, z}, seen);
    EXPECT_GT(seen.hit, 200);
}

TEST(LineInterval, FindsARoundedCornerThatRampsAcrossTheLine) {
    // The line is at the height of the corner only while the disc is next to it.
    const ElementSweep sweep{{1.0, 5.0, 1.0, 5.0, 1.0}, {0, -40, 30}, {0, 40, -30}};
    Seen seen;
    for (double y = -12.0; y < 12.0; y += 0.3)
        for (double z = -8.0; z < 10.0; z += 0.7) expect_true_interval({sweep, 0, z, y}, seen);
    EXPECT_GT(seen.hit, 10);
}

} // namespace
} // namespace core
