#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/klartext_programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// Kind and position of each motion, dwell and spindle command: r for rapid, f for feed.
std::string cycle(std::string_view lines) {
    const Ran ran = run_text(klartext_program(lines), DialectId::heidenhain);
    std::string text;
    const auto place = [](const Position& end) {
        return fmt::format("({:g},{:g},{:g}) ", *end[0], *end[1], *end[2]);
    };
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands) {
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                text += "r" + place(rapid->end);
            if (const auto* feed = std::get_if<StraightFeed>(&command))
                text += fmt::format("f{:g}", feed->feed) + place(feed->end);
            if (const auto* arc = std::get_if<ArcFeed>(&command))
                text += fmt::format("a{:g}", arc->feed) + place(arc->end);
            if (const auto* dwell = std::get_if<Dwell>(&command))
                text += fmt::format("d{:g} ", dwell->seconds);
            if (const auto* spindle = std::get_if<Spindle>(&command))
                text += fmt::format("s{} ", int(spindle->direction));
        }
    return ran.run.error ? text + ran.run.error->message : text;
}

constexpr std::string_view drilling = "CYCL DEF 200 DRILLING ~\n"
                                      " Q200=2 ;SET-UP CLEARANCE ~\n"
                                      " Q201=-10 ;DEPTH ~\n"
                                      " Q206=150 ;FEED ~\n"
                                      " Q202=6 ;PLUNGING DEPTH ~\n"
                                      " Q210=0.5 ;DWELL ABOVE ~\n"
                                      " Q203=+1 ;SURFACE ~\n"
                                      " Q204=50 ;2ND CLEARANCE ~\n"
                                      " Q211=0.2 ;DWELL BELOW\n";

TEST(KlartextCycle, DrillsInPecks) {
    // Surface at 1: set-up clearance at 3, first peck to -5, bottom at -9, second clearance at 51.
    EXPECT_EQ(cycle(std::string(drilling) + "L X+5 Y+6 FMAX M99\n"),
              "r(5,6,0) r(5,6,3) f150(5,6,-5) r(5,6,3) d0.5 r(5,6,-3) f150(5,6,-9) d0.2 r(5,6,3) "
              "r(5,6,51) ");
}

TEST(KlartextCycle, M89CallsAfterEveryMotionUntilM99) {
    const std::string peck = "CYCL DEF 200 A Q200=2 Q201=-5 Q206=100 Q202=5 Q210=0 Q203=0 Q204=0 "
                             "Q211=0\n";
    EXPECT_EQ(cycle(peck + "L X+1 FMAX M89\nL X+2 FMAX\nL X+3 FMAX M99\nL X+4 FMAX\nCYCL CALL\n"),
              "r(1,0,0) r(1,0,2) f100(1,0,-5) r(1,0,2) "
              "r(2,0,2) r(2,0,2) f100(2,0,-5) r(2,0,2) "
              "r(3,0,2) r(3,0,2) f100(3,0,-5) r(3,0,2) "
              "r(4,0,2) r(4,0,2) f100(4,0,-5) r(4,0,2) ");
}

TEST(KlartextCycle, OldPeckingStartsWhereTheToolIs) {
    // 25 above the surface at 0; the rapid back into the hole ends 0.6 above the last peck.
    EXPECT_EQ(cycle("CYCL DEF 1.0 PECKING\nCYCL DEF 1.1 DIST25.000\nCYCL DEF 1.2 DEPTH-5\nCYCL DEF "
                    "1.3 PLNGNG3.0\nCYCL DEF 1.4 DWELL0\nCYCL DEF 1.5 F224\nL X+15 Z+25 FMAX\nL "
                    "FMAX M99\n"),
              "r(15,0,25) f224(15,0,-3) r(15,0,25) r(15,0,-2.4) f224(15,0,-5) r(15,0,25) ");
}

TEST(KlartextCycle, ReamsOutWithItsOwnFeed) {
    EXPECT_EQ(cycle("CYCL DEF 201 REAMING Q200=2 Q201=-15 Q206=100 Q211=0.5 Q208=250 Q203=+0 "
                    "Q204=20\nCYCL CALL POS X+1 Y+2 Z+0 FMAX\n"),
              "r(1,2,0) r(1,2,2) f100(1,2,-15) d0.5 f250(1,2,2) r(1,2,20) ");
}

TEST(KlartextCycle, BoresAndMovesOffTheWall) {
    EXPECT_EQ(cycle("L X+5 FMAX M3\nCYCL DEF 202 BORING Q200=2 Q201=-15 Q206=100 Q211=0 Q208=250 "
                    "Q203=+0 Q204=0 Q214=1\nCYCL CALL\n"),
              "s1 r(5,0,0) r(5,0,2) f100(5,0,-15) s0 f100(4.8,0,-15) f250(4.8,0,2) r(5,0,2) s1 ");
}

TEST(KlartextCycle, UniversalDrillingShortensItsPecksAndBreaksChips) {
    // 5, then 4: one break, then out; then 3 to the bottom at -12.
    EXPECT_EQ(cycle("CYCL DEF 203 UNIVERSAL Q200=2 Q201=-12 Q206=100 Q202=5 Q210=0 Q203=0 Q204=0 "
                    "Q212=1 Q213=1 Q205=3 Q211=0 Q208=500 Q256=0.2\nCYCL CALL\n"),
              "r(0,0,2) f100(0,0,-5) f100(0,0,-4.8) f100(0,0,-9) r(0,0,2) r(0,0,-7) f100(0,0,-12) "
              "f500(0,0,2) ");
}

TEST(KlartextCycle, TapsWithTheSpindlesPitch) {
    EXPECT_EQ(cycle("TOOL CALL 0 Z S500\nCYCL DEF 207 RIGID TAPPING Q200=2 Q201=-20 Q239=+1 Q203=0 "
                    "Q204=0\nCYCL CALL\n"),
              "r(0,0,2) s1 f500(0,0,-20) s2 f500(0,0,2) s0 ");
}

TEST(KlartextCycle, MillsABoreAlongAHelix) {
    // A bore of 20 with a tool of radius 4: 6 from the centre, from 2 down to -3 in steps of 3.
    EXPECT_EQ(cycle("TOOL DEF 1 L+0 R+4\nTOOL CALL 1 Z S500\nCYCL DEF 208 BORE Q200=2 Q201=-3 "
                    "Q206=100 Q334=3 Q203=0 Q204=0 Q335=20 Q342=0\nCYCL CALL\n"),
              "r(0,0,2) f100(6,0,2) a100(6,0,-1) a100(6,0,-3) a100(6,0,-3) f100(0,0,-3) "
              "r(0,0,2) ");
}

TEST(KlartextCycle, PatternsCallTheCycleAtEveryPosition) {
    const std::string peck = "CYCL DEF 200 A Q200=2 Q201=-5 Q206=100 Q202=5 Q210=0 Q203=0 Q204=0 "
                             "Q211=0\n";
    EXPECT_EQ(cycle(peck
                    + "CYCL DEF 221 ROWS Q225=10 Q226=20 Q237=5 Q238=3 Q242=2 Q243=2 Q224=0 "
                      "Q200=2 Q203=0 Q204=9 Q301=0\n"),
              "r(0,0,9) r(10,20,9) r(10,20,2) f100(10,20,-5) r(10,20,2) "
              "r(15,20,2) r(15,20,2) f100(15,20,-5) r(15,20,2) "
              "r(15,23,2) r(15,23,2) f100(15,23,-5) r(15,23,2) "
              "r(10,23,2) r(10,23,2) f100(10,23,-5) r(10,23,2) r(10,23,9) ");
    EXPECT_THAT(cycle(peck
                      + "CYCL DEF 220 CIRCLE Q216=50 Q217=50 Q244=20 Q245=0 Q246=360 Q247=0 "
                        "Q241=4 Q200=2 Q203=0 Q204=9 Q301=1\n"),
                HasSubstr("r(50,60,9) r(50,60,2) f100(50,60,-5) r(50,60,2) r(50,60,9) r(40,50,9)"));
}

TEST(KlartextCycle, RefusesWhatWouldGoWrong) {
    EXPECT_THAT(klartext_error("CYCL CALL\n"), HasSubstr("there is no cycle to call"));
    EXPECT_THAT(klartext_error("CYCL DEF 200 A Q200=2 Q201=5 Q206=100\nCYCL CALL\n"),
                HasSubstr("program a negative depth"));
    EXPECT_THAT(klartext_error("CYCL DEF 251 POCKET Q215=0\n"),
                HasSubstr("'CYCL DEF 251': this cycle is not supported"));
    EXPECT_THAT(klartext_error("CYCL DEF 221 ROWS Q242=2 Q243=2\n"),
                HasSubstr("a cycle from 200 on"));
}

} // namespace
} // namespace gcode
