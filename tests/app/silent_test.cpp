#include <numbers>

#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::flat_10;
using test_support::program;
using test_support::SetupWriter;

/// Expects no finding for everyday practice.
void expect_silence(const std::string& text, const SetupWriter& setup = {}) {
    const Checked checked = check(setup, text);
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.verdict, "clear");
    EXPECT_EQ(checked.errors(), "");
    EXPECT_EQ(checked.of_severity("warning"), "");
}

TEST(Silence, IsKeptOnARetractAlongTheWallJustCut) {
    expect_silence(program({"G0 X-20. Y50.", "Z-5.", "G1 X50. F800.", "G0 Z60."}));
}

TEST(Silence, IsKeptOnARapidBackThroughTheSlot) {
    expect_silence(program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 X-20.", "Z60."}));
    expect_silence(program({"G0 X-20. Y50.25", "Z-5.1", "G1 X120. F800.", "G0 Z-4.9", "X-20."}));
}

TEST(Silence, IsKeptOnTheRetractsOfAPeckingCycle) {
    const std::string cycle =
        program({"G0 X50. Y50.", "Z5.", "G98 G83 X50. Y50. Z-15. R2. Q4. F200.", "G80", "G0 Z60."});
    expect_silence(cycle);
    const BlockLine block = check(SetupWriter(), cycle).at_line(8);
    EXPECT_EQ(block.motion, "cycle");
    EXPECT_NEAR(block.removed, std::numbers::pi * 25.0 * 15.0, 12.0);
}

TEST(Silence, IsKeptAboutAShankOfTheFlutesDiameterInItsOwnHole) {
    expect_silence(
        program({"G0 X50. Y50.", "Z5.", "G98 G81 X50. Y50. Z-28. R2. F200.", "G80", "G0 Z60."}));
}

TEST(Silence, IsKeptAboutAShankOfTheFlutesDiameterInItsOwnSlot) {
    expect_silence(program({"G0 X-20. Y50.", "Z-12.", "G1 X120. F800.", "G0 Z60.", "X-20.",
                            "Z-24.3", "G1 X120.", "G0 X-20.", "Z60."}));
}

TEST(Silence, IsKeptAboutAShankInAHelicalHole) {
    std::vector<std::string> lines = {"G0 X50. Y50.", "Z2.", "G1 X53. F500."};
    for (int depth = 2; depth <= 26; depth += 4)
        lines.push_back("G3 I-3. Z-" + std::to_string(depth) + ".");
    for (const char* line : {"G3 I-3.", "G1 X50.", "G0 Z60."}) lines.push_back(line);
    expect_silence(program(lines));
}

TEST(Silence, IsKeptOnANeckThinnerThanTheFlutes) {
    const std::string necked = "number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 8\n"
                               "shank = [[9, 9, 37]]\nholder = [[40, 40, 50]]\n";
    expect_silence(program({"G0 X-20. Y50.", "Z-7.", "G1 X120. F800.", "Z-14.", "X-20.", "Z-21.",
                            "X120.", "G0 Z60."}),
                   SetupWriter().tool(necked));
}

TEST(Silence, IsKeptWhereTheWallLeansAgainstTheMeshByAHair) {
    for (const char* y : {"49.99", "50.01", "50.125", "50.3333"})
        expect_silence(
            program({std::string("G0 X-20. Y") + y, "Z-12.", "G1 X120. F800.", "G0 X30.", "Z60."}));
}

} // namespace
} // namespace app_test
