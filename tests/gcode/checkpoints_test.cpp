#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/gcode/checkpoints.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

/// A complete run with all its states.
struct Followed {
    Program program;
    Environment environment;
    std::vector<uint64_t> digests; // before each result
    Checkpoints checkpoints;

    Followed(const std::string& text, DialectId dialect) : environment(known_environment(dialect)) {
        program = *program_from_text(text);
        ProgramLibrary library(program, gcode::dialect(dialect));
        Interpreter interpreter(library, environment);
        InterpreterState state = initial_state(environment);
        while (true) {
            digests.push_back(digest_of(state));
            checkpoints.note(digests.size() - 1, state);
            const auto block = interpreter.next(state);
            EXPECT_TRUE(block) << block.error().message;
            if (!block || !*block) break;
        }
    }

    void expect_every_place_is_reached(int looks) {
        ProgramLibrary library(program, gcode::dialect(environment.dialect));
        Interpreter interpreter(library, environment);
        std::mt19937 random(11);
        for (int look = 0; look < looks; ++look) {
            const uint64_t results = random() % digests.size();
            const auto state = checkpoints.state_after(results, interpreter);
            ASSERT_TRUE(state) << state.error().message;
            EXPECT_EQ(digest_of(*state), digests[results]) << results;
        }
    }
};

std::string long_program(int lines) {
    std::string text = "G21 G90 F500\n";
    for (int line = 0; line < lines; ++line)
        text += fmt::format("G1 X{} Y{}\n", line % 97, line % 89);
    return text + "M2\n";
}

TEST(Checkpoints, CostAtMostSixteenBytesALine) {
    constexpr int lines = 400'000;
    Followed run(long_program(lines), DialectId::linuxcnc);
    EXPECT_LE(run.checkpoints.memory(), size_t{16} * lines);
    EXPECT_LE(run.checkpoints.interval(), 1024u);
    run.expect_every_place_is_reached(300);
}

TEST(Checkpoints, StaySmallWhereEveryBlockChangesWhatStatesHold) {
    std::string text = "G21 G90 F500\n#4999 = 1\n#1 = 0\no1 repeat [100000]\n#1 = [#1 + 1]\n"
                       "#3000 = #1\nG1 X[#1 / 100]\no1 endrepeat\nM2\n";
    Followed run(text, DialectId::linuxcnc);
    EXPECT_LE(run.checkpoints.memory(), 16 * run.digests.size());
    run.expect_every_place_is_reached(5);
}

TEST(Checkpoints, LieInsideSubprogramsAndContoursAsWell) {
    std::string text = "G21 G90 F500\no100 sub\nG91 G1 X1\nX#1\nX-1\nX-#1\nG90\no100 endsub\n"
                       "o2 repeat [300]\no100 call [2]\nG41.1 D2 G1 X10 Y10\nX20\nY20\nX0\nG40 Y0\n"
                       "o2 endrepeat\nM2\n";
    Followed run(text, DialectId::linuxcnc);
    run.expect_every_place_is_reached(300);
}

TEST(Checkpoints, SayWhenARunIsNotThatLong) {
    Followed run("G21\nG0 X1\nM2\n", DialectId::linuxcnc);
    ProgramLibrary library(run.program, dialect(DialectId::linuxcnc));
    Interpreter interpreter(library, run.environment);
    EXPECT_FALSE(run.checkpoints.state_after(10, interpreter));
    EXPECT_FALSE(Checkpoints().state_after(0, interpreter));
}

} // namespace
} // namespace gcode
