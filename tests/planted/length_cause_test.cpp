#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::SetupWriter;
using testing::HasSubstr;
using testing::Not;

/// A program with the lines, tool `tool` and length offset `offset`, which line 5 activates.
std::string with_length(int tool, int offset, const std::string& lines) {
    return "O1\nG21 G17 G90 G40 G80\nT" + std::to_string(tool)
           + " M6\nG54 G0 X-30. Y50. S6000 M3\nG43 H" + std::to_string(offset) + " Z60.\n" + lines
           + "G0 Z60.\nM30\n";
}

/// H3 is `length`; tools 1 and 2 are 95 and 120 long.
SetupWriter table_with(double length) {
    return SetupWriter()
        .lengths("[[length_offset]]\nnumber = 3\nlength = " + std::to_string(length) + "\n")
        .also_tool("number = 2\nshape = \"drill\"\ndiameter = 8\nflute_length = 40\n"
                   "shank = [[8, 8, 20]]\nholder = [[32, 32, 60]]\n");
}

SetupWriter with_clamp(double length, double top) {
    return table_with(length).fixture("clamp-1", "box = [[40, 104, -30], [60, 130, "
                                                     + std::to_string(top) + "]]\n");
}

std::string all_words(const Checked& checked) {
    std::string words;
    for (const FindingLine& finding : checked.findings)
        words += finding.rule + ": " + finding.message + "\n";
    return words;
}

const std::string over_clamp = "G0 Z14.\nX50. Y110.\n";

TEST(WrongLength, DoesNotTakeInAClampThatIsInTheWayAnyhow) {
    const Checked wrong = check(with_clamp(93.5, 42), with_length(1, 3, over_clamp));
    const Checked right = check(with_clamp(93.5, 42), with_length(1, 1, over_clamp));
    EXPECT_THAT(right.errors(), HasSubstr("collision 7"));
    EXPECT_EQ(wrong.errors(), right.errors());
    EXPECT_THAT(all_words(wrong), Not(HasSubstr("lower than intended")));
}

TEST(WrongLength, AbsorbsAClampThatTheRightOneClears) {
    // Minimum clearance 2 mm: at Z14.5 the tool is 2.5 mm above the top, with H3 1 mm.
    const std::string lines = "G0 Z14.5\nX50. Y110.\n";
    const Checked wrong = check(with_clamp(93.5, 12), with_length(1, 3, lines));
    EXPECT_THAT(wrong.errors(), Not(HasSubstr(",")));
    EXPECT_THAT(all_words(wrong), HasSubstr("1.500 mm lower than intended and comes too close to"));
    EXPECT_EQ(check(with_clamp(93.5, 12), with_length(1, 1, lines)).errors(), "");
}

TEST(WrongLength, LeavesAClampThatIsTooNearWithTheRightOne) {
    // With the right length the clearance is 0.5 mm short, with the wrong one 2 mm.
    const std::string lines = "G0 Z13.5\nX50. Y110.\n";
    const Checked wrong = check(with_clamp(93.5, 12), with_length(1, 3, lines));
    EXPECT_THAT(all_words(wrong), Not(HasSubstr("lower than intended")));
    EXPECT_THAT(wrong.errors(), HasSubstr("7"));
    EXPECT_THAT(check(with_clamp(93.5, 12), with_length(1, 1, lines)).errors(), HasSubstr("7"));
}

TEST(WrongLength, LeavesTheTopOfZ) {
    const Checked top = check(table_with(85), with_length(1, 3, "G0 Z350.\n"));
    EXPECT_THAT(top.errors(), HasSubstr("over-travel 6"));
    EXPECT_THAT(all_words(top), Not(HasSubstr("lower than intended")));
}

TEST(WrongLength, AbsorbsTheLowerEndOfZByTheMissingLength) {
    // Z-167 ends 8 mm above the limit with the right length, 2 mm below it with 10 mm less.
    const auto beside = [](const std::string& z) { return "G0 Z" + z + "\n"; };
    const SetupWriter setup = table_with(85);
    const Checked little = check(setup, with_length(1, 3, beside("-167.")));
    EXPECT_THAT(all_words(little), HasSubstr("10.000 mm lower than intended"));
    EXPECT_EQ(check(setup, with_length(1, 1, beside("-167."))).errors(), "");
    const Checked far = check(setup, with_length(1, 3, beside("-180.")));
    EXPECT_THAT(far.errors(), HasSubstr("over-travel 6"));
    EXPECT_THAT(all_words(far), Not(HasSubstr("lower than intended")));
}

TEST(WrongLength, LeavesADrillThatIsFedSideways) {
    const std::string lines = "G0 X20.\nZ50.\nG1 Z-5. F300.\nX60. F800.\n";
    const Checked wrong = check(table_with(118), with_length(2, 3, lines));
    EXPECT_THAT(all_words(wrong), HasSubstr("is a drill and is fed sideways"));
    EXPECT_THAT(wrong.errors(), HasSubstr("collision 9"));
}

TEST(WrongLength, LeavesCollisionsOfMovesInMachineCoordinates) {
    // G53 ignores the length offset, so the right one changes nothing.
    const std::string lines = "G0 X50. Y110.\nG53 G0 Z-318.\n";
    const SetupWriter setup = with_clamp(85, 12).also("[control]\n\"5001#6\" = 1\n");
    const Checked wrong = check(setup, with_length(1, 3, lines));
    EXPECT_THAT(wrong.errors(), HasSubstr("collision 7"));
    EXPECT_THAT(all_words(wrong), Not(HasSubstr("lower than intended")));
}

// Reports of blocks name the same findings as the text.

TEST(WrongLength, LeavesTheRulesInTheRowsOfBlocks) {
    const test_support::ScopedFolder folder;
    const SetupWriter setup = table_with(40);
    const auto program = folder.write("p.nc", with_length(1, 3, "G0 X50.\nZ20.\n"));
    const auto file = folder.write("s.toml", setup.text());
    for (const std::string form : {"csv", "json"}) {
        const auto ran = feeler({"check", program, "--setup", file, "--format", form});
        EXPECT_THAT(ran.out, HasSubstr("rapid-in-stock"));
        if (form == "csv") {
            EXPECT_THAT(ran.out, Not(HasSubstr(",collision,\r\n")));
        }
    }
}

} // namespace
} // namespace app_test
