#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The error of a program, and the number of blocks before it.
struct Stop {
    std::string message;
    size_t blocks = 0;
};

Stop stop_of(std::string_view text, DialectId dialect = DialectId::fanuc) {
    const auto program = program_from_text(text, "test.nc");
    EXPECT_TRUE(program);
    const Environment environment = known_environment(dialect);
    ProgramLibrary library(*program, gcode::dialect(dialect));
    Interpreter interpreter(library, environment);
    InterpreterState state = initial_state(environment);
    Stop stop;
    while (true) {
        const auto block = interpreter.next(state);
        if (!block)
            return {fmt::format("{}: {}", block.error().where.line, block.error().message),
                    stop.blocks};
        if (!*block) return stop;
        ++stop.blocks;
    }
}

TEST(EndlessLoop, WithoutAConditionIsFoundAfterAFewPasses) {
    const Stop counting = stop_of("G21 G90\n#1=0\nN10 #1=#1+1\nG0 X#1\nGOTO 10\nM30\n");
    EXPECT_LT(counting.blocks, 30u);
    EXPECT_THAT(counting.message,
                AllOf(HasSubstr("5: the program never ends: the loop of lines 3 to 5 has no "
                                "condition that ends it"),
                      HasSubstr("#1 goes from")));
    EXPECT_THAT(stop_of("G21\nN10 G91 G0 X1\nGOTO 10\n").message, HasSubstr("never ends"));
    EXPECT_THAT(stop_of("G21 G91\no1 while [1]\nG0 X1\no1 endwhile\n", DialectId::linuxcnc).message,
                HasSubstr("never ends"));
}

TEST(EndlessLoop, WhoseConditionsCannotChangeIsFoundAfterAFewPasses) {
    const Stop stop = stop_of("G21\n#1=0\n#2=5\nWHILE[#2 GT 0]DO1\n#1=#1+1\nG0 X#1\nEND1\nM30\n");
    EXPECT_LT(stop.blocks, 40u);
    EXPECT_THAT(stop.message, AllOf(HasSubstr("7: the program never ends: the loop of lines 4 to 7 "
                                              "does not change what its conditions depend on"),
                                    HasSubstr("#1 goes from")));
}

TEST(EndlessLoop, ThatCountsAwayFromItsEndIsFound) {
    const Stop stop = stop_of("G21\n#1=0\nWHILE[#1 LT 5]DO1\n#1=#1-1\nG0 X#1\nEND1\nM30\n");
    EXPECT_LT(stop.blocks, 60'000u);
    EXPECT_THAT(stop.message, AllOf(HasSubstr("the loop of lines 3 to 6 has made 10000 passes, and "
                                              "each was further from its end"),
                                    HasSubstr("#1 goes from -")));
    const Stop outer = stop_of("G21\n#1=0\nWHILE[#1 LT 5]DO1\n#2=0\nWHILE[#2 LT 3]DO2\n#2=#2+1\n"
                               "END2\n#1=#1-1\nG0 X#1\nEND1\nM30\n");
    EXPECT_THAT(outer.message, HasSubstr("the loop of lines 3 to 10 has made 10000 passes"));
    const Stop unequal = stop_of("G21\n#1=0\nN1 #1=#1+2\nG0 X#1\nIF[#1 NE 7]GOTO 1\nM30\n");
    EXPECT_THAT(unequal.message, HasSubstr("the loop of lines 3 to 5 has made 10000 passes"));
}

TEST(EndlessLoop, ThatNeverMovesIsStoppedAtALimit) {
    // The sign changes in each pass, so no pass is like the one before.
    const Stop stop = stop_of("#1=1\nWHILE[#1 NE 0]DO1\n#1=[-1]*#1\n#2=#2+1\nEND1\nM30\n");
    EXPECT_FALSE(stop.message.empty());
    EXPECT_LT(stop.blocks, 4'000'001u);
}

std::string klartext_lines(std::string_view lines) {
    return "BEGIN PGM A MM\nL X+0 Y+0 Z+0 R0 FMAX\n" + std::string(lines) + "END PGM A MM\n";
}

Stop klartext_stop(std::string_view lines) {
    return stop_of(klartext_lines(lines), DialectId::heidenhain);
}

Stop siemens_stop(std::string_view lines) {
    return stop_of("G71 G90 G0 X0\n" + std::string(lines) + "M30\n", DialectId::siemens);
}

TEST(EndlessLoop, IsFoundInEachLanguage) {
    for (const char* lines :
         {"LOOP\nR1=R1+1\nX=R1\nENDLOOP\n", "LOOP\nR1=R1+1\nENDLOOP\n", "AA:\nR1=R1+1\nGOTOB AA\n",
          "WHILE 1==1\nR1=R1+1\nENDWHILE\n", "REPEAT\nR1=R1+1\nX=R1\nUNTIL R2>0\n",
          "LOOP\nFOR R2=1 TO 0\nX1\nENDFOR\nR1=R1+1\nX=R1\nENDLOOP\n"}) {
        const Stop stop = siemens_stop(lines);
        EXPECT_LT(stop.blocks, 60u) << lines;
        EXPECT_THAT(stop.message,
                    AllOf(HasSubstr("never ends: the loop of lines"), HasSubstr("R1 goes from")))
            << lines;
    }
    for (const char* lines : {"AA: R1=R1+1\nX=R1\nIF R1>0 GOTOB AA\n",
                              "DEF REAL FAR=0\nREPEAT\nFAR=FAR+1\nR1=FAR\nUNTIL FAR<0\n",
                              "LOOP\nFOR R2=1 TO 3\nX=R2\nENDFOR\nR1=R1+1\nX=R1\nENDLOOP\n",
                              "FOR R2=1 TO 3\nR1=R1+1\nX=R1\nR2=R2-2\nENDFOR\n"}) {
        const Stop stop = siemens_stop(lines);
        EXPECT_LT(stop.blocks, 150'000u) << lines;
        EXPECT_THAT(stop.message,
                    AllOf(HasSubstr("has made 10000 passes"), HasSubstr("R1 goes from")))
            << lines;
    }
    for (const char* lines :
         {"LBL 1\nFN 1: Q1 = +Q1 + +1\nL X+Q1 F500\nFN 9: IF +1 EQU +1 GOTO LBL 1\n",
          "LBL 1\nQ1 = Q1 + 1\nFN 9: IF +1 EQU +1 GOTO LBL 1\n",
          "LBL 1\nQ1 = Q1 + 1\nLBL 2\nL IX+1 F500\nCALL LBL 2 REP 3\n"
          "FN 9: IF +1 EQU +1 GOTO LBL 1\n"}) {
        const Stop stop = klartext_stop(lines);
        EXPECT_LT(stop.blocks, 100u) << lines;
        EXPECT_THAT(stop.message,
                    AllOf(HasSubstr("never ends: the loop of lines"), HasSubstr("Q1 goes from")))
            << lines;
    }
    EXPECT_THAT(
        klartext_stop("LBL 1\nQ1 = Q1 + 1\nL X+Q1 F500\nFN 11: IF +Q1 GT +0 GOTO LBL 1\n").message,
        HasSubstr("has made 10000 passes"));
}

TEST(LongLoop, IsRunToItsEndInEachLanguage) {
    for (const char* lines :
         {"FOR R1=1 TO 50000\nX=R1/1000\nENDFOR\n",
          "WHILE R1<50000\nR1=R1+1\nX=R1/1000\nENDWHILE\n",
          "LOOP\nR1=R1+1\nX=R1/1000\nIF R1>50000 GOTOF OUT\nENDLOOP\nOUT:\n",
          "AA: G91 X0.001\nREPEAT AA P=9000\n",
          // Two conditions in a line, of which the second moves away from its end.
          "AA: R1=R1+1\nX=R1/1000\nIF R1>20000 GOTOF OUT IF R1>0 GOTOB AA\nOUT:\n",
          // The number of passes stays the same for 20,000 passes.
          "LOOP\nR1=R1+1\nX=R1/1000\nR5=1-TRUNC(R1/20000)\nFOR R2=1 TO R5\nGOTOF ON\nENDFOR\n"
          "GOTOF OUT\nON:\nENDLOOP\nOUT:\n",
          "LOOP\nR1=R1+1\nX=R1/1000\nR5=TRUNC(R1/20000)\nFOR R2=1 TO R5\nGOTOF OUT\nENDFOR\n"
          "ENDLOOP\nOUT:\n"})
        EXPECT_EQ(siemens_stop(lines).message, "") << lines;
    for (const char* lines :
         {"LBL 1\nL IX+0.001 F500\nCALL LBL 1 REP 50000\n",
          "LBL 1\nQ1 = Q1 + 1\nL IX+0.001 F500\nFN 12: IF +Q1 LT +50000 GOTO LBL 1\n",
          "LBL 9\nQ1 = Q1 + 1\nQ2 = INT (Q1 / 20000)\nL IX+0.001 F500\n"
          "FN 9: IF +1 EQU +1 GOTO LBL 3\nLBL 1\nFN 9: IF +1 EQU +1 GOTO LBL 4\nLBL 3\n"
          "CALL LBL 1 REP Q2\nFN 9: IF +1 EQU +1 GOTO LBL 9\nLBL 4\n",
          // Read from the control in each pass.
          "LBL 1\nL IX+0.001 F500\nFN 18: SYSREAD Q2 = ID270 NR1 IDX1\n"
          "Q3 = INT Q2\nFN 12: IF +Q3 LT +20 GOTO LBL 1\n"})
        EXPECT_EQ(klartext_stop(lines).message, "") << lines;
}

TEST(LongLoop, IsRunToItsEnd) {
    const std::string_view counts = "#1=0\nWHILE[#1 LT 100000]DO1\n#1=#1+1\nEND1\nM30\n";
    EXPECT_EQ(stop_of(counts).message, "");
    const std::string_view moves =
        "G21 G0 X0\n#1=0\nN1 #1=#1+1\nG0 X[#1/1000]\nIF[#1 LT 300000]GOTO 1\nM30\n";
    EXPECT_EQ(stop_of(moves).message, "");
    const std::string_view nested = "G21\n#1=0\nWHILE[#1 LT 300]DO1\n#2=0\nWHILE[#2 LT 300]DO2\n"
                                    "#2=#2+1\nG0 X#2\nEND2\n#1=#1+1\nEND1\nM30\n";
    EXPECT_EQ(stop_of(nested).message, "");
    EXPECT_EQ(
        stop_of("G21\no1 repeat [100000]\nG91 G0 X0.001\no1 endrepeat\nM2\n", DialectId::linuxcnc)
            .message,
        "");
    EXPECT_EQ(stop_of("O1\nG21\nM98 P2 L50000\nM30\nO2\nG91 G0 X0.001\nM99\n").message, "");
    EXPECT_EQ(stop_of("O1\nG21 G91\nG65 P2 L20000 A1\nM30\nO2\nG0 X#1\nM99\n").message, "");
}

TEST(LongLoop, MayEndByAFlagACounterOrAnArgument) {
    // The condition stays the same for 20,000 passes.
    EXPECT_EQ(stop_of("G21\n#1=0\n#5=0\nWHILE[#5 EQ 0]DO1\n#1=#1+1\nG0 X[#1/1000]\n"
                      "IF[#1 GE 20000]THEN #5=1\nEND1\nM30\n")
                  .message,
              "");
    EXPECT_EQ(stop_of("G21\n#1=0\n#5=0\nWHILE[#5 EQ 0]DO1\n#1=#1+1\nG0 X[#1/1000]\n"
                      "#5=FIX[#1/20000]\nEND1\nM30\n")
                  .message,
              "");
    EXPECT_EQ(stop_of("G21\n#1=0\n#5=10\nN10 #1=#1+1\nG0 X#1\n#5=10+10*FIX[#1/50]\nGOTO #5\n"
                      "N20 M30\n")
                  .message,
              "");
    EXPECT_EQ(stop_of("G21\n#100=0\nN1 #100=#100+1\nG65 P9 A#100\nG0 X#100\nGOTO 1\nM30\n"
                      "O9\nIF[#1 LT 500]GOTO 9\nM30\nN9 M99\n")
                  .message,
              "");
}

} // namespace
} // namespace gcode
