#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/view/model/file_watch.h"

namespace {

using app::viewer::files_of_setup;
using app::viewer::FileWatch;
using testing::EndsWith;
using testing::UnorderedElementsAre;

class FileWatchTest : public testing::Test {
protected:
    void SetUp() override { write("G1 X1\n"); }
    void TearDown() override { std::filesystem::remove(path_); }
    void write(const std::string& text) { std::ofstream(path_) << text; }

    std::string path_ = testing::TempDir() + "feeler_watched.nc";
};

TEST_F(FileWatchTest, TellsOfAChangeOnceAndWhenItRests) {
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
    std::filesystem::remove(path_ + ".none");
}

TEST(FilesOfSetup, AreAllThatItAndItsMachineName) {
    const std::string folder = testing::TempDir();
    std::ofstream(folder + "feeler_watched.toml")
        << "frame = \"G54\"\n[machine]\nfile = 'feeler_machine.toml'\n"
           "[[fixture]]\nmesh = \"a/clamp.stl\" # not \"b.nc\"\n[[[broken\nmesh = \"C.STL\"\n";
    std::ofstream(folder + "feeler_machine.toml") << "mesh = \"table.obj\"\n";
    EXPECT_THAT(files_of_setup(folder + "feeler_watched.toml"),
                UnorderedElementsAre(EndsWith("feeler_watched.toml"),
                                     EndsWith("feeler_machine.toml"), EndsWith("a/clamp.stl"),
                                     EndsWith("C.STL"), EndsWith("table.obj")));
    std::filesystem::remove(folder + "feeler_watched.toml");
    std::filesystem::remove(folder + "feeler_machine.toml");
}

} // namespace
