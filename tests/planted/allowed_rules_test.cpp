#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/session/allowed_rules.h"
#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::SetupWriter;
using testing::ElementsAre;
using testing::IsEmpty;

/// A rapid along Y97.8 over the stock, past a clamp whose near side is at Y104: 1.2 mm.
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

TEST(AllowedRules, AreReadFromCommentsOnly) {
    EXPECT_THAT(app::allowed_rules("G0 X5. (feeler: allow rapid-near-clamp)"),
                ElementsAre("rapid-near-clamp"));
    EXPECT_THAT(app::allowed_rules("G0 X5 ; FEELER:ALLOW near-miss, air-cut"),
                ElementsAre("near-miss", "air-cut"));
    EXPECT_THAT(app::allowed_rules("(a) X5 (feeler: allow near-miss) (feeler: allow air-cut)"),
                ElementsAre("near-miss", "air-cut"));
    EXPECT_THAT(app::allowed_rules("(feeler gauge)"), IsEmpty());
    EXPECT_THAT(app::allowed_rules("feeler: allow near-miss"), IsEmpty());
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
    EXPECT_TRUE(says(checked, "does not count in line 8"));
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

TEST(AllowedRules, SayWhichSeveritiesTheSetUpChanged) {
    const Checked lowered = checked_with("", "rapid-near-clamp = \"warning\"\n");
    EXPECT_EQ(lowered.of_severity("warning"), "rapid-near-clamp 8");
    EXPECT_TRUE(says(lowered, "rapid-near-clamp told as warning, not as error"));
    EXPECT_TRUE(says(checked_with("", "rapid-near-clamp = \"off\"\n"), "switched off"));
}

} // namespace
} // namespace app_test
