#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/conclusion.h"
#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::SetupWriter;
using testing::ElementsAre;
using testing::IsEmpty;

/// A rapid along Y97.8 above the stock, 1.2 mm past a clamp whose near side is at Y104.
SetupWriter past_a_clamp(const std::string& rules) {
    return SetupWriter()
        .fixture("clamp-1", "box = [[40, 104, -30], [60, 130, 12]]")
        .also("[rules]\n" + rules);
}

Checked checked_with(const std::string& comment, const std::string& rules) {
    return check(past_a_clamp(rules),
                 program({"G0 X-20. Y97.8", "Z2.5", "X120. " + comment, "Z60."}));
}

bool says(const Checked& checked, const std::string& what) {
    return std::any_of(checked.assumptions.begin(), checked.assumptions.end(),
                       [&](const std::string& text) { return text.find(what) != text.npos; });
}

/// Only the names.
std::vector<std::string> names_in(const std::string& line) {
    std::vector<std::string> names;
    for (const app::AllowedRule& rule : app::allowed_rules(line)) names.push_back(rule.name);
    return names;
}

TEST(AllowedRules, AreReadFromCommentsOnly) {
    EXPECT_THAT(names_in("G0 X5. (feeler: allow rapid-near-clamp)"),
                ElementsAre("rapid-near-clamp"));
    EXPECT_THAT(names_in("G0 X5 ; FEELER:ALLOW near-miss, air-cut"),
                ElementsAre("near-miss", "air-cut"));
    EXPECT_THAT(names_in("(a) X5 (feeler: allow near-miss) (feeler: allow air-cut)"),
                ElementsAre("near-miss", "air-cut"));
    EXPECT_THAT(names_in("(feeler gauge)"), IsEmpty());
    EXPECT_THAT(names_in("feeler: allow near-miss"), IsEmpty());
}

TEST(AllowedRules, CountWhereTheSetUpPermitsIt) {
    const Checked allowed =
        checked_with("(feeler: allow rapid-near-clamp)", "allow_comments = true\n");
    EXPECT_EQ(allowed.errors(), "");
    EXPECT_EQ(allowed.status, 0);
    EXPECT_EQ(allowed.verdict, "violation");
    EXPECT_TRUE(says(allowed, "allow rapid-near-clamp in line 8"));
}

TEST(AllowedRules, DoNotCountWhereTheSetUpIsSilent) {
    const Checked checked =
        checked_with("(feeler: allow rapid-near-clamp)", "allow_comments = false\n");
    EXPECT_EQ(checked.errors(), "rapid-near-clamp 8");
    EXPECT_TRUE(says(checked, "has no effect in line 8"));
}

TEST(AllowedRules, CoverTheirRuleAndTheirLineOnly) {
    EXPECT_EQ(checked_with("(feeler: allow near-miss)", "allow_comments = true\n").errors(),
              "rapid-near-clamp 8");
    const Checked other = check(
        past_a_clamp("allow_comments = true\n"),
        program({"G0 X-20. Y97.8", "Z2.5 (feeler: allow rapid-near-clamp)", "X120.", "Z60."}));
    EXPECT_EQ(other.errors(), "rapid-near-clamp 8");
}

TEST(AllowedRules, NeverCoverACollision) {
    const Checked checked =
        check(SetupWriter().also("[rules]\nallow_comments = true\n"),
              program({"G0 X-20. Y50.", "Z-5.", "X120. (feeler: allow rapid-in-stock)", "Z60."}));
    EXPECT_EQ(checked.errors(), "rapid-in-stock 8");
    EXPECT_TRUE(says(checked, "a collision is never allowed"));
}

TEST(AllowedRules, SayWhichNameIsNoRule) {
    const Checked wrong =
        checked_with("(feeler: allow rapid-near-clmp)", "allow_comments = true\n");
    EXPECT_EQ(wrong.errors(), "rapid-near-clamp 8");
    EXPECT_EQ(wrong.of_severity("warning"), "program 8");
    for (const FindingLine& finding : wrong.findings) {
        if (finding.rule != "program") continue;
        EXPECT_THAT(finding.message, testing::HasSubstr("Line 8, column 22: "));
        EXPECT_THAT(finding.message, testing::HasSubstr("rapid-near-clmp"));
        EXPECT_EQ(finding.cure, "Write rapid-near-clamp if you mean that rule.");
    }
}

TEST(AllowedRules, ReportACommentThatIsNotPermittedOnceEvenWithoutFindings) {
    const Checked checked =
        check(past_a_clamp("allow_comments = false\n"),
              program({"G0 X-20. Y97.8", "Z60. ; feeler: allow near-miss", "M98 P2000 L3"})
                  + "O2000\nX120. (feeler: allow near-miss)\nX-20.\nM99\n");
    EXPECT_EQ(checked.errors(), "");
    EXPECT_EQ(checked.of_severity("warning"), "");
    EXPECT_THAT(checked.of_severity("note"), testing::HasSubstr("program 7, program 11"));
    EXPECT_EQ(checked.status, 0);
}

TEST(AllowedRules, SayWhichSeveritiesTheSetUpChanged) {
    const Checked lowered = checked_with("", "rapid-near-clamp = \"warning\"\n");
    EXPECT_EQ(lowered.of_severity("warning"), "rapid-near-clamp 8");
    EXPECT_TRUE(says(lowered, "reports rapid-near-clamp as warning instead of error"));
    EXPECT_TRUE(
        says(checked_with("", "rapid-near-clamp = \"off\"\n"), "switches rapid-near-clamp off"));
}

} // namespace
} // namespace app_test
