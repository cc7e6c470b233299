#include <gtest/gtest.h>

#include "tests/support/guarantee_tally.h"

namespace core {
namespace {

using test_support::Footing;
using test_support::GuaranteeTally;
using test_support::Meeting;

TEST(Guarantee, HoldsForRandomBodiesOfKnownDistance) {
    test_support::PairGenerator pairs(1);
    GuaranteeTally tally;
    for (int i = 0; i < 4000; ++i) {
        const test_support::KnownPair pair = pairs.next();
        tally.measure(pair, pairs.engine());
    }
    for (size_t i = 0; i < std::min<size_t>(tally.failures.size(), 40); ++i)
        ADD_FAILURE() << tally.failures[i];
    std::cout << tally.failures.size() << "\n" << tally.report();
}

} // namespace
} // namespace core
