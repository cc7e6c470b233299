#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::Ran;
using test_support::ScopedFolder;
using test_support::SetupWriter;

constexpr double pi = std::numbers::pi;

/// The tool is 10 mm wide and 95 mm long, flutes up to 20.
std::string five_axes(const std::string& more = "") {
    return SetupWriter::mill()
           + SetupWriter::axis("A", "side = \"table\"\npoint = [-350, -200, -440]\nmin = -120\n"
                                    "max = 120\nrapid = 3600\n")
           + SetupWriter::axis("C", "side = \"table\"\npoint = [-350, -200, -440]\nrapid = 7200\n")
           + more;
}

/// A cube of 40 with its centre where the axes A and C intersect; G54 is the centre of its top.
SetupWriter cube(const std::string& more = "") {
    return SetupWriter()
        .machine(five_axes(more))
        .stock("box = [[-20, -20, -40], [20, 20, 0]]")
        .also("[control]\n\"1008#0\" = 0\n");
}

std::string text(const std::string& blocks) {
    return "G21 G90 G40 G49 G80 G17\nT1 M6\nG54\nS6000 M3\n" + blocks + "\nM30\n";
}

TEST(Rotary, AnIndexedFaceIsCutLikeTheTop) {
    const Checked checked =
        check(cube(), text("G43 H1 Z50.\nX-40. Y0\nZ-3.\nG1 X40. F600.\nG0 Z50.\n"
                           "G0 A90.\nX-40. Y0\nZ-3.\nG1 X40.\nG0 Z50.\n"
                           "G0 A0 C90.\nX-40.\nZ-3.\nG1 X40.\nG0 Z50."));
    EXPECT_EQ(checked.errors(), "");
    EXPECT_EQ(checked.status, 0);
    const double slot = 40.0 * 10.0 * 3.0;
    EXPECT_NEAR(checked.at_line(8).removed, slot, 0.02 * slot);
    EXPECT_NEAR(checked.at_line(13).removed, slot, 0.02 * slot);
    // Across the first slot, where the material in the middle is already removed.
    EXPECT_NEAR(checked.at_line(18).removed, slot - 10.0 * 10.0 * 3.0, 0.02 * slot);
}

TEST(Rotary, ATiltedPlaneIsDrilledAlongItsOwnAxis) {
    // The plane is in the middle of the face towards -Y and faces that way.
    const Checked checked =
        check(cube(), text("G43 H1 Z120.\nG68.2 X0 Y-20. Z-20. I0 J90. K0\nG53.1\nG0 X3. Y4. Z5.\n"
                           "G1 Z-6. F100.\nG0 Z5.\nG69\nG53 G0 Z0\nG49"));
    EXPECT_EQ(checked.errors(), "");
    const double hole = pi * 25.0 * 6.0;
    EXPECT_NEAR(checked.at_line(9).removed, hole, 0.03 * hole);
    EXPECT_EQ(checked.at_line(7).motion, "rapid"); // G53.1 rotates the table
}

TEST(Rotary, ARapidTurnIntoTheToolIsACollision) {
    // The tip is 1 mm above the top; a corner of the cube moves up to 8 mm higher.
    const Checked checked = check(cube(), text("G43 H1 Z50.\nX0 Y0\nZ1.\nA45.\nZ50."));
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_EQ(checked.at_line(8).verdict, "collision");
    EXPECT_EQ(checked.at_line(8).pair("flutes stock").verdict, "collision");
    EXPECT_NE(checked.errors().find("rotary-with-tool-down 8"), std::string::npos);
    EXPECT_EQ(checked.status, 1);
}

TEST(Rotary, ATurnWithRoomIsClearAndItsDistanceKnown) {
    // The corner of the cube reaches 20 sqrt 2 above the axis while A rotates from 0 to 60.
    const Checked checked = check(cube(), text("G43 H1 Z50.\nX0 Y0\nZ20.\nA60.\nZ50."));
    EXPECT_EQ(checked.errors(), "");
    const PairLine flutes = checked.at_line(8).pair("flutes stock");
    const double gap = 40.0 - 20.0 * std::sqrt(2.0);
    EXPECT_LE(flutes.lower, gap);
    ASSERT_TRUE(flutes.upper);
    EXPECT_GE(*flutes.upper, gap - 1e-9);
    EXPECT_NEAR(flutes.lower, gap, 0.4);
    EXPECT_NEAR(*flutes.upper, gap, 0.4);
}

TEST(Rotary, ToolCentreControlKeepsTheTipOnItsLineWhileTheTableTurns) {
    // A swarf cut: the tip follows the lower edge of a wall that tilts from 0 to 20 degrees.
    // Whatever A does, the material along the tip's line at Z-10 is cut, and nothing below it
    // except by the tilt of the end face, 5 sin 20 at most.
    const Checked checked =
        check(cube(), text("G43.4 H1 Z60.\nX-40. Y0 A0\nZ-10.\nG1 X40. A20. F600.\nG0 Z60.\nG49\n"
                           "G53 G0 Z0"));
    EXPECT_EQ(checked.errors(), "");
    const double upright = 40.0 * 10.0 * 10.0;
    EXPECT_GT(checked.at_line(8).removed, upright);
    EXPECT_LT(checked.at_line(8).removed, upright / std::cos(20.0 * pi / 180.0) + 40.0 * 10.0);
}

/// The edge of the flutes ends exactly at the minimum clearance of 2 mm: 5 mm times sin 20 above
/// the tip. The path of the axes is known only within a chord error, so halving the leg decides
/// nothing.
TEST(Rotary, ATurnThatEndsExactlyAtTheMinimumClearanceIsMeasured) {
    const SetupWriter setup =
        cube().fixture("plate", "box = [[-70, -30, -40], [-22, 30, 0]]\nframe = \"G54\"\n");
    const Checked checked =
        check(setup, text("G43.4 H1 Z60.\nX-45. Y0 A0\nZ3.7101\nG1 X-40. A20. F600.\nG0 Z60.\nG49\n"
                          "G53 Z0"));
    EXPECT_LE(checked.status, 1);
    const PairLine pair = checked.at_line(8).pair("flutes plate");
    EXPECT_NEAR(pair.lower, 2.0, 0.01);
    EXPECT_NEAR(pair.upper.value_or(0.0), 2.0, 0.01);
}

TEST(Rotary, AnArcUnderTipControlIsNotFartherThanItIs) {
    // The tip runs round the middle of a post, at a distance of 20 from its wall.
    const Checked checked = check(
        SetupWriter()
            .machine(SetupWriter::mill()
                     + SetupWriter::axis("A", "side = \"table\"\npoint = [-350, -200, -440]\n")
                     + SetupWriter::axis("C", "side = \"table\"\npoint = [-350, -200, -440]\n"))
            .stock("box = [[-200, -200, -300], [-190, -190, -290]]")
            .fixture("post",
                     "cylinder = { radius = 10, height = 80 }\nat = [0, 0, -40]\nframe = \"G54\"\n")
            .also("[control]\n\"1008#0\" = 0\n"),
        text("G43.4 H1\nG0 X-35. Y0\nZ0\nG3 X35. Y0 I35. J0 F1000.\nG0 Z60.\nG49"));
    const PairLine flutes = checked.at_line(8).pair("flutes post");
    EXPECT_LE(flutes.lower, 20.0 + 1e-9);
    EXPECT_GE(flutes.lower, 20.0 - 0.003);
    ASSERT_TRUE(flutes.upper.has_value());
    EXPECT_GE(*flutes.upper, 20.0 - 1e-9);
    EXPECT_LE(*flutes.upper, 20.0 + 0.003);
}

TEST(Rotary, ATipThatATurnedSlideMovesIsNotChecked) {
    const std::string axes = SetupWriter::axis("X", "side = \"table\"\n")
                             + SetupWriter::axis("C", "side = \"tool\"\npoint = [0, 0, 100]\n")
                             + SetupWriter::axis("Z", "side = \"tool\"\n")
                             + SetupWriter::axis("Y", "side = \"tool\"\n")
                             + SetupWriter::axis("A", "side = \"tool\"\npoint = [0, 0, 100]\n");
    const auto checked_with = [&](const std::string& blocks) {
        return check(SetupWriter()
                         .machine("rapid = \"straight\"\n" + axes)
                         .stock("box = [[-200, -200, -300], [-190, -190, -290]]")
                         .also("[control]\n\"1008#0\" = 0\n"),
                     text(blocks));
    };
    const Checked turned = checked_with("G43.4 H1\nG0 X0 Y0 Z0\nG1 X10. A20. C30. F500.");
    EXPECT_NE(turned.verdict, "clear");
    EXPECT_THAT(turned.finding("undecided").message, testing::HasSubstr("carries a linear axis"));
    EXPECT_EQ(checked_with("G43.4 H1\nG0 X0 Y0 Z0\nG1 X10. F500.").errors(), "nothing-cut 7");
}

// The tool is turned in a plane, which the axes of the head follow within an error that shorter
// legs do not reduce.
TEST(Rotary, AToolThatIsTurnedInAPlaneIsCheckedToItsEnd) {
    const ScopedFolder folder;
    const std::string setup = folder.write(
        "setup.toml",
        "mesh_size = 2\n"
        "[[machine.axis]]\nname = \"A\"\nside = \"table\"\npoint = [-383.589, -221.249, -420.516]\n"
        "[[machine.axis]]\nname = \"C\"\nside = \"table\"\n"
        "direction = [0.00047143609324274609, 0.0005259128210104955, 0.99999975058182633]\n"
        "point = [-11.337, 103.126, -265.795]\n"
        "[stock]\nbox = [[-90000, -90000, 0], [-89990, -89990, 10]]\nframe = \"machine\"\n"
        "[offsets]\nG54 = { X = 6088.518, Y = -3219.499, Z = 760.694 }\n"
        "[[fixture]]\nname = \"jaw\"\nframe = \"G54\"\nat = [9.232, 0.77, -1.811]\n"
        "box = [[-11.532, -1.738, -5.126], [2.296, 12.254, 10.264]]\n");
    const std::string program =
        folder.write("turned.mpf", "TRAORI\nG1 X11.5377 Y-7.5969 Z-48.3412 A92.9371 C-5.1823 F789\n"
                                   "G1 X-14.0128 Y42.1730 Z-52.1880 A3=-0.128693576 B3=0.780580217 "
                                   "C3=0.611663706 F1361\n");
    EXPECT_EQ(check_files(program, setup).status, 1);
}

// Scaled eight times, the chords of the arc may leave it by more than a turn is measured to.
TEST(Rotary, AScaledArcOnWhichTheTableTurnsIsCheckedToItsEnd) {
    const Checked checked = check(
        SetupWriter()
            .root("mesh_size = 0.2\nallowance = 7\n")
            .program("dialect = \"fanuc\"\nstart = { X = 0, Y = 0, Z = 0, A = 0, C = 0 }\n")
            .machine("rapid = \"straight\"\n" + SetupWriter::axis("A", "point = [0, 0, -500]\n")
                     + SetupWriter::axis("C", "point = [0, 0, 0]\n"))
            .offsets("G54 = { X = 0, Y = 0, Z = -400 }\n")
            .stock("box = [[-90000, -90000, 0], [-89990, -89990, 10]]\nframe = \"machine\"")
            .tool("number = 1\nshape = \"flat\"\ndiameter = 2\nflute_length = 30\n"
                  "shank = [[2, 2, 8]]\nholder = [[3, 3, 41]]\n")
            .fixture("post", "cylinder = { radius = 2, height = 50 }\nframe = \"G54\"\n"
                             "at = [-28.136668, -10.40807, -10]\n")
            .also("[control]\n\"5006#6\" = 1\n\"1008#0\" = 0\n"),
        "G21 G90 G40 G49 G80 G17 G94 G54\nT1 M6\nS5000 M3\nG51 X0. Y0. Z0. P8.\nG43.4 H1\n"
        "G0 X-3.5 Y0. Z0. A0. C0.\nG3 X3.5 Y0. I3.5 J0. C20. F1000.\nM30\n");
    const PairLine flutes = checked.at_line(7).pair("flutes post");
    EXPECT_LT(flutes.lower, 7.0);
    ASSERT_TRUE(flutes.upper.has_value());
    EXPECT_GE(*flutes.upper, flutes.lower);
}

/// Where A stands at the end of a program on a table with A and C without limits, from its trace.
double a_at_end(const std::string& ending, const std::string& dialect, const std::string& program) {
    const ScopedFolder folder;
    const std::string setup = folder.write(
        "setup.toml",
        "[program]\ndialect = \"" + dialect
            + "\"\nstart = { X = 0, Y = 0, Z = 0, A = 0, C = 0 }\n"
              "[[machine.axis]]\nname = \"A\"\nside = \"table\"\npoint = [0, 0, -500]\n"
              "[[machine.axis]]\nname = \"C\"\nside = \"table\"\npoint = [0, 0, 0]\n"
              "[offsets]\nG54 = { X = 0, Y = 0, Z = -400 }\n"
              "[[tool]]\nnumber = 1\nshape = \"flat\"\ndiameter = 2\nflute_length = 30\n"
              "holder = [[3, 3, 41]]\n");
    const Ran ran = feeler({"trace", folder.write("program" + ending, program), "--setup", setup});
    EXPECT_EQ(ran.status, 0) << ran.err;
    const size_t last = ran.out.rfind(" a=");
    return last == std::string::npos ? std::nan("") : std::stod(ran.out.substr(last + 3));
}

TEST(Rotary, TheSignOfATiltIsThatOfTheAngleWhereverTheAxisStands) {
    for (const double stands : {-150.0, 0.0, 170.0, 350.0, -700.0}) {
        for (const double wanted : {50.0, -50.0}) {
            const bool positive = wanted > 0.0;
            const std::string siemens =
                fmt::format("G710 G90 G40 G17 G94 G54 G60\nT1\nM6\nD1\nS5000 M3\n"
                            "G0 X0 Y0 Z200 A={} C=0\n"
                            "CYCLE800(0,\"T\",0,57,0,0,0,50,0,0,0,0,0,{},100,1)\nM30\n",
                            stands, positive ? "1" : "-1");
            EXPECT_NEAR(std::remainder(a_at_end(".mpf", "siemens", siemens) - wanted, 360.0), 0.0,
                        1e-6)
                << siemens;
            const std::string heidenhain = fmt::format(
                "BEGIN PGM Q MM\nTOOL CALL 1 Z S5000\nL X+0 Y+0 Z+200 A{:+} C+0 FMAX M3\n"
                "PLANE SPATIAL SPA+50 SPB+0 SPC+0 TURN FMAX SEQ{}\nEND PGM Q MM\n",
                stands, positive ? "+" : "-");
            EXPECT_NEAR(std::remainder(a_at_end(".h", "heidenhain", heidenhain) - wanted, 360.0),
                        0.0, 1e-6)
                << heidenhain;
        }
    }
}

TEST(Rotary, LimitsOfRotaryAxesAreInDegrees) {
    const Checked checked = check(cube(), text("G43 H1 Z200.\nG0 A130."));
    EXPECT_EQ(checked.errors(), "over-travel 6");
    std::string messages;
    for (const FindingLine& finding : checked.findings) messages += finding.message;
    EXPECT_NE(messages.find("10.000 degrees beyond"), std::string::npos) << messages;
}

TEST(MachineBody, OnTheTableIsMetByTheTool) {
    const std::string jaw = "[[machine.body]]\nname = \"rim\"\naxis = \"C\"\n"
                            "box = [[-320, -230, -480], [-310, -170, -420]]\n";
    const Checked clear = check(cube(jaw), text("G43 H1 Z50.\nX28. Y0\nZ5."));
    // 5 mm above the top of the rim at G54 Z0, and in plan view 2 mm from its side: 3 minus 2.
    EXPECT_EQ(clear.errors(), "");
    const Checked near = check(cube(jaw), text("G43 H1 Z50.\nX24. Y0\nZ-5."));
    EXPECT_EQ(near.at_line(7).pair("flutes rim").verdict, "violation");
    expect_encloses(near.at_line(7).pair("flutes rim"), 1.0, 1e-6);
    // Half a turn of C brings the rim to the other side.
    const Checked turned = check(cube(jaw), text("G43 H1 Z50.\nC180.\nX26. Y0\nZ-5."));
    EXPECT_EQ(turned.errors(), "");
}

TEST(MachineBody, OfTheHeadIsCarriedWithTheTool) {
    const std::string nose = "[[machine.body]]\nname = \"nose\"\naxis = \"Z\"\n"
                             "cylinder = { radius = 40, height = 100 }\n";
    // The nose begins at the gauge line, 95 mm above the tip.
    const SetupWriter setup = cube(nose).fixture("post", "box = [[50, -5, -40], [60, 5, 60]]");
    const Checked checked = check(setup, text("G43 H1 Z0\nX0 Y0"));
    const PairLine pair = checked.at_line(6).pair("nose post");
    expect_encloses(pair, std::hypot(10.0, 35.0), 1e-6);
}

TEST(MachineBody, NeighboursAndWhatIsFixedTogetherAreNoPair) {
    const std::string bodies =
        "[[machine.body]]\nname = \"column\"\naxis = \"base\"\nbox = [[-1000, 100, -700], [100, "
        "300, 300]]\n"
        "[[machine.body]]\nname = \"ram\"\naxis = \"Z\"\nbox = [[-50, -50, 0], [50, 50, 400]]\n"
        "[[machine.body]]\nname = \"cradle\"\naxis = \"A\"\nbox = [[-450, -300, -600], [-250, "
        "-100, -500]]\n"
        "[[machine.body]]\nname = \"table\"\naxis = \"C\"\nbox = [[-400, -250, -500], [-300, -150, "
        "-480]]\n";
    const Checked checked = check(cube(bodies), text("G43 H1 Z50.\nX0 Y0"));
    EXPECT_EQ(checked.errors(), "");
    for (const PairLine& pair : checked.at_line(6).pairs) {
        EXPECT_NE(pair.name, "column cradle");
        EXPECT_NE(pair.name, "cradle table");
        EXPECT_NE(pair.name, "ram ram");
    }
}

} // namespace
} // namespace app_test
