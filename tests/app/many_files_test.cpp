#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"
#include "tests/app/many_files.h"
#include "tests/support/usage.h"

namespace app_test {
namespace {

namespace fs = std::filesystem;
using many_files::all_files;
using many_files::fill;
using many_files::programs;
using many_files::resolved_path;
using test_support::bytes_of;
using test_support::ScopedFolder;
using test_support::Usage;
using test_support::usage_of;

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        if (line.find(part) != line.npos) lines.push_back(line);
    return lines;
}

/// The number of skipped files, from lines such as "skipped: 12 files, such as ...", or 1 per line.
size_t counted_in(const std::vector<std::string>& lines) {
    size_t count = 0;
    for (const std::string& line : lines)
        count += line.find(" files, such as ") == line.npos
                     ? 1
                     : std::stoul(line.substr(line.find("skipped: ") + 9));
    return count;
}

/// The paths of the reports of one run.
struct Reports {
    std::string rows, page, sarif, whole;
};

void expect_all_files(const Reports& reports, const std::string& folder) {
    EXPECT_EQ(lines_with(bytes_of(reports.rows), ".nc,").size(), programs);
    EXPECT_LT(fs::file_size(reports.page), 20'000'000U);
    EXPECT_LT(fs::file_size(reports.sarif), 10'000'000U) << "code hosts take no more";
    const auto json = nlohmann::json::parse(bytes_of(reports.whole));
    EXPECT_EQ(json["programs"].size(), programs);
    std::set<std::string> skipped;
    for (const auto& file : json["skipped"]) skipped.insert(file["file"]);
    EXPECT_EQ(skipped.size(), all_files - programs);
    EXPECT_TRUE(skipped.contains(folder + "/" + resolved_path(1003) + "/ü 1003.stl"));
}

// A single test, because writing so many files takes longer than checking them.
TEST(ManyFiles, AreReadOnceInLittleMemoryAndSkippedInAFewLines) {
    const ScopedFolder folder;
    const std::string shop = folder / "shop", out = folder / "out.txt";
    fill(shop);
    const Reports to{folder / "rows.csv", folder / "page.html", folder / "report.sarif",
                     folder / "whole.json"};
    const std::vector<std::string> check = {FEELER_BINARY, "check", shop, "--no-cache"};
    std::vector<std::string> words = check;
    words.insert(words.end(),
                 {"--format", "csv", "-o", to.rows, "--format", "html", "-o", to.page, "--format",
                  "sarif", "-o", to.sarif, "--format", "json", "-o", to.whole});
    const Usage usage = usage_of(words, out);
    EXPECT_EQ(usage.status, 0);
    if (usage.io) { // otherwise this kernel does not count
        EXPECT_LT(usage.io->reads, 3 * all_files);
        EXPECT_LT(usage.io->bytes, 100'000'000u);
        RecordProperty("reads", static_cast<int>(usage.io->reads));
    }
    EXPECT_LT(usage.kib, 600 * 1024);
    RecordProperty("mib", static_cast<int>(usage.kib / 1024));
    expect_all_files(to, shop);
    const std::string brief = bytes_of(out);
    EXPECT_EQ(lines_with(brief, "no error   ").size(), programs);
    EXPECT_LT(lines_with(brief, "skipped:").size(), 10U);
    EXPECT_EQ(counted_in(lines_with(brief, "skipped:")), all_files - programs);

    words = check;
    words.push_back("--verbose");
    EXPECT_EQ(usage_of(words, out).status, 0);
    EXPECT_EQ(lines_with(bytes_of(out), "skipped:").size(), all_files - programs);
}

} // namespace
} // namespace app_test
