#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "core/base/rule.h"
#include "tests/app/checked.h"

namespace app_test {
namespace {

const std::filesystem::path folder = std::filesystem::path(FEELER_SOURCE_DIR) / "tests/planted";

/// A row of the table: a program with a mistake and its correct twin.
struct Planted {
    std::string rule, dialect, program;
    int line = 0; // 0: the program as a whole
    std::string setup, right, right_setup;
    std::vector<std::string> options, right_options;
};

/// The options of a row. A file named by an option is in the folder of the set-ups.
std::vector<std::string> options_in(const std::string& word) {
    if (word == "-") return {};
    const std::string ini = "--ini=";
    if (!word.starts_with(ini)) return {word};
    return {ini + (folder / "setups" / word.substr(ini.size())).string()};
}

std::vector<Planted> table() {
    std::ifstream file(folder / "table.txt");
    std::vector<Planted> rows;
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::stringstream words(line);
        Planted row;
        std::string options, right_options;
        words >> row.rule >> row.dialect >> row.program >> row.line >> row.setup >> row.right
            >> row.right_setup >> options >> right_options;
        row.options = options_in(options);
        row.right_options = options_in(right_options);
        rows.push_back(row);
    }
    return rows;
}

Checked checked(const Planted& row, const std::string& program, const std::string& setup,
                std::vector<std::string> options) {
    options.insert(options.end(), {"--dialect", row.dialect});
    return check_files(folder / program, folder / "setups" / (setup + ".toml"), options);
}

std::string text_of(const Checked& result) {
    std::string text;
    for (const FindingLine& finding : result.findings)
        text += "\n  " + finding.severity + " " + finding.rule + " "
                + (finding.line ? std::to_string(*finding.line) : "-") + ": " + finding.message;
    return text + "\n" + result.err;
}

class PlantedRow : public testing::TestWithParam<Planted> {};

TEST_P(PlantedRow, IsFoundAtItsLineWithItsSeverity) {
    const Planted& row = GetParam();
    const Checked result = checked(row, row.program, row.setup, row.options);
    const auto severity = core::default_severity(row.rule);
    ASSERT_TRUE(severity) << row.rule;
    bool found = false;
    for (const FindingLine& finding : result.findings)
        found = found
                || (finding.rule == row.rule && finding.line.value_or(0) == row.line
                    && finding.severity == core::name_of(*severity) && !finding.message.empty());
    EXPECT_TRUE(found) << row.program << ":" << row.line << " " << row.rule << text_of(result);
    if (*severity == core::Severity::error) {
        EXPECT_GE(result.status, 1) << row.program;
    }
}

TEST_P(PlantedRow, HasNoMillimetresInACureThatWereNotTried) {
    const Planted& row = GetParam();
    static const std::regex amount("[0-9] mm");
    for (const FindingLine& finding : checked(row, row.program, row.setup, row.options).findings) {
        const bool is_fact = finding.rule == "undecided"; // the tolerance that causes the doubt
        if (is_fact || !std::regex_search(finding.cure, amount)) continue;
        EXPECT_NE(finding.cure.find("tried"), std::string::npos)
            << row.program << " " << finding.rule << ": " << finding.cure;
    }
}

TEST_P(PlantedRow, HasATwinAboutWhichNothingIsSaid) {
    const Planted& row = GetParam();
    const Checked result = checked(row, row.right, row.right_setup, row.right_options);
    EXPECT_EQ(result.status, 0) << row.right << text_of(result);
    EXPECT_EQ(result.errors() + result.of_severity("warning"), "") << row.right << text_of(result);
    const char* severity = core::name_of(core::default_severity(row.rule).value());
    for (const FindingLine& finding : result.findings)
        EXPECT_FALSE(finding.rule == row.rule && finding.severity == severity)
            << row.right << text_of(result);
}

INSTANTIATE_TEST_SUITE_P(Table, PlantedRow, testing::ValuesIn(table()), [](const auto& row) {
    std::string name;
    for (const char letter : row.param.program)
        if (std::isalnum(static_cast<unsigned char>(letter)))
            name += letter;
        else
            name += '_';
    return name;
});

/// Rules without a row here, because a row cannot state what they need.
const std::set<std::string_view> tested_elsewhere = {
    "fixture-move",     // fixture_move_test
    "gouge",            // part_test
    "incomplete-setup", // coverage_test
    "loose-piece",      // stock_pieces_test
    "program",          // tests of each remark
    "refused",          // engine_test
};

TEST(PlantedTable, HasAtLeastThreeProgramsForEachRule) {
    std::map<std::string_view, int> count;
    const std::vector<Planted> rows = table();
    for (const Planted& row : rows) ++count[row.rule];
    for (const core::RuleEntry& rule : core::rule_table())
        EXPECT_NE(count[rule.name] >= 3, tested_elsewhere.contains(rule.name)) << rule.name;
}

} // namespace
} // namespace app_test
