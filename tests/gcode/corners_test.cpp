#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// The end points of the feed moves of a program, with the centres of arcs.
std::string path_of(std::string_view text) {
    const Ran ran = run_text(text);
    std::string path;
    const auto add = [&](const Position& end) {
        path += std::to_string(std::lround(*end[0] * 1000)) + ","
                + std::to_string(std::lround(*end[1] * 1000));
    };
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands) {
            if (const auto* line = std::get_if<StraightFeed>(&command)) {
                add(line->end);
                path += " ";
            }
            if (const auto* arc = std::get_if<ArcFeed>(&command)) {
                add(arc->end);
                path += "(" + std::to_string(std::lround(arc->centre[0] * 1000)) + ","
                        + std::to_string(std::lround(arc->centre[1] * 1000)) + ","
                        + std::to_string(arc->turns) + ") ";
            }
        }
    if (ran.run.error) path += "error: " + ran.run.error->message;
    return path;
}

TEST(Corners, RoundARightAngleBetweenTwoLines) {
    EXPECT_EQ(path_of("G1 X20. F100 ,R5.\nY20.\nM30\n"),
              "15000,0 20000,5000(15000,5000,1) 20000,20000 ");
}

TEST(Corners, AreChamferedByTheDistanceFromTheCorner) {
    EXPECT_EQ(path_of("G1 X20. F100 ,C2.\nY20.\nM30\n"), "18000,0 20000,2000 20000,20000 ");
}

TEST(Corners, RoundBetweenALineAndAnArcTouchingBoth) {
    // 2 away from the line and 12 from the centre of the arc: (18, 10 - sqrt(140)).
    EXPECT_EQ(path_of("G0 X20. Y-20.\nG1 Y0 F100 ,R2.\nG2 X10. Y10. J10.\nM30\n"),
              "20000,-1832 18333,140(18000,-1832,1) 10000,10000(20000,10000,-1) ");
}

TEST(Corners, RoundBetweenTwoArcsTouchingBoth) {
    // Clockwise about (10, 0), then counterclockwise about (20, 10): 12 from the first centre, 8
    // from the second.
    EXPECT_EQ(path_of("G2 X20. I10. F100 ,R2.\nG3 X30. Y10. J10.\nM30\n"),
              "19830,1837(10000,0,-1) 22245,255(21796,2204,1) 30000,10000(20000,10000,1) ");
    EXPECT_THAT(error_of("G2 X20. I10. F100 ,R2.\nG2 X40. I10.\nM30\n"), // back again
                HasSubstr("no corner of this size"));
}

TEST(Corners, ChamferAnArcByTheWayAsTheCrowFlies) {
    // On the circle of 10 about (10, 0), 2 away from (20, 0): u = 20 - 0.2.
    EXPECT_EQ(path_of("G2 X20. I10. F100 ,C2.\nG1 X30.\nM30\n"),
              "19800,1990(10000,0,-1) 22000,0 30000,0 ");
}

TEST(Corners, FollowOneAnother) {
    EXPECT_EQ(path_of("G1 X20. F100 ,R5.\nY20. ,C3.\nX0 ,R4.\nY0\nM30\n"),
              "15000,0 20000,5000(15000,5000,1) 20000,17000 17000,20000 4000,20000 "
              "0,16000(4000,16000,1) 0,0 ");
}

TEST(Corners, AreMadeOnceADwellHasPassed) {
    EXPECT_EQ(path_of("G1 X20. F100 ,R5.\nG4 P100\nY20.\nM30\n"),
              "15000,0 20000,5000(15000,5000,1) 20000,20000 ");
}

TEST(Corners, BelongToTheBlockTheyAreWrittenIn) {
    const Ran ran = run_text("G1 X20. F100 ,R5.\nY20.\nM30\n");
    ASSERT_EQ(ran.run.blocks.size(), 3u);
    EXPECT_EQ(ran.run.blocks[0].line, 1u);
    EXPECT_EQ(ran.run.blocks[0].commands.size(), 2u);
    EXPECT_EQ(ran.run.blocks[0].columns[1], 14u);
    EXPECT_EQ(ran.run.blocks[1].commands.size(), 1u);
}

TEST(Corners, CountIncrementsFromTheCornerThatWasProgrammed) {
    EXPECT_EQ(path_of("G91 G1 X20. F100 ,R5.\nY20.\nX-5.\nM30\n"),
              "15000,0 20000,5000(15000,5000,1) 20000,20000 15000,20000 ");
}

TEST(Corners, AreNotThereWithinADegreeOfStraightOn) {
    EXPECT_EQ(path_of("G1 X20. F100 ,R5.\nX40. Y0.3\nM30\n"), "20000,0 40000,300 ");
    EXPECT_THAT(path_of("G1 X20. F100 ,R5.\nX40. Y0.5\nM30\n"), HasSubstr("("));
}

TEST(Corners, TakeAWholeMove) {
    EXPECT_EQ(path_of("G1 X5. F100 ,R5.\nY5.\nM30\n"), "5000,5000(0,5000,1) 5000,5000 ");
}

TEST(Corners, ThatDoNotFitAreRefusedWithTheirWord) {
    EXPECT_EQ(error_of("G1 X20. F100\nG1 Y4. ,R5.\nX0\nM30\n"),
              "2:8: ,R5: the corner is too large for the motions before and after it; the control "
              "stops with an alarm (PS0055 on Fanuc)");
}

TEST(Corners, NeedAMotionInThePlaneAfterThem) {
    EXPECT_THAT(error_of("G1 X20. F100 ,R5.\nM30\n"),
                HasSubstr("in the plane, but the program ends"));
    EXPECT_THAT(error_of("G1 X20. F100 ,R5.\n"), HasSubstr("the program ends"));
    EXPECT_THAT(error_of("G1 X20. F100 ,R5.\nM8\nY20.\n"), HasSubstr("only a dwell"));
    EXPECT_THAT(error_of("G1 X20. F100 ,R5.\nZ5.\n"), HasSubstr("leaves the plane"));
    EXPECT_THAT(error_of("G1 X20. F100 ,R5.\nG0 Y5.\n"), HasSubstr("a rapid follows"));
    EXPECT_THAT(error_of("G1 X20. F100 ,R5.\nG18 Z5.\n"),
                HasSubstr("only a dwell is allowed between the two motions"));
}

TEST(Corners, ThatFailLeaveTheirBlockAsProgrammed) {
    for (const char* rest : {"M8\nY20.\n", ""}) {
        const Ran ran = run_text(std::string("G1 X20. F100 ,R5.\n") + rest);
        EXPECT_TRUE(ran.run.error);
        ASSERT_EQ(ran.run.blocks.size(), 1u) << rest;
        EXPECT_EQ(ran.run.blocks[0].line, 1u);
    }
    EXPECT_THAT(path_of("G1 X20. F100 ,R5.\nM8\nY20.\n"), HasSubstr("20000,0 error"));
}

TEST(Corners, BelongToFeedsOnly) {
    EXPECT_THAT(error_of("G0 X20. ,R5.\nG1 Y20. F100\n"),
                HasSubstr("a corner must be programmed in"));
    EXPECT_THAT(error_of("G1 X20. F100 ,R5. ,C2.\nY20.\n"), HasSubstr("one corner"));
}

TEST(Corners, AreMovedAsideWithTheContour) {
    // 2 to the left of the line along Y = 0 and of the corner's arc: the radius 5 becomes 3.
    EXPECT_EQ(path_of("G10 L12 P1 R2.\nG1 G41 D1 X10. F100\nX30. ,R5.\nY20.\nG40 X40.\nM30\n"),
              "10000,2000 25000,2000 28000,5000(25000,5000,1) 28000,20000 40000,20000 ");
}

TEST(Corners, OfMetricAndInchProgramsAreInTheirUnits) {
    EXPECT_EQ(path_of("G20\nG1 X2. F10 ,R.5\nY2.\nM30\n"),
              "38100,0 50800,12700(38100,12700,1) 50800,50800 ");
}

TEST(AngleWords, GiveTheOtherCoordinateOfALine) {
    EXPECT_EQ(path_of("G1 X20. ,A45. F100\nY0 ,A-90.\nM30\n"), "20000,20000 20000,0 ");
}

TEST(AngleWords, WithoutASingleEndAreRefused) {
    EXPECT_THAT(error_of("G1 X20. Y5. ,A45. F100\n"), HasSubstr("not both"));
    EXPECT_THAT(error_of("G1 X20. ,A90. F100\n"), HasSubstr("does not change"));
}

} // namespace
} // namespace gcode
