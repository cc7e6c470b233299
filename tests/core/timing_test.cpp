#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "core/motion/timing.h"
#include "tests/support/timing_oracle.h"

namespace core {
namespace {

constexpr double pi = std::numbers::pi;

MachineLimits even_limits(double speed, double acceleration) {
    MachineLimits limits;
    limits.fill({speed, acceleration});
    return limits;
}

PathMotion line(const Vec3& by, double speed) {
    const double length = glm::length(by);
    PathMotion motion{.length = length, .speed = speed};
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<size_t>(i);
        motion.start[k] = motion.end[k] = by[i] / length;
        motion.fastest[k] = std::abs(by[i] / length);
    }
    return motion;
}

/// A line along X, then one of the same length at an angle to it.
std::vector<PathMotion> corner(double length, double angle_deg, double speed) {
    const double angle = angle_deg * pi / 180.0;
    return {line({length, 0, 0}, speed),
            line(length * Vec3(std::cos(angle), std::sin(angle), 0), speed)};
}

std::vector<MotionTime> times_of(TimePlan plan, const std::vector<PathMotion>& motions) {
    std::vector<MotionTime> done;
    for (size_t i = 0; i < motions.size(); ++i)
        add_motion(plan, motions[i], static_cast<uint32_t>(i), done);
    plan_stop(plan, done);
    return done;
}

double total(const std::vector<MotionTime>& times) {
    double sum = 0.0;
    for (const MotionTime& time : times) sum += time.duration;
    return sum;
}

TimePlan plan_of(const MachineLimits& limits, Blending blending = Blending::continuous,
                 double tolerance = 0.01) {
    return {
        .limits = limits, .blending = blending, .tolerance = tolerance, .waiting = {}, .last = {}};
}

TEST(Timing, GivesALongMoveItsTrapezoid) {
    const auto times = times_of(plan_of(even_limits(500, 1000)), {line({100, 0, 0}, 100)});
    ASSERT_EQ(times.size(), 1u);
    EXPECT_NEAR(times[0].duration, 100.0 / 100.0 + 100.0 / 1000.0, 1e-12);
    EXPECT_DOUBLE_EQ(times[0].cruise, 100.0);
}

TEST(Timing, GivesAShortMoveItsTriangle) {
    const auto times = times_of(plan_of(even_limits(500, 1000)), {line({1, 0, 0}, 100)});
    EXPECT_NEAR(times[0].duration, 2.0 * std::sqrt(1.0 / 1000.0), 1e-12);
    EXPECT_NEAR(times[0].cruise, std::sqrt(1000.0), 1e-9);
}

TEST(Timing, RunsAtFullSpeedWhereNoAccelerationIsKnown) {
    const auto times = times_of(plan_of(even_limits(500, infinity)), corner(10, 90, 100));
    EXPECT_EQ(times[0].duration, 0.1);
    EXPECT_EQ(times[1].duration, 0.1);
}

TEST(Timing, ObeysTheAxisThatIsSlowest) {
    MachineLimits limits = even_limits(500, 1000);
    limits[2] = {50, 200};
    // Along (3, 0, 4) / 5: Z allows a speed of 50 / 0.8 along the path, and an acceleration of 200
    // / 0.8.
    const auto times = times_of(plan_of(limits), {line({60, 0, 80}, 400)});
    EXPECT_NEAR(times[0].duration, 100.0 / 62.5 + 62.5 / 250.0, 1e-12);
}

TEST(Timing, StopsAtEveryEndUnderExactStop) {
    const auto times =
        times_of(plan_of(even_limits(500, 1000), Blending::exact_stop), corner(20, 0, 100));
    EXPECT_NEAR(times[0].duration, 0.2 + 0.1, 1e-12);
    EXPECT_NEAR(times[1].duration, 0.2 + 0.1, 1e-12);
}

TEST(Timing, PassesAStraightJointWithoutSlowingDown) {
    for (const Blending blending : {Blending::exact_path, Blending::continuous}) {
        const auto times = times_of(plan_of(even_limits(500, 1000), blending), corner(20, 0, 100));
        EXPECT_NEAR(total(times), 40.0 / 100.0 + 0.1, 1e-12);
        EXPECT_DOUBLE_EQ(times[0].leave, 100.0);
    }
}

TEST(Timing, KeepsToExactCornersWithinAJumpOfOneCycle) {
    const auto times =
        times_of(plan_of(even_limits(500, 1000), Blending::exact_path), corner(20, 90, 100));
    EXPECT_NEAR(times[0].leave, 1000 * control_cycle, 1e-12);
}

/// Corners of several angles, all with enough space for rounding.
TEST(Timing, RoundsCornersAsFastAsToleranceAndAxesAllow) {
    const double a = 1000.0, tolerance = 0.01, feed = 100.0, length = 20.0;
    const auto ramp = [&](double v, double path_a) {
        const double up = (feed * feed - v * v) / (2 * path_a), down = feed * feed / (2 * path_a);
        return (feed - v) / path_a + feed / path_a + (length - up - down) / feed;
    };
    for (const double degrees : {30.0, 60.0, 90.0, 120.0, 135.0, 180.0}) {
        const double angle = degrees * pi / 180.0;
        const double turn = 2.0 * std::sin(angle / 2.0);
        const double steepest = std::max(1.0 - std::cos(angle), std::sin(angle));
        // The parabola with acceleration a/steepest * turn along the bisector misses the corner by
        // turn^2 v^2 / (8 times that acceleration).
        const double bisector = a / steepest * turn;
        const double v = std::sqrt(8.0 * tolerance * bisector) / turn;
        const auto times = times_of(plan_of(even_limits(500, a), Blending::continuous, tolerance),
                                    corner(length, degrees, feed));
        EXPECT_NEAR(times[0].leave, v, 1e-9) << degrees;
        EXPECT_NEAR(times[0].duration, ramp(v, a), 1e-9) << degrees;
        const double along = a / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
        EXPECT_NEAR(times[1].duration, ramp(v, along), 1e-9) << degrees;
    }
}

TEST(Timing, LeavesHalfOfAShortMotionToEachOfItsCorners) {
    // A tolerance that is never reached: the parabola begins half a length before the corner.
    const auto times = times_of(plan_of(even_limits(500, 1000), Blending::continuous, 100.0),
                                corner(0.2, 90, 100));
    EXPECT_NEAR(times[0].leave, std::sqrt(0.2 * 1000.0), 1e-9);
}

/// A full circle of radius r in the plane.
PathMotion circle(double r, double speed) {
    PathMotion motion{.length = 2.0 * pi * r, .speed = speed};
    motion.start[1] = motion.end[1] = 1.0;
    motion.fastest[0] = motion.fastest[1] = 1.0;
    motion.bend[0] = motion.bend[1] = 1.0 / r;
    return motion;
}

TEST(Timing, SlowsDownOnATightCircle) {
    const double r = 10.0, v = std::sqrt(std::sqrt(3.0) / 2.0 * 1000.0 * r);
    const auto times = times_of(plan_of(even_limits(500, 1000)), {circle(r, 200)});
    EXPECT_NEAR(times[0].cruise, v, 1e-9);
    EXPECT_NEAR(times[0].duration, 2.0 * pi * r / v + v / 500.0, 1e-9);
}

TEST(Timing, KeepsItsSpeedOnAWideCircle) {
    const auto times = times_of(plan_of(even_limits(500, 1000)), {circle(50, 100)});
    EXPECT_NEAR(times[0].duration, 2.0 * pi * 50.0 / 100.0 + 100.0 / 500.0, 1e-9);
}

TEST(Timing, EntersATangentArcWithoutAStop) {
    std::vector<PathMotion> motions = {line({0, 50, 0}, 80), circle(10, 80), line({0, 50, 0}, 80)};
    const auto times = times_of(plan_of(even_limits(500, 1000), Blending::exact_path), motions);
    EXPECT_NEAR(total(times), (100.0 + 20.0 * pi) / 80.0 + 80.0 / 1000.0, 1e-9);
}

TEST(Timing, GivesTheMomentAtWhichAPointIsReached) {
    const auto times = times_of(plan_of(even_limits(500, 1000)), {line({100, 0, 0}, 100)});
    EXPECT_NEAR(times[0].moment(0.0), 0.0, 1e-12);
    EXPECT_NEAR(times[0].moment(1.25), std::sqrt(2.0 * 1.25 / 1000.0), 1e-12);
    EXPECT_NEAR(times[0].moment(50.0), 0.55, 1e-12);
    EXPECT_NEAR(times[0].moment(98.75), 1.1 - std::sqrt(2.0 * 1.25 / 1000.0), 1e-12);
    EXPECT_NEAR(times[0].moment(100.0), 1.1, 1e-12);
}

/// A random program: lines of all lengths, some continuing straight, some reversing, and circles.
struct RandomPath {
    std::mt19937_64 random;
    MachineLimits limits;
    std::vector<PathMotion> motions;

    explicit RandomPath(uint64_t seed, size_t count) : random(seed) {
        for (AxisLimits& axis : limits) axis = {between(50, 400), between(300, 3000)};
        Vec3 way(1, 0, 0);
        for (size_t i = 0; i < count; ++i) {
            const double speed = std::exp(between(std::log(2.0), std::log(500.0)));
            const double kind = between(0, 1);
            if (kind > 0.3) way = glm::normalize(way + between(0.0, 1.0) * anywhere());
            if (kind > 0.95) way = -way;
            if (kind > 0.9)
                motions.push_back(circle(between(0.2, 30.0), speed));
            else
                motions.push_back(line(std::exp(between(-5.0, 4.0)) * way, speed));
        }
    }
    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(random() >> 11U) * 0x1p-53);
    }
    Vec3 anywhere() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
};

constexpr Blending all_modes[] = {Blending::exact_stop, Blending::exact_path, Blending::continuous};

TEST(Timing, FindsTheFastestWay) {
    size_t passing = 0;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        RandomPath path(seed, 40);
        const TimePlan plan = plan_of(path.limits, all_modes[seed % 3], path.between(0.001, 0.1));
        std::vector<test_support::SpeedPiece> pieces;
        for (size_t i = 0; i < path.motions.size(); ++i)
            pieces.push_back(
                {path.motions[i].length, path_acceleration(path.limits, path.motions[i]),
                 cruise_speed(path.limits, path.motions[i]),
                 i == 0 ? 0.0 : corner_speed(plan, path.motions[i - 1], path.motions[i])});
        const auto slow = test_support::fastest_times(pieces, 2000);
        const auto times = times_of(plan, path.motions);
        ASSERT_EQ(times.size(), slow.size());
        for (size_t i = 0; i < slow.size(); ++i)
            EXPECT_NEAR(times[i].duration, slow[i], 2e-3 * slow[i] + 1e-9) << seed << ' ' << i;
        EXPECT_NEAR(total(times), std::accumulate(slow.begin(), slow.end(), 0.0),
                    1e-3 * total(times));
        for (const MotionTime& time : times) passing += time.leave > 1.0;
    }
    EXPECT_GT(passing, 300u);
}

TEST(Timing, IsNeverFasterThanFeedOrAxes) {
    for (uint64_t seed = 1; seed <= 60; ++seed) {
        RandomPath path(seed, 700);
        const TimePlan plan = plan_of(path.limits, all_modes[seed % 3]);
        const auto times = times_of(plan, path.motions);
        ASSERT_EQ(times.size(), path.motions.size());
        double speed = 0.0;
        for (size_t i = 0; i < times.size(); ++i) {
            const MotionTime& time = times[i];
            const PathMotion& motion = path.motions[i];
            ASSERT_EQ(time.tag, i);
            ASSERT_EQ(time.enter, speed);
            speed = time.leave;
            const double a = time.acceleration, top = time.cruise;
            ASSERT_GE(top, std::max(time.enter, time.leave));
            ASSERT_LE(top, motion.speed * (1.0 + 1e-12));
            for (size_t k = 0; k < motion.fastest.size(); ++k) {
                ASSERT_LE(top * motion.fastest[k], path.limits[k].speed * (1.0 + 1e-9));
                ASSERT_LE(std::hypot(a * motion.fastest[k], top * top * motion.bend[k]),
                          path.limits[k].acceleration * (1.0 + 1e-9));
            }
            // The length covered at these speeds in the time.
            const double up = (top - time.enter) / a, down = (top - time.leave) / a;
            const double covered = 0.5 * (time.enter + top) * up + 0.5 * (time.leave + top) * down
                                   + top * (time.duration - up - down);
            ASSERT_NEAR(covered, motion.length, 1e-9 * motion.length + 1e-12);
            ASSERT_GE(time.duration - up - down, -1e-9);
        }
        EXPECT_EQ(speed, 0.0);
    }
}

TEST(Timing, IsNeverSlowerThanStoppingAtEveryBlock) {
    for (uint64_t seed = 1; seed <= 60; ++seed) {
        RandomPath path(seed, 700);
        const auto stopping = times_of(plan_of(path.limits, Blending::exact_stop), path.motions);
        for (const Blending blending : {Blending::exact_path, Blending::continuous}) {
            const auto times = times_of(plan_of(path.limits, blending), path.motions);
            for (size_t i = 0; i < times.size(); ++i)
                ASSERT_LE(times[i].duration, stopping[i].duration * (1.0 + 1e-12));
            ASSERT_LT(total(times), total(stopping));
        }
    }
}

TEST(Timing, KeepsRoundedCornersWithinToleranceAndAxes) {
    size_t jumps = 0, rounded = 0;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        RandomPath path(seed, 200);
        const TimePlan plan = plan_of(path.limits, Blending::continuous, 0.02);
        for (size_t i = 1; i < path.motions.size(); ++i) {
            const PathMotion &before = path.motions[i - 1], &after = path.motions[i];
            const double v = corner_speed(plan, before, after);
            if (v == infinity) continue;
            double sharpness = 0.0;
            for (size_t k = 0; k < 9; ++k)
                sharpness = std::max(sharpness, std::abs(after.start[k] - before.end[k])
                                                    / path.limits[k].acceleration);
            if (v * sharpness <= control_cycle * (1.0 + 1e-12)) {
                ++jumps;
                continue;
            }
            ++rounded;
            const bool curved = before.bend[0] + after.bend[0] > 0.0;
            const double lasts = v * sharpness * (curved ? 2.0 : 1.0);
            const auto seen = test_support::run_corner(before.end, after.start, v, lasts);
            EXPECT_LE(seen.missed, 0.02 * (1.0 + 1e-3) + v * lasts / 2000.0);
            EXPECT_LE(seen.length, 0.5 * std::min(before.length, after.length) * (1.0 + 1e-9));
            for (size_t k = 0; k < 9; ++k)
                EXPECT_LE(seen.acceleration[k] + v * v * std::max(before.bend[k], after.bend[k]),
                          path.limits[k].acceleration * (1.0 + 1e-6));
        }
    }
    EXPECT_GT(jumps, 50u);
    EXPECT_GT(rounded, 300u);
}

/// Hundreds of tiny blocks, so that the known future is too short to brake from the feed rate.
TEST(Timing, LooksAheadNoFartherThanItsWindow) {
    const std::vector<PathMotion> motions(4 * look_ahead, line({0.01, 0, 0}, 400));
    const auto times = times_of(plan_of(even_limits(500, 1000)), motions);
    const double within = std::sqrt(2.0 * 1000.0 * 0.01 * look_ahead);
    double fastest = 0.0;
    for (const MotionTime& time : times) fastest = std::max(fastest, time.leave);
    EXPECT_NEAR(fastest, within, 1e-6);
    EXPECT_EQ(times.back().leave, 0.0);
}

TEST(Timing, DoesNotDependOnHowBlocksAreFed) {
    RandomPath path(5, 2000);
    const TimePlan plan = plan_of(path.limits);
    const auto whole = times_of(plan, path.motions);
    TimePlan going = plan;
    std::vector<MotionTime> piecewise;
    for (size_t i = 0; i < path.motions.size(); ++i) {
        TimePlan copy = going; // state left by looking ahead must not count
        std::vector<MotionTime> thrown_away;
        if (i % 97 == 0) plan_stop(copy, thrown_away);
        std::vector<MotionTime> done;
        add_motion(going, path.motions[i], static_cast<uint32_t>(i), done);
        EXPECT_EQ(done.size(), i < look_ahead ? 0u : 1u);
        piecewise.insert(piecewise.end(), done.begin(), done.end());
        EXPECT_LE(going.waiting.size(), look_ahead);
    }
    plan_stop(going, piecewise);
    ASSERT_EQ(piecewise.size(), whole.size());
    for (size_t i = 0; i < whole.size(); ++i) {
        EXPECT_EQ(piecewise[i].duration, whole[i].duration);
        EXPECT_EQ(piecewise[i].leave, whole[i].leave);
    }
}

} // namespace
} // namespace core
