#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"
#include "tests/support/signalled.h"
#include "tests/support/usage.h"

namespace app_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test_support::bytes_of;
using test_support::program;
using test_support::Ran;
using test_support::RunningProgram;
using test_support::ScopedFolder;
using testing::HasSubstr;
using testing::Not;

/// Programs, one of which calls another, with a project; used for failures during a batch.
class BatchSurvival : public testing::Test {
protected:
    void SetUp() override {
        fs::create_directory(folder / "lib");
        folder.write("lib/feeler.toml", "[[program]]\nfiles = \"[a-z]*.nc\"\n");
        folder.write("lib/call.nc", program({"G0 Z5. X1.", "M98 P2000", "G0 Z5."}));
        folder.write("lib/O2000.nc", "O2000\nG1 Z-1. F100.\nX30.\nM99\n");
        folder.write("lib/other.nc", program({"G0 Z5. X1.", "G1 Z-1. F100.", "X30.", "G0 Z5."}));
    }

    std::string lib() const { return folder / "lib"; }

    ScopedFolder folder;
};

TEST_F(BatchSurvival, ReplacesNoFileThatACheckReads) {
    ASSERT_EQ(feeler({"check", lib()}).status, 0);
    fs::copy(folder / "lib/.feeler/results.db", folder / "lib/.feeler/results-1of2.db");
    for (const char* name : {"lib/feeler.toml", "lib/O2000.nc", "lib/.feeler/results.db",
                             "lib/.feeler/results-1of2.db"}) {
        const std::string before = bytes_of(folder / name);
        const Ran ran = feeler({"check", lib(), "--format", "json", "-o", folder / name});
        EXPECT_EQ(ran.status, 2) << name;
        EXPECT_THAT(ran.err, HasSubstr("is an input and would be overwritten")) << name;
        // A check writes to the database when it reuses a result.
        const bool is_database = before.starts_with("SQLite format 3");
        const size_t length = is_database ? 16 : std::string::npos;
        EXPECT_EQ(bytes_of(folder / name).substr(0, length), before.substr(0, length)) << name;
    }
    const std::string called = folder / "lib/O2000.nc", before = bytes_of(called);
    fs::create_symlink(called, folder / "link");
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"check", folder / "lib/call.nc", "-o", folder / "link"},
             {"diff", folder / "lib/other.nc", folder / "lib/call.nc", "-o", called},
             {"trace", folder / "lib/call.nc", "-o", called},
             {"coproc", folder / "lib/call.nc", "--no-fit", "-o", called}}) {
        const Ran ran = feeler(words);
        EXPECT_EQ(ran.status, 2) << words[0];
        EXPECT_THAT(ran.err, HasSubstr("is an input and would be overwritten")) << words[0];
        EXPECT_EQ(bytes_of(called), before) << words[0];
    }
}

TEST_F(BatchSurvival, NeverOverwritesAnotherFileWithAPicture) {
    for (const std::string name : {"lib/call.nc", "lib/O2000.nc"}) {
        const std::string before = bytes_of(folder / name);
        const Ran ran = feeler({"shot", folder / "lib/call.nc", "-o", folder / name});
        EXPECT_EQ(ran.status, 2) << name;
        EXPECT_EQ(bytes_of(folder / name), before) << name;
    }
    folder.write("shot.png", "");
    for (int i = 0; i < 2; ++i)
        EXPECT_EQ(feeler({"shot", folder / "lib/call.nc", "-o", folder / "shot.png"}).status, 0);
}

TEST_F(BatchSurvival, RefusesTwoReportsInOneFile) {
    const Ran ran = feeler({"check", lib(), "--format", "json", "-o", folder / "report", "--format",
                            "csv", "-o", folder / "lib/../report"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.err, HasSubstr("two reports would go to"));
    EXPECT_FALSE(fs::exists(folder / "report"));
}

TEST_F(BatchSurvival, RefusesAReportWhosePathCannotBeResolved) {
    fs::create_symlink("self", folder / "self");
    for (const std::string& place : {folder / "self", folder / std::string(300, 'n')}) {
        const Ran ran = feeler({"check", lib(), "--format", "json", "-o", place});
        EXPECT_EQ(ran.status, 2) << place;
        EXPECT_THAT(ran.err, HasSubstr(place + ": cannot be written: "));
    }
    EXPECT_TRUE(fs::is_symlink(folder / "self"));
    for (const auto& entry : fs::directory_iterator(fs::current_path()))
        EXPECT_NE(entry.path().extension(), ".new") << entry.path();
    const Ran piped = test_support::run({"bash", "-c", "\"$@\" | cat", "_", FEELER_BINARY, "check",
                                         lib(), "--format", "csv", "-o", "/dev/stdout", "--quiet"});
    EXPECT_THAT(piped.out, HasSubstr("program,"));
    EXPECT_EQ(piped.err, "");
}

TEST_F(BatchSurvival, FollowsLinksToReportsThatAreNotThereYet) {
    fs::create_directory(folder / "reports");
    fs::create_symlink("reports/a.json", folder / "latest");
    fs::create_symlink("latest", folder / "link");
    const Ran ran = feeler({"check", lib(), "--format", "json", "-o", folder / "link"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_TRUE(fs::is_regular_file(folder / "reports/a.json"));
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    fs::remove(folder / "reports/a.json");
    const Ran twice = feeler({"check", lib(), "--format", "json", "-o", folder / "link", "--format",
                              "csv", "-o", folder / "reports/a.json"});
    EXPECT_EQ(twice.status, 2);
    EXPECT_THAT(twice.err, HasSubstr("two reports would go to"));
}

TEST_F(BatchSurvival, ReplacesItsOldReportNextToThePrograms) {
    for (int i = 0; i < 2; ++i) {
        const Ran ran = feeler({"check", folder.path(), "-o", folder / "lib/report.txt"});
        EXPECT_EQ(ran.status, 0) << ran.err;
    }
}

TEST_F(BatchSurvival, WritesItsReportsOnASignal) {
    folder.write("long.nc", program({"F500.", "#1=0", "WHILE[#1LT1000000]DO1", "G1 X#1",
                                     "#1=#1+0.001", "END1"}));
    for (const int signal : {SIGTERM, SIGHUP}) {
        RunningProgram running({FEELER_BINARY, "check", folder / "lib/other.nc", folder / "long.nc",
                                "--jobs", "2", "--format", "json", "-o", folder / "report.json"});
        EXPECT_TRUE(running.wait_for_output({"other.nc"}));
        running.send(signal);
        EXPECT_EQ(running.result().status, 2) << signal;
        EXPECT_EQ(json::parse(bytes_of(folder / "report.json"))["unchecked"],
                  json({folder / "long.nc"}));
    }
}

TEST_F(BatchSurvival, TakesASignalThatComesTwiceAtOnceForOne) {
    folder.write("long.nc", program({"F500.", "#1=0", "WHILE[#1LT1000000]DO1", "G1 X#1",
                                     "#1=#1+0.001", "END1"}));
    for (int i = 0; i < 5; ++i) {
        fs::remove(folder / "report.json");
        RunningProgram running({FEELER_BINARY, "check", folder / "long.nc", folder / "lib/other.nc",
                                "--jobs", "2", "--format", "json", "-o", folder / "report.json"});
        EXPECT_TRUE(running.wait_for_output({"other.nc"}));
        running.send(SIGTERM); // as `timeout` does: to the process and to its process group
        running.send(SIGTERM);
        EXPECT_EQ(running.result().status, 2) << i;
        EXPECT_TRUE(fs::exists(folder / "report.json")) << i;
    }
}

TEST_F(BatchSurvival, OutlivesItsTerminalUnderNohup) {
    folder.write("lib/p.nc",
                 program({"F500.", "#1=0", "N10 G1 X#1", "#1=#1+0.01", "IF[#1LT50.]GOTO 10"}));
    RunningProgram running({"/usr/bin/env", "--ignore-signal=HUP", FEELER_BINARY, "check", lib(),
                            "--jobs", "2", "--no-cache", "--format", "json", "-o",
                            folder / "report.json"});
    EXPECT_TRUE(running.wait_for_output({"other.nc"}));
    running.send(SIGHUP);
    const Ran ran = running.result();
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(json::parse(bytes_of(folder / "report.json"))["programs"].size(), 3U);
}

TEST_F(BatchSurvival, WritesItsReportsWhenTheTerminalOutputIsFull) {
    const std::string report = folder / "report.json";
    for (const char* redirection : {"exec >/dev/full;", "exec 2>/dev/full;"}) {
        fs::remove(report);
        const std::string words = std::string(FEELER_BINARY) + " check " + lib()
                                  + " --cache /dev/null --format json -o " + report;
        const Ran ran = test_support::run({"sh", "-c", redirection + words});
        EXPECT_LE(ran.status, 2) << redirection;
        EXPECT_TRUE(fs::exists(report)) << redirection;
    }
    fs::remove(report);
    test_support::run({"sh", "-c",
                       std::string(FEELER_BINARY) + " check " + lib() + " "
                           + folder / "lib/other.nc" + " --format json -o " + report + " | true"});
    EXPECT_TRUE(fs::exists(report));
}

TEST_F(BatchSurvival, ContinuesWithFewerThreadsThanRequested) {
    for (int i = 0; i < 400; ++i)
        folder.write("lib/p" + std::to_string(i) + ".nc", bytes_of(folder / "lib/other.nc"));
    const Ran ran = feeler({"check", lib(), "--no-cache", "--jobs", "300"}, "ulimit -v 700000;");
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("402 programs in"));
}

TEST_F(BatchSurvival, KeepsTheModelsOfAllJobsWithinTheMemory) {
    const std::string setup = "mesh_size = 0.25\n[stock]\nbox = [[0, 0, -100], [500, 400, 0]]\n";
    for (const char* name : {"a", "b", "c", "d"}) {
        folder.write(std::string("lib/big ") + name + ".nc", bytes_of(folder / "lib/other.nc"));
        folder.write(std::string("lib/big ") + name + ".toml", setup);
    }
    const auto peak = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {FEELER_BINARY, "check"});
        const test_support::Usage usage = test_support::usage_of(words, folder / "out");
        EXPECT_LE(usage.status, 1);
        return usage.kib;
    };
    const long one = peak({lib() + "/big a.nc"});
    const long all = peak({lib() + "/big *.nc", "--jobs", "4", "--memory", "1"});
    EXPECT_GT(one, 100'000) << "otherwise nothing is shown";
    EXPECT_LT(all, one + one / 3);
}

} // namespace
} // namespace app_test
