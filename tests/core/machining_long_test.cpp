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
class LongMachining : public testing::TestWithParam<unsigned> {};

TEST_P(LongMachining, KeepsTheTruthBetweenLowerAndUpper) {
    const auto tally = test_support::judged_programs(10'000 + 100 * GetParam(), 40, 25, false);
    expect_sound(tally);
    EXPECT_TRUE(tally.is_representative()) << tally.report();
}

INSTANTIATE_TEST_SUITE_P(FortyThousand, LongMachining, testing::Range(0U, 40U));

} // namespace
} // namespace core
