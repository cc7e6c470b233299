#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string radius_2 = "G10 L12 P1 R2.\n";

/// The end points of the moves in the plane, in micrometres.
std::string path_of(const std::string& text) {
    const Ran ran = run_text(radius_2 + text);
    std::string path;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands) {
            const Position* end = nullptr;
            if (const auto* move = std::get_if<StraightFeed>(&command)) end = &move->end;
            if (const auto* move = std::get_if<StraightTraverse>(&command)) end = &move->end;
            const auto* arc = std::get_if<ArcFeed>(&command);
            if (arc) end = &arc->end;
            if (!end) continue;
            path += std::to_string(std::lround(*(*end)[0] * 1000)) + ","
                    + std::to_string(std::lround(*(*end)[1] * 1000)) + (arc ? "arc " : " ");
        }
    if (ran.run.error) path += "error: " + ran.run.error->message;
    return path;
}

TEST(FanucContour, BeginsAtTheOffsetStartOfTheMoveAfterTheEntry) {
    // Up from (10, 0) with the tool on the left: (8, 0), whatever the direction of the entry.
    EXPECT_EQ(path_of("G1 G41 D1 X10. F9\nY20.\nG40 X0\nM30\n"), "8000,0 8000,20000 0,20000 ");
    EXPECT_EQ(path_of("G1 G42 D1 X10. F9\nY20.\nG40 X0\nM30\n"), "12000,0 12000,20000 0,20000 ");
}

TEST(FanucContour, MayBeginWithAMoveShorterThanTheRadius) {
    EXPECT_EQ(path_of("G1 G41 D1 X1. F9\nX20.\nG40 Y10.\nM30\n"),
              "1000,2000 20000,2000 20000,10000 ");
}

TEST(FanucContour, MayDescendBeforeItBegins) {
    EXPECT_EQ(path_of("G41 D1\nG1 Z-1. F9\nX10.\nX20.\nG40 Y10.\nM30\n"),
              "0,0 10000,2000 20000,2000 20000,10000 ");
}

TEST(FanucContour, DoesNotBeginWithAnArc) {
    EXPECT_THAT(path_of("G41 D1\nG2 X10. Y10. I10. F9\nX20.\n"), HasSubstr("PS0034"));
}

TEST(FanucContour, ExtendsOutsideCornersToTheIntersectionOfTheOffsetLines) {
    // A right angle: the offset lines meet 2 beyond each side.
    EXPECT_EQ(path_of("G1 G42 D1 X10. F9\nX20.\nY20.\nG40 X0\nM30\n"),
              "10000,-2000 22000,-2000 22000,20000 0,20000 ");
}

TEST(FanucContour, PassesASharpCornerByTwoStraightPieces) {
    // Reversal by 135 degrees: 2 further on, straight across, and 2 before the start of the next
    // move.
    const double d = std::sqrt(2.0);
    const auto um = [](double value) { return std::to_string(std::lround(value * 1000)); };
    EXPECT_EQ(path_of("G1 G42 D1 X10. F9\nX20.\nX10. Y10.\nG40 X0\nM30\n"),
              "10000,-2000 22000,-2000 " + um(20.0 + d + d) + "," + um(d - d) + " " + um(10.0 + d)
                  + "," + um(10.0 + d) + " 0,10000 ");
}

TEST(FanucContour, StaysOnTheTangentsRoundACornerOfArcs) {
    // The line along Y = 0 meets the arc, which leaves it upwards and turns left about (10, 0).
    EXPECT_EQ(path_of("G1 G42 D1 X10. F9\nX20.\nG3 X0 I-10.\nG1 Y-5.\nG40 X-20.\nM30\n"),
              "10000,-2000 22000,-2000 22000,0 -2000,0arc -2000,-5000 -20000,-5000 ");
}

TEST(FanucContour, MeetsBothSidesOfAnInsideCorner) {
    EXPECT_EQ(path_of("G1 G41 D1 X10. F9\nX20.\nY20.\nG40 X0\nM30\n"),
              "10000,2000 18000,2000 18000,20000 0,20000 ");
}

TEST(FanucContour, KeepsTheNumberOfTheRadius) {
    EXPECT_EQ(path_of("G1 G41 D1 X10. F9\nX20.\nG40 Y9.\nG41 Y20.\nY30.\nG40 X0\nM30\n"),
              "10000,2000 20000,2000 20000,9000 18000,20000 18000,30000 0,30000 ");
    EXPECT_EQ(path_of("G1 G41 D0 X10. F9\nX20.\nM30\n"), "10000,0 20000,0 ");
    EXPECT_THAT(warnings_of("G1 G41 X10. F9\nX20.\nM30\n"), HasSubstr("no D word programmed yet"));
}

TEST(FanucContour, ANegativeRadiusIsTheOtherSide) {
    const Ran ran = run_text("G10 L12 P1 R-2.\nG1 G41 D1 X10. F9\nX20.\nG40 Y9.\nM30\n");
    const auto& move = std::get<StraightFeed>(ran.run.blocks[1].commands.back());
    EXPECT_EQ(*move.end[1], -2.0);
}

TEST(FanucContour, IsNotBrokenByLookAheadAndLengths) {
    for (const std::string code : {"G05 P0", "G05.1 Q1", "G08 P1", "G43 H1", "G49", "G61", "G64",
                                   "G98", "M48", "G09", "G04 P100"}) {
        const std::string text = "G1 G41 D1 X10. F9\nX20.\n" + code + "\nX30.\nG40 Y9.\nM30\n";
        EXPECT_THAT(path_of(text), HasSubstr("30000,2000 30000,9000")) << code;
        EXPECT_THAT(warnings_of(radius_2 + text), Not(HasSubstr("leaves the contour"))) << code;
    }
}

TEST(FanucContour, IsLeftForAReferencePointAndTakenUpAgain) {
    const std::string text = "G1 G41 D1 X10. F9\nX20.\nG91 G28 Z0\nG90 X30.\nX40.\nG40 Y9.\nM30\n";
    EXPECT_THAT(path_of(text), HasSubstr("20000,2000 20000,0 20000,0 30000,2000 40000,2000"));
    EXPECT_THAT(warnings_of(radius_2 + text), HasSubstr("the tool leaves the contour"));
}

TEST(FanucContour, StopsWhereAMoveWouldRunBackwards) {
    // A groove of 3 is too narrow for the radius 2.
    EXPECT_THAT(path_of("G1 G41 D1 X10. F9\nX20.\nY3.\nX10.\nM30\n"), HasSubstr("PS0041"));
    EXPECT_THAT(path_of("G1 G41 D1 X10. F9\nX20.\nY5.\nX10.\nM30\n"), Not(HasSubstr("error")));
}

TEST(FanucContour, WarnsOfBlocksWithoutAMoveInThePlane) {
    const auto warned = [](const std::string& between) {
        return warnings_of(radius_2 + "G1 G41 D1 X10. F9\nX20.\n" + between + "Y20.\nM30\n");
    };
    EXPECT_THAT(warned("M8\n"), Not(HasSubstr("blocks without a move")));
    EXPECT_THAT(warned("M8\nZ-1.\n"), HasSubstr("2 blocks without a move in the plane"));
    EXPECT_THAT(warned("M1\n"), HasSubstr("does not read past the stop"));
}

/// "X20. Y20. ": the blocks that are in doubt.
std::string in_doubt(const std::string& text, double look_ahead = 3.0) {
    Environment environment = known_environment(DialectId::fanuc);
    environment.control.answers[ControlQuestion::contour_look_ahead] = look_ahead;
    const Ran ran = run_text(radius_2 + "G1 G41 D1 X10. F9\n" + text + "M30\n", environment);
    std::string blocks;
    for (const BlockCommands& block : ran.run.blocks)
        if (block.path == core::PathCertainty::doubtful) blocks += std::string(block.text) + " ";
    return blocks;
}

TEST(FanucContour, IsInDoubtAtACornerThatTheControlDoesNotReadInTime) {
    EXPECT_EQ(in_doubt("X20.\nZ-1.\nY20.\nY30.\n"), "");
    EXPECT_EQ(in_doubt("X20.\nZ-1.\nZ-2.\nY20.\nY30.\n"), "X20. Z-1. Z-2. Y20. ");
    EXPECT_EQ(in_doubt("X20.\nZ-1.\nZ-2.\nY20.\nY30.\n", 4), "");
    EXPECT_EQ(in_doubt("X20.\nM0\nY20.\nY30.\n", 8), "X20. M0 Y20. ");
    EXPECT_EQ(in_doubt("X20. M1\nY20.\nY30.\n", 8), "X20. M1 Y20. ");
    EXPECT_EQ(in_doubt("X20.\nM1\nX30.\nX40.\n"), "") << "no corner";
    EXPECT_EQ(in_doubt("X20.\nY20. M1\nM5\nX30.\n"), "Y20. M1 M5 X30. ") << "an outside corner";
}

TEST(FanucContour, RefusesAnotherPlaneAndASkip) {
    EXPECT_THAT(path_of("G1 G41 D1 X10. F9\nG18 X20.\n"),
                HasSubstr("G18 is not allowed between G41 and G40"));
    EXPECT_THAT(path_of("G1 G41 D1 X10. F9\nG31 X20.\n"),
                HasSubstr("G31 is not allowed between G41 and G40"));
}

TEST(FanucContour, WorksInEveryPlane) {
    const Ran ran = run_text(radius_2 + "G19 G1 G41 D1 Y10. F9\nY20.\nG40 Z9.\nM30\n");
    ASSERT_FALSE(ran.run.error) << ran.run.error->message;
    EXPECT_EQ(*std::get<StraightFeed>(ran.run.blocks[2].commands.back()).end[2], 2.0);
}

TEST(ScaledArcs, WithRTakeTheLargerScale) {
    // Fanuc's example: from (0, 100) to (200, 0) with the radius 200.
    const Ran ran =
        run_text("G0 X0 Y100.\nG51 X0 Y0 Z0 I2000 J1000\nG2 X100. Y0 R100. F500\nM30\n");
    ASSERT_FALSE(ran.run.error) << ran.run.error->message;
    // The centre is 200 from both ends, below the chord: the intersection of two circles.
    const double half = 0.5 * std::hypot(200.0, 100.0), height = std::sqrt(40000.0 - half * half);
    const double x = 100.0 - height * 100.0 / (2.0 * half),
                 y = 50.0 - height * 200.0 / (2.0 * half);
    size_t count = 0;
    for (const CanonicalCommand& command : ran.run.blocks[2].commands) {
        const auto& end = std::get<StraightFeed>(command).end;
        EXPECT_NEAR(std::hypot(2.0 * *end[0] - x, *end[1] - y), 200.0, 1e-9);
        ++count;
    }
    EXPECT_GT(count, 100u);
    EXPECT_THAT(warnings_of(ran.run), HasSubstr("an arc of radius 200 mm"));
}

} // namespace
} // namespace gcode
