#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support/machining_tally.h"

namespace core {
namespace {

/// Random programs, each on a set-up of its own, every block of which is held against the truth.
class Machining : public testing::TestWithParam<unsigned> {
protected:
    test_support::MachiningTally tally;

    void carry_out(unsigned programs, int blocks, bool turning) {
        for (unsigned i = 0; i < programs; ++i) {
            test_support::JudgedMachining run(1000 * GetParam() + i, turning, tally);
            run.carry_out(blocks);
        }
        RecordProperty("report", tally.report());
        if(getenv("SHOW")) puts(tally.report().c_str());
        for (size_t i = 0; i < std::min<size_t>(tally.failures.size(), 20); ++i)
            ADD_FAILURE() << tally.failures[i];
    }
};

TEST_P(Machining, KeepsTheTruthBetweenLowerAndUpper) {
    carry_out(10, 25, false);
    EXPECT_TRUE(tally.is_representative()) << tally.report();
}

TEST_P(Machining, KeepsItOnATrunnion) { carry_out(1, 4, true); }

INSTANTIATE_TEST_SUITE_P(Random, Machining, testing::Range(0U, 12U));

} // namespace
} // namespace core
