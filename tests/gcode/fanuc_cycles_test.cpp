#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The actions of a program after its first block: r rapid, f feed, each with X and Z; d dwell; the
/// spindle cw, ccw, off; stop.
std::string steps(const std::string& text, DialectId dialect = DialectId::fanuc) {
    const Ran ran = run_text("G21 G0 Z20\n" + text, dialect);
    if (ran.run.error) return ran.run.error->message;
    std::string found;
    const auto place = [](char kind, const Position& end) {
        return fmt::format(" {}{:g},{:g}", kind, *end[0], *end[2]);
    };
    for (const BlockCommands& block : ran.run.blocks) {
        if (block.line == 1) continue;
        for (const CanonicalCommand& command : block.commands) {
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                found += place('r', rapid->end);
            else if (const auto* feed = std::get_if<StraightFeed>(&command))
                found += place('f', feed->end);
            else if (std::holds_alternative<Dwell>(command))
                found += " d";
            else if (std::holds_alternative<ProgramStop>(command))
                found += " stop";
            else if (const auto* spindle = std::get_if<Spindle>(&command))
                found += spindle->direction == core::SpindleDirection::stopped     ? " off"
                         : spindle->direction == core::SpindleDirection::clockwise ? " cw"
                                                                                   : " ccw";
        }
    }
    return found;
}

TEST(FanucCycle, RotaryWordsTurnBeforeTheHole) {
    const std::string turned = "straight_traverse x=1 y=0 z=20 a=90\n"
                               "straight_traverse x=1 y=0 z=2 a=90\n"
                               "straight_feed x=1 y=0 z=-5 a=90 feed=100\n"
                               "straight_traverse x=1 y=0 z=20 a=90\n"
                               "straight_traverse x=1 y=0 z=20 a=180 b=20\n"
                               "straight_traverse x=1 y=0 z=2 a=180 b=20\n";
    const std::string text =
        "G21\nG0 X0 Y0 Z20\nF100\n\nG98 G81 X1. Z-5. R2. A90.\nA180. B20.\nG80\n";
    EXPECT_THAT(trace(text, DialectId::fanuc), HasSubstr(turned));
    EXPECT_THAT(trace(text, DialectId::haas), HasSubstr(turned));
}

TEST(FanucCycle, RepeatedHolesTurnByTheSameAngle) {
    const std::string text = "G21\nG0 X0 Y0 Z20\nG91 G81 Z-5. R-2. F100. A30. L3\n";
    const std::string found = trace(text, DialectId::haas);
    for (const std::string angle : {"a=30", "a=60", "a=90"})
        EXPECT_THAT(found, HasSubstr("straight_feed x=0 y=0 z=13 " + angle + " feed=100"));
    EXPECT_THAT(found, Not(HasSubstr("a=120")));
}

TEST(FanucCycle, RepeatedHolesInPolarCoordinatesStayOnTheCircle) {
    const std::string found = trace("G21 G16\nG0 X0 Y0 Z20\nG81 X50. Y60. Z-5. R2. F100.\n"
                                    "G91 Y30. K2\n");
    for (const std::string place : {"x=25 y=43.30127", "x=0 y=50", "x=-25 y=43.30127"})
        EXPECT_THAT(found, HasSubstr("straight_feed " + place)) << found;
}

TEST(FanucCycle, RefusesAxesOfWhichTheUseIsUnknown) {
    EXPECT_THAT(steps("G81 X1 Z-8 R3 W-2 F50"), HasSubstr("whether Z or W drills"));
    EXPECT_THAT(steps("G81 X1 Z-8 R3 A90 F50 K0"), HasSubstr("only defines its cycle"));
    EXPECT_EQ(error_of("G21\nG0 X0 Y0 Z5 A90\nG81 X1 Z-8 R3 A90 F50 K0"), "");
    EXPECT_THAT(error_of("G0 X0 Y0 Z5\nG12 I5 D1 Z-1 F100 A90", DialectId::haas),
                HasSubstr("G12 moves X, Y and Z only"));
}

TEST(FanucCycle, G84TapsInAndOutWithTheSpindleReversed) {
    EXPECT_EQ(steps("S500 M3\nG99 G84 X1 Z-8 R3 P500 F500"), " cw r1,20 r1,3 f1,-8 d ccw f1,3 cw");
    EXPECT_EQ(steps("S500 M3\nG98 G84 X1 Z-8 R3 F500"), " cw r1,20 r1,3 f1,-8 ccw f1,3 cw r1,20");
}

TEST(FanucCycle, G74TapsLeftHandThreads) {
    EXPECT_EQ(steps("S500 M4\nG99 G74 X1 Z-8 R3 F500"), " ccw r1,20 r1,3 f1,-8 cw f1,3 ccw");
}

TEST(FanucCycle, RigidTappingStartsTheSpindleItself) {
    EXPECT_EQ(steps("M29 S500\nG99 G84 X1 Z-8 R3 F500"), " r1,20 r1,3 cw f1,-8 ccw f1,3 cw off");
    EXPECT_THAT(trace("G0 Z9\nM29 S500\nG95 G84 X1 Z-8 R3 F1.25"), HasSubstr("feed=625"));
    EXPECT_EQ(error_of("S500 G95 G84 X1 Z-8 R3 F1.25 J2", DialectId::haas), "");
}

TEST(FanucCycle, QTapsInPecks) {
    EXPECT_EQ(steps("S500 M3\nG99 G84 X1 Z-8 R3 Q5 F500"),
              " cw r1,20 r1,3 f1,-2 ccw f1,3 cw f1,-7 ccw f1,3 cw f1,-8 ccw f1,3 cw");
}

TEST(FanucCycle, G76LeavesTheWallBeforeItComesOut) {
    EXPECT_EQ(steps("S500 M3\nG99 G76 X1 Z-8 R3 Q0.5 P100 F50"),
              " cw r1,20 r1,3 f1,-8 d off r1.5,-8 r1.5,3 r1,3 cw");
    EXPECT_EQ(steps("S500 M3\nG98 G76 X1 Z-8 R3 I-0.5 J0 F50", DialectId::haas),
              " cw r1,20 r1,3 f1,-8 off r0.5,-8 r0.5,20 r1,20 cw");
    EXPECT_THAT(warnings_of("G0 Z5\nG76 X1 Z-8 R3 Q0.5 F50"), HasSubstr("+X is assumed"));
}

TEST(FanucCycle, G87BoresFromTheBack) {
    const std::string path = " cw r1,20 off r1.5,20 r1.5,-30 r1,-30 cw f1,-10 d off r1.5,-10 "
                             "r1.5,20 r1,20 cw";
    EXPECT_EQ(steps("S500 M3\nG98 G87 X1 Z-10 R-30 Q0.5 P1000 F50"), path);
    EXPECT_EQ(steps("S500 M3\nG98 G77 X1 Z-10 R-30 Q0.5 P1000 F50", DialectId::haas), path);
    EXPECT_THAT(steps("G98 G87 X1 Z-10 R3 Q0.5 F50"), HasSubstr("works upwards"));
    EXPECT_THAT(steps("G99 G87 X1 Z-10 R-30 Q0.5 F50"), HasSubstr("use G98"));
}

TEST(FanucCycle, G88StopsForARetractByHand) {
    const std::string path = " cw r1,20 r1,3 f1,-8 d off stop r1,3 cw";
    EXPECT_EQ(steps("S500 M3\nG99 G88 X1 Z-8 R3 P100 F50"), path);
    EXPECT_EQ(steps("S500 M3\nG99 G88 X1 Z-8 R3 P100 F50", DialectId::haas), path);
    EXPECT_EQ(steps("S500 M3\nG99 G87 X1 Z-8 R3 P100 F50", DialectId::haas), path);
}

TEST(FanucCycle, G85FeedsOutToRAndThenRetractsInARapid) {
    EXPECT_EQ(steps("G98 G85 X1 Z-8 R3 F50"), " r1,20 r1,3 f1,-8 f1,3 r1,20");
    EXPECT_EQ(steps("G98 G89 X1 Z-8 R3 P100 F50"), " r1,20 r1,3 f1,-8 d f1,3 r1,20");
    EXPECT_EQ(steps("F50 G98 G85 X1 Z-8 R3", DialectId::linuxcnc), " r1,20 r1,3 f1,-8 f1,3 r1,20");
    EXPECT_EQ(steps("F50 G98 G89 X1 Z-8 R3 P1", DialectId::linuxcnc), " r1,20 r1,3 f1,-8 d f1,20");
}

TEST(FanucCycle, AllCountFromTheInitialLevelUnderG91) {
    EXPECT_EQ(steps("S500 M3\nG91 G99 G84 X1 Z-8 R-17 K2 F500"),
              " cw r1,20 r1,3 f1,-5 ccw f1,3 cw r2,3 f2,-5 ccw f2,3 cw");
    EXPECT_EQ(steps("S500 M3\nG91 G98 G87 X1 Z20 R-50 Q1 F50"),
              " cw r1,20 off r2,20 r2,-30 r1,-30 cw f1,-10 off r2,-10 r2,20 r1,20 cw");
}

TEST(FanucCycle, ShiftsInThePlaneThatIsActive) {
    EXPECT_EQ(trace("G0 Y20\nG18 G99 G76 X1 Z1 Y-2 R3 Q0.5 F100"),
              "straight_traverse x=0 y=20 z=0\n"
              "select_plane plane=ZX\n"
              "straight_traverse x=1 y=20 z=1\n"
              "straight_traverse x=1 y=3 z=1\n"
              "straight_feed x=1 y=-2 z=1 feed=100\n"
              "spindle direction=stopped speed=0\n"
              "straight_traverse x=1 y=-2 z=1.5\n"
              "straight_traverse x=1 y=3 z=1.5\n"
              "straight_traverse x=1 y=3 z=1\n"
              "spindle direction=stopped speed=0\n");
}

TEST(FanucCycle, TheSignOfQIsPassedOver) {
    EXPECT_EQ(steps("G99 G83 X1 Z-8 R3 Q-8 F50"), steps("G99 G83 X1 Z-8 R3 Q8 F50"));
    EXPECT_THAT(steps("G99 G83 X1 Z-8 R3 Q0 F50"),
                HasSubstr("the peck depth must be greater than 0"));
}

TEST(FanucCycle, ScalingLeavesPecksAsTheyAre) {
    // R and Z are scaled by 2; Q and the retract of 1 mm of G83 are not.
    EXPECT_EQ(steps("G51 X0 Y0 Z0 P2000\nG99 G83 X1 Z-4 R1 Q6 F50"),
              " r1,10 r1,1 f1,-2 r1,1 r1,-1.5 f1,-4 r1,1");
}

/// The holes of a Haas program: X and Y of its feed moves.
std::string holes(const std::string& text) {
    const Ran ran = run_text("G21 G0 X10 Y20 Z20\n" + text, DialectId::haas);
    if (ran.run.error) return ran.run.error->message;
    std::string found;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* feed = std::get_if<StraightFeed>(&command))
                found += fmt::format(" {:.4g},{:.4g}", *feed->end[0], *feed->end[1]);
    return found;
}

TEST(HolePattern, G70DrillsACircle) {
    const std::string circle = " 10,25 5,20 10,15 15,20";
    EXPECT_EQ(holes("G81 Z-1 R1 F9 L0\nG70 I5 J90 L4\nG80"), circle);
    EXPECT_EQ(holes("G81 Z-1 R1 F9 G70 I5 J90 L4\nG80"), circle);
    EXPECT_EQ(holes("G81 Z-1 R1 F9 L0\nG70 X0 Y0 I5 L2"), " 5,0 -5,0");
    EXPECT_EQ(holes("G76 Z-1 R1 Q0.1 F9 L0\nG70 I5 L2"), " 15,20 5,20");
}

TEST(HolePattern, G71DrillsAnArcAndG72ALine) {
    EXPECT_EQ(holes("G81 Z-1 R1 F9 L0\nG71 I5 J0 K-90 L3"), " 15,20 10,15 5,20");
    EXPECT_EQ(holes("G81 Z-1 R1 F9 L0\nG72 I5 J90 L3"), " 10,20 10,25 10,30");
}

TEST(HolePattern, PocketsAndEngravingAreRefusedWithACure) {
    EXPECT_THAT(error_of("G150 P1 Z-1", DialectId::haas), HasSubstr("program the passes"));
    EXPECT_THAT(error_of("G47 P0 X1 Y1", DialectId::haas), HasSubstr("program the letters"));
}

TEST(HolePattern, NeedsACycleAndItsWords) {
    EXPECT_THAT(holes("G70 I5 L4"), HasSubstr("program one, such as G81"));
    EXPECT_THAT(holes("G81 Z-1 R1 F9 L0\nG70 I5"), HasSubstr("needs an L word"));
    EXPECT_THAT(holes("G81 Z-1 R1 F9 L0\nG71 I5 L3"), HasSubstr("needs a K word"));
}

} // namespace
} // namespace gcode
