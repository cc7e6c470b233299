#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "gcode/dialect.h"
#include "tests/support/device_judgement.h"

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

TEST(Coprocessor, RefusesEveryBlockOfThePlantedProgramsThatTheExactEngineDoes) {
    test_support::DeviceJudgement all;
    for (const Program& program : programs()) {
        CheckJob job{.program = folder / program.file,
                     .setup = folder / "setups" / (program.setup + ".toml"),
                     .detail = core::Detail::every_pair};
        job.settings.dialect = gcode::dialect_named(program.dialect);
        hwsim::FunctionalDevice device = hwsim::functional_device({}).value();
        judge_by_device(job, port_of(device), all);
    }
    EXPECT_EQ(all.missed, "");
    EXPECT_EQ(all.errors, "");
    test_support::record(all.counts);
    EXPECT_GT(all.counts.violations, 150);
    EXPECT_LT(all.counts.false_alarms, all.counts.blocks / 200);
    EXPECT_LT(all.counts.not_asked, all.counts.blocks / 50);
}

} // namespace
} // namespace app
