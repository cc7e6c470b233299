#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gcode/language/lexer.h"
#include "tests/support/canonical_program.h"
#include "tests/support/plain_trace.h"
#include "tests/support/program_generator.h"
#include "tests/support/run_difference.h"

namespace test_support {
namespace {

constexpr uint32_t seeds = 12;

/// Two equivalent programs may have different lines.
PlainRun without_lines(PlainRun run) {
    for (PlainCommand& command : run.commands) {
        command.line = 1;
        // The reference gives three axes of a tapping move, so only these are compared.
        if (command.kind == "rigid_tap") command.values.assign(&command.end[0], &command.end[3]);
    }
    if (run.refused) run.refused = 1;
    run.message.clear();
    return run;
}

std::string differences_of(const PlainRun& first, const PlainRun& second,
                           const std::string& program) {
    return report_of(compare_runs(without_lines(first), without_lines(second), {}), program);
}

class Features : public testing::TestWithParam<ProgramFeature> {
protected:
    /// Programs of this feature that run to their end.
    std::vector<std::string> programs() const {
        std::vector<std::string> found;
        for (uint32_t seed = 1; seed <= seeds; ++seed) {
            std::string program = generated_program(GetParam().name, seed);
            if (!run_feeler(program).refused) found.push_back(std::move(program));
        }
        return found;
    }
};

/// The text with each character outside comments replaced by `change`.
template <typename Change>
std::string changed_text(const std::string& program, Change change) {
    std::string text;
    char comment = '\0';
    for (const char c : program) {
        if (c == '\n') comment = '\0';
        if (comment == '\0' && (c == '(' || c == ';')) comment = c;
        text += comment == '\0' ? change(c) : std::string(1, c);
        if (comment == '(' && c == ')') comment = '\0';
    }
    return text;
}

bool can_be_written(const PlainRun& run) {
    return std::all_of(run.commands.begin(), run.commands.end(), [](const PlainCommand& command) {
        return command.kind != "straight_probe" && command.kind != "thread_feed"
               && command.kind != "rigid_tap"
               && (command.kind != "arc_feed" || command.state.plane.front() < 'U');
    });
}

TEST_P(Features, AreWhatTheirCanonicalFormIs) {
    for (const std::string& program : programs()) {
        const PlainRun run = run_feeler(program);
        if (!can_be_written(run)) continue;
        const std::string form = canonical_program(run);
        EXPECT_EQ(differences_of(run, run_feeler(form), form), "") << program << form;
    }
}

TEST_P(Features, DoNotCareAboutCaseAndSpacing) {
    for (const std::string& program : programs()) {
        const PlainRun run = run_feeler(program);
        const auto small = [](char c) { return std::string(1, gcode::lower(c)); };
        std::mt19937 random(4);
        const auto spaced = [&](char c) {
            return std::string(random() % 2, ' ') + c + std::string(random() % 3 == 0, '\t');
        };
        for (const std::string& twin :
             {changed_text(program, small), changed_text(program, spaced)})
            EXPECT_EQ(differences_of(run, run_feeler(twin), twin), "") << twin;
    }
}

TEST_P(Features, DoNotCareAboutCommentsAndBlockNumbers) {
    for (const std::string& program : programs()) {
        std::string commented, numbered;
        int number = 0;
        size_t begin = 0;
        while (begin < program.size()) {
            const size_t end = std::min(program.find('\n', begin), program.size());
            const std::string line = program.substr(begin, end - begin);
            commented += line + " (about X1 Y2)\n";
            const char first = gcode::Lexer{.line = line}.peek();
            const bool is_word = std::string_view("\0Nn%/", 5).find(first) == std::string::npos;
            numbered += is_word ? fmt::format("N{} {}\n", number += 10, line) : line + "\n";
            begin = end + 1;
        }
        const PlainRun run = run_feeler(program);
        EXPECT_EQ(differences_of(run, run_feeler(numbered), numbered), "") << numbered;
        if (program.find(';') != std::string::npos || program.find('(') != std::string::npos)
            continue; // only the last comment of a line is evaluated
        EXPECT_EQ(differences_of(run, run_feeler(commented), commented), "") << commented;
    }
}

INSTANTIATE_TEST_SUITE_P(OfTheLanguage, Features, testing::ValuesIn(program_features()),
                         [](const auto& feature) { return feature.param.name; });

} // namespace
} // namespace test_support
