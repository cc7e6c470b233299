#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/lower/trace.h"
#include "gcode/text/source.h"
#include "tests/support/scoped_folder.h"

namespace gcode {
namespace {

using test_support::ScopedFolder;
using testing::AllOf;
using testing::HasSubstr;

/// Lines of all lengths with all line ends; every third is empty.
std::string mixed_text(std::mt19937& random, size_t lines) {
    constexpr const char* ends[] = {"\n", "\r\n", "\r\r\n"};
    std::string text = "\xEF\xBB\xBF";
    for (size_t i = 0; i < lines; ++i) {
        if (random() % 3 != 0) text += "X" + std::string(random() % 90, '1');
        text += ends[random() % 3];
    }
    return text + "M30";
}

TEST(LineWindows, GiveTheLinesOfTheWholeTextInAnyOrder) {
    std::mt19937 random(1);
    for (const size_t window : {16u, 61u, 300u, 5000u}) {
        const ScopedFolder folder;
        const std::string text = mixed_text(random, 2000);
        const auto whole = program_from_text(text);
        ASSERT_TRUE(whole);
        const auto windows = LineWindows::open(folder.write("p.nc", text), window);
        ASSERT_TRUE(windows);
        for (size_t i = 0; i < 3000; ++i) {
            const size_t number = i < 1000 ? i + 1 : random() % whole->line_count() + 1;
            const auto line = (*windows)->line(number);
            ASSERT_TRUE(line && *line) << number;
            EXPECT_EQ(**line, whole->line(number)) << number << " of window " << window;
        }
        const auto behind = (*windows)->line(whole->line_count() + 1);
        ASSERT_TRUE(behind);
        EXPECT_FALSE(*behind);
    }
}

/// A control may read on in the same line.
TEST(LineWindows, HaveNoLoneReturns) {
    const ScopedFolder folder;
    std::string text;
    for (int i = 0; i < 50; ++i) text += "G0 X1\n";
    const auto windows = LineWindows::open(folder.write("p.nc", text + "G0 X2\rG0 X3\n"), 64);
    ASSERT_TRUE(windows);
    EXPECT_TRUE((*windows)->line(1));
    const auto line = (*windows)->line(51);
    ASSERT_FALSE(line);
    EXPECT_EQ(line.error().where.line, 51U);
}

/// A program with windows of a few lines.
core::Result<Program> opened(const ScopedFolder& folder, const std::string& text) {
    return open_program(folder.write("p.ngc", text), 64);
}

std::string error_of(const core::Result<Program>& program) {
    if (!program) return program.error().message;
    for (size_t number = 1;; ++number) {
        const auto there = program->has_line(number);
        if (!there) return std::to_string(there.error().where.line) + ": " + there.error().message;
        if (!*there) return {};
    }
}

TEST(OpenProgram, HoldsShortProgramsWholeAndReadsLongOnesInWindows) {
    const ScopedFolder folder;
    EXPECT_FALSE(opened(folder, "G0 X1\nM30\n")->windows);
    const auto program = opened(folder, std::string(100, '\n') + std::string(200, ' ') + "\nM30\n");
    ASSERT_TRUE(program) << program.error().message;
    EXPECT_TRUE(program->windows);
    EXPECT_TRUE(program->text.empty());
    EXPECT_EQ(program->line(102), "M30");
    EXPECT_EQ(error_of(program), "");
}

TEST(OpenProgram, DetectsATextThatIsNotAProgram) {
    const ScopedFolder folder;
    std::string lines;
    for (int i = 0; i < 100; ++i) lines += "G1 X" + std::to_string(i) + "\n";
    EXPECT_THAT(error_of(opened(folder, lines + std::string("G1\0\n", 4))),
                AllOf(HasSubstr("101: "), HasSubstr("NUL")));
    EXPECT_THAT(error_of(opened(folder, lines + std::string(70000, 'X') + "\nM30\n")),
                AllOf(HasSubstr("101: "), HasSubstr("more than 65536 characters in line 101")));
    EXPECT_THAT(error_of(opened(folder, lines + std::string(300, '\1') + "\n")),
                HasSubstr("binary"));
    EXPECT_THAT(error_of(opened(folder, "%\n" + std::string(400, '\n') + "(nothing)\n")),
                HasSubstr("no blocks"));
    EXPECT_EQ(error_of(opened(folder, lines + std::string(65536, ' ') + "\n")), "");
}

TEST(OpenProgram, NoticesThatTheFileHasChanged) {
    const ScopedFolder folder;
    std::string lines;
    for (int i = 0; i < 200; ++i) lines += "G1 X1\n";
    const auto program = opened(folder, lines);
    ASSERT_TRUE(program);
    ASSERT_TRUE(program->has_line(200).value());
    folder.write("p.ngc", std::string(lines.size(), '\n'));
    const auto again = program->has_line(1);
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("changed while"));
}

/// The commands of a run, block by block, each with its program text.
std::string traced(const Program& program, DialectId id) {
    Environment environment;
    environment.dialect = id;
    ProgramLibrary library(program, dialect(id));
    Interpreter interpreter(library, environment);
    InterpreterState state = initial_state(environment);
    std::string text;
    while (true) {
        const auto block = interpreter.next(state);
        if (!block) return text + block.error().message;
        if (!*block) return text;
        text += std::to_string((*block)->line) + " " + std::string((*block)->text) + "\n";
        for (const CanonicalCommand& command : (*block)->commands) text += to_text(command) + "\n";
    }
}

TEST(Interpreter, RunsLoopsBranchesAndCallsThroughWindowsAsInTheWholeText) {
    std::string program = "g21 g90 f100\no<far> sub\n  g1 x[#1] y2\no<far> endsub\n"
                          "#2=0\no1 while [#2 lt 20]\n";
    for (int i = 0; i < 40; ++i) program += "g1 z" + std::to_string(i) + " (a line of the loop)\n";
    program += "o2 if [#2 eq 3]\ng4 p1\n";
    for (int i = 0; i < 40; ++i) program += "g1 y" + std::to_string(i) + "\n";
    program += "o2 elseif [#2 eq 5]\no<far> call [#2]\no2 else\ng0 x0\no2 endif\n"
               "#2=[#2+1]\no1 endwhile\nm2\n";
    const ScopedFolder folder;
    const auto windows = opened(folder, program);
    const auto whole = program_from_text(program);
    ASSERT_TRUE(windows && windows->windows && whole);
    const std::string expected = traced(*whole, DialectId::linuxcnc);
    EXPECT_THAT(expected, HasSubstr("straight_feed x=5 y=2"));
    EXPECT_THAT(expected, HasSubstr("program_end"));
    EXPECT_EQ(traced(*windows, DialectId::linuxcnc), expected);
}

TEST(Interpreter, KeepsTheTextsOfBlocksThatWaitForLaterOnesWhileWindowsMoveOn) {
    std::string program = "g21 g90 g17 f100\ng0 x-20 y-20 z0\ng41.1 d4 g1 x0 y0\n";
    for (int i = 1; i < 60; ++i) {
        program += "g1 x" + std::to_string(10 * i) + " y" + std::to_string(5 * (i % 2)) + "\n";
        program += std::string(i % 5, '\n') + "m8 (while the contour waits)\n";
    }
    program += "g40 g1 x700 y50\nm2\n";
    const ScopedFolder folder;
    const auto windows = opened(folder, program);
    const auto whole = program_from_text(program);
    ASSERT_TRUE(windows && windows->windows && whole);
    const std::string expected = traced(*whole, DialectId::linuxcnc);
    EXPECT_THAT(expected, HasSubstr("program_end"));
    EXPECT_EQ(traced(*windows, DialectId::linuxcnc), expected);
}

} // namespace
} // namespace gcode
