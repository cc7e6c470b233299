#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "app/session/coprocessor_check.h"
#include "app/session/program_runner.h"
#include "gcode/dialect.h"

namespace app {
namespace {

const std::filesystem::path folder = std::filesystem::path(FEELER_SOURCE_DIR) / "tests/planted";

/// A program of the table with its set-up, those that begin in the middle left out.
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

struct Tally {
    int blocks = 0, refused = 0, not_asked = 0, violations = 0, false_alarms = 0, doubtful = 0;
};

/// What the device says of a block, and then what the exact engine says. False at the end.
bool compare(CoprocessorCheck& device, ProgramRunner& runner, BlockRunner& ahead,
             const CheckRun& run, Tally& tally) {
    std::optional<BlockPermit> permit;
    ahead.visit_ahead(runner.place(), [&](const gcode::BlockResult& block,
                                          std::span<const core::Event> events) {
        auto asked = device.ask({.block = block.block, .events = events}, runner.place().machine);
        EXPECT_TRUE(asked) << run.program_file << ": " << asked.error().message;
        if (asked) permit = *asked;
        return false;
    });
    const size_t before = run.blocks.size();
    if (!runner.advance()) return false;
    if (!permit || run.blocks.size() == before) return true;
    const CheckedBlock& block = run.blocks.back();
    ++tally.blocks;
    tally.refused += permit->permitted ? 0 : 1;
    tally.not_asked += permit->not_asked.empty() ? 0 : 1;
    bool violates = false;
    for (const core::PairClearance& pair : block.result.pairs)
        violates = violates || pair.verdict >= core::Verdict::violation;
    if (violates) {
        ++tally.violations;
        EXPECT_FALSE(permit->permitted) << run.program_file << ":" << block.line;
    } else if (!permit->permitted && permit->not_asked.empty()) {
        const bool is_open = block.result.verdict == core::Verdict::undecided;
        ++(is_open ? tally.doubtful : tally.false_alarms);
    }
    return true;
}

void run_both(const Program& program, Tally& tally) {
    CheckJob job{.program = folder / program.file,
                 .setup = folder / "setups" / (program.setup + ".toml")};
    job.settings.dialect = gcode::dialect_named(program.dialect);
    job.detail = core::Detail::every_pair;
    auto prepared = prepare_check(job);
    ASSERT_TRUE(prepared) << prepared.error().message;
    hwsim::FunctionalDevice device = hwsim::functional_device({}).value();
    auto coprocessor =
        CoprocessorCheck::with(port_of(device), prepared->run.setup, prepared->machine.stock);
    ASSERT_TRUE(coprocessor) << program.file << ": " << coprocessor.error().message;
    ProgramRunner runner(*prepared);
    BlockRunner ahead(*prepared->program, prepared->file.environment, prepared->run.setup,
                      runner.library());
    ahead.speed_by_hand = prepared->file.speed_by_hand;
    while (compare(*coprocessor, runner, ahead, prepared->run, tally)) {
    }
}

TEST(Coprocessor, RefusesEveryBlockOfThePlantedProgramsThatTheExactEngineDoes) {
    Tally tally;
    for (const Program& program : programs()) run_both(program, tally);
    RecordProperty("blocks", tally.blocks);
    RecordProperty("violations", tally.violations);
    RecordProperty("refused", tally.refused);
    RecordProperty("not_asked", tally.not_asked);
    RecordProperty("undecided_and_refused", tally.doubtful);
    RecordProperty("false_alarms", tally.false_alarms);
    EXPECT_GT(tally.violations, 150);
    EXPECT_LT(tally.false_alarms, tally.blocks / 50);
    EXPECT_LT(tally.not_asked, tally.blocks / 50);
}

} // namespace
} // namespace app
