#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/app/tolerance_cases.h"

namespace app_test {
namespace {

/// The number in a variable of the environment, or another one.
unsigned number_of(const char* name, unsigned other) {
    const char* text = std::getenv(name);
    return text ? static_cast<unsigned>(std::atoi(text)) : other;
}

TEST(ToleranceSoak, HoldsForManyRandomJobs) {
    ToleranceTally tally;
    const unsigned first = number_of("TOLERANCE_FIRST_SEED", 1000);
    const unsigned count = number_of("TOLERANCE_SEEDS", 150);
    for (unsigned seed = first; seed < first + count; ++seed) compare_tolerances(seed, tally);
    fmt::print("{} jobs, {} clear; {} limits, {} open, {} zero; inside: {} undecided, {} wrong; "
               "just beyond: {} of {} still clear\n",
               tally.jobs, tally.clear_jobs, tally.limits, tally.open, tally.zero, tally.undecided,
               tally.wrong, tally.beyond_clear, tally.beyond);
    EXPECT_EQ(tally.wrong, 0U);
}

} // namespace
} // namespace app_test
