#include <filesystem>

#include <gtest/gtest.h>

#include "app/commands/output.h"
#include "app/library/watch/watched_files.h"
#include "core/base/file_reads.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

/// A report that was written by the first pass of a watch but not by the next.
class PassOutputsTest : public testing::Test {
protected:
    void SetUp() override {
        outputs.begin_pass();
        ASSERT_TRUE(write_output(report, "clear\n"));
        outputs.end_pass(files);
        ASSERT_TRUE(is_there());
        outputs.begin_pass();
    }

    bool is_there() const { return std::filesystem::exists(report); }

    test_support::ScopedFolder folder;
    const std::string report = folder / "r.csv";
    WatchedFiles files{{report}};
    WatchOutputs outputs{{report}};
};

TEST_F(PassOutputsTest, RemoveReportsOfAnEarlierVersion) {
    outputs.end_pass(files);
    EXPECT_FALSE(is_there());
}

TEST_F(PassOutputsTest, LeaveWhatIsWrittenAnew) {
    ASSERT_TRUE(write_output(report, "clear\n"));
    outputs.end_pass(files);
    EXPECT_TRUE(is_there());
}

TEST_F(PassOutputsTest, LeaveFilesThatOthersHaveWritten) {
    folder.write("r.csv", "a list of mine\n");
    outputs.end_pass(files);
    outputs.begin_pass();
    outputs.end_pass(files);
    EXPECT_TRUE(is_there());
}

TEST_F(PassOutputsTest, LeaveWhatIsRead) {
    files.note({core::FileAccessKind::content, report, {}, {}});
    outputs.end_pass(files);
    EXPECT_TRUE(is_there());
}

} // namespace
} // namespace app
