#include <cmath>

#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::flat_10;
using test_support::program;
using test_support::SetupWriter;

const std::string far_stock = "box = [[200, 200, -30], [210, 210, 0]]\n";

/// From X0 Y0 to X100 Y50 at Z10. A straight move passes X50 at Y25; a dog-leg passes it at Y50.
const std::string slanted = program({"G0 Z10.", "X100. Y50.", "Z60."});

SetupWriter post_beside_the_way() {
    return SetupWriter().stock(far_stock).fixture("post", "box = [[40, 48, -30], [50, 58, 40]]");
}

TEST(Rapid, PassesClearWhenItRunsStraight) {
    const Checked checked = check(
        post_beside_the_way().machine("rapid = \"straight\"\n" + SetupWriter::mill()), slanted);
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.errors(), "");
    // The corner X50 Y48 is this far from the line from the origin through X100 Y50.
    const double off = (48.0 * 100.0 - 50.0 * 50.0) / std::hypot(100.0, 50.0);
    expect_encloses(checked.at_line(7).pair("flutes post"), off - 5.0, 1e-6);
}

TEST(Rapid, HitsWhatTheDogLegRunsInto) {
    const Checked checked =
        check(post_beside_the_way().machine("rapid = \"dogleg\"\n" + SetupWriter::mill()), slanted);
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_EQ(checked.at_line(7).pair("flutes post").verdict, "collision");
    EXPECT_EQ(checked.at_line(7).pair("shank post").verdict, "collision");
}

TEST(Rapid, IsUndecidedWhereTheSpeedsOfADogLegAreNotKnown) {
    const Checked checked = check(post_beside_the_way().machine("rapid = \"dogleg\"\n"), slanted);
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "undecided");
    EXPECT_EQ(checked.errors(), "dog-leg-rapid 7, dog-leg-rapid 7");
}

/// The same program for a control whose rapids need not be straight; nothing states what they are.
Checked check_for(const std::string& dialect, const std::string& stated = {}) {
    SetupWriter setup = post_beside_the_way();
    setup.program("dialect = \"" + dialect
                  + "\"\nstart = { X = -350, Y = -200, Z = 0 }\nno_decimal_point = \"units\"\n");
    return check(setup.also(stated), slanted);
}

TEST(Rapid, IsFollowedAsADogLegWhereTheControlMayRunOne) {
    for (const char* dialect : {"fanuc", "haas"}) {
        const Checked open = check_for(dialect);
        EXPECT_EQ(open.errors(), "open-premise 7") << dialect;
        EXPECT_EQ(open.verdict, "collision") << dialect;
        EXPECT_EQ(open.status, 1) << dialect;
    }
    EXPECT_NE(check_for("fanuc").finding("open-premise").message.find("1401#1"), std::string::npos);
    EXPECT_NE(check_for("haas").finding("open-premise").message.find("setting 335"),
              std::string::npos);
}

TEST(Rapid, IsStraightWhereTheSetupOrTheControlSaysSo) {
    EXPECT_EQ(check_for("fanuc", "[control]\n\"1401#1\" = 1\n").errors(), "");
    EXPECT_EQ(check_for("haas", "[control]\n\"setting 335\" = \"LINEAR\"\n").errors(), "");
    EXPECT_EQ(check_for("linuxcnc").errors(), "");
    SetupWriter straight = post_beside_the_way();
    straight.machine("rapid = \"straight\"\n" + SetupWriter::mill());
    EXPECT_EQ(check(straight, slanted).errors(), "");
}

TEST(Rapid, InFreeAirIsClearBothWays) {
    SetupWriter setup;
    setup.stock(far_stock);
    EXPECT_EQ(check(setup.also("[rules]\nnothing-cut = \"off\"\n"), slanted).errors(), "");
}

/// The stock is out of the way, on purpose.
SetupWriter without_cuts() {
    return SetupWriter().stock(far_stock).also("[rules]\nnothing-cut = \"off\"\n");
}

TEST(OverTravel, IsFoundInsideAnArcWhoseEndsAreWithinTheLimits) {
    // The half circle extends by its radius of 50: to Y220 of the work, 20 beyond machine zero.
    const SetupWriter setup = without_cuts();
    const Checked beyond = check(
        setup, program({"G0 X100. Y170.", "G0 Z20.", "G2 X200. Y170. I50. J0 F1000.", "G0 Z60."}));
    EXPECT_EQ(beyond.status, 1);
    EXPECT_EQ(beyond.errors(), "over-travel 8");
    EXPECT_NE(beyond.findings.at(0).message.find("20.000 mm beyond"), std::string::npos);
    const Checked within = check(
        setup, program({"G0 X100. Y150.", "G0 Z50.", "G2 X200. Y150. I50. J0 F1000.", "G0 Z60."}));
    EXPECT_EQ(within.errors(), "");
    EXPECT_EQ(within.status, 0);
}

TEST(OverTravel, IsNotFoundInTheHalfOfTheCircleThatIsNotDriven) {
    const Checked checked =
        check(without_cuts(),
              program({"G0 X100. Y170.", "G0 Z50.", "G3 X200. Y170. I50. J0 F1000.", "G0 Z60."}));
    EXPECT_EQ(checked.errors(), "");
}

TEST(OverTravel, IsFoundAHairBeyondTheLimitAndNotAtIt) {
    const SetupWriter setup = without_cuts();
    EXPECT_EQ(check(setup, program({"G0 Y200."})).errors(), "");
    EXPECT_EQ(check(setup, program({"G0 Y200.001"})).errors(), "over-travel 6");
}

TEST(OverTravel, OfAMachineMoveIsNotCuredByAnotherOffset) {
    const auto cure = [](const Checked& checked) { return checked.finding("over-travel").cure; };
    EXPECT_EQ(cure(check(without_cuts(), program({"G53 G0 Z10."}))),
              "Change the Z of this block: it is a machine coordinate, so neither the work offset "
              "nor the position of the work has an effect on it.");
    const auto siemens = [&](const std::string& move, const std::string& control) {
        return cure(check(without_cuts()
                              .program("dialect = \"siemens\"\n"
                                       "start = { X = -350, Y = -200, Z = 0 }\n")
                              .also("[control]\n" + control),
                          "G17 G71 G90 G94 G40\nT1\nM6\nD1\nS6000 M3\nG54 G0 X50 Y50\nZ60\n" + move
                              + "\nM30\n"));
    };
    const std::string tip = "Add D0 to this block: a tool length is active, so it moves the tip of "
                            "the tool to this Z, and the machine farther.";
    EXPECT_EQ(siemens("SUPA G0 Z0", ""),
              tip
                  + " If the control moves the gauge line there, state \"MD10760\" = 1 under "
                    "[control] in the set-up.");
    EXPECT_EQ(siemens("SUPA G0 Z0", "MD10760 = 0\n"), tip);
    EXPECT_EQ(siemens("SUPA G0 Z5", "MD10760 = 1\n").substr(0, 12), "Change the Z");
    EXPECT_EQ(siemens("SUPA G0 Z5 D0", "").substr(0, 12), "Change the Z");
}

TEST(OverTravel, OfALoopIsOneFindingForEachLimitThatNamesTheLargestExcess) {
    // Y200 of the work is the limit: from the 11th pass on the loop is beyond it, at last by 40.
    const Checked checked =
        check(without_cuts(), program({"G0 X100. Y150.", "#1=0", "WHILE[#1LT50]DO1", "#1=#1+1",
                                       "G0 Y[190.+#1]", "END1", "G0 Y150.", "G0 Y205."}));
    EXPECT_EQ(checked.errors(), "over-travel 10");
    EXPECT_EQ(checked.finding("over-travel").message,
              "Y goes to 1.000 in machine coordinates, 1.000 mm beyond its limit. 42 blocks go "
              "beyond it (lines 10, 12-13), the farthest by 40.000 mm, to 40.000, in line 10.");
}

TEST(OverTravel, IsReportedAtBothLimitsOfAnAxis) {
    const Checked checked =
        check(without_cuts(), program({"G0 Y205.", "G0 Y150.", "G0 Y-1000.", "G0 Y203."}));
    EXPECT_EQ(checked.errors(), "over-travel 6, over-travel 8");
    // The way back from beyond a limit counts, too.
    EXPECT_NE(checked.findings.at(0).message.find("3 blocks go beyond it (lines 6-7, 9), none of "
                                                  "them farther."),
              std::string::npos);
    EXPECT_NE(checked.findings.at(1).message.find("2 blocks go beyond it (lines 8-9)"),
              std::string::npos);
}

TEST(FirstMove, FromAnUnknownPositionIsAWarningOnly) {
    const SetupWriter setup = SetupWriter().without_machine().program("dialect = \"fanuc\"\n");
    const Checked checked =
        check(setup, program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 Z60."}));
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.errors(), "");
    EXPECT_EQ(checked.of_severity("warning"), "first-move 5");
    EXPECT_EQ(checked.at_line(8).verdict, "clear"); // by then every axis is known
    EXPECT_NEAR(checked.at_line(8).removed, 5000.0, 1.0);
}

TEST(FirstMove, FromHomeIsNoWarning) {
    const std::string home = "home = 0\nmin = -700\nmax = 0\n";
    const SetupWriter setup =
        SetupWriter()
            .program("dialect = \"fanuc\"\n")
            .machine(SetupWriter::axis("X", "direction = [1, 0, 0]\n" + home)
                     + SetupWriter::axis("Y", "direction = [0, 1, 0]\n" + home)
                     + SetupWriter::axis("Z", "direction = [0, 0, 1]\n" + home));
    const Checked checked = check(setup, program({"G0 X-20. Y50."}));
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.of_severity("warning"), "");
}

TEST(ToolChange, IsCheckedWithTheLengthOfTheNewTool) {
    // The second tool is 40 longer: after the change at Z30 its tip is 20 deep in the block.
    const std::string longer = "number = 2\nshape = \"flat\"\ndiameter = 10\nflute_length = 60\n"
                               "shank = [[10, 10, 25]]\nholder = [[40, 40, 50]]\n"
                               "[[length_offset]]\nnumber = 2\nlength = 135\n";
    const SetupWriter setup = SetupWriter().stock(far_stock).also_tool(longer).fixture(
        "block", "box = [[40, 40, 0], [60, 60, 30]]");
    const Checked checked = check(setup, program({"G0 X50. Y50.", "Z50.", "T2 M6", "G0 X0 Y0"}));
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.at_line(7).verdict, "clear");
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_EQ(checked.at_line(9).pair("flutes block").verdict, "collision");
    const Checked high = check(setup, program({"G0 X50. Y50.", "Z73.", "T2 M6", "G0 X0 Y0"}));
    EXPECT_EQ(high.status, 0);
    expect_encloses(high.at_line(9).pair("flutes block"), 3.0, 1e-6);
}

TEST(Tool, WithoutADescriptionLeavesItsMotionsUndecided) {
    const Checked checked =
        check(SetupWriter(), "G21 G90 G54\nT7 M6\nS6000 M3\nG0 G43 H1 Z60.\nM30\n");
    EXPECT_EQ(checked.of_severity("warning").substr(0, 19), "tool-not-in-table 2");
    EXPECT_EQ(checked.at_line(4).verdict, "undecided");
}

} // namespace
} // namespace app_test
