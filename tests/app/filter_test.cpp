#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/base/sha256.h"
#include "app/base/text.h"
#include "app/guard/program_filter.h"
#include "core/base/platform.h"
#include "tests/app/checked.h"
#include "tests/support/shell.h"

namespace app_test {
namespace {

using test_support::Ran;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A program with a sum of odd bytes: CR LF, a comment in Latin-1, no line end at its end.
const std::string harmless = "G21 G90 G54\r\n(Schlichten f\xFCr Nut)\r\nT1 M6\r\nS3000 M3\r\n"
                             "G43 H1\r\nG0 X10 Y10 Z20\r\nG1 Z-1 F200\r\nX90\r\nG0 Z20\r\nM2";

const std::string setup_text = R"([offsets]
G54 = { X = 0, Y = 0, Z = 0 }
[stock]
box = [[0, 0, -10], [100, 100, 0]]
[[fixture]]
name = "clamp"
box = [[40, 40, 0], [60, 60, 15]]
[[tool]]
number = 1
shape = "flat"
diameter = 6
flute_length = 20
stick_out = 40
)";

/// Runs the filter as a window of LinuxCNC does, with a state folder of its own.
class Filter : public ::testing::Test {
protected:
    Ran filter(const std::string& program, std::vector<std::string> more = {},
               const std::string& before = "") const {
        std::vector<std::string> words = {"filter", program, "--setup", folder_ / "mill.toml"};
        words.insert(words.end(), more.begin(), more.end());
        return feeler(words, "XDG_STATE_HOME=" + folder_.path().string() + "/state " + before);
    }

    std::string crash() const {
        std::string text = harmless;
        text.replace(text.find("X90"), 3, "X50 Y50");
        return folder_.write("crash.ngc", text);
    }

    test_support::ScopedFolder folder_;
    std::string setup_ = folder_.write("mill.toml", setup_text);
    std::string harmless_ = folder_.write("a.ngc", harmless);
};

TEST_F(Filter, PassesAProgramByteForByte) {
    const Ran ran = filter(harmless_);
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, harmless);
    EXPECT_THAT(ran.err, AllOf(HasSubstr("FILTER_PROGRESS="), HasSubstr("a.ngc: ")));
}

TEST_F(Filter, RefusesACrashInWords) {
    for (int pass = 0; pass < 2; ++pass) { // the second time from the database
        const Ran ran = filter(crash());
        EXPECT_EQ(ran.status, 1);
        EXPECT_EQ(ran.out, "");
        EXPECT_THAT(ran.err,
                    AllOf(HasSubstr("COLLISION"), HasSubstr("line 8"), HasSubstr("X50 Y50"),
                          HasSubstr("clamp"), HasSubstr("The program is not loaded.")));
    }
}

TEST_F(Filter, ChecksOnlyWhatHasChanged) {
    EXPECT_THAT(filter(harmless_).err, HasSubstr("FILTER_PROGRESS"));
    const Ran known = filter(harmless_);
    EXPECT_EQ(known.out, harmless);
    EXPECT_THAT(known.err, Not(HasSubstr("FILTER_PROGRESS"))) << "it was checked again";
    EXPECT_THAT(filter(harmless_, {"--no-cache"}).err, HasSubstr("FILTER_PROGRESS"));
    std::string moved = setup_text;
    moved.replace(moved.find("[[40, 40, 0], [60"), 17, "[[40, 5, 0], [60"); // into the way
    folder_.write("mill.toml", moved);
    const Ran checked = filter(harmless_);
    EXPECT_EQ(checked.status, 1) << "the set-up has changed";
    EXPECT_EQ(checked.out, "");
}

TEST_F(Filter, RefusesWhatCannotBeChecked) {
    const std::string broken = folder_.write("b.ngc", "G21 G90\nG1 X[1+ F100\nM2\n");
    const Ran ran = filter(broken);
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, AllOf(HasSubstr("b.ngc"), HasSubstr("2"), HasSubstr("not loaded")));
    EXPECT_EQ(filter(folder_ / "none.ngc").status, 2);
    folder_.write("mill.toml", "mesh_size = \n");
    const Ran mistaken = filter(harmless_);
    EXPECT_EQ(mistaken.status, 2);
    EXPECT_EQ(mistaken.out, "");
    EXPECT_THAT(mistaken.err, AllOf(HasSubstr("mill.toml:1:"), HasSubstr("not loaded")));
}

TEST_F(Filter, RefusesAnIncompleteSetUpIfAsked) {
    EXPECT_EQ(filter(harmless_, {"--require", "coverage"}).status, 1);
}

TEST_F(Filter, ChecksWhatAnotherFilterWrites) {
    const std::string lift = "sed s/X90/X50.Y50./";
    const Ran crash = filter(harmless_, {"--then", lift});
    EXPECT_EQ(crash.status, 1);
    EXPECT_EQ(crash.out, "");
    std::string expected = harmless;
    expected.replace(expected.find("X90"), 3, "X80");
    for (int pass = 0; pass < 2; ++pass) {
        const Ran ran = filter(harmless_, {"--then", "sed s/X90/X80/"});
        EXPECT_EQ(ran.status, 0) << ran.err;
        EXPECT_EQ(ran.out, expected);
        EXPECT_EQ(ran.err.find("FILTER_PROGRESS") != std::string::npos, pass == 0);
    }
    EXPECT_THAT(filter(harmless_, {"--then", "true"}).err, HasSubstr("true: has written nothing"));
    EXPECT_THAT(crash.err, AllOf(HasSubstr(harmless_ + ": COLLISION"), Not(HasSubstr("state"))));
    // A filter within a filter, of the same program.
    const Ran both = filter(harmless_, {"--then", FEELER_BINARY " filter --setup '"
                                                      + (folder_ / "mill.toml") + "' --then cat"});
    EXPECT_EQ(both.status, 0) << both.err;
    EXPECT_EQ(both.out, harmless);
    const Ran failed = filter(harmless_, {"--then", "false"});
    EXPECT_EQ(failed.status, 2);
    EXPECT_EQ(failed.out, "");
    EXPECT_THAT(failed.err, HasSubstr("failed with status 1"));
}

/// The folder for a copy of the program is one for each program; a killed filter leaves it.
TEST_F(Filter, TakesOverTheFolderOfAFilterThatWasKilled) {
    const std::string name = app::sha256_of(app::absolute_path(harmless_)).substr(0, 16);
    const std::filesystem::path left = folder_.path() / "state/feeler/filter" / name;
    const auto is_left_by = [&](const std::string& process) {
        std::filesystem::create_directories(left);
        std::ofstream(left / ".owner") << process;
        EXPECT_EQ(filter(harmless_, {"--then", "cat"}).status, 0);
        return std::filesystem::exists(left);
    };
    EXPECT_TRUE(is_left_by(std::to_string(core::platform::process_id()))); // it runs
    EXPECT_FALSE(is_left_by("999999999"));
}

TEST_F(Filter, SearchesSubprogramsWhereTheSetUpSaysAlsoAfterAnotherFilter) {
    std::filesystem::create_directory(folder_.path() / "subs");
    std::string call = harmless;
    call.replace(call.find("X90"), 3, "O<way> CALL");
    const std::string program = folder_.write("call.ngc", call);
    folder_.write("way.ngc", "O<way> SUB\nG1 X90\nO<way> ENDSUB\nM2\n");
    folder_.write("subs/way.ngc", "O<way> SUB\nG1 X50 Y50\nO<way> ENDSUB\nM2\n");
    EXPECT_EQ(filter(program).status, 0);
    folder_.write("mill.toml", "program.search_path = [\"subs\"]\n" + setup_text);
    EXPECT_EQ(filter(program).status, 1) << "the set-up names another folder";
    EXPECT_EQ(filter(program, {"--then", "cat"}).status, 1);
    folder_.write("mill.toml", setup_text);
    const Ran unknown = filter(program, {"--then", "cat"});
    EXPECT_EQ(unknown.status, 2) << "LinuxCNC runs the copy, next to which there is none";
    EXPECT_EQ(unknown.out, "");
}

TEST_F(Filter, TakesTheIniFileOfLinuxCnc) {
    folder_.write("mill.ini", "[TRAJ]\nCOORDINATES = XYZ\nLINEAR_UNITS = mm\n[AXIS_X]\n"
                              "MIN_LIMIT = 0\nMAX_LIMIT = 60\n[AXIS_Y]\nMIN_LIMIT = 0\n"
                              "MAX_LIMIT = 60\n[AXIS_Z]\nMIN_LIMIT = -60\nMAX_LIMIT = 60\n");
    const Ran ran = filter(harmless_, {}, "INI_FILE_NAME=" + (folder_ / "mill.ini") + " ");
    EXPECT_EQ(ran.status, 1);
    EXPECT_THAT(ran.err, HasSubstr("over-travel"));
}

/// Those that the program uses, by more than a hundredth.
TEST_F(Filter, RefusesAProgramForAnotherWorkOffset) {
    folder_.write("mill.ini", "[RS274NGC]\nPARAMETER_FILE = sim.var\n[TRAJ]\nLINEAR_UNITS = mm\n");
    std::string text = setup_text;
    folder_.write("mill.toml", text.replace(text.find("[stock]"), 0, "G55 = { X = 5 }\n"));
    const auto status_with = [&](const std::string& stored) {
        folder_.write("sim.var", stored);
        return filter(harmless_, {"--ini", folder_ / "mill.ini"});
    };
    EXPECT_EQ(status_with("5221 0\n5222 0.005\n5223 0\n5241 7\n").status, 0);
    const Ran other = status_with("5221 0\n5222 0\n5223 0.5\n5241 5\n");
    EXPECT_EQ(other.status, 1);
    EXPECT_EQ(other.out, "");
    EXPECT_THAT(other.err, AllOf(HasSubstr("G54 Z is 0.5000 in LinuxCNC and 0.0000 in the set-up"),
                                 HasSubstr("not loaded"), Not(HasSubstr("G55"))));
    // One that was never set is 0.
    folder_.write("mill.toml", text.replace(text.find("Z = 0 }"), 7, "Z = 2 }"));
    EXPECT_EQ(status_with("5220 1\n5221 0\n5222 0\n5223 0\n").status, 1);
}

TEST(FilterProgress, RisesInStepsThatAWindowCanFollow) {
    app::FilterProgress progress;
    app::FilterProgress::Clock::time_point now{};
    EXPECT_EQ(progress.line(0.0, now), "FILTER_PROGRESS=0\n");
    EXPECT_EQ(progress.line(0.5, now), "") << "too soon";
    now += std::chrono::milliseconds(200);
    EXPECT_EQ(progress.line(0.5, now), "FILTER_PROGRESS=50\n");
    now += std::chrono::seconds(1);
    EXPECT_EQ(progress.line(0.4, now), "") << "a loop begins again";
    EXPECT_EQ(progress.line(7.0, now), "FILTER_PROGRESS=100\n");
}

} // namespace
} // namespace app_test
