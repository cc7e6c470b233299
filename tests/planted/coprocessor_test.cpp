#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/coproc/study/coprocessor_run.h"
#include "gcode/language/dialect.h"
#include "hwsim/coprocessor.h"
#include "tests/support/device_judgement.h"

namespace app {
namespace {

const std::filesystem::path folder = std::filesystem::path(FEELER_SOURCE_DIR) / "tests/planted";

/// A program of the table with its set-up. Programs that start in the middle are omitted.
struct Program {
    std::string file, setup, dialect;
    auto operator<=>(const Program&) const = default;
};

std::set<Program> programs() {
    std::ifstream file(folder / "table.txt");
    std::set<Program> found;
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::stringstream words(line);
        std::string rule, dialect, wrong, number, setup, right, right_setup, options, more;
        words >> rule >> dialect >> wrong >> number >> setup >> right >> right_setup >> options
            >> more;
        if (options != "-" || more != "-") continue;
        found.insert({wrong, setup, dialect});
        found.insert({right, right_setup, dialect});
    }
    return found;
}

CheckJob job_of(const Program& program) {
    CheckJob job{.program = folder / program.file,
                 .setup = folder / "setups" / (program.setup + ".toml"),
                 .detail = core::Detail::every_pair};
    job.settings.dialect = gcode::dialect_named(program.dialect);
    return job;
}

TEST(Coprocessor, RefusesEveryBlockOfThePlantedProgramsThatTheExactEngineDoes) {
    test_support::DeviceJudgement all;
    for (const Program& program : programs()) {
        const CheckJob job = job_of(program);
        hwsim::FunctionalDevice device = hwsim::functional_device({}).value();
        judge_by_device(job, port_of(device), all);
    }
    EXPECT_EQ(all.missed, "");
    EXPECT_EQ(all.unproven, "");
    EXPECT_EQ(all.errors, "");
    test_support::record(all.counts);
    EXPECT_GT(all.counts.violations, 150);
    EXPECT_LT(all.counts.false_alarms, all.counts.blocks / 200);
    EXPECT_LT(all.counts.not_queried, all.counts.blocks / 40);
}

/// The run of a program with one engine.
CheckRun checked_by(CheckJob job, Engine engine) {
    job.engine = engine;
    auto checked = run_check(job);
    EXPECT_TRUE(checked.has_value()) << job.program;
    return checked ? *std::move(checked) : CheckRun();
}

/// Compares the device's judgement of a block with that of the exact engine.
void expect_safe(const CheckedBlock& device, const CheckedBlock& exact, const std::string& file) {
    const auto where = file + ":" + std::to_string(exact.line);
    const core::BlockResult& a = exact.result;
    const core::BlockResult& b = device.result;
    if (a.verdict >= core::Verdict::violation) {
        EXPECT_NE(b.verdict, core::Verdict::clear) << where;
    }
    if (b.verdict == core::Verdict::undecided) return; // no request was made
    // After a body has been rotated into the stock, different material is missing.
    if (!file.starts_with("rotary")) {
        EXPECT_NEAR(b.removed, a.removed, 1e-9) << where;
    }
    for (const core::PairClearance& pair : b.pairs)
        for (const core::PairClearance& other : a.pairs)
            if (other.pair == pair.pair) {
                EXPECT_LE(pair.lower, other.upper + core::resolution) << where;
            }
}

TEST(Coprocessor, GivesTheSamePermitsWhenBlocksOverlapInIt) {
    const std::set<std::string> rules = {"collision", "near-miss", "rapid-in-stock",
                                         "rest-material", "tool-change-unsafe"};
    size_t refused = 0;
    for (const Program& program : programs()) {
        if (!rules.contains(std::filesystem::path(program.file).parent_path())) continue;
        const CheckJob job = job_of(program);
        hwsim::FunctionalDevice device = hwsim::functional_device({}).value();
        const auto alone = test_support::judged_by_device(job, port_of(device));
        const auto beside = run_with_coprocessor({.check = job});
        ASSERT_TRUE(alone && beside) << program.file;
        ASSERT_EQ(beside->blocks.size(), alone->permits.size());
        uint64_t last = 0;
        for (size_t i = 0; i < beside->blocks.size(); ++i) {
            const BlockPermit& a = alone->permits[i];
            const DeviceBlock& b = beside->blocks[i];
            const auto where = program.file + ":" + std::to_string(alone->blocks[i].line);
            EXPECT_EQ(b.permit.permitted, a.permitted) << where;
            EXPECT_EQ(b.permit.stop, a.stop) << where;
            EXPECT_EQ(b.permit.pair, a.pair) << where;
            EXPECT_EQ(b.permit.segments, a.segments) << where;
            EXPECT_LE(b.interval, b.cycles) << where;
            EXPECT_GE(b.after[hwsim::Counter::cycles], last) << where;
            last = b.after[hwsim::Counter::cycles];
            refused += !a.permitted;
        }
    }
    EXPECT_GT(refused, 20U);
}

TEST(Coprocessor, AsTheEngineOfACheckItClaimsNoMoreThanTheExactOne) {
    const std::set<std::string> rules = {"collision",        "near-miss",
                                         "rapid-in-stock",   "low-retract",
                                         "rapid-near-clamp", "rotary-with-tool-down",
                                         "spindle-off",      "tool-change-unsafe"};
    size_t blocks = 0;
    for (const Program& program : programs()) {
        if (!rules.contains(std::filesystem::path(program.file).parent_path())) continue;
        const CheckJob job = job_of(program);
        const CheckRun exact = checked_by(job, Engine::exact);
        const CheckRun device = checked_by(job, Engine::coprocessor);
        ASSERT_EQ(device.blocks.size(), exact.blocks.size());
        blocks += exact.blocks.size();
        for (size_t i = 0; i < exact.blocks.size(); ++i)
            expect_safe(device.blocks[i], exact.blocks[i], program.file);
        EXPECT_EQ(device.cycle_time, exact.cycle_time);
        if (exact.verdict >= core::Verdict::violation) {
            EXPECT_TRUE(device.has_errors()) << program.file;
        }
    }
    EXPECT_GT(blocks, 500U);
}

} // namespace
} // namespace app
