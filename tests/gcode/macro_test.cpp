#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// The X of each rapid of a program, in order.
std::string rapids(std::string_view text, DialectId dialect = DialectId::fanuc) {
    const Ran ran = run_text("G21\n" + std::string(text), dialect);
    std::string found;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                found += std::to_string(static_cast<int>(std::round(*rapid->end[0]))) + " ";
    return ran.run.error ? found + "error: " + ran.run.error->message : found;
}

/// Copies the arguments of a call to the common variables #101 to #133.
std::string arguments_of_call(std::string_view words) {
    std::string text = "G65 P1 " + std::string(words) + "\nM30\nO1\n";
    for (int i = 1; i <= 33; ++i) text += fmt::format("#{}=#{}\n", 100 + i, i);
    const Ran ran = run_text(text + "M99\n");
    if (ran.run.error) return "error: " + ran.run.error->message;
    std::string found;
    for (int i = 1; i <= 33; ++i)
        if (const Value value = ran.run.state.parameters->numbered(100 + i))
            found += fmt::format("{}={} ", i, *value);
    return found;
}

// Source: Fanuc B-64304, 15.7.1, argument specifications I and II.
TEST(Macro, ArgumentsSetTheVariablesThatFanucAssigns) {
    EXPECT_EQ(arguments_of_call("A1 B2 C3 D7 E8 F9 H11 I4 J5 K6 M13"),
              "1=1 2=2 3=3 4=4 5=5 6=6 7=7 8=8 9=9 11=11 13=13 ");
    EXPECT_EQ(arguments_of_call("Q17 R18 S19 T20 U21 V22 W23 X24 Y25 Z26"),
              "17=17 18=18 19=19 20=20 21=21 22=22 23=23 24=24 25=25 26=26 ");
    EXPECT_EQ(arguments_of_call("A1 B2 C3 I4 J5 K6 I7 J8 K9 I10"),
              "1=1 2=2 3=3 4=4 5=5 6=6 7=7 8=8 9=9 10=10 ");
    EXPECT_EQ(arguments_of_call("I1 K2 I3"), "4=1 6=2 7=3 ");
    EXPECT_EQ(arguments_of_call("A1. I2. I-3. I4. D5."), "1=1 4=2 7=5 10=4 ");
    std::string most;
    for (int i = 0; i < 10; ++i) most += fmt::format("I{} J{} K{} ", i, i, i);
    EXPECT_THAT(arguments_of_call(most), HasSubstr("31=9 32=9 33=9"));
    EXPECT_THAT(arguments_of_call(most + "I1"), HasSubstr("at most ten sets"));
    EXPECT_THAT(arguments_of_call("G1"), HasSubstr("cannot be a macro argument"));
    EXPECT_EQ(arguments_of_call("A#0 B#99"), "");
}

TEST(Macro, CallsHaveVariablesOfTheirOwn) {
    EXPECT_EQ(rapids("#1=7\nG65 P1 A3\nG0 X#1\nM30\nO1\nG0 X#1\n#1=5\n#2=6\nM99\n"), "3 7 ");
    // M98 within a macro keeps the local variables of the macro.
    EXPECT_EQ(rapids("G65 P1 A3\nM30\nO1\nM98 P2\nG0 X#1\nM99\nO2\nG0 X#1\n#1=4\nM99\n"), "3 4 ");
    EXPECT_EQ(rapids("G65 P1 A3\nM30\nO1\nIF [#2 EQ #0] GOTO 5\nG0 X1\nN5 G0 X2\nM99\n"), "2 ");
    EXPECT_EQ(rapids("G65 P1 A1\nM30\nO1\nG65 P2 A[#1+1]\nG0 X#1\nM99\nO2\nG0 X#1\nM99\n"), "2 1 ");
}

TEST(Macro, RoundsBeginWithTheSameArguments) {
    EXPECT_EQ(rapids("#100=0\nG65 P1 L3 A1\nM30\nO1\nG0 X[#1+#100]\n#1=50\n#100=#100+1\nM99\n"),
              "1 2 3 ");
}

TEST(Macro, WordsBeforeTheCallAreCarriedOut) {
    EXPECT_EQ(rapids("G91 G0 X1 G65 P1 X5\nM30\nO1\nG0 X#24\nM99\n"), "1 6 ");
    EXPECT_THAT(rapids("G65 A1\nM30"), HasSubstr("must be followed by a P word"));
    EXPECT_THAT(rapids("G65 P77\nM30"), HasSubstr("no program O77"));
}

// The program and the order of its moves are those of Fanuc B-64304, 15.7.2.
TEST(Macro, ModalCallsNestAsInFanucsExample) {
    EXPECT_EQ(rapids("G0\nG66 P9100\nX11\nG66 P9200\nX12\nG67\nG67\nX15\nM30\n"
                     "O9100\nX21\nM99\nO9200\nX31\nX32\nM99\n"),
              "11 21 12 31 21 32 21 15 ");
}

TEST(Macro, ModalCallsFollowMotionsOnly) {
    const std::string macro = "M30\nO1\n#100=#100+#1\nM99\n";
    const auto sum = [&](const std::string& text) {
        const Ran ran = run_text("G21 G0\n#100=0\n" + text + macro);
        return ran.run.error ? -1.0 : *ran.run.state.parameters->numbered(100);
    };
    EXPECT_EQ(sum("G66 P1 A2\nX1\nM8\n#5=1\nX2 Y3\nG67\nX4\n"), 4.0);
    EXPECT_EQ(sum("G66 P1 L3 A2\nX1\nG67\n"), 6.0);
    EXPECT_EQ(sum("G66 P1 A2\nX1\nG67 X4\n"), 2.0);
    EXPECT_EQ(sum("G66 P1 A2 X5\nG67\n"), 0.0);
}

TEST(Macro, VariablesOfAModalCallLiveOn) {
    EXPECT_EQ(rapids("G0\nG66 P1 A1\nY1\nY2\nG67\nM30\nO1\nG0 X#1\n#1=#1+1\nM99\n"), "0 1 1 2 ");
}

TEST(Macro, EveryBlockIsACallUnderG66_1) {
    EXPECT_EQ(rapids("G66.1 P1 X3\nX4\nG1 X5 Y6\nG67\nG0 X9\nM30\nO1\nG0 X#24\nM99\n"), "3 4 5 9 ");
    EXPECT_EQ(rapids("#100=0\nG66.1 P1\nG1 X5\nG67\nG0 X#100\nM30\nO1\n#100=#10\nM99\n"), "1 ");
}

} // namespace
} // namespace gcode
