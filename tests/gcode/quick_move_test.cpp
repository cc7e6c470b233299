#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gcode/exec/quick_move.h"
#include "tests/gcode/programs.h"
#include "tests/support/same_state.h"

namespace gcode {
namespace {

std::string random_words(std::mt19937& random, std::string_view letters) {
    std::string words;
    for (const char letter : letters)
        if (random() % 2 == 0)
            words += fmt::format(" {}{}", letter, static_cast<int>(random() % 4000) / 16.0 - 100.0);
    return words;
}

/// A line of a program that consists mainly of straight moves and sometimes changes a mode.
std::string random_line(std::mt19937& random, std::string_view axes) {
    constexpr std::string_view modes[] = {
        "G90", "G91",           "G20",         "G21",    "G17",      "G2 X1 Y0 I5 J0 F60",
        "G80", "G81 Z-5 R2",    "G93",         "G94",    "T1 M6",    "G0",
        "G1",  "G54",           "G55",         "M3 S99", "G43 H1",   "G49",
        "F0",  "G53 G0 X1 Z-1", "G41 D1 X50.", "G40 X9", "G92 X1.5", "G28 Z9"};
    if (random() % 8 == 0) return std::string(modes[random() % std::size(modes)]);
    constexpr std::string_view codes[] = {"", "", "", "G0", "G1", "G01", "G00", "N10 G1", "g1"};
    std::string line(codes[random() % std::size(codes)]);
    line += random_words(random, random() % 3 == 0 ? axes : "XYZ");
    if (random() % 6 == 0) line += fmt::format(" F{}", random() % 500);
    if (random() % 60 == 0) line += " F-3";
    if (random() % 60 == 0) line += " S5";
    return line;
}

std::string outcome_of(const std::string& text, DialectId dialect) {
    const Ran ran = run_text(text, dialect);
    std::string outcome = commands_of(ran.run);
    for (const BlockCommands& block : ran.run.blocks) {
        outcome += fmt::format("{}", block.line);
        for (const uint32_t column : block.columns) outcome += fmt::format(" {}", column);
        for (const Warning& warning : block.warnings)
            outcome +=
                fmt::format(" {}:{} {}", warning.where.line, warning.where.column, warning.message);
        outcome += "\n";
    }
    if (ran.run.error) outcome += ran.run.error->message;
    return outcome + fmt::format("{}", digest_of(ran.run.state));
}

TEST(QuickMove, DoesWhatTheStepsOfABlockDo) {
    std::mt19937 random(3);
    for (int round = 0; round < 600; ++round) {
        const DialectId dialect = std::array{DialectId::linuxcnc, DialectId::fanuc, DialectId::haas,
                                             DialectId::grbl}[static_cast<size_t>(round % 4)];
        const std::string_view axes = dialect == DialectId::grbl ? "XYZ" : "XYZABCUVW";
        std::string quick = "G21 G90 G94 G17 F100\n", slow = quick;
        for (int line = 0; line < 40; ++line) {
            const std::string words = random_line(random, axes);
            quick += words + "\n";
            slow += words + "()\n"; // a comment prevents the fast path
        }
        ASSERT_EQ(outcome_of(quick, dialect), outcome_of(slow, dialect)) << quick;
    }
}

TEST(QuickMove, LeavesWhatIsMoreThanAStraightMove) {
    const Environment environment = known_environment(DialectId::linuxcnc);
    InterpreterState state = initial_state(environment);
    EXPECT_FALSE(moves_quickly(state)); // no motion code yet
    state.modal.motion = MotionCode::straight;
    state.modal.unit_said = true;
    state.rules.offset_is_fresh = false;
    ASSERT_TRUE(moves_quickly(state));
    const InterpreterState before = state;
    BlockCommands result;
    for (const Word word : {Word{'I', 1.0}, Word{'S', 1.0}, Word{'G', 2.0}, Word{'X', 1.0}}) {
        Block block; // a feed without F, or a word that does not belong to a straight move
        block.words = {word};
        EXPECT_FALSE(run_quick_move(block, state, result)) << word.letter;
        EXPECT_TRUE(continue_alike(state, before) && result.commands.empty());
    }
}

} // namespace
} // namespace gcode
