#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"
#include "tests/support/same_state.h"

namespace gcode {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Interpreter, CarriesWordsOutInTheOrderOfTheStandard) {
    // NISTIR 6556, table 8: S, T, M6, M3, M8, G17, G43, G54, G0, whatever the order of the words.
    EXPECT_EQ(trace("G0 X1 G54 G43 H0 G17 M8 M3 M6 T2 S100"),
              "select_tool tool=2\n"
              "change_tool tool=2\n"
              "spindle direction=clockwise speed=100\n"
              "coolant mist=0 flood=1\n"
              "select_plane plane=XY\n"
              "use_tool_length_offset number=0 length=0\n"
              "set_offset offset=G54 x=0 y=0 z=0\n"
              "straight_traverse x=1 y=0 z=0\n");
}

TEST(Interpreter, ModesHoldForTheBlocksAfter) {
    EXPECT_EQ(trace("G0 X1\nY2\nG1 Z-1 F100\nX3"), "straight_traverse x=1 y=0 z=0\n"
                                                   "straight_traverse x=1 y=2 z=0\n"
                                                   "straight_feed x=1 y=2 z=-1 feed=100\n"
                                                   "straight_feed x=3 y=2 z=-1 feed=100\n");
}

TEST(Interpreter, AxesStayUnknownUntilCommanded) {
    const Ran ran =
        run_text("G0 Z5\nG91 X1 Z1\nG90 X2\n", Environment{.dialect = DialectId::fanuc});
    EXPECT_FALSE(ran.run.error);
    EXPECT_EQ(commands_of(ran.run), "straight_traverse z=5\n"
                                    "straight_traverse z=6\n"
                                    "straight_traverse x=2 z=6\n");
}

TEST(Interpreter, CountsBlocksNotLines) {
    const Ran ran = run_text("%\nO1 (A)\n\n(comment)\nN10\n/G0 X1\n; more\nM30\n%\nG0 X9\n");
    ASSERT_EQ(ran.run.blocks.size(), 4u);
    const uint32_t lines[] = {2, 5, 6, 8};
    for (uint32_t i = 0; i < 4; ++i) {
        EXPECT_EQ(ran.run.blocks[i].block, core::BlockIndex(i));
        EXPECT_EQ(ran.run.blocks[i].line, lines[i]);
    }
    EXPECT_EQ(ran.run.blocks[2].text, "/G0 X1");
    EXPECT_EQ(ran.run.state.ending, ProgramStatus::program_end);
    EXPECT_FALSE(ran.run.ending);
}

TEST(Interpreter, IgnoresEverythingAfterTheSecondTapeMark) {
    const Ran ran = run_text("%\nG0 X1\n%\n!garbage\n", DialectId::linuxcnc);
    EXPECT_FALSE(ran.run.error);
    EXPECT_EQ(ran.run.blocks.size(), 1u);
    EXPECT_FALSE(ran.run.ending);
    EXPECT_THAT(warnings_of("%\nG0 X1\n%\n", DialectId::fanuc), HasSubstr("no M2 or M30"));
}

TEST(Interpreter, BlockDeleteRunsOrSkipsBySwitch) {
    const std::string_view text = "G0 X1\n/X2\n/ !garbage of another machine\n";
    EXPECT_THAT(error_of(text), HasSubstr("3:3: "));
    Environment environment = known_environment(DialectId::fanuc);
    environment.block_delete = true;
    const Ran ran = run_text(text, environment);
    EXPECT_FALSE(ran.run.error);
    EXPECT_EQ(commands_of(ran.run), "straight_traverse x=1 y=0 z=0\n");
    EXPECT_EQ(commands_of(run_text("N5 /G0 X1", environment).run), "");
    EXPECT_EQ(commands_of(run_text("/G0 X1").run), "straight_traverse x=1 y=0 z=0\n");
}

TEST(Interpreter, BlockDeleteHasASwitchForEachNumberThatTheControlKnows) {
    const auto questions = [](std::string_view text, DialectId dialect) {
        Environment environment = known_environment(dialect);
        environment.control.reports_premises = true;
        const auto program = program_from_text(text, "test.nc");
        ProgramLibrary library(*program, gcode::dialect(dialect));
        Interpreter interpreter(library, environment);
        InterpreterState state = initial_state(environment);
        while (true) {
            const auto block = interpreter.next(state);
            if (!block || !*block) break;
        }
        return std::count_if(state.readings->met.begin(), state.readings->met.end(),
                             [](const OpenPremise& premise) {
                                 return premise.id.question == ControlQuestion::blocks_are_deleted;
                             });
    };
    EXPECT_EQ(questions("G90 G0 X1\n/X2\n/1 X3\n/2 X4\n", DialectId::fanuc), 2);
    EXPECT_EQ(questions("G90 G0 X1\n/X2\n/0 X3\n/1 X4\n", DialectId::siemens), 2);
    EXPECT_EQ(
        questions("BEGIN PGM A MM\n/1 L X+1 FMAX\n/2 L X+2 FMAX\n3 / L X+3 FMAX\n/ L X+4 FMAX\n"
                  "END PGM A MM\n",
                  DialectId::heidenhain),
        1);
}

TEST(Interpreter, LeavesTheStateAloneOnError) {
    const std::string_view mistakes[] = {"G1 X5",
                                         "G0 X5 G123",
                                         "T5 M6 S100 M3 G55 G20 G91 F5 G2 X5 R0.1",
                                         "G43 H3 G0 B90 K1 G123",
                                         "G81 X1 Z5 R1 F10",
                                         "G10 L9 P1",
                                         "G52 X5 G2 X1 Y1 I1 F5",
                                         "X1 X2",
                                         "S-5 M3"};
    for (const std::string_view mistake : mistakes) {
        const Environment environment = known_environment(DialectId::fanuc);
        const auto program = program_from_text("G0 X1\n" + std::string(mistake) + "\n");
        ASSERT_TRUE(program);
        ProgramLibrary library(*program, dialect(environment.dialect));
        Interpreter interpreter(library, environment);
        InterpreterState state = initial_state(environment);
        ASSERT_TRUE(interpreter.next(state));
        const InterpreterState before = state;
        const auto result = interpreter.next(state);
        ASSERT_FALSE(result) << mistake;
        EXPECT_EQ(result.error().where.line, 2u) << mistake;
        EXPECT_GT(result.error().where.column, 0u) << mistake;
        EXPECT_TRUE(continue_alike(state, before)) << mistake;
    }
}

TEST(Interpreter, DistinguishesStatesByTheirWaitingBlocks) {
    InterpreterState state = initial_state(known_environment(DialectId::fanuc));
    state.contour.write().corners.word = CornerWord{};
    state.contour.write().corners.waiting.emplace_back();
    InterpreterState other = state;
    EXPECT_TRUE(continue_alike(state, other));
    other.contour.write().corners.waiting[0].before.position[0] = 1.0;
    EXPECT_FALSE(continue_alike(state, other));
}

TEST(Interpreter, GivesTheSameAgainFromACopiedState) {
    const Environment environment = known_environment(DialectId::fanuc);
    const auto program = program_from_text("G0 X1\nG91 X1\nG2 X2 I1 F100\n");
    ASSERT_TRUE(program);
    ProgramLibrary library(*program, dialect(environment.dialect));
    Interpreter interpreter(library, environment);
    InterpreterState state = initial_state(environment);
    ASSERT_TRUE(interpreter.next(state));
    InterpreterState copy = state;
    while (state.ending == ProgramStatus::running) ASSERT_TRUE(interpreter.next(state));
    EXPECT_NE(digest_of(state), digest_of(copy));
    while (copy.ending == ProgramStatus::running) ASSERT_TRUE(interpreter.next(copy));
    EXPECT_TRUE(continue_alike(state, copy));
    EXPECT_EQ(digest_of(state), digest_of(copy));
}

TEST(Interpreter, NeedsAMotionCodeForAxisWords) {
    EXPECT_EQ(error_of("G54\nX10", DialectId::linuxcnc),
              "2:1: X10: no motion code is active; program G0, G1, G2 or G3");
    EXPECT_THAT(error_of("G0 X1\nG80 X2", DialectId::linuxcnc), HasSubstr("2:5: X2"));
}

TEST(Interpreter, NeedsAFeedRateForFeeds) {
    EXPECT_EQ(error_of("G0 X1\nG1 X2"), "2:1: G1: no feed rate: no F has been programmed yet");
    EXPECT_EQ(error_of("G1 X2 F0"), "1:1: G1: the feed rate is F0");
    EXPECT_EQ(error_of("F-1"), "1:1: F-1: a feed rate must not be negative");
}

TEST(Interpreter, WarnsOfAnEndWithoutM2) {
    const Ran ran = run_text("G0 X1\n");
    ASSERT_TRUE(ran.run.ending);
    EXPECT_EQ(ran.run.ending->severity, Severity::warning);
    EXPECT_THAT(ran.run.ending->message, HasSubstr("no M2 or M30"));
    EXPECT_FALSE(run_text("G0 X1\nM2\n").run.ending);
    EXPECT_FALSE(run_text("G0 X1\nM30").run.ending);
}

TEST(Interpreter, RepeatsAMainProgramThatEndsInM99UntilNothingChanges) {
    const Ran ran = run_text("G0 X1\nM99\nG0 X2\n");
    EXPECT_EQ(ran.run.blocks.size(), 6u); // the first pass starts elsewhere
    ASSERT_TRUE(ran.run.ending);
    EXPECT_THAT(ran.run.ending->message, HasSubstr("M99"));
}

TEST(Interpreter, StopsAreCommands) {
    EXPECT_EQ(trace("M0\nM1\nM60", DialectId::linuxcnc),
              "program_stop\noptional_stop\nprogram_stop\n");
    EXPECT_EQ(to_text(run_text("M30").run.blocks[0].commands[0]), "program_end");
}

TEST(Trace, WritesAFrameRowByRowAndThenItsShift) {
    SetOffset command;
    command.offsets.has_frame = true;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            command.offsets.frame.linear[column][row] = 3 * row + column + 1;
    command.offsets.frame.shift = {10.5, -11.0, 12.0};
    EXPECT_THAT(to_text(command), testing::EndsWith(" frame=1,2,3,4,5,6,7,8,9,10.5,-11,12"));
}

TEST(Interpreter, SaysOnceThatUnitsWereAssumed) {
    const std::string warnings = warnings_of("G17\nG0 X1\nX2\nM30\n");
    EXPECT_THAT(warnings,
                HasSubstr("no units (G20 or G21) programmed before X1; millimetres assumed"));
    EXPECT_THAT(warnings, Not(HasSubstr("before X2")));
    EXPECT_THAT(warnings_of("G0 X1\n", DialectId::linuxcnc), HasSubstr("millimetres assumed"));
    Environment inches = known_environment(DialectId::linuxcnc);
    inches.machine_unit = LengthUnit::inch;
    EXPECT_THAT(warnings_of(run_text("G0 X1\n", inches).run), HasSubstr("inches assumed"));
    EXPECT_EQ(warnings_of("G21 G0 X1\nM30\n"), "");
}

} // namespace
} // namespace gcode
