#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"
#include "tests/support/terminal.h"

namespace app_test {
namespace {

namespace fs = std::filesystem;
using test_support::bytes_of;
using test_support::program;
using test_support::ScopedFolder;
using test_support::SetupWriter;
using test_support::Terminal;
using testing::HasSubstr;
using testing::Not;

const std::string fine = program({"X-20. Y50.", "Z-3.", "G1 X120. F500.", "G0 Z60."});
const std::string near = program({"X-20. Y97.5", "Z-3.", "G1 X120. F500.", "G0 Z60."});

/// A user at a terminal who watches a folder of programs.
class Watch : public testing::Test {
protected:
    void SetUp() override {
        folder.write("plate.nc", fine);
        folder.write("plate.toml", setup("42"));
        std::this_thread::sleep_for(std::chrono::milliseconds(80)); // clock: at least
    }

    static std::string setup(const std::string& height) {
        return SetupWriter()
            .fixture("clamp", "box = [[40, 104, 0], [60, 130, " + height + "]]")
            .text();
    }

    Terminal watching(std::vector<std::string> words) const {
        words.insert(words.begin(), {FEELER_BINARY, "check", "--watch"});
        return Terminal(words, folder.path());
    }

    /// The output until everything is checked and nothing more happens.
    static std::string pass(Terminal& terminal) { return terminal.until("Ctrl-C ends it"); }

    static int end(Terminal& terminal) {
        terminal.type("\x03");
        return terminal.status();
    }

    ScopedFolder folder;
};

TEST_F(Watch, ChecksAProgramAgainThatWasSaved) {
    Terminal terminal = watching({folder / "plate.nc"});
    EXPECT_THAT(pass(terminal), HasSubstr("clear"));
    folder.write("plate.nc", near);
    const std::string seen = pass(terminal);
    EXPECT_THAT(seen, HasSubstr("plate.nc changed"));
    EXPECT_THAT(seen, HasSubstr("near-miss"));
    EXPECT_EQ(end(terminal), 1);
}

TEST_F(Watch, SeesASetupThatChangesGoesAndComes) {
    Terminal terminal = watching({folder / "plate.nc"});
    pass(terminal);
    folder.write("plate.toml", "[stock");
    EXPECT_THAT(pass(terminal), HasSubstr("plate.toml:1"));
    std::filesystem::remove(folder / "plate.toml");
    EXPECT_THAT(pass(terminal), HasSubstr("no set-up"));
    folder.write("plate.toml", setup("42"));
    EXPECT_THAT(pass(terminal), HasSubstr("because it is next to"));
    EXPECT_EQ(end(terminal), 0);
}

TEST_F(Watch, ContinuesWhileAProgramIsMissing) {
    Terminal terminal = watching({folder / "later.nc"});
    EXPECT_THAT(pass(terminal), HasSubstr("No such file"));
    folder.write("later.nc", fine);
    EXPECT_THAT(pass(terminal), HasSubstr("NO ERROR IN THE PROGRAM ITSELF"));
    EXPECT_EQ(end(terminal), 0);
}

TEST_F(Watch, SaysOnlyWhatWasCheckedAgainOfMany) {
    folder.write("other.nc", fine);
    folder.write("other.toml", setup("42"));
    const std::string report = folder / "report.jsonl";
    Terminal terminal = watching({folder.path(), "--no-cache", "--format", "jsonl", "-o", report});
    EXPECT_THAT(pass(terminal), HasSubstr("2 programs in"));
    folder.write("plate.nc", near);
    std::string seen = pass(terminal);
    EXPECT_THAT(seen, HasSubstr(folder / "plate.nc: 3 errors"));
    EXPECT_THAT(seen, Not(HasSubstr("other.nc:")));
    EXPECT_THAT(seen, HasSubstr("2 programs in"));
    EXPECT_THAT(bytes_of(report), HasSubstr("near-miss"));
    folder.write("third.nc", fine);
    seen = pass(terminal);
    EXPECT_THAT(seen, HasSubstr("third.nc"));
    EXPECT_THAT(seen, HasSubstr("3 programs in"));
    EXPECT_EQ(end(terminal), 1);
    EXPECT_FALSE(std::filesystem::exists(folder / ".feeler"));
}

TEST_F(Watch, SaysTheFolderOfWhatIsCalledAsAnother) {
    for (const std::string name : {"one", "two"}) {
        fs::create_directory(folder / name);
        folder.write(name + "/a.nc", fine);
        folder.write(name + "/a.toml", setup("42"));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(80)); // clock: at least
    Terminal terminal = watching({folder.path(), "--no-cache"});
    pass(terminal);
    terminal.while_stopped([&] {
        for (const std::string name : {"one", "two"}) folder.write(name + "/a.nc", near);
    });
    EXPECT_THAT(pass(terminal), HasSubstr(folder / "one/a.nc, " + folder / "two/a.nc changed"));
    EXPECT_EQ(end(terminal), 1);
}

TEST_F(Watch, SaysAgainWhatCameBack) {
    Terminal terminal = watching({folder.path(), "--cache", folder / "kept.db"});
    pass(terminal);
    for (int i = 0; i < 2; ++i) {
        folder.write("plate.nc", near);
        EXPECT_THAT(pass(terminal), HasSubstr(folder / "plate.nc: 3 errors")) << i;
        folder.write("plate.nc", fine);
        EXPECT_THAT(pass(terminal), HasSubstr(folder / "plate.nc\r\n")) << i;
    }
    EXPECT_EQ(end(terminal), 0);
}

TEST_F(Watch, SeesAChangedLinkAlsoWithStoredResults) {
    for (const std::string name : {"one", "two"}) {
        fs::create_directory(folder / name);
        folder.write(name + "/a.nc", name == "one" ? fine : near);
        folder.write(name + "/a.toml", setup("42"));
    }
    fs::create_directory_symlink("one", folder / "current");
    std::this_thread::sleep_for(std::chrono::milliseconds(80)); // clock: at least
    ASSERT_EQ(feeler({"check", folder / "current"}).status, 0);
    for (const std::string word : {"current", "current/a.nc"}) {
        Terminal terminal =
            watching({folder / word, "--cache", folder / "current/.feeler/results.db", "--jobs",
                      "1", folder / "one/a.nc"});
        pass(terminal);
        fs::create_directory_symlink("two", folder / "next");
        fs::rename(folder / "next", folder / "current");
        EXPECT_THAT(pass(terminal), HasSubstr("current/a.nc: 3 errors")) << word;
        EXPECT_EQ(end(terminal), 1);
        fs::remove(folder / "current");
        fs::create_directory_symlink("one", folder / "current");
    }
}

TEST_F(Watch, SaysInTheReportsThatTheProgramStopped) {
    Terminal terminal = watching({folder / "plate.nc", "--format", "html", "-o", folder / "r.html",
                                  "--format", "csv", "-o", folder / "r.csv"});
    pass(terminal);
    EXPECT_THAT(bytes_of(folder / "r.html"), HasSubstr("CLEAR"));
    EXPECT_THAT(bytes_of(folder / "r.csv"), HasSubstr("clear"));
    folder.write("plate.nc", program({"X-20. Y50.", "Z-3.", "G777"}));
    const std::string seen = pass(terminal);
    EXPECT_THAT(seen, HasSubstr("STOPPED")) << "the previous result instead of the rows";
    EXPECT_THAT(seen, Not(HasSubstr("<html"))) << "HTML does not go to the terminal";
    EXPECT_THAT(bytes_of(folder / "r.html"), HasSubstr("STOPPED"));
    EXPECT_THAT(bytes_of(folder / "r.html"), HasSubstr("G777"));
    EXPECT_THAT(seen, HasSubstr("r.csv: described an earlier version; deleted"));
    EXPECT_FALSE(fs::exists(folder / "r.csv"));
    folder.write("plate.nc", fine);
    pass(terminal);
    EXPECT_TRUE(fs::exists(folder / "r.csv"));
    EXPECT_EQ(end(terminal), 0);
}

TEST_F(Watch, RemovesReportsOfAnEarlierVersion) {
    const std::string report = folder.write("r.json", "of another day\n");
    const std::string project = folder.write("feeler.toml", "[rules]\nnone\n");
    folder.write("plate.toml", "[stock");
    for (const std::string word : {"plate.nc", "."}) {
        folder.write("r.json", "of another day\n");
        Terminal terminal =
            watching({folder / word, "--format", "json", "-o", report, "--no-cache"});
        pass(terminal);
        EXPECT_EQ(bytes_of(report), "of another day\n") << "the watch did not write it";
        terminal.while_stopped([&] {
            folder.write("plate.toml", setup("42"));
            folder.write("feeler.toml", "[[program]]\nfiles = \".\"\n");
        });
        pass(terminal);
        EXPECT_THAT(bytes_of(report), HasSubstr("clear")) << word;
        terminal.while_stopped([&] {
            folder.write("plate.toml", "[stock");
            folder.write("feeler.toml", "[rules]\nnone\n");
        });
        EXPECT_THAT(pass(terminal), HasSubstr("an earlier version; deleted"));
        EXPECT_FALSE(fs::exists(report)) << word;
        EXPECT_EQ(end(terminal), 2);
    }
}

TEST_F(Watch, SeesAFolderWhereNothingWas) {
    Terminal terminal = watching({folder / "later"});
    EXPECT_THAT(pass(terminal), HasSubstr("No such file"));
    fs::create_directory(folder / "new");
    folder.write("new/plate.nc", near);
    folder.write("new/plate.toml", setup("42"));
    fs::rename(folder / "new", folder / "later");
    EXPECT_THAT(pass(terminal), HasSubstr("later/plate.nc: 3 errors"));
    terminal.while_stopped([&] {
        fs::remove_all(folder / "later");
        folder.write("later", fine);
    });
    pass(terminal);
    EXPECT_EQ(end(terminal), 0);
}

TEST_F(Watch, WritesNothingToTheWorkingFolderWithNoCache) {
    fs::create_directory(folder / "here");
    const std::string home = fs::current_path();
    fs::current_path(folder / "here");
    Terminal terminal = watching({folder / "plate.nc", folder / "plate.nc", "--no-cache"});
    pass(terminal);
    EXPECT_EQ(end(terminal), 0);
    fs::current_path(home);
    EXPECT_TRUE(fs::is_empty(folder / "here"));
}

TEST_F(Watch, ContinuesWhileOthersWriteInTheFolder) {
    Terminal terminal = watching({folder.path(), "--no-cache"});
    pass(terminal);
    folder.write("plate.nc", near);
    std::atomic<bool> is_over = false;
    std::thread busy([&] {
        for (int i = 0; !is_over; ++i) {
            folder.write("note " + std::to_string(i), "");
            std::this_thread::sleep_for(std::chrono::milliseconds(100)); // clock: any pause
        }
    });
    EXPECT_THAT(terminal.until("3 errors"), HasSubstr("plate.nc"));
    is_over = true;
    busy.join();
}

TEST_F(Watch, DoesNotWakeUpBecauseOfItsOwnReports) {
    Terminal terminal = watching({folder.path(), "--cache", folder / "kept.db", "--format", "csv",
                                  "-o", folder / "report.txt"});
    pass(terminal);
    std::this_thread::sleep_for(std::chrono::milliseconds(1500)); // clock: nothing may happen
    EXPECT_EQ(terminal.seen_so_far().find("changed"), std::string::npos);
    EXPECT_EQ(end(terminal), 0);
}

} // namespace
} // namespace app_test
