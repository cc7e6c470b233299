#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

const std::string set_radius = "G10 L12 P1 R6.\nG0 X10. Y20. Z2.\n"; // a diameter on this control

std::string commands(const std::string& block) {
    return trace(set_radius + block, DialectId::haas);
}

/// The largest distance of the tool centre from a point along the path, ends and arcs.
double farthest_from(const Run& run, double x, double y) {
    double farthest = 0.0;
    for (const BlockCommands& block : run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* arc = std::get_if<ArcFeed>(&command)) {
                const double to_centre = std::hypot(arc->centre[0] - x, arc->centre[1] - y);
                const double radius =
                    std::hypot(*arc->end[0] - arc->centre[0], *arc->end[1] - arc->centre[1]);
                farthest = std::max(farthest, to_centre + radius);
            }
    return farthest;
}

TEST(CircularPocket, GoesDownOutRoundAndBackToTheMiddle) {
    EXPECT_THAT(commands("G13 I8. Z-1. F100. D1\n"),
                HasSubstr("straight_feed x=10 y=20 z=-1 feed=100\n"
                          "arc_feed x=15 y=20 z=-1 plane=XY centre=12.5,20 turns=1 feed=100\n"
                          "arc_feed x=15 y=20 z=-1 plane=XY centre=10,20 turns=1 feed=100\n"
                          "arc_feed x=10 y=20 z=-1 plane=XY centre=12.5,20 turns=1 feed=100\n"));
}

TEST(CircularPocket, OfG12RunsClockwise) {
    EXPECT_THAT(commands("G12 I8. Z-1. F100. D1\n"),
                HasSubstr("arc_feed x=15 y=20 z=-1 plane=XY centre=10,20 turns=-1 feed=100\n"));
}

TEST(CircularPocket, GrowsByQToKLessTheToolsRadius) {
    const Ran ran = run_text(set_radius + "G13 I8. K15. Q3. Z-1. F100. D1\n", DialectId::haas);
    ASSERT_FALSE(ran.run.error) << ran.run.error->message;
    std::vector<double> circles;
    for (const CanonicalCommand& command : ran.run.blocks.back().commands)
        if (const auto* arc = std::get_if<ArcFeed>(&command))
            if (arc->centre[0] == 10.0 && arc->centre[1] == 20.0)
                circles.push_back(std::abs(*arc->end[0] - 10.0));
    EXPECT_THAT(circles, testing::ElementsAre(5.0, 8.0, 11.0, 12.0));
    EXPECT_NEAR(farthest_from(ran.run, 10.0, 20.0), 12.0, 1e-12);
    EXPECT_EQ(ran.run.state.modal.position[0], 10.0);
    EXPECT_EQ(ran.run.state.modal.position[2], -1.0);
}

TEST(CircularPocket, WithD0KeepsItsRadiiForTheToolsCentre) {
    EXPECT_THAT(commands("G13 I8. Z-1. F100. D0\n"), HasSubstr("arc_feed x=18 y=20"));
}

TEST(CircularPocket, UnderG91GoesDeeperWithEachLoop) {
    const std::string text = commands("G91 G13 I8. Z-3. F100. L3 D1\n");
    EXPECT_THAT(text, HasSubstr("straight_feed x=10 y=20 z=-1"));
    EXPECT_THAT(text, HasSubstr("straight_feed x=10 y=20 z=-4"));
    EXPECT_THAT(text, HasSubstr("straight_feed x=10 y=20 z=-7"));
}

TEST(CircularPocket, MovesToAMiddleOfItsOwn) {
    EXPECT_THAT(commands("G13 X30. Y40. I8. Z-1. F100. D1\n"),
                HasSubstr("straight_traverse x=30 y=40 z=2\nstraight_feed x=30 y=40 z=-1"));
}

TEST(CircularPocket, RefusesRadiiThatDoNotFit) {
    const auto error = [](const std::string& block) {
        return error_of(set_radius + block, DialectId::haas);
    };
    EXPECT_THAT(error("G13 I3. Z-1. F9. D1\n"), HasSubstr("I3: the circle must be larger"));
    EXPECT_THAT(error("G13 Z-1. F9. D1\n"), HasSubstr("the radius I is missing"));
    EXPECT_THAT(error("G13 I8. K9. Z-1. F9. D1\n"), HasSubstr("K also needs Q"));
    EXPECT_THAT(error("G13 I8. Q2. Z-1. F9. D1\n"), HasSubstr("Q also needs K"));
    EXPECT_THAT(error("G13 I8. K7. Q2. Z-1. F9. D1\n"), HasSubstr("K must be greater"));
    EXPECT_THAT(error("G13 I8. Z-1. D1\n"), HasSubstr("no F has been programmed"));
}

} // namespace
} // namespace gcode
