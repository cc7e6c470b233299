#include "tests/app/tolerance_cases.h"

#include <gtest/gtest.h>

namespace app_test {
namespace {

void expect_inside(const ToleranceCase& one, const app::Tolerance& tolerance, unsigned seed,
                   double by, ToleranceTally& tally) {
    const auto end = checked_with(one.job, tolerance.deviation, by);
    ASSERT_TRUE(end.has_value());
    tally.undecided += end->verdict == core::Verdict::undecided;
    tally.wrong += end->is_wrong();
    EXPECT_FALSE(end->is_wrong()) << "seed " << seed << ", " << title_of(tolerance.deviation)
                                  << " by " << by << ": " << range_text(tolerance);
}

void compare_side(const ToleranceCase& one, const app::Tolerance& tolerance, bool more,
                  unsigned seed, test_support::Dice& dice, ToleranceTally& tally) {
    const app::ToleranceLimit& limit = more ? tolerance.more : tolerance.less;
    const double sign = more ? 1.0 : -1.0;
    ++tally.limits;
    tally.open += limit.is_open;
    tally.zero += limit.by == 0.0;
    if (limit.by > 0.0) {
        expect_inside(one, tolerance, seed, sign * limit.by, tally);
        expect_inside(one, tolerance, seed, sign * limit.by * dice.fraction(), tally);
    }
    if (limit.is_open || !limit.not_shown) return;
    const auto beyond =
        checked_with(one.job, tolerance.deviation, sign * (1.02 * *limit.not_shown + 0.02));
    if (!beyond) return;
    ++tally.beyond;
    tally.beyond_clear += beyond->is_clear();
}

} // namespace

void compare_tolerances(unsigned seed, ToleranceTally& tally, double rounding) {
    RandomJob random(seed, rounding);
    const ToleranceCase one(random.setup, random.program);
    ++tally.jobs;
    const auto run = app::run_check(one.job);
    ASSERT_TRUE(run.has_value()) << run.error().message << random.setup;
    if (run->verdict != core::Verdict::clear || run->stopped) return;
    ++tally.clear_jobs;
    const auto tolerances = app::tolerances_of(one.job, *run);
    ASSERT_TRUE(tolerances.has_value());
    if (!tolerances->refusal.empty()) return;
    for (const app::Tolerance& tolerance : tolerances->list) {
        if (!tolerance.is_known()) continue;
        for (const bool more : {false, true})
            compare_side(one, tolerance, more, seed, random.dice, tally);
    }
}

} // namespace app_test
