#include <gtest/gtest.h>

#include "tests/support/machining_tally.h"

namespace core {
namespace {

/// Random programs, each on a set-up of its own, every block of which is held against the truth.
class Machining : public testing::TestWithParam<unsigned> {};

TEST_P(Machining, KeepsTheTruthBetweenLowerAndUpper) {
    test_support::MachiningTally tally;
    for (unsigned i = 0; i < 10; ++i) {
        test_support::JudgedMachining run(1000 * GetParam() + i, tally);
        run.carry_out(25);
    }
    RecordProperty("report", tally.report());
    for (size_t i = 0; i < std::min<size_t>(tally.failures.size(), 20); ++i)
        ADD_FAILURE() << tally.failures[i];
    EXPECT_TRUE(tally.is_representative()) << tally.report();
}

INSTANTIATE_TEST_SUITE_P(Random, Machining, testing::Range(0U, 12U));

} // namespace
} // namespace core
