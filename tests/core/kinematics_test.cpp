#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "tests/support/machines.h"

namespace core {
namespace {

using test_support::fork_head;
using test_support::head_and_table;
using test_support::trunnion;

constexpr double radian = std::numbers::pi / 180.0;

Vec3 about_x(const Vec3& p, double degrees) {
    const double c = std::cos(degrees * radian), s = std::sin(degrees * radian);
    return {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
}
Vec3 about_y(const Vec3& p, double degrees) {
    const double c = std::cos(degrees * radian), s = std::sin(degrees * radian);
    return {c * p.x + s * p.z, p.y, -s * p.x + c * p.z};
}
Vec3 about_z(const Vec3& p, double degrees) {
    const double c = std::cos(degrees * radian), s = std::sin(degrees * radian);
    return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

AxisValues random_values(std::mt19937& rng) {
    std::uniform_real_distribution<double> mm(-300.0, 300.0), degrees(-170.0, 170.0);
    AxisValues values{};
    for (size_t i = 0; i < 6; ++i) values[i] = is_rotary(i) ? degrees(rng) : mm(rng);
    return values;
}

std::vector<Machine> machines() {
    return {trunnion({10, 20, -500}, {-5, 12, -480}), head_and_table({3, 0, 150}, {40, -30, -500}),
            fork_head({1, 2, 180}), Machine()};
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
    EXPECT_LT(glm::distance(a, b), tolerance)
        << a.x << ' ' << a.y << ' ' << a.z << " and " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(TipPosition, OfATrunnionIsTurnedBackThroughBothAxes) {
    const Vec3 a_point(10, 20, -500), c_point(-5, 12, -480);
    const Machine machine = trunnion(a_point, c_point);
    std::mt19937 rng(3);
    for (int i = 0; i < 200; ++i) {
        const AxisValues q = random_values(rng);
        // Relative to the work the tool rotates by A and C: first about A, whose axis is fixed.
        const Vec3 tip(q[0], q[1], q[2] - 80.0);
        const Vec3 on_cradle = about_x(tip - a_point, q[3]) + a_point;
        expect_near(tip_position(machine, q, 80.0), about_z(on_cradle - c_point, q[5]) + c_point,
                    1e-9);
    }
}

TEST(TipPosition, OfAForkHeadSwingsWithTheTool) {
    const Vec3 pivot(1, 2, 180);
    const Machine machine = fork_head(pivot);
    std::mt19937 rng(4);
    for (int i = 0; i < 200; ++i) {
        const AxisValues q = random_values(rng);
        const Vec3 from_pivot = about_z(about_y(Vec3(0, 0, -80) - pivot, q[4]), q[5]);
        expect_near(tip_position(machine, q, 80.0), from_pivot + pivot + Vec3(q[0], q[1], q[2]),
                    1e-9);
    }
}

TEST(TipPosition, IsExactAtQuarterTurns) {
    const Machine machine = trunnion({0, 0, -100}, {0, 0, -100});
    AxisValues q{};
    q[2] = -50.0, q[3] = 90.0;
    EXPECT_EQ(tip_position(machine, q, 50.0), Vec3(0, 0, -100));
    q[2] = 0.0;
    EXPECT_EQ(tip_position(machine, q, 50.0), Vec3(0, -50, -100));
}

TEST(ReachTip, BringsTheTipToItsTargetOnEveryMachine) {
    std::mt19937 rng(5);
    for (const Machine& machine : machines())
        for (int i = 0; i < 200; ++i) {
            const AxisValues q = random_values(rng);
            const Vec3 position(random_values(rng)[0], random_values(rng)[1],
                                random_values(rng)[2]);
            const auto reached = reach_tip(machine, q, position, 80.0);
            ASSERT_TRUE(reached);
            expect_near(tip_position(machine, *reached, 80.0), position, 1e-8);
            for (size_t axis = 3; axis < axis_count; ++axis) EXPECT_EQ((*reached)[axis], q[axis]);
        }
}

Vec3 tool_axis(const Machine& machine, const AxisValues& q) {
    return glm::normalize(tip_position(machine, q, 0.0) - tip_position(machine, q, 1.0));
}

TEST(PointTool, ReachesEveryDirectionThatSomeAnglesGive) {
    std::mt19937 rng(6);
    for (const Machine& machine : machines()) {
        if (!machine.has_rotary()) continue;
        for (int i = 0; i < 300; ++i) {
            const AxisValues q = random_values(rng), now = random_values(rng);
            const Vec3 wanted = tool_axis(machine, q);
            const auto pointed = point_tool(machine, now, wanted);
            ASSERT_TRUE(pointed);
            expect_near(tool_axis(machine, *pointed), wanted, 1e-8);
            for (size_t axis = 0; axis < 3; ++axis) EXPECT_EQ((*pointed)[axis], now[axis]);
        }
    }
}

TEST(PointTool, KeepsToTheLimitsAndTurnsAsLittleAsItCan) {
    Machine machine = trunnion({0, 0, 0}, {0, 0, 0});
    machine.axes[3].min = -30.0;
    machine.axes[3].max = 120.0;
    AxisValues q{};
    // Towards -Y by A 90, or by A -90 and half a turn of C, which the limit excludes.
    const auto pointed = point_tool(machine, q, {0, -1, 0});
    ASSERT_TRUE(pointed);
    EXPECT_NEAR((*pointed)[3], 90.0, 1e-9);
    EXPECT_NEAR((*pointed)[5], 0.0, 1e-9);
    const auto other = point_tool(machine, q, {0, 1, 0});
    ASSERT_TRUE(other);
    EXPECT_NEAR((*other)[3], 90.0, 1e-9);
    EXPECT_NEAR(std::abs((*other)[5]), 180.0, 1e-9);
    machine.axes[3].max = 60.0;
    EXPECT_FALSE(point_tool(machine, q, {0, 1, 0}));
    EXPECT_FALSE(point_tool(Machine(), q, {0, 1, 0}));
    EXPECT_TRUE(point_tool(Machine(), q, {0, 0, 1}));
}

/// A leg of a random machine with a random mover and target.
struct RandomLeg {
    Mount target;
    Mover mover;
    Leg leg;
};

LinkId random_link(const Machine& machine, std::mt19937& rng) {
    while (true) {
        const size_t i = rng() % 7;
        if (i == 6) return LinkId::base;
        if (machine.axes[i].present) return link_of(i);
    }
}

RandomLeg random_leg(const Machine& machine, double turn_deg, std::mt19937& rng) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto position = [&](double size) { return size * Vec3(unit(rng), unit(rng), unit(rng)); };
    RandomLeg random;
    random.target = {random_link(machine, rng),
                     {rotation_xyz_deg(180.0 * position(1.0)), position(200.0)}};
    random.mover = {
        {random_link(machine, rng), {rotation_xyz_deg(180.0 * position(1.0)), position(200)}},
        position(60.0),
        50.0 * std::abs(unit(rng))};
    AxisValues from = random_values(rng), to = from;
    for (size_t i = 0; i < 6; ++i) to[i] += is_rotary(i) ? turn_deg * unit(rng) : 8.0 * unit(rng);
    random.leg.positions = {from, to};
    return random;
}

/// A point of the sphere around the mover's centre at a fraction of the leg: where it really is,
/// and where the mover's origin is if it does not turn.
struct Moment {
    Vec3 point;  // in the mover's frame
    Vec3 real;   // in the target's frame
    Vec3 origin; // in the target's frame
};

Moment random_moment(const Machine& machine, const RandomLeg& random, const RelativeLeg& leg,
                     double fraction, std::mt19937& rng) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const AxisValues q = stretch(random.leg, 0.0, fraction).positions[1];
    const Vec3 direction = glm::normalize(Vec3(unit(rng), unit(rng), unit(rng) + 1e-3));
    const Vec3 p = random.mover.centre + random.mover.reach * direction;
    return {p, target_from_mover(machine, random.target, random.mover.mount, q) * p,
            leg.positions[0] + fraction * (leg.positions[1] - leg.positions[0])};
}

TEST(RelativeLeg, KeepsEveryPointWithinItsError) {
    std::mt19937 rng(7);
    double tightest = 0.0;
    int turned = 0, straight = 0;
    for (int i = 0; i < 6000; ++i) {
        const Machine machine = machines()[rng() % 4];
        const RandomLeg random = random_leg(machine, i % 3 ? 0.3 : 8.0, rng);
        const RelativeLeg leg = relative_leg(machine, random.target, random.mover, random.leg);
        if (leg.error == infinity) continue;
        ++(leg.turns ? turned : straight);
        for (int k = 0; k <= 20; ++k) {
            const Moment at = random_moment(machine, random, leg, k / 20.0, rng);
            const double off = glm::distance(at.real, leg.orientation * at.point + at.origin);
            ASSERT_LE(off, leg.error + 1e-9) << i;
            if (leg.turns) tightest = std::max(tightest, off / leg.error);
            const Transform before = target_from_mover(machine, random.target, random.mover.mount,
                                                       random.leg.positions[0]);
            ASSERT_LE(glm::distance(at.real, before * at.point), leg.travel + 1e-9) << i;
        }
    }
    EXPECT_GT(turned, 2000);
    EXPECT_GT(straight, 200);
    EXPECT_GT(tightest, 0.5); // a bound that is much too wide would be useless
}

TEST(RelativeLeg, KeepsABodyOfRevolutionWithinItsError) {
    // As a set: the points of the real body are compared with the nearest ones of the body without
    // turning, which is a circle for each of them.
    std::mt19937 rng(8);
    double tightest = 0.0, least = infinity;
    int turned = 0;
    for (int i = 0; i < 6000; ++i) {
        const Machine machine = machines()[rng() % 4];
        RandomLeg random = random_leg(machine, i % 3 ? 0.3 : 8.0, rng);
        if (i % 2) random.mover.mount.link_from_body = {}; // upright, as tools are
        random.mover.centre.x = random.mover.centre.y = 0.0;
        const double of_any_body =
            relative_leg(machine, random.target, random.mover, random.leg).error;
        random.mover.is_revolved = true;
        const RelativeLeg leg = relative_leg(machine, random.target, random.mover, random.leg);
        if (leg.error == infinity || !leg.turns) continue;
        ++turned;
        ASSERT_LE(leg.error, of_any_body + 1e-12);
        least = std::min(least, leg.error / of_any_body);
        for (int k = 0; k <= 20; ++k) {
            const Moment at = random_moment(machine, random, leg, k / 20.0, rng);
            // The real point in the frame of the body without turning, and the circle of the point
            // there.
            const Vec3 there = glm::transpose(leg.orientation) * (at.real - at.origin);
            const Vec3& p = at.point;
            const double off =
                std::hypot(std::hypot(there.x, there.y) - std::hypot(p.x, p.y), there.z - p.z);
            ASSERT_LE(off, leg.error + 1e-9) << i;
            tightest = std::max(tightest, off / leg.error);
        }
    }
    EXPECT_GT(turned, 2000);
    EXPECT_GT(tightest, 0.5);
    EXPECT_LT(least, 0.1); // a tool along the axis of rotation does not change
}

TEST(TipPath, StaysWithinTheErrorOfItsLegs) {
    std::mt19937 rng(8);
    for (int i = 0; i < 300; ++i) {
        const Machine machine = machines()[static_cast<size_t>(i) % 3];
        AxisValues from = random_values(rng), to = from;
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (size_t axis = 3; axis < 6; ++axis) to[axis] += 30.0 * unit(rng);
        const Vec3 a = tip_position(machine, from, 90.0);
        const Vec3 b = a + 20.0 * Vec3(unit(rng), unit(rng), unit(rng));
        to = *reach_tip(machine, to, b, 90.0);
        Motion motion{.kind = MotionKind::feed, .tip = TipPath{a, b, 90.0}, .feed = 100.0};
        for (size_t axis = 0; axis < axis_count; ++axis) {
            motion.from[axis] = from[axis];
            motion.to[axis] = to[axis];
        }
        const Path path = path_of(motion, machine, 0.002);
        double fraction = 0.0;
        for (const Leg& leg : path.legs) {
            for (const double part : {0.25, 0.5, 0.75, 1.0}) {
                const AxisValues q = stretch(leg, 0.0, part).positions[1];
                const double at = (fraction + part) / static_cast<double>(path.legs.size());
                expect_near(tip_position(machine, q, 90.0), a + at * (b - a), 0.002 + 1e-8);
            }
            fraction += 1.0;
        }
        EXPECT_EQ(path.legs.front().positions[0], from);
        EXPECT_EQ(path.legs.back().positions[1], to);
    }
}

TEST(AxisRange, OfATipPathHoldsWhatTheAxesDoOnTheWay) {
    // The tip does not move, 100 mm from the axis of A, while A moves from -40 to 40 degrees: Z has
    // its extreme in the middle and equal values at both ends.
    const Machine machine = trunnion({0, 0, 0}, {0, 0, 0});
    AxisValues from{};
    from[3] = -40.0;
    const Vec3 tip(0, 0, 100);
    from = *reach_tip(machine, from, tip, 50.0);
    AxisValues to = from;
    to[3] = 40.0;
    to = *reach_tip(machine, to, tip, 50.0);
    Motion motion{.kind = MotionKind::feed, .tip = TipPath{tip, tip, 50.0}, .feed = 100.0};
    for (size_t axis = 0; axis < axis_count; ++axis) {
        motion.from[axis] = from[axis];
        motion.to[axis] = to[axis];
    }
    const AxisRange range = axis_range(motion, machine, 0.002);
    EXPECT_NEAR(range.max[2], 150.0, 0.003);
    EXPECT_GE(range.max[2], 150.0);
    EXPECT_NEAR(range.min[2], 50.0 + 100.0 * std::cos(40 * radian), 1e-9);
}

Vec3 random_direction(std::mt19937& rng) {
    std::normal_distribution<double> part;
    return glm::normalize(Vec3(part(rng), part(rng), part(rng)));
}

/// No point of a body is farther from where the stated machine has it than the bound, which is not
/// many times too large either.
TEST(AxisTolerances, BoundTheDisplacementOfEveryPoint) {
    std::mt19937 rng(28);
    std::uniform_real_distribution<double> unit(0.0, 1.0), mm(-80.0, 80.0), change(-40.0, 40.0);
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < 3000; ++i) {
        Machine machine = machines()[static_cast<size_t>(i) % 3];
        Machine real = machine;
        for (size_t axis = 3; axis < 6; ++axis) {
            if (!machine.axes[axis].present) continue;
            MachineAxis &stated = machine.axes[axis], &true_one = real.axes[axis];
            stated.point_tolerance = i % 5 == 0 ? 0.0 : 0.2 * unit(rng);
            stated.direction_tolerance = i % 7 == 0 ? 0.0 : 0.01 * unit(rng);
            true_one.point += stated.point_tolerance * random_direction(rng);
            // Turned away by the tolerance.
            const Vec3 aside = glm::normalize(glm::cross(stated.direction, random_direction(rng)));
            const double angle = stated.direction_tolerance;
            true_one.direction = std::cos(angle) * stated.direction + std::sin(angle) * aside;
        }
        Mover mover{.mount = {machine.spindle, {}},
                    .centre = Vec3(mm(rng), mm(rng), mm(rng)),
                    .reach = 1.0 + std::abs(mm(rng))};
        AxisValues from = random_values(rng), to = from;
        if (i % 11 == 0)
            for (size_t axis = 3; axis < 6; ++axis) from[axis] = to[axis] = 0.0;
        if (i % 3 != 0)
            for (double& value : to) value += change(rng);
        if (i % 13 == 0) to[5] += 400.0;
        Leg leg;
        leg.positions = {from, to};
        leg.straight = i % 4 != 0;
        const double bound = axis_tolerance_error(machine, machine.table, mover, leg);
        double most = 0.0;
        for (int k = 0; k < 200; ++k) {
            AxisValues at = from;
            const double whole = unit(rng);
            for (size_t axis = 0; axis < axis_count;
                 ++axis) // anywhere in the hull, if not straight
                at[axis] += (leg.straight ? whole : unit(rng)) * (to[axis] - from[axis]);
            const Vec3 point = mover.centre + mover.reach * random_direction(rng);
            const Vec3 here =
                target_from_mover(machine, {machine.table, {}}, mover.mount, at) * point;
            const Vec3 there =
                target_from_mover(real, {machine.table, {}}, mover.mount, at) * point;
            most = std::max(most, glm::distance(here, there));
        }
        ASSERT_LE(most, bound + 1e-9) << i;
        if (most > 0.01 && leg.straight) sum += bound / most, ++count;
    }
    EXPECT_GT(count, 1000);
    EXPECT_LT(sum / count, 6.0) << "the bound is of the right size";
}

TEST(AxisTolerances, DoNotCountWhileTheAxesAreAtZeroOrNotBetweenTheBodies) {
    Machine machine = head_and_table({3, 0, 150}, {40, -30, -500});
    Leg leg;
    leg.positions = {AxisValues{}};
    const Mover mover{.mount = {machine.spindle, {}}, .centre = {10, 0, 0}, .reach = 5.0};
    for (MachineAxis& axis : machine.axes)
        if (axis.present) axis.point_tolerance = 0.1;
    EXPECT_EQ(axis_tolerance_error(machine, machine.table, mover, leg), 0.0);
    leg.positions[0][5] = 90.0; // the table: 0.1 at each end of a quarter turn
    EXPECT_NEAR(axis_tolerance_error(machine, machine.table, mover, leg), 0.1 * std::sqrt(2.0),
                1e-3);
    EXPECT_EQ(axis_tolerance_error(machine, LinkId::base, mover, leg), 0.0)
        << "the base does not turn with the table";
    leg.positions[0][5] = 180.0;
    EXPECT_NEAR(axis_tolerance_error(machine, machine.table, mover, leg), 0.2, 1e-3);
    // A slip in the program turns it millions of times.
    leg.positions.push_back(AxisValues{});
    leg.positions[1][5] = 1e9 + 90.0;
    leg.straight = true;
    EXPECT_GE(axis_tolerance_error(machine, machine.table, mover, leg), 0.2);
}

} // namespace
} // namespace core
