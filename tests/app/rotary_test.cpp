#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

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
