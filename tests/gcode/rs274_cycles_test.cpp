#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

// Expected moves are those printed by LinuxCNC's rs274 for the same lines.
namespace gcode {
namespace {

std::string cycle(std::string_view block, std::string_view before = "S500 M3") {
    return std::string("G21 G90 F100 ") + std::string(before) + "\nG0 X0 Y0 Z10\nG98 "
           + std::string(block) + "\nM2\n";
}

std::string moves(std::string_view block, std::string_view before = "S500 M3") {
    const std::string text = trace(cycle(block, before), DialectId::linuxcnc);
    const size_t from = text.find("exact_path");
    return from == std::string::npos ? text : text.substr(text.find('\n', from) + 1);
}

size_t count_of(std::string_view text, std::string_view part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
    return count;
}

TEST(Rs274Cycle, TapsWithAReversedSpindleAndWithoutOverrides) {
    const std::string text = moves("G84 X1 Y2 Z-3 R2 P0.5");
    const size_t down = text.find("z=-3"), reversed = text.find("counterclockwise");
    const size_t waits = text.find("dwell"), up = text.find("z=10", down);
    EXPECT_LT(text.find("enable_override"), down) << text;
    EXPECT_LT(down, reversed) << text;
    EXPECT_LT(reversed, waits) << text;
    EXPECT_LT(waits, up) << text;
    EXPECT_EQ(count_of(text, "enable_override"), 4u) << text;
}

TEST(Rs274Cycle, RefusesToTapWithASpindleThatIsStoppedOrTurnsTheOtherWay) {
    EXPECT_EQ(error_of(cycle("G84 X1 Z-3 R2", "S500"), DialectId::linuxcnc),
              "3:5: G84: the spindle is stopped: start it with M3 first");
    EXPECT_EQ(error_of(cycle("G74 X1 Z-3 R2"), DialectId::linuxcnc),
              "3:5: G74 cuts a left-hand thread, but the spindle turns the other way: start it "
              "with M4 first");
}

TEST(Rs274Cycle, KeepsTheDwellOfTheCycleBeforeForATap) {
    EXPECT_NE(moves("G82 X1 Z-3 R2 P0.7\nG80\nG84 X4 Z-3 R2").find("dwell seconds=0.7", 200),
              std::string::npos);
    EXPECT_EQ(error_of(cycle("G82 X1 Z-3 R2 P1\nG89 X2 Z-3 R2"), DialectId::linuxcnc),
              "4:1: G89 needs a P word, the dwell at the bottom in seconds");
}

TEST(Rs274Cycle, BoresBackUpToKAndComesOutOffTheMiddle) {
    const std::string text = moves("G87 X1 Y2 Z-3 R2 I0.5 J0.25 K-1");
    EXPECT_EQ(count_of(text, "straight_feed"), 2u) << text;
    EXPECT_LT(text.find("straight_feed x=1 y=2 z=-1"), text.find("straight_feed x=1 y=2 z=-3"))
        << text;
    EXPECT_EQ(count_of(text, "x=1.5 y=2.25"), 4u) << text;
    EXPECT_EQ(
        error_of(cycle("G87 X1 Z-3 R2 I1 J1"), DialectId::linuxcnc),
        "3:5: G87 has no K: it needs I and J, the shift off centre, and K, where the boring ends");
}

TEST(Rs274Cycle, LeavesTheToolInTheHoleAfterG88) {
    const std::string text = moves("G88 X1 Y2 Z-3 R2 P1\nG80\nG0 X9");
    EXPECT_EQ(count_of(text, "program_stop"), 1u) << text;
    EXPECT_EQ(text.find("straight_traverse", text.find("program_stop")),
              text.find("straight_traverse x=9 y=2 z=10"))
        << text;
    EXPECT_NE(warnings_of(cycle("G88 X1 Z-3 R2 P1"), DialectId::linuxcnc).find("retracts it"),
              std::string::npos);
}

TEST(Rs274Cycle, RunsInExactPathAndGoesBackToTheModeBefore) {
    const std::string text =
        trace("G21 F100 G64 P0.1 Q0.05\nG0 Z10\nG81 X1 Z-3 R2\nM2\n", DialectId::linuxcnc);
    EXPECT_EQ(count_of(text, "set_path_mode"), 3u) << text;
    EXPECT_LT(text.find("exact_path"), text.find("x=1")) << text;
    EXPECT_EQ(count_of(text, "continuous"), 2u) << text;
}

TEST(Rs274Cycle, WarnsOfTapsThatLeaveTheirHoleInOtherPlanes) {
    const std::string program = "G21 F100 S500 M3\nG18 G84 X4 Y-5 Z6 R7\nM2\n";
    EXPECT_NE(warnings_of(program, DialectId::linuxcnc).find("tap in G17"), std::string::npos);
    EXPECT_EQ(warnings_of("G21 F100 S500 M3\nG17 G84 X4 Y5 Z-6 R7\nM2\n", DialectId::linuxcnc)
                  .find("tap in G17"),
              std::string::npos);
}

TEST(Rs274Cycle, RefusesAxesOfNoUseAndCutterCompensation) {
    EXPECT_EQ(error_of(cycle("G81 X1 Z-3 R2 A5"), DialectId::linuxcnc),
              "3:19: A5: a cycle moves only X, Y and Z: move A in an earlier block");
    EXPECT_EQ(error_of(cycle("G81 X1 Z-3 R2\nG81"), DialectId::linuxcnc).substr(0, 24),
              "4:1: G81 has no axis wor");
    const std::string compensated =
        "G21 F100\nG0 X50 Y50 Z10\nG41.1 D3\nG1 X10 Y10\nX0\nG81 X1 Z-3 R2\n";
    EXPECT_EQ(
        error_of(compensated, DialectId::linuxcnc),
        "6:1: G81 is not allowed between G41 and G40: cancel cutter radius compensation first");
    EXPECT_EQ(error_of(cycle("G81 X1 Z-3 R2 K2"), DialectId::linuxcnc),
              "3:19: K2: no code in this block uses this word");
}

} // namespace
} // namespace gcode
