#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/language/codes.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

TEST(Codes, AreFoundByTheirNumber) {
    const Code* code = find_code('G', 59.3, DialectId::linuxcnc);
    ASSERT_NE(code, nullptr);
    EXPECT_EQ(code->number, g_code(59, 3));
    EXPECT_EQ(code->group, ModalGroup::work_offset);
    EXPECT_EQ(find_code('M', 593, DialectId::linuxcnc), nullptr);
    EXPECT_EQ(find_code('G', 59.35, DialectId::linuxcnc), nullptr);
    EXPECT_EQ(find_code('G', -1, DialectId::linuxcnc), nullptr);
    EXPECT_EQ(find_code('G', 1e300, DialectId::linuxcnc), nullptr);
}

TEST(Codes, OfGAndMAreDifferentNumbers) {
    EXPECT_NE(g_code(6), m_code(6));
    EXPECT_LT(g_code(973), m_code(0));
    EXPECT_EQ(find_code(m_code(6), DialectId::fanuc)->group, ModalGroup::tool_change);
    EXPECT_EQ(find_code(g_code(6), DialectId::fanuc), nullptr);
}

TEST(Codes, AreWrittenAsInAProgram) {
    EXPECT_EQ(written(g_code(59, 3)), "G59.3");
    EXPECT_EQ(written(g_code(83)), "G83");
    EXPECT_EQ(written(m_code(6)), "M6");
    EXPECT_EQ(written(MotionCode::probe_away), "G38.4");
    EXPECT_EQ(written(MotionCode::arc_through_point), "CIP");
    EXPECT_EQ(written(MotionCode::tangent_arc), "CT");
}

TEST(Codes, OfMotionsAreFoundBothWays) {
    for (const CodeNumber code : {g_code(0), g_code(3), g_code(5, 2), g_code(38, 5), g_code(332)})
        EXPECT_EQ(number_of(motion_of(code).value()), code);
    EXPECT_FALSE(motion_of(g_code(5, 3))) << "which acts in its block only";
    EXPECT_FALSE(number_of(MotionCode::tangent_arc));
}

TEST(Codes, BelongToDialects) {
    EXPECT_EQ(find_code('G', 59.3, DialectId::fanuc), nullptr);
    EXPECT_NE(find_code('G', 187, DialectId::haas), nullptr);
    EXPECT_EQ(find_code('G', 187, DialectId::fanuc), nullptr);
    EXPECT_EQ(find_code('G', 81, DialectId::grbl), nullptr);
}

TEST(Codes, AnUnknownGCodeIsAnErrorWithLineAndColumn) {
    const Ran ran = run_text("G0 X1\nG1 G123 X2 F100\n");
    ASSERT_TRUE(ran.run.error);
    EXPECT_EQ(ran.run.error->code, core::ErrorCode::unsupported);
    EXPECT_EQ(ran.run.error->file, "test.ngc");
    EXPECT_EQ(ran.run.error->where.line, 2u);
    EXPECT_EQ(ran.run.error->where.column, 4u);
    EXPECT_EQ(ran.run.error->where.length, 4u);
    EXPECT_EQ(ran.run.error->message, "G123: the dialect fanuc has no such code");
    EXPECT_EQ(commands_of(ran.run), "straight_traverse x=1 y=0 z=0\n");
}

TEST(Codes, AnUnknownMCodeIsAWarningAndTheProgramContinues) {
    const Ran ran = run_text("M31 P5\nG0 X1\nM30\n");
    EXPECT_FALSE(ran.run.error);
    EXPECT_THAT(warnings_of(ran.run),
                HasSubstr("M31: unknown M code, probably of the machine builder"));
    EXPECT_EQ(commands_of(ran.run), "straight_traverse x=1 y=0 z=0\n");
}

TEST(Codes, AnMCodeIsAWholeNumber) {
    for (const DialectId dialect :
         {DialectId::linuxcnc, DialectId::fanuc, DialectId::haas, DialectId::grbl}) {
        EXPECT_THAT(error_of("S1\nM3.5", dialect),
                    HasSubstr("2:1: M3.5: an M code must be a whole number, not negative"));
        EXPECT_THAT(error_of("M-3", dialect),
                    HasSubstr("1:1: M-3: an M code must be a whole number, not negative"));
        EXPECT_EQ(error_of("M3. S1", dialect), "");
    }
}

TEST(Codes, AnMCodeThatJumpsOrCallsIsRefusedInEveryDialect) {
    for (const DialectId dialect :
         {DialectId::linuxcnc, DialectId::fanuc, DialectId::haas, DialectId::grbl})
        for (const std::string_view text : {"M96 P5", "M97 P5", "M98 P5", "M99 P5", "M198 P5"})
            EXPECT_THAT(error_of(text, dialect), HasSubstr("1:")) << text;
    EXPECT_THAT(
        error_of("G0 X1 M97 P5", DialectId::fanuc),
        HasSubstr("1:7: M97: on other controls this code jumps or calls, but the dialect fanuc "
                  "does not have it; remove it, or select the dialect of the program"));
    EXPECT_THAT(error_of("M198 P5"), HasSubstr("1:6: P5: there is no program O5"));
    EXPECT_THAT(error_of("M99", DialectId::grbl),
                HasSubstr("1:1: M99: on other controls this code jumps or calls"));
}

TEST(Codes, AnMCodeThatChangesTheStateIsRefused) {
    for (const std::string_view text : {"T2 M16", "M46 P1 Q2", "M50 P2"})
        EXPECT_THAT(error_of(text, DialectId::haas), HasSubstr("not supported yet: "));
    EXPECT_THAT(warnings_of("M72", DialectId::haas),
                HasSubstr("M72: unknown M code, probably of the machine builder"));
}

TEST(Codes, TwoOfOneModalGroupAreAnError) {
    EXPECT_EQ(error_of("G17\nG90 G0 G1 X1", DialectId::haas),
              "2:8: G0 and G1 are in the same modal group: a block may have only one of them");
    EXPECT_EQ(error_of("M3 M5"),
              "1:4: M3 and M5 are in the same modal group: a block may have only one of them");
    EXPECT_EQ(error_of("G54 G55", DialectId::haas),
              "1:5: G54 and G55 are in the same modal group: a block may have only one of them");
    EXPECT_THAT(error_of("G17 G17", DialectId::linuxcnc), HasSubstr("1:5: "));
    EXPECT_EQ(error_of("G98 G98", DialectId::fanuc), "");
}

TEST(Codes, ACycleAndAMotionOfOneGroupClash) {
    EXPECT_THAT(error_of("G0 G81 X1 Z-1 R1 F1", DialectId::linuxcnc), HasSubstr("1:4: G0 and G81"));
    EXPECT_EQ(error_of("G0 G80 X1", DialectId::linuxcnc), "");
    EXPECT_EQ(error_of("G0 G80 G40 G49 X1", DialectId::fanuc), "");
}

TEST(Codes, RefusedOnesSayWhy) {
    for (const std::string_view text : {"M16 T1", "M50 P1"})
        EXPECT_THAT(error_of(text, DialectId::haas), HasSubstr("not supported yet")) << text;
    EXPECT_THAT(error_of("M46 P1 Q2", DialectId::haas), HasSubstr("not supported yet"));
}

TEST(Codes, CancellationsAreAccepted) {
    EXPECT_EQ(error_of("G15 G40 G49 G50 G67 G69 G80 G97"), "");
    EXPECT_EQ(error_of("G40 G49 G61 G8 M48", DialectId::linuxcnc), "");
    EXPECT_EQ(error_of("G61.1\nG64 P0.1 Q0.1\nM49", DialectId::linuxcnc), "");
    EXPECT_EQ(error_of("G187 P1\nG103 P1", DialectId::haas), "");
    EXPECT_EQ(error_of("G9 G1 X1 F1"), "");
}

TEST(Codes, AWordThatNothingUsesIsAnErrorOrAWarning) {
    EXPECT_EQ(error_of("G0 X0 K2", DialectId::linuxcnc),
              "1:7: K2: no code in this block uses this word");
    EXPECT_EQ(error_of("G0 X0 K2", DialectId::fanuc), "");
    EXPECT_THAT(error_of("G0 X1e3", DialectId::fanuc),
                HasSubstr("1:6: E3: no code in this block uses this word"));
    EXPECT_THAT(error_of("G0 X1e3", DialectId::fanuc), HasSubstr("write an exponent such as 1E3"));
    EXPECT_THAT(warnings_of("G0 X0 K2"), HasSubstr("K2: no code in this block uses this word"));
}

TEST(Codes, NineAxesAreFollowed) {
    EXPECT_EQ(trace("G0 X1 B90 U2\nG91 B-30 C1 W5"),
              "straight_traverse x=1 y=0 z=0 b=90 u=2\n"
              "straight_traverse x=1 y=0 z=0 b=60 c=1 u=2 w=5\n");
    // Rotary axes are in degrees with G20 too.
    EXPECT_EQ(trace("G20 G0 X1 A90 V1"), "straight_traverse x=25.4 y=0 z=0 a=90 v=25.4\n");
}

} // namespace
} // namespace gcode
