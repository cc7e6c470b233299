#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

std::string text_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::stringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// The trace of a program of assets/programs in the format of golden files.
std::string trace_of_asset(const std::string& name) {
    const auto program = read_program((source_dir / "assets/programs" / name).string());
    if (!program) return program.error().message;
    Environment environment;
    environment.dialect = recognise(*program).dialect;
    return to_text(run(*program, environment));
}

/// On a difference, the new trace is saved in the test's folder, to be checked and copied.
void expect_golden(const std::string& asset, const std::string& name) {
    const std::string actual = trace_of_asset(asset);
    const std::filesystem::path golden = source_dir / "tests/golden/gcode" / name / "expected.txt";
    if (actual == text_of(golden)) return;
    const std::filesystem::path left = std::filesystem::path(testing::TempDir()) / (name + ".txt");
    std::ofstream(left, std::ios::binary) << actual;
    ADD_FAILURE() << golden << " differs from " << left;
}

TEST(Golden, ParallelFinishingWithHelicesInTheYzPlane) { expect_golden("PARALLEL.NC", "parallel"); }

TEST(Golden, MillingOfAFloorAProfileAndHolesWithFullTurns) {
    expect_golden("TEST_G90.NC", "test_g90");
}

} // namespace
} // namespace gcode
