#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gcode/text/source.h"

namespace gcode {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string scratch(const std::string& name) {
    return testing::TempDir() + "feeler_source_" + std::to_string(getpid()) + "_" + name;
}

std::string file_with(const std::string& name, std::string_view content) {
    const std::string path = scratch(name);
    std::ofstream(path, std::ios::binary) << content;
    return path;
}

core::Error error_of_file(const std::string& path) {
    const auto program = read_program(path);
    return program ? core::Error{} : program.error();
}

TEST(Source, KeepsTheTextAndIndexesItsLines) {
    const auto program = read_program(file_with("lines.nc", "G0\nX1\r\nX2\rX3"));
    ASSERT_TRUE(program) << program.error().message;
    ASSERT_EQ(program->line_count(), 4u);
    EXPECT_EQ(program->line(1), "G0");
    EXPECT_EQ(program->line(2), "X1");
    EXPECT_EQ(program->line(3), "X2");
    EXPECT_EQ(program->line(4), "X3");
}

TEST(Source, CountsEmptyLines) {
    const auto program = program_from_text("\n\r\n\r\rG0\n");
    ASSERT_TRUE(program);
    ASSERT_EQ(program->line_count(), 5u);
    EXPECT_EQ(program->line(5), "G0");
}

TEST(Source, SkipsAByteOrderMark) {
    const auto program = program_from_text("\xEF\xBB\xBFG0 X1\n");
    ASSERT_TRUE(program);
    EXPECT_EQ(program->line(1), "G0 X1");
}

TEST(Source, NamesAMissingFile) {
    const core::Error error = error_of_file(scratch("nowhere.nc"));
    EXPECT_EQ(error.code, core::ErrorCode::io);
    EXPECT_THAT(error.message, AllOf(HasSubstr("nowhere.nc"), HasSubstr("No such file")));
    EXPECT_THAT(error.file, HasSubstr("nowhere.nc"));
}

TEST(Source, RefusesADirectory) {
    const core::Error error = error_of_file(testing::TempDir());
    EXPECT_EQ(error.code, core::ErrorCode::io);
    EXPECT_THAT(error.message, HasSubstr("directory"));
}

TEST(Source, RefusesAFileItMayNotRead) {
    if (geteuid() == 0) GTEST_SKIP() << "root may read every file";
    const std::string path = file_with("secret.nc", "G0\n");
    ASSERT_EQ(chmod(path.c_str(), 0), 0);
    EXPECT_THAT(error_of_file(path).message, HasSubstr("Permission denied"));
}

TEST(Source, RefusesAProgramWithoutBlocks) {
    for (const std::string_view text :
         {"", "\n\n", "%\n%\n", "(only a comment)\n; and this\n", "\xEF\xBB\xBF", " \t\r\n"}) {
        const core::Error error = error_of_file(file_with("empty.nc", text));
        EXPECT_EQ(error.code, core::ErrorCode::syntax) << text;
        EXPECT_THAT(error.message, AllOf(HasSubstr("empty.nc"), HasSubstr("no blocks"))) << text;
    }
}

TEST(Source, RefusesABinaryFile) {
    const core::Error nul = error_of_file(file_with("b.nc", std::string_view("G0\nX\0", 5)));
    EXPECT_EQ(nul.code, core::ErrorCode::syntax);
    EXPECT_EQ(nul.where.line, 2u);
    EXPECT_THAT(nul.message, HasSubstr("binary"));
    EXPECT_THAT(error_of_file(file_with("c.nc", "\x01\x02\x03\x04G0 X1")).message,
                HasSubstr("binary"));
}

TEST(Source, RefusesALineLongerThanTheLimitAndNamesIt) {
    const std::string longest(longest_line, 'X');
    EXPECT_TRUE(program_from_text("G0\n" + longest + "\n"));
    const auto program = program_from_text("G0\n" + longest + "X\n", "long.nc");
    ASSERT_FALSE(program);
    EXPECT_EQ(program.error().where.line, 2u);
    EXPECT_THAT(program.error().message, AllOf(HasSubstr("long.nc"), HasSubstr("line 2"),
                                               HasSubstr("65536"), HasSubstr("split it")));
}

TEST(Source, RefusesAHugeFileOfOneLineAfterReadingLittleOfIt) {
    // The writer of the pipe notices how much was read, because the pipe breaks.
    signal(SIGPIPE, SIG_IGN);
    const std::string path = scratch("pipe.nc");
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    size_t written_bytes = 0;
    std::thread writer([&] {
        std::ofstream pipe(path, std::ios::binary);
        const std::string piece(65536, 'X');
        while (written_bytes < (size_t(1) << 30) && pipe.write(piece.data(), 65536))
            written_bytes += piece.size();
    });
    const core::Error error = error_of_file(path);
    writer.join();
    unlink(path.c_str());
    EXPECT_THAT(error.message, HasSubstr("more than 65536 characters"));
    EXPECT_LT(written_bytes, size_t(1) << 20);
}

TEST(Source, RefusesAHugeSparseFile) {
    const std::string path = file_with("sparse.nc", "G0 X1\n");
    ASSERT_EQ(truncate(path.c_str(), off_t(1) << 30), 0);
    EXPECT_THAT(error_of_file(path).message, HasSubstr("NUL"));
    unlink(path.c_str());
}

} // namespace
} // namespace gcode
