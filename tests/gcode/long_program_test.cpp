#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/text/source.h"
#include "tests/support/scoped_folder.h"

namespace gcode {
namespace {

constexpr int line_count = 10'000'000;

void write_long_program(const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    ASSERT_NE(file, nullptr);
    std::string text = "G21 G90 G17\nF500\n";
    for (int line = 0; line < line_count; ++line) {
        text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", line % 1000 / 7.0, line % 777 / 3.0,
                            -(line % 13) / 11.0);
        if (text.size() < (1u << 20)) continue;
        std::fwrite(text.data(), 1, text.size(), file);
        text.clear();
    }
    text += "M2\n";
    std::fwrite(text.data(), 1, text.size(), file);
    std::fclose(file);
}

long most_memory_in_kilobytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

TEST(LongProgram, OfTenMillionLinesIsReadInBoundedMemory) {
    const test_support::ScopedFolder folder;
    const std::string path = folder / "long.ngc";
    write_long_program(path);
    const long before = most_memory_in_kilobytes();
    const auto program = open_program(path);
    ASSERT_TRUE(program) << program.error().message;
    const Environment environment;
    ProgramLibrary library(*program, dialect(environment.dialect));
    Interpreter interpreter(library, environment);
    InterpreterState state = initial_state(environment);
    int blocks = 0;
    while (true) {
        const auto block = interpreter.next(state);
        ASSERT_TRUE(block) << block.error().message;
        if (!*block) break;
        ++blocks;
    }
    EXPECT_EQ(blocks, line_count + 3);
    EXPECT_EQ(state.ending, ProgramStatus::program_end);
    EXPECT_LT(most_memory_in_kilobytes() - before, 16 * 1024);
}

} // namespace
} // namespace gcode
