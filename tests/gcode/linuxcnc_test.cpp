#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

std::string traced(std::string_view text) {
    return trace("G21\n" + std::string(text), DialectId::linuxcnc);
}
std::string refused(std::string_view text) { return error_of(text, DialectId::linuxcnc); }

TEST(Linuxcnc, PolarPositionsKeepTheValuesThatTheyOmit) {
    EXPECT_EQ(traced("G0 @5 ^30"), "straight_traverse x=4.330127 y=2.5 z=0\n");
    EXPECT_THAT(traced("G0 X1 Y1\nG91 @2 ^45"), HasSubstr("x=0 y=3.414214 z=0\n"));
    EXPECT_THAT(traced("G0 X3 Y4\n^10\n@7"), HasSubstr("x=6.893654 y=1.215537 z=0\n"));
    EXPECT_THAT(refused("G0 @1 X3"), HasSubstr("not both"));
    EXPECT_THAT(refused("G0 @-1"), HasSubstr("which has no angle"));
}

TEST(Linuxcnc, DiametersAreHalved) {
    EXPECT_EQ(traced("G7 G0 X10\nG91 X1\nG8 X3"), "straight_traverse x=5 y=0 z=0\n"
                                                  "straight_traverse x=5.5 y=0 z=0\n"
                                                  "straight_traverse x=8.5 y=0 z=0\n");
}

TEST(Linuxcnc, ThreadsKeepPaceWithTheSpindle) {
    EXPECT_THAT(traced("M3 S100\nG33 Z-5 K1.5"),
                HasSubstr("thread_feed x=0 y=0 z=-5 pitch=1.5 back_again=0\n"));
    // A rigid tap ends where it started.
    EXPECT_THAT(traced("M3 S100\nG33.1 Z-5 K1.5\nG0 X1"),
                HasSubstr("pitch=1.5 back_again=1\nstraight_traverse x=1 y=0 z=0\n"));
    EXPECT_THAT(refused("G33.1 Z-1 K1"), HasSubstr("G33.1: the spindle is stopped"));
    EXPECT_THAT(refused("M3 S1 G33 Z-1"),
                HasSubstr("G33 needs a K word, the distance per revolution of the spindle"));
}

TEST(Linuxcnc, ProbesAreFollowedToTheirEnds) {
    EXPECT_THAT(traced("G38.5 Z-5 F100\nG0 X#5061 Z#5063"),
                HasSubstr("straight_probe x=0 y=0 z=-5 feed=100 towards=0 must_succeed=0\n"
                          "straight_traverse x=0 y=0 z=-5\n"));
    EXPECT_THAT(warnings_of("G21 G38.2 Z-5 F100", DialectId::linuxcnc),
                HasSubstr("the whole move is checked"));
}

TEST(Linuxcnc, ModesOfPathSpindleAndOverridesAreSaid) {
    EXPECT_THAT(traced("G61\nG61.1\nG64 P0.1 Q0.2\nG64"),
                HasSubstr("mode=exact_stop tolerance=0 naive_tolerance=0\n"
                          "set_path_mode mode=continuous tolerance=0.1 naive_tolerance=0.2\n"
                          "set_path_mode mode=continuous tolerance=0 naive_tolerance=0\n"));
    EXPECT_THAT(traced("G96 D2500 S300 M3"),
                HasSubstr("use_spindle_mode surface_speed=1 speed=300 fastest_speed=2500\n"));
    EXPECT_THAT(traced("M49\nM52\nM53 P0"),
                HasSubstr("enable_override kind=feed enabled=0\nenable_override kind=speed "
                          "enabled=0\nenable_override kind=adaptive_feed enabled=1\n"
                          "enable_override kind=feed_hold enabled=0\n"));
    EXPECT_THAT(traced("M62 P1\nM68 E2 Q3.5\nM66 P1 L3 Q5"),
                HasSubstr("set_output number=1 value=1 analog=0 with_motion=1\n"
                          "set_output number=2 value=3.5 analog=1 with_motion=0\n"
                          "wait_for_input number=1 analog=0 seconds=5\n"));
    EXPECT_THAT(refused("M66 P1 L1"), HasSubstr("longest time"));
    EXPECT_THAT(refused("M62"), HasSubstr("M62 needs a P word"));
}

TEST(Linuxcnc, SavedModesComeBack) {
    EXPECT_THAT(traced("F100\nM70\nG91 F5\nM72\nG1 X1\nX1"),
                HasSubstr("straight_feed x=1 y=0 z=0 feed=100\n"
                          "straight_feed x=1 y=0 z=0 feed=100\n"));
    EXPECT_THAT(traced("o1 sub\nM73\nG91\no1 endsub\nG90 G0 X1\no1 call\nG0 X1"),
                HasSubstr("straight_traverse x=1 y=0 z=0\nstraight_traverse x=1 y=0 z=0\n"));
    EXPECT_THAT(refused("M72"), HasSubstr("no M70 saved them"));
}

TEST(Linuxcnc, MessagesAreWrittenOut) {
    EXPECT_THAT(traced("#5=3\n(MSG, hi #5)\n(DEBUG,a #5 %d#5 %.2f#5)\nG0 X1 (no msg,)"),
                testing::StartsWith("message text= hi #5\nmessage text=a 3.000000 3 3.00\n"
                                    "straight_traverse"));
}

TEST(Linuxcnc, ToolTableEntriesAreWritten) {
    EXPECT_THAT(traced("G10 L1 P5 Z50 R2\nG43 H5"),
                HasSubstr("use_tool_length_offset number=5 length=50\n"));
    // Here, at machine Z 10, the tip must read 3.
    EXPECT_THAT(traced("G0 Z10\nG10 L10 P6 Z3\nG43 H6\nG0 X#5422"),
                HasSubstr("number=6 length=7\nstraight_traverse x=3 y=0 z=3\n"));
    EXPECT_THAT(traced("G10 L2 P9 Z4\nG0 Z10\nG10 L11 P6 Z1\nG43 H6"),
                HasSubstr("number=6 length=5\n"));
    EXPECT_THAT(traced("G10 L1 P5 Z50\nG10 L1 P6 Z3\nG43 H5\nG43.2 H6"),
                HasSubstr("number=5 length=53\n"));
}

TEST(Linuxcnc, TheToolInTheSpindleCanBeNamed) {
    EXPECT_EQ(traced("M61 Q3"), "name_tool tool=3\n");
    EXPECT_THAT(refused("M61"), HasSubstr("M61 needs a Q word"));
    EXPECT_THAT(warnings_of("T1 M6\nM61 Q3", DialectId::linuxcnc),
                HasSubstr("tool 1 stays in the spindle"));
    EXPECT_EQ(warnings_of("M61 Q1\nM61 Q1\nT2 M6\nM2", DialectId::linuxcnc), "");
}

/// It keeps a straight feed back to join it with the next, and M61 drops it.
TEST(Linuxcnc, DoesNotMakeAFeedBeforeM61) {
    EXPECT_THAT(refused("G1 F100 X5\nM61 Q3"), HasSubstr("leaves out the straight feed"));
    EXPECT_THAT(refused("G1 F100 X5\nG18\nM61 Q3"), HasSubstr("leaves out the straight feed"));
    EXPECT_THAT(refused("G1 F100 X5 Y1\nX6\n(and)\nM61 Q3"), HasSubstr("leaves out"));
    for (const char* between : {"G4 P0", "G0 X6", "G2 X6 I0.5"})
        EXPECT_EQ(error_of("G1 F100 X5\n" + std::string(between) + "\nM61 Q3", DialectId::linuxcnc),
                  "")
            << between;
    EXPECT_THAT(traced("M61 Q3\nG1 F100 X5"), HasSubstr("straight_feed"));
}

/// LinuxCNC takes a lone carriage return for a blank, Grbl for the end of a line.
TEST(Linuxcnc, ReadsOnBehindALoneCarriageReturn) {
    EXPECT_THAT(refused("G0 X1\nG0 Z60\rX160\n"), HasSubstr("carriage return"));
    EXPECT_THAT(refused("; up\rG0 Z60\nG0 X160\n"), HasSubstr("carriage return"));
    EXPECT_THAT(refused("G0 X1\rG0 X2\r"), HasSubstr("carriage return"));
    EXPECT_EQ(traced("G0 X1\r\r\nG0 X2\r\r"),
              "straight_traverse x=1 y=0 z=0\nstraight_traverse x=2 y=0 z=0\n");
    EXPECT_THAT(error_of("O1\nG0 X1\rG0 X2\n", DialectId::fanuc), HasSubstr("carriage return"));
    EXPECT_EQ(error_of("O1\rG0 X1\rG0 X2\rM30\r", DialectId::fanuc), "");
    EXPECT_EQ(error_of("G21\nG0 X1\rG0 X2\n", DialectId::grbl), "");
}

TEST(Linuxcnc, ParametersShowTheStateOfTheControl) {
    EXPECT_THAT(traced("G55 G0 X3\nG0 Y#5220 Z#<_x>"), HasSubstr("x=3 y=2 z=3\n"));
    EXPECT_THAT(traced("#5241=7\nG55 G0 X0 Y#<_metric>\nG0 X#<_coord_system>"),
                HasSubstr("offset=G55 x=7 y=0 z=0\nstraight_traverse x=0 y=1 z=0\n"
                          "straight_traverse x=550 y=1 z=0\n"));
    EXPECT_THAT(refused("#5420=1"), HasSubstr("read-only"));
    EXPECT_THAT(refused("#<_x>=1"), HasSubstr("read-only"));
}

TEST(Linuxcnc, ContoursMoveAsideByTheCuttersRadius) {
    // Entry next to the first point, around an outside corner, and back at the exit.
    EXPECT_EQ(traced("F100\nG0 X-10 Y-10\nG41.1 D4 G1 X0 Y0\nY20\nX20\nG40\nG0 X30"),
              "straight_traverse x=-10 y=-10 z=0\n"
              "straight_feed x=-2 y=0.828427 z=0 feed=100\n" // 2 away from both lines
              "straight_feed x=-2 y=20 z=0 feed=100\n"
              "arc_feed x=0 y=22 z=0 plane=XY centre=0,20 turns=-1 feed=100\n"
              "straight_feed x=20 y=22 z=0 feed=100\n"
              "straight_traverse x=30 y=20 z=0\n");
    EXPECT_THAT(refused("F100 G41.1 D4 G1 X1"), HasSubstr("1:"));
    EXPECT_THAT(refused("G21 F100 G41.1 D4 G1 X10\nG28"),
                HasSubstr("G28 is not allowed between G41 and G40"));
}

TEST(Linuxcnc, BlocksBeforeARefusedContourMoveAreGiven) {
    const Ran ran = run_text("G21 F100 G41.1 D4 G1 X10\nX20\nG28", DialectId::linuxcnc);
    ASSERT_TRUE(ran.run.error);
    EXPECT_EQ(ran.run.error->where.line, 3u);
    EXPECT_EQ(ran.run.blocks.size(), 2u);
}

TEST(Linuxcnc, TurnedWorkOffsetsTurnTheMachine) {
    const Ran ran = run_text("G21 G10 L2 P1 X10 R90\nG0 X5 Y0", DialectId::linuxcnc);
    ASSERT_FALSE(ran.run.error) << ran.run.error->message;
    const ModalState& modal = ran.run.state.modal;
    const Position machine = machine_from_program(modal.offsets, modal.position);
    EXPECT_NEAR(*machine[0], 10.0, 1e-12);
    EXPECT_NEAR(*machine[1], 5.0, 1e-12);
    // L20 sets the current position whatever the rotation.
    const Ran named =
        run_text("G21 G10 L2 P1 X10 R90\nG0 X5 Y0\nG10 L20 P1 X1 Y2", DialectId::linuxcnc);
    EXPECT_NEAR(*named.run.state.modal.position[0], 1.0, 1e-12);
    EXPECT_NEAR(*named.run.state.modal.position[1], 2.0, 1e-12);
}

} // namespace
} // namespace gcode
