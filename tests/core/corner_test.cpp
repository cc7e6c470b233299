#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "core/motion/corner.h"
#include "core/motion/machine.h"
#include "tests/support/blended_corner.h"

namespace core {
namespace {

using test_support::blended;
using test_support::on_a_circle;
using test_support::StraightCorner;

struct Limit {
    double deviation = 0.0, distance = infinity;
};

AxisValues values_at(const Vec3& p) { return {p.x, p.y, p.z}; }

Leg leg(const Vec3& from, const Vec3& to) {
    return {.positions = {values_at(from), values_at(to)}};
}

std::optional<CornerRegion> region_of(const StraightCorner& path, const Limit& limit) {
    const std::vector<Leg> before = {leg(path.a, path.corner)}, after = {leg(path.corner, path.b)};
    return corner_region(before, after, limit.deviation, {limit.distance, limit.distance});
}

Vec3 point(const AxisValues& values) { return {values[0], values[1], values[2]}; }

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const double length = glm::dot(b - a, b - a);
    const double at = length > 0.0 ? std::clamp(glm::dot(p - a, b - a) / length, 0.0, 1.0) : 0.0;
    return glm::distance(p, a + at * (b - a));
}

double distance_to_path(const Vec3& p, const CornerRegion& region) {
    double least = infinity;
    for (const Leg& one : region.along)
        least = std::min(least, distance_to_segment(p, point(one.positions.front()),
                                                    point(one.positions.back())));
    return least;
}

/// How far a point is outside of a triangle in whose plane it is, or of the line that it is flat
/// to.
double outside(const Vec3& p, const CornerRegion& region) {
    const std::vector<AxisValues>& at = region.hull.positions;
    const Vec3 a = point(at.at(0)), b = point(at.at(1)), c = point(at.at(2));
    const Vec3 normal = glm::cross(b - a, c - a);
    const auto is_inside = [&](const Vec3& from, const Vec3& to) {
        return glm::dot(glm::cross(to - from, p - from), normal) >= 0.0;
    };
    if (is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) return 0.0;
    return std::min(
        {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

struct RandomCorners {
    std::mt19937 rng{4711};
    double between(double low, double high) {
        return std::uniform_real_distribution(low, high)(rng);
    }
    Vec3 vector(double size) {
        return {between(-size, size), between(-size, size), between(-size, size)};
    }
    StraightCorner next() {
        const Vec3 corner = vector(100.0);
        return {corner + vector(80.0), corner, corner + vector(80.0)};
    }
};

TEST(CornerRegion, ContainsMachinesThatBlendWithinATolerance) {
    RandomCorners random;
    int near_half = 0, by_tolerance = 0;
    for (int i = 0; i < 2000; ++i) {
        const StraightCorner path = random.next();
        const double tolerance = std::exp(random.between(-5.0, 2.5));
        const auto region = region_of(path, {tolerance});
        ASSERT_TRUE(region);
        const auto positions =
            blended(path, random.between(500.0, 5000.0), random.between(10.0, 700.0), tolerance);
        double farthest = 0.0;
        for (const Vec3& p : positions) {
            EXPECT_LE(outside(p, *region), 1e-6);
            farthest = std::max(farthest, distance_to_path(p, *region));
        }
        EXPECT_LE(farthest, tolerance + 1e-6);
        const double reach = glm::distance(positions.front(), path.corner);
        const double half =
            0.5 * std::min(glm::distance(path.a, path.corner), glm::distance(path.b, path.corner));
        near_half += reach > 0.95 * half;
        by_tolerance +=
            glm::distance(positions[positions.size() / 2], path.corner) > 0.95 * tolerance;
    }
    EXPECT_GT(near_half, 50) << "the length of the moves limits some";
    EXPECT_GT(by_tolerance, 500) << "the tolerance limits most";
}

TEST(CornerRegion, ContainsCirclesAndParabolasWithinADistance) {
    RandomCorners random;
    for (int i = 0; i < 2000; ++i) {
        const StraightCorner path = random.next();
        const double distance = std::exp(random.between(-3.0, 3.5));
        const auto region = region_of(path, {0.5 * distance, distance});
        ASSERT_TRUE(region);
        const double before = std::min(distance, glm::distance(path.a, path.corner));
        const double after = std::min(distance, glm::distance(path.b, path.corner));
        const Vec3 in = glm::normalize(path.corner - path.a);
        const Vec3 out = glm::normalize(path.b - path.corner);
        auto positions = on_a_circle(path, random.between(0.0, std::min(before, after)));
        for (int k = 0; k <= 100; ++k) {
            const double t = 0.01 * k;
            positions.push_back(path.corner - before * (1.0 - t) * (1.0 - t) * in
                                + after * t * t * out);
        }
        for (const Vec3& p : positions) {
            EXPECT_LE(outside(p, *region), 1e-6);
            EXPECT_LE(distance_to_path(p, *region), 0.5 * distance + 1e-9);
        }
    }
}

TEST(CornerRegion, ContainsCirclesWithinATolerance) {
    RandomCorners random;
    for (int i = 0; i < 2000; ++i) {
        const StraightCorner path = random.next();
        const double half =
            0.5 * std::min(glm::distance(path.a, path.corner), glm::distance(path.b, path.corner));
        const auto positions = on_a_circle(path, random.between(0.0, half));
        double tolerance = infinity;
        for (const Vec3& p : positions)
            tolerance = std::min(tolerance, glm::distance(p, path.corner));
        const auto region = region_of(path, {tolerance});
        ASSERT_TRUE(region);
        for (const Vec3& p : positions) EXPECT_LE(outside(p, *region), 1e-6);
    }
}

/// A machine whose linear axes all have this acceleration.
Machine machine_with(std::optional<double> acceleration) {
    Machine machine;
    for (size_t i = 0; i < 3; ++i) {
        machine.axes[i].acceleration = acceleration;
        machine.axes[i].rapid = 12000.0;
    }
    return machine;
}

TEST(CornerRegion, ContainsMachinesThatKeepTheirSpeed) {
    RandomCorners random;
    int below_half = 0, at_half = 0;
    for (int i = 0; i < 2000; ++i) {
        const StraightCorner path = random.next();
        const double acceleration = random.between(300.0, 5000.0);
        const double speed = random.between(5.0, 300.0);
        const Vec3 in = path.corner - path.a, out = path.b - path.corner;
        Leg first = leg(path.a, path.corner), second = leg(path.corner, path.b);
        first.end = glm::length(in) / speed;
        second.end = glm::length(out) / speed;
        const std::vector<Leg> before = {first}, after = {second};
        const CornerReach reach =
            blend_at(before, after, infinity, CornerKind::rapids, machine_with(acceleration)).reach;
        const auto region = corner_region(before, after, infinity, reach);
        ASSERT_TRUE(region);
        // The planner keeps half of the acceleration for the other motion.
        std::vector<Vec3> positions = blended(path, 0.5 * acceleration, speed, infinity);
        // Or it follows a circle that needs sqrt(3)/2 of the acceleration.
        const double turn = std::acos(glm::dot(in, out) / (glm::length(in) * glm::length(out)));
        const double half = 0.5 * std::min(glm::length(in), glm::length(out));
        const double on_circle =
            speed * speed / (0.5 * std::sqrt(3.0) * acceleration) * std::tan(0.5 * turn);
        for (const Vec3& p : on_a_circle(path, std::min(on_circle, half))) positions.push_back(p);
        for (const Vec3& p : positions) EXPECT_LE(outside(p, *region), 1e-6);
        EXPECT_LE(reach.before, 0.5 * glm::length(in) + 1e-9);
        EXPECT_LE(reach.after, glm::length(out) + 1e-9);
        const bool is_short = reach.before < 0.4 * glm::length(in);
        below_half += is_short;
        at_half += !is_short;
    }
    EXPECT_GT(below_half, 300) << "accelerations limit some";
    EXPECT_GT(at_half, 300) << "the length of the moves limits others";
}

/// How far before corners of long moves LinuxCNC's planner leaves them: measured with its own
/// tpmod.so (2.9) at 100 mm/s, 1000 mm/s2 and a cycle of 1 ms, in parts of v^2/a.
TEST(CornerRegion, BeginsWhereThePlannerOfLinuxcncLeavesThePath) {
    constexpr std::pair<double, double> measured[] = {
        {5, 0.991},   {15, 1.002},  {30, 1.020},  {45, 1.050},  {60, 1.100},  {75, 1.170},
        {80, 1.200},  {90, 1.270},  {100, 1.370}, {110, 1.641}, {120, 1.992}, {135, 2.785},
        {150, 4.306}, {155, 5.203}, {160, 5.951}, {170, 5.455}};
    for (const auto& [turn, reached] : measured) {
        const double angle = turn * std::numbers::pi / 180.0;
        const Vec3 corner(200, 0, 0),
            end = corner + 200.0 * Vec3(std::cos(angle), std::sin(angle), 0);
        Leg first = leg({0, 0, 0}, corner), second = leg(corner, end);
        first.end = second.end = 2.0;
        const std::vector<Leg> before = {first}, after = {second};
        const CornerReach reach =
            blend_at(before, after, infinity, CornerKind::rapids, machine_with(1000.0)).reach;
        EXPECT_GE(reach.before, 10.0 * reached) << turn;
        EXPECT_GE(reach.after, 10.0 * reached) << turn;
        if (turn <= 150.0) {
            EXPECT_LE(reach.before, 12.5 * reached) << turn;
        }
    }
}

TEST(CornerBlend, BeginsInTheMiddleIfAccelerationsAreNotKnown) {
    const std::vector<Leg> before = {leg({0, 0, 0}, {10, 0, 0})},
                           after = {leg({10, 0, 0}, {10, 8, 0})};
    const CornerReach reach =
        blend_at(before, after, infinity, CornerKind::rapids, machine_with(std::nullopt)).reach;
    EXPECT_EQ(reach.before, 5.0);
    EXPECT_EQ(reach.after, 8.0) << "a slow motion before it takes its time";
}

/// A corner that the planner of LinuxCNC has made, and how it left it (linuxcnc_corners.txt).
struct RecordedCorner {
    Machine machine;
    double tolerance = 0.0, feed = 0.0; // 0: none; a rapid
    Motion motions[2];
    int arc = 0; // 1: the first motion, 2: the second one
    double before = 0.0, after = 0.0, off = 0.0;

    std::vector<Leg> legs(size_t i) const { return path_of(motions[i], machine, 1e-3).legs; }
    CornerBlend blend(const Machine& on, CornerKind of_feeds = CornerKind::feeds) const {
        return blend_at(legs(0), legs(1), tolerance > 0.0 ? tolerance : infinity,
                        feed > 0.0 ? of_feeds : CornerKind::rapids, on);
    }
    Machine without_dynamics() const {
        Machine unstated = machine;
        for (MachineAxis& axis : unstated.axes) axis.acceleration.reset();
        return unstated;
    }
};

std::vector<RecordedCorner> recorded_corners() {
    std::ifstream file(FEELER_SOURCE_DIR "/tests/core/linuxcnc_corners.txt");
    std::vector<RecordedCorner> corners;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with('#')) continue;
        std::istringstream words(line);
        RecordedCorner corner;
        Vec3 from, to;
        ArcPath arc;
        for (size_t i = 0; i < 3; ++i) {
            double speed = 0.0;
            words >> speed;
            corner.machine.axes[i].rapid = 60.0 * speed;
        }
        for (size_t i = 0; i < 3; ++i) {
            double acceleration = 0.0;
            words >> acceleration;
            corner.machine.axes[i].acceleration = acceleration;
        }
        words >> corner.tolerance >> corner.feed >> from.x >> from.y >> from.z >> to.x >> to.y
            >> to.z >> corner.arc >> arc.centre.x >> arc.centre.y >> arc.angle >> corner.before
            >> corner.after >> corner.off;
        EXPECT_TRUE(words) << line;
        const Vec3 ends[] = {from, Vec3(0.0), to};
        for (size_t i = 0; i < 2; ++i) {
            Motion& motion = corner.motions[i];
            motion.from = {ends[i].x, ends[i].y, ends[i].z};
            motion.to = {ends[i + 1].x, ends[i + 1].y, ends[i + 1].z};
            motion.feed = 60.0 * corner.feed;
            motion.kind = corner.feed > 0.0 ? MotionKind::feed : MotionKind::rapid;
            if (corner.arc != static_cast<int>(i) + 1) continue;
            motion.kind = MotionKind::arc;
            motion.arc = arc;
        }
        corners.push_back(corner);
    }
    EXPECT_EQ(corners.size(), 400U);
    return corners;
}

TEST(CornerBlend, ContainsWhatThePlannerOfLinuxcncDoes) {
    constexpr double recorded = 2e-4; // mm
    size_t lines = 0, arcs = 0, close = 0, beyond_tolerance = 0;
    for (const RecordedCorner& corner : recorded_corners()) {
        const CornerBlend blend = corner.blend(corner.machine);
        EXPECT_LE(corner.off, blend.deviation + recorded);
        EXPECT_LE(corner.before, blend.reach.before + recorded);
        EXPECT_LE(corner.after, blend.reach.after + recorded);
        (corner.arc == 0 ? lines : arcs) += corner.off > recorded;
        if (corner.feed > 0.0) {
            const CornerBlend joined = corner.blend(corner.machine, CornerKind::joined_feeds);
            EXPECT_LE(corner.off, joined.deviation + recorded);
        }
        close += corner.off > 0.3 * blend.deviation;
        const bool is_straight = corner.arc == 0 && corner.tolerance > 0.0;
        if (!is_straight) continue;
        beyond_tolerance += corner.off > corner.tolerance;
        EXPECT_LE(corner.off, most_blend_deviation(corner.machine) * corner.tolerance + recorded);
        const CornerBlend unstated = corner.blend(corner.without_dynamics());
        EXPECT_LE(corner.off, unstated.deviation + recorded);
        EXPECT_LE(corner.before, unstated.reach.before + recorded);
        EXPECT_LE(corner.after, unstated.reach.after + recorded);
    }
    EXPECT_GT(lines, 150U);
    EXPECT_GT(arcs, 150U);
    EXPECT_GT(close, 150U) << "the bounds are not far off";
    EXPECT_GT(beyond_tolerance, 1U);
}

/// A straight leg of X and A, which takes a second.
Leg turning_leg(double x0, double a0, double x1, double a1) {
    Leg leg{.positions = {AxisValues{x0, 0, 0, a0}, AxisValues{x1, 0, 0, a1}}};
    leg.end = 1.0;
    return leg;
}

TEST(CornerBlend, LeavesAnAxisHalfWayBackIfTheOthersGoOnWithoutIt) {
    const Machine machine = machine_with(500.0);
    const std::vector<Leg> turn = {turning_leg(0, 0, 0, 90)}, go = {turning_leg(0, 90, 40, 90)};
    CornerBlend blend = blend_at(turn, go, 0.05, CornerKind::feeds, machine);
    EXPECT_NEAR(blend.turn, 1.05 * std::numbers::pi / 4.0, 1e-12);
    EXPECT_EQ(blend.deviation, 0.0);
    // From 48 mm/s with 225 mm/s2.
    blend = blend_at(go, turn, 0.05, CornerKind::feeds, machine);
    EXPECT_EQ(blend.turn, 0.0);
    EXPECT_NEAR(blend.deviation, 1.05 * 48.0 * 48.0 / 450.0, 1e-9);
    // From 108 degrees/s with 450 degrees/s2.
    Machine other = machine;
    other.axes[3].acceleration = 1000.0;
    blend = blend_at(turn, go, 0.05, CornerKind::feeds, other);
    EXPECT_NEAR(blend.turn, 1.05 * 108.0 * 108.0 / 900.0 * std::numbers::pi / 180.0, 1e-9);
}

TEST(CornerBlend, OfAxesThatMoveWithTheOthersIsWhatTheyChangeDifferently) {
    Machine machine = machine_with(500.0);
    machine.axes[3].present = true;
    const std::vector<Leg> before = {turning_leg(0, 0, 10, 5)}, after = {turning_leg(10, 5, 20, 8)};
    // At most half of the first motion is made together with the second one.
    CornerBlend blend = blend_at(before, after, 0.05, CornerKind::feeds, machine);
    EXPECT_NEAR(blend.turn, 1.05 * 5.0 * 0.2 * std::numbers::pi / 180.0, 1e-12);
    EXPECT_NEAR(blend.deviation, 0.0, 1e-12);
    // With 225 mm/s2 it brakes from 12 mm/s within 0.32 mm.
    machine.axes[3].acceleration = 1000.0;
    blend = blend_at(before, after, 0.05, CornerKind::feeds, machine);
    EXPECT_NEAR(blend.turn, 1.05 * 144.0 / 450.0 * 0.2 * std::numbers::pi / 180.0, 1e-12);
    // Back again, the tolerance limits it.
    const std::vector<Leg> back = {turning_leg(10, 5, 0, 0)};
    blend = blend_at(before, back, 0.001, CornerKind::feeds, machine);
    EXPECT_NEAR(blend.deviation, 8.4e-3, 1e-4);
    EXPECT_NEAR(blend.turn, 4.2e-3 * std::numbers::pi / 180.0, 1e-5);
}

TEST(CornerBlend, LeavesAtLeastWhatThePlannerOfLinuxcncDoesOfATurningMotion) {
    std::ifstream file(FEELER_SOURCE_DIR "/tests/core/linuxcnc_turning_corners.txt");
    size_t corners = 0, close = 0, made_close = 0;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with('#')) continue;
        ++corners;
        std::istringstream words(line);
        Machine machine;
        for (size_t i = 0; i < 4; ++i) {
            double acceleration = 0.0;
            words >> acceleration;
            machine.axes[i].present = true;
            machine.axes[i].acceleration = acceleration;
        }
        double tolerance = 0.0, feeds[2], left = 0.0, made = 0.0;
        words >> tolerance >> feeds[0] >> feeds[1];
        Leg before{.positions = {AxisValues{}, AxisValues{}}}, after = before;
        for (size_t i = 0; i < 4; ++i) words >> before.positions[0][i];
        for (size_t i = 0; i < 4; ++i) words >> after.positions[1][i];
        words >> left >> made;
        ASSERT_TRUE(words) << line;
        const auto time_of = [](const Leg& one, double feed) {
            const double length = length_of({&one, 1});
            return (length > 0.0 ? length : std::abs(one.positions[1][3] - one.positions[0][3]))
                   / feed;
        };
        before.end = time_of(before, feeds[0]);
        after.end = time_of(after, feeds[1]);
        const CornerBlend blend =
            blend_at({&before, 1}, {&after, 1}, tolerance, CornerKind::feeds, machine);
        EXPECT_LE(left, blend.left + 1e-5) << line;
        EXPECT_LE(made, blend.part_after + 1e-5) << line;
        made_close += made > 0.3 * std::min(1.0, blend.part_after);
        close += left > 0.3 * blend.left;
    }
    EXPECT_EQ(corners, 300U);
    EXPECT_GT(close, 100U) << "the bound is not far off";
    EXPECT_GT(made_close, 100U);
}

Motion arc_about(const Vec3& centre, const AxisPosition& from, const AxisPosition& to,
                 double degrees) {
    Motion motion{.kind = MotionKind::arc, .from = from, .to = to, .feed = 600.0};
    motion.arc = ArcPath{.centre = centre, .angle = degrees * std::numbers::pi / 180.0};
    return motion;
}

TEST(CornerBlend, LeavesMoreOfAnArcThanOfALine) {
    // Along an arc, LinuxCNC brakes with half of what the slowest axis can.
    Machine machine = machine_with(5000.0);
    machine.axes[1].acceleration = 300.0;
    machine.axes[3].present = true;
    machine.axes[3].acceleration = 5000.0;
    Motion arc = arc_about(Vec3(0, 0, 0), {0, -50, 0}, {50, 0, 0}, 90.0);
    arc.feed = 4800.0; // 80 mm/s
    arc.from[3] = arc.to[3] = 0.0;
    std::vector<Leg> before = path_of(arc, machine, 1e-3).legs;
    const Leg turn{.positions = {AxisValues{50, 0, 0, 0}, AxisValues{50, 0, 0, 50}}, .end = 1.0};
    const double length = length_of(before);
    // The rest is v^2 / (2 a) with 96 mm/s.
    EXPECT_NEAR(blend_at(before, {&turn, 1}, 0.05, CornerKind::feeds, machine).left,
                std::min(0.525, 1.05 * 96.0 * 96.0 / (2.0 * 0.225 * 300.0) / length), 1e-3);
    for (Leg& leg : before) leg.arc = {}; // its last chord is along Y
    EXPECT_NEAR(blend_at(before, {&turn, 1}, 0.05, CornerKind::feeds, machine).left,
                1.05 * 96.0 * 96.0 / (2.0 * 0.45 * 300.0) / length, 0.02);
}

TEST(CornerBlend, OfFeedsNeedsNoSpeedsOfAxes) {
    Machine machine = machine_with(500.0);
    Leg before = leg({-50, 0, 0}, {0, 0, 0}), after = leg({0, 0, 0}, {0, 50, 0});
    before.end = after.end = 5.0; // 10 mm/s
    const auto blend = [&](CornerKind kind) {
        return blend_at(std::vector{before}, std::vector{after}, 0.05, kind, machine);
    };
    const CornerBlend feeds = blend(CornerKind::feeds), rapids = blend(CornerKind::rapids);
    EXPECT_LT(feeds.reach.after, 1.0);
    for (MachineAxis& axis : machine.axes) axis.rapid.reset();
    EXPECT_EQ(blend(CornerKind::feeds).deviation, feeds.deviation);
    EXPECT_EQ(blend(CornerKind::feeds).reach.after, feeds.reach.after);
    EXPECT_GT(blend(CornerKind::rapids).reach.after, rapids.reach.after);
}

TEST(LinesOfArc, AreTwoChordsWithinTheToleranceAboutZ) {
    const auto lines = [](const Motion& motion, double joining) {
        return lines_of_arc(motion, path_of(motion, Machine(), 1e-3), joining);
    };
    const Motion half = arc_about(Vec3(1, 0, 0), {0, 0, 0}, {2, 0, 4}, -180.0);
    const std::vector<Leg> two = lines(half, 1.01);
    ASSERT_EQ(two.size(), 2U);
    EXPECT_EQ(point(two[0].positions[0]), Vec3(0, 0, 0));
    EXPECT_LT(glm::distance(point(two[0].positions[1]), Vec3(1, 1, 2)), 1e-9);
    EXPECT_EQ(two[0].positions[1], two[1].positions[0]);
    EXPECT_EQ(point(two[1].positions[1]), Vec3(2, 0, 4));
    EXPECT_GT(two[0].end, two[0].begin);
    EXPECT_EQ(two[0].end, two[1].begin);
    EXPECT_EQ(lines(half, 1.0).size(), 2U) << "which of both is not certain";
    EXPECT_TRUE(lines(half, 0.99).empty());
    EXPECT_TRUE(lines(half, 0.0).empty());
    const Motion circle = arc_about(Vec3(1, 0, 0), {0, 0, 0}, {0, 0, 0}, 360.0);
    EXPECT_TRUE(lines(circle, 1.99).empty());
    EXPECT_EQ(lines(circle, 2.01).size(), 2U);
    Motion upright = half;
    upright.arc->normal = 1;
    EXPECT_TRUE(lines(upright, 1.01).empty());
}

/// A position of a straight leg.
AxisValues at(const Leg& leg, double fraction) {
    AxisValues values{};
    for (size_t i = 0; i < axis_count; ++i)
        values[i] = leg.positions[0][i] + fraction * (leg.positions[1][i] - leg.positions[0][i]);
    return values;
}

TEST(DisplacedLegs, ContainAllThatIsMadeWhileTheMotionBeforeEnds) {
    RandomCorners random;
    const auto position = [&] {
        AxisValues values{};
        for (double& value : values) value = random.between(-50.0, 50.0);
        return values;
    };
    for (int corner = 0; corner < 200; ++corner) {
        Leg before{.positions = {position(), position()}};
        const Leg after{.positions = {before.positions[1], position()}};
        before.end = random.between(0.1, 10.0);
        const double part = random.between(0.01, 1.0);
        const std::vector<Leg> rest = last_part({&before, 1}, part);
        ASSERT_EQ(rest.size(), 1U);
        const double from = random.between(0.0, 0.9), to = random.between(from, 1.0);
        const std::vector<Leg> legs =
            displaced({&after, 1}, rest[0], from, to, before.positions[1]);
        for (int point = 0; point < 20; ++point) {
            const double along = random.between(0.0, 1.0);
            const AxisValues now = at(before, 1.0 - part + part * random.between(from, to)),
                             next = at(after, along), seen = at(legs[0], along);
            double square = 0.0, turn = 0.0;
            for (size_t i = 0; i < axis_count; ++i) {
                const double off = now[i] - before.positions[1][i] + next[i] - seen[i];
                if (is_rotary(i))
                    turn += std::abs(off) * std::numbers::pi / 180.0;
                else
                    square += off * off;
            }
            EXPECT_LE(std::sqrt(square), legs[0].path_error + 1e-9);
            EXPECT_LE(turn, legs[0].turn_error + 1e-9);
        }
    }
}

TEST(LastPart, IsThatOfTheTimeOrElseOfTheLength) {
    std::vector<Leg> legs = {leg({0, 0, 0}, {6, 0, 0}), leg({6, 0, 0}, {6, 2, 0})};
    std::vector<Leg> last = last_part(legs, 0.5);
    ASSERT_EQ(last.size(), 2U);
    EXPECT_NEAR(last[0].positions[0][0], 4.0, 1e-12);
    EXPECT_EQ(last[1].positions, legs[1].positions);
    EXPECT_EQ(last_part(legs, 0.1).size(), 1U);
    legs[0].end = legs[1].begin = 1.0;
    legs[1].end = 2.0;
    last = last_part(legs, 0.75);
    ASSERT_EQ(last.size(), 2U);
    EXPECT_NEAR(last[0].positions[0][0], 3.0, 1e-12);
    const Leg turn{.positions = {AxisValues{0, 0, 0, 0}, AxisValues{0, 0, 0, 90}}};
    last = last_part({&turn, 1}, 0.5);
    ASSERT_EQ(last.size(), 1U) << "all of it, because it has neither";
    EXPECT_EQ(last[0].positions, turn.positions);
}

TEST(CornerBlend, CountsFourTimesTheToleranceWithoutAccelerations) {
    EXPECT_NEAR(most_blend_deviation(machine_with(std::nullopt)), 4.2, 1e-12);
    EXPECT_NEAR(most_blend_deviation(machine_with(500.0)), 1.84, 0.01);
    Machine slow_head = machine_with(500.0);
    slow_head.axes[2].acceleration = 50.0;
    EXPECT_GT(most_blend_deviation(slow_head), 2.5);
    EXPECT_LT(most_blend_deviation(slow_head), 4.2);
}

TEST(CornerRegion, EndsAtTheLimits) {
    const StraightCorner path{{0, -100, 0}, {0, 0, 0}, {40, 0, 0}};
    const auto reach = [&](const Limit& limit) {
        const std::vector<AxisValues> at = region_of(path, limit)->hull.positions;
        return std::pair(-at.front()[1], at.back()[0]);
    };
    EXPECT_EQ(reach({1e3}), std::pair(50.0, 20.0)) << "half of either move";
    EXPECT_EQ(reach({5.0, 10.0}), std::pair(10.0, 10.0));
    EXPECT_EQ(reach({50.0, 100.0}), std::pair(100.0, 40.0)) << "the whole moves";
    EXPECT_NEAR(reach({0.1}).first, 0.4 * std::sqrt(2.0), 1e-12);
}

TEST(CornerRegion, IsEmptyWhereNothingIsRounded) {
    const Limit limit{1.0};
    EXPECT_FALSE(region_of({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}}, limit)) << "straight on";
    EXPECT_FALSE(region_of({{0, 0, 0}, {10, 0, 0}, {10, 0, 0}}, limit)) << "no second move";
    EXPECT_FALSE(region_of({{0, 0, 0}, {10, 0, 0}, {10, 9, 0}}, {}));
    EXPECT_TRUE(region_of({{0, 0, 0}, {10, 0, 0}, {0, 0, 0}}, limit)) << "a reversal";
}

TEST(CornerRegion, HasNoHullWhereRotaryAxesTurn) {
    Leg turning = leg({10, 0, 0}, {10, 10, 0});
    turning.positions[1][3] = 90.0;
    const std::vector<Leg> before = {leg({0, 0, 0}, {10, 0, 0})}, after = {turning};
    const auto region = corner_region(before, after, 1.0);
    ASSERT_TRUE(region);
    EXPECT_TRUE(region->hull.positions.empty());
}

} // namespace
} // namespace core
