#include <gtest/gtest.h>

#include "tests/support/machining_tally.h"

namespace core {
namespace {

void expect_sound(const test_support::MachiningTally& tally) {
    testing::Test::RecordProperty("report", tally.report());
    for (size_t i = 0; i < std::min<size_t>(tally.failures.size(), 20); ++i)
        ADD_FAILURE() << tally.failures[i];
}

/// Random programs; each block is compared with the exact truth for every point.
class Machining : public testing::TestWithParam<unsigned> {};

TEST_P(Machining, KeepsTheTruthBetweenLowerAndUpper) {
    const auto tally = test_support::judged_programs(100 * GetParam(), 10, 25, false);
    expect_sound(tally);
    EXPECT_TRUE(tally.is_representative()) << tally.report();
}

INSTANTIATE_TEST_SUITE_P(Random, Machining, testing::Range(0U, 8U));

TEST(MachiningWithDeviatingBodies, KeepsTheTruthBetweenLowerAndUpper) {
    using test_support::KnownBodies;
    expect_sound(test_support::judged_programs(4000, 30, 25, false, KnownBodies::deviating));
    expect_sound(test_support::judged_programs(5000, 4, 4, true, KnownBodies::deviating));
}

TEST(MachiningOnATrunnion, KeepsTheTruthBetweenLowerAndUpper) {
    expect_sound(test_support::judged_programs(7, 4, 4, true));
}

} // namespace
} // namespace core
