#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/usage.h"

namespace app_test {
namespace {

using test_support::Ran;
using test_support::ScopedFolder;
using test_support::Usage;
using test_support::usage_of;

constexpr int many = 300000;

/// A program of `count` feed moves, each with a block number.
std::string long_program(const ScopedFolder& folder, int count, const std::string& end = "M30\n") {
    const std::string path = folder / (std::to_string(count) + ".nc");
    std::ofstream file(path, std::ios::binary);
    file << "O1000\nG21 G90 G17 G54\nG0 X0 Y0 Z5.\nG1 F300.\n";
    for (int i = 0; i < count; ++i)
        file << 'N' << i + 1 << " G1 X" << i % 997 << ".125 Y" << i % 89 << ".5 Z-" << i % 7
             << ".\n";
    file << end;
    return path;
}

Usage trace(const std::string& program, const std::string& output) {
    return usage_of(
        {FEELER_BINARY, "trace", program, "--dialect", "fanuc", "--format", "jsonl", "-o", output},
        "/dev/null");
}

TEST(Streaming, NeedsNoMoreMemoryForALongProgram) {
    const ScopedFolder folder;
    const Usage shorter = trace(long_program(folder, 60000), folder / "short.jsonl");
    const Usage longer = trace(long_program(folder, many), folder / "long.jsonl");
    ASSERT_EQ(shorter.status, 0);
    ASSERT_EQ(longer.status, 0);
    EXPECT_LT(longer.kib, shorter.kib + 1024);
    const std::string text = test_support::bytes_of(folder / "long.jsonl");
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), many + 4)
        << "plane, offset, rapid and end in addition to the feeds";
    EXPECT_NE(text.find("\"text\":\"N300000 G1"), std::string::npos);
}

/// As stated in docs/manual/exit-status-and-limits.md.
TEST(Streaming, NeedsLittleMemoryForABlockOfACheckWithItsReport) {
    constexpr int few = 20000, more = 120000, bytes_per_block = 200;
    const ScopedFolder folder;
    const std::string setup = folder.write("s.toml", R"(
mesh_size = 2
program.dialect = "fanuc"
machine.rapid = "straight"
stock.box = [[0, 0, -20], [100, 20, 0]]
tool = [{ number = 1, shape = "flat", diameter = 10, flute_length = 30, stick_out = 50, holder = "BT40-ER32" }]
fixture = [{ name = "clamp", box = [[30, 30, -20], [70, 60, 10]] }]
)");
    // After 2,000 moves they cut nothing more, so only the record grows.
    const auto check = [&](int count) {
        std::string text = "O1000\nG21 G90 G17 G54\nT1 M6\nS3000 M3\nG0 G43 H1 Z5.\nG1 F300.\n";
        for (int i = 0; i < count; ++i)
            text += "G1 X" + std::to_string(i % 97) + ".125 Y" + std::to_string(i % 8) + ".5 Z-"
                    + std::to_string(i % 3) + ".\n";
        return usage_of({FEELER_BINARY, "check", folder.write("p.nc", text + "M30\n"), "--setup",
                         setup, "--format", "json", "-o", folder / "report.json"},
                        "/dev/null");
    };
    const Usage shorter = check(few), longer = check(more);
    ASSERT_LT(longer.status, 2);
    EXPECT_LT((longer.kib - shorter.kib) * 1024 / (more - few), bytes_per_block);
    const std::string text = test_support::bytes_of(folder / "report.json");
    EXPECT_NE(text.find("\"block\": 120000"), std::string::npos);
}

TEST(Streaming, WritesWhatCameBeforeAnError) {
    const ScopedFolder folder;
    const std::string program = long_program(folder, 60000, "G777\n");
    const Ran plain = feeler({"trace", program, "--dialect", "fanuc"});
    EXPECT_EQ(plain.status, 2);
    EXPECT_EQ(std::count(plain.out.begin(), plain.out.end(), '\n'), 60003);
    const std::string old = folder.write("old.txt", "old");
    const Ran kept = feeler({"trace", program, "--dialect", "fanuc", "-o", old});
    EXPECT_EQ(kept.status, 2);
    EXPECT_EQ(kept.out, plain.out);
    EXPECT_EQ(test_support::bytes_of(old), "old");
    EXPECT_EQ(folder.names().size(), 2u);
}

TEST(Streaming, StopsWhereALongFileTurnsIntoSomethingElse) {
    const ScopedFolder folder;
    const std::string program = long_program(folder, 60000, std::string("G1\0\n", 4));
    const Ran ran = feeler({"trace", program, "--dialect", "fanuc"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.out.find("1000: straight_feed"), std::string::npos);
    EXPECT_NE(ran.err.find(":60005: "), std::string::npos) << ran.err;
    EXPECT_NE(ran.err.find("NUL"), std::string::npos) << ran.err;
}

TEST(Streaming, GoesToAFileAsItGoesToStandardOutput) {
    const ScopedFolder folder;
    const std::string program = long_program(folder, 5000);
    const Ran out = feeler({"trace", program, "--dialect", "fanuc"});
    const Ran file = feeler({"trace", program, "--dialect", "fanuc", "-o", folder / "t.txt"});
    EXPECT_EQ(file.status, 0);
    EXPECT_EQ(file.out, "");
    EXPECT_EQ(test_support::bytes_of(folder / "t.txt"), out.out);
    EXPECT_EQ(feeler({"trace", program, "--dialect", "fanuc", "-o", "/dev/full"}).status, 2);
}

TEST(Streaming, SaysWhichDialectItTakesUnlessItIsGiven) {
    const ScopedFolder folder;
    const std::string program = long_program(folder, 3);
    const Ran seen = feeler({"trace", program});
    EXPECT_EQ(seen.err, "feeler: dialect fanuc, because line 1 is a program number (O1000)\n");
    EXPECT_EQ(feeler({"trace", program, "--dialect", "fanuc"}).err, "");
}

TEST(Streaming, SaysAWarningTenTimesAndThenCountsIt) {
    const ScopedFolder folder;
    std::string text = "G21 G90\nG0 X1.\n";
    for (int i = 0; i < 30; ++i) text += "M777\n";
    const Ran ran = feeler({"trace", folder.write("p.nc", text + "M30\n"), "--dialect", "fanuc"});
    EXPECT_EQ(ran.status, 0);
    size_t places = 0;
    for (size_t at = 0; (at = ran.err.find("M777", at)) != std::string::npos; ++at) ++places;
    EXPECT_EQ(places, 11u) << ran.err;
    EXPECT_NE(ran.err.find("20 more times: "), std::string::npos) << ran.err;
    EXPECT_NE(ran.err.find("p.nc:12:1: "), std::string::npos) << ran.err;
    EXPECT_EQ(ran.err.find("p.nc:13:1: "), std::string::npos) << ran.err;
}

} // namespace
} // namespace app_test
