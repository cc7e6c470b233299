#include <gtest/gtest.h>

#include "tests/support/guarantee_tally.h"
#include "tests/support/pair_generator.h"

namespace core {
namespace {

/// A million pairs in eight parts, each with a generator of its own.
class GuaranteeSoak : public testing::TestWithParam<unsigned> {};

TEST_P(GuaranteeSoak, HoldsForRandomBodiesOfKnownDistance) {
    test_support::PairGenerator pairs(GetParam());
    test_support::GuaranteeTally tally;
    for (int i = 0; i < 125'000; ++i) {
        const test_support::KnownPair pair = pairs.next();
        tally.measure(pair, pairs.engine());
    }
    RecordProperty("report", tally.report());
    for (size_t i = 0; i < std::min<size_t>(tally.failures.size(), 20); ++i)
        ADD_FAILURE() << tally.failures[i];
    EXPECT_TRUE(tally.is_representative()) << tally.report();
    EXPECT_GT(tally.tight_share(), 0.995) << tally.report();
    EXPECT_GT(tally.share_closed_at_zero(), 0.998) << tally.report();
}

INSTANTIATE_TEST_SUITE_P(OneMillion, GuaranteeSoak, testing::Range(100U, 108U));

} // namespace
} // namespace core
