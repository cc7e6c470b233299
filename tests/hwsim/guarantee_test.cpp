#include <gtest/gtest.h>

#include "tests/hwsim/judged_queries.h"

namespace hwsim {
namespace {

void expect_none_missed(const JudgedQueries& all) {
    EXPECT_EQ(all.missed, 0) << all.first_missed;
    // The sample holds enough of both kinds, and the device does not just refuse.
    EXPECT_GT(all.violations, all.asked / 10);
    EXPECT_GT(all.asked - all.refused, all.asked / 10);
    EXPECT_LT(all.false_alarms, all.asked / 10);
}

TEST(Guarantee, WhatTheExactEngineCallsAViolationIsRefused) {
    expect_none_missed(judged_queries(1, {.stocks = 30, .queries = 200}));
}

TEST(Guarantee, HoldsWhereEverythingLiesOnALattice) {
    const JudgedQueries all = judged_queries(2, {.grid = 0.5, .stocks = 30, .queries = 200});
    expect_none_missed(all);
    EXPECT_GT(all.at_a_tie, 20);
}

/// One cylinder against the posts of an uncut box, whose distance is known exactly.
TEST(Guarantee, AnAlarmIsTrueButForTheReserveAndTheCover) {
    std::mt19937 rng(3);
    int near_misses = 0, alarms = 0;
    const test_support::CutBox world{{{-8, -7, -6}, {9, 8, 2}}, 0.0, {}};
    const core::CutModel stock = world.uncut(0.5);
    DeviceStock device(stock);
    for (int i = 0; i < 20'000; ++i) {
        Question q = random_question(rng, world.box, i % 2 ? 0.25 : 0.0);
        const double step = glm::length(q.to - q.from) / double(1U << q.log2_steps);
        const double kept = std::hypot(q.allowance, 0.5 * step);
        // The allowance, then the reserve of 3, 1 of T, sqrt(3) of the place, 2 sqrt(3) of the
        // covers, and the tolerance of the tool's.
        const double bound = kept + (4.0 + 3.0 * std::sqrt(3.0)) * lsb + 0.05;
        q.allowance = bound;
        const double truth = exact_distance(q, stock).separation.lower;
        q.allowance = std::sqrt(std::max(kept * kept - 0.25 * step * step, 0.0));
        const bool refused = device.ask(q).found;
        if (refused) {
            ASSERT_LE(truth, bound) << i;
        }
        alarms += refused ? 1 : 0;
        near_misses += !refused && truth < bound + 0.5 ? 1 : 0;
    }
    EXPECT_GT(alarms, 2'000);
    EXPECT_GT(near_misses, 100);
}

} // namespace
} // namespace hwsim
