#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "gcode/contour/spline.h"
#include "gcode/lower/lowering.h"
#include "tests/gcode/programs.h"
#include "tests/support/same_state.h"

namespace gcode {
namespace {

constexpr DialectId linuxcnc = DialectId::linuxcnc;

size_t count_of(std::string_view text, std::string_view part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
    return count;
}

std::string error(std::string_view text) { return error_of(text, linuxcnc); }

double distance_to_chords(SplinePoint place, SplinePoint from,
                          const std::vector<SplinePoint>& ends) {
    double nearest = INFINITY;
    for (const SplinePoint end : ends) {
        const double x = end.x - from.x, y = end.y - from.y;
        const double squared = x * x + y * y;
        const double along =
            squared > 0.0 ? ((place.x - from.x) * x + (place.y - from.y) * y) / squared : 0.0;
        const double fraction = std::min(std::max(along, 0.0), 1.0);
        nearest = std::min(
            nearest, std::hypot(place.x - from.x - fraction * x, place.y - from.y - fraction * y));
        from = end;
    }
    return nearest;
}

TEST(SplineChords, StayWithinTheirTolerance) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-60.0, 60.0), weight(0.2, 5.0);
    size_t chords = 0;
    for (int round = 0; round < 30; ++round) {
        NurbsCurve curve;
        curve.order = 3 + round % 3;
        for (int i = 0; i < curve.order + round % 4; ++i)
            curve.points.push_back({{place(random), place(random)}, weight(random)});
        const auto ends = chords_within(curve, 0.001);
        ASSERT_TRUE(ends) << ends.error().message;
        EXPECT_EQ(ends->back(), curve.points.back().at);
        chords += ends->size();
        for (int i = 0; i <= 997 && round < 12; ++i)
            EXPECT_LT(distance_to_chords(point_at(curve, curve.spans() * i / 997.0),
                                         curve.points.front().at, *ends),
                      0.001);
    }
    EXPECT_GT(chords, 3000u);
}

TEST(Spline, IsAFeedAndLeavesTheMotionModeAlone) {
    const std::string text =
        trace("G21 F100 G17\nG0 X0 Y0 Z1\nG5 X10 Y1 I1 J1 P1 Q1\nX20\nM2\n", linuxcnc);
    EXPECT_GT(count_of(text, "straight_feed"), 10u);
    EXPECT_NE(text.find("straight_traverse x=20 y=1 z=1"), std::string::npos) << text;
    EXPECT_EQ(error("G21 F100 G17 X0\n").substr(0, 6), "1:14: ");
    EXPECT_EQ(error("G21 F100\nG5.1 X10 Y1 I1 J1\nX3\nM2\n").substr(0, 4), "3:1:");
}

TEST(Spline, IsRefusedWithLineAndColumnIfItsWordsAreWrong) {
    EXPECT_EQ(error("G21 F100\nG5 X10 Y1 P1 Q1 Z3\nM2\n"),
              "2:17: Z3: a spline moves X and Y only: move Z in a separate block");
    EXPECT_EQ(error("G21 F100 G18\nG5.1 X10 Y1 I1 J1\nM2\n"),
              "2:1: G5.1 works in the XY plane only: program G17 first");
    EXPECT_EQ(error("G21 F100\nG5 X10 Y1 I1 P1 Q1\nM2\n").substr(0, 5), "2:1: ");
    EXPECT_EQ(error("G21 F100\nG5.3\nM2\n"),
              "2:1: G5.3 ends a curve, but none was started with G5.2");
    EXPECT_EQ(error("G21\nG5.2 X1 Y2 P1\nM2\n").substr(0, 5), "2:1: ");
}

TEST(Spline, ForgetsControlPointsThatAnotherMotionCutsOff) {
    const std::string cut = "G21 F100\nG5.2 X1 Y9 P1\nX3 Y4 P1\nG0 X5 Y0\n";
    const std::string curve = "G5.2 X7 Y7 P1\nX8 Y8 P1\nG5.3\nM2\n";
    const auto feeds = [](const std::string& text) { return text.substr(text.find("_feed")); };
    EXPECT_EQ(feeds(trace(cut + curve, linuxcnc)),
              feeds(trace("G21 F100\nG0 X5 Y0\n" + curve, linuxcnc)));
}

TEST(Spline, IsPartOfTheStateWhileItIsGathered) {
    const Ran one = run_text("G21 F100\nG5.2 X1 Y2 P1\n", linuxcnc);
    const Ran other = run_text("G21 F100\nG5.2 X1 Y2 P2\n", linuxcnc);
    ASSERT_FALSE(one.run.error || other.run.error);
    EXPECT_FALSE(continue_alike(one.run.state, other.run.state));
    EXPECT_NE(digest_of(one.run.state), digest_of(other.run.state));
}

const std::string thread = "G21 S500 M3 F100\nG18 G0 X20 Z10\n";

TEST(Threading, CutsPassesWithThePitchOfTheWords) {
    const std::string text = trace(thread + "G76 P1 Z-5 I-1 J.2 K.5\nM2\n", linuxcnc);
    EXPECT_EQ(count_of(text, "thread_feed"), 3u) << text;
    EXPECT_EQ(count_of(text, "enable_override"), 6u) << text;
    EXPECT_NE(text.find("x=18.5 y=0 z=-5"), std::string::npos) << text;
}

TEST(Threading, NeedsItsWordsInEachBlock) {
    EXPECT_EQ(error(thread + "G76 P1 Z-5 I-1 J.2 K.5\nX30\nM2\n"),
              "4:1: G76 needs a P word, the pitch of the thread");
    EXPECT_EQ(error(thread + "G76 P1 I-1 J.2 K.5\nM2\n"),
              "3:1: G76 has no axis word: it needs Z, the end of the thread");
    EXPECT_EQ(error(thread + "M5\nG76 P1 Z-5 I-1 J.2 K.5\nM2\n"),
              "4:1: G76: the spindle is stopped: start it with M3 or M4 first");
    EXPECT_EQ(error(thread + "G76 P1 Z-5 A4 I-1 J.2 K.5\nM2\n"),
              "3:12: A4: G76 does not move rotary axes: move A in an earlier block");
}

const std::string shaft =
    "G21 F100 G18\no100 sub\nG0 X10 Z2\nG1 X10 Z-10\nX16 Z-16\nG0 X18\no100 endsub\nG0 X20 Z10\n";

/// The trace after the subprogram and the first rapid.
std::string turned(std::string_view block) {
    const std::string text = trace(shaft + std::string(block) + "\nM2\n", linuxcnc);
    const std::string first = "straight_traverse x=20 y=0 z=10\n";
    const size_t at = text.find(first);
    return at == text.npos ? text : text.substr(at + first.size());
}

TEST(Turning, FollowsTheContourOfASubprogram) {
    // As printed by rs274.
    EXPECT_EQ(turned("G70 Q100 X18 Z4"), "straight_traverse x=18 y=0 z=4\n"
                                         "straight_traverse x=18 y=0 z=4\n"
                                         "straight_traverse x=10 y=0 z=2\n"
                                         "straight_feed x=10 y=0 z=-10 feed=100\n"
                                         "straight_feed x=16 y=0 z=-16 feed=100\n"
                                         "straight_feed x=18 y=0 z=-16 feed=100\n");
    EXPECT_NE(turned("G71 Q100 X18 Z4 D0 I4 R1").find("x=14 y=0 z=-14"), std::string::npos);
    EXPECT_NE(turned("G72.2 Q100 X18 Z4 I4").find("x=10 y=0 z=2"), std::string::npos);
}

TEST(Turning, LeavesTheMotionOfItsLastMove) {
    EXPECT_TRUE(turned("G70 Q100 X18 Z4\nX5").ends_with("straight_feed x=5 y=0 z=-16 feed=100\n"));
}

TEST(Turning, ReadsCornersFromAAndC) {
    const std::string round =
        "G21 F100 G18\no1 sub\nG0 X10 Z2\nG1 Z-10 A2\nX20\no1 endsub\nG70 Q1 X22 Z4\nM2\n";
    const std::string text = trace(round, linuxcnc);
    EXPECT_NE(text.find("arc_feed x=12 y=0 z=-10"), std::string::npos) << text;
}

TEST(Turning, KeepsTheValuesThatTheSubprogramSets) {
    const std::string program =
        "G21 F100 G18\no1 sub\nG0 X10 Z2\n#100=7\nG1 Z-10\nX20\no1 endsub\nG70 Q1 X22 Z4\n"
        "G0 X#100\nM2\n";
    EXPECT_NE(trace(program, linuxcnc).find("straight_traverse x=7 "), std::string::npos);
}

TEST(Turning, ReportsMistakesWithLineAndColumn) {
    EXPECT_EQ(error(shaft + "G71 X18 Z4\nM2\n"),
              "9:1: G71: no Q word: it must give the number of the subprogram with the contour; if "
              "it means millimetres, use G21");
    EXPECT_EQ(error("G21\nN20G71G91.1\nM2\n"),
              "2:4: G71: beside G91.1 it is Mach3's code for millimetres: use G21; with that, "
              "--dialect linuxcnc reads the program");
    EXPECT_EQ(error(shaft + "G17 G71 Q100 X18 Z4\nM2\n"),
              "9:5: G71: turning cycles work in the ZX plane: program G18 first");
    EXPECT_EQ(error(shaft + "G71 Q200 X18 Z4\nM2\n").substr(0, 4), "9:5:");
    EXPECT_EQ(error(shaft + "G71 Q100 X18 Z4 I-1\nM2\n").substr(0, 4), "9:1:");
    EXPECT_EQ(error("G21 F100 G18\no1 sub\nG0 X10 Z2\nG1 Z-10 A1 C1\nX20\no1 endsub\n"
                    "G70 Q1 X22 Z4\nM2\n"),
              "4:1: a corner can have a fillet (A) or a chamfer (C), not both");
}

TEST(Turning, LeavesTheStateAsItWasOnAnError) {
    const std::string before = shaft + "#5=3\n";
    const Ran good = run_text(before, linuxcnc);
    const Ran bad = run_text(before + "G71 Q100 X18 Z4 I-1\n", linuxcnc);
    ASSERT_TRUE(bad.run.error);
    EXPECT_EQ(bad.run.state.modal, good.run.state.modal);
    EXPECT_EQ(bad.run.state.frames, good.run.state.frames);
}

} // namespace
} // namespace gcode
