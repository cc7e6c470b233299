#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

const std::filesystem::path source_dir = FEELER_SOURCE_DIR;
constexpr double clearance_tolerance = 0.02; // mm: searches may stop at different values
constexpr double removed_tolerance = 0.3;    // mm3, and
constexpr double removed_share = 0.01;       // of the volume, which scan lines sample

std::string rounded(const char* format, double value) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// One line for a moving block: line, motion, verdict, pair, clearance, removed.
std::string compact(const BlockLine& block) {
    const PairLine& pair = block.deciding;
    std::string text = std::to_string(block.line) + " " + block.motion + " " + block.verdict + " ";
    text += pair.name.empty() ? "- -" : pair.name;
    text += pair.upper ? rounded(" %.3f", *pair.upper) : " -";
    return text + rounded(" %.1f\n", block.removed);
}

std::string compact(const Checked& checked) {
    std::string text = "verdict " + checked.verdict + "\n";
    for (const FindingLine& finding : checked.findings) {
        text += "finding " + finding.severity + " " + finding.rule;
        if (finding.line)
            text += " " + std::to_string(*finding.line) + " "
                    + checked.at_line(*finding.line).deciding.name;
        text += "\n";
    }
    for (const BlockLine& block : checked.blocks)
        if (block.motion != "none") text += compact(block);
    return text;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::stringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    std::stringstream stream(line);
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

bool near_or_same(const std::string& a, const std::string& b, double tolerance) {
    if (a == "-" || b == "-") return a == b;
    return std::abs(std::stod(a) - std::stod(b)) <= tolerance;
}

/// Words must be equal; the two numbers at the end of a block's line may differ slightly.
bool agree(const std::string& a, const std::string& b) {
    if (a == b) return true;
    std::vector<std::string> left = words_of(a), right = words_of(b);
    if (left.size() != 7 || right.size() != 7) return false;
    if (!near_or_same(left[5], right[5], clearance_tolerance)) return false;
    const double removed = std::max(removed_tolerance, removed_share * std::stod(right[6]));
    if (!near_or_same(left[6], right[6], removed)) return false;
    left.resize(5);
    right.resize(5);
    return left == right;
}

/// On a difference, the new report is saved in the test's directory, to be checked and copied.
void expect_golden(const std::string& program, const std::string& name) {
    const Checked checked = check_files(source_dir / "assets/programs" / program,
                                        source_dir / "assets/setups" / (name + ".toml"));
    const std::string actual = compact(checked);
    const std::filesystem::path golden = source_dir / "tests/golden/check" / name / "expected.txt";
    const std::filesystem::path left = std::filesystem::path(testing::TempDir()) / (name + ".txt");
    std::ofstream(left, std::ios::binary) << actual;
    const std::vector<std::string> is = lines_of(actual);
    const std::vector<std::string> should = lines_of(test_support::bytes_of(golden));
    EXPECT_EQ(is.size(), should.size()) << golden << " and " << left;
    int differences = 0;
    for (size_t i = 0; i < std::min(is.size(), should.size()) && differences < 10; ++i) {
        if (agree(is[i], should[i])) continue;
        ++differences;
        ADD_FAILURE() << left << ":" << i + 1 << "\n  is        " << is[i] << "\n  should be "
                      << should[i];
    }
}

TEST(GoldenCheck, OfAFinishingProgramWithNothingWrongInIt) {
    expect_golden("PARALLEL.NC", "parallel");
}

TEST(GoldenCheck, OfAMillingProgramWithAStudThatIsTooLong) {
    expect_golden("TEST_G90.NC", "test_g90");
}

} // namespace
} // namespace app_test
