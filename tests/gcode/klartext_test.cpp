#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/klartext_programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

TEST(KlartextMotion, FmaxIsARapidOfItsBlockAlone) {
    EXPECT_EQ(klartext("L X+10 F500\nL Y+5 FMAX\nL X-10\n"),
              "straight_feed x=10 y=0 z=0 feed=500\n"
              "straight_traverse x=10 y=5 z=0\n"
              "straight_feed x=-10 y=5 z=0 feed=500\n");
}

TEST(KlartextMotion, CountsAxesWithIFromWhereTheyAre) {
    EXPECT_EQ(klartext("L X+10 Y+10 FMAX\nL IX-4 Y+3 FMAX\nL IX + 1,5 FMAX\n"),
              "straight_traverse x=10 y=10 z=0\n"
              "straight_traverse x=6 y=3 z=0\n"
              "straight_traverse x=7.5 y=3 z=0\n");
}

TEST(KlartextMotion, ReadsBlockNumbersCommentsAndEmptyLetters) {
    EXPECT_EQ(
        klartext("12 L X+1 R F100 M ;to the part\n13 ;L X+2\n14 * - L X+3\n/15 L X+4\nX+5 FMAX\n"),
        "straight_feed x=1 y=0 z=0 feed=100\n"
        "straight_feed x=4 y=0 z=0 feed=100\n"
        "straight_traverse x=5 y=0 z=0\n");
}

TEST(KlartextMotion, InchesAreThoseOfBeginPgm) {
    EXPECT_EQ(trace("BEGIN PGM A INCH\nL X+1 FMAX\nEND PGM A INCH\n", DialectId::heidenhain),
              "straight_traverse x=25.4 y=0 z=0\n");
}

TEST(KlartextMotion, M91IsInMachineCoordinatesOfTheGaugeLine) {
    // Tool 1 is 50 long and the origin is at 100: the tip is at -10 - 100 - 50.
    Environment environment = known_environment(DialectId::heidenhain);
    environment.work_offsets[0][2] = 100.0;
    environment.tool_lengths[core::ToolNumber(1)] = 50.0;
    const Ran ran = run_text("BEGIN PGM A MM\nTOOL CALL 1 Z S100\nL Z-10 FMAX M91\nEND PGM A MM\n",
                             environment);
    EXPECT_THAT(commands_of(ran.run), HasSubstr("straight_traverse x=0 y=0 z=-160\n"));
}

TEST(KlartextMotion, StartsSpindleAndCoolantBeforeTheMotionAndStopsThemAfterIt) {
    EXPECT_EQ(klartext("L X+1 FMAX M13\nL X+2 FMAX M5 M9\n"),
              "spindle direction=clockwise speed=0\n"
              "coolant mist=0 flood=1\n"
              "straight_traverse x=1 y=0 z=0\n"
              "straight_traverse x=2 y=0 z=0\n"
              "spindle direction=stopped speed=0\n"
              "coolant mist=0 flood=0\n");
}

TEST(KlartextMotion, RefusesRadiusCompensationByName) {
    EXPECT_THAT(klartext_error("L X+10 RL F100\n"),
                HasSubstr("2:8: 'RL': cutter radius compensation"));
    EXPECT_THAT(klartext_error("APPR LT X+10 LEN5\n"), HasSubstr("'APPR' is not supported yet"));
    EXPECT_THAT(klartext_error("PLANE PROJECTED PROPR+30 PROMIN+0 ROT+0 STAY\n"),
                HasSubstr("PLANE PROJECTED is not supported yet"));
}

TEST(KlartextMotion, NamesWhatItCannotRead) {
    EXPECT_THAT(klartext_error("L X+10 H5\n"), HasSubstr("2:8: 'H' is not allowed in this block"));
    EXPECT_THAT(klartext_error("HELLO X+10\n"),
                HasSubstr("2:1: 'HELLO' does not start a Klartext statement"));
    EXPECT_THAT(klartext_error("L X FMAX\n"),
                HasSubstr("2:3: 'X ' must be followed by a number or a Q parameter"));
    EXPECT_THAT(klartext_error("L X+1 X+2 FMAX\n"),
                HasSubstr("2:7: 'X+2' appears twice in this block"));
    EXPECT_THAT(klartext_error("L X+10\n"), HasSubstr("no F has been programmed yet"));
    EXPECT_THAT(klartext_error("L X+10 FMAX M140 MB MAX\n"), HasSubstr("M140"));
}

TEST(KlartextArc, TurnsAroundThePole) {
    EXPECT_EQ(klartext("L X+10 F100\nCC X+0 Y+0\nC X+0 Y+10 DR+\nC DR-\n"),
              "straight_feed x=10 y=0 z=0 feed=100\n"
              "arc_feed x=0 y=10 z=0 plane=XY centre=0,0 turns=1 feed=100\n"
              "arc_feed x=0 y=10 z=0 plane=XY centre=0,0 turns=-1 feed=100\n");
}

TEST(KlartextArc, PoleCountsFromTheToolWithI) {
    EXPECT_EQ(klartext("L X+10 Y+2 F100\nCC IX-5 IY+0\nC IX-10 IY+0 DR-\n"),
              "straight_feed x=10 y=2 z=0 feed=100\n"
              "arc_feed x=0 y=2 z=0 plane=XY centre=5,2 turns=-1 feed=100\n");
}

TEST(KlartextArc, RefusesInvalidCircles) {
    EXPECT_THAT(
        klartext_error("L X+10 F100\nCC X+0 Y+0\nC X+0 Y+11 DR+\n"),
        HasSubstr("the radius of the arc is 10.0000 mm at its start and 11.0000 mm at its end"));
    EXPECT_THAT(klartext_error("L X+10 F100\nC X+0 Y+10 DR+\n"), HasSubstr("no CC"));
    EXPECT_THAT(klartext_error("CC X+0 Y+0\nL X+10 F100\nC X+0 Y+10\n"), HasSubstr("DR+"));
}

TEST(KlartextArc, SignOfTheRadiusChoosesTheShorterOrLongerArc) {
    // From (0,0) to (10,10) with radius 10: centres (0,10) and (10,0). The shorter counterclockwise
    // arc is about (0,10).
    EXPECT_EQ(klartext("L X+0 Y+0 F100\nCR X+10 Y+10 R+10 DR+\n"),
              "straight_feed x=0 y=0 z=0 feed=100\n"
              "arc_feed x=10 y=10 z=0 plane=XY centre=0,10 turns=1 feed=100\n");
    EXPECT_THAT(klartext("L X+0 Y+0 F100\nCR X+10 Y+10 R-10 DR+\n"),
                HasSubstr("centre=10,0 turns=1"));
    EXPECT_THAT(klartext("L X+0 Y+0 F100\nCR X+10 Y+10 R+10 DR-\n"),
                HasSubstr("centre=10,0 turns=-1"));
}

TEST(KlartextArc, TangentArcContinuesInThePreviousDirection) {
    // Along +X to (10,0), then two quarters of the circle about (10,10).
    EXPECT_EQ(klartext("L X+10 Y+0 F100\nCT X+20 Y+10\nCT IX-10 IY+10\n"),
              "straight_feed x=10 y=0 z=0 feed=100\n"
              "arc_feed x=20 y=10 z=0 plane=XY centre=10,10 turns=1 feed=100\n"
              "arc_feed x=10 y=20 z=0 plane=XY centre=10,10 turns=1 feed=100\n");
    EXPECT_THAT(klartext_error("CT X+20 Y+10 F100\n"), HasSubstr("no previous move in the plane"));
}

TEST(KlartextArc, PolarPositionsTurnAboutThePole) {
    EXPECT_EQ(klartext("CC X+10 Y+0\nLP PR+5 PA+90 FMAX\nLP IPA+90 F100\nCP IPA+90 DR+\n"),
              "straight_traverse x=10 y=5 z=0\n"
              "straight_feed x=5 y=0 z=0 feed=100\n"
              "arc_feed x=10 y=-5 z=0 plane=XY centre=10,0 turns=1 feed=100\n");
}

TEST(KlartextArc, PolarHelixHasItsTurns) {
    EXPECT_EQ(klartext("CC X+0 Y+0\nL X+5 F100\nCP IPA-720 IZ-3 DR-\n"),
              "straight_feed x=5 y=0 z=0 feed=100\n"
              "arc_feed x=5 y=0 z=-3 plane=XY centre=0,0 turns=-2 feed=100\n");
    EXPECT_THAT(klartext_error("CC X+0 Y+0\nL X+5 F100\nCP IPA-720 IZ-3 DR+\n"),
                HasSubstr("different signs"));
}

TEST(KlartextTool, CallBringsToolLengthAndSpeed) {
    EXPECT_EQ(klartext("TOOL DEF 5 L+20 R+3\nTOOL CALL 5 Z S1000 F200 DL+0.5 DR+0.1\n"
                       "L Z+30 FAUTO M3\nTOOL CALL S500\nL Z+Q108\n"),
              "select_plane plane=XY\n"
              "select_tool tool=5\n"
              "change_tool tool=5\n"
              "use_tool_length_offset number=5 length=20.5\n"
              "spindle direction=clockwise speed=1000\n"
              "straight_feed x=0 y=0 z=30 feed=200\n"
              "spindle direction=clockwise speed=500\n"
              "straight_feed x=0 y=0 z=3.1 feed=200\n");
}

TEST(KlartextTool, WarnsWhereProgramAndTableDiffer) {
    Environment environment = known_environment(DialectId::heidenhain);
    environment.tool_lengths[core::ToolNumber(5)] = 80.0;
    const std::string text = "BEGIN PGM A MM\nTOOL DEF 5 L+20 R+3\nEND PGM A MM\n";
    EXPECT_THAT(warnings_of(run_text(text, environment).run),
                HasSubstr("L20: the tool table gives 80.0000 mm as the length of tool 5"));
}

TEST(KlartextFrame, DatumShiftMovesTheProgram) {
    EXPECT_EQ(klartext("CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1  X + 10\nCYCL DEF 7.2 IX+2\nL X+1 "
                       "FMAX\nCYCL DEF 7.1 X+0\nL FMAX\nL IY+1 FMAX\n"),
              "set_offset offset=G54 x=10 y=0 z=0\n"
              "set_offset offset=G54 x=12 y=0 z=0\n"
              "straight_traverse x=1 y=0 z=0\n"
              "set_offset offset=G54 x=0 y=0 z=0\n"
              "straight_traverse x=13 y=1 z=0\n");
}

TEST(KlartextFrame, TurnsAndMirrorsInTheOrderOfTheProgram) {
    // Shifted to (10,0), then rotated by 90 degrees: program (1,0) is machine (10,1).
    const std::string shifted = "CYCL DEF 7.0\nCYCL DEF 7.1 X+10\n";
    const std::string turned = "CYCL DEF 10.0\nCYCL DEF 10.1 ROT+90\n";
    const std::string read = "L X+1 Y+0 FMAX\nFN 18: SYSREAD Q1 = ID240 NR1 IDX1\n"
                             "FN 18: SYSREAD Q2 = ID240 NR1 IDX2\nCYCL DEF 10.0\nCYCL DEF 10.1 "
                             "ROT+0\nCYCL DEF 7.0\nCYCL DEF 7.1 X+0\nCYCL DEF 8.0\nCYCL DEF "
                             "8.1\nL X+Q1 Y+Q2 FMAX\n";
    EXPECT_THAT(klartext(shifted + turned + read), HasSubstr("straight_traverse x=10 y=1 z=0\n"));
    // In the other order the shift is along the rotated axis: (0, 10 + 1).
    EXPECT_THAT(klartext(turned + shifted + read), HasSubstr("straight_traverse x=0 y=11 z=0\n"));
    EXPECT_THAT(klartext("CYCL DEF 8.0\nCYCL DEF 8.1 X\n" + shifted + read),
                HasSubstr("straight_traverse x=-11 y=0 z=0\n"));
}

TEST(KlartextFrame, DwellsAndNotes) {
    EXPECT_EQ(klartext("CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5\nCYCLE DEF 9.1 "
                       "5\nCYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.05\nBLK FORM 0.1 Z X+0 Y+0 "
                       "Z-5\nPLANE RESET STAY\nCYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+0 B+0 "
                       "C+0\nSTOP M6\nL M128\n"),
              "dwell seconds=1.5\ndwell seconds=5\nset_path_mode mode=continuous tolerance=0.05 "
              "naive_tolerance=0\nprogram_stop\n");
}

} // namespace
} // namespace gcode
