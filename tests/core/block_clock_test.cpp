#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "core/sim/run/block_clock.h"
#include "core/sim/run/simulator.h"
#include "tests/support/machines.h"

namespace core {
namespace {

constexpr double pi = std::numbers::pi;

Machine mill(double acceleration, double rapid = 12'000.0) {
    Machine machine;
    for (size_t i = 0; i < 3; ++i) {
        machine.axes[i].rapid = rapid;
        machine.axes[i].acceleration = acceleration;
    }
    return machine;
}

AxisPosition at(const Vec3& p) {
    AxisPosition position{};
    for (int i = 0; i < 3; ++i) position[static_cast<size_t>(i)] = p[i];
    return position;
}

Motion feed(const Vec3& from, const Vec3& to, double rate) {
    return {.kind = MotionKind::feed, .from = at(from), .to = at(to), .arc = {}, .feed = rate};
}

Motion rapid(const Vec3& from, const Vec3& to) {
    return {.kind = MotionKind::rapid, .from = at(from), .to = at(to), .arc = {}};
}

std::vector<BlockTime> times_of(const Machine& machine,
                                const std::vector<std::vector<Event>>& blocks) {
    BlockClock clock = start_clock(machine);
    std::vector<BlockTime> done;
    for (size_t i = 0; i < blocks.size(); ++i)
        add_block(clock, {BlockIndex{static_cast<uint32_t>(i)}, false, blocks[i]}, done);
    stop_clock(clock, done);
    return done;
}

TEST(BlockClock, GivesEveryBlockATime) {
    const auto times = times_of(mill(1000), {{},
                                             {feed({0, 0, 0}, {100, 0, 0}, 6000)},
                                             {},
                                             {Dwell{2.5}},
                                             {rapid({100, 0, 0}, {100, 0, 40})},
                                             {SpindleChange{}}});
    ASSERT_EQ(times.size(), 6u);
    const double expected[] = {0.0, 1.1, 0.0, 2.5, 0.2 + 0.2, 0.0};
    double now = 0.0;
    for (size_t i = 0; i < times.size(); ++i) {
        EXPECT_EQ(times[i].block, BlockIndex{static_cast<uint32_t>(i)});
        EXPECT_NEAR(times[i].duration, expected[i], 1e-12) << i;
        EXPECT_NEAR(times[i].start, now, 1e-12) << i;
        now += expected[i];
    }
}

TEST(BlockClock, StopsForDwellsToolsAndTheSpindle) {
    const Motion first = feed({0, 0, 0}, {10, 0, 0}, 6000),
                 second = feed({10, 0, 0}, {20, 0, 0}, 6000);
    const auto duration = [&](const std::vector<Event>& between) {
        double sum = 0.0;
        for (const BlockTime& time : times_of(mill(1000), {{first}, between, {second}}))
            sum += time.duration;
        return sum;
    };
    EXPECT_NEAR(duration({}), 0.2 + 0.1, 1e-12);
    EXPECT_NEAR(duration({LengthOffsetChange{}}), 0.2 + 0.1, 1e-12);
    EXPECT_NEAR(duration({ToolChange{}}), 0.4, 1e-12);
    EXPECT_NEAR(duration({SpindleChange{}}), 0.4, 1e-12);
    EXPECT_NEAR(duration({Dwell{1.0}}), 1.4, 1e-12);
    EXPECT_NEAR(duration({PathModeChange{Blending::exact_stop, {}}}), 0.4, 1e-12);
    EXPECT_NEAR(duration({PathModeChange{Blending::exact_path, {}}}), 0.3, 1e-12);
}

TEST(BlockClock, RoundsCornersByTheStatedTolerance) {
    const auto duration = [&](std::optional<double> tolerance) {
        return times_of(mill(1000), {{PathModeChange{Blending::continuous, tolerance}},
                                     {feed({0, 0, 0}, {10, 0, 0}, 6000)},
                                     {feed({10, 0, 0}, {10, 10, 0}, 6000)}})[1]
            .duration;
    };
    // v^2 = 8 P a / sqrt 2 at a right angle with equal axes, from 100 mm/s.
    const auto expected = [](double tolerance) {
        const double v = std::sqrt(8.0 * tolerance * 1000.0 / std::sqrt(2.0));
        return 0.1 + (100.0 - v) / 1000.0 + (10.0 - 5.0 - (10'000.0 - v * v) / 2000.0) / 100.0;
    };
    EXPECT_NEAR(duration(0.01), expected(0.01), 1e-9);
    EXPECT_NEAR(duration({}), expected(default_blend_tolerance), 1e-9);
}

TEST(BlockClock, CountsFullSpeedWhereNoAccelerationIsStated) {
    const auto times =
        times_of({}, {{feed({0, 0, 0}, {30, 40, 0}, 600)}, {rapid({30, 40, 0}, {30, 40, 100})}});
    EXPECT_NEAR(times[0].duration, 5.0, 1e-12);
    EXPECT_NEAR(times[1].duration, 100.0 / assumed_rapid * 60.0, 1e-12);
}

TEST(BlockClock, RunsTheAxesOfADogLegOneByOne) {
    Machine machine = mill(1000);
    machine.rapid = RapidStyle::dogleg;
    const auto times = times_of(machine, {{rapid({0, 0, 0}, {100, 3, 0})}});
    EXPECT_NEAR(times[0].duration, 100.0 / 200.0 + 200.0 / 1000.0, 1e-12);
    const auto both =
        times_of(machine, {{feed({0, 0, 0}, {100, 0, 0}, 6000)}, {rapid({100, 0, 0}, {0, 0, 0})}});
    EXPECT_NEAR(both[0].duration, 1.1, 1e-12);
}

TEST(BlockClock, PutsWitnessesWhereTheyArePassed) {
    const auto times = times_of(mill(1000), {{feed({0, 0, 0}, {100, 0, 0}, 6000), Dwell{1.0},
                                              feed({100, 0, 0}, {0, 0, 0}, 12'000)}});
    // At full speed: 1 s there, 1 s of waiting, 0.5 s back; then 1.1, 1 and 0.7.
    const BlockTime& time = times[0];
    EXPECT_NEAR(time.duration, 1.1 + 1.0 + 0.7, 1e-12);
    EXPECT_NEAR(time.moment(0.5 / 2.5), 0.55, 1e-12);
    EXPECT_NEAR(time.moment(1.5 / 2.5), 1.6, 1e-12);
    EXPECT_NEAR(time.moment(2.25 / 2.5), 2.1 + 0.35, 1e-12);
    EXPECT_NEAR(time.moment(1.0), 2.8, 1e-12);
    BlockResult result;
    result.duration = 2.5;
    result.pairs.push_back({.time = 1.5});
    settle_time(result, time);
    EXPECT_NEAR(result.pairs[0].time, 1.6, 1e-12);
    EXPECT_NEAR(result.duration, 2.8, 1e-12);
}

/// Runs a motion from rest to rest, samples its axes finely, and expects that none exceeds its
/// speed or acceleration. Returns the largest fraction of its acceleration that an axis used.
double drive(const Motion& motion, const Machine& machine,
             const std::function<AxisValues(double)>& position_of) {
    const auto path = path_motion(motion, machine);
    EXPECT_TRUE(path);
    if (!path) return 0.0;
    TimePlan plan{.limits = limits_of(machine), .waiting = {}, .last = {}};
    std::vector<MotionTime> done;
    add_motion(plan, *path, 0, done);
    plan_stop(plan, done);
    constexpr int steps = 2000;
    std::vector<double> when;
    std::vector<AxisValues> where;
    for (int k = 0; k <= steps; ++k) {
        const double fraction = 0.5 * (1.0 - std::cos(pi * k / steps)); // finer at the ends
        when.push_back(done[0].moment(fraction * path->length));
        where.push_back(position_of(fraction));
    }
    EXPECT_NEAR(done[0].moment(path->length), done[0].duration, 1e-9);
    double used = 0.0;
    for (size_t k = 2; k < when.size(); ++k) {
        const double t1 = when[k - 1] - when[k - 2], t2 = when[k] - when[k - 1];
        for (size_t i = 0; i < axis_count; ++i) {
            const MachineAxis& axis = machine.axes[i];
            if (!axis.present) continue;
            const double v1 = (where[k - 1][i] - where[k - 2][i]) / t1;
            const double v2 = (where[k][i] - where[k - 1][i]) / t2;
            const double a = std::abs(v2 - v1) / (0.5 * (t1 + t2));
            EXPECT_LE(a, *axis.acceleration * 1.01) << i << ' ' << k;
            EXPECT_LE(std::abs(v2), *axis.rapid / 60.0 * (1.0 + 1e-6)) << i;
            used = std::max(used, a / *axis.acceleration);
        }
    }
    return used;
}

TEST(PathMotion, DrivesArcsWithinTheLimitsOfEveryAxis) {
    std::mt19937_64 random(11);
    const auto between = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random() >> 11U) * 0x1p-53);
    };
    double tightest = 0.0;
    for (int round = 0; round < 200; ++round) {
        Machine machine = mill(1000);
        for (size_t i = 0; i < 3; ++i) {
            machine.axes[i].acceleration = between(300, 3000);
            machine.axes[i].rapid = between(3000, 20'000);
        }
        const int normal = static_cast<int>(random() % 3);
        const double radius = between(0.5, 40), angle = between(-7, 7), start = between(-4, 4);
        const double growth = round % 4 == 0 ? between(0.7, 1.4) : 1.0, rise = between(-5, 5);
        const auto position_of = [&](double fraction) {
            Vec3 p(1, 2, 3);
            const double r = radius * (1.0 + fraction * (growth - 1.0));
            p[(normal + 1) % 3] += r * std::cos(start + fraction * angle);
            p[(normal + 2) % 3] += r * std::sin(start + fraction * angle);
            p[normal] += fraction * rise;
            return p;
        };
        Motion motion = feed(position_of(0), position_of(1), between(500, 20'000));
        motion.kind = MotionKind::arc;
        motion.arc = ArcPath{normal, {1, 2, 3}, angle};
        tightest = std::max(tightest, drive(motion, machine, [&](double fraction) {
                                const Vec3 p = position_of(fraction);
                                return AxisValues{p.x, p.y, p.z};
                            }));
    }
    EXPECT_GT(tightest, 0.95);
}

TEST(PathMotion, DrivesTheTipWithinTheLimitsOfEveryAxis) {
    std::mt19937_64 random(12);
    const auto between = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random() >> 11U) * 0x1p-53);
    };
    double tightest = 0.0;
    for (int round = 0; round < 100; ++round) {
        Machine machine = test_support::trunnion({0, 0, -300}, {20, 10, -300});
        for (MachineAxis& axis : machine.axes) {
            axis.acceleration = between(300, 3000);
            axis.rapid = between(3000, 20'000);
        }
        const double tool_length = between(50, 150);
        const auto anywhere = [&] {
            return Vec3(between(-50, 50), between(-50, 50), between(-250, -200));
        };
        const Vec3 from = anywhere(), to = from + between(0.01, 1.0) * (anywhere() - from);
        AxisValues first{}, last{};
        for (const size_t rotary : {size_t{3}, size_t{5}}) {
            first[rotary] = between(-60, 60);
            last[rotary] = first[rotary] + between(-40, 40);
        }
        const auto position_of = [&](double fraction) {
            AxisValues turned = first;
            for (size_t i = 3; i < 6; ++i) turned[i] += fraction * (last[i] - first[i]);
            return *reach_tip(machine, turned, from + fraction * (to - from), tool_length);
        };
        Motion motion{.kind = MotionKind::feed, .feed = between(500, 20'000)};
        motion.tip = TipPath{from, to, tool_length};
        for (size_t i = 0; i < axis_count; ++i) {
            motion.from[i] = position_of(0)[i];
            motion.to[i] = position_of(1)[i];
        }
        tightest = std::max(tightest, drive(motion, machine, position_of));
    }
    EXPECT_GT(tightest, 0.8);
}

TEST(PathMotion, KnowsNothingOfAMotionFromAnywhere) {
    Motion motion = feed({0, 0, 0}, {1, 0, 0}, 100);
    motion.from[0].reset();
    EXPECT_FALSE(path_motion(motion, mill(1000)));
    motion = feed({0, 0, 0}, {0, 0, 0}, 100);
    EXPECT_FALSE(path_motion(motion, mill(1000)));
}

} // namespace
} // namespace core
