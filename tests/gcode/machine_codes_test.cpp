#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr DialectId fanuc = DialectId::fanuc, haas = DialectId::haas, grbl = DialectId::grbl,
                    linuxcnc = DialectId::linuxcnc;

TEST(PrintStatements, MoveNothing) {
    const std::string_view text =
        "G21 G0 X1\nPOPEN\nDPRNT[X#5021[44]*Y#2[33]]\nN5 BPRNT[C*X#1[3]]\n"
        "DPRNT[]\nPCLOS\nX2\n";
    for (const DialectId dialect : {fanuc, haas})
        EXPECT_EQ(trace(text, dialect),
                  "straight_traverse x=1 y=0 z=0\nstraight_traverse x=2 y=0 z=0\n");
    EXPECT_THAT(error_of("DPRNT[X#1[44]"), HasSubstr("1:1: 'DPRNT' needs a list in brackets"));
    EXPECT_THAT(error_of("DPRNT X"), HasSubstr("needs a list"));
    EXPECT_FALSE(error_of("POPEN", linuxcnc).empty());
    EXPECT_EQ(trace("G21 G0 B5 D1\nP1"), trace("G21 G0 B5 D1"));
}

TEST(AnswersOfTheOperator, GoToTheVariablesOfTheControl) {
    for (const char* number : {"500", "549", "10500", "10549"})
        EXPECT_EQ(error_of("M109 P" + std::string(number) + " (GO ON?)", haas), "") << number;
    for (const char* number : {"1", "499", "550", "10499", "10550"})
        EXPECT_THAT(error_of("M109 P" + std::string(number), haas),
                    HasSubstr("P must be 500 to 549 or 10500 to 10549"))
            << number;
}

TEST(FailedBlocks, LeaveTheSharedVariablesAsTheyWere) {
    // A machine code, assignments and a wear offset come before the error in their block.
    constexpr std::pair<DialectId, const char*> programs[] = {
        {haas, "#501=7.\nM109 P501 G53 G2 X1.\n"},
        {linuxcnc, "#100=7\nM66 P1 L0 #100=9 #101=5 #100=11 G53 G2\n"},
        {fanuc, "#500=7.\n#500=9. #500=11. #3000=1\n"},
        {fanuc, "#500=7.\nG10 L11 P1 R0.5 G53 G2 X1.\n"},
    };
    for (const auto& [dialect, text] : programs) {
        Environment environment;
        environment.dialect = dialect;
        environment.control.reports_premises = true;
        const auto program = program_from_text(text);
        ASSERT_TRUE(program);
        ProgramLibrary library(*program, gcode::dialect(dialect), {});
        InterpreterState state = initial_state(environment);
        Interpreter interpreter(library, environment);
        ASSERT_TRUE(interpreter.next(state)) << text;
        const InterpreterState before = state;
        EXPECT_FALSE(interpreter.next(state)) << text;
        EXPECT_TRUE(state.parameters == before.parameters) << text;
        EXPECT_EQ(state.parameters->digest(), before.parameters->digest()) << text;
        EXPECT_EQ(digest_of(state), digest_of(before)) << text;
    }
}

TEST(SharedVariables, TakeBackTheirChangesInReverse) {
    Parameters parameters;
    parameters.set_numbered(500, 7.0);
    parameters.set_named("_depth", 2.0);
    parameters.mark(501, true);
    parameters.begin_changes();
    const Parameters before = parameters;
    EXPECT_FALSE(parameters.has_changes());
    parameters.set_numbered(500, 8.0);
    parameters.set_numbered(500, {});
    parameters.set_numbered(600, 1.0);
    parameters.set_named("_depth", 3.0);
    parameters.set_named("_width", 4.0);
    parameters.mark(501, false);
    parameters.mark(502, true);
    parameters.mark("_width", true);
    parameters.mark("_width", true);
    EXPECT_TRUE(parameters.has_changes());
    EXPECT_FALSE(parameters == before);
    parameters.take_back_changes();
    EXPECT_TRUE(parameters == before);
    EXPECT_EQ(parameters.digest(), before.digest());
    EXPECT_EQ(parameters.numbered(500), 7.0);
    EXPECT_EQ(parameters.named().at("_depth"), 2.0);
    EXPECT_TRUE(parameters.is_unpredictable(501));
    EXPECT_FALSE(parameters.is_unpredictable(502));
    EXPECT_TRUE(parameters.unpredictable_names().empty());
    EXPECT_FALSE(parameters.has_changes());
}

TEST(CodesOfOneGroup, TheLastCountsOnFanuc) {
    // G28 goes through Z0 of the program, not through where the tool is.
    const std::string_view text = "G21 G90 G0 Z10\nG91 G28 Z0 G90\n";
    EXPECT_THAT(trace(text), HasSubstr("z=10\nstraight_traverse x=0 y=0 z=0\n"));
    EXPECT_EQ(trace(text), trace("G21 G90 G0 Z10\nG90 G28 Z0\n"));
    EXPECT_THAT(warnings_of(text), HasSubstr("G91 has no effect in this block"));
    EXPECT_EQ(trace("G21 G0 G1 X5 F100"), trace("G21 G1 X5 F100"));
    for (const DialectId dialect : {haas, linuxcnc})
        EXPECT_THAT(error_of(text, dialect), HasSubstr("same modal group"));
    EXPECT_THAT(error_of("G28 G53 Z0"), HasSubstr("same modal group"));
    EXPECT_THAT(warnings_of("G21 G90 G90 G0 X1"), Not(HasSubstr("no effect")));
}

TEST(OlderToolEntries, L1IsWearAndNoLIsOneValue) {
    const auto z_after = [](std::string_view text) {
        const Ran ran = run_text(text, fanuc);
        EXPECT_FALSE(ran.run.error) << (ran.run.error ? ran.run.error->message : "");
        return *machine_from_program(ran.run.state.modal.offsets, ran.run.state.modal.position)[2];
    };
    EXPECT_EQ(z_after("G21 G10 L10 P5 R100\nG10 L1 P5 R-0.5\nG43 H5 G0 Z1"), 100.5);
    EXPECT_EQ(z_after("G21 G10 P1 R25.\nG43 H1 G0 Z1"), 26.0);
    EXPECT_EQ(z_after("G21 G10 P1 R25.\nG91 G10 P1 R-1.\nG90 G43 H1 G0 Z1"), 25.0);
    const Ran ran = run_text("G21 G10 P7 R5.", fanuc);
    EXPECT_EQ(diameter_under(*ran.run.state.tables, 7), 10.0);
    EXPECT_THAT(warnings_of(ran.run), HasSubstr("offset 7 is taken as one value"));
    EXPECT_THAT(error_of("G10 P1 X5"),
                HasSubstr("G10 needs L2 or L20 for a work offset, or P and"));
    EXPECT_THAT(error_of("G10 P1 R25.", haas), HasSubstr("G10 needs L2 or L20"));
    EXPECT_THAT(error_of("G10 L1 P1 R25.", haas), HasSubstr("this form of G10"));
    Environment environment = known_environment(fanuc);
    environment.length_offsets[core::OffsetNumber(1)] = {.length = 80.0, .diameter = 10.0};
    EXPECT_THAT(run_text("G21 G10 P1 R25.", environment).run.error->message,
                HasSubstr("offset 1 has a length and a diameter"));
}

TEST(MeasuringCodes, AreMovesOrRefused) {
    const std::string moved = "straight_probe x=20 y=0 z=0 feed=100";
    for (const std::string code : {"G35 D1", "G36", "G136"}) {
        const std::string text = "G21 G90\nG0 X0\n" + code + " X20 F100\n";
        EXPECT_THAT(trace(text, haas), HasSubstr(moved)) << code;
        EXPECT_THAT(warnings_of(text, haas), HasSubstr("is assumed to be the one"));
        EXPECT_THAT(error_of("G21 " + code + " F100", haas), HasSubstr("needs an axis word"));
    }
    for (const DialectId dialect : {haas, fanuc})
        EXPECT_THAT(error_of("G21 G43 H1\nG37 Z5 F100", dialect),
                    HasSubstr("only the control knows where"));
    EXPECT_THAT(error_of("G36 X5"), HasSubstr("only the control knows where"));
}

TEST(Refusals, NameWhatTheCodeDoes) {
    for (const DialectId dialect : {haas, fanuc}) {
        EXPECT_THAT(error_of("G60 X5", dialect), HasSubstr("Fanuc 5440"));
        EXPECT_THAT(error_of("G107 A0 R10", dialect), HasSubstr("cylindrical"));
    }
    EXPECT_THAT(error_of("G12.1"), HasSubstr("polar coordinate interpolation"));
    EXPECT_THAT(error_of("G7.1 A10"), HasSubstr("cylindrical"));
    EXPECT_THAT(error_of("G141 D1 X5", haas), HasSubstr("compensation along I, J and K"));
    EXPECT_THAT(error_of("G165 X5", haas), HasSubstr("cycles along a tilted tool"));
    EXPECT_THAT(error_of("G71 P1 Q2"), HasSubstr("lathe cycles are not supported"));
    EXPECT_THAT(error_of("G71 P1 Q2", haas), HasSubstr("cycles of lathes are not supported"));
}

TEST(StoredLimits, MoveNothing) {
    EXPECT_EQ(trace("G21 G0 X1\nG22 X100 Y100 Z0 I-100 J-100 K-200\nG23\nX2"),
              trace("G21 G0 X1\n\n\nX2"));
    EXPECT_THAT(warnings_of("G22 X1 Y1 Z1"), HasSubstr("forbidden area is not modelled"));
}

TEST(TapsInAnyDirection, FeedToTheEndAndBack) {
    const std::string text = "G21 G0 X0 Y0 Z0\nF100 S200\nG184 X10 Z-10\nX1\n";
    const std::string wanted =
        "spindle direction=clockwise speed=200\nstraight_feed x=10 y=0 z=-10 feed=100\n"
        "spindle direction=counterclockwise speed=200\nstraight_feed x=0 y=0 z=0 feed=100\n"
        "spindle direction=stopped speed=0\nstraight_traverse x=1 y=0 z=0\n";
    EXPECT_THAT(trace(text, haas), HasSubstr(wanted));
    EXPECT_THAT(trace("G21 G0 X0 Y0 Z0\nF100 S200\nG174 Z-10\n", haas),
                HasSubstr("z=0\nspindle direction=counterclockwise speed=200"));
    EXPECT_THAT(error_of("G21 G0 Z0\nG184 Z-1 F100", haas), HasSubstr("G184 needs S"));
    EXPECT_THAT(error_of("G21 G0 Z0\nG184 S5 F100", haas), HasSubstr("G184 needs X, Y or Z"));
}

TEST(HarmlessMCodes, AreKnownOnTheirControl) {
    EXPECT_EQ(warnings_of("G21\nM10\nM12\nM31\nM33\nM34\nM41\nM59 P1133\nM69 P1133\nM75\nM80\nM83\n"
                          "M88\nM95\nM130\nM138 P1 E2\nM160\nM181\nM30",
                          haas),
              "");
    EXPECT_EQ(warnings_of("G21\nM56 P1\nM30", grbl), "");
    EXPECT_THAT(warnings_of("G21\nM31\nM30", fanuc), HasSubstr("M31: unknown M code"));
    EXPECT_THAT(warnings_of("G21\nM82\nM30", haas), HasSubstr("M82: unknown M code"));
}

TEST(GrblArcs, IgnoreTheOffsetOfTheThirdAxis) {
    const std::string_view arc = "G21 G0 X0 Y0 Z5\nG3 X10 Y0 I5 J0 F100";
    EXPECT_EQ(trace(std::string(arc) + " K0", grbl), trace(arc, grbl));
    EXPECT_EQ(warnings_of(std::string(arc) + " K0\nM2", grbl), "");
    EXPECT_EQ(trace(std::string(arc) + " K3", grbl), trace(arc, grbl));
    EXPECT_THAT(warnings_of(std::string(arc) + " K3", grbl), HasSubstr("K3: the control ignores"));
    EXPECT_THAT(error_of("G21 G0 X0 Y0\nG3 X10 Y0 R5 K0 F100", grbl), HasSubstr("does not use"));
    EXPECT_THAT(error_of("G21 G0 X0 Y0\nG3 X10 Y0 K5 F100", grbl), HasSubstr("has no centre"));
    const Ran other = run_text(std::string(arc) + " K0", linuxcnc);
    ASSERT_TRUE(other.run.error);
    EXPECT_EQ(other.run.error->code, core::ErrorCode::syntax); // not the rule of wrong arcs
}

TEST(Positions, FarBeyondEveryMachineAreErrors) {
    const std::string far = "1" + std::string(40, '0');
    for (const DialectId dialect : {fanuc, grbl, linuxcnc})
        EXPECT_THAT(error_of("G21 G0 X0 Y0 Z0\nG0 X" + far, dialect), HasSubstr("too large"));
    EXPECT_THAT(error_of("G21 G0 X0\nG0 X5000000000"), HasSubstr("further than any machine"));
    EXPECT_THAT(error_of("G21 G0 X0\nG91\nX999999999\nX999999999"), HasSubstr("4:1: X999999999"));
    EXPECT_EQ(error_of("G21 G0 X0\nG0 X99999999"), "");
}

} // namespace
} // namespace gcode
