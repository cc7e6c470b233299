#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/siemens_programs.h"
#include "tests/support/scoped_folder.h"

namespace gcode {
namespace {

using testing::HasSubstr;

// SINUMERIK 840D sl / 828D, Programming Manual Job Planning (6FC5398-2BP40), "Program jumps",
// "Control structures", "Subprograms".

std::string places(std::string_view text) {
    const Ran ran = run_text(text, DialectId::siemens);
    std::string found;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* move = std::get_if<StraightTraverse>(&command))
                found += std::to_string(static_cast<int>(*move->end[0])) + " ";
    return ran.run.error ? found + "error: " + ran.run.error->message : found;
}

TEST(SiemensJump, LooksForwardsOrBackwards) {
    EXPECT_EQ(places("G0 X1\nGOTOF OVER\nX2\nOVER: X3\n"), "1 3 ");
    EXPECT_EQ(places("G0\nN10 R1=R1+1\nX=R1\nIF R1<3 GOTOB N10\nX9\n"), "1 2 3 9 ");
    EXPECT_EQ(places("G0 X1\nGOTO AFTER\nX2\nAFTER:\nX3\n"), "1 3 ");
    EXPECT_EQ(places("G0 X1\nGOTOC NOWHERE\nX2\n"), "1 2 ");
    EXPECT_EQ(places("G0 X1\nIF R1==1 GOTOF ONE IF R1==0 GOTOF ZERO\nONE: X5\nZERO: X6\n"), "1 6 ");
    EXPECT_EQ(places("G0\nR1=R1+1\nX=R1\nIF R1>2 GOTOF OUT\nGOTOS\nOUT: M30\n"), "1 2 3 ");
}

TEST(SiemensJump, NamesATargetThatIsNotThere) {
    EXPECT_THAT(siemens_error("G0 X1\nGOTOF GONE\n"),
                HasSubstr("2:1: there is no GONE after this block to jump to"));
    EXPECT_THAT(siemens_error("GONE: G0 X1\nGOTOF GONE\n"), HasSubstr("in the other direction"));
    EXPECT_THAT(siemens_error("GOTOF\n"),
                HasSubstr("1:1: 'GOTOF' must be followed by a label or a block number"));
    EXPECT_THAT(siemens_error("G0 X1 GOTOF GONE\n"), HasSubstr("must be in a block by itself"));
    EXPECT_THAT(siemens_error("R1=5 EXTERN PART(REAL)\n"),
                HasSubstr("1:6: 'EXTERN' must be in a block by itself"));
}

TEST(SiemensStructure, TakesOneBranch) {
    const std::string branch = "IF R1==1\nX1\nIF R2==1\nX2\nENDIF\nELSE\nX3\nENDIF\nX4\n";
    EXPECT_EQ(places("G0\n" + branch), "3 4 ");
    EXPECT_EQ(places("G0 R1=1\n" + branch), "1 4 ");
    EXPECT_EQ(places("G0 R1=1 R2=1\n" + branch), "1 2 4 ");
    EXPECT_THAT(siemens_error("IF R1==1\nG0 X1\n"), HasSubstr("1:1: ENDIF is missing"));
    EXPECT_THAT(siemens_error("IF R1==0\nG0 X1\nELSE\n"), HasSubstr("3:1: ENDIF is missing"));
    EXPECT_THAT(siemens_error("ENDIF\n"), HasSubstr("1:1: IF is missing"));
}

TEST(SiemensStructure, RunsLoops) {
    EXPECT_EQ(places("G0\nDEF INT II\nFOR II=1 TO 3\nX=II\nENDFOR\nX9\n"), "1 2 3 9 ");
    EXPECT_EQ(places("G0\nFOR R1=3 TO 2\nX=R1\nENDFOR\nX9\n"), "9 ");
    EXPECT_EQ(places("G0\nFOR R1=1 TO 2\nFOR R2=1 TO 2\nX=R1*10+R2\nENDFOR\nENDFOR\n"),
              "11 12 21 22 ");
    EXPECT_EQ(places("G0\nWHILE R1<2\nR1=R1+1\nX=R1\nENDWHILE\nX9\n"), "1 2 9 ");
    EXPECT_EQ(places("G0\nREPEAT\nR1=R1+1\nX=R1\nUNTIL R1>=2\nX9\n"), "1 2 9 ");
    EXPECT_EQ(places("G0\nLOOP\nR1=R1+1\nX=R1\nIF R1==2 GOTOF OUT\nENDLOOP\nOUT: X9\n"), "1 2 9 ");
    EXPECT_EQ(places("G0\nAGAIN: R1=R1+1\nX=R1\nREPEAT AGAIN P=2\nX9\n"), "1 2 3 9 ");
}

TEST(SiemensStructure, FindsLoopsThatNeverEnd) {
    EXPECT_THAT(siemens_error("LOOP\nG0 X1\nENDLOOP\n"), HasSubstr("never ends"));
    EXPECT_THAT(siemens_error("HERE: G0 X1\nGOTOB HERE\n"), HasSubstr("never ends"));
}

const std::string with_subprograms = "%_N_MAIN_MPF\n"
                                     "G0 X1\n"
                                     "L10 P2\n"
                                     "SUB_A(5,,7)\n"
                                     "CALL \"SUB_A\"\n"
                                     "X9\n"
                                     "M30\n"
                                     "%_N_L10_SPF\n"
                                     "X10\n"
                                     "M17\n"
                                     "%_N_SUB_A_SPF\n"
                                     "PROC SUB_A(REAL FIRST, REAL SECOND=6, INT THIRD)\n"
                                     "X=FIRST\n"
                                     "X=SECOND\n"
                                     "X=THIRD\n"
                                     "RET\n";

TEST(SiemensCall, PassesValuesAndRepeats) {
    EXPECT_EQ(places(with_subprograms), "1 10 10 5 6 7 0 6 0 9 ");
}

TEST(SiemensCall, ReturnsFromASubprogramWithoutBlocks) {
    EXPECT_EQ(places("G0 X1\nSUB_G\nX9\nM30\n%_N_SUB_G_SPF\n; nothing\n"), "1 9 ");
}

TEST(SiemensCall, RefusesWhatDoesNotFit) {
    EXPECT_THAT(siemens_error("SUB_B(1,2)\n%_N_SUB_B_SPF\nPROC SUB_B(REAL ONE)\nM17\n"),
                HasSubstr("1:1: SUB_B takes 1 parameters, but 2 are given"));
    EXPECT_THAT(siemens_error("SUB_C\n%_N_SUB_C_SPF\nSUB_C\nM17\n"),
                HasSubstr("calls are nested deeper"));
    EXPECT_THAT(siemens_error("SUB_D(1)\n%_N_SUB_D_SPF\nPROC SUB_D(VAR REAL ONE)\nM17\n"),
                HasSubstr("VAR one"));
}

TEST(SiemensCall, VariablesAreOfTheirProgram) {
    EXPECT_THAT(siemens_error("DEF REAL LEN=5\nSUB_E\n%_N_SUB_E_SPF\nG0 X=LEN\nM17\n"),
                HasSubstr("'len': this variable is not defined in this program"));
}

TEST(SiemensCall, FindsFilesOfTheSearchPathInAnyCase) {
    const test_support::ScopedFolder folder;
    folder.write("Hole_1.spf", "G0 X5\n"); // returns at its end
    folder.write("whole.MPF", "X6\nM30\n");
    Environment environment = known_environment(DialectId::siemens);
    environment.search_path = {folder.path().string()};
    const Ran ran = run_text("G0 X1\nHOLE_1\nWHOLE\nX9\nM30\n", environment);
    EXPECT_FALSE(ran.run.error) << ran.run.error->message;
    EXPECT_EQ(commands_of(ran.run), "straight_traverse x=1 y=0 z=0\n"
                                    "straight_traverse x=5 y=0 z=0\n"
                                    "straight_traverse x=6 y=0 z=0\n"
                                    "straight_traverse x=9 y=0 z=0\n");
    const Ran outside = run_text("CALL \"../Hole_1\"\n", environment);
    EXPECT_FALSE(outside.run.error); // only the name of a path is used
    EXPECT_TRUE(run_text("CALL \"..\"\n", environment).run.error);
}

TEST(SiemensCall, ModalCallsComeAfterEveryBlockThatMoves) {
    EXPECT_EQ(places("G0\nMCALL SUB_F(3)\nX1\nR1=5\nX2\nMCALL\nX9\nM30\n%_N_SUB_F_SPF\n"
                     "PROC SUB_F(REAL DEEP)\nX=DEEP\nM17\n"),
              "1 3 2 3 9 ");
}

TEST(SiemensFlow, EndsAMainProgramAtTheEndOfASubprogram) {
    for (const std::string end : {"M17", "RET"}) {
        const Ran ran = run_text("G71 G0 X1\n" + end + "\nX2\n", DialectId::siemens);
        EXPECT_FALSE(ran.run.error);
        EXPECT_EQ(commands_of(ran.run), "straight_traverse x=1 y=0 z=0\n");
        EXPECT_EQ(warnings_of(ran.run), end + " in a main program ends it, as M30 does\n");
    }
}

} // namespace
} // namespace gcode
