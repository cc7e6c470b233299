#include <fstream>

#include <gtest/gtest.h>

#include "app/library/store/database.h"
#include "tests/app/checked.h"

namespace app_test {
namespace {

const std::string clear_program = "G21 G90 G54\nT1 M6\nG0 X0 Y0\nM30\n";

/// A folder with some programs.
void fill(const test_support::ScopedFolder& folder) {
    for (const std::string name : {"a.nc", "b.nc", "c d.nc"}) folder.write(name, clear_program);
}

bool says(const test_support::Ran& ran, const std::string& text) {
    return ran.out.find(text) != std::string::npos;
}

TEST(BatchCache, ChecksNothingTwice) {
    const test_support::ScopedFolder folder;
    fill(folder);
    const auto first =
        feeler({"check", folder.path().string(), "--format", "jsonl", "-o", folder / "1"});
    EXPECT_FALSE(says(first, "nothing has changed")) << first.out;
    EXPECT_TRUE(std::filesystem::exists(folder / ".feeler/results.db"));
    const auto second =
        feeler({"check", folder.path().string(), "--format", "jsonl", "-o", folder / "2"});
    EXPECT_TRUE(says(second, "3 of 3 results come from earlier checks")) << second.out;
    EXPECT_EQ(second.status, first.status);
    folder.write("b.nc", clear_program + "( changed )\n");
    const auto third = feeler({"check", folder.path().string()});
    EXPECT_TRUE(says(third, "2 of 3 results")) << third.out;
    const auto other = feeler({"check", folder.path().string(), "--mesh-size", "0.7"});
    EXPECT_FALSE(says(other, "nothing has changed")) << "another mesh size is another check";
    const auto history = feeler({"history", folder / "b.nc"});
    EXPECT_TRUE(says(history, "3 versions")) << history.out;
}

/// Two programs linked without a build-id that differ in one byte at the end.
TEST(BatchCache, IsThatOfOneBuildAlsoWithoutABuildId) {
    const test_support::ScopedFolder folder;
    std::filesystem::create_directory(folder / "parts");
    folder.write("parts/a.nc", clear_program);
    const std::string one = folder / "one", other = folder / "other";
    const auto made = test_support::run(
        {"objcopy", "--remove-section", ".note.gnu.build-id", FEELER_BINARY, one});
    ASSERT_EQ(made.status, 0) << made.err;
    std::filesystem::copy_file(one, other);
    std::ofstream(other, std::ios::app) << '\0';
    for (const std::string& build : {one, other}) {
        EXPECT_FALSE(says(test_support::run({build, "check", folder / "parts"}), "earlier"));
        EXPECT_TRUE(says(test_support::run({build, "check", folder / "parts"}), "1 of 1 results"));
    }
}

TEST(BatchCache, IsNotCreatedInTheFoldersOfAnInstallation) {
    const test_support::ScopedFolder folder;
    for (const char* part : {"bin", "share", "share/feeler", "share/feeler/programs", "mine"})
        std::filesystem::create_directory(folder / part);
    const std::string feeler = folder / "bin/feeler";
    std::filesystem::copy_file(FEELER_BINARY, feeler);
    for (const std::string programs : {"share/feeler/programs", "mine"}) {
        folder.write(programs + "/a.nc", clear_program);
        const auto ran = test_support::run({feeler, "check", folder / programs});
        EXPECT_EQ(ran.status, 0) << ran.err;
        EXPECT_EQ(std::filesystem::exists(folder / (programs + "/.feeler")), programs == "mine");
    }
}

TEST(BatchCache, IsNotCreatedWithNoCache) {
    const test_support::ScopedFolder folder;
    fill(folder);
    EXPECT_EQ(feeler({"check", folder.path().string(), "--no-cache"}).status, 0);
    EXPECT_EQ(feeler({"check", folder / "a.nc"}).status, 0);
    EXPECT_FALSE(std::filesystem::exists(folder / ".feeler"));
    const auto named = feeler({"check", folder.path().string(), "--cache", folder / "r.db"});
    EXPECT_EQ(named.status, 0) << named.err;
    EXPECT_TRUE(std::filesystem::exists(folder / "r.db"));
}

TEST(BatchCache, ReportsAnUnusableDatabaseAndContinues) {
    const test_support::ScopedFolder folder;
    fill(folder);
    const std::string wrong = folder.write("wrong.db", std::string(5000, 'x'));
    const auto ran = feeler({"check", folder.path().string(), "--cache", wrong});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_NE(ran.err.find("wrong.db"), std::string::npos) << ran.err;
    EXPECT_NE(ran.err.find("the check continues"), std::string::npos) << ran.err;
    EXPECT_TRUE(says(ran, "3 programs")) << ran.out;
}

TEST(BatchCache, ThatOthersHoldIsGivenUpOnceForARun) {
    const test_support::ScopedFolder folder;
    fill(folder);
    feeler({"check", folder.path().string()});
    auto other =
        app::Database::open(folder / ".feeler/results.db", app::Database::Access::read_write);
    ASSERT_TRUE(other && other->run("BEGIN EXCLUSIVE"));
    const auto ran = feeler({"check", folder.path().string(), "--jobs", "1"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_NE(ran.err.find("results.db: database is locked"), std::string::npos) << ran.err;
    EXPECT_EQ(ran.err.find("goes on"), ran.err.rfind("goes on")) << "reported once: " << ran.err;
    EXPECT_TRUE(says(ran, "3 programs")) << ran.out;
}

TEST(BatchCache, OfAShardIsSeparateAndReadByAllRuns) {
    const test_support::ScopedFolder folder;
    fill(folder);
    const auto check = [&](const std::string& share) {
        std::vector<std::string> words = {"check", folder.path().string()};
        if (!share.empty()) words.insert(words.end(), {"--shard", share});
        return feeler(words);
    };
    EXPECT_TRUE(says(check("1/2"), "shard 1/2: 2 of 3 programs"));
    EXPECT_TRUE(says(check("2/2"), "shard 2/2: 1 of 3 programs"));
    EXPECT_TRUE(std::filesystem::exists(folder / ".feeler/results-1of2.db"));
    EXPECT_TRUE(std::filesystem::exists(folder / ".feeler/results-2of2.db"));
    EXPECT_FALSE(std::filesystem::exists(folder / ".feeler/results.db"));
    EXPECT_TRUE(says(check("1/2"), "2 of 2 results come from earlier checks"));
    const std::string before = test_support::bytes_of(folder / ".feeler/results-1of2.db");
    EXPECT_TRUE(says(check("2/3"), "1 of 1 results come from earlier checks"));
    EXPECT_TRUE(says(check(""), "3 of 3 results come from earlier checks"));
    folder.write("b.nc", clear_program + "( changed, and so the largest )\n");
    EXPECT_TRUE(says(check(""), "2 of 3 results come from earlier checks"));
    EXPECT_EQ(test_support::bytes_of(folder / ".feeler/results-1of2.db"), before);
    EXPECT_TRUE(says(check("1/2"), "1 of 1 results come from earlier checks"));
    const auto history = feeler({"history", folder / "b.nc"});
    EXPECT_TRUE(says(history, "2 versions")) << history.out << history.err;
}

TEST(BatchCache, HistoryEndsWithTheCurrentProgramEvenIfAShardCheckedItBefore) {
    const test_support::ScopedFolder folder;
    fill(folder);
    const std::string parts = folder.path().string(), b = folder / "b.nc";
    const auto last_of_history = [&] {
        const std::string text = feeler({"history", b}).out;
        return text.substr(text.rfind("program ") + 8, 8);
    };
    feeler({"check", parts, "--shard", "1/2"});
    feeler({"check", parts, "--shard", "2/2"});
    const std::string first = last_of_history();
    folder.write("b.nc", clear_program + "( changed )\n");
    feeler({"check", parts});
    EXPECT_NE(last_of_history(), first);
    folder.write("b.nc", clear_program);
    EXPECT_TRUE(says(feeler({"check", parts}), "3 of 3 results come from earlier checks"));
    EXPECT_EQ(last_of_history(), first);
    EXPECT_TRUE(says(feeler({"history", b}), ": 2 versions"));
}

/// A library that is checked under three different paths.
class Library : public testing::Test {
protected:
    Library() {
        std::filesystem::create_directories(folder / "lib/setups");
        folder.write("lib/a.nc", clear_program);
        folder.write("lib/wrong.nc", "G999\n" + clear_program);
        folder.write("lib/setups/s.toml", test_support::SetupWriter().text());
        folder.write("lib/feeler.toml",
                     "[[program]]\nfiles = \"*.nc\"\nsetup = \"setups/s.toml\"\n");
    }

    test_support::Ran from(const std::string& working_folder,
                           std::vector<std::string> words) const {
        words.insert(words.begin(), "check");
        return feeler(words, "cd " + test_support::quoted(folder / working_folder) + ";");
    }

    const test_support::ScopedFolder folder;
};

TEST_F(Library, IsCheckedOnceFromAnyWorkingFolder) {
    from(".", {"lib", "--format", "jsonl", "-o", "1"});
    const auto inside = from("lib", {".", "--format", "jsonl"});
    EXPECT_NE(inside.err.find("2 of 2 results come from earlier"), std::string::npos) << inside.err;
    EXPECT_EQ(inside.out.find("lib/"), std::string::npos) << inside.out;
    EXPECT_NE(inside.out.find("\"setup\":\"setups/s.toml\""), std::string::npos) << inside.out;
    EXPECT_TRUE(says(from("lib/setups", {".."}), "2 of 2 results come from earlier"));
    const auto whole = from("/", {folder / "lib"});
    EXPECT_TRUE(says(whole, "2 of 2 results come from earlier")) << whole.out;
    EXPECT_TRUE(says(whole, folder / "lib/wrong.nc:1:1: G999")) << whole.out;
    EXPECT_TRUE(says(feeler({"history", folder / "lib/a.nc"}), ": 1 version\n"));
}

TEST_F(Library, NeverSpeaksOfPathsAsAnotherCallNamedThem) {
    folder.write("lib/control.ini", "[RS274NGC]\nPARAMETER_FILE = none.var\n");
    const auto outside =
        from(".", {"lib", "--ini", "lib/control.ini", "--format", "jsonl", "--verbose"});
    ASSERT_TRUE(says(outside, "lib/control.ini: lib/none.var does not exist")) << outside.out;
    const auto inside = from("lib", {".", "--ini", "control.ini", "--format", "jsonl"});
    EXPECT_TRUE(says(inside, "\"control.ini: none.var does not exist")) << inside.out;
    EXPECT_EQ(inside.out.find("lib/"), std::string::npos) << inside.out;
    const auto again = from("lib", {".", "--ini", "control.ini"});
    EXPECT_TRUE(says(again, "2 of 2 results come from earlier")) << again.out;
    const std::string history = feeler({"history", folder / "lib/a.nc"}).out;
    EXPECT_NE(history.find(": 1 version\n"), std::string::npos) << history;
}

TEST(BatchCache, IgnoresAnUnreadableDatabaseOfAShard) {
    const test_support::ScopedFolder folder;
    fill(folder);
    std::filesystem::create_directory(folder / ".feeler");
    folder.write(".feeler/results-1of2.db", std::string(5000, 'x'));
    const auto ran = feeler({"check", folder.path().string()});
    EXPECT_EQ(ran.status, 0);
    EXPECT_EQ(ran.err, "");
    EXPECT_TRUE(says(feeler({"check", folder.path().string()}), "3 of 3 results"));
}

} // namespace
} // namespace app_test
