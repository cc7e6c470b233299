#include <array>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

struct Tip {
    int orientation;
    double x, z; // of a nose of radius 1, from its centre
};

// The end points of the first move in LinuxCNC's interpreter.
constexpr Tip tips[] = {{0, 0, 0}, {1, -1, 1}, {2, -1, -1}, {3, 1, -1}, {4, 1, 1},
                        {5, 0, 1}, {6, -1, 0}, {7, 0, -1},  {8, 1, 0},  {9, 0, 0}};

std::string contour(std::string_view entry) {
    return fmt::format("G21 F100 G18\nG0 X40 Y0 Z5\n{}\nG1 X20 Z0\nY4\nG2 X30 Z-10 I10 K0\n"
                       "G1 X60 Z-30\nG40\nG1 Y5\nG0 X80 Z5\n",
                       entry);
}

/// The end points and centres of the motions of a trace along X and Z.
std::vector<std::array<double, 2>> places(const Run& run) {
    std::vector<std::array<double, 2>> found;
    for (const BlockCommands& block : run.blocks)
        for (const CanonicalCommand& command : block.commands) {
            if (const auto* move = std::get_if<StraightFeed>(&command))
                found.push_back({*move->end[0], *move->end[2]});
            if (const auto* move = std::get_if<ArcFeed>(&command)) {
                found.push_back({*move->end[0], *move->end[2]});
                found.push_back({move->centre[1], move->centre[0]});
            }
        }
    return found;
}

void expect_shifted(const Run& run, const Run& mill, const Tip& tip, double radius) {
    ASSERT_FALSE(run.error) << run.error->message;
    const auto ours = places(run), centres = places(mill);
    ASSERT_EQ(ours.size(), centres.size());
    ASSERT_GT(ours.size(), 5U);
    for (size_t i = 0; i + 1 < ours.size(); ++i) { // the last one is after G40
        EXPECT_NEAR(ours[i][0], centres[i][0] + radius * tip.x, 1e-9) << tip.orientation;
        EXPECT_NEAR(ours[i][1], centres[i][1] + radius * tip.z, 1e-9) << tip.orientation;
    }
    EXPECT_EQ(ours.back(), centres.back());
}

TEST(TurningCompensation, MovesThePointThatIsControlled) {
    const Ran mill = run_text(contour("G42.1 D3"), DialectId::linuxcnc);
    ASSERT_FALSE(mill.run.error);
    EXPECT_NEAR(places(mill.run)[0][0], 21.578368, 1e-6);
    for (const Tip& tip : tips) {
        const std::string entry = fmt::format("G42.1 D3 L{}", tip.orientation);
        expect_shifted(run_text(contour(entry), DialectId::linuxcnc).run, mill.run, tip, 1.5);
    }
}

TEST(TurningCompensation, TakesTheOrientationOfTheToolsEntry) {
    const Ran mill = run_text(contour("G41.1 D3"), DialectId::linuxcnc);
    for (const Tip& tip : tips) {
        const std::string entry = fmt::format("G10 L1 P5 R1.5 Q{}\nG41 D5", tip.orientation);
        expect_shifted(run_text(contour(entry), DialectId::linuxcnc).run, mill.run, tip, 1.5);
    }
}

TEST(TurningCompensation, IsOfThePlaneOfG18) {
    EXPECT_THAT(error_of("G21 G17 G41.1 D2 L3", DialectId::linuxcnc),
                HasSubstr("this is a turning tool (orientation 3)"));
    EXPECT_THAT(error_of("G21 G10 L1 P5 R1 Q3\nG42 D5", DialectId::linuxcnc),
                HasSubstr("2:1: G42: this is a turning tool"));
    EXPECT_EQ(error_of("G21 G41.1 D2 L9", DialectId::linuxcnc), "");
    EXPECT_THAT(error_of("G18 G41.1 D2 L10", DialectId::linuxcnc), HasSubstr("from 0 to 9"));
}

} // namespace
} // namespace gcode
