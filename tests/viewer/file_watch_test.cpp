#include <fstream>

#include <gtest/gtest.h>

#include "app/viewer/file_watch.h"

namespace {

using app::viewer::FileWatch;

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
    EXPECT_FALSE(watch.has_changed());
    write("");
    EXPECT_FALSE(watch.has_changed());
    EXPECT_FALSE(watch.has_changed());
    write("G1 X3 Y5\n");
    EXPECT_FALSE(watch.has_changed());
    EXPECT_TRUE(watch.has_changed());
}

} // namespace
