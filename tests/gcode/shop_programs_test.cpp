#include <array>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// Typical shop programs, compared with the manuals of Fanuc and Haas.
constexpr std::array controls = {DialectId::fanuc, DialectId::haas};

Recognition recognised(std::string_view text) {
    const auto program = program_from_text(text);
    EXPECT_TRUE(program);
    return recognise(*program);
}

/// The heights to which the tool moves.
std::string heights(std::string_view text, DialectId dialect) {
    const Ran ran = run_text(text, dialect);
    if (ran.run.error) return ran.run.error->message;
    std::string found;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands) {
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                found += fmt::format(" r{:g}", *rapid->end[2]);
            else if (const auto* feed = std::get_if<StraightFeed>(&command))
                found += fmt::format(" f{:g}", *feed->end[2]);
        }
    return found;
}

TEST(ShopCycle, KeepsItsLevelsForHolesOfG91) {
    for (const DialectId control : controls)
        EXPECT_EQ(heights("G21 G0 Z50.\nG99 G81 X0 Z-5. R2. F100\nG91 X10. L2\nG90 Y9.", control),
                  " r50 r50 r2 f-5 r2 r2 f-5 r2 r2 f-5 r2 r2 f-5 r2");
}

TEST(ShopCycle, KeepsWaysOfG91ForHolesOfG90) {
    for (const DialectId control : controls)
        EXPECT_EQ(heights("G21 G0 Z50.\nG91 G99 G81 X1. Z-7. R-48. F100\nG90 X5.", control),
                  " r50 r50 r2 f-5 r2 r2 f-5 r2");
}

TEST(ShopCycle, CountsItsLevelsAnewUnderG91InLinuxcnc) {
    const std::string program = "G21 G0 Z10\nF100 G99 G81 X0 Z-5 R2\nG91 X10";
    EXPECT_NE(heights(program, DialectId::linuxcnc), heights(program, DialectId::fanuc));
}

TEST(ShopCycle, G83PecksOutToRUnderG98Too) {
    for (const DialectId control : controls)
        EXPECT_EQ(heights("G21 G0 Z50.\nG98 G83 X0 Z-5. R2. Q3. F100", control),
                  " r50 r50 r2 f-1 r2 r0 f-4 r2 r-3 f-5 r50");
}

TEST(ShopCycle, PecksShrinkFromIByJDownToK) {
    EXPECT_EQ(heights("G21 G0 Z5.\nG99 G83 X0 Z-9. R0 I4. J1.5 K2. F100", DialectId::haas),
              " r5 r5 r0 f-4 r0 r-3 f-6.5 r0 r-5.5 f-8.5 r0 r-7.5 f-9 r0");
    EXPECT_EQ(heights("G21 G0 Z5.\nG99 G73 X0 Z-5. R0 I4. J9. K2. F100", DialectId::haas),
              " r5 r5 r0 f-4 r-3 f-5 r0");
    EXPECT_EQ(error_of("G0 Z5.\nG83 X0 Z-9. R0 I4. J1. F100", DialectId::haas),
              "2:1: G83 needs a K word");
    EXPECT_EQ(error_of("G0 Z5.\nG83 X0 Z-9. R0 I4. J1. F100"), "2:1: G83 needs a Q word");
    // The shift of a boring cycle is not a peck.
    EXPECT_EQ(error_of("G0 Z5.\nG76 X0 Z-9. R0 I1. F100\nG83 X1. Q2.", DialectId::haas), "");
}

std::string value(const std::string& expression, DialectId dialect) {
    return trace("G21 G0 X[" + expression + "]", dialect);
}

TEST(ShopMacro, FixAndFupGoByTheAmount) {
    for (const DialectId control : controls) {
        EXPECT_THAT(value("FIX[-2.5]", control), HasSubstr("x=-2 "));
        EXPECT_THAT(value("FUP[-2.1]", control), HasSubstr("x=-3 "));
        EXPECT_THAT(value("FIX[2.5]", control), HasSubstr("x=2 "));
        EXPECT_THAT(value("FUP[2.1]", control), HasSubstr("x=3 "));
    }
    EXPECT_THAT(value("FIX[-2.5]", DialectId::linuxcnc), HasSubstr("x=-3 "));
    EXPECT_THAT(value("FUP[-2.1]", DialectId::linuxcnc), HasSubstr("x=-2 "));
}

TEST(ShopMacro, RoundIsToTheLeastInputIncrementAfterAnAddress) {
    // The example of the manuals: the distances there and back are equal only with ROUND.
    const std::string program = "#1=1.2346\n#2=2.3456\nG91 G1 F9. X-[ROUND[#1]]\nX-[ROUND[#2]]\n"
                                "X[ROUND[#1]+ROUND[#2]]";
    for (const DialectId control : controls) {
        EXPECT_THAT(trace("G21\n" + program, control), HasSubstr("x=-1.235 y=0 z=0 feed=9\n"
                                                                 "straight_feed x=-3.581 "));
        EXPECT_THAT(trace("G20\n#1=1.00333\nG0 X[ROUND[#1]]", control), HasSubstr("x=25.48382 "));
        EXPECT_THAT(trace("#1=ROUND[1.6]\nG0 X#1", control), HasSubstr("x=2 "));
        EXPECT_THAT(trace("O1\nG65 P9 X[ROUND[1.6]]\nM30\nO9\nG0 X#24\nM99", control),
                    HasSubstr("x=2 "));
    }
    EXPECT_THAT(trace("G21 G0 X[ROUND[1.2345]]", DialectId::linuxcnc), HasSubstr("x=1 "));
}

TEST(ShopMacro, AnglesOfFanucHaveNoSign) {
    EXPECT_THAT(value("ATAN[-1]/[-1]", DialectId::fanuc), HasSubstr("x=225 "));
    EXPECT_THAT(value("ASIN[-0.5]", DialectId::fanuc), HasSubstr("x=330 "));
    EXPECT_THAT(value("ATAN[-1]", DialectId::fanuc), HasSubstr("x=-45 "));
    EXPECT_THAT(value("ATAN[-1]/[-1]", DialectId::haas), HasSubstr("x=-135 "));
}

TEST(ShopMacro, G29PassesTheIntermediatePointsOfEveryG28) {
    // Fanuc's example: G28 X40. and G28 Y60. leave the intermediate point (40, 60).
    EXPECT_THAT(trace("G21 G0 X1. Y1. Z1.\nG28 X40.\nG28 Y60.\nG29 X2. Y3."),
                HasSubstr("straight_traverse x=40 y=60 z=1\nstraight_traverse x=2 y=3 z=1\n"));
}

TEST(ShopProgram, BeginsWithG0WhereNoMotionCodeCame) {
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas, DialectId::grbl}) {
        EXPECT_EQ(trace("G21\nG54 X10. Y5.\nG91 X1.", dialect).find("error"), std::string::npos);
        EXPECT_THAT(warnings_of("G21\nG54 X10. Y5.", dialect),
                    HasSubstr("G0, the power-on default"));
    }
    EXPECT_THAT(error_of("G54 X10", DialectId::linuxcnc), HasSubstr("no motion code"));
}

TEST(ShopProgram, BeginsWithALineThatCancelsEverything) {
    EXPECT_EQ(error_of("O1\nG0 G17 G20 G40 G49 G50 G50.1 G64 G67 G69 G80 G90 G94 G97 G98 G15\n"
                       "G13.1 G23 G25 G40.1\nM30"),
              "");
}

TEST(ShopProgram, DwellsInMillisecondsWhereStepsAreCounted) {
    Environment environment = known_environment(DialectId::fanuc);
    environment.counts_smallest_steps = true;
    EXPECT_THAT(commands_of(run_text("G21 G4 X1500\nG4 P1500", environment).run),
                HasSubstr("dwell seconds=1.5\ndwell seconds=1.5\n"));
}

TEST(ShopProgram, InKlartextMayMixWholeAndBrokenLengths) {
    const std::string head = "0 BEGIN PGM A MM\n1 L X-5 Y-5 Z+0 R0 FMAX\n2 L X+27.5 R0 FMAX\n";
    EXPECT_EQ(warnings_of(head + "3 END PGM A MM\n", DialectId::heidenhain), "");
    EXPECT_THAT(error_of(head + "3 CC Y-4 Z-4\n", DialectId::heidenhain),
                HasSubstr("outside the working plane"));
}

TEST(ShopProgram, OmitsTheRestOfALineAfterASlash) {
    const std::string program = "G21 G0 X1. Y1.\nX4. /2 Y5.\nG91 X1.";
    Environment environment = known_environment(DialectId::fanuc);
    EXPECT_THAT(commands_of(run_text(program, environment).run), HasSubstr("x=4 y=5"));
    environment.block_delete = true;
    EXPECT_THAT(commands_of(run_text(program, environment).run), HasSubstr("x=4 y=1"));
    EXPECT_THAT(error_of(program, DialectId::linuxcnc), HasSubstr("start of the block"));
}

TEST(ShopProgram, MayHaveANameInsteadOfANumber) {
    const std::string program = "%\n<BRACKET>(OP 1)\nG21 G0 X1.\nM30\n%\n";
    EXPECT_EQ(recognised(program).dialect, DialectId::fanuc);
    EXPECT_THAT(trace(program), HasSubstr("x=1 "));
    EXPECT_THAT(error_of("G0 X1\n<A\n"), HasSubstr("'<'"));
}

TEST(ShopProgram, IsOfHaasWhereACodeOfItsOwnFollowsTheNumber) {
    for (const char* code : {"G154 P3", "G187 P1", "G12 I5. D1", "G110", "M97 P100"})
        EXPECT_EQ(recognised("%\nO00123 (A)\nG21 G0 X1.\n" + std::string(code) + "\n").dialect,
                  DialectId::haas)
            << code;
    // M97 without P ends interrupts on Fanuc; M98 exists on both.
    for (const char* code : {"M97", "M98 P100", "G54.1 P1", "G65 P9810 Z1.", "#1=3\nGOTO 5"})
        EXPECT_EQ(recognised("%\nO00123 (A)\nG21 G0 X1.\n" + std::string(code) + "\n").dialect,
                  DialectId::fanuc)
            << code;
}

TEST(ShopProgram, IsLinuxcncsWhereItHasPolarWords) {
    EXPECT_EQ(recognised("G21 G0 X1\nG91 G81 R1 Z-5 ^60 L6 F10\nM2\n").dialect,
              DialectId::linuxcnc);
    EXPECT_EQ(recognised("; G0 @1 ^60\nG21 G0 X1 (MAIL A@5)\nM2\n").dialect, DialectId::grbl);
}

TEST(ShopProgram, InUtf16IsSaidToBe) {
    const auto program = program_from_text(std::string_view("\xFF\xFEG\0O\0\n\0", 8));
    ASSERT_FALSE(program);
    EXPECT_THAT(program.error().message, HasSubstr("UTF-16"));
}

} // namespace
} // namespace gcode
