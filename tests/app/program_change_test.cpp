#include <gtest/gtest.h>

#include "app/library/result/program_diff.h"

namespace {

using app::numberless;
using app::ProgramResult;
using app::StoredFinding;

TEST(Numberless, LeavesWhatTheBlockSays) {
    EXPECT_EQ(numberless("N120 G1 x10 Y-5."), "G1X10Y-5.");
    EXPECT_EQ(numberless("/N120 G1 X10"), "/G1X10");
    EXPECT_EQ(numberless("12 L X+10 FMAX ; to the corner"), "LX+10FMAX");
    EXPECT_EQ(numberless("  G0 Z50\r"), "G0Z50");
    EXPECT_EQ(numberless("NEXT: R1=1"), "NEXT:R1=1");
    EXPECT_EQ(numberless(""), "");
    EXPECT_NE(numberless("G1 X1"), numberless("G1 X11"));
}

StoredFinding near_miss(uint32_t line, const std::string& text) {
    return {{.rule = "near-miss",
             .severity = core::Severity::error,
             .block = core::BlockIndex{line},
             .pair = {"holder", "clamp-1"}},
            line,
            "",
            text};
}

TEST(ChangeBetween, FollowsFindingsWhereverTheirBlockGoes) {
    ProgramResult before, after;
    before.findings = {near_miss(5, "N5 X10"), near_miss(7, "N7 X20")};
    after.findings = {near_miss(9, "N90 X10"), near_miss(12, "N120 X30")};
    const app::ProgramChange change = change_between(before, after);
    ASSERT_EQ(change.new_findings.size(), 1u);
    EXPECT_EQ(change.new_findings[0].line, 12u);
    ASSERT_EQ(change.gone_findings.size(), 1u);
    EXPECT_EQ(change.gone_findings[0].line, 7u);
}

TEST(ChangeBetween, CountsFindingsOfTheSameBlockOneByOne) {
    ProgramResult before, after;
    before.findings = {near_miss(5, "X10")};
    after.findings = {near_miss(5, "X10"), near_miss(5, "X10")};
    EXPECT_EQ(change_between(before, after).new_findings.size(), 1u);
    EXPECT_EQ(change_between(after, before).gone_findings.size(), 1u);
    after.findings[1].severity = core::Severity::warning;
    EXPECT_EQ(change_between(before, after).new_findings[0].severity, core::Severity::warning);
}

TEST(ChangeBetween, ComparesTheLeastMargins) {
    ProgramResult before{.cycle_time = 10.0}, after{.cycle_time = 12.5};
    EXPECT_FALSE(change_between(before, after).nearer);
    before.tightest = {.lower = 4.0, .upper = 5.0, .allowance = 2.0};
    after.tightest = {.lower = 2.5, .allowance = 1.0};
    EXPECT_EQ(change_between(before, after).nearer, 1.5);
    EXPECT_EQ(change_between(before, after).longer, 2.5);
}

} // namespace
