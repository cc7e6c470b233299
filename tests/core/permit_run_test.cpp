#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/sim/run/permit_run.h"

namespace core {
namespace {

/// A random path in the plane at the machine's limits, with occasional stops.
std::vector<PermitMotion> random_plan(std::mt19937& random, size_t count) {
    std::uniform_real_distribution<double> any(0.0, 1.0);
    TimePlan plan;
    plan.limits.fill({300.0, 500.0 + 4000.0 * any(random)});
    std::vector<MotionTime> times;
    double heading = 0.0;
    for (size_t i = 0; i < count; ++i) {
        if (any(random) < 0.03) {
            plan_stop(plan, times);
            MotionTime pause;
            pause.duration = 0.2 * any(random);
            times.push_back(pause);
            continue;
        }
        heading += any(random) < 0.8 ? 0.3 * (any(random) - 0.5) : 6.0 * any(random);
        PathMotion motion;
        motion.length = any(random) < 0.7 ? 0.05 + any(random) : 30.0 * any(random) + 1.0;
        motion.speed = 10.0 + 200.0 * any(random);
        motion.start[0] = motion.end[0] = std::cos(heading);
        motion.start[1] = motion.end[1] = std::sin(heading);
        for (size_t axis = 0; axis < 2; ++axis) motion.fastest[axis] = std::abs(motion.start[axis]);
        add_motion(plan, motion, 0, times);
    }
    plan_stop(plan, times);
    std::vector<PermitMotion> motions;
    for (const MotionTime& time : times)
        motions.push_back({time, static_cast<uint32_t>(motions.size())});
    return motions;
}

/// Number of permits at a time, given when each becomes known, in order.
uint32_t permitted_at(const std::vector<double>& known, double time) {
    uint32_t count = 0;
    while (count < known.size() && known[count] <= time + 1e-12) ++count;
    return count;
}

double planned_time(const PermitRun& run) { return run.times.back() / run.servo.feed; }

PermitRun finished(const std::vector<PermitMotion>& motions, const ServoTiming& servo,
                   const std::vector<double>& known) {
    PermitRun run = permit_run(motions, servo);
    size_t given = 0;
    while (!run.is_done() && run.time() < 1e4) {
        while (given < known.size() && known[given] <= run.time() + 1e-12) ++given;
        step(run, static_cast<uint32_t>(given));
    }
    return run;
}

class RandomPermitRun : public testing::TestWithParam<unsigned> {
protected:
    std::mt19937 random{GetParam()};
    std::vector<PermitMotion> motions = random_plan(random, 300);
    ServoTiming servo{.period = 0.001, .latency = 0.002, .feed = GetParam() % 3 == 0 ? 0.6 : 1.0};
};

TEST_P(RandomPermitRun, KeepsToItsPlanWhilePermitsAreThere) {
    const PermitRun run = finished(motions, servo, std::vector<double>(motions.size(), 0.0));
    EXPECT_GE(run.time(), planned_time(run) - 1e-9);
    EXPECT_LE(run.time(), planned_time(run) + 1.001 * servo.period);
    for (size_t i = 0; i < motions.size(); ++i) {
        EXPECT_NEAR(run.entries[i].entered, run.times[i] / servo.feed, 1e-9) << i;
        EXPECT_LE(run.entries[i].due, run.entries[i].entered + (i == 0 ? infinity : 1e-9)) << i;
    }
}

TEST_P(RandomPermitRun, PermitsAtTheLastMomentCostNoTime) {
    const PermitRun early = finished(motions, servo, std::vector<double>(motions.size(), 0.0));
    std::vector<double> known = {0.0};
    for (size_t i = 1; i < motions.size(); ++i)
        known.push_back(std::max(known.back(), early.entries[i].due));
    const PermitRun run = finished(motions, servo, known);
    EXPECT_EQ(run.ticks, early.ticks);
    for (size_t i = 0; i < motions.size(); ++i) {
        EXPECT_LE(run.entries[i].seen, run.entries[i].due) << i;
        EXPECT_EQ(run.entries[i].entered, early.entries[i].entered) << i;
    }
}

TEST_P(RandomPermitRun, EntersNothingWithoutAPermitAndBrakesNoHarderThanItsAxesCan) {
    std::uniform_real_distribution<double> any(0.0, 1.0);
    std::vector<double> known;
    double at = 0.0, hardest = 0.0;
    for (const PermitMotion& motion : motions) {
        at += 1.3 * any(random) * motion.time.duration + (any(random) < 0.02 ? 0.3 : 0.0);
        known.push_back(at);
        if (std::isfinite(motion.time.acceleration))
            hardest = std::max(hardest, motion.time.acceleration);
    }
    PermitRun run = permit_run(motions, servo);
    double before = 0.0, position = 0.0;
    size_t held = 0;
    while (!run.is_done()) {
        ASSERT_LT(run.time(), 1e4) << "it continues by itself";
        const uint32_t permitted = permitted_at(known, run.time());
        step(run, permitted);
        ASSERT_LE(run.position(), run.starts[permitted] + 1e-9);
        ASSERT_GE(run.position(), position - 1e-9) << "never back";
        const double speed = run.speed_now();
        const double change = std::abs(speed - before) / servo.period;
        ASSERT_LE(change, 2.1 * hardest) << run.time();
        ASSERT_LE(run.position() - position, 1.01 * std::max(before, speed) * servo.period + 1e-6
                                                 + 0.5 * hardest * servo.period * servo.period);
        before = speed;
        position = run.position();
        held += run.is_held();
    }
    EXPECT_GT(held, 0U);
    size_t late = 0;
    for (size_t i = 0; i < motions.size(); ++i) {
        EXPECT_GE(run.entries[i].entered, known[i] - 1e-9) << i;
        EXPECT_GE(run.entries[i].entered, run.times[i] / servo.feed - 1e-9) << i;
        late += run.entries[i].seen > run.entries[i].due;
    }
    EXPECT_GT(late, 0U);
    EXPECT_GT(run.time(), planned_time(run));
}

TEST_P(RandomPermitRun, StopsBeforeWhatIsNeverPermitted) {
    const size_t last = motions.size() / 2;
    PermitRun run = permit_run(motions, servo);
    while (run.time() < planned_time(run) + 5.0) step(run, static_cast<uint32_t>(last));
    EXPECT_TRUE(run.is_held());
    EXPECT_EQ(run.motion, last);
    EXPECT_EQ(run.speed_now(), 0.0);
    EXPECT_EQ(run.position(), run.starts[last]);
    EXPECT_EQ(run.entries[last].entered, infinity);
}

TEST_P(RandomPermitRun, ACopyContinuesLikeTheOriginal) {
    PermitRun run = permit_run(motions, servo);
    for (int i = 0; i < 500; ++i) step(run, static_cast<uint32_t>(i / 3));
    PermitRun copy = run;
    for (int i = 500; i < 900; ++i) {
        step(run, static_cast<uint32_t>(i / 3));
        step(copy, static_cast<uint32_t>(i / 3));
    }
    EXPECT_EQ(copy.position(), run.position());
    EXPECT_EQ(copy.speed_now(), run.speed_now());
}

INSTANTIATE_TEST_SUITE_P(Many, RandomPermitRun, testing::Range(1U, 21U));

TEST(PermitRun, APermitIsDueWhereItCanStillStop) {
    // 100 mm/s, 1000 mm/s2: 5 mm to stop, 0.5 mm for three periods and the latency.
    MotionTime there{
        .duration = 1.05, .length = 100.0, .cruise = 100.0, .leave = 100.0, .acceleration = 1000.0};
    MotionTime on{
        .duration = 1.05, .length = 100.0, .enter = 100.0, .cruise = 100.0, .acceleration = 1000.0};
    PermitRun run = permit_run({{there, 0}, {on, 1}}, {.period = 0.001, .latency = 0.002});
    while (!run.is_done()) step(run, 2);
    EXPECT_NEAR(run.entries[1].due, 0.1 + (100.0 - 5.0 - 5.5) / 100.0, 0.0011);
    EXPECT_NEAR(run.entries[1].entered, 1.05, 1e-9);
}

TEST(PermitRun, GoesFromOneHoldToTheNextAsItsAxesCan) {
    // 10 mm from rest to rest: 0.2 s at 1000 mm/s2.
    const MotionTime hop{.duration = 0.2, .length = 10.0, .cruise = 100.0, .acceleration = 1000.0};
    PermitRun run = permit_run({{hop, 0}, {hop, 1}, {hop, 2}}, {});
    double before = 0.0;
    while (!run.is_done()) {
        step(run, run.time() < 1.0 ? 1 : run.time() < 2.0 ? 2 : 3);
        EXPECT_LE(run.position() - before, 0.1 + 1e-6) << run.time();
        before = run.position();
        ASSERT_LT(run.time(), 5.0);
    }
    EXPECT_NEAR(run.entries[1].entered, 1.0, 0.0011);
    EXPECT_NEAR(run.entries[2].entered, 2.0, 0.0011);
    EXPECT_NEAR(run.time(), 2.2, 0.0021);
}

TEST(PermitRun, PausesAsLongAsPlanned) {
    MotionTime pause;
    pause.duration = 0.5;
    PermitRun run = permit_run({{pause, 0}, {pause, 1}}, {});
    while (!run.is_done()) step(run, run.time() < 2.0 ? 1 : 2);
    EXPECT_NEAR(run.time(), 2.5, 0.0021);
}

} // namespace
} // namespace core
