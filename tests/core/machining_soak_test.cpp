#include <cstdlib>

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
class MachiningSoak : public testing::TestWithParam<unsigned> {};

/// Total number of blocks: FEELER_MACHINING_BLOCKS, or one million.
unsigned long long blocks_wanted() {
    const char* said = std::getenv("FEELER_MACHINING_BLOCKS");
    return said ? std::strtoull(said, nullptr, 10) : 1'000'000;
}

constexpr unsigned parts = 40;

TEST_P(MachiningSoak, KeepsTheTruthBetweenLowerAndUpper) {
    const auto programs = static_cast<unsigned>(blocks_wanted() / (25 * parts) + 1);
    const unsigned seed = 1'000'000 + 100'000 * GetParam();
    const auto tally = test_support::judged_programs(seed, programs, 25, false);
    expect_sound(tally);
    EXPECT_TRUE(tally.is_representative()) << tally.report();
}

TEST_P(MachiningSoak, KeepsItOnATrunnion) {
    const auto programs = static_cast<unsigned>(blocks_wanted() / (4 * 100 * parts) + 1);
    expect_sound(test_support::judged_programs(1000 * GetParam(), programs, 4, true));
}

INSTANTIATE_TEST_SUITE_P(OneMillion, MachiningSoak, testing::Range(0U, parts));

} // namespace
} // namespace core
