#include <random>

#include <gtest/gtest.h>

#include "core/dbm/cutter.h"
#include "tests/support/tilted_sweep.h"

namespace core {
namespace {

using test_support::argmin_convex;
using test_support::outside_tilted_sweep;
using test_support::random_rotation;

struct Case {
    ElementSweep sweep;
    Mat3 orientation;
    int axis;
    double u, v;

    double outside(double along) const {
        Vec3 p;
        p[axis] = along;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v;
        return outside_tilted_sweep(sweep.element, orientation, sweep.from, sweep.to, p);
    }
    Interval reach() const {
        const double size =
            glm::length(bounds(sweep.element).max) + glm::length(bounds(sweep.element).min) + 1.0;
        return {std::min(sweep.from[axis], sweep.to[axis]) - size,
                std::max(sweep.from[axis], sweep.to[axis]) + size};
    }
};

struct Seen {
    int hit = 0, miss = 0, graze = 0;
};

/// The ends of the interval must be in the swept volume. Points 1e-6 beyond must not be deeper in
/// it than rounding allows for a line along a surface. Without an interval, the line must miss the
/// volume.
void expect_true_interval(const Case& c, Seen& seen) {
    const auto found = tilted_line_interval(c.sweep, c.orientation, c.axis, c.u, c.v);
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
    EXPECT_GE(outside(found->lower - 1e-6), -1e-8);
    EXPECT_GE(outside(found->upper + 1e-6), -1e-8);
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
    case 7: // a needle
        return {0.0, 0.001, 20.0, 0.5, 0.0};
    default:
        return {s, r, s, r, 0.3 * s};
    }
}
constexpr int element_kinds = 9;

Mat3 orientation_of(int kind, std::mt19937& rng) {
    std::uniform_real_distribution<double> angle(-180.0, 180.0);
    switch (kind) {
    case 0:
        return random_rotation(rng);
    case 1: // along an axis, or upside down
        return rotation_xyz_deg({90.0 * static_cast<double>(rng() % 4), 90.0 * (rng() % 4), 0.0});
    case 2: // about one axis, as is common on machines with two rotary axes
        return rotation_xyz_deg({angle(rng), 0.0, 0.0});
    case 3:
        return rotation_xyz_deg({0.0, 45.0, 0.0});
    case 4: // almost upright
        return rotation_xyz_deg({1e-7 * angle(rng), 1e-10 * angle(rng), 0.0});
    default:
        return Mat3(1.0);
    }
}
constexpr int orientation_kinds = 6;

/// A move: none, along the tool axis, along the line, in the end face, along the 45 degree flank,
/// almost along any of these, or in any direction.
Vec3 move_of(int kind, const Mat3& orientation, int axis, std::mt19937& rng) {
    std::uniform_real_distribution<double> step(-12.0, 12.0);
    Vec3 line(0.0);
    line[axis] = 1.0;
    switch (kind) {
    case 0:
        return Vec3(0.0);
    case 1:
        return step(rng) * orientation[2];
    case 2:
        return step(rng) * line;
    case 3:
        return step(rng) * orientation[0] + step(rng) * orientation[1];
    case 4:
        return step(rng) * (orientation[0] + orientation[2]);
    case 5:
        return step(rng) * (orientation[2] + 1e-9 * step(rng) * orientation[0]);
    case 6:
        return step(rng) * (line + 1e-9 * step(rng) * orientation[1]);
    case 7:
        return 1e-9 * Vec3(step(rng), step(rng), step(rng));
    case 8:
        return 20.0 * Vec3(step(rng), step(rng), step(rng));
    default:
        return {step(rng), step(rng), step(rng)};
    }
}
constexpr int move_kinds = 10;

class EveryTiltedElement : public ::testing::TestWithParam<int> {
protected:
    template <typename Act>
    void run(int repeats, const Act& act) {
        std::mt19937 rng(400 + GetParam());
        for (int turn = 0; turn < orientation_kinds; ++turn)
            for (int move = 0; move < move_kinds; ++move)
                for (int axis = 0; axis < 3; ++axis)
                    for (int i = 0; i < repeats; ++i) {
                        std::uniform_real_distribution<double> position(-10.0, 10.0);
                        Case c{{element_of(GetParam(), rng), {}, {}},
                               orientation_of(turn, rng),
                               axis,
                               0.0,
                               0.0};
                        if (i % 3) c.sweep.from = {position(rng), position(rng), position(rng)};
                        if (i % 8 == 1) c.sweep.from += Vec3(1900.0, -1500.0, 700.0);
                        c.sweep.to = c.sweep.from + move_of(move, c.orientation, axis, rng);
                        aim(c, rng);
                        act(c);
                        ASSERT_FALSE(HasFailure()) << "turn " << turn << " move " << move
                                                   << " axis " << axis << " repeat " << i;
                    }
    }

private:
    /// Makes the line pass near the body at some moment; every fourth time through its axis or rim.
    static void aim(Case& c, std::mt19937& rng) {
        std::uniform_real_distribution<double> fraction(-1.02, 1.02);
        const ProfileElement& e = c.sweep.element;
        const double r = std::max(e.r0, e.r1) + e.margin;
        const bool special = rng() % 4 == 0;
        Vec3 q(r * fraction(rng), r * fraction(rng), 0.0);
        q.z = e.z0 - e.margin + 0.5 * (1.0 + fraction(rng)) * (e.z1 - e.z0 + 2.0 * e.margin);
        if (special) {
            const double radii[] = {0.0, e.r0, e.r1, e.r0 + e.margin};
            q = {radii[rng() % 4], 0.0, rng() % 2 ? e.z0 : e.z1};
        }
        const double t = special ? 0.5 * static_cast<double>(rng() % 3) : fraction(rng);
        const Vec3 p = c.orientation * q + c.sweep.from + t * (c.sweep.to - c.sweep.from);
        c.u = p[(c.axis + 1) % 3];
        c.v = p[(c.axis + 2) % 3];
    }
};

TEST_P(EveryTiltedElement, GivesTheLineInTheSweptVolume) {
    Seen seen;
    run(30, [&](const Case& c) { expect_true_interval(c, seen); });
    EXPECT_GT(seen.hit, 1500);
    EXPECT_GT(seen.miss, 150);
    EXPECT_GT(seen.graze, 10);
}

TEST_P(EveryTiltedElement, AgreesUprightWithTheWayForUprightTools) {
    int both = 0;
    run(12, [&](Case c) {
        c.orientation = Mat3(1.0);
        const auto tilted = tilted_line_interval(c.sweep, c.orientation, c.axis, c.u, c.v);
        const auto upright = line_interval(c.sweep, c.axis, c.u, c.v);
        if (!tilted || !upright) {
            const auto& found = tilted ? tilted : upright;
            EXPECT_GE(found ? c.outside(0.5 * (found->lower + found->upper)) : 0.0, -1e-8);
            return;
        }
        // What only one of the two has runs along the surface.
        for (const auto& [one, other] :
             {std::pair(tilted->lower, upright->lower), std::pair(tilted->upper, upright->upper)})
            if (std::abs(one - other) > 1e-9) {
                EXPECT_GE(c.outside(0.5 * (one + other)), -1e-8);
            }
        ++both;
    });
    EXPECT_GT(both, 300);
}

INSTANTIATE_TEST_SUITE_P(TiltedLine, EveryTiltedElement, ::testing::Range(0, element_kinds));

} // namespace
} // namespace core
