#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/plain_trace.h"
#include "tests/support/program_generator.h"
#include "tests/support/reference_differences.h"
#include "tests/support/reference_interpreter.h"
#include "tests/support/run_difference.h"
#include "tests/support/scoped_folder.h"

namespace test_support {
namespace {

const std::filesystem::path shared = FEELER_SOURCE_DIR "/../shared/programs/linuxcnc";

/// A feature for which the two interpreters are compared.
struct Held {
    const char* feature;
    bool generated; // random programs give equal results
    bool spoilt;    // both reject the same nearly valid programs
};

/// A feature is enabled once it is implemented, and stays enabled.
constexpr Held held[] = {
    {"straight", true, false},       {"rotary_axes", true, false},
    {"secondary_axes", true, false}, {"centre_arcs", true, false},
    {"radius_arcs", true, false},    {"odd_arcs", true, false},
    {"feed_modes", true, false},     {"compensation", true, false},
    {"splines", true, false},        {"polar", true, false},
    {"threads", true, false},        {"probes", true, true},
    {"work_offsets", true, true},    {"rotated_offsets", true, false},
    {"axis_offsets", true, false},   {"tool_offsets", true, false},
    {"tool_table", true, false},     {"home", true, false},
    {"drilling", true, false},       {"drilling_in_all_planes", true, false},
    {"boring", true, false},         {"tapping", true, false},
    {"odd_cycles", true, false},     {"turned_threads", true, false},
    {"tools", true, false},          {"spindle", true, false},
    {"coolant", true, false},        {"stops", true, false},
    {"path_modes", true, true},      {"overrides", true, true},
    {"outputs", true, false},        {"messages", true, false},
    {"crowded_lines", true, false},  {"saved_modes", true, false},
    {"expressions", true, false},    {"parameters", true, false},
    {"positions", true, false},      {"predefined_names", true, false},
    {"formats", true, true},         {"branches", true, false},
    {"loops", true, false},          {"subprograms", true, false},
    {"recursion", true, false},      {"nested_calls", true, false},
};

std::vector<std::string> switched_on(bool Held::*kind) {
    std::vector<std::string> names;
    for (const Held& one : held)
        if (one.*kind) names.emplace_back(one.feature);
    return names;
}

/// Shared programs that do not yet match the reference.
constexpr const char* awaited[] = {
    "LinuxCNC__lathe_g70_71_demo.ngc",
};

bool is_awaited(const std::string& name) {
    return std::find(std::begin(awaited), std::end(awaited), name) != std::end(awaited);
}

/// Skips the test, or fails it in CI, if something is missing.
bool skips(const std::string& what) {
    if (std::getenv("FEELER_REQUIRE_SHARED")) ADD_FAILURE() << what << " is missing";
    return true;
}

std::vector<std::string> generated(const std::string& feature, int count) {
    std::vector<std::string> programs;
    for (int seed = 1; seed <= count; ++seed)
        programs.push_back(generated_program(feature, static_cast<uint32_t>(seed)));
    return programs;
}

/// The totals over all programs.
struct Tally {
    size_t commands = 0, accepted = 0, refused = 0;
};

Tally expect_equal(const std::vector<std::string>& programs) {
    const std::vector<PlainRun> reference = run_reference(programs);
    Tally tally;
    for (size_t i = 0; i < programs.size(); ++i) {
        EXPECT_EQ(reference[i].problem, "");
        const RunComparison comparison =
            compare_runs(reference[i], run_feeler(programs[i]), reference_differences().refusals);
        EXPECT_TRUE(comparison.differences.empty())
            << report_of(comparison, programs[i]) << "of program\n"
            << programs[i];
        tally.commands += comparison.total;
        ++(reference[i].refused ? tally.refused : tally.accepted);
    }
    return tally;
}

class Reference : public testing::Test {
protected:
    void SetUp() override {
        if (!reference_is_installed() && skips("rs274")) GTEST_SKIP() << "rs274 is missing";
    }
};

class Generated : public Reference, public testing::WithParamInterface<std::string> {};

TEST_P(Generated, ProgramsAreReadAsTheReferenceReadsThem) {
    const Tally tally = expect_equal(generated(GetParam(), 8));
    EXPECT_GE(tally.accepted, 4u);
    EXPECT_GT(tally.commands, 100u);
}

INSTANTIATE_TEST_SUITE_P(Reference, Generated, testing::ValuesIn(switched_on(&Held::generated)),
                         [](const auto& feature) { return feature.param; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Generated);

class Spoilt : public Reference, public testing::WithParamInterface<std::string> {};

TEST_P(Spoilt, ProgramsAreRefusedWhereTheReferenceRefusesThem) {
    std::vector<std::string> programs = generated(GetParam(), 40);
    for (size_t i = 0; i < programs.size(); ++i)
        programs[i] = spoilt_program(programs[i], static_cast<uint32_t>(i));
    const Tally tally = expect_equal(programs);
    EXPECT_GE(tally.accepted, 2u);
    EXPECT_GE(tally.refused, 5u);
}

INSTANTIATE_TEST_SUITE_P(Reference, Spoilt, testing::ValuesIn(switched_on(&Held::spoilt)),
                         [](const auto& feature) { return feature.param; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Spoilt);

TEST_F(Reference, ReadsTheSharedProgramsAsWeDo) {
    if (!std::filesystem::exists(shared) && skips(shared)) GTEST_SKIP() << shared << " is missing";
    std::vector<std::string> programs;
    for (const auto& entry : std::filesystem::directory_iterator(shared)) {
        const std::string name = entry.path().filename();
        if (!is_awaited(name) && !reference_differences().programs.contains(name))
            programs.push_back(bytes_of(entry.path()));
    }
    const Tally tally = expect_equal(programs);
    EXPECT_GT(tally.commands, 1000u);
}

} // namespace
} // namespace test_support
