#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

// What only Grbl 1.1 does: gcode.c and protocol.c of gnea/grbl.

namespace gcode {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

constexpr DialectId grbl = DialectId::grbl, linuxcnc = DialectId::linuxcnc;

DialectId dialect_of(std::string_view text) {
    return recognise(program_from_text(text, "p.nc").value()).dialect;
}

TEST(GrblEnd, M30SetsModesBackAndTheNextLinesRun) {
    const std::string text = "G21 G91 G55 G18 M3 S100 M8\nG0 X5\nM30\nX2 F100\n";
    const Ran ran = run_text(text, grbl);
    ASSERT_FALSE(ran.run.error) << ran.run.error->message;
    EXPECT_THAT(commands_of(ran.run), HasSubstr("spindle direction=stopped speed=0\n"));
    EXPECT_THAT(commands_of(ran.run), EndsWith("straight_feed x=2 y=0 z=0 feed=100\n"));
    EXPECT_THAT(warnings_of(ran.run), HasSubstr("the program goes on after its end"));
    const ModalState& modal = ran.run.state.modal;
    EXPECT_EQ(modal.offsets.active, 0u);
    EXPECT_EQ(modal.plane, Plane::xy);
    EXPECT_EQ(modal.distance, DistanceMode::absolute);
    EXPECT_EQ(modal.spindle, core::SpindleDirection::stopped);
    EXPECT_FALSE(modal.flood);
    EXPECT_EQ(modal.unit, LengthUnit::mm);
    EXPECT_EQ(ran.run.state.ending, ProgramStatus::text_end);
    EXPECT_THAT(trace(text, linuxcnc), EndsWith("straight_traverse x=5 y=0 z=0\n"));
}

TEST(GrblEnd, NeedsNoWarningWhereNothingFollows) {
    for (const std::string end : {"M30", "M2\n", "M30\n\n(END)\n%\n", "M2\n; END\n%\n\n",
                                  "N8 M30\nN9 %\n", "M30 (END\n%\n"}) {
        const Ran ran = run_text("%\nG21 G90 G54\nG0 X1\n" + end, grbl);
        ASSERT_FALSE(ran.run.error) << end << ran.run.error->message;
        EXPECT_EQ(ran.run.state.ending, ProgramStatus::program_end) << end;
        EXPECT_EQ(warnings_of(ran.run), "") << end;
    }
}

TEST(GrblEnd, APercentSignHasNoEffect) {
    const std::string text = "%\nG21 G90 G54\nG0 X1\n%\nG0 X2\n%\n";
    EXPECT_THAT(trace(text, grbl), EndsWith("x=2 y=0 z=0\n"));
    EXPECT_THAT(warnings_of(text, grbl), HasSubstr("no M2 or M30"));
    EXPECT_THAT(trace(text, linuxcnc), EndsWith("x=1 y=0 z=0\n"));
}

TEST(GrblEnd, ABlockAfterItThatFailsIsStillAfterIt) {
    const Ran ran = run_text("G21 G90\nG0 X1\nM30\nG0 G49 X1\n", grbl);
    ASSERT_TRUE(ran.run.error);
    EXPECT_EQ(ran.run.error->where.line, 4u);
    EXPECT_TRUE(ran.run.state.after_end);
}

TEST(GrblLength, G49TakesAxisWordsAndMovesNothing) {
    const std::string text = "G21 G90\nG0 X1 Y1\nG43.1 Z5\nG49 X7 Y8\nG0 Z9\n";
    EXPECT_THAT(trace(text, grbl), Not(HasSubstr("x=7")));
    EXPECT_THAT(trace(text, grbl), HasSubstr("use_tool_length_offset length=0\n"));
    EXPECT_THAT(trace(text, grbl), EndsWith("straight_traverse x=1 y=1 z=9\n"));
    EXPECT_THAT(warnings_of(text, grbl), HasSubstr("G49 takes the axis words of this block"));
    EXPECT_THAT(warnings_of("G21 G90\nG49\nM2", grbl), Not(HasSubstr("G49")));
    EXPECT_THAT(trace("G21 G90\nG0 X1\nG49 X7\n", linuxcnc), HasSubstr("x=7 "));
}

TEST(GrblOffset, AMoveInTheBlockOfG921StillHasIt) {
    const Ran ran = run_text("G21 G90\nG92 X-10 Y-5\nG92.1 G0 X1\n", grbl);
    ASSERT_FALSE(ran.run.error) << ran.run.error->message;
    EXPECT_EQ(commands_of(ran.run), "set_offset offset=G54 x=10 y=5 z=0\n"
                                    "straight_traverse x=1 y=-5 z=0\n"
                                    "set_offset offset=G54 x=0 y=0 z=0\n");
    EXPECT_EQ(ran.run.state.modal.position[0], 11.0);
    EXPECT_EQ(ran.run.state.modal.position[1], 0.0);
    // On LinuxCNC the offset ends first, and along all axes.
    EXPECT_EQ(trace("G21 G90\nG92 X-10 Y-5\nG92.1 G0 X1\n", linuxcnc),
              "set_offset offset=G54 x=10 y=5 z=0\n"
              "set_offset offset=G54 x=0 y=0 z=0\n"
              "straight_traverse x=1 y=0 z=0\n");
}

TEST(GrblSlash, SkipsNothing) {
    const std::string text = "G21 G90 G54\n/G0 X1\nG0 /Y2\nM2\n";
    Environment environment = known_environment(grbl);
    environment.control.reports_premises = true;
    const Ran off = run_text(text, environment);
    ASSERT_FALSE(off.run.error) << off.run.error->message;
    EXPECT_THAT(commands_of(off.run), EndsWith("straight_traverse x=1 y=0 z=0\n"
                                               "straight_traverse x=1 y=2 z=0\n"));
    EXPECT_EQ(warnings_of(off.run), "");
    EXPECT_TRUE(off.run.state.readings->met.empty());
    environment.block_delete = true;
    const Ran on = run_text(text, environment);
    ASSERT_FALSE(on.run.error) << on.run.error->message;
    EXPECT_EQ(commands_of(on.run), commands_of(off.run));
    EXPECT_THAT(warnings_of(on.run), HasSubstr("block delete has no effect"));
}

TEST(GrblComment, EndsAtTheFirstBracketOrWithItsLine) {
    EXPECT_THAT(trace("G21 G90\nG0 X5 (unclosed", grbl), EndsWith("x=5 y=0 z=0\n"));
    EXPECT_THAT(trace("G21 G90\nG0 X5 (a (b) Y2 ; (c", grbl), EndsWith("x=5 y=2 z=0\n"));
    EXPECT_THAT(trace("G21 G90\nG0 X5 () Y3", grbl), EndsWith("x=5 y=3 z=0\n"));
    EXPECT_THAT(error_of("G21 G90\nG0 X5 (to the (second) hole)", grbl), HasSubstr("'hole'"));
    EXPECT_THAT(error_of("G21 G90\nG0 X5 (a (b))", grbl), HasSubstr("')'"));
    EXPECT_THAT(error_of("G21 G90\nG0 X5 (unclosed", linuxcnc), HasSubstr("not closed"));
}

/// Of the line after a head that sets the modes and moves to X1 Y1 Z1.
std::string refusal_of(const std::string& line) {
    return error_of("G21 G90 G17 F100\nG0 X1 Y1 Z1\n" + line, grbl);
}

TEST(GrblRefusal, OfAxisWordsAfterG80) {
    for (const char* line : {"G80\nX5", "G80\nG28 Z0", "G80\nG92 X5", "G80\nG49 X5", "G80 X5",
                             "G80\nG43.1 Z5", "G80\nG10 L2 P1 X5", "G80 G92.1\nX5"})
        EXPECT_THAT(refusal_of(line), HasSubstr("while G80 is active")) << line;
    EXPECT_THAT(refusal_of("G80\nX5"), HasSubstr("4:1: X5: "));
    EXPECT_THAT(refusal_of("G80\nX5"), HasSubstr("(error 31)"));
    for (const char* line : {"G80\nG0 X5", "G80\nG28", "G80 G90\nG1 X5\nX6", "G80 M30\nX5"})
        EXPECT_EQ(refusal_of(line), "") << line;
    for (const char* line : {"G80 G0 X5", "G1 G80 X5"})
        EXPECT_THAT(refusal_of(line), HasSubstr("are in the same modal group")) << line;
    EXPECT_EQ(error_of("G21 G90 F100\nG1 G80 X5", linuxcnc), "");
}

TEST(GrblRefusal, OfTwoCommandsForTheAxes) {
    for (const char* line : {"G0 G49 X5", "G49 G0", "G28 G0 X5", "G0 G43.1 Z5", "G1 G92 X5",
                             "G49 G92 X5", "G10 L2 P1 G1 X5"})
        EXPECT_THAT(refusal_of(line), HasSubstr("(error 24)")) << line;
    EXPECT_THAT(refusal_of("G0 G49 X5"), HasSubstr("3:4: G49: G0 in the same block"));
    for (const char* line : {"G28.1 G0 X5", "G92.1 X5", "G53 G0 X5", "G80 G49", "G4 P1 X5"})
        EXPECT_EQ(refusal_of(line), "") << line;
}

TEST(GrblRefusal, OfAxisWordsThatAreMissingOrDoNotBelong) {
    for (const char* line : {"G43.1", "G43.1 X0", "G43.1 X1 Z2"})
        EXPECT_THAT(refusal_of(line), HasSubstr("(error 37)")) << line;
    for (const char* line : {"G92", "G10 L2 P1", "G38.2", "G2", "G2 I5"})
        EXPECT_THAT(refusal_of(line), HasSubstr("(error 26)")) << line;
    EXPECT_THAT(refusal_of("G2 Z5 I5"), HasSubstr("an arc needs X or Y"));
    EXPECT_THAT(refusal_of("G2 Z5 I5"), HasSubstr("(error 32)"));
    EXPECT_THAT(refusal_of("G18 G2 Y5 I5"), HasSubstr("an arc needs Z or X"));
    EXPECT_THAT(refusal_of("G2 X5 I2\nI5"), HasSubstr("4:1: I5: "));
    EXPECT_EQ(refusal_of("G2 X1 I5"), ""); // a full circle
}

TEST(GrblRefusal, OfWordsThatItLacksOrDoesNotUse) {
    EXPECT_THAT(refusal_of("G2 X5 I2 P1"), HasSubstr("3:10: P1: "));
    EXPECT_THAT(refusal_of("G2 X5 I2 P1"), HasSubstr("(error 36)"));
    for (const char* line : {"G0 X5 A1", "B2", "G1 X2 C5", "G0 U3", "O100", "H1", "D2"})
        EXPECT_THAT(refusal_of(line), HasSubstr("(error 20)")) << line;
    EXPECT_THAT(refusal_of("G0 X5 A1"), HasSubstr("3:7: A1: Grbl has no word A"));
    EXPECT_THAT(refusal_of("#1=90"), HasSubstr("(error 1)"));
    for (const char* line : {"G0 X#1", "G0 X[1+2]", "G0 XSIN[30]"})
        EXPECT_THAT(refusal_of(line), HasSubstr("3:4: ")) << line;
    EXPECT_THAT(refusal_of("G0 X#1"), HasSubstr("(error 2)"));
    EXPECT_NE(refusal_of("G0 X-[5]"), "");
    EXPECT_EQ(error_of("#1=90\nG0 X#1", linuxcnc), "");
}

TEST(GrblRefusal, OfALineOfMoreThan79Characters) {
    const std::string zeros(20, '0');
    const std::string line =
        "G1 X1." + zeros + " Y1." + zeros + " Z1." + zeros + " F100.000"; // 79 without blanks
    EXPECT_EQ(refusal_of(line), "");
    EXPECT_EQ(refusal_of("/" + line + " (a comment) ; and another"), "");
    EXPECT_THAT(refusal_of(line + "0"), HasSubstr("(error 11)"));
    EXPECT_EQ(error_of("G21 G90\n" + line + "0", linuxcnc), "");
    const std::string plain = "N1 G1 G17 G21 G40 G54 G61 G90 G94 X1.00000000000000 "
                              "Y1.00000000000000 Z1.00000000000000 F1.";
    EXPECT_EQ(refusal_of(plain), "");
    EXPECT_THAT(refusal_of(plain + "0"), HasSubstr("(error 11)"));
}

TEST(GrblMachineMove, IsAbsoluteUnderG91) {
    EXPECT_THAT(trace("G21 G91\nG0 X2\nG53 G0 X5\nX1", grbl),
                EndsWith("straight_traverse x=5 y=0 z=0\nstraight_traverse x=6 y=0 z=0\n"));
    EXPECT_THAT(error_of("G21 G91\nG53 G0 X5", linuxcnc), HasSubstr("G53 with G91"));
}

TEST(GrblRecognition, LeavesLinesThatItWouldRefuseToOthers) {
    EXPECT_EQ(dialect_of("G21\nG0 X1\nM2\n"), grbl);
    EXPECT_EQ(dialect_of("G21\nG0 X1 A5\nM2\n"), linuxcnc);
    EXPECT_EQ(dialect_of("G0 G17 G40 G49 G80 G90\nG0 X1\nM2\n"), linuxcnc);
    EXPECT_EQ(dialect_of("G17 G40 G49 G80 G90\nG0 X1\nM2\n"), grbl);
}

} // namespace
} // namespace gcode
