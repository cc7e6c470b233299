#include <cmath>

#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::SetupWriter;

const std::string end_mill = "number = 1\nshape = \"flat\"\ndiameter = 12\nflute_length = 22\n"
                             "stick_out = 45\nholder = \"BT40-ER32\"\n";

/// A slot of 12 mm at Z-20, then the other tool along it at the same depth, and out as in `last`.
std::string slot_and(const std::string& last) {
    return "G21 G90 G17 G54\nT1 M6\nS3000 M3\nG0 G43 H1 Z60.\nG0 X-20. Y50.\nZ-20.\n"
           "G1 X120. F800.\nG0 Z60.\nT2 M6\nS1000 M3\nG0 G43 H2 Z60.\nG0 X-20. Y50.\nZ-20.\n"
           "G1 X50. F300.\n"
           + last + "\nM30\n";
}

Checked run(const std::string& shape, const std::string& last) {
    return check(SetupWriter().lengths("").tool(end_mill).also_tool(
                     "number = 2\ndiameter = 20\nneck_diameter = 8\nstick_out = 60\n"
                     "shank_diameter = 8\nholder = \"BT40-EM8\"\nshape = "
                     + shape + "\n"),
                 slot_and(last));
}

const char* const shapes[] = {"\"tslot\"\nflute_length = 8",
                              "\"tslot\"\nflute_length = 8\ncorner_radius = 1",
                              "\"dovetail\"\nflute_length = 8\nangle_deg = 20",
                              "\"threadmill\"\nflute_length = 8\npitch = 2", "\"lollipop\""};

TEST(Undercut, IsLeftTheWayItWasCut) {
    for (const char* shape : shapes) {
        const Checked checked = run(shape, "G0 X-20.\nZ60.");
        EXPECT_EQ(checked.status, 0) << shape << checked.err << checked.errors();
        EXPECT_EQ(checked.verdict, "clear") << shape;
    }
}

TEST(Undercut, IsNotLeftStraightUp) {
    for (const char* shape : shapes) {
        const Checked checked = run(shape, "G0 Z60.");
        EXPECT_EQ(checked.status, 1) << shape;
        EXPECT_EQ(checked.errors(), "rapid-in-stock 15") << shape;
    }
}

TEST(Undercut, RemovesWhatTheHeadIsWiderThanTheSlot) {
    // 8 mm high, 4 mm on each side of the slot, to X 50 and around the head beyond it.
    const Checked checked = run(shapes[0], "G0 X-20.\nZ60.");
    const double slot = 12.0 * 20.0 * 100.0;
    const double straight = 8.0 * (20.0 - 12.0) * 50.0;
    double removed = 0.0;
    for (const BlockLine& block : checked.blocks) removed += block.removed;
    // Beyond X 50, the half disc of radius 10 without the slot of 12 mm: two segments that begin at
    // 6 mm.
    const double half_segments = 8.0 * (100.0 * std::acos(0.6) - 6.0 * 8.0);
    EXPECT_NEAR(removed, slot + straight + half_segments, 0.005 * removed);
}

} // namespace
} // namespace app_test
