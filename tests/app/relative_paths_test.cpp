#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/library/store/relative_paths.h"
#include "core/base/file_reads.h"
#include "tests/support/scoped_folder.h"

namespace {

namespace fs = std::filesystem;

using app::RelativePaths;
using test_support::ScopedFolder;

/// A library with links, with its database inside and files next to it.
class RelativePathsTest : public testing::Test {
protected:
    RelativePathsTest() {
        for (const char* name : {"lib/setups", "lib/sub/deep", "old/setups", "new/setups", "other"})
            fs::create_directories(folder / name);
        for (const char* name : {"lib/a.nc", "lib/setups/s.toml", "lib/sub/a.nc",
                                 "lib/sub/deep/a.nc", "old/s.toml", "new/s.toml", "other/a.nc"})
            folder.write(name, name);
        fs::create_directory_symlink("../old/setups", folder / "lib/current");
        fs::create_directory_symlink("lib", folder / "link");
        fs::create_symlink("../other/a.nc", folder / "lib/linked.nc");
    }

    ~RelativePathsTest() override { fs::current_path(before); }

    RelativePaths from(const std::string& working_folder, const std::string& database) const {
        fs::current_path(folder / working_folder);
        return RelativePaths(database);
    }

    const fs::path before = fs::current_path();
    const ScopedFolder folder;
};

TEST_F(RelativePathsTest, AreTheSameFromAnyWorkingFolder) {
    const std::string whole = folder / "lib/.feeler/r.db";
    EXPECT_EQ(from(".", "lib/.feeler/r.db").relative("lib/setups/s.toml"), "setups/s.toml");
    EXPECT_EQ(from("lib", ".feeler/r.db").relative("./setups//s.toml"), "setups/s.toml");
    EXPECT_EQ(from("lib", "./.feeler/r.db").relative("setups/s.toml"), "setups/s.toml");
    EXPECT_EQ(from("other", whole).relative(folder / "lib/setups/s.toml"), "setups/s.toml");
    EXPECT_EQ(from("lib/sub", "../.feeler/r.db").relative("../setups/s.toml"), "setups/s.toml");
    EXPECT_EQ(from(".", "link/.feeler/r.db").relative("link/setups/s.toml"), "setups/s.toml");
    EXPECT_EQ(from("lib", "r.db").relative("../other/a.nc"), "../other/a.nc");
    EXPECT_EQ(from(".", "lib/r.db").relative("other/a.nc"), "../other/a.nc");
    EXPECT_EQ(from("other", whole).relative(folder / "other/a.nc"), "../other/a.nc");
    EXPECT_EQ(from("lib", "r.db").relative("."), ".");
    EXPECT_EQ(from("lib", "r.db").relative("/"), "/");
    EXPECT_EQ(from("lib", "r.db").relative(""), "");
}

TEST_F(RelativePathsTest, DistinguishNamesOfOneFile) {
    const RelativePaths paths = from("lib", "r.db");
    EXPECT_EQ(paths.relative("linked.nc"), "linked.nc")
        << "subprograms are searched for next to the link";
    EXPECT_EQ(paths.absolute("linked.nc"), folder / "lib/linked.nc");
}

TEST_F(RelativePathsTest, LeadToTheSameFileAsThePathAfterALinkHasChanged) {
    const std::string place = from(".", "lib/r.db").relative("lib/current/../s.toml");
    const auto read = [&] {
        return test_support::bytes_of(from("lib/sub", "../r.db").absolute(place));
    };
    EXPECT_EQ(read(), "old/s.toml");
    fs::remove(folder / "lib/current");
    fs::create_directory_symlink("../new/setups", folder / "lib/current");
    EXPECT_EQ(read(), "new/s.toml");
}

TEST_F(RelativePathsTest, MoveWithTheFolder) {
    const std::string place = from(".", "lib/r.db").relative("lib/setups/s.toml");
    fs::rename(folder / "lib", folder / "moved");
    EXPECT_EQ(from(".", "moved/r.db").absolute(place), folder / "moved/setups/s.toml");
}

/// A path from any folder must lead to the file that the system opens for it.
TEST_F(RelativePathsTest, LeadToTheSameFileAsThePath) {
    const std::vector<std::string> folders = {".",           "lib",  "lib/sub",
                                              "lib/current", "link", "other"};
    const std::vector<std::string> parts = {"..",     "lib",     "sub",      "deep",
                                            "setups", "current", "link",     "other",
                                            "a.nc",   "s.toml",  "linked.nc"};
    std::mt19937 random(3);
    const auto any = [&](const std::vector<std::string>& of) { return of[random() % of.size()]; };
    size_t files = 0;
    for (int i = 0; i < 20'000; ++i) {
        const fs::path working = folder / any(folders);
        fs::current_path(working);
        std::string database = (any({folder.path(), ".", ".."}) + "/");
        for (size_t left = random() % 3; left > 0; --left) database += any(parts) + "/";
        if (!fs::is_directory(database)) continue;
        const RelativePaths paths(database + "r.db");
        std::string path = any({folder.path(), any(parts)});
        for (size_t left = random() % 5; left > 0; --left) path += "/" + any(parts);
        const std::string back = paths.absolute(paths.relative(path));
        EXPECT_TRUE(back.starts_with('/')) << back;
        ASSERT_EQ(fs::exists(path), fs::exists(back)) << working << " " << database << " " << path;
        if (!fs::exists(path)) continue;
        ASSERT_TRUE(fs::equivalent(path, back)) << working << " " << database << " " << path;
        const std::string real = fs::canonical(path);
        EXPECT_EQ(paths.absolute(paths.relative(real)), real);
        ++files;
    }
    EXPECT_GT(files, 1000u);
}

bool quotes(const std::string& text, const std::string& program = "lib/a.nc") {
    app::CheckJob job;
    job.program = program;
    app::ProgramResult result;
    result.assumptions = {text};
    return app::quotes_paths(result, job, {{core::FileAccessKind::presence, "x", "", {}}},
                             "/home/w");
}

TEST(QuotedPath, IsAWordOfATextOrPartOfAPathInIt) {
    EXPECT_TRUE(quotes("lib/a.nc is short"));
    EXPECT_TRUE(quotes("there is no sub.nc in lib."));
    EXPECT_TRUE(quotes("\"lib/b.ini\" has no X"));
    EXPECT_TRUE(quotes("see /home/w/c.tbl"));
    EXPECT_FALSE(quotes("calibrated, 3.5 mm/min in a library"));
    EXPECT_FALSE(quotes("It ends here. And here."));
    EXPECT_TRUE(quotes("there is none in . or above", "./a.nc"));
    EXPECT_FALSE(quotes("It ends here. And here.", "./b.nc"));
}

TEST(QuotedPath, IsNotTheNameOfTheProgramWhichIsPutBack) {
    app::CheckJob job;
    job.program = "lib/a.nc";
    app::ProgramResult result{.program = job.program};
    result.error = {"lib/a.nc", 3, 1, "G999: there is no such code"};
    EXPECT_FALSE(app::quotes_paths(result, job, {}, "/home/w"));
    app::CheckJob here;
    here.program = "a.nc";
    here.setup = "s.toml";
    const app::ProgramResult found = app::renamed(result, here);
    EXPECT_EQ(found.program, "a.nc");
    EXPECT_EQ(found.setup, "s.toml");
    EXPECT_EQ(found.error->file, "a.nc");
    result.error->file = "lib/sub.nc";
    EXPECT_TRUE(app::quotes_paths(result, job, {}, "/home/w"));
}

TEST_F(RelativePathsTest, HoldUntilTheWorkingFolderChanges) {
    const RelativePaths paths = from("old", "../lib/.feeler/results.db");
    EXPECT_TRUE(paths.are_still_valid());
    fs::rename(folder / "old", folder / "older");
    fs::create_directory(folder / "old");
    EXPECT_FALSE(paths.are_still_valid());
}

TEST_F(RelativePathsTest, AreThoseOfTheFileHoweverItIsSpelled) {
    EXPECT_EQ(from(".", "lib/.feeler/./results.db").relative("lib/a.nc"), "a.nc");
    EXPECT_EQ(from(".", "lib//.feeler/results.db").relative("lib/a.nc"), "a.nc");
}

TEST_F(RelativePathsTest, HoldUntilALinkToTheFolderIsChanged) {
    const RelativePaths paths = from(".", "link/.feeler/results.db");
    EXPECT_TRUE(paths.are_still_valid());
    fs::remove(folder / "link");
    fs::create_directory_symlink("new", folder / "link");
    EXPECT_FALSE(paths.are_still_valid());
}

} // namespace
