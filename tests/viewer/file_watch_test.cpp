#include <fstream>

#include <gtest/gtest.h>

#include "app/view/model/file_watch.h"
#include "tests/support/scoped_folder.h"

namespace {

using app::viewer::FileWatch;

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
    watch.set({table, path_, "", table});
    EXPECT_FALSE(watch.has_changed());
    std::ofstream(table) << "T1 P1 D40.0";
    EXPECT_FALSE(watch.has_changed()) << "it may still be written";
    EXPECT_TRUE(watch.has_changed());
    write("G1 X1\nG1 X2\n");
    EXPECT_FALSE(watch.has_changed());
    watch.set({path_, table});
    EXPECT_TRUE(watch.has_changed()) << "a file that is known keeps its state";
    watch.set({path_});
    std::filesystem::remove(table);
    EXPECT_FALSE(watch.has_changed());
    EXPECT_FALSE(watch.has_changed());
    EXPECT_EQ(watch.missing(), "") << "it is not polled any more";
}

TEST_F(FileWatchTest, DoesNotReportWhatWasSaved) {
    FileWatch watch;
    watch.set({path_});
    write("G1 X1\nG1 X2\n");
    watch.take_as_known(path_);
    watch.take_as_known(path_ + ".none");
    EXPECT_FALSE(watch.has_changed());
    EXPECT_FALSE(watch.has_changed());
    write("G1 X1\n");
    EXPECT_FALSE(watch.has_changed());
    EXPECT_TRUE(watch.has_changed());
}

} // namespace
