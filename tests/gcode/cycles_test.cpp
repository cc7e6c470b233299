#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/cycles/cycles.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// The levels along Z that a program visits after its first block, and how: r rapid, f feed, d
/// dwell.
std::string levels(const std::string& text, DialectId dialect = DialectId::fanuc) {
    std::string found;
    const Ran ran = run_text("G21 G0 Z20\n" + text, dialect);
    if (ran.run.error) return ran.run.error->message;
    for (const BlockCommands& block : ran.run.blocks) {
        if (block.line == 1) continue;
        for (const CanonicalCommand& command : block.commands) {
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                found += " r" + std::to_string(std::lround(*rapid->end[2] * 10));
            else if (const auto* feed = std::get_if<StraightFeed>(&command))
                found += " f" + std::to_string(std::lround(*feed->end[2] * 10));
            else if (std::holds_alternative<Dwell>(command))
                found += " d";
            else if (const auto* spindle = std::get_if<Spindle>(&command))
                found += spindle->direction == core::SpindleDirection::stopped ? " stop" : " turn";
        }
    }
    return found;
}

TEST(Cycle, OfEveryDialectHasItsMotions) {
    int count = 0;
    for (const DialectId id : {DialectId::linuxcnc, DialectId::fanuc, DialectId::haas,
                               DialectId::grbl, DialectId::siemens_iso})
        for (int number = 0; number < 1000; ++number)
            if (const Code* code = find_code(g_code(number), id); code && code->is_cycle()) {
                EXPECT_EQ(drilling_cycle(code->number, dialect(id)).code, code->number);
                ++count;
            }
    EXPECT_GT(count, 40);
}

TEST(Cycle, G81DrillsAndRetractsToTheInitialLevelOrToR) {
    EXPECT_EQ(levels("G98 G81 X1 Z-2 R3 F100"), " r200 r30 f-20 r200");
    EXPECT_EQ(levels("G99 G81 X1 Z-2 R3 F100"), " r200 r30 f-20 r30");
}

TEST(Cycle, EveryBlockWithAnAxisWordDrillsAgain) {
    EXPECT_EQ(trace("G0 Z20\nG99 G81 X1 Y1 Z-2 R3 F100\nX2\nG80\nX3"),
              "straight_traverse x=0 y=0 z=20\n"
              "straight_traverse x=1 y=1 z=20\n"
              "straight_traverse x=1 y=1 z=3\n"
              "straight_feed x=1 y=1 z=-2 feed=100\n"
              "straight_traverse x=1 y=1 z=3\n"
              "straight_traverse x=2 y=1 z=3\n"
              "straight_feed x=2 y=1 z=-2 feed=100\n"
              "straight_traverse x=2 y=1 z=3\n"
              "straight_traverse x=3 y=1 z=3\n");
}

TEST(Cycle, G98AfterG99ClimbsFirstInLinuxcncAndLastInFanuc) {
    const std::string text = "G99 G81 X1 Z-2 R3 F100\nG98 X2";
    EXPECT_EQ(levels(text, DialectId::linuxcnc), " r200 r30 f-20 r30 r200 r30 f-20 r200");
    EXPECT_EQ(levels(text, DialectId::fanuc), " r200 r30 f-20 r30 r30 f-20 r200");
}

TEST(Cycle, StartsFromBelowRByGoingUpInLinuxcnc) {
    const DialectId linuxcnc = DialectId::linuxcnc;
    EXPECT_EQ(levels("F100\nG99 G81 X1 Z-2 R30", linuxcnc), " r300 r300 f-20 r300");
    EXPECT_EQ(levels("F100\nG98 G81 X1 Z-2 R30", linuxcnc), " r300 r300 f-20 r300");
}

TEST(Cycle, GoesToTheHoleBelowRInFanucAndHaas) {
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas}) {
        EXPECT_EQ(levels("G99 G81 X1 Z-2 R30 F100", dialect), " r200 r300 f-20 r300");
        EXPECT_EQ(levels("G98 G81 X1 Z-2 R30 F100\nX2", dialect),
                  " r200 r300 f-20 r200 r200 r300 f-20 r200");
        EXPECT_EQ(levels("G98 G83 X1 Z-2 R30 Q16 F100", dialect),
                  " r200 r300 f140 r300 r150 f-20 r200");
    }
    EXPECT_EQ(trace("G0 Z-5\nG99 G81 X1 Y1 Z-9 R2 F100"), "straight_traverse x=0 y=0 z=-5\n"
                                                          "straight_traverse x=1 y=1 z=-5\n"
                                                          "straight_traverse x=1 y=1 z=2\n"
                                                          "straight_feed x=1 y=1 z=-9 feed=100\n"
                                                          "straight_traverse x=1 y=1 z=2\n");
}

TEST(Cycle, G82DwellsAtTheBottom) {
    EXPECT_EQ(levels("G99 G82 X1 Z-2 R3 P500 F100"), " r200 r30 f-20 d r30");
    EXPECT_THAT(trace("G82 X1 Z-2 R3 P500 F100"), HasSubstr("dwell seconds=0.5"));
}

TEST(Cycle, G83PecksOutOfTheHole) {
    // LinuxCNC stops 0.254 mm above the bottom of the last peck.
    EXPECT_EQ(levels("F100\nG99 G83 X1 Z-3 R3 Q2.5", DialectId::linuxcnc),
              " r200 r30 f5 r30 r8 f-20 r30 r-17 f-30 r30");
}

TEST(Cycle, G73BreaksChipsInTheHole) {
    EXPECT_EQ(levels("F100\nG98 G73 X1 Z-3 R3 Q2.5", DialectId::linuxcnc),
              " r200 r30 f5 r8 f-20 r-17 f-30 r200");
}

TEST(Cycle, G85AndG89FeedOut) {
    EXPECT_EQ(levels("G99 G85 X1 Z-2 R3 F100"), " r200 r30 f-20 f30");
    EXPECT_EQ(levels("G98 G89 X1 Z-2 R3 P1. F100"), " r200 r30 f-20 d f30 r200");
}

TEST(Cycle, G86StopsTheSpindleOnItsWayOut) {
    EXPECT_EQ(levels("S100 M3\nG99 G86 X1 Z-2 R3 P1. F100"), " turn r200 r30 f-20 d stop r30 turn");
}

TEST(Cycle, RepeatsUnderG91StepByStep) {
    // As in rs274: G91 G81 X10 Z-3 R-2 L3 from Z10.
    EXPECT_EQ(trace("G21 G0 Z10\nF100\nG91 G81 X10 Z-3 R-2 L3", DialectId::linuxcnc),
              "straight_traverse x=0 y=0 z=10\n"
              "set_path_mode mode=exact_path tolerance=0 naive_tolerance=0\n"
              "straight_traverse x=10 y=0 z=10\n"
              "straight_traverse x=10 y=0 z=8\n"
              "straight_feed x=10 y=0 z=5 feed=100\n"
              "straight_traverse x=10 y=0 z=8\n"
              "straight_traverse x=20 y=0 z=8\n"
              "straight_feed x=20 y=0 z=5 feed=100\n"
              "straight_traverse x=20 y=0 z=8\n"
              "straight_traverse x=30 y=0 z=8\n"
              "straight_feed x=30 y=0 z=5 feed=100\n"
              "straight_traverse x=30 y=0 z=8\n"
              "set_path_mode mode=continuous tolerance=0 naive_tolerance=0\n");
}

TEST(Cycle, RCountsFromTheInitialLevelUnderG91) {
    EXPECT_EQ(levels("G91 G99 G81 X5 R-1 Z-4 F100 L2\nX1"),
              " r200 r190 f150 r190 r190 f150 r190 r190 f150 r190");
}

TEST(Cycle, FanucRepeatsWithKAndStoresWithK0) {
    EXPECT_EQ(levels("G91 G99 G81 X5 R-1 Z-4 F100 K2"), " r200 r190 f150 r190 r190 f150 r190");
    EXPECT_EQ(levels("G99 G81 Z-2 R3 F100 K0\nX1"), " r200 r30 f-20 r30");
}

TEST(Cycle, DrillsAlongThePlanesNormal) {
    EXPECT_EQ(trace("G0 Y20\nG18 G99 G81 X1 Z1 Y-2 R3 F100"),
              "straight_traverse x=0 y=20 z=0\n"
              "select_plane plane=ZX\n"
              "straight_traverse x=1 y=20 z=1\n"
              "straight_traverse x=1 y=3 z=1\n"
              "straight_feed x=1 y=-2 z=1 feed=100\n"
              "straight_traverse x=1 y=3 z=1\n");
}

TEST(Cycle, IsOneBlockWithSeveralMotions) {
    const Ran ran = run_text("G0 Z20\nG81 X1 Z-2 R3 F100\nG80\n");
    EXPECT_FALSE(ran.run.blocks[0].is_cycle);
    EXPECT_TRUE(ran.run.blocks[1].is_cycle);
    EXPECT_FALSE(ran.run.blocks[2].is_cycle);
}

TEST(Cycle, EndsWithAMotionCode) {
    EXPECT_THAT(trace("G0 Z20\nG81 X1 Z-2 R3 F100\nG0 X5\nX6"),
                testing::EndsWith("straight_traverse x=5 y=0 z=20\n"
                                  "straight_traverse x=6 y=0 z=20\n"));
}

TEST(Cycle, NamesTheWordItMisses) {
    EXPECT_EQ(error_of("G81 X1 R3 F100"), "1:1: G81 needs a Z word");
    EXPECT_EQ(error_of("G81 X1 Z-2 F100"), "1:1: G81 needs an R word");
    EXPECT_EQ(error_of("G83 X1 Z-2 R3 F100"), "1:1: G83 needs a Q word");
    EXPECT_EQ(error_of("G83 X1 Z-2 R3 Q0 F100"), "1:15: Q0: the peck depth must be greater than 0");
    EXPECT_THAT(error_of("G81 X1 Z-2 R3"), HasSubstr("1:1: G81: no feed rate"));
    EXPECT_THAT(error_of("G81 X1 Z-2 R-3 F100"),
                HasSubstr("G81: R at -3.0000 mm is below the bottom of the hole at -2.0000"));
}

TEST(Cycle, RefusesToMakeEndlessMoves) {
    EXPECT_THAT(error_of("G83 X1 Z-200 R3 Q0.0001 F100"), HasSubstr("this Q gives more than"));
    EXPECT_THAT(error_of("G91 G83 X1 Z-20 R0 Q0.01 F100 L10000"), HasSubstr("gives more than"));
    EXPECT_THAT(error_of("G81 X1 Z-2 R3 F100 L100000"),
                HasSubstr("L100000: L must be a whole number from 0 to 10000"));
}

TEST(Cycle, RetractsToAnUnknownLevelAsUnknown) {
    const Ran ran =
        run_text("G98 G81 X1 Y1 Z-2 R3 F100\n", Environment{.dialect = DialectId::fanuc});
    EXPECT_FALSE(ran.run.error);
    EXPECT_EQ(commands_of(ran.run), "straight_traverse x=1 y=1\n"
                                    "straight_traverse x=1 y=1 z=3\n"
                                    "straight_feed x=1 y=1 z=-2 feed=100\n"
                                    "straight_traverse x=1 y=1\n");
}

} // namespace
} // namespace gcode
