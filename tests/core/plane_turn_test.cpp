#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "core/motion/plane_turn.h"
#include "tests/support/machines.h"

namespace core {
namespace {

using test_support::axis;
using test_support::fork_head;
using test_support::head_and_table;
using test_support::trunnion;

constexpr double radian = std::numbers::pi / 180.0;

/// A table C on a swivel whose axis leans by 45 degrees.
Machine nutating_table() {
    Machine machine;
    machine.axes[4] = axis(glm::normalize(Vec3(0, 1, 1)), Side::table, LinkId::base, {0, 0, -300});
    machine.axes[5] = axis({0, 0, 1}, Side::table, link_of(4), {0, 0, -300});
    machine.table = link_of(5);
    return machine;
}

std::vector<Machine> five_axis_machines() {
    return {trunnion({10, 20, -500}, {-5, 12, -480}), head_and_table({3, 0, 150}, {40, -30, -500}),
            fork_head({1, 2, 180}), nutating_table()};
}

Vec3 direction(const Machine& machine, const AxisValues& q) {
    return glm::normalize(tip_position(machine, q, 0.0) - tip_position(machine, q, 1.0));
}

/// The direction at a fraction of the way in the plane of both.
Vec3 between(const Vec3& from, const Vec3& to, double fraction) {
    const double angle = std::atan2(glm::length(glm::cross(from, to)), glm::dot(from, to));
    if (angle < 1e-12) return from;
    return (std::sin((1.0 - fraction) * angle) * from + std::sin(fraction * angle) * to)
           / std::sin(angle);
}

/// The rotary axes that give a direction, near to others: Newton's method with numerical
/// derivatives.
AxisValues solved(const Machine& machine, AxisValues q, const Vec3& wanted) {
    std::vector<size_t> rotary;
    for (size_t i = 3; i < 6; ++i)
        if (machine.axes[i].present) rotary.push_back(i);
    for (int step = 0; step < 40; ++step) {
        const Vec3 miss = wanted - direction(machine, q);
        if (glm::length(miss) < 1e-14) break;
        Vec3 by[2];
        constexpr double small = 1e-4; // degrees
        for (size_t n = 0; n < 2; ++n) {
            AxisValues more = q, less = q;
            more[rotary[n]] += small, less[rotary[n]] -= small;
            by[n] = (direction(machine, more) - direction(machine, less)) / (2.0 * small);
        }
        const double aa = glm::dot(by[0], by[0]), ab = glm::dot(by[0], by[1]),
                     bb = glm::dot(by[1], by[1]), determinant = aa * bb - ab * ab;
        const double ra = glm::dot(by[0], miss), rb = glm::dot(by[1], miss);
        q[rotary[0]] += (bb * ra - ab * rb) / determinant;
        q[rotary[1]] += (aa * rb - ab * ra) / determinant;
    }
    return q;
}

struct RandomTurn {
    AxisValues from{}, to{};

    RandomTurn(const Machine& machine, std::mt19937& rng, double most) {
        std::uniform_real_distribution<double> degrees(-170.0, 170.0), by(-most, most);
        for (size_t i = 3; i < 6; ++i) {
            if (!machine.axes[i].present) continue;
            from[i] = degrees(rng);
            to[i] = from[i] + by(rng);
        }
    }
};

double sum_of_turns(const AxisValues& a, const AxisValues& b) {
    double sum = 0.0;
    for (size_t i = 3; i < 6; ++i) sum += std::abs(a[i] - b[i]) * radian;
    return sum;
}

TEST(PlaneTurn, KeepsTheDirectionsInTheirPlaneAndTheAxesWithinTheError) {
    std::mt19937 rng(41);
    int turned = 0;
    for (const Machine& machine : five_axis_machines())
        for (const double most : {0.3, 5.0, 60.0})
            for (int i = 0; i < 60; ++i) {
                const RandomTurn ends(machine, rng, most);
                const auto turn = turn_in_plane(machine, ends.from, ends.to, 1e-4);
                if (!turn) continue;
                ++turned;
                EXPECT_LE(turn->error, turn->positions.size() < 1024 ? 1e-4 : 1e-3);
                EXPECT_EQ(turn->positions.back(), ends.to);
                const Vec3 first = direction(machine, ends.from),
                           last = direction(machine, ends.to);
                const auto count = static_cast<double>(turn->positions.size());
                AxisValues here = ends.from, truth = ends.from;
                for (size_t part = 0; part < turn->positions.size(); ++part) {
                    const AxisValues& next = turn->positions[part];
                    const bool is_tried =
                        part < 4 || part % 16 == 0 || part + 1 == turn->positions.size();
                    if (is_tried) truth = here;
                    for (int k = 1; is_tried && k <= 8; ++k) {
                        const double inside = k / 8.0;
                        const double fraction = (static_cast<double>(part) + inside) / count;
                        truth = solved(machine, truth, between(first, last, fraction));
                        AxisValues even = here;
                        for (size_t a = 3; a < 6; ++a) even[a] += inside * (next[a] - here[a]);
                        ASSERT_LE(sum_of_turns(truth, even), turn->error + 1e-9)
                            << "part " << part << " of " << count;
                    }
                    here = next;
                }
                EXPECT_LT(sum_of_turns(truth, ends.to), 1e-8);
            }
    EXPECT_GT(turned, 500);
}

TEST(PlaneTurn, BoundsEveryPointOfEveryBodyFromItsLegs) {
    std::mt19937 rng(42);
    std::uniform_real_distribution<double> mm(-150.0, 150.0), unit(-1.0, 1.0);
    constexpr double length = 90.0;
    for (const Machine& machine : five_axis_machines()) {
        std::vector<LinkId> links = {LinkId::base, machine.spindle, machine.table, link_of(2)};
        for (size_t i = 3; i < 6; ++i)
            if (machine.axes[i].present) links.push_back(link_of(i));
        for (int i = 0; i < 120; ++i) {
            // Some turn a little by one axis alone, which stays within one part and yet needs the
            // other; some bodies are far from the axes.
            const bool is_small = i % 3 == 0;
            RandomTurn ends(machine, rng, is_small ? 2.0 : 8.0);
            for (size_t a = 3; is_small && a < 5; ++a) ends.to[a] = ends.from[a];
            const auto turn = turn_in_plane(machine, ends.from, ends.to, 1e-3);
            if (!turn) continue;
            // The tip goes straight, in as many parts.
            const Vec3 tip_from(mm(rng), mm(rng), mm(rng)), tip_to(mm(rng), mm(rng), mm(rng));
            const Vec3 first = direction(machine, ends.from), last = direction(machine, ends.to);
            const size_t count = turn->positions.size();
            const size_t part = rng() % count;
            const auto at = [&](size_t n) {
                return static_cast<double>(n) / static_cast<double>(count);
            };
            const Vec3 from = tip_from + at(part) * (tip_to - tip_from);
            const Vec3 to = tip_from + at(part + 1) * (tip_to - tip_from);
            const AxisValues begin = *reach_tip(
                machine, part == 0 ? ends.from : turn->positions[part - 1], from, length);
            const AxisValues end = *reach_tip(machine, turn->positions[part], to, length);
            Motion motion{.kind = MotionKind::feed, .feed = 1000.0};
            for (size_t a = 0; a < axis_count; ++a)
                motion.from[a] = begin[a], motion.to[a] = end[a];
            motion.tip = TipPath{from, to, length, turn->error};
            const Path path = path_of(motion, machine, 0.0025);
            ASSERT_FALSE(path.legs.empty());
            const LinkId a = links[rng() % links.size()], b = links[rng() % links.size()];
            if (a == b) continue;
            const Mount target{a, {}};
            const double far = i % 2 == 0 ? 20.0 : 1.0;
            const Vec3 centre = far * Vec3(mm(rng), mm(rng), mm(rng));
            const Mover mover{.mount = {b, {}}, .centre = centre, .reach = 100.0};
            for (const Leg& leg : path.legs) {
                const RelativeLeg relative = relative_leg(machine, target, mover, leg);
                if (!std::isfinite(relative.error)) continue;
                for (int k = 0; k <= 6; ++k) {
                    const double inside = k / 6.0;
                    const double time = leg.begin + inside * (leg.end - leg.begin);
                    const double fraction = (static_cast<double>(part) + time / path.duration)
                                            / static_cast<double>(count);
                    const AxisValues rotary =
                        solved(machine, leg.positions[0], between(first, last, fraction));
                    const AxisValues truth = *reach_tip(
                        machine, rotary, tip_from + fraction * (tip_to - tip_from), length);
                    const Vec3 offset =
                        100.0 * glm::normalize(Vec3(unit(rng), unit(rng), unit(rng)));
                    const Transform pose = target_from_mover(machine, target, mover.mount, truth);
                    const Vec3 there = pose * (centre + offset);
                    const Vec3 origin =
                        relative.positions.front()
                        + inside * (relative.positions.back() - relative.positions.front());
                    const Vec3 assumed = origin + relative.orientation * (centre + offset);
                    ASSERT_LE(glm::distance(there, assumed), relative.error + 1e-9);
                }
            }
        }
    }
}

/// A body far from the tip, while both rotary axes may be off: also one that turns with an axis
/// that does not move in this leg.
TEST(PlaneTurn, CountsTheErrorOfTheRotaryAxesFarFromTheTip) {
    const Machine machine = trunnion({0, 0, -500}, {0, 0, -480});
    constexpr double length = 90.0, off = 1e-3;
    const Vec3 tip(10.0, 20.0, -470.0);
    AxisValues from{}, to{};
    from[3] = to[3] = 30.0;
    to[5] = 1e-3;
    Motion motion{.kind = MotionKind::feed, .feed = 1000.0};
    const AxisValues begin = *reach_tip(machine, from, tip, length);
    const AxisValues end = *reach_tip(machine, to, tip + Vec3(1, 0, 0), length);
    for (size_t a = 0; a < axis_count; ++a) motion.from[a] = begin[a], motion.to[a] = end[a];
    motion.tip = TipPath{tip, tip + Vec3(1, 0, 0), length, off};
    const Path path = path_of(motion, machine, 1e-4);
    ASSERT_EQ(path.legs.size(), 1u);
    for (const size_t carrier : {size_t{3}, size_t{5}}) { // A stays, C turns
        const Mover mover{.mount = {link_of(carrier), {}}, .centre = {0, 5000, -500}};
        const RelativeLeg relative = relative_leg(machine, {}, mover, path.legs[0]);
        AxisValues truth = begin;
        truth[3] += off / radian;
        truth = *reach_tip(machine, truth, tip, length);
        const Vec3 there = target_from_mover(machine, {}, mover.mount, truth) * mover.centre;
        const Vec3 assumed = relative.positions[0] + relative.orientation * mover.centre;
        const double apart = glm::distance(there, assumed);
        EXPECT_GT(apart, 4.9);
        EXPECT_LE(apart, relative.error);
        EXPECT_LT(relative.error, 8.0);
        EXPECT_GT(relative.lasting_error, 4.9);
    }
}

TEST(PlaneTurn, IsASingleTiltWhereOneAxisTurnsAtRightAnglesToTheTool) {
    const Machine machine = trunnion({0, 0, -500}, {0, 0, -480});
    AxisValues from{}, to{};
    to[3] = 40.0;
    const auto tilt = turn_in_plane(machine, from, to, 1e-5);
    ASSERT_TRUE(tilt);
    EXPECT_EQ(tilt->positions.size(), 1u);
    EXPECT_EQ(tilt->error, 0.0);
    EXPECT_EQ(tilt->sine, 1.0);
}

TEST(PlaneTurn, TurnsInPlaceAtAPole) {
    const Machine machine = trunnion({0, 0, -500}, {0, 0, -480});
    AxisValues from{}, to{};
    to[3] = 40.0, to[5] = 70.0;
    for (const bool is_away : {true, false}) {
        const AxisValues &begin = is_away ? from : to, &end = is_away ? to : from;
        const auto turn = turn_in_plane(machine, begin, end, 1e-5);
        ASSERT_TRUE(turn);
        EXPECT_EQ(turn->begins_in_place, is_away);
        EXPECT_EQ(turn->ends_in_place, !is_away);
        ASSERT_EQ(turn->positions.size(), 2u);
        EXPECT_EQ(turn->positions[0][5], 70.0);
        EXPECT_EQ(turn->positions[0][3], 0.0);
        EXPECT_EQ(turn->positions[1], end);
    }
}

/// Four degrees from a pole, 2,900 parts are too few, and twice as many would be too many.
TEST(PlaneTurn, IsDividedUpToTheLimitBeforeItIsGivenUp) {
    Machine machine;
    machine.axes[4] = {
        .direction = {0, 1, 0}, .present = true, .side = Side::tool, .carrier = link_of(2)};
    machine.axes[3] = {
        .direction = {1, 0, 0}, .present = true, .side = Side::tool, .carrier = link_of(4)};
    machine.spindle = link_of(3);
    AxisValues from{}, to{};
    from[3] = -85.8367, from[4] = -4.0142;
    to[3] = 70.7344, to[4] = -82.5715;
    const auto turn = turn_in_plane(machine, from, to, turn_error);
    ASSERT_TRUE(turn);
    EXPECT_EQ(turn->positions.size(), 4096u);
    EXPECT_LE(turn->error, 1e-3);
}

TEST(PlaneTurn, HasNoWayThroughAPoleThatIsNotAtAnEnd) {
    const Machine machine = trunnion({0, 0, -500}, {0, 0, -480});
    AxisValues from{}, to{};
    from[3] = 30.0, to[3] = 30.0, to[5] = 180.0;
    EXPECT_FALSE(turn_in_plane(machine, from, to, 1e-5));
    // Near to it, the sine says how near.
    to[5] = 150.0;
    const auto turn = turn_in_plane(machine, from, to, 1e-3);
    ASSERT_TRUE(turn);
    EXPECT_LT(turn->sine, std::sin(9.0 * radian));
    EXPECT_GT(turn->sine, 0.0);
    // The other position with the same direction is not on the way.
    AxisValues other = from;
    other[3] = -30.0, other[5] = 180.0;
    EXPECT_FALSE(turn_in_plane(machine, from, other, 1e-5));
}

} // namespace
} // namespace core
