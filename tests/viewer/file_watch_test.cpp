#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/view/model/file_watch.h"
#include "tests/support/scoped_folder.h"

namespace {

using app::viewer::files_of_setup;
using app::viewer::FileWatch;
using testing::EndsWith;
using testing::UnorderedElementsAre;

class FileWatchTest : public testing::Test {
protected:
    void SetUp() override { write("G1 X1\n"); }
    void write(const std::string& text) { std::ofstream(path_) << text; }

    const test_support::ScopedFolder folder_;
    const std::string path_ = folder_ / "watched.nc";
};

TEST_F(FileWatchTest, ReportsAChangeOnceAfterItHasSettled) {
    FileWatch watch;
    watch.set({path_, ""});
    EXPECT_FALSE(watch.has_changed());
    write("G1 X1\nG1 X2\n");
    EXPECT_FALSE(watch.has_changed()) << "it may still be written";
    EXPECT_TRUE(watch.has_changed());
    EXPECT_FALSE(watch.has_changed());
}

TEST_F(FileWatchTest, WaitsForAFileThatWasTakenAwayOrEmptied) {
    FileWatch watch;
    watch.set({path_});
    std::filesystem::remove(path_);
    EXPECT_FALSE(watch.has_changed());
    EXPECT_EQ(watch.missing(), "") << "an editor may be replacing it";
    EXPECT_FALSE(watch.has_changed());
    EXPECT_EQ(watch.missing(), path_);
    write("");
    EXPECT_FALSE(watch.has_changed());
    EXPECT_FALSE(watch.has_changed());
    EXPECT_EQ(watch.missing(), path_);
    write("G1 X3 Y5\n");
    EXPECT_FALSE(watch.has_changed());
    EXPECT_TRUE(watch.has_changed());
    EXPECT_EQ(watch.missing(), "");
}

TEST_F(FileWatchTest, IsNotHeldUpByAFileThatWasNeverThere) {
    FileWatch watch;
    watch.set({path_, path_ + ".none"});
    EXPECT_FALSE(watch.has_changed());
    EXPECT_EQ(watch.missing(), "");
    write("G1 X1\nG1 X2\n");
    EXPECT_FALSE(watch.has_changed());
    EXPECT_TRUE(watch.has_changed());
    std::ofstream(path_ + ".none") << "it comes";
    EXPECT_FALSE(watch.has_changed());
    EXPECT_TRUE(watch.has_changed());
}

TEST_F(FileWatchTest, TakesFilesOnThatACheckHasRead) {
    FileWatch watch;
    watch.set({path_});
    const std::string table = path_ + ".tbl";
    std::ofstream(table) << "T1 P1 D10";
    watch.add({table, path_, ""});
    EXPECT_FALSE(watch.has_changed());
    std::ofstream(table) << "T1 P1 D40.0";
    EXPECT_FALSE(watch.has_changed()) << "it may still be written";
    EXPECT_TRUE(watch.has_changed());
    write("G1 X1\nG1 X2\n");
    EXPECT_FALSE(watch.has_changed());
    watch.add({path_});
    EXPECT_TRUE(watch.has_changed()) << "a file that is known keeps its state";
    std::filesystem::remove(table);
}

TEST(FilesOfSetup, AreAllThatItAndItsMachineName) {
    const test_support::ScopedFolder folder;
    const std::string setup = folder.write(
        "feeler_watched.toml",
        "frame = \"G54\"\n[machine]\nfile = 'feeler_machine.toml'\n"
        "[[fixture]]\nmesh = \"a/clamp.stl\" # not \"b.nc\"\n[[[broken\nmesh = \"C.STL\"\n");
    folder.write("feeler_machine.toml", "mesh = \"table.obj\"\n");
    EXPECT_THAT(files_of_setup(setup),
                UnorderedElementsAre(EndsWith("feeler_watched.toml"),
                                     EndsWith("feeler_machine.toml"), EndsWith("a/clamp.stl"),
                                     EndsWith("C.STL"), EndsWith("table.obj")));
}

} // namespace
