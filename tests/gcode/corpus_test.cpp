#include <cctype>
#include <cstdlib>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

const std::filesystem::path shared_programs = source_dir / "../shared/programs";

/// The shared programs of a kind; without them the test is skipped or fails.
std::vector<std::filesystem::path> programs_of(const std::string& kind) {
    std::vector<std::filesystem::path> paths;
    std::error_code absent;
    for (const auto& entry : std::filesystem::directory_iterator(shared_programs / kind, absent))
        paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    return paths;
}

class Corpus : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override {
        if (std::filesystem::exists(shared_programs)) return;
        if (std::getenv("FEELER_REQUIRE_SHARED")) FAIL() << shared_programs << " is missing";
        GTEST_SKIP() << shared_programs << " is missing";
    }
};

TEST_P(Corpus, RunsOrSaysWhereAndWhyNot) {
    size_t finished = 0;
    const auto paths = programs_of(GetParam());
    ASSERT_FALSE(paths.empty());
    for (const auto& path : paths) {
        const auto program = read_program(path.string());
        ASSERT_TRUE(program) << program.error().message;
        Environment environment;
        environment.dialect = recognise(*program).dialect;
        const auto whole = gcode::run(*program, environment);
        finished += !whole.error;
        if (!whole.error || !dialect(environment.dialect).supported) continue;
        const core::Error& error = *whole.error;
        EXPECT_GT(error.where.line, 0u) << path << ": " << error.message;
        EXPECT_GT(error.where.column, 0u) << path << ": " << error.message;
        EXPECT_EQ(error.file, path.string());
        // The message quotes the word or the character at the position of the error.
        const std::string_view line = program->line(error.where.line);
        const char at = line.at(error.where.column - 1);
        if (std::iscntrl(static_cast<unsigned char>(at))) continue; // quoted as a number
        EXPECT_NE(error.message.find_first_of({at, static_cast<char>(std::toupper(at))}),
                  std::string::npos)
            << path << ": " << error.message;
    }
    // Of the heidenhain programs, one calls a program stored under another name, one is that
    // program, which stops without its parameters, and one divides by a distance that is set by
    // manual jogging.
    RecordProperty("finished", static_cast<int>(finished));
    const std::map<std::string, size_t> least = {{"fanuc-like", 16},
                                                 {"linuxcnc", 10},
                                                 {"grbl-hobby", 20},
                                                 {"siemens", 1},
                                                 {"heidenhain", 9}};
    EXPECT_GE(finished, least.at(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Shared, Corpus,
                         testing::Values("fanuc-like", "linuxcnc", "grbl-hobby", "siemens",
                                         "heidenhain"),
                         [](const auto& kind) {
                             std::string name = kind.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

} // namespace
} // namespace gcode
