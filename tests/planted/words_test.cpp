#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::SetupWriter;
using testing::HasSubstr;
using testing::Not;

// Rapids within a block of several motions.

TEST(RapidOnTheWayHome, IsARapidInTheStock) {
    const Checked checked =
        check(SetupWriter(), program({"G0 X-20. Y50.", "Z2.", "G28 X120. Z-5.", "G0 Z0."}));
    const FindingLine shown_assumptions = checked.finding("rapid-in-stock");
    EXPECT_EQ(shown_assumptions.line, 8);
    EXPECT_THAT(shown_assumptions.message,
                HasSubstr("on the way to the reference point (G28, G30)"));
    EXPECT_THAT(shown_assumptions.cure, HasSubstr("G91 G28 Z0"));
    EXPECT_THAT(checked.errors(), Not(HasSubstr("collision")));
}

TEST(RapidOfACycle, IsARapidInTheStock) {
    // G98 returns to Z-8, where the cycle started in the pocket next to the wall.
    const std::vector<std::string> pocket = {"G0 X20. Y50.", "Z2.", "G1 Z-8. F200."};
    std::vector<std::string> lines = pocket;
    lines.insert(lines.end(), {"G98 G81 X80. Y50. Z-12. R-8. F200.", "G80", "G0 Z60."});
    const Checked checked = check(SetupWriter(), program(lines));
    const FindingLine shown_assumptions = checked.finding("rapid-in-stock");
    EXPECT_EQ(shown_assumptions.line, 9);
    EXPECT_THAT(shown_assumptions.message, HasSubstr("on a rapid of this cycle"));
    EXPECT_THAT(shown_assumptions.cure, HasSubstr("the cycle"));
    lines = {"G0 X20. Y50.", "Z2.", "G98 G81 X80. Y50. Z-12. R2. F200.", "G80", "G0 Z60."};
    EXPECT_EQ(check(SetupWriter(), program(lines)).errors(), "");
}

TEST(FeedOfACycle, IsNoRapid) {
    // The holder reaches the stock while the cycle feeds.
    const Checked checked = check(
        SetupWriter(), program({"G0 X50. Y50.", "Z2.", "G81 Z-60. R2. F200.", "G80", "G0 Z60."}));
    EXPECT_THAT(checked.errors(), HasSubstr("holder-into-wall 8"));
    EXPECT_THAT(checked.errors(), Not(HasSubstr("rapid-in-stock 8")));
}

TEST(RapidOfACycle, PastAClampIsNamedAsARapid) {
    const SetupWriter setup =
        SetupWriter().fixture("clamp-1", "box = [[40, 104, -30], [60, 130, 12]]");
    const Checked checked =
        check(setup, program({"G0 X-20. Y97.8", "Z2.5", "G98 G81 X90. Y97.8 Z-3. R2.5 F200.", "G80",
                              "G0 Z60."}));
    const FindingLine shown_assumptions = checked.finding("rapid-near-clamp");
    EXPECT_EQ(shown_assumptions.line, 8);
    EXPECT_THAT(shown_assumptions.message,
                HasSubstr("On a rapid of this cycle, the flutes come within 1.200 mm of clamp-1"));
}

// Tool changes.

SetupWriter long_second_tool(const std::string& rules = "") {
    return SetupWriter()
        .also_tool("number = 2\nshape = \"flat\"\ndiameter = 10\nflute_length = 20\n"
                   "shank = [[10, 10, 65]]\nholder = [[40, 40, 50]]\n")
        .also(rules);
}

/// Height of tool 1, 95 long, above the stock when tool 2, which is 40 longer, is loaded.
Checked changed_at(const std::string& z, const std::string& rules = "") {
    return check(long_second_tool(rules),
                 program({"G0 X50. Y50.", "Z" + z, "T2 M6", "G53 G0 Z0."}));
}

TEST(UnsafeToolChange, IsTheVerdictOfItsBlock) {
    const Checked inside = changed_at("30.");
    EXPECT_EQ(inside.errors(), "tool-change-unsafe 8, rapid-in-stock 9");
    EXPECT_EQ(inside.at_line(8).verdict, "collision");
    EXPECT_EQ(inside.verdict, "collision");
    EXPECT_THAT(inside.finding("tool-change-unsafe").message, HasSubstr("collide with the stock"));
    const Checked free = changed_at("50.");
    EXPECT_EQ(free.errors(), "");
    EXPECT_EQ(free.at_line(8).verdict, "clear");
    EXPECT_EQ(free.verdict, "clear");
}

TEST(UnsafeToolChange, IsReportedDespiteTheSetUpIfBodiesOverlap) {
    const std::string off = "[rules]\ntool-change-unsafe = \"off\"\n";
    EXPECT_EQ(changed_at("30.", off).errors(), "tool-change-unsafe 8, rapid-in-stock 9");
    EXPECT_EQ(changed_at("50.", off).errors(), "");
}

// Lengths as written in the set-up.

TEST(FluteLength, IsReportedAsTheSetUpStatesIt) {
    const SetupWriter setup = SetupWriter().lengths("").tool(
        "number = 1\nshape = \"tslot\"\ndiameter = 20\nflute_length = 5\nneck_diameter = 10\n"
        "neck_length = 20\nstick_out = 45\nholder = [[40, 40, 50]]\n");
    const Checked checked =
        check(setup, program({"G0 X-20. Y0.", "Z-14.", "G1 X120. F300.", "G0 Z60."}));
    const FindingLine shown_assumptions = checked.finding("over-engagement");
    EXPECT_THAT(shown_assumptions.message, HasSubstr("5.0 mm"));
    EXPECT_THAT(shown_assumptions.message, Not(HasSubstr("5.2")));
}

// The same words with and without --pairs.

TEST(Witness, IsAtTheSameMomentAtAnyLevelOfDetail) {
    // The holder passes through both walls of a slot that is too deep and through a clamp after it.
    const SetupWriter setup = SetupWriter()
                                  .fixture("clamp-1", "box = [[70, 60, -30], [80, 90, 12]]")
                                  .fixture("clamp-2", "box = [[90, 30, -30], [95, 40, 14]]");
    const std::string crash = program({"G0 X-40. Y50.", "Z5.", "X20.", "G1 Z-55. F500.", "X70.",
                                       "G0 Z-50.", "X120. Y80.", "X-20. Z-48.", "G0 Z60."});
    const test_support::ScopedFolder folder;
    const std::string file = folder.write("program.nc", crash);
    const std::string written = folder.write("setup.toml", setup.text());
    const auto messages = [&](const std::string& option) {
        std::vector<std::string> words = {"check", file, "--setup", written, "--format", "text"};
        if (!option.empty()) words.push_back(option);
        const std::string text = feeler(words).out;
        return text.substr(0, text.find(" line move")).substr(0, text.find(file + ": "));
    };
    EXPECT_THAT(messages(""), HasSubstr("% of the block"));
    EXPECT_EQ(messages(""), messages("--pairs"));
}

} // namespace
} // namespace app_test
