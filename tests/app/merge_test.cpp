#include <regex>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "app/library/shard/shard.h"
#include "tests/app/checked.h"
#include "tests/support/program_writer.h"
#include "tests/support/signalled.h"

namespace app_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test_support::bytes_of;
using test_support::program;
using test_support::Ran;
using test_support::RunningProgram;
using test_support::ScopedFolder;
using test_support::SetupWriter;
using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

const Words formats = {"text", "json", "jsonl", "csv", "html", "junit", "sarif"};

std::string fine(const std::string& y = "50.") {
    return program({"X-20. Y" + y, "Z-3.", "G1 X120. F500.", "G0 Z60."});
}

/// A large program that never ends.
std::string long_program() {
    std::string text = fine().substr(0, fine().find("M30")) + "#1=0\nN10 #1=#1+0.001\n";
    for (int i = 0; i < 300'000; ++i)
        text += "G1 X" + std::to_string(i % 2 * 90 + 5) + ". Y" + std::to_string(i % 97) + ".\n";
    return text + "GOTO 10\nM30\n";
}

/// Removes run times, which differ between runs.
std::string without_seconds(std::string text) {
    text =
        std::regex_replace(text, std::regex("\"seconds\":(\\[[^\\]]*\\]|[^,]*)"), "\"seconds\":0");
    text = std::regex_replace(text, std::regex("time=\"[^\"]*\""), "time=\"0\"");
    // In CSV: before the error, the headline and what was not checked.
    text = std::regex_replace(text, std::regex(",[0-9.]+((,(\"([^\"]|\"\")*\"|[^\",\r]*)){3}\r\n)"),
                              ",0$1");
    text = std::regex_replace(text, std::regex(" in ([0-9]+ min )?[0-9.]+ s: "), " in 0 s: ");
    text = std::regex_replace(text, std::regex("(checking took[^0-9]*)[^,]*,"), "$1");
    return std::regex_replace(text, std::regex("  slowest .*\n"), "");
}

/// A folder with everything that can occur in a batch.
class Merge : public testing::Test {
protected:
    void SetUp() override {
        fs::create_directory(folder / "lib");
        write("fine.nc", fine());
        write("near.nc", fine("97.5") + "( a little longer )\n");
        write("a bad one.nc", program({"G999"}));
        write("no set-up.nc", fine());
        write("no set-up.toml", "nonsense = 1\n");
        write("part.stl", "solid part\nendsolid part\n");
        // Two names that read the same, one of which is not valid UTF-8.
        write("Geh\xe4use.nc", fine("40."));
        write("Gehäuse.nc", fine("45.5"));
        for (int i = 0; i < 6; ++i) write(std::to_string(i) + ".nc", fine(std::to_string(i) + "."));
        words = {folder / "lib",
                 folder / "none.nc",
                 folder / "\xff*.tap",
                 "--jobs",
                 "1",
                 "--setup",
                 folder.write(
                     "setup.toml",
                     SetupWriter().fixture("clamp", "box = [[40, 104, 0], [60, 130, 42]]").text())};
    }

    void write(const std::string& name, const std::string& bytes) const {
        folder.write("lib/" + name, bytes);
    }

    std::string share(int i) const { return folder / (std::to_string(i) + ".share"); }

    Ran check(const Words& more) const {
        Words all = {"check"};
        all.insert(all.end(), words.begin(), words.end());
        all.insert(all.end(), more.begin(), more.end());
        return feeler(all);
    }

    Words share_words(int i, int n, Words more) const {
        for (const std::string& word :
             {std::string("--shard"), std::to_string(i) + "/" + std::to_string(n),
              std::string("--format"), std::string("shard"), std::string("-o"), share(i)})
            more.push_back(word);
        return more;
    }

    Ran check_shard_option(int i, int n, const Words& more = {"--no-cache"}) const {
        return check(share_words(i, n, more));
    }

    /// Arguments for the first of two shards, which runs in parallel to the test.
    Words first_share() const {
        Words all = {FEELER_BINARY, "check"};
        const Words more = share_words(1, 2, {"--no-cache"});
        all.insert(all.end(), words.begin(), words.end());
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

    Ran merge(int n, Words more = {}) const {
        more.insert(more.begin(), "merge");
        for (int i = 1; i <= n; ++i) more.push_back(share(i));
        return feeler(more);
    }

    /// Options that write every format to a file of its own.
    Words to_files(const std::string& name) const {
        Words options;
        for (const std::string& format : formats)
            for (const std::string& word : {std::string("--format"), format, std::string("-o"),
                                            folder / (name + "." + format)})
                options.push_back(word);
        return options;
    }

    void expect_same_files(const std::string& a, const std::string& b) const {
        for (const std::string& format : formats) {
            const std::string text = without_seconds(bytes_of(folder / (a + "." + format)));
            EXPECT_EQ(text, without_seconds(bytes_of(folder / (b + "." + format)))) << format;
            EXPECT_THAT(text, HasSubstr("near.nc")) << format;
        }
    }

    ScopedFolder folder;
    Words words;
};

TEST_F(Merge, GivesWhatOneRunGives) {
    Words all = to_files("one");
    all.push_back("--no-cache");
    const Ran one = check(all);
    EXPECT_EQ(one.status, 2);
    size_t programs = 0;
    for (const int n : {1, 3, 20}) {
        for (int i = 1; i <= n; ++i) EXPECT_NE(check_shard_option(i, n).status, -1);
        const Ran merged = merge(n, to_files("merged"));
        EXPECT_EQ(merged.status, one.status);
        EXPECT_EQ(merged.err, one.err);
        EXPECT_EQ(without_seconds(merged.out), without_seconds(one.out)) << n;
        expect_same_files("merged", "one");
        programs = json::parse(bytes_of(folder / "merged.json"))["programs"].size();
    }
    EXPECT_EQ(programs, 14U);
    EXPECT_THAT(one.out, HasSubstr("skipped: " + folder / "lib/part.stl"));
}

/// Reused results have the run times of the run that made them.
TEST_F(Merge, GivesTheSameBytesWhereResultsAreFoundAgain) {
    const Words kept = {"--cache", folder / "results.db"};
    for (int i = 1; i <= 3; ++i) check_shard_option(i, 3, kept);
    Words all = to_files("one");
    all.insert(all.end(), kept.begin(), kept.end());
    check(all);
    merge(3, to_files("merged"));
    for (const std::string& format : formats)
        EXPECT_EQ(bytes_of(folder / ("merged." + format)), bytes_of(folder / ("one." + format)));
}

TEST_F(Merge, SaysLessOrMoreAsOneRunDoes) {
    for (int i = 1; i <= 2; ++i) check_shard_option(i, 2);
    for (const char* option : {"--quiet", "--verbose"})
        EXPECT_EQ(without_seconds(merge(2, {option}).out),
                  without_seconds(check({option, "--no-cache"}).out));
    const Ran rows = merge(2, {"--format", "csv"});
    EXPECT_THAT(rows.out, testing::StartsWith("program,setup,"));
    EXPECT_THAT(rows.err, HasSubstr("14 programs in "));
}

TEST_F(Merge, HasTheStatusOfAll) {
    words = {folder / "lib/fine.nc", folder / "lib/near.nc", "--setup", folder / "setup.toml"};
    EXPECT_EQ(check_shard_option(1, 2).status, 1) << "the larger one, which is near the clamp";
    EXPECT_EQ(check_shard_option(2, 2).status, 0);
    EXPECT_EQ(merge(2).status, 1);
    words.erase(words.begin() + 1);
    for (int i = 1; i <= 2; ++i)
        EXPECT_EQ(check_shard_option(i, 2).status, 0) << "the second is empty";
    EXPECT_EQ(merge(2).status, 0);
}

TEST_F(Merge, AShardReportsOnlyItsOwnPrograms) {
    const Ran ran = check({"--shard", "2/3", "--format", "jsonl", "--no-cache"});
    EXPECT_THAT(ran.err, HasSubstr("shard 2/3: 4 of 13 programs"));
    EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 5)
        << "four programs and the last record";
    const Ran empty = check({"--shard", "20/20", "--no-cache"});
    EXPECT_THAT(empty.out, HasSubstr("shard 20/20: 0 of 13 programs"));
}

TEST_F(Merge, NamesTheUncheckedProgramsOfAnInterruptedShard) {
    write("long.nc", long_program());
    RunningProgram running(first_share());
    EXPECT_TRUE(running.wait_until_it_catches(SIGINT));
    running.send(SIGINT);
    EXPECT_EQ(running.result().status, 2);
    check_shard_option(2, 2);
    const Ran merged =
        merge(2, {"--format", "json", "-o", folder / "merged.json", "--format", "text"});
    EXPECT_EQ(merged.status, 2);
    EXPECT_THAT(merged.out, HasSubstr("not checked: " + folder / "lib/long.nc"));
    EXPECT_THAT(merged.err, HasSubstr("1.share: shard 1/2 was interrupted: run it again"));
    const json report = json::parse(bytes_of(folder / "merged.json"));
    EXPECT_THAT(report["unchecked"], testing::Contains(folder / "lib/long.nc"));
    EXPECT_EQ(report["programs"].size() + report["unchecked"].size(), 15U);
}

TEST_F(Merge, FindsNoOldShardOfARunThatWasKilled) {
    for (int i = 1; i <= 2; ++i) check_shard_option(i, 2);
    write("long.nc", long_program());
    RunningProgram running(first_share());
    EXPECT_TRUE(running.wait_for([&] { return !fs::exists(share(1)); }));
    running.send(SIGKILL);
    EXPECT_EQ(running.result().status, 128 + SIGKILL);
    EXPECT_FALSE(fs::exists(share(1)));
    const Ran merged = merge(2);
    EXPECT_EQ(merged.status, 2);
    EXPECT_THAT(merged.err, HasSubstr("1.share: cannot be read: No such file"));
    EXPECT_THAT(feeler({"merge", share(2)}).err, HasSubstr("a shard is missing: 1/2"));
}

TEST_F(Merge, FindsNoOldShardOfAComputerThatSawNoPrograms) {
    for (int i = 1; i <= 2; ++i) check_shard_option(i, 2);
    fs::rename(folder / "lib", folder / "not mounted");
    fs::create_directory(folder / "lib");
    const Ran ran =
        feeler({"check", folder / "lib", "--shard", "1/2", "--format", "shard", "-o", share(1)});
    EXPECT_EQ(ran.status, 2);
    EXPECT_FALSE(fs::exists(share(1)));
}

TEST_F(Merge, FindsNoOldShardOfARunThatCannotBegin) {
    for (const Words& more :
         {Words{"--search-path", folder / "not mounted"}, Words{"--blocks", "1-2"}}) {
        check_shard_option(1, 2);
        ASSERT_TRUE(fs::exists(share(1)));
        EXPECT_EQ(check_shard_option(1, 2, more).status, 2) << more[0];
        EXPECT_FALSE(fs::exists(share(1))) << more[0];
    }
}

TEST_F(Merge, FindsNoOldShardThroughALink) {
    fs::create_directory(folder / "far");
    fs::create_symlink("far/1.share", share(1));
    check_shard_option(1, 2);
    ASSERT_TRUE(fs::exists(folder / "far/1.share"));
    EXPECT_EQ(check_shard_option(1, 2, {"--search-path", folder / "not mounted"}).status, 2);
    EXPECT_FALSE(fs::exists(folder / "far/1.share"));
    check_shard_option(1, 2);
    EXPECT_TRUE(fs::is_symlink(share(1)));
    EXPECT_TRUE(fs::exists(folder / "far/1.share"));
}

TEST_F(Merge, WritesItsFilesWhenThePipeIsClosed) {
    for (int i = 1; i <= 2; ++i) check_shard_option(i, 2);
    const std::string all = folder / "all.json";
    // The reader of the pipe ends before the program starts.
    const Ran ran = test_support::run(
        {"bash", "-c", "mkfifo \"$0\"; (: <\"$0\") & exec 4>\"$0\"; wait; \"$@\" >&4",
         folder / "pipe", FEELER_BINARY, "merge", "--format", "json", "-o", all, "--format", "text",
         share(1), share(2)});
    EXPECT_EQ(ran.status, 2);
    EXPECT_TRUE(fs::exists(all));
}

TEST_F(Merge, LeavesAFileThatIsNotAShardUntilItIsReplaced) {
    folder.write("notes", "mine\n");
    fs::create_directory(folder / "empty");
    EXPECT_EQ(feeler({"check", folder / "empty", "--shard", "1/2", "--format", "shard", "-o",
                      folder / "notes"})
                  .status,
              2);
    EXPECT_EQ(bytes_of(folder / "notes"), "mine\n");
    EXPECT_LE(feeler({"check", folder / "lib", "--shard", "1/2", "--format", "shard", "-o",
                      folder / "notes"})
                  .status,
              2);
    EXPECT_THAT(bytes_of(folder / "notes"), HasSubstr("feeler_shard"));
}

TEST_F(Merge, RefusesShardsWithOtherOptions) {
    check_shard_option(1, 2);
    for (const Words& more : std::vector<Words>{{"--allowance", "2.5"},
                                                {"--engine", "coprocessor"},
                                                {"--mesh-size", "0.7"},
                                                {"--verdict-only"},
                                                {"--dialect", "haas"},
                                                {"--start-position", "X=-1"},
                                                {"--block-delete", "on"},
                                                {"--max-blocks", "9"},
                                                {"--no-decimal-point", "steps"},
                                                {"--machine-unit", "inch"},
                                                {"--search-path", folder.path()},
                                                {"--memory-limit", "100"}}) {
        Words all = more;
        all.push_back("--no-cache");
        check_shard_option(2, 2, all);
        const Ran merged = merge(2);
        EXPECT_EQ(merged.status, 2) << more[0];
        EXPECT_EQ(merged.out, "") << more[0];
        EXPECT_THAT(merged.err, HasSubstr("different options or a different set-up")) << more[0];
    }
    check_shard_option(2, 2);
    EXPECT_THAT(merge(2).err, "");
}

TEST_F(Merge, RefusesShardsOfOtherStatesOfTheLibrary) {
    const auto why = [&](auto change) {
        check_shard_option(1, 2);
        change();
        check_shard_option(2, 2);
        const Ran merged = merge(2, {"--format", "json", "-o", folder / "all.json"});
        EXPECT_EQ(merged.status, 2);
        EXPECT_FALSE(fs::exists(folder / "all.json"));
        return merged.err;
    };
    EXPECT_THAT(why([&] { write("0.nc", fine() + "( changed )\n"); }),
                HasSubstr("lib/0.nc has a different size there"));
    EXPECT_THAT(why([&] { write("new.nc", fine()); }),
                HasSubstr("it contains " + folder / "lib/new.nc"));
    EXPECT_THAT(why([&] { fs::remove(folder / "lib/1.nc"); }),
                HasSubstr("it does not contain " + folder / "lib/1.nc"));
    EXPECT_THAT(why([&] { std::ofstream(folder / "setup.toml", std::ios::app) << "# moved\n"; }),
                HasSubstr("a different set-up"));
    words.insert(words.end(), {"--tool-table", folder.write("tool.tbl", "T1 P1 D10\n")});
    EXPECT_THAT(why([&] { folder.write("tool.tbl", "T1 P1 D11\n"); }),
                HasSubstr("a different set-up"));
    words.insert(words.end(), {"--parameters", folder.write("variables", "5220\t1\n")});
    EXPECT_THAT(why([&] { folder.write("variables", "5220\t1\n5221\t0\n"); }),
                HasSubstr("a different set-up"));
    words.insert(words.end(), {"--ini", folder.write("mill.ini", "[TRAJ]\nCOORDINATES = XYZ\n")});
    EXPECT_THAT(why([&] { folder.write("mill.ini", "[TRAJ]\nCOORDINATES = X Y Z\n"); }),
                HasSubstr("a different set-up"));
    EXPECT_THAT(why([&] { words.push_back(folder / "nothing*.nc"); }),
                HasSubstr("different files were missing"));
}

TEST_F(Merge, RefusesFilesThatAreNotShardsOfTheBatch) {
    for (int i = 1; i <= 2; ++i) check_shard_option(i, 2);
    const auto why = [&](Words files) {
        files.insert(files.begin(), "merge");
        const Ran ran = feeler(files);
        EXPECT_EQ(ran.status, 2);
        EXPECT_EQ(ran.out, "");
        return ran.err;
    };
    const std::string whole = bytes_of(share(2));
    EXPECT_THAT(why({share(1), share(1), share(2)}), HasSubstr("is shard 1/2, and so is"));
    EXPECT_THAT(why({share(1), folder.write("cut", whole.substr(0, whole.size() / 2))}),
                HasSubstr("cut: is a shard of a batch that was truncated"));
    EXPECT_THAT(why({share(1), folder / "lib/fine.nc"}), HasSubstr("fine.nc: is not a shard"));
    EXPECT_THAT(why({share(1), folder / "lib"}), HasSubstr("lib: cannot be read"));
    EXPECT_THAT(why({share(1), folder.write("new", "{\"feeler_shard\": 2}")}),
                HasSubstr("new: was written by a newer version"));
    std::string foreign = whole;
    foreign.replace(foreign.find("\"version\": \"") + 12, 1, "9");
    EXPECT_THAT(why({share(1), folder.write("foreign", foreign)}),
                HasSubstr("foreign: is a shard of a batch that was truncated or changed"));
    foreign = app::sealed(foreign.substr(0, foreign.rfind(",\n\"seal\"")));
    EXPECT_THAT(why({share(1), folder.write("foreign", foreign)}),
                HasSubstr("was written by feeler 9"));
}

TEST_F(Merge, NeverOverwritesAShardThatItReads) {
    for (int i = 1; i <= 2; ++i) check_shard_option(i, 2);
    const std::string before = bytes_of(share(2));
    const Ran ran = merge(2, {"--format", "json", "-o", share(2)});
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.err, HasSubstr("2.share: is an input and would be overwritten"));
    EXPECT_EQ(bytes_of(share(2)), before);
}

TEST_F(Merge, NeverOverwritesFilesThatItsShardsHaveRead) {
    for (int i = 1; i <= 2; ++i) check_shard_option(i, 2);
    for (const char* name :
         {"lib/fine.nc", "lib/a bad one.nc", "lib/Geh\xe4use.nc", "setup.toml"}) {
        const std::string before = bytes_of(folder / name);
        const Ran ran = merge(2, {"--format", "csv", "-o", folder / name});
        EXPECT_EQ(ran.status, 2) << name;
        EXPECT_EQ(ran.out, "") << name;
        EXPECT_THAT(ran.err, HasSubstr(": is an input and would be overwritten")) << name;
        EXPECT_EQ(bytes_of(folder / name), before) << name;
    }
}

TEST_F(Merge, TakesAsLongAsItsShardsTogether) {
    words = {folder / "lib/fine.nc", folder / "lib/near.nc", "--setup", folder / "setup.toml"};
    for (int i = 1; i <= 2; ++i) {
        check_shard_option(i, 2);
        std::string text = bytes_of(share(i));
        text.resize(text.rfind(",\n\"seal\""));
        const std::string seconds = i == 1 ? "\"seconds\": 20.25," : "\"seconds\": 10.5,";
        text = std::regex_replace(text, std::regex("\"seconds\": [^,]*,"), seconds);
        folder.write(std::to_string(i) + ".share", app::sealed(text));
    }
    EXPECT_THAT(merge(2).out, HasSubstr("2 programs in 30.8 s"));
}

TEST_F(Merge, RefusesAnInvalidShardNumber) {
    for (const char* name : {"3/2", "0/2", "2", "1/0", "1/99999999999", "x"}) {
        const Ran ran = check({"--shard", name, "--no-cache"});
        EXPECT_EQ(ran.status, 2) << name;
        EXPECT_THAT(ran.err, HasSubstr("is not a shard")) << name;
    }
    const Ran ran = check({"--format", "shard", "-o", share(1)});
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.err, HasSubstr("--shard I/N"));
    EXPECT_FALSE(fs::exists(share(1)));
}

} // namespace
} // namespace app_test
