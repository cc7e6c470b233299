#include <cstdio>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"
#include "tests/support/usage.h"

namespace app_test {
namespace {

namespace fs = std::filesystem;
using test_support::bytes_of;
using test_support::ScopedFolder;
using test_support::Usage;
using test_support::usage_of;

constexpr size_t all_files = 100'000, one_program_in = 20, folders = 1'000;
constexpr size_t programs = all_files / one_program_in;

/// What a shop keeps beside its programs.
struct Kind {
    const char* ending;
    std::string bytes;
};

const Kind foreign[] = {{".txt", "notes of the shop\nabout a part\n"},
                        {".stl", "solid part\n"},
                        {".md", "# What is here\n"},
                        {"", "a few words\n"},
                        {".png", "\x89PNG"},
                        {".dat", std::string("\0\1\2", 3)}};

/// The folder of the file with this number: three levels, names with blanks and UTF-8.
std::string place_of(size_t i) {
    const size_t at = i % folders;
    return "Auftrag " + std::to_string(at % 50) + "/Gehäuse " + std::to_string(at / 50) + "/日本 "
           + std::to_string(at);
}

void write(const fs::path& path, const std::string& bytes) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    ASSERT_NE(file, nullptr) << path;
    std::fwrite(bytes.data(), 1, bytes.size(), file);
    std::fclose(file);
}

/// A hundred thousand files, one of twenty a program.
void fill(const fs::path& root) {
    const std::string program =
        test_support::program({"X5. Y5.", "G1 Z-1. F200.", "X20.", "G0 Z60."});
    for (size_t i = 0; i < folders; ++i) fs::create_directories(root / place_of(i));
    for (size_t i = 0; i < all_files; ++i) {
        const bool is_program = i / folders % one_program_in == 0;
        const Kind& kind = foreign[i % std::size(foreign)];
        const std::string name = (is_program ? "part " : "ü ") + std::to_string(i);
        write(root / place_of(i) / (name + (is_program ? ".nc" : kind.ending)),
              is_program ? program : kind.bytes);
    }
}

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        if (line.find(part) != line.npos) lines.push_back(line);
    return lines;
}

/// The numbers of files in lines such as "skipped: 12 files, such as ...", and what has none.
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
    EXPECT_TRUE(skipped.contains(folder + "/" + place_of(1003) + "/ü 1003.stl"));
}

// One test, as it takes longer to write so many files than to check them.
TEST(ManyFiles, AreWalkedSoonInLittleMemoryAndSkippedInAFewLines) {
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
    EXPECT_LT(usage.cpu_seconds, 20.0);
    EXPECT_LT(usage.kib, 600 * 1024);
    RecordProperty("milliseconds", static_cast<int>(1e3 * usage.cpu_seconds));
    RecordProperty("mib", static_cast<int>(usage.kib / 1024));
    expect_all_files(to, shop);
    const std::string brief = bytes_of(out);
    EXPECT_EQ(lines_with(brief, "clear      ").size(), programs);
    EXPECT_LT(lines_with(brief, "skipped:").size(), 10U);
    EXPECT_EQ(counted_in(lines_with(brief, "skipped:")), all_files - programs);

    words = check;
    words.push_back("--verbose");
    EXPECT_EQ(usage_of(words, out).status, 0);
    EXPECT_EQ(lines_with(bytes_of(out), "skipped:").size(), all_files - programs);
}

} // namespace
} // namespace app_test
