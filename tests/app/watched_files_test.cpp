#include <optional>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "app/library/find/folder_walk.h"
#include "app/library/find/program_finder.h"
#include "app/library/watch/watched_files.h"
#include "gcode/language/program_folder.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

namespace fs = std::filesystem;
using test_support::ScopedFolder;

/// Waits until earlier writes no longer count as just written, and a new one gets another time
/// stamp.
// clock: at least
void let_it_rest() { std::this_thread::sleep_for(std::chrono::milliseconds(80)); }

class WatchedFilesTest : public testing::Test {
protected:
    void SetUp() override {
        folder.write("a.nc", "G0 X1\n");
        let_it_rest();
    }

    /// Records file accesses as a check does.
    template <typename Looks>
    void watch(Looks&& looks) {
        const core::FileAccessObserver listening(
            [this](const core::FileAccess& look) { files.note(look); });
        looks();
    }

    /// Stops the clock of the files: what is written from now on counts as just written.
    void stop_the_clock() { stopped = WatchTime::now(); } // clock: a start

    void advance_the_clock(std::chrono::milliseconds time) {
        stopped->of_day += time;
        stopped->steady += time;
    }

    std::vector<std::string> changed() {
        std::vector<std::string> names;
        for (const std::string& path : files.poll().paths)
            names.push_back(fs::path(path).filename());
        return names;
    }

    using Names = std::vector<std::string>;

    ScopedFolder folder;
    std::optional<WatchTime> stopped; // empty: the clock goes
    WatchedFiles files{{folder / "report.json"},
                       // clock: a start
                       [this] { return stopped ? *stopped : WatchTime::now(); }};
};

TEST_F(WatchedFilesTest, ReportAFileThatWasWrittenReplacedOrRemoved) {
    folder.write("b.nc", "G0 X2\n");
    folder.write("c.nc", "G0 X3\n");
    let_it_rest();
    watch([&] {
        for (const char* name : {"a.nc", "b.nc", "c.nc"}) core::file_bytes(folder / name);
    });
    EXPECT_EQ(changed(), Names{});
    folder.write("a.nc", "G0 X9\n"); // the same length as before
    fs::remove(folder / "b.nc");
    folder.write("new", "G0 X3\n"); // as editors save files
    fs::rename(folder / "new", folder / "c.nc");
    EXPECT_EQ(changed(), (Names{"a.nc", "b.nc", "c.nc"}));
}

TEST_F(WatchedFilesTest, ReportAMissingFileThatAppears) {
    watch([&] {
        core::is_file(folder / "plate.toml");
        gcode::file_in(folder.path(), "o1000.nc");
    });
    EXPECT_EQ(changed(), Names{});
    folder.write("plate.toml", "");
    EXPECT_EQ(changed(), Names{"plate.toml"});
    folder.write("o1000.nc", "");
    EXPECT_EQ(changed(), (Names{"o1000.nc", "plate.toml"}));
}

TEST_F(WatchedFilesTest, ReportNewNamesInAFolderAndBelow) {
    fs::create_directories(folder / "sub/deep");
    let_it_rest();
    watch([&] { walk_folder(folder.path()); });
    EXPECT_EQ(changed(), Names{});
    folder.write("sub/deep/x.nc", "");
    EXPECT_EQ(changed(), Names{"deep"});
    fs::remove(folder / "sub/deep/x.nc");
    EXPECT_EQ(changed(), Names{}) << "nothing has changed";
}

TEST_F(WatchedFilesTest, DoNotCountWhatTheCheckWritesItself) {
    watch([&] {
        walk_folder(folder.path());
        core::file_bytes(folder / "report.json");
    });
    folder.write("report.json", "{}");
    folder.write("report.json-journal", "");
    fs::create_directory(folder / ".feeler");
    EXPECT_EQ(changed(), Names{});
    folder.write("report2.json", "{}");
    EXPECT_EQ(changed(), Names{folder.path().filename()});
}

TEST_F(WatchedFilesTest, DoNotCountOutputThroughALinkThatWasDangling) {
    fs::create_symlink("new.json", folder / "latest");
    files.add_own(folder / "latest");
    const auto look = [&] {
        for (const char* name : {"latest", "new.json"}) core::is_there(folder / name);
    };
    watch(look);
    folder.write("new.json", "{}");
    EXPECT_EQ(changed(), Names{});
    watch(look);
    folder.write("new.json", "{ }");
    EXPECT_EQ(changed(), Names{});
}

TEST_F(WatchedFilesTest, KnowWhichOfTheChecksOwnFilesItReads) {
    const std::string report = folder.write("report.json", "{}");
    EXPECT_FALSE(files.reads(report));
    watch([&] { core::is_there(report); });
    EXPECT_FALSE(files.reads(report)) << "nothing in it was accessed";
    fs::create_symlink(report, folder / "link");
    watch([&] {
        core::notify_file_access({core::FileAccessKind::content, folder / "link", {}, {}});
    });
    EXPECT_TRUE(files.reads(report)) << "by another name";
    EXPECT_FALSE(files.reads(folder / "a.nc"));
    files.begin_again();
    EXPECT_FALSE(files.reads(report));
}

TEST_F(WatchedFilesTest, CountAFileWrittenWhileItWasRead) {
    stop_the_clock();
    folder.write("a.nc", "G0 X2\n");
    watch([&] { core::file_bytes(folder / "a.nc"); });
    EXPECT_EQ(changed(), Names{"a.nc"}) << "either version may have been read";
}

TEST_F(WatchedFilesTest, CountAFileReplacedWhileItWasRead) {
    stop_the_clock();
    folder.write("old.nc", "G0 X2\n");
    const auto now = fs::last_write_time(folder / "old.nc");
    fs::last_write_time(folder / "old.nc", now - std::chrono::hours(1));
    fs::rename(folder / "old.nc", folder / "a.nc");
    watch([&] { core::file_bytes(folder / "a.nc"); });
    EXPECT_EQ(changed(), Names{"a.nc"}) << "either version may have been read";
}

TEST_F(WatchedFilesTest, CountATimeToComeOnce) {
    stop_the_clock();
    const auto look = [&] { core::file_bytes(folder / "a.nc"); };
    const auto in_an_hour = fs::last_write_time(folder / "a.nc") + std::chrono::hours(1);
    for (const auto seconds : {0, 1}) {
        fs::last_write_time(folder / "a.nc", in_an_hour + std::chrono::seconds(seconds));
        files.begin_again();
        watch(look);
        EXPECT_EQ(changed(), Names{"a.nc"}) << "the time of writing is unknown";
        advance_the_clock(std::chrono::seconds(1));
        files.begin_again();
        watch(look);
        EXPECT_EQ(changed(), Names{});
    }
    folder.write("a.nc", "G0 X9\n");
    EXPECT_EQ(changed(), Names{"a.nc"});
}

TEST_F(WatchedFilesTest, AreNotSettledWhileAFileMayBeWrittenWithoutAnotherTime) {
    stop_the_clock();
    folder.write("a.nc", "G0 X2\n");
    const auto in_an_hour = fs::last_write_time(folder / "a.nc") + std::chrono::hours(1);
    fs::last_write_time(folder / "a.nc",
                        std::chrono::time_point_cast<std::chrono::seconds>(in_an_hour));
    watch([&] { core::file_bytes(folder / "a.nc"); });
    advance_the_clock(std::chrono::seconds(2));
    EXPECT_FALSE(files.poll().are_files_settled) << "its time stamps may have steps of 2 s";
    advance_the_clock(std::chrono::seconds(1));
    EXPECT_TRUE(files.poll().are_files_settled);
}

TEST_F(WatchedFilesTest, AreSettledAtOnceIfAFileThatWasJustWrittenIsWrittenAgain) {
    stop_the_clock();
    folder.write("a.nc", "G0 X2\n");
    watch([&] { core::file_bytes(folder / "a.nc"); });
    EXPECT_FALSE(files.poll().are_files_settled);
    folder.write("a.nc", "G0 X2\nG1 X5\n");
    files.poll();
    EXPECT_TRUE(files.poll().are_files_settled) << "what has changed is checked at once";
}

TEST_F(WatchedFilesTest, AreSettledOnceNothingMovesAnyMore) {
    watch([&] { core::file_bytes(folder / "a.nc"); });
    EXPECT_TRUE(files.poll().are_files_settled);
    folder.write("a.nc", "G0 X1\nG1");
    EXPECT_FALSE(files.poll().are_files_settled);
    folder.write("a.nc", "G0 X1\nG1 X5\n");
    EXPECT_FALSE(files.poll().are_files_settled);
    const WatchedFiles::Change change = files.poll();
    EXPECT_TRUE(change.are_files_settled);
    EXPECT_EQ(change.paths.size(), 1U);
}

TEST_F(WatchedFilesTest, SettleWhileOtherNamesComeAndGo) {
    watch([&] {
        walk_folder(folder.path());
        core::file_bytes(folder / "a.nc");
    });
    files.poll();
    folder.write("new.tmp", "");
    const WatchedFiles::Change change = files.poll();
    EXPECT_TRUE(change.are_files_settled);
    EXPECT_FALSE(change.are_names_settled);
}

TEST_F(WatchedFilesTest, CountTheReportsOfOthersOnlyWhenTheyBecomePrograms) {
    folder.write("report.txt", "all is well\n");
    let_it_rest();
    watch([&] { find_programs({folder.path()}); });
    folder.write("report.txt", "all is well, again\n");
    EXPECT_EQ(changed(), Names{});
    folder.write("report.txt", "G21 G90\nG0 X1\nM30\n");
    EXPECT_EQ(changed(), Names{"report.txt"});
}

TEST_F(WatchedFilesTest, SeeALinkToAFolderThatIsSwapped) {
    for (const char* name : {"one", "two"}) {
        fs::create_directory(folder / name);
        folder.write(std::string(name) + "/x.txt", "no program\n");
    }
    fs::create_directory_symlink("one", folder / "current");
    watch([&] { find_programs({folder / "current"}); });
    EXPECT_EQ(changed(), Names{});
    fs::remove(folder / "current");
    fs::create_directory_symlink("two", folder / "current");
    EXPECT_EQ(changed(), Names{"current"});
}

TEST_F(WatchedFilesTest, SeeLinksThatLedNowhereLeadToAFileOrAFolder) {
    fs::create_directory(folder / "parts");
    for (const char* name : {"file", "folder"})
        fs::create_symlink(folder / name, folder / ("parts/to-" + std::string(name)));
    for (const std::string word : {"parts", "parts/to-*", "*/to-file", "*/to-folder/x.nc"}) {
        WatchedFiles each;
        const core::FileAccessObserver listening(
            [&each](const core::FileAccess& look) { each.note(look); });
        find_programs({folder / word});
        EXPECT_TRUE(each.poll().paths.empty()) << word;
        fs::create_directory(folder / "folder");
        folder.write("file", "G0 X1\n");
        EXPECT_FALSE(each.poll().paths.empty()) << word;
        fs::remove(folder / "file");
        fs::remove(folder / "folder");
    }
}

TEST_F(WatchedFilesTest, SeeAFileThatReplacesAPipeOrAFolder) {
    const std::string pipe = folder / "b.nc";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    fs::create_directory(folder / "c.nc");
    watch([&] {
        find_programs({folder.path()});
        find_programs({folder / "?.nc"});
    });
    EXPECT_EQ(changed(), Names{});
    fs::remove(pipe);
    folder.write("b.nc", "G0 X2\n");
    EXPECT_EQ(changed(), Names{"b.nc"});
    fs::remove(folder / "c.nc");
    folder.write("c.nc", "G0 X3\n");
    EXPECT_EQ(changed(), (Names{"b.nc", "c.nc"}));
}

TEST_F(WatchedFilesTest, SeeALinkToAFolderThatWasEnteredByAnotherNameLeadElsewhere) {
    fs::create_directories(folder / "parts/one");
    fs::create_directory(folder / "two");
    fs::create_directory_symlink("one", folder / "parts/current");
    watch([&] { walk_folder(folder / "parts"); });
    EXPECT_EQ(changed(), Names{});
    fs::create_directory_symlink("../two", folder / "parts/next");
    fs::rename(folder / "parts/next", folder / "parts/current");
    EXPECT_EQ(changed(), Names{"current"});
}

TEST_F(WatchedFilesTest, SeeANewNameDespiteRestoredTimes) {
    watch([&] { walk_folder(folder.path()); });
    const auto time = fs::last_write_time(folder.path());
    folder.write("b.nc", "");
    fs::last_write_time(folder.path(), time);
    EXPECT_EQ(changed(), Names{folder.path().filename()});
}

TEST_F(WatchedFilesTest, NameAFileOnceHoweverItWasCalled) {
    fs::create_symlink("a.nc", folder / "link.nc");
    const std::string beside = (folder.path() / "." / "a.nc").string();
    const std::string relative = fs::relative(folder / "a.nc");
    watch([&] {
        for (const std::string& path : {folder / "a.nc", beside, relative, folder / "link.nc"})
            core::file_bytes(path);
    });
    folder.write("a.nc", "G0 X1\nG1 X5\n");
    EXPECT_EQ(changed(), Names{"a.nc"});
    fs::remove(folder / "a.nc");
    EXPECT_EQ(changed(), (Names{"a.nc", "link.nc"})) << "a dangling link is not a name of it";
}

TEST_F(WatchedFilesTest, KeepTheFirstOfSeveralAccesses) {
    watch([&] { core::file_bytes(folder / "a.nc"); });
    folder.write("a.nc", "G0 X1\nG1 X5\n");
    let_it_rest();
    watch([&] { core::file_bytes(folder / "a.nc"); });
    EXPECT_EQ(changed(), Names{"a.nc"});
}

} // namespace
} // namespace app
