#include <random>

#include <gtest/gtest.h>

#include "core/dbm/solid.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "core/motion/path.h"
#include "tests/support/meshes.h"
#include "tests/support/random_setup.h"

namespace core {
namespace {

using test_support::Dice;

Vec3 vector_within(Dice& dice, double most) { return dice.within({Vec3(-most), Vec3(most)}); }

/// A point of the segment.
Vec3 some_of(Dice& dice, const Play& play) {
    return play.from + dice.fraction() * (play.to - play.from);
}

Solid random_solid(Dice& dice) {
    const Vec3 corner = vector_within(dice, 5.0);
    switch (dice.index(3)) {
    case 0:
        return {SolidBox{{corner, corner + Vec3(8, 6, 4)}}};
    case 1:
        return {SolidCylinder{corner, 3.0, 5.0, static_cast<int>(dice.index(3))}};
    default:
        return {solid_mesh(test_support::moved(test_support::torus_mesh(3.0, 1.0, 12, 8),
                                               dice.turned(corner, 60.0)))};
    }
}

TEST(Play, ColumnsHoldEveryDisplacedSolid) {
    Dice dice{std::mt19937(5)};
    size_t met = 0;
    for (int i = 0; i < 2000; ++i) {
        Solid solid = random_solid(dice);
        solid.play = {vector_within(dice, 3.0), vector_within(dice, 3.0)};
        const Vec3 at = dice.within(outer_bounds(solid)), by = some_of(dice, solid.play);
        const Vec3 nominal = at - by;
        const IntervalList line = line_of(solid, 2, nominal.x, nominal.y);
        const IntervalList column =
            column_of(solid, {at.x - 0.1, at.x + 0.2, at.y - 0.3, at.y + 0.1});
        for (const Interval& matter : line) {
            ++met;
            for (const double z : {matter.lower, 0.5 * (matter.lower + matter.upper), matter.upper})
                EXPECT_TRUE(column.contains(z + by.z));
        }
    }
    EXPECT_GT(met, 200U);
}

TEST(Play, LegsHoldEveryDisplacedBody) {
    Dice dice{std::mt19937(7)};
    const Machine machine;
    for (int i = 0; i < 500; ++i) {
        AxisValues from{}, to{};
        for (size_t axis = 0; axis < 3; ++axis) {
            from[axis] = dice.between(-20.0, 20.0);
            to[axis] = dice.between(-20.0, 20.0);
        }
        const Leg leg{.positions = {from, to}};
        const Mount target{LinkId::base, dice.turned(Vec3(1.0, 2.0, 3.0), 90.0)};
        Mover mover{.mount = {machine.spindle, {}}, .reach = 1.0};
        const RelativeLeg rigid = relative_leg(machine, target, mover, leg);
        mover.play = {vector_within(dice, 3.0), vector_within(dice, 3.0)};
        const RelativeLeg loose = relative_leg(machine, target, mover, leg);
        RelativeLeg as_error = rigid;
        add_play_as_error(as_error, rotated(rigid.orientation, mover.play));
        const ConvexShape ball = convex_sphere(1.0);
        const ConvexShape fixture =
            posed(convex_sphere(2.0), translation(vector_within(dice, 20.0)));
        const double enclosed = separation(swept(ball, loose.positions), fixture).lower;
        const double by_error =
            separation(swept(ball, as_error.positions), fixture).lower - as_error.error;
        RelativeLeg there = rigid;
        const Vec3 by = rigid.orientation * some_of(dice, mover.play);
        for (Vec3& position : there.positions) position += by;
        const double truth = separation(swept(ball, there.positions), fixture).upper;
        EXPECT_LE(enclosed, truth + 1e-9);
        EXPECT_LE(by_error, truth + 1e-9);
    }
}

} // namespace
} // namespace core
