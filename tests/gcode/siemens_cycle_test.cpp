#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/siemens_programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

// SINUMERIK 840D/840Di/810D, Programming Guide Cycles (PGZ), 11.02, "Drilling cycles" and "Drill
// pattern cycles": the parameters, their order and the sequences of motion.

const std::string ready = "S1000 M3\nG0 X10 Y20 Z50\nG1 F100\n";

/// The motions after those that bring the tool to the hole at X10 Y20, and the dwells.
std::string motions(const std::string& cycle) {
    const Ran ran = run_text(ready + cycle + "\n", DialectId::siemens);
    if (ran.run.error) return "error: " + ran.run.error->message;
    std::string text;
    for (const CanonicalCommand& command : ran.run.blocks.back().commands) {
        if (const auto* rapid = std::get_if<StraightTraverse>(&command))
            text += fmt::format("rapid {:g}\n", *rapid->end[2]);
        if (const auto* feed = std::get_if<StraightFeed>(&command))
            text += fmt::format("feed {:g} {:g}\n", *feed->end[2], feed->feed);
        if (const auto* dwell = std::get_if<Dwell>(&command))
            text += fmt::format("dwell {:g}\n", dwell->seconds);
        if (const auto* spindle = std::get_if<Spindle>(&command))
            text += fmt::format("spindle {} {:g}\n", int(spindle->direction), spindle->speed);
        if (std::holds_alternative<ProgramStop>(command)) text += "stop\n";
    }
    return text;
}

TEST(SiemensCycle, DrillsFromTheSafetyDistanceToTheDepth) {
    const std::string drilled = "rapid 2\nfeed -5 100\nrapid 10\n";
    EXPECT_EQ(motions("CYCLE81(10,0,2,-5)"), drilled);
    EXPECT_EQ(motions("CYCLE81(10,0,2,,5)"), drilled);
    EXPECT_EQ(motions("CYCLE81( 10 , 0 , 2 , 0 , 5 )"), drilled); // DPR takes precedence
    EXPECT_EQ(motions("R5=-5 CYCLE81(10,0,2,R5)"), drilled);
    EXPECT_EQ(motions("CYCLE82(10,0,2,-5,,0.5)"), "rapid 2\nfeed -5 100\ndwell 0.5\nrapid 10\n");
}

TEST(SiemensCycle, RefusesLevelsThatCannotBe) {
    EXPECT_THAT(motions("CYCLE81(-1,0,2,-5)"), HasSubstr("RTP at -1.0000 mm is below"));
    EXPECT_THAT(motions("CYCLE81(10,0,2,5)"), HasSubstr("above the reference plane"));
    EXPECT_THAT(motions("CYCLE81(10,0,2)"), HasSubstr("give DP or DPR"));
    EXPECT_THAT(motions("CYCLE81(,0,2,-5)"), HasSubstr("(RTP) is missing"));
    EXPECT_THAT(motions("CYCLE83(10,0,1,-20,,-25)"), HasSubstr("61107"));
    EXPECT_THAT(motions("CYCLE95(1)"), HasSubstr("'CYCLE95': this cycle is not supported yet"));
    EXPECT_THAT(siemens_error("CYCLE81(10,0,2,-5)\n"), HasSubstr("1:1: CYCLE81: no feed rate"));
    EXPECT_THAT(siemens_error("CYCLE81(10,0\n"), HasSubstr("is not closed"));
}

TEST(SiemensCycle, ClearsChipsOfDeepHoles) {
    // First 8 deep, then shorter by 3 down to 3; the rapid ends 0.6 mm above the last depth.
    EXPECT_EQ(motions("CYCLE83(10,0,1,-20,,-8,,3,0,0.2,0.5,1)"), "rapid 1\nfeed -8 50\n"
                                                                 "rapid 1\ndwell 0.2\nrapid -7.4\n"
                                                                 "feed -13 100\n"
                                                                 "rapid 1\ndwell 0.2\nrapid -12.4\n"
                                                                 "feed -16 100\n"
                                                                 "rapid 1\ndwell 0.2\nrapid -15.4\n"
                                                                 "feed -18 100\n"
                                                                 "rapid 1\ndwell 0.2\nrapid -17.4\n"
                                                                 "feed -20 100\nrapid 10\n");
}

TEST(SiemensCycle, BreaksChipsOfDeepHoles) {
    EXPECT_EQ(motions("CYCLE83(10,0,1,-12,,,5,0,0.1,0,1,0)"),
              "rapid 1\nfeed -5 100\ndwell 0.1\nfeed -4 100\nfeed -10 100\ndwell 0.1\n"
              "feed -9 100\nfeed -12 100\ndwell 0.1\nrapid 10\n");
    // A factor instead of an amount, and a programmed retract.
    EXPECT_EQ(motions("CYCLE83(10,0,1,-17.5,,,10,-0.5,0,0,1,0,,,2)"),
              "rapid 1\nfeed -10 100\nfeed -8 100\nfeed -15 100\nfeed -13 100\nfeed -17.5 100\n"
              "rapid 10\n");
}

TEST(SiemensCycle, TapsWithTheSpindle) {
    // M8 has a pitch of 1.25 mm: 125 mm/min at 100 rev/min, 250 at 200.
    EXPECT_EQ(motions("CYCLE84(10,0,2,-5,,0,3,8,,,100,200)"),
              "rapid 2\nspindle 1 100\nfeed -5 125\nspindle 2 200\nfeed 2 250\nspindle 1 1000\n"
              "rapid 10\n");
    EXPECT_EQ(motions("CYCLE840(10,0,2,-5,,0,4,3,0,,2)"),
              "rapid 2\nspindle 1 1000\nfeed -5 2000\nspindle 2 1000\nfeed 2 2000\n"
              "spindle 1 1000\nrapid 10\n");
    EXPECT_THAT(motions("CYCLE84(10,0,2,-5,,0,3)"), HasSubstr("the pitch is missing"));
}

TEST(SiemensCycle, Bores) {
    EXPECT_EQ(motions("CYCLE85(10,0,2,-5,,0.1,30,60)"),
              "rapid 2\nfeed -5 30\ndwell 0.1\nfeed 2 60\nrapid 10\n");
    EXPECT_EQ(motions("CYCLE89(10,0,2,-5,,0.1)"),
              "rapid 2\nfeed -5 100\ndwell 0.1\nfeed 2 100\nrapid 10\n");
    EXPECT_EQ(motions("CYCLE88(10,0,2,-5,,0.1,3)"), "rapid 2\nspindle 1 1000\nfeed -5 100\n"
                                                    "dwell 0.1\nspindle 0 0\nstop\nrapid 10\n");
    EXPECT_THAT(siemens(ready + "CYCLE86(10,0,2,-5,,0,3,-1,0.5,0)\n"),
                HasSubstr("straight_traverse x=9 y=20.5 z=-5\n"
                          "straight_traverse x=9 y=20.5 z=2\n"
                          "straight_traverse x=10 y=20 z=10\n"));
}

std::string holes(const std::string& text) {
    const Ran ran = run_text(ready + text, DialectId::siemens);
    if (ran.run.error) return "error: " + ran.run.error->message;
    std::string found;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* feed = std::get_if<StraightFeed>(&command);
                feed && *feed->end[2] == -5.0)
                found += fmt::format("{:.3f},{:.3f} ", *feed->end[0], *feed->end[1]);
    return found;
}

TEST(SiemensCycle, McallDrillsAfterEveryBlockThatMoves) {
    EXPECT_EQ(holes("MCALL CYCLE81(10,0,2,-5)\nG0 X1 Y2\nM8\nX3\nMCALL\nX9\n"),
              "1.000,2.000 3.000,2.000 ");
}

TEST(SiemensCycle, PatternsHaveTheirHoles) {
    EXPECT_EQ(holes("G0 X0 Y0\nMCALL CYCLE81(10,0,2,-5)\nHOLES1(10,0,90,5,20,3)\nMCALL\n"),
              "10.000,5.000 10.000,25.000 10.000,45.000 ");
    // From the nearer end.
    EXPECT_EQ(holes("G0 X10 Y50\nMCALL CYCLE81(10,0,2,-5)\nHOLES1(10,0,90,5,20,3)\nMCALL\n"),
              "10.000,45.000 10.000,25.000 10.000,5.000 ");
    EXPECT_EQ(holes("MCALL CYCLE81(10,0,2,-5)\nHOLES2(10,10,5,0,0,4)\nMCALL\n"),
              "15.000,10.000 10.000,15.000 5.000,10.000 10.000,5.000 ");
    EXPECT_EQ(holes("MCALL CYCLE81(10,0,2,-5)\nHOLES2(0,0,10,90,-90,2)\nMCALL\n"),
              "0.000,10.000 10.000,0.000 ");
    EXPECT_THAT(holes("HOLES2(0,0,10,90,-90,0)\n"), HasSubstr("parameter 6 (NUM)"));
}

} // namespace
} // namespace gcode
