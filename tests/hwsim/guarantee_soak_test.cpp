#include <gtest/gtest.h>

#include "tests/hwsim/judged_queries.h"

namespace hwsim {
namespace {

void expect_none_missed(uint32_t seed, const QueryKind& kind) {
    const JudgedQueries all = judged_queries(seed, kind);
    EXPECT_EQ(all.missed, 0) << all.first_missed;
    EXPECT_GT(all.violations, all.asked / 10);
    EXPECT_GT(all.asked - all.refused, all.asked / 10);
    testing::Test::RecordProperty("asked", static_cast<int>(all.asked));
    testing::Test::RecordProperty("violations", static_cast<int>(all.violations));
    testing::Test::RecordProperty("false_alarms", static_cast<int>(all.false_alarms));
}

// A million questions in all.

TEST(GuaranteeSoak, HoldsForHalfAMillionQuestions) {
    expect_none_missed(11, {.stocks = 1'000, .queries = 500});
}

TEST(GuaranteeSoak, HoldsForAQuarterOfAMillionOnACoarseLattice) {
    expect_none_missed(12, {.grid = 0.5, .stocks = 500, .queries = 500});
}

TEST(GuaranteeSoak, HoldsForAQuarterOfAMillionOnTheLatticeOfTheDevice) {
    expect_none_missed(13, {.grid = lsb, .h = 0.75, .stocks = 500, .queries = 500});
}

} // namespace
} // namespace hwsim
