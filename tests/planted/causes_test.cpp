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

std::string rules_in(const Checked& checked) {
    std::string rules;
    for (const FindingLine& finding : checked.findings) rules += finding.rule + " ";
    return rules;
}

/// Three passes into the plate, with the given length code in line 5.
std::string passes(const std::string& length, const std::string& between = "") {
    std::string text = "O1000\nG21 G90 G17 G54\nT1 M6\nS6000 M3\nG0 " + length + " Z60.\n"
                       + "G0 X-20. Y30.\nZ-2.\nG1 X120. F800.\nG0 Z60.\n" + between;
    for (const char* y : {"50.", "70."})
        text += std::string("X-20. Y") + y + "\nZ-2.\nG1 X120.\nG0 Z60.\n";
    return text + "M30\n";
}

// A wrong length is one finding.

TEST(MissingLength, IsOneFindingWithAllThatComesOfIt) {
    const Checked checked = check(SetupWriter(), passes(""));
    EXPECT_EQ(checked.errors(), "missing-length-offset 5");
    EXPECT_EQ(checked.of_severity("warning"), "");
    const FindingLine shown_assumptions = checked.finding("missing-length-offset");
    EXPECT_THAT(shown_assumptions.message,
                HasSubstr("95.000 mm lower than intended and collides with the stock"));
    EXPECT_THAT(shown_assumptions.message, HasSubstr("from line 5 to line 17"));
    EXPECT_THAT(shown_assumptions.cure, HasSubstr("G43 H1"));
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_EQ(checked.at_line(8).verdict, "collision"); // blocks keep their verdicts
    EXPECT_EQ(check(SetupWriter(), passes("G43 H1")).errors(), "");
}

TEST(MissingLength, OfAG43WithoutHIsOneFinding) {
    const Checked checked = check(SetupWriter(), passes("G43"));
    EXPECT_EQ(checked.errors(), "missing-length-offset 5");
    const FindingLine missing = checked.finding("missing-length-offset");
    EXPECT_THAT(missing.message, HasSubstr("because G43 or G44 has no H"));
    EXPECT_THAT(missing.message,
                HasSubstr("95.000 mm lower than intended and collides with the stock"));
    EXPECT_THAT(missing.message, HasSubstr("from line 5 to line 17"));
    EXPECT_THAT(missing.cure, HasSubstr("Add H1"));
    EXPECT_THAT(checked.finding("program").message, Not(HasSubstr("in the spindle")));
    // The H of the offset that is on stays.
    EXPECT_EQ(check(SetupWriter(), passes("G43 H1 Z60.\nG0 G43")).errors(), "");
}

TEST(MissingLength, EndsWhereTheLengthIsCalled) {
    // The clamp is too close with the right length as well.
    const SetupWriter setup =
        SetupWriter().fixture("clamp-1", "box = [[40, 75, -30], [60, 90, 12]]");
    const Checked checked = check(setup, passes("", "G43 H1 Z60.\n"));
    EXPECT_THAT(checked.errors(), HasSubstr("missing-length-offset 5, "));
    EXPECT_THAT(checked.errors(), HasSubstr("17"));
    EXPECT_THAT(checked.finding("missing-length-offset").message, HasSubstr("to line 9"));
}

TEST(MissingLength, IsNotCuredByMoreStickOut) {
    EXPECT_THAT(rules_in(check(SetupWriter(), passes(""))), Not(HasSubstr("stick-out-short")));
    const SetupWriter table = SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 30\n");
    const Checked wrong_table = check(table, passes("G43 H1"));
    EXPECT_THAT(wrong_table.errors(), HasSubstr("holder-into-wall"));
    EXPECT_THAT(rules_in(wrong_table), Not(HasSubstr("stick-out-short")));
}

TEST(MissingLength, AbsorbsNothingIfItsRuleIsOff) {
    const SetupWriter off = SetupWriter().also("[rules]\nmissing-length-offset = \"off\"\n");
    EXPECT_THAT(check(off, passes("")).errors(), HasSubstr("holder-into-wall"));
}

const SetupWriter short_second_length =
    SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 95\n"
                          "[[length_offset]]\nnumber = 2\nlength = 85\n");

TEST(LengthOfAnotherTool, AbsorbsNoOtherCause) {
    std::string stopped = passes("G43 H2");
    stopped.replace(stopped.find("S6000 M3"), 8, "S6000 M5");
    EXPECT_THAT(check(short_second_length, stopped).errors(), HasSubstr("spindle-off 8"));
}

TEST(LengthOfAnotherTool, IsOneWarningAndOneError) {
    const SetupWriter setup = SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 95\n"
                                                    "[[length_offset]]\nnumber = 2\nlength = 40\n");
    const Checked deep = check(setup, passes("G43 H2"));
    EXPECT_EQ(deep.of_severity("warning"), "offset-not-tool 5");
    EXPECT_EQ(deep.errors(), "collision 8");
    const FindingLine shown_assumptions = deep.finding("collision");
    EXPECT_THAT(shown_assumptions.message, HasSubstr("see offset-not-tool in line 5"));
    EXPECT_THAT(shown_assumptions.message, HasSubstr("55.000 mm lower"));
    const SetupWriter alike = SetupWriter().lengths("[[length_offset]]\nnumber = 2\nlength = 95\n");
    const Checked harmless = check(alike, passes("G43 H2"));
    EXPECT_EQ(harmless.errors(), "");
    EXPECT_EQ(harmless.of_severity("warning"), "offset-not-tool 5");
}

// Expendable fixtures.

/// A plate on a board that the flutes may cut; the board's top is the underside of the plate.
SetupWriter on_a_board(const std::string& also = "") {
    return SetupWriter()
        .fixture("board", "box = [[-50, -50, -50], [150, 150, -30]]\nexpendable = true\n" + also)
        .tool("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 40\n"
              "shank = [[10, 10, 25]]\nholder = [[40, 40, 30]]\n");
}

TEST(ExpendableFixture, MayBeLeftByTheWayTheToolCame) {
    const std::vector<std::string> slot = {"G0 X-20. Y50.", "Z-28.", "G1 Z-33. F300.",
                                           "G1 X60. F800."};
    const auto then = [&](std::vector<std::string> more) {
        std::vector<std::string> lines = slot;
        lines.insert(lines.end(), more.begin(), more.end());
        return check(on_a_board(), program(lines));
    };
    EXPECT_EQ(then({"G0 Z60."}).errors(), "");
    EXPECT_EQ(then({"G0 X0.", "G0 Z60."}).errors(), "");
    EXPECT_EQ(then({"G0 Z-31.", "X20.", "Z60."}).errors(), "");
    EXPECT_EQ(then({"G0 Z60.", "X-20. Y50.", "Z-33.", "X10.", "Z60."}).errors(), "");
}

TEST(ExpendableFixture, IsFoundWhereTheToolHasNotCutIt) {
    const auto after_a_hole = [&](const std::vector<std::string>& more) {
        std::vector<std::string> lines = {"G0 X-20. Y-20.", "Z-28.", "G1 Z-33. F300."};
        lines.insert(lines.end(), more.begin(), more.end());
        return check(on_a_board(), program(lines)).errors();
    };
    EXPECT_EQ(after_a_hole({"G0 Z60."}), "");
    EXPECT_EQ(after_a_hole({"G0 X-30.", "Z60."}), "collision 9, collision 10");
    EXPECT_EQ(after_a_hole({"G0 X-30. Z-20.", "Z60."}), "collision 9");
    EXPECT_EQ(after_a_hole({"G0 Z-40.", "Z60."}), "collision 9, collision 10");
}

TEST(ExpendableFixture, ThatWasExchangedIsWhole) {
    const std::string exchanged = "[[fixture.move]]\nline = 9\nat = [0, 0, 0]\n";
    const std::vector<std::string> lines = {"G0 X-20. Y-20.", "Z-28.", "G1 Z-33. F300.", "G0 Z60."};
    EXPECT_EQ(check(on_a_board(), program(lines)).errors(), "");
    EXPECT_THAT(check(on_a_board(exchanged), program(lines)).errors(), HasSubstr("collision"));
}

// Values stated in the set-up.

TEST(WorkOffset, ThatTheSetUpStatesAsZeroIsSet) {
    const std::string zeros = "G54 = { X = 0, Y = 0, Z = 0 }\n";
    const std::string other = "G55 = { X = -350, Y = -200, Z = -420 }\n";
    const SetupWriter base =
        SetupWriter().stock("box = [[0, 0, -30], [100, 100, 0]]\nframe = \"G55\"\n");
    const std::string moves = program({"G0 X-350. Y-200. Z-10."});
    EXPECT_EQ(check(SetupWriter(base).offsets(zeros + other), moves).of_severity("warning"), "");
    EXPECT_THAT(check(SetupWriter(base).offsets(other), moves).of_severity("warning"),
                HasSubstr("work-offset-unset"));
}

// A restart.

TEST(RestartInTheMiddle, NamesTheMotionCodeThatItsFirstBlockNeeds) {
    const std::string slot =
        program({"G0 X-20. Y50.", "Z-5.", "G1 X50. F800.", "X120.", "G0 Z60."});
    const FindingLine shown_assumptions =
        check(SetupWriter(), slot, {"--start-line", "9"}).finding("restart-in-the-middle");
    EXPECT_EQ(shown_assumptions.line, 9);
    EXPECT_EQ(shown_assumptions.severity, "warning");
    EXPECT_THAT(shown_assumptions.message, HasSubstr("G1, F800"));
}

} // namespace
} // namespace app_test
