#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/klartext_programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

TEST(KlartextCorner, RoundsBetweenTwoLines) {
    EXPECT_EQ(klartext("L X+0 Y+0 F100\nL X+20\nRND R5 F50\nL Y+20\n"),
              "straight_feed x=0 y=0 z=0 feed=100\n"
              "straight_feed x=15 y=0 z=0 feed=100\n"
              "arc_feed x=20 y=5 z=0 plane=XY centre=15,5 turns=1 feed=50\n"
              "straight_feed x=20 y=20 z=0 feed=100\n");
}

TEST(KlartextCorner, ChamfersBothLegsByItsLength) {
    EXPECT_EQ(klartext("L X+0 Y+0 F100\nL X+20\nCHF 4\nL Y-20\n"),
              "straight_feed x=0 y=0 z=0 feed=100\n"
              "straight_feed x=16 y=0 z=0 feed=100\n"
              "straight_feed x=20 y=-4 z=0 feed=100\n"
              "straight_feed x=20 y=-20 z=0 feed=100\n");
}

TEST(KlartextCorner, IncrementsCountFromTheCornerThatWasRounded) {
    EXPECT_THAT(klartext("L X+0 Y+0 F100\nL X+20\nRND R5\nL IY+10\n"),
                HasSubstr("straight_feed x=20 y=10 z=0 feed=100\n"));
}

TEST(KlartextCorner, FollowsOneAnotherAlongTheJumpsOfTheProgram) {
    EXPECT_EQ(klartext("L X+0 Y+0 F100\nL X+20\nRND R5\n; a comment\nL Y+20\nRND R2\nFN 9: IF +0 "
                       "EQU +0 GOTO LBL \"on\"\nL X+99\nLBL \"on\"\nQ1 = 3 * 10\nL X+Q1\n"),
              "straight_feed x=0 y=0 z=0 feed=100\n"
              "straight_feed x=15 y=0 z=0 feed=100\n"
              "arc_feed x=20 y=5 z=0 plane=XY centre=15,5 turns=1 feed=100\n"
              "straight_feed x=20 y=18 z=0 feed=100\n"
              "arc_feed x=22 y=20 z=0 plane=XY centre=22,18 turns=-1 feed=100\n"
              "straight_feed x=30 y=20 z=0 feed=100\n");
}

TEST(KlartextCorner, RoundsBetweenALineAndAnArc) {
    // Along X to (10,0) on the circle of radius 10 about the origin, then up along it. The centre
    // is 1 above the line and 9 from the origin: (sqrt(80),1); on the circle that is 10/9 as far.
    const std::string ran =
        klartext("L X+5 Y+0 F100\nCC X+0 Y+0\nL X+10\nRND R1\nC X+0 Y+10 DR+\n");
    EXPECT_THAT(ran, HasSubstr("straight_feed x=8.944272 y=0 z=0"));
    EXPECT_THAT(ran, HasSubstr("arc_feed x=9.93808 y=1.111111 z=0 plane=XY centre=8.944272,1 "
                               "turns=1"));
    EXPECT_THAT(ran, HasSubstr("arc_feed x=0 y=10 z=0 plane=XY centre=0,0 turns=1"));
}

TEST(KlartextCorner, ContinuesTangentiallyAfterIt) {
    // The rounding ends upwards at (20,5); the arc to (10,15) then turns about (10,5).
    EXPECT_THAT(klartext("L X+0 Y+0 F100\nL X+20\nRND R5\nL Y+6\nCT X+10 Y+16\n"),
                HasSubstr("arc_feed x=10 y=16 z=0 plane=XY centre=10,6 turns=1"));
}

TEST(KlartextCorner, RefusesWhatDoesNotFit) {
    EXPECT_THAT(klartext_error("L X+0 Y+0 F100\nL X+20\nRND R25\nL Y+20\n"),
                HasSubstr("4:1: RND: it is too large"));
    EXPECT_THAT(klartext_error("L X+0 Y+0 F100\nL X+20\nCHF 15\nL Y+10\n"),
                HasSubstr("4:1: CHF: it is too large"));
    EXPECT_THAT(klartext_error("L X+0 Y+0 F100\nL X+20\nRND R5\n"),
                HasSubstr("4:1: RND: it must be followed by a feed move in the plane at"));
    EXPECT_THAT(klartext_error("L X+0 Y+0 F100\nL X+20\nRND\nL Y+20\n"), HasSubstr("RND needs R"));
}

} // namespace
} // namespace gcode
