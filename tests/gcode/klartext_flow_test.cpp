#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/klartext_programs.h"
#include "tests/support/scoped_folder.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// X of each rapid of the lines.
std::string way(std::string_view lines) {
    const Ran ran = run_text(klartext_program(lines), DialectId::heidenhain);
    std::string text;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                text += std::to_string(std::lround(*rapid->end[0] * 1000.0)) + " ";
    return ran.run.error ? text + ran.run.error->message : text;
}

/// The value of a formula, in thousandths.
std::string value_of_formula(const std::string& formula) {
    return way("Q1 = 30\nQ2 = -2,5\n" + formula + "\nL X+Q5 FMAX\n");
}

TEST(KlartextFormula, ComputesLikeTheControl) {
    EXPECT_EQ(value_of_formula("Q5 = 5 * 3 + 2 * 10"), "35000 ");
    EXPECT_EQ(value_of_formula("Q5 = SQ 10 - 3^3"), "73000 ");
    EXPECT_EQ(value_of_formula("Q5 = Q2 * SIN Q1 + 5"), "3750 ");
    EXPECT_EQ(value_of_formula("Q5 = SQRT(Q1 + 6) / ( 2 - 5 )"), "-2000 ");
    EXPECT_EQ(value_of_formula("Q5 = INT ( 7 / -2 ) + FRAC 1.25"), "-2750 ");
    EXPECT_EQ(value_of_formula("Q5 = SGN Q2 * ABS Q2 + NEG 1"), "-3500 ");
    EXPECT_EQ(value_of_formula("Q5 = 400 % 360 + LOG 1000 + ATAN 1"), "88000 ");
    EXPECT_EQ(value_of_formula("Q5 = - 200 + PI - PI"), "-200000 ");
    EXPECT_EQ(value_of_formula("Q0 = 7\nQR3 = Q0 + 1\nQ5 = QR3"), "8000 ");
}

TEST(KlartextFormula, FunctionsOfFnComputeToo) {
    EXPECT_EQ(value_of_formula("FN 0: Q5 = +Q1"), "30000 ");
    EXPECT_EQ(value_of_formula("FN1 : Q5 = +Q1 + -5"), "25000 ");
    EXPECT_EQ(value_of_formula("FN 2: Q5 = +10 - +5"), "5000 ");
    EXPECT_EQ(value_of_formula("FN 3: Q5 = +3 * +3"), "9000 ");
    EXPECT_EQ(value_of_formula("FN4: Q5 = +4 DIV +Q2"), "-1600 ");
    EXPECT_EQ(value_of_formula("FN 5: Q5 = SQRT 4"), "2000 ");
    EXPECT_EQ(value_of_formula("FN 6: Q5 = SIN-Q1"), "-500 ");
    EXPECT_EQ(value_of_formula("FN 7: Q5 = COS+60"), "500 ");
    EXPECT_EQ(value_of_formula("FN 8: Q5 = +3 LEN +4"), "5000 ");
    EXPECT_EQ(value_of_formula("FN 13: Q5 = -10 ANG +10"), "315000 ");
}

TEST(KlartextFormula, ReportsMistakes) {
    EXPECT_THAT(klartext_error("Q1 = 5 / 0\n"), HasSubstr("2:8: this is a division by zero"));
    EXPECT_THAT(klartext_error("Q1 = FOO 5\n"), HasSubstr("there is no function 'FOO'"));
    EXPECT_THAT(klartext_error("Q2500 = 5\n"),
                HasSubstr("'Q2500': the highest number of these Q parameters is 1999"));
    EXPECT_THAT(klartext_error("QS1 = 5\n"), HasSubstr("QS"));
    EXPECT_THAT(klartext_error("FN 14: ERROR= 1042\n"), HasSubstr("FN 14: the program stops"));
    EXPECT_THAT(klartext_error("FN 26: TABOPEN TNC:\\A.TAB\n"), HasSubstr("'FN 26'"));
}

TEST(KlartextFlow, SubprogramsEndAtLabelZero) {
    EXPECT_EQ(way("L X+1 FMAX\nCALL LBL 5\nL X+2 FMAX\nCALL LBL \"sub\"\nL X+3 FMAX M30\nLBL 5\nL "
                  "X+10 FMAX\nLBL 0\nLBL \"sub\"\nL X+20 FMAX\nCALL LBL5\nLBL0\n"),
              "1000 10000 2000 20000 10000 3000 ");
}

TEST(KlartextFlow, RepeatsAPartOfTheProgram) {
    EXPECT_EQ(way("LBL 1\nL IX+1 FMAX\nCALL LBL 1 REP 2/2\nL X+50 FMAX\n"),
              "1000 2000 3000 50000 ");
    // Inside another repetition it starts again.
    EXPECT_EQ(way("LBL 1\nLBL 2\nL IX+1 FMAX\nCALL LBL 2 REP 1\nCALL LBL 1 REP1/1\n"),
              "1000 2000 3000 4000 ");
}

TEST(KlartextFlow, JumpsWhenAConditionHolds) {
    EXPECT_EQ(way("LBL 1\nQ1 = Q1 + 1\nL X+Q1 FMAX\nFN 12: IF +Q1 LT +3 GOTO LBL 1\n"),
              "1000 2000 3000 ");
    EXPECT_EQ(way("FN9: IF +Q1 EQU +0 GOTO LBL2\nL X+1 FMAX\nLBL 2\nFN 10: IF Q1 NE 0 GOTO LBL "
                  "3\nL X+2 FMAX\nFN 11: IF 2 GT 1 GOTO LBL \"end\"\nLBL 3\nL X+3 FMAX\nLBL "
                  "\"end\"\n"),
              "2000 ");
}

TEST(KlartextFlow, FindsProgramsThatNeverEnd) {
    EXPECT_THAT(klartext_error("LBL 1\nFN 9: IF +0 EQU +0 GOTO LBL 1\n"), HasSubstr("never ends"));
    EXPECT_THAT(klartext_error("LBL 1\nCALL LBL 1\nLBL 0\n"), HasSubstr("calls are nested deeper"));
    EXPECT_THAT(klartext_error("CALL LBL 7\n"), HasSubstr("2:1: there is no LBL 7"));
    EXPECT_THAT(klartext_error("CALL LBL 1\nSTOP\nLBL 1\n"), HasSubstr("LBL 0 is missing"));
    EXPECT_THAT(klartext_error("CALL PGM TNC:\\A.H\n"), HasSubstr("no file A.H"));
}

TEST(KlartextFlow, JoinsTheLinesOfABlock) {
    EXPECT_EQ(way("L X+1 ~\n  FMAX\nL X+2 ;Z ~\n FMAX\n"), "1000 2000 ");
    EXPECT_EQ(way(";L X+1 FMAX and more ~\nL X+2 FMAX\nL X+3 FMAX\n"), "3000 ");
    EXPECT_THAT(klartext_error("L X+1 ~\n  H5\n"),
                HasSubstr("3:3: 'H' is not allowed in this block"));
}

TEST(KlartextFlow, ReadsPositionsOfTheSystem) {
    EXPECT_EQ(way("CYCL DEF 7.0\nCYCL DEF 7.1 X+10\nL X+5 FMAX\nFN18: SYSREAD Q1 = ID270 NR1 "
                  "IDX1\nFN18 : SYSREAD Q2 = ID240 NR1 IDX1\nL X+Q1 FMAX\nL X+Q2 FMAX\n"),
              "5000 5000 15000 ");
    EXPECT_THAT(klartext_error("FN 18: SYSREAD Q1 = ID50 NR1 IDX1\n"), HasSubstr("ID50 NR1 IDX1"));
}

class KlartextFiles : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text) const {
        folder_.write(name, text);
    }
    Ran ran(std::string_view text) const {
        Environment environment = known_environment(DialectId::heidenhain);
        environment.search_path = {folder_.path().string()};
        environment.length_offsets[core::OffsetNumber(1)] = {.length = 100.0, .diameter = 50.0};
        return run_text(text, environment);
    }

    const test_support::ScopedFolder folder_;
};

TEST_F(KlartextFiles, CallsProgramsOfTheSearchPath) {
    write("SUB.H", "0 BEGIN PGM SUB MM\n1 L X+Q1 FMAX\n2 CALL LBL 1\n3 END PGM SUB MM\n4 LBL 1\n");
    write("GOOD.H", "0 BEGIN PGM SUB MM\n1 L X+Q1 FMAX\n3 END PGM SUB MM\n");
    const Ran good =
        ran("BEGIN PGM A MM\nQ1 = 7\nCALL PGM TNC:\\X\\GOOD.H\nL X+1 FMAX\nEND PGM A MM\n");
    EXPECT_FALSE(good.run.error);
    EXPECT_EQ(commands_of(good.run),
              "straight_traverse x=7 y=0 z=0\nstraight_traverse x=1 y=0 z=0\n");
}

/// The facing program in the file Plan.h: its spirals use labels, tangential arcs, and roundings
/// between motions that are connected by jumps.
TEST_F(KlartextFiles, RunsTheSharedFacingCycle) {
    const auto shared = source_dir / "../shared/programs/heidenhain";
    if (!std::filesystem::exists(shared)) GTEST_SKIP() << shared << " is missing";
    std::filesystem::copy_file(shared / "jstjst__Plan.h", folder_ / "Plan.h");
    const auto program = read_program((shared / "jstjst__Plan-Beispiel.h").string());
    ASSERT_TRUE(program);
    const Ran whole = ran(program->text);
    EXPECT_FALSE(whole.run.error) << whole.run.error->file << whole.run.error->where.line << ": "
                                  << whole.run.error->message;
    // Three cuts of 1 mm from Z0 down to Z-3.
    const std::string text = commands_of(whole.run);
    EXPECT_THAT(text, HasSubstr("z=-1 feed=600"));
    EXPECT_THAT(text, HasSubstr("z=-3 feed=600"));
    EXPECT_THAT(text, HasSubstr("arc_feed"));
}

} // namespace
} // namespace gcode
