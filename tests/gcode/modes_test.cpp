#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

TEST(Units, InchesBecomeMillimetresOnce) {
    EXPECT_EQ(trace("G20 G0 X1 Y-0.5\nG1 Z0.1 F10\nG21 X1 F10"),
              "straight_traverse x=25.4 y=-12.7 z=0\n"
              "straight_feed x=25.4 y=-12.7 z=2.54 feed=254\n"
              "straight_feed x=1 y=-12.7 z=2.54 feed=10\n");
}

TEST(Units, OfTheFeedOfRotaryAxesAreDegrees) {
    EXPECT_EQ(trace("G20\nG1 A90 F600\nX1 A0\nA90\nG21 A0\nF600 A90\nG20\nA0", DialectId::linuxcnc),
              "straight_feed x=0 y=0 z=0 a=90 feed=600\n"
              "straight_feed x=25.4 y=0 z=0 feed=15240\n"
              "straight_feed x=25.4 y=0 z=0 a=90 feed=600\n"
              "straight_feed x=25.4 y=0 z=0 feed=600\n"
              "straight_feed x=25.4 y=0 z=0 a=90 feed=600\n"
              "straight_feed x=25.4 y=0 z=0 feed=600\n");
}

TEST(Units, FeedAndUnitsInOneBlockGoByTheDialect) {
    EXPECT_EQ(trace("G20\nG21 G1 X1 F10", DialectId::fanuc), "straight_feed x=1 y=0 z=0 feed=10\n");
    // RS274/NGC: F takes effect before the units change.
    EXPECT_EQ(trace("G20\nG21 G1 X1 F10", DialectId::linuxcnc),
              "straight_feed x=1 y=0 z=0 feed=254\n");
}

TEST(Units, StartAsTheDialectHasThem) {
    EXPECT_EQ(trace("G0 X1", DialectId::linuxcnc), "straight_traverse x=1 y=0 z=0\n");
    Environment inches = known_environment(DialectId::linuxcnc);
    inches.machine_unit = LengthUnit::inch;
    EXPECT_EQ(commands_of(run_text("G0 X1", inches).run), "straight_traverse x=25.4 y=0 z=0\n");
    EXPECT_EQ(trace("G0 X1", DialectId::grbl), "straight_traverse x=1 y=0 z=0\n");
}

TEST(Distance, IncrementsAddToWhereTheToolIs) {
    EXPECT_EQ(trace("G0 X5\nG91 X2 Z-1\nX2\nG90 X2"), "straight_traverse x=5 y=0 z=0\n"
                                                      "straight_traverse x=7 y=0 z=-1\n"
                                                      "straight_traverse x=9 y=0 z=-1\n"
                                                      "straight_traverse x=2 y=0 z=-1\n");
}

TEST(FeedMode, InverseTimeGivesTheRateOfThePath) {
    // 5 mm in 1/10 of a minute.
    EXPECT_EQ(trace("G93 G1 X3 Y4 F10"), "straight_feed x=3 y=4 z=0 feed=50\n");
    EXPECT_EQ(error_of("G93 G1 X3 F10\nX4"),
              "2:1: X4: with G93 each feed move needs its own F word");
    // Half a circle of radius 10 in a minute.
    EXPECT_THAT(trace("G93 G3 X20 I10 F1"), HasSubstr("feed=31.415927"));
}

TEST(FeedMode, PerTurnNeedsATurningSpindle) {
    EXPECT_EQ(trace("S1000 M3\nG95 G1 X1 F0.2"), "spindle direction=clockwise speed=1000\n"
                                                 "straight_feed x=1 y=0 z=0 feed=200\n");
    EXPECT_THAT(error_of("G95 G1 X1 F0.2"), HasSubstr("1:5: G1: G95 gives no feed rate here"));
}

TEST(FeedMode, ARateOfOneModeDoesNotCountInAnother) {
    EXPECT_THAT(error_of("G94 F100\nS100 M3\nG95 G1 X1"), HasSubstr("no feed rate"));
    EXPECT_EQ(error_of("G94 F100\nG94 G1 X1"), "");
}

TEST(Dwell, CountsAsTheDialectDoes) {
    EXPECT_EQ(trace("G4 P1.5", DialectId::linuxcnc), "dwell seconds=1.5\n");
    EXPECT_EQ(trace("G4 P500", DialectId::linuxcnc), "dwell seconds=500\n");
    EXPECT_EQ(trace("G4 P500", DialectId::fanuc), "dwell seconds=0.5\n");
    EXPECT_EQ(trace("G4 P1.5", DialectId::haas), "dwell seconds=1.5\n");
    EXPECT_EQ(trace("G4 X2.\nG4 U0.5", DialectId::fanuc), "dwell seconds=2\ndwell seconds=0.5\n");
    EXPECT_EQ(error_of("G4"), "1:1: G4 has no time: it needs a P word");
    EXPECT_THAT(error_of("G4 P-1"), HasSubstr("1:4: P-1"));
}

TEST(Dwell, ItsXWordMovesNothing) {
    EXPECT_EQ(trace("G0 X5\nG4 X2."), "straight_traverse x=5 y=0 z=0\ndwell seconds=2\n");
}

TEST(Spindle, TurnsStopsAndChangesSpeed) {
    EXPECT_EQ(trace("S100\nM3\nS200\nM4 S300\nM5\nM19"),
              "spindle direction=clockwise speed=100\n"
              "spindle direction=clockwise speed=200\n"
              "spindle direction=counterclockwise speed=300\n"
              "spindle direction=stopped speed=0\n"
              "spindle direction=stopped speed=0\n");
}

TEST(Coolant, HasMistAndFlood) {
    EXPECT_EQ(trace("M7\nM8\nM9"), "coolant mist=1 flood=0\n"
                                   "coolant mist=1 flood=1\n"
                                   "coolant mist=0 flood=0\n");
}

TEST(Tools, AreSelectedByTAndChangedByM6) {
    EXPECT_EQ(trace("T3\nM6\nT4 M6\nT0 M6"), "select_tool tool=3\nchange_tool tool=3\n"
                                             "select_tool tool=4\nchange_tool tool=4\n"
                                             "select_tool tool=0\nchange_tool tool=0\n");
    EXPECT_EQ(error_of("M6"),
              "1:1: M6 has no tool to change to: no T word has been programmed yet");
    EXPECT_THAT(error_of("T1.5 M6"),
                HasSubstr("1:1: T1.5: T must be a whole number from 0 to 99999999"));
    EXPECT_THAT(error_of("T-1 M6"), HasSubstr("1:1: T-1"));
}

TEST(Tools, AChangeStopsTheSpindle) {
    EXPECT_EQ(trace("S100 M3\nT1 M6"), "spindle direction=clockwise speed=100\n"
                                       "select_tool tool=1\n"
                                       "spindle direction=stopped speed=0\n"
                                       "change_tool tool=1\n");
}

} // namespace
} // namespace gcode
