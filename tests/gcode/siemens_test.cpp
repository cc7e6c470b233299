#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/siemens/siemens_state.h"
#include "tests/gcode/siemens_programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

// Source of the expected values: SINUMERIK 840D sl / 828D, Programming Manual Fundamentals
// (6FC5398-1BP40) and Job Planning (6FC5398-2BP40), under the names of the commands.

TEST(SiemensWords, ReadsWordsWithAndWithoutEquals) {
    EXPECT_EQ(siemens("N10 G0 X10 Y-2.5\nN20G1X=3+4*2 Y=-(1+1)F500 ; comment\n:30 Z1EX-1\n"),
              "straight_traverse x=10 y=-2.5 z=0\n"
              "straight_feed x=11 y=-2 z=0 feed=500\n"
              "straight_feed x=11 y=-2 z=0.1 feed=500\n");
}

TEST(SiemensWords, CountsAxesByThemselvesWithAcAndIc) {
    EXPECT_EQ(siemens("G90 G0 X10 Y10\nX=IC(2) Y=AC(3)\nG91 X=AC(1) Y1\n"),
              "straight_traverse x=10 y=10 z=0\n"
              "straight_traverse x=12 y=3 z=0\n"
              "straight_traverse x=1 y=4 z=0\n");
}

TEST(SiemensWords, InchesOfG70AreOfLengthsAndThoseOfG700OfFeedsToo) {
    EXPECT_EQ(siemens("G70 G1 X1 F100\nG700 X2 F10\nG710 X10 F10\n"),
              "straight_feed x=25.4 y=0 z=0 feed=100\n"
              "straight_feed x=50.8 y=0 z=0 feed=254\n"
              "straight_feed x=10 y=0 z=0 feed=10\n");
}

TEST(SiemensWords, DwellsInSecondsOrTurns) {
    EXPECT_EQ(siemens("S120 M3\nG4 F1.5\nG4 S4\n"), "spindle direction=clockwise speed=120\n"
                                                    "dwell seconds=1.5\n"
                                                    "dwell seconds=2\n");
}

TEST(SiemensWords, NamesWhatItCannotRead) {
    EXPECT_THAT(siemens_error("N10 G0 X10 FOO\n"),
                HasSubstr("1:12: 'FOO' is not a word of this control"));
    EXPECT_THAT(siemens_error("FOO X10\n"), HasSubstr("1:1: 'FOO' is called here"));
    EXPECT_THAT(
        siemens_error("FOO\n"),
        HasSubstr("1:1: 'FOO' is not a word of this control, and there is no program FOO.SPF"));
    EXPECT_THAT(siemens_error("G0 X\n"), HasSubstr("1:4: 'X' must be followed by a number"));
    EXPECT_THAT(siemens_error("G0 X1 X2\n"), HasSubstr("1:7: 'X2' appears twice in this block"));
    EXPECT_THAT(siemens_error("G777 X1\n"),
                HasSubstr("1:1: G777: the dialect siemens has no such code"));
    EXPECT_THAT(siemens_error("G1 X1 F1 RND=5\n"), HasSubstr("1:10: 'RND': corners"));
    EXPECT_THAT(siemens_error("G1 X=FOO F1\n"),
                HasSubstr("1:6: 'foo': this variable is not defined in this program"));
    EXPECT_THAT(siemens_error("G1 X=FOO(1)\n"),
                HasSubstr("1:6: 'FOO': this function is not supported; supported are SIN"));
    EXPECT_THAT(siemens_error("G2 X1 Y0 I1=IC(5) F1\n"),
                HasSubstr("1:13: 'IC' is not supported here: it can only be the whole value of"));
    EXPECT_THAT(siemens_error("FOO=1\n"),
                HasSubstr("'foo': this variable is not defined in this program"));
    EXPECT_THAT(siemens_error("G0 X1\n(comment)\n"), HasSubstr("comments start with ';'"));
    EXPECT_THAT(siemens_error("G1 A3=1 F1\n"), HasSubstr("1:4: A2 to C3 turn the tool"));
    EXPECT_THAT(siemens_error("G1 A8=1 F1\n"), HasSubstr("1:4: 'A8=': there is no such axis"));
    EXPECT_THAT(siemens_error("G0 X10 R5\n"),
                HasSubstr("1:8: 'R5' alone has no effect: set the parameter with '='"));
    EXPECT_THAT(siemens_error("G1 X1 F1 E5\n"), HasSubstr("1:10: 'E'"));
    EXPECT_THAT(siemens_error("G1 X1\n"), HasSubstr("no feed rate"));
    EXPECT_THAT(siemens_error("ASPLINE X1\n"), HasSubstr("'ASPLINE': splines"));
}

TEST(SiemensWords, WarnsOfUnknownMCodesOnly) {
    EXPECT_THAT(warnings_of("G710\nM123\nM30\n", DialectId::siemens),
                HasSubstr("M123: unknown M code, probably of the machine builder"));
    EXPECT_EQ(
        warnings_of("G710 SOFT FFWON COMPOF\nCYCLE832(0.01,3)\nSTOPRE\nM30\n", DialectId::siemens),
        "");
    EXPECT_THAT(warnings_of("G710\nTRAORI(2)\nM30\n", DialectId::siemens),
                HasSubstr("TRAORI: motions are not checked while it is on and a rotary axis"));
}

TEST(SiemensWords, PassOverNothingInSilence) {
    const auto warned = [](const std::string& text) {
        return warnings_of("G710\nG0 X0\n" + text + "\nM30\n", DialectId::siemens);
    };
    EXPECT_THAT(warned("X1 I5"), HasSubstr("I5: no code in this block uses this word"));
    EXPECT_THAT(warned("X1 CR=5"), HasSubstr("CR=5: no code in this block uses this word"));
    EXPECT_THAT(warned("X1 RPL=5"), HasSubstr("RPL=5: no code in this block uses this word"));
    EXPECT_THAT(warned("X1 I1=5"), HasSubstr("I1=5: no code in this block uses this word"));
    EXPECT_THAT(warned("M2=3 S2=100"), HasSubstr("not for spindle 1"));
    EXPECT_THAT(siemens_error("G4 F1 X10\n"), HasSubstr("1:1: G4 must be in a block by itself"));
    EXPECT_THAT(siemens_error("GOTOF OUT G0 X10\nOUT:\n"),
                HasSubstr("1:1: 'GOTOF OUT' must be in a block by itself"));
}

TEST(SiemensExpression, FollowsTheControlsPriorities) {
    const auto value = [](const std::string& text) { return siemens("G0 X=" + text + "\n"); };
    EXPECT_EQ(value("2+3*4"), "straight_traverse x=14 y=0 z=0\n");
    EXPECT_EQ(value("7 DIV 2"), "straight_traverse x=3 y=0 z=0\n");
    EXPECT_EQ(value("7 MOD 4"), "straight_traverse x=3 y=0 z=0\n");
    EXPECT_EQ(value("7/2"), "straight_traverse x=3.5 y=0 z=0\n");
    EXPECT_EQ(value("SQRT(POT(3)+POT(4))"), "straight_traverse x=5 y=0 z=0\n");
    EXPECT_EQ(value("SIN(30)*10"), "straight_traverse x=5 y=0 z=0\n");
    EXPECT_EQ(value("ATAN2(1,-1)"), "straight_traverse x=135 y=0 z=0\n");
    EXPECT_EQ(value("TRUNC(-2.7)"), "straight_traverse x=-2 y=0 z=0\n");
    EXPECT_EQ(value("ROUND(2.5)"), "straight_traverse x=3 y=0 z=0\n");
    EXPECT_EQ(value("MAXVAL(2,'HA')"), "straight_traverse x=10 y=0 z=0\n");
    EXPECT_EQ(value("(2<3) AND NOT (1==2)"), "straight_traverse x=1 y=0 z=0\n");
    EXPECT_THAT(siemens_error("G0 X=1/0\n"), HasSubstr("1:7: this is a division by zero"));
}

TEST(SiemensParameters, AreSetInTheOrderOfTheBlock) {
    EXPECT_EQ(siemens("R1=2 R0=R1+1 R[R0]=7\nG0 X=R1 Y=R0 Z=R3\nR1=R1+1 X=R1\n"),
              "straight_traverse x=2 y=3 z=7\n"
              "straight_traverse x=3 y=3 z=7\n");
    EXPECT_EQ(siemens("G0 X=R99\n"), "straight_traverse x=0 y=0 z=0\n");
}

TEST(SiemensParameters, DeclaredVariablesHoldTheirTypes) {
    EXPECT_EQ(siemens("DEF REAL _LEN=1.5, WIDE\nDEF INT CNT\nDEF BOOL FLAG\nWIDE=_LEN*2 CNT=2.6 "
                      "FLAG=5\nG0 X=WIDE Y=CNT Z=FLAG\n"),
              "straight_traverse x=3 y=3 z=1\n");
    EXPECT_THAT(siemens_error("DEF STRING[8] NAME\n"), HasSubstr("'STRING': variables"));
    EXPECT_THAT(siemens_error("DEF REAL ARR[3]\n"), HasSubstr("arrays"));
}

TEST(SiemensArc, ReadsCentresRadiiAndTurns) {
    EXPECT_EQ(siemens("G1 X0 Y0 F100\nG2 X10 Y10 CR=10\nG3 X0 Y0 CR=-10\n"),
              "straight_feed x=0 y=0 z=0 feed=100\n"
              "arc_feed x=10 y=10 z=0 plane=XY centre=10,0 turns=-1 feed=100\n"
              "arc_feed x=0 y=0 z=0 plane=XY centre=0,10 turns=1 feed=100\n");
    EXPECT_EQ(siemens("G1 X10 F100\nG3 X10 Y0 Z-4 I=AC(5) J0 TURN=2\n"),
              "straight_feed x=10 y=0 z=0 feed=100\n"
              "arc_feed x=10 y=0 z=-4 plane=XY centre=5,0 turns=3 feed=100\n");
}

TEST(SiemensArc, OpensByAnAngle) {
    // A quarter about (0,0) from (10,0).
    EXPECT_EQ(siemens("G1 X10 F100\nG3 X0 Y10 AR=90\nG3 I0 J-10 AR=90\n"),
              "straight_feed x=10 y=0 z=0 feed=100\n"
              "arc_feed x=0 y=10 z=0 plane=XY centre=0,0 turns=1 feed=100\n"
              "arc_feed x=-10 y=0 z=0 plane=XY centre=0,0 turns=1 feed=100\n");
}

TEST(SiemensArc, GoesThroughAPointOrOnInItsDirection) {
    EXPECT_EQ(siemens("G1 X10 F100\nCIP X-10 Y0 I1=0 J1=10\n"),
              "straight_feed x=10 y=0 z=0 feed=100\n"
              "arc_feed x=-10 y=0 z=0 plane=XY centre=0,0 turns=1 feed=100\n");
    EXPECT_EQ(siemens("G1 X10 F100\nCT X20 Y10\nX10 Y20\nG1 X0\n"),
              "straight_feed x=10 y=0 z=0 feed=100\n"
              "arc_feed x=20 y=10 z=0 plane=XY centre=10,10 turns=1 feed=100\n"
              "arc_feed x=10 y=20 z=0 plane=XY centre=10,10 turns=1 feed=100\n"
              "straight_feed x=0 y=20 z=0 feed=100\n");
}

TEST(SiemensArc, EndsNearItsCircle) {
    // MD21000: 0.01 mm, MD21010: a thousandth of the radius.
    EXPECT_EQ(siemens_error("G1 X10 F100\nG3 X0 Y10.009 I-10 J0\n"), "");
    EXPECT_THAT(siemens_error("G1 X10 F100\nG3 X0 Y10.02 I-10 J0\n"), HasSubstr("radius"));
    EXPECT_EQ(siemens_error("G1 X1000 F100\nG3 X0 Y1000.9 I-1000 J0\n"), "");
}

TEST(SiemensPolar, PositionsTurnAboutThePole) {
    EXPECT_EQ(siemens("G0 X30 Y40\nG111 X40 Y30\nG0 RP=10 AP=0\nAP=90\nG1 AP=IC(90) F100\n"
                      "G3 AP=270 RP=10\n"),
              "straight_traverse x=30 y=40 z=0\n"
              "straight_traverse x=50 y=30 z=0\n"
              "straight_traverse x=40 y=40 z=0\n"
              "straight_feed x=30 y=30 z=0 feed=100\n"
              "arc_feed x=40 y=20 z=0 plane=XY centre=40,30 turns=1 feed=100\n");
    EXPECT_EQ(siemens("G0 X5 Y5\nG110 X5\nG112 Y1\nRP=2 AP=0\n"),
              "straight_traverse x=5 y=5 z=0\n"
              "straight_traverse x=12 y=6 z=0\n");
}

TEST(SiemensOffset, SupaIsInMachineCoordinatesAndKeepsTheToolsLength) {
    Environment environment = known_environment(DialectId::siemens);
    environment.work_offsets[0][2] = 100.0;
    environment.tool_lengths[core::ToolNumber(1)] = 50.0;
    // The tip at machine 0 is at -100 of G54; without D it is the gauge line.
    const Ran ran = run_text("T1\nM6\nSUPA G0 Z0\nSUPA Z0 D0\nG500 Z1\n", environment);
    EXPECT_THAT(commands_of(ran.run), HasSubstr("straight_traverse x=0 y=0 z=-100\n"
                                                "use_tool_length_offset length=0\n"
                                                "straight_traverse x=0 y=0 z=-100\n"
                                                "set_offset offset=G500 x=0 y=0 z=0\n"
                                                "straight_traverse x=0 y=0 z=1\n"));
    EXPECT_EQ(ran.run.state.modal.position[2], 1.0);
}

TEST(SiemensOffset, NumbersGoFromG54ToG599) {
    Environment environment = known_environment(DialectId::siemens);
    environment.work_offsets[4][0] = 7.0;
    const Ran ran = run_text("G505\nG0 X0\n", environment);
    EXPECT_EQ(machine_from_program(ran.run.state.modal.offsets, ran.run.state.modal.position)[0],
              7.0);
    EXPECT_THAT(warnings_of("G599\n", DialectId::siemens), HasSubstr("unknown and assumed"));
}

TEST(SiemensTool, LengthComesWithTheChangeAndD0TakesItAway) {
    Environment environment = known_environment(DialectId::siemens);
    environment.tool_lengths[core::ToolNumber(3)] = 50.0;
    const Ran ran = run_text("T3\nM6\nD0\nD1\n", environment);
    EXPECT_EQ(commands_of(ran.run), "select_tool tool=3\n"
                                    "change_tool tool=3\n"
                                    "use_tool_length_offset number=3 length=50\n"
                                    "use_tool_length_offset length=0\n"
                                    "use_tool_length_offset number=3 length=50\n");
}

TEST(SiemensTool, NamesBecomeNumbersAndAreSaid) {
    EXPECT_THAT(siemens("T=\"DRILL\" M6\nT=\"MILL\"\nT=\"DRILL\"\n"),
                testing::AllOf(HasSubstr("select_tool tool=2"), HasSubstr("change_tool tool=1")));
    EXPECT_THAT(warnings_of("T=\"DRILL\"\n", DialectId::siemens),
                HasSubstr("\"DRILL\" is tool 1 here"));
}

TEST(SiemensFrame, ShiftsTurnsAndMirrorsInTheOrderOfTheProgram) {
    const auto machine = [](const std::string& frames) {
        const Ran ran = run_text(frames + "G0 X1 Y0\n", DialectId::siemens);
        EXPECT_FALSE(ran.run.error);
        const auto place =
            machine_from_program(ran.run.state.modal.offsets, ran.run.state.modal.position);
        return std::make_pair(std::round(*place[0] * 1e9) / 1e9, std::round(*place[1] * 1e9) / 1e9);
    };
    EXPECT_EQ(machine("TRANS X10 Y5\n"), std::make_pair(11.0, 5.0));
    EXPECT_EQ(machine("TRANS X10\nAROT RPL=90\n"), std::make_pair(10.0, 1.0));
    EXPECT_EQ(machine("ROT RPL=90\nATRANS X10\n"), std::make_pair(0.0, 11.0));
    EXPECT_EQ(machine("ROT Z90\nATRANS X10\nTRANS X1\n"), std::make_pair(2.0, 0.0));
    EXPECT_EQ(machine("TRANS X10\nAMIRROR X0\n"), std::make_pair(9.0, 0.0));
    EXPECT_EQ(machine("TRANS X10\nASCALE X2 Y2\n"), std::make_pair(12.0, 0.0));
    EXPECT_EQ(machine("TRANS X10\nTRANS\n"), std::make_pair(1.0, 0.0));
}

TEST(SiemensFrame, RefusesDistortedArcsAndTiltedPlanes) {
    EXPECT_THAT(siemens_error("SCALE X2\nG1 X5 F100\nG2 X10 I2.5\n"),
                HasSubstr("SCALE uses different factors"));
    EXPECT_EQ(siemens_error("CYCLE800()\n"), "");
    EXPECT_TRUE(run_text("ROT X30\n", DialectId::siemens).run.state.modal.offsets.frame.tilts_tool);
}

TEST(SiemensFrame, RadiusCompensationTakesTheToolsOwnDiameter) {
    Environment environment = known_environment(DialectId::siemens);
    environment.tool_diameters[core::ToolNumber(4)] = 10.0;
    const Ran ran =
        run_text("T4\nM6\nG0 X-20 Y0\nG1 G41 D1 X0 F100\nX20\nG40 X40 Y20\nM30\n", environment);
    EXPECT_FALSE(ran.run.error) << ran.run.error->message;
    EXPECT_THAT(commands_of(ran.run), HasSubstr("y=5 z=0 feed=100"));
}

TEST(SiemensFrame, TheReferencePointIsNotPartOfACompensatedContour) {
    Environment environment = known_environment(DialectId::siemens);
    environment.tool_diameters[core::ToolNumber(4)] = 10.0;
    const Ran ran = run_text("T4\nM6\nG0 X-20 Y0\nG1 G41 D1 X0 F100\nX20\nG74 X1=0 Y1=0\n"
                             "G0 X40 Y0\nG1 Y50\nG40 X60\nM30\n",
                             environment);
    EXPECT_FALSE(ran.run.error) << ran.run.error->message;
    EXPECT_THAT(commands_of(ran.run), HasSubstr("x=20 y=5 z=0 feed=100"));
}

TEST(SiemensState, IsAsBeforeTheBlockAtFaultAndCopiesAgree) {
    const std::string good = "R1=5\nDEF REAL LEN=2\nTRANS X3\nG0 X=R1\n";
    const Ran before = run_text(good, DialectId::siemens);
    const Ran failed = run_text(good + "R1=6 LEN=7 X=1/0\n", DialectId::siemens);
    ASSERT_TRUE(failed.run.error);
    InterpreterState state = failed.run.state;
    state.ending = before.run.state.ending;
    EXPECT_EQ(state.parameters->numbered(1), Value(5.0));
    EXPECT_EQ(state.frames.back().named.at("len"), 2.0);
    EXPECT_EQ(state.modal, before.run.state.modal);
    EXPECT_EQ(digest_of(state), digest_of(InterpreterState(state)));
    InterpreterState other = state;
    writable_siemens(other).edge = 2;
    EXPECT_NE(digest_of(state), digest_of(other));
    EXPECT_EQ(siemens_of(state).edge, 1);
}

TEST(SiemensRecognition, SeesNativePrograms) {
    const auto recognised = [](std::string_view text, std::string file = {}) {
        return recognise(*program_from_text(text, std::move(file))).dialect;
    };
    EXPECT_EQ(recognised("G0 X1\n", "part.mpf"), DialectId::siemens);
    EXPECT_EQ(recognised("%_N_PART_MPF\nG0 X1\n"), DialectId::siemens);
    EXPECT_EQ(recognised(";$PATH=/_N_WKS_DIR\nG0 X1\n"), DialectId::siemens);
    EXPECT_EQ(recognised("N10 R1=5\n"), DialectId::siemens);
    EXPECT_EQ(recognised("N10 MSG(\"A\")\n"), DialectId::siemens);
    EXPECT_EQ(recognised("G0 X1\nG2 X5 CR=5\n"), DialectId::siemens);
    EXPECT_EQ(recognised("G0 X1\nCYCLE83(1,2,3)\n"), DialectId::siemens);
    EXPECT_NE(recognised("O1000\n#1=5\nG0 X1\n"), DialectId::siemens);
    EXPECT_NE(recognised("G0 X1 (CR=5)\nG2 X1 R5\n"), DialectId::siemens);
}

TEST(SiemensIso, G291BeginsFanucsLanguageAndG290EndsIt) {
    EXPECT_EQ(siemens("G0 X1\nG291\n#1=5\nG0 X#1\nG81 Z-2 R1 F100\nG80\nG290\nR1=7\nG0 X=R1\n"),
              "straight_traverse x=1 y=0 z=0\n"
              "straight_traverse x=5 y=0 z=0\n"
              "straight_traverse x=5 y=0 z=0\n"
              "straight_traverse x=5 y=0 z=1\n"
              "straight_feed x=5 y=0 z=-2 feed=100\n"
              "straight_traverse x=5 y=0 z=0\n"
              "straight_traverse x=7 y=0 z=0\n");
    EXPECT_EQ(trace("O1\nG90 G0 X#1 Y5.\nM30\n", DialectId::siemens_iso),
              "straight_traverse x=0 y=5 z=0\n");
}

} // namespace
} // namespace gcode
