#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/base/clearance_text.h"
#include "app/check/check_run.h"
#include "app/library/result/program_diff.h"
#include "app/report/exchange/exchange_reports.h"
#include "app/report/history/history_report.h"
#include "app/report/json/json_report.h"
#include "app/report/text/bench_report.h"
#include "app/report/text/diff_report.h"
#include "app/report/text/text_report.h"

namespace app {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A run whose deciding pairs all have these bounds.
CheckRun with_bounds(double lower, double upper, double keep) {
    const std::string folder = std::string(FEELER_SOURCE_DIR) + "/assets/";
    CheckRun run = *run_check({.program = folder + "programs/clamped_plate_low.nc",
                               .setup = folder + "setups/clamped_plate.toml",
                               .detail = core::Detail::deciding_pair});
    run.blocks.change_all([&](CheckedBlock& block) {
        if (!block.result.deciding) return;
        core::PairClearance& pair = block.result.pairs[*block.result.deciding];
        pair.lower = lower;
        pair.upper = upper;
        pair.allowance.distance = keep;
    });
    return run;
}

ProgramResult with_tightest(double lower, std::optional<double> upper, double keep) {
    return {.program = "a.nc",
            .tightest = Tightest{.line = 7,
                                 .pair = {"holder", "clamp-1"},
                                 .lower = lower,
                                 .upper = upper,
                                 .allowance = keep}};
}

std::string history_of(const ProgramResult& result) {
    StoredVersion version;
    version.result = result;
    return history_text("a.nc", {version});
}

std::string diff_of_bounds(double lower, std::optional<double> upper, double keep) {
    ProgramDiff diff;
    ChangedBlock changed;
    changed.after = {.line = 7,
                     .text = "G0",
                     .pair = {"holder", "clamp-1"},
                     .lower = lower,
                     .upper = upper,
                     .allowance = keep,
                     .margin = lower - keep};
    changed.before = changed.after;
    diff.nearer.push_back(changed);
    return diff_text(diff, true);
}

TEST(TextReport, RoundsLowerBoundsDownAndUpperBoundsUp) {
    const auto text = [](double lower, double upper, double keep) {
        return text_report(with_bounds(lower, upper, keep), {.blocks = true});
    };
    EXPECT_THAT(text(1.9996, 1.9996, 2.0), HasSubstr(" 1.999 mm (minimum 2.000 mm)"));
    EXPECT_THAT(text(1.9996, 1.9996, 2.0), HasSubstr("          1.999 "));
    EXPECT_THAT(text(1.9006, 2.0024, 2.0), HasSubstr(" 1.900-2.003 mm (minimum 2.000 mm)"));
    EXPECT_THAT(text(1.9006, 2.0024, 2.0), HasSubstr("    1.900-2.003 "));
    EXPECT_THAT(text(1.9, 1.9996, 2.0), HasSubstr(" 1.900-1.999600 mm (minimum 2.000 mm)"));
    EXPECT_THAT(text(2.0000000001, 2.0000000001, 2.0), HasSubstr(" 2.000 mm (minimum 2.000 mm)"));
    EXPECT_THAT(text(2.0002, 2.0002, 2.0004), HasSubstr(" 2.000 mm (minimum 2.001 mm)"));
    EXPECT_THAT(text(-0.0004, 0.0, 2.0), HasSubstr(" 0.000 mm (minimum 2.000 mm)"));
    EXPECT_THAT(text(1.9996, core::infinity, 2.0), HasSubstr(" >= 1.999 "));
}

TEST(TextReport, SaysNoMoreThanTheSearchWentThrough) {
    CheckRun run = with_bounds(1.0, 1.0, 2.0);
    run.blocks.change_all([](CheckedBlock& block) {
        block.result.deciding.reset();
        block.result.pairs.clear();
        block.result.checked = true;
    });
    run.setup.search_limit = 49.6;
    EXPECT_THAT(text_report(run, {.blocks = true}), HasSubstr(" >= 49.600 "));
}

TEST(Csv, HasBoundsToTheLastBit) {
    const double lower = 1.9999999000000002, upper = 2.0 - 1e-9, keep = 2.0;
    const std::string whole = csv_report(with_bounds(lower, upper, keep));
    EXPECT_THAT(whole, HasSubstr(",1.9999999000000002,1.999999999,2,"));
    const std::string row = batch_csv_report({.programs = {with_tightest(lower, upper, keep)}});
    EXPECT_THAT(row, HasSubstr(",7,1.9999999000000002,1.999999999,2,holder,clamp-1,"));
}

TEST(HistoryText, RoundsLowerBoundsDownAndUpperBoundsUp) {
    EXPECT_THAT(history_of(with_tightest(1.9996, 1.9996, 2.0)), HasSubstr(" 1.999 mm holder"));
    EXPECT_THAT(history_of(with_tightest(1.9006, 2.0024, 2.0)), HasSubstr(" 1.900-2.003 mm"));
    EXPECT_THAT(history_of(with_tightest(1.9, 1.9996, 2.0)), HasSubstr(" 1.900-1.999600 mm"));
    EXPECT_THAT(history_of(with_tightest(49.9996, {}, 2.0)), HasSubstr(" >= 49.999 mm"));
}

TEST(DiffText, RoundsLowerBoundsDownAndUpperBoundsUp) {
    EXPECT_THAT(diff_of_bounds(1.9996, 1.9996, 2.0), HasSubstr(" 1.999 -> 1.999 mm"));
    EXPECT_THAT(diff_of_bounds(1.9006, 2.0024, 2.0), HasSubstr("-> 1.900-2.003 mm"));
    EXPECT_THAT(diff_of_bounds(1.9, 1.9996, 2.0), HasSubstr("-> 1.900-1.999600 mm"));
    EXPECT_THAT(diff_of_bounds(49.9996, {}, 2.0), HasSubstr("-> >= 49.999 mm"));
}

TEST(DistanceText, RoundsLowerBoundsDownAndUpperBoundsUp) {
    BodyPairDistance found;
    found.distance = 5.0000009;
    found.lower = 4.9999999956;
    found.upper = 5.0000000014;
    const std::string text = text_distance(found, "a.stl", "b.stl", false);
    EXPECT_THAT(text, HasSubstr(" 5.000000 mm, guaranteed between 4.999999995 and 5.000000002"));
    EXPECT_THAT(text, HasSubstr(" closest pair 5.000000 mm apart"));
}

TEST(ClearanceText, RoundsLowerBoundsDownAndUpperBoundsUp) {
    const auto text = [](const ShownClearance& clearance) {
        return clearance_text(clearance, ClearanceStyle::sentence) + "|"
               + clearance_text(clearance, ClearanceStyle::column) + "|"
               + clearance_text(clearance, ClearanceStyle::lower_bound);
    };
    EXPECT_EQ(text({true, 1.9996, 1.9996, 2.0}), "1.999 mm|1.999|1.999");
    EXPECT_EQ(text({true, 1.9006, 2.0024, 2.0}), "1.900 to 2.003 mm|1.900-2.003|1.900");
    EXPECT_EQ(text({true, 1.9, 1.9996, 2.0}), "1.900 to 1.999600 mm|1.900-1.999600|1.900");
    EXPECT_EQ(text({true, 49.9996, {}, 2.0}), "at least 49.999 mm|>= 49.999|>= 49.999");
    EXPECT_EQ(text({.is_known = false}), "unknown|unknown|unknown");
}

TEST(ShownClearance, IsThatOfTheDecidingPairOrALowerBoundOfAll) {
    const auto text = [](const core::BlockResult& result) {
        return clearance_text(shown_clearance({}, result), ClearanceStyle::sentence);
    };
    core::BlockResult result;
    EXPECT_EQ(text(result), "at least 50.000 mm");
    result.pairs = {{.lower = 3.0}, {.lower = 2.0, .upper = 2.5}};
    EXPECT_EQ(text(result), "at least 2.000 mm");
    result.deciding = 0;
    EXPECT_EQ(text(result), "at least 3.000 mm");
    result.deciding = 1;
    EXPECT_EQ(text(result), "2.000 to 2.500 mm");
    result.checked = false;
    EXPECT_EQ(text(result), "unknown");
}

} // namespace
} // namespace app
