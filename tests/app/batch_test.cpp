#include <algorithm>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"
#include "tests/support/signalled.h"
#include "tests/support/terminal.h"

namespace app_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test_support::bytes_of;
using test_support::program;
using test_support::Ran;
using test_support::ScopedFolder;
using test_support::SetupWriter;
using testing::HasSubstr;
using testing::Not;

const std::string fine = program({"X-20. Y50.", "Z-3.", "G1 X120. F500.", "G0 Z60."});
const std::string near = program({"X-20. Y97.5", "Z-3.", "G1 X120. F500.", "G0 Z60."});

/// A large program that never ends.
std::string long_program() {
    std::string text = fine.substr(0, fine.find("M30")) + "#1=0\nN10 #1=#1+0.001\n";
    for (int i = 0; i < 300'000; ++i)
        text += "G1 X" + std::to_string(i % 2 * 90 + 5) + ". Y" + std::to_string(i % 97) + ".\n";
    return text + "GOTO 10\nM30\n";
}

/// A folder of programs with set-ups next to them.
class Batch : public testing::Test {
protected:
    void SetUp() override {
        const std::string setup =
            SetupWriter().fixture("clamp", "box = [[40, 104, 0], [60, 130, 42]]").text();
        for (const char* name : {"fine", "near", "Gehäuse links"}) {
            folder.write(std::string(name) + ".nc", name == std::string("near") ? near : fine);
            folder.write(std::string(name) + ".toml", setup);
        }
    }

    Ran check(std::vector<std::string> words, const std::string& before = "") const {
        words.insert(words.begin(), "check");
        return feeler(words, before);
    }

    std::string all() const { return folder.path(); }

    ScopedFolder folder;
};

TEST_F(Batch, ChecksAFolderWithASetupNextToEachProgram) {
    const Ran ran = check({all()});
    EXPECT_EQ(ran.status, 1) << ran.err;
    EXPECT_EQ(ran.err, "");
    EXPECT_THAT(ran.out, HasSubstr("violation  " + folder / "near.nc"));
    EXPECT_THAT(ran.out, HasSubstr("clear      " + folder / "Gehäuse links.nc"));
    EXPECT_THAT(ran.out, HasSubstr("3 programs in "));
    EXPECT_THAT(ran.out, Not(HasSubstr("\033")));
    EXPECT_EQ(check({folder / "fine.nc", folder / "Gehäuse links.nc"}).status, 0);
}

TEST_F(Batch, SaysThatItFoundTheSetup) {
    EXPECT_THAT(check({all(), "--verbose"}).out, HasSubstr("because it is next to the"));
    EXPECT_THAT(check({folder / "near.nc", "--format", "json"}).out,
                HasSubstr("because it is next to the program"));
}

TEST_F(Batch, ContinuesAfterABadProgramAndEndsWithTwo) {
    folder.write("a bad one.nc", program({"G999"}));
    const Ran ran = check({all(), folder / "none.nc", folder / "*.tap", "-j", "2"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.out, HasSubstr("violation  " + folder / "near.nc"));
    EXPECT_THAT(ran.out, HasSubstr("6 programs in "));
    EXPECT_THAT(ran.out, HasSubstr("a bad one.nc:6"));
    EXPECT_THAT(ran.out, HasSubstr("none.nc"));
    EXPECT_THAT(ran.out, HasSubstr("*.tap: matches no file"));
}

TEST_F(Batch, ReportsAFolderWithoutPrograms) {
    fs::create_directory(folder / "empty");
    const Ran alone = check({folder / "empty"});
    EXPECT_EQ(alone.status, 2);
    EXPECT_THAT(alone.err, HasSubstr("empty: contains no NC program"));
    const Ran beside = check({folder / "empty", folder / "fine.nc"});
    EXPECT_EQ(beside.status, 2);
    EXPECT_THAT(beside.out, HasSubstr("empty: contains no NC program"));
    EXPECT_THAT(beside.out, HasSubstr("clear      " + folder / "fine.nc"));
}

TEST_F(Batch, ReportsAFileThatCannotBeRead) {
    if (::geteuid() == 0) GTEST_SKIP() << "root can read every file";
    fs::permissions(folder / "fine.nc", fs::perms::none);
    const Ran ran = check({all()});
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.out, HasSubstr("ermission"));
    EXPECT_THAT(ran.out, HasSubstr("violation  " + folder / "near.nc"));
}

TEST_F(Batch, ReadsOneProgramFromAPipeAndNothingElse) {
    const std::string pipe = folder / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    // clock: ends a copy that hangs
    const std::string piped = "timeout 120 dd status=none if='" + folder / "near.nc" + "' of='"
                              + pipe + "' & timeout 120"; // clock: gives up after 2 min
    const Ran alone = check({pipe, "--setup", folder / "near.toml", "--format", "json"}, piped);
    EXPECT_EQ(alone.status, 1) << alone.err;
    const Ran by_name = check({folder / "near.nc", "--format", "json"});
    EXPECT_EQ(json::parse(alone.out)["sha256"], json::parse(by_name.out)["sha256"]);
    // clock: gives up after 2 min
    const Ran beside = check({folder / "fine.nc", "/dev/zero"}, "timeout 120");
    EXPECT_EQ(beside.status, 2);
    EXPECT_THAT(beside.out, HasSubstr("is a pipe or a device"));
    EXPECT_THAT(beside.out, HasSubstr("clear      " + folder / "fine.nc"));
    for (const char* option : {"--setup", "--tool-table", "--parameters"}) {
        // clock: gives up after 2 min
        const Ran ran = check({folder / "fine.nc", option, "/dev/zero"}, "timeout 120");
        EXPECT_EQ(ran.status, 2) << option;
        EXPECT_THAT(ran.err, HasSubstr("/dev/zero: is a pipe or a device, not a file")) << option;
    }
}

TEST_F(Batch, ReadsAProjectInAFolder) {
    folder.write("feeler.toml",
                 "[rules]\nnear-miss = \"note\"\n[[program]]\nfiles = \"near.nc\"\n");
    const Ran ran = check({all(), "--format", "jsonl"});
    EXPECT_EQ(ran.status, 0) << ran.out;
    EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 1);
    folder.write("feeler.toml", "[[program]]\nfile = \"near.nc\"\n");
    const Ran wrong = check({all()});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("feeler.toml:2:1: [[program]] 1: "));
    EXPECT_EQ(wrong.out, "");
}

TEST_F(Batch, SaysThatAProjectAboveDoesNotApplyToANamedProgram) {
    folder.write("feeler.toml", "[[program]]\nfiles = \"*.nc\"\n");
    fs::create_directory(folder / "sub");
    for (const std::string name : {"new.nc", "sub/new.nc"}) {
        folder.write(name, near);
        EXPECT_THAT(check({folder / name}).err,
                    HasSubstr("feeler.toml does not apply to a program that is named directly"));
        EXPECT_THAT(check({folder / name, "--setup", folder / "near.toml"}).err,
                    Not(HasSubstr("feeler.toml")));
    }
    EXPECT_THAT(check({folder / "near.nc"}).err, Not(HasSubstr("does not apply"))); // own set-up
    EXPECT_THAT(check({all()}).err, Not(HasSubstr("does not apply")));
}

TEST_F(Batch, WritesEachFormatToItsFile) {
    const Ran ran =
        check({all(), "--format", "sarif", "-o", folder / "a.sarif", "--format", "junit", "-o",
               folder / "b.xml", "--format", "json", "-o", folder / "c.json", "--format", "csv"});
    EXPECT_EQ(ran.status, 1) << ran.err;
    EXPECT_EQ(json::parse(bytes_of(folder / "a.sarif"))["version"], "2.1.0");
    EXPECT_THAT(bytes_of(folder / "b.xml"), HasSubstr("<testsuites"));
    EXPECT_EQ(json::parse(bytes_of(folder / "c.json"))["programs"].size(), 3U);
    EXPECT_THAT(ran.out, testing::StartsWith("program,setup,"));
    EXPECT_THAT(ran.err, HasSubstr("3 programs in ")) << "lines for people give way to the rows";
}

TEST_F(Batch, RefusesFormatsAndFilesThatDoNotPairUp) {
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"-o", folder / "a", "-o", folder / "b"},
             {"--format", "json", "--format", "csv"},
             {"--format", "json", "-o", folder / "a", "--format", "csv", "-o", folder / "a"},
             {"--save-stock", folder / "stock.stl"},
             {"--blocks"},
             {"-o", folder / "near.nc"},
             {"-o", folder / "near.toml"}}) {
        std::vector<std::string> all_words = {all()};
        all_words.insert(all_words.end(), words.begin(), words.end());
        const Ran ran = check(all_words);
        EXPECT_EQ(ran.status, 2) << words[0];
        EXPECT_EQ(ran.out, "") << words[0];
        EXPECT_NE(ran.err, "") << words[0];
    }
    EXPECT_EQ(bytes_of(folder / "near.nc"), near);
}

TEST_F(Batch, WritesSarifAndJunitOfOneProgram) {
    const Ran ran = check({folder / "near.nc", "--format", "text", "--format", "sarif"});
    EXPECT_EQ(ran.status, 2) << "two to standard output";
    EXPECT_EQ(check({folder / "near.nc", "--format", "sarif", "-o", folder / "one.sarif",
                     "--format", "junit", "-o", folder / "one.xml"})
                  .status,
              1);
    const json results = json::parse(bytes_of(folder / "one.sarif"))["runs"][0]["results"];
    EXPECT_EQ(results[0]["ruleId"], "near-miss");
    EXPECT_THAT(bytes_of(folder / "one.xml"), HasSubstr("tests=\"1\" failures=\"1\""));
    folder.write("bad.nc", program({"G999"}));
    EXPECT_EQ(check({folder / "bad.nc", "--format", "junit", "-o", folder / "one.xml"}).status, 2);
    EXPECT_THAT(bytes_of(folder / "one.xml"), HasSubstr("tests=\"1\" failures=\"0\" errors=\"1\""));
}

TEST_F(Batch, LeavesAnOldReportWhereTheNewOneCannotBeWritten) {
    folder.write("old.json", "old report\n");
    const Ran full = check({all(), "--format", "json", "-o", folder / "old.json", "--format", "csv",
                            "-o", "/dev/full", "--format", "junit", "-o", folder / "new.xml"},
                           "ulimit -f 1; trap '' XFSZ;");
    EXPECT_EQ(full.status, 2);
    EXPECT_THAT(full.err, HasSubstr("old.json: could not be written completely; the old file is "
                                    "unchanged"));
    EXPECT_THAT(full.err, HasSubstr("/dev/full"));
    EXPECT_EQ(bytes_of(folder / "old.json"), "old report\n");
    const Ran nowhere = check({all(), "--format", "json", "-o", "/proc/nowhere/report.json",
                               "--format", "csv", "-o", folder / "rows.csv"});
    EXPECT_EQ(nowhere.status, 2);
    EXPECT_THAT(nowhere.err, HasSubstr("/proc/nowhere/report.json"));
    EXPECT_THAT(bytes_of(folder / "rows.csv"), HasSubstr("near.nc")) << "the others are written";
}

TEST_F(Batch, KeepsWhatHasEndedWhenItIsInterrupted) {
    folder.write("long.nc", long_program());
    fs::copy_file(folder / "near.toml", folder / "long.toml");
    test_support::RunningProgram running({FEELER_BINARY, "check", all(), folder / "long.nc",
                                          "--jobs", "2", "--format", "json", "-o",
                                          folder / "report.json"});
    EXPECT_TRUE(running.wait_for_output({"fine.nc", "near.nc", "links.nc"}));
    running.send(SIGINT);
    const Ran ran = running.result();
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.out, HasSubstr("not checked: " + folder / "long.nc"));
    EXPECT_THAT(ran.out, HasSubstr("violation  " + folder / "near.nc"));
    EXPECT_THAT(ran.err, HasSubstr("interrupted; 3 of 4 programs were checked"));
    const json report = json::parse(bytes_of(folder / "report.json"));
    EXPECT_EQ(report["programs"].size(), 3U);
    EXPECT_EQ(report["unchecked"], json({folder / "long.nc"}));
}

TEST_F(Batch, SkipsTenThousandFilesInOneLine) {
    fs::create_directory(folder / "many");
    for (int i = 0; i < 10'000; ++i)
        folder.write("many/" + std::to_string(i) + ".txt", "no program, and no block either\n");
    folder.write("many/one.nc", fine);
    const Ran ran = check({folder / "many", "--setup", folder / "fine.toml"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("skipped: 10000 files, such as"));
}

TEST_F(Batch, IsColouredOnATerminalUnlessNoColorIsSet) {
    for (const char* colour : {"", "1"}) {
        ::setenv("NO_COLOR", colour, 1);
        test_support::Terminal terminal({FEELER_BINARY, "check", all()}, all());
        const std::string seen = terminal.until("programs in");
        EXPECT_EQ(seen.find("\033[32mclear") != std::string::npos, *colour == '\0') << seen;
        EXPECT_EQ(terminal.status(), 1);
    }
    ::unsetenv("NO_COLOR");
}

TEST_F(Batch, ShowsHowFarItIsOnATerminal) {
    folder.write("long.nc", long_program());
    fs::copy_file(folder / "near.toml", folder / "long.toml");
    test_support::Terminal terminal({FEELER_BINARY, "check", all()}, all());
    EXPECT_THAT(terminal.until(" of 4 programs"), HasSubstr("%"));
    terminal.type("\x03");
    EXPECT_THAT(terminal.until("were checked"), HasSubstr("not checked"));
    EXPECT_EQ(terminal.status(), 2);
}

} // namespace
} // namespace app_test
