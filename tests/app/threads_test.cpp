#include <filesystem>
#include <fstream>
#include <random>
#include <regex>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/check/run_state.h"
#include "app/report/json/json_report.h"
#include "tests/support/scoped_folder.h"

namespace {

using app::CheckJob;
using app::CheckRun;
using test_support::ScopedFolder;

/// What a run shows and leaves: its report without times, and its last state.
struct Outcome {
    std::string report;
    uint64_t state = 0;
    double foreseen = 0.0; // part of the blocks that other threads have read and cut

    bool operator==(const Outcome& other) const {
        return report == other.report && state == other.state;
    }
};

Outcome outcome(const CheckJob& job, unsigned threads, size_t first = 0) {
    auto check = app::prepare_check(job);
    if (!check) {
        ADD_FAILURE() << check.error().message;
        return {};
    }
    app::ProgramRunner runner(*check);
    runner.use_threads(threads, first);
    runner.run_to_end();
    runner.conclude(false);
    std::string report = app::json_report(check->run, true);
    report = std::regex_replace(report, std::regex("\"(read|model|check)\": [0-9.e-]+,?"), "");
    const auto blocks = static_cast<double>(check->run.blocks.size());
    return {report, digest_of(runner.state()),
            static_cast<double>(runner.foreseen_blocks()) / blocks};
}

/// Expects the same outcome of a check whatever the number of threads, and that so much of it is
/// foreseen.
void expect_same_with_threads(const CheckJob& job, double foreseen) {
    const Outcome alone = outcome(job, 1);
    EXPECT_EQ(alone.foreseen, 0.0);
    for (const unsigned threads : {2U, 3U, 8U, 64U}) {
        const Outcome together = outcome(job, threads);
        ASSERT_TRUE(together == alone) << threads << " threads";
        EXPECT_GE(together.foreseen, foreseen);
    }
    ASSERT_TRUE(outcome(job, 3, 37) == alone) << "later";
}

constexpr const char* setup = R"(
mesh_size = 0.8
[program]
dialect = "fanuc"
start = { X = 0, Y = 0, Z = 300 }
[machine]
rapid = "straight"
[stock]
box = [[0, 0, -20], [60, 50, 0]]
[offsets]
G54 = { X = 0, Y = 0, Z = 0 }
[[tool]]
number = 1
shape = "ball"
diameter = 6
flute_length = 12
stick_out = 40
holder = "BT40-ER32"
[[tool]]
number = 2
shape = "drill"
diameter = 5
flute_length = 30
stick_out = 45
holder = "BT40-ER32"
[[fixture]]
name = "clamp"
box = [[50, 20, 0], [80, 30, 9]]
[[fixture]]
name = "board"
box = [[0, 0, -30], [60, 50, -20]]
expendable = true
)";

/// Writes a program with feeds, arcs, helices, cycles, rapids above and through the stock, probing,
/// wrong lengths, calls, changes of tool and spindle.
class RandomProgram {
public:
    explicit RandomProgram(uint32_t seed) : random_(seed) {}

    std::string text(int blocks, bool ends_badly) {
        std::string text = "%\nO1000\nG21 G90 G17 G40 G80 G54\nT1 M6\nG43 H1 Z50.\nS5000 M3\n"
                           "G1 F800. Z20.\n";
        while (blocks > 0) blocks -= add(text);
        if (ends_badly) text += "G2 X1. Y1. R0.001\n";
        return text + "M30\n%\n";
    }

private:
    double between(double a, double b) {
        return std::uniform_real_distribution<double>(a, b)(random_);
    }
    bool chance(double p) { return between(0, 1) < p; }
    std::string place() { return fmt::format("X{:.3f} Y{:.3f}", between(-5, 65), between(-5, 55)); }

    int add(std::string& text) {
        if (chance(0.75)) {
            const int count = 5 + static_cast<int>(between(0, 60));
            text += fmt::format("G1 {} Z{:.3f}\n", place(), between(-3, 1));
            double x = between(0, 60), y = between(0, 50);
            for (int i = 0; i < count; ++i) {
                x += between(-1.5, 1.5), y += between(-1.5, 1.5);
                text += fmt::format("G1 X{:.3f} Y{:.3f}{}\n", x, y,
                                    chance(0.2) ? fmt::format(" Z{:.3f}", between(-4, 0)) : "");
            }
            return count;
        }
        const auto kind = static_cast<int>(between(0, 12));
        switch (kind) {
        case 0:
            text += fmt::format("G3 I{:.3f} J{:.3f}\n", between(-6, 6), between(0.5, 6));
            return 1;
        case 1:
            text += fmt::format("G2 I4. J0. Z{:.3f}\n", between(-6, -1));
            return 1;
        case 2:
            text += fmt::format("G0 Z{:.3f}\nG0 {}\n", between(3, 20), place());
            return 2;
        case 3:
            text += fmt::format("G0 {} Z{:.3f}\n", place(), between(-3, 12));
            return 1;
        case 4:
            text += "G0 Z30.\nT2 M6\nG43 H2 Z30.\nS2000 M3\n";
            text += fmt::format("G81 {} Z-8. R2. F200.\n{}\nG80\n", place(), place());
            text += "G0 Z40.\nT1 M6\nG43 H1 Z40.\nS5000 M3\n";
            return 10;
        case 5:
            text += chance(0.3) ? "M5\nG1 Z5.\nM3 S5000\n" : "G4 P100\n";
            return 3;
        case 6:
            if (!chance(0.3)) return 1;
            text += fmt::format("G0 Z25.\nG31 Z{:.1f} F100.\nG0 Z25.\nG53 Z300.\nG43 H1 Z30.\n",
                                between(-1, 10));
            return 5;
        case 7:
            text += "M98 P2000 L2\n";
            return 8;
        case 8:
            if (!chance(0.2)) return 1;
            text += "G43 H2 Z20.\nG1 X10. Y10.\nG1 X12.\nG43 H1 Z20.\n"; // a wrong length
            return 4;
        case 9:
            text += fmt::format("#1={:.2f}\nWHILE[#1 LT 8]DO1\nG1 X[#1*3] Y[20+#1]\n#1=#1+0.5\n"
                                "END1\n",
                                between(0, 6));
            return 20;
        case 10:
            text += "G28 G91 Z0\nG90\nG43 H1 Z30.\n";
            return 3;
        default:
            text += "G1 Z-22.\nG1 Z2.\n"; // into the board
            return 2;
        }
    }

    std::mt19937 random_;
};

constexpr const char* subprogram = "%\nO2000\nG91\nG1 X1.5 F700.\nG1 Y1.5\nG1 X-1.5\nG1 Y-1.5\n"
                                   "G90\nM99\n%\n";

CheckJob job_in(const ScopedFolder& folder, const std::string& program,
                const std::string& settings = setup) {
    CheckJob job;
    folder.write("O2000.nc", subprogram);
    job.program = folder.write("p.nc", program);
    job.setup = folder.write("s.toml", settings);
    return job;
}

TEST(Threads, ChangeNothingInRandomPrograms) {
    const ScopedFolder folder;
    for (uint32_t seed = 1; seed <= 6; ++seed) {
        SCOPED_TRACE(seed);
        CheckJob job = job_in(folder, RandomProgram(seed).text(900, seed % 3 == 0));
        job.detail = std::array{core::Detail::deciding_pair, core::Detail::every_pair,
                                core::Detail::verdict}[seed % 3];
        ASSERT_NO_FATAL_FAILURE(expect_same_with_threads(job, 0.3));
    }
}

/// A finishing raster with nothing in its way: all of it is foreseen.
std::string raster(int rows, int steps) {
    std::string text = "%\nO1\nG21 G90 G17 G54\nT1 M6\nG43 H1 Z50.\nS5000 M3\nG1 F800. Z0.\n";
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i <= steps; ++i) {
            const int at = row % 2 == 0 ? i : steps - i;
            text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", 40.0 * at / steps, 0.7 * row,
                                -1.0 - std::sin(0.2 * at) * std::cos(0.1 * row));
        }
    return text + "G0 Z50.\nM30\n%\n";
}

TEST(Threads, ChangeNothingInARaster) {
    const ScopedFolder folder;
    CheckJob job = job_in(folder, raster(25, 60));
    ASSERT_NO_FATAL_FAILURE(expect_same_with_threads(job, 0.95));
    job.mesh_size = 0.3;
    ASSERT_NO_FATAL_FAILURE(expect_same_with_threads(job, 0.95));
}

TEST(Threads, ReportTheFilesThatTheyRead) {
    const ScopedFolder folder;
    std::string text = raster(8, 60);
    text.insert(text.find("G0 Z50."), "M98 P2000\nG1 X1.\nG1 X2.\nM98 P2000\n");
    CheckJob job = job_in(folder, text);
    const auto inputs = [&](unsigned threads) {
        job.threads = threads;
        auto run = app::run_check(job);
        EXPECT_TRUE(run);
        return run ? run->inputs : std::vector<app::InputFile>{};
    };
    const auto alone = inputs(1);
    EXPECT_TRUE(std::any_of(alone.begin(), alone.end(), [](const app::InputFile& file) {
        return file.path.find("O2000") != std::string::npos;
    }));
    EXPECT_EQ(inputs(2), alone);
    EXPECT_EQ(inputs(4), alone);
}

TEST(Threads, StopWhenTheUserStops) {
    const ScopedFolder folder;
    CheckJob job = job_in(folder, raster(25, 60));
    for (const size_t last : {300U, 777U}) {
        job.after_block = [&](const app::CheckProgress& progress) {
            return progress.blocks < last;
        };
        job.threads = 1;
        const auto alone = app::run_check(job);
        job.threads = 4;
        const auto together = app::run_check(job);
        ASSERT_TRUE(alone && together);
        EXPECT_EQ(together->blocks.size(), last);
        EXPECT_EQ(alone->blocks.size(), last);
        ASSERT_TRUE(together->stopped);
        EXPECT_EQ(together->stopped->message, alone->stopped->message);
    }
}

TEST(Threads, LeaveTheProgramInWindowsAlone) {
    // A program that is read in windows: its lines are read once more for messages at the end.
    const ScopedFolder folder;
    std::string text = raster(60, 300);
    ASSERT_GT(text.size(), size_t(1) << 18U);
    text.insert(text.rfind("G0 Z50."), "G1 X1. Q\n");
    CheckJob job = job_in(folder, text);
    job.mesh_size = 4.0;
    ASSERT_NO_FATAL_FAILURE(expect_same_with_threads(job, 0.95));
}

} // namespace
