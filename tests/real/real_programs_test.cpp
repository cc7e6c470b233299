#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "hwsim/coprocessor.h"
#include "tests/support/device_judgement.h"

namespace real_test {
namespace {

/// The verified findings of a posted program: see README.md.
struct RealProgram {
    const char* file; // from the root of the repository
    int status;
    const char* errors; // rule and count
};

const RealProgram programs[] = {
    {"assets/programs/TEST_G90.NC", 0, ""},
    {"assets/programs/PARALLEL.NC", 0, ""},
    {"tests/real/programs/CONTOUR_R.NC", 0, ""},
    {"tests/real/programs/G83.NC", 0, ""},
    {"tests/real/programs/TEST4.NC", 0, ""},
    {"tests/real/programs/PROGRAM2.NC", 1, "spindle-off 110 "},
    {"tests/real/programs/CONTOUR_ABS.NC", 2, "arc-radius 1 "},
    {"tests/real/programs/circle_diamond_square.gcode", 2, "arc-radius 1 "},
    {"tests/real/programs/CAM_TEST.MPF", 0, ""},
};

std::string errors_of(const app::CheckRun& run) {
    std::map<std::string, int> counts;
    for (const core::Finding& finding : run.findings)
        if (finding.severity == core::Severity::error) ++counts[finding.rule];
    std::string text;
    for (const auto& [rule, count] : counts) text += fmt::format("{} {} ", rule, count);
    return text;
}

TEST(RealPrograms, HaveTheErrorsThatAreTrueOfThemAndNoOthers) {
    for (const RealProgram& program : programs) {
        const auto run =
            app::run_check({.program = std::string(FEELER_SOURCE_DIR "/") + program.file,
                            .setup = {},
                            .allowance = {},
                            .mesh_size = {}});
        ASSERT_TRUE(run) << program.file;
        const int status = run->stopped ? 2 : run->has_errors() ? 1 : 0;
        EXPECT_EQ(status, program.status) << program.file;
        EXPECT_EQ(errors_of(*run), program.errors) << program.file;
    }
}

/// All of them, each on its own device.
template <typename Device>
test_support::DeviceJudgement judged_by(const Device& fresh) {
    test_support::DeviceJudgement all;
    for (const RealProgram& program : programs) {
        Device device = fresh;
        judge_by_device({.program = std::string(FEELER_SOURCE_DIR "/") + program.file,
                         .detail = core::Detail::every_pair},
                        port_of(device), all);
    }
    return all;
}

TEST(RealPrograms, AreRefusedByTheCoprocessorWhereTheExactEngineFindsAViolation) {
    const auto all = judged_by(hwsim::functional_device({}).value());
    EXPECT_EQ(judged_by(hwsim::emulated_device({}).value()), all);
    EXPECT_EQ(all.missed, "");
    EXPECT_EQ(all.unproven, "");
    EXPECT_EQ(all.errors, "");
    test_support::record(all.counts);
    EXPECT_GT(all.counts.blocks, 1'000);
    EXPECT_GT(all.counts.violations, 50);
    EXPECT_LT(all.counts.false_alarms, all.counts.blocks / 500);
}

} // namespace
} // namespace real_test
