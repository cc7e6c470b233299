#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// Offsets of a machine with a job: G54 and G55 set, two lengths in the table.
Environment shop(DialectId dialect) {
    Environment environment = known_environment(dialect);
    environment.work_offsets[0] = {-350, -200, -420};
    environment.work_offsets[1] = {-100, -100, -400};
    environment.length_offsets[core::OffsetNumber(1)] = {.length = 95.0};
    environment.length_offsets[core::OffsetNumber(2)] = {.length = 60.0, .wear = -0.5};
    environment.tool_lengths[core::ToolNumber(7)] = 77.0;
    return environment;
}

std::string in_shop(std::string_view text, DialectId dialect = DialectId::fanuc) {
    const Ran ran = run_text(text, shop(dialect));
    if (ran.run.error) return ran.run.error->message;
    return commands_of(ran.run);
}

/// The machine position at the end, which a change of offsets must not alter.
Position machine_at_end(std::string_view text, DialectId dialect = DialectId::fanuc) {
    const Ran ran = run_text(text, shop(dialect));
    EXPECT_FALSE(ran.run.error);
    const ModalState& modal = ran.run.state.modal;
    return machine_from_program(modal.offsets, modal.position);
}

TEST(Offsets, ChangesMoveTheCoordinatesAndNotTheMachine) {
    for (const std::string_view text :
         {"G21 G55", "G21 G10 L2 P1 X1 Y2 Z3", "G21 G92 X5 Z6", "G21 G43 H1", "G21 G52 X9",
          "G21 G43 H2\nG49", "G21 G10 L20 P1 X1 Y2 Z3"}) {
        const Position machine = machine_at_end(text);
        for (size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(*machine[axis], 0.0, 1e-9) << text;
    }
}

TEST(Offsets, AxesKeepTheirPositionWhenAnotherMoves) {
    EXPECT_EQ(in_shop("G0 X0\nG55 G0 X0"), "straight_traverse x=0 y=200 z=420\n"
                                           "set_offset offset=G55 x=-100 y=-100 z=-400\n"
                                           "straight_traverse x=0 y=100 z=400\n");
}

TEST(Offsets, AllNineWorkOffsetsCanBeSelected) {
    EXPECT_THAT(trace("G54\nG55\nG56\nG57\nG58\nG59\nG59.1\nG59.2\nG59.3", DialectId::linuxcnc),
                HasSubstr("offset=G59 x=0 y=0 z=0\nset_offset offset=G59.1 x=0 y=0 z=0\n"
                          "set_offset offset=G59.2 x=0 y=0 z=0\nset_offset offset=G59.3 "));
}

TEST(Offsets, G10WritesThem) {
    EXPECT_EQ(in_shop("G10 L2 P2 X5 Y6\nG55"), "set_offset offset=G54 x=-350 y=-200 z=-420\n"
                                               "set_offset offset=G55 x=5 y=6 z=-400\n");
    // At machine zero, so that X reads 10 there.
    EXPECT_EQ(in_shop("G21 G10 L20 P1 X10\nG0 X0", DialectId::linuxcnc),
              "set_offset offset=G54 x=-10 y=-200 z=-420\n"
              "straight_traverse x=0 y=200 z=420\n");
    EXPECT_EQ(in_shop("G91 G10 L2 P1 X5"), "set_offset offset=G54 x=-345 y=-200 z=-420\n");
    EXPECT_EQ(in_shop("G21 G91 G10 L2 P0 X5", DialectId::linuxcnc),
              "set_offset offset=G54 x=5 y=-200 z=-420\n");
    EXPECT_EQ(error_of("G10 P1 X1", DialectId::haas), "1:1: G10 needs L2 or L20");
    EXPECT_EQ(error_of("G10 L2 X1"), "1:1: G10 needs a P word, the number of the work offset");
    EXPECT_THAT(error_of("G10 L2 P10 X1"), HasSubstr("1:8: P10"));
    EXPECT_THAT(error_of("G10 L12 P1 R5", DialectId::linuxcnc), HasSubstr("1:5: L12"));
    EXPECT_THAT(error_of("G10 L2 P1 R5"), HasSubstr("1:11: R5"));
}

TEST(Offsets, G92SetsTheCoordinatesOfTheCurrentPosition) {
    EXPECT_EQ(in_shop("G0 X5\nG92 X0\nG0 X1\nG92.1\nG0 X6"),
              "straight_traverse x=5 y=200 z=420\n"
              "set_offset offset=G54 x=-345 y=-200 z=-420\n"
              "straight_traverse x=1 y=200 z=420\n"
              "set_offset offset=G54 x=-350 y=-200 z=-420\n"
              "straight_traverse x=6 y=200 z=420\n");
}

TEST(Offsets, G92CanBeSuspendedAndRestored) {
    EXPECT_EQ(trace("G21 G92 X-10\nG92.2\nG92.3", DialectId::linuxcnc),
              "set_offset offset=G54 x=10 y=0 z=0\n"
              "set_offset offset=G54 x=0 y=0 z=0\n"
              "set_offset offset=G54 x=10 y=0 z=0\n");
}

TEST(Offsets, G92AtAnUnknownPositionLeavesTheMachineUnknown) {
    const Ran ran = run_text("G92 X0 Y0\nG0 X5\n", Environment{.dialect = DialectId::grbl});
    EXPECT_FALSE(ran.run.error);
    EXPECT_EQ(commands_of(ran.run), "set_offset offset=G54 z=0\nstraight_traverse x=5 y=0\n");
    EXPECT_EQ(machine_from_program(ran.run.state.modal.offsets, ran.run.state.modal.position)[0],
              std::nullopt);
}

TEST(Offsets, G52IsItsOwnInFanucAndG92InLinuxcnc) {
    EXPECT_EQ(trace("G92 X-3\nG52 X1"), "set_offset offset=G54 x=3 y=0 z=0\n"
                                        "set_offset offset=G54 x=4 y=0 z=0\n");
    EXPECT_EQ(trace("G21 G92 X-3\nG52 X1", DialectId::linuxcnc),
              "set_offset offset=G54 x=3 y=0 z=0\nset_offset offset=G54 x=1 y=0 z=0\n");
    EXPECT_EQ(trace("G52 X1 Y2\nG52 X0 Y0 B0"), "set_offset offset=G54 x=1 y=2 z=0\n"
                                                "set_offset offset=G54 x=0 y=0 z=0\n");
}

TEST(Offsets, APMakesG54AnotherOffset) {
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas}) {
        EXPECT_EQ(trace("G54 P1", dialect), "set_offset offset=G54.1 P1 x=0 y=0 z=0\n");
        EXPECT_EQ(error_of("G54 G4 P500", dialect), "");
    }
}

TEST(Offsets, G53MovesInMachineCoordinatesOfTheGaugeLine) {
    EXPECT_EQ(in_shop("G43 H1\nG53 G0 Z-10"), "use_tool_length_offset number=1 length=95\n"
                                              "straight_traverse x=350 y=200 z=315\n");
    // Also with G91, except that Fanuc controls ignore it there and LinuxCNC stops.
    EXPECT_EQ(in_shop("G21 G91 G53 G0 X-350", DialectId::haas),
              "straight_traverse x=0 y=200 z=420\n");
    for (const DialectId dialect : {DialectId::linuxcnc, DialectId::fanuc})
        EXPECT_THAT(error_of("G91 G53 G0 X-350", dialect),
                    HasSubstr("1:5: G53 with G91 stops some controls and is ignored by others"));
    EXPECT_EQ(error_of("G53 X1", DialectId::linuxcnc), "1:1: G53 needs G0 or G1");
    EXPECT_EQ(error_of("G53 X1", DialectId::fanuc), "");
    EXPECT_EQ(error_of("G2 X10 I5 F100\nG53 X1", DialectId::linuxcnc), "2:1: G53 needs G0 or G1");
}

TEST(Offsets, G53IsAlwaysARapidInFanucAndFollowsTheMotionCodeElsewhere) {
    const std::string text = "G21\nG1 X1 F100\nG53 X50";
    EXPECT_THAT(trace(text, DialectId::fanuc), HasSubstr("straight_traverse x=50 y=0 z=0\n"));
    EXPECT_THAT(trace("G2 X10 I5 F100\nG53 X50", DialectId::fanuc),
                HasSubstr("straight_traverse x=50 y=0 z=0\n"));
    for (const DialectId dialect : {DialectId::linuxcnc, DialectId::haas})
        EXPECT_THAT(trace(text, dialect), HasSubstr("straight_feed x=50 y=0 z=0 feed=100\n"));
    EXPECT_EQ(error_of("G53 X1", DialectId::haas), "1:1: G53 needs G0 or G1");
}

TEST(LengthOffset, ComesFromTheTableElseFromTheTool) {
    EXPECT_EQ(in_shop("G43 H1"), "use_tool_length_offset number=1 length=95\n");
    EXPECT_EQ(in_shop("G43 H2"), "use_tool_length_offset number=2 length=59.5\n");
    EXPECT_EQ(in_shop("G43 H7"), "use_tool_length_offset number=7 length=77\n");
    EXPECT_EQ(in_shop("G44 H1"), "use_tool_length_offset number=1 length=-95\n");
    EXPECT_EQ(in_shop("G43 H0"), "use_tool_length_offset number=0 length=0\n");
    EXPECT_EQ(in_shop("G43 H1\nG49"), "use_tool_length_offset number=1 length=95\n"
                                      "use_tool_length_offset length=0\n");
}

TEST(LengthOffset, WithoutHIsTheToolInTheSpindleInLinuxcnc) {
    EXPECT_THAT(in_shop("T7 M6\nT1\nG43", DialectId::linuxcnc),
                HasSubstr("use_tool_length_offset number=7 length=77\n"));
    EXPECT_THAT(in_shop("G43 H1\nG43", DialectId::fanuc),
                HasSubstr("length=95\nuse_tool_length_offset number=1 length=95\n"));
    EXPECT_THAT(warnings_of("G0 G43 Z1"), HasSubstr("G43 has no H word"));
}

TEST(LengthOffset, ALoneHChangesTheOneThatIsOn) {
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas}) {
        EXPECT_EQ(in_shop("G43 H1\nH2", dialect), "use_tool_length_offset number=1 length=95\n"
                                                  "use_tool_length_offset number=2 length=59.5\n");
        EXPECT_THAT(in_shop("G44 H1\nG0 Z10 H2", dialect),
                    HasSubstr("use_tool_length_offset number=2 length=-59.5\n"
                              "straight_traverse x=350 y=200 z=10\n"));
        EXPECT_THAT(in_shop("G43 H1\nM77 H0", dialect),
                    HasSubstr("use_tool_length_offset number=0 length=0\n"));
        EXPECT_EQ(warnings_of("G43 H0\nH0\nM30", dialect), "");
        EXPECT_THAT(warnings_of("G43 H0\nG49\nH1\nM30", dialect),
                    HasSubstr("H1: no code in this block uses this word"));
    }
    EXPECT_EQ(error_of("G43 H0\nH0", DialectId::linuxcnc),
              "2:1: H0: no code in this block uses this word");
}

TEST(LengthOffset, OfAnUnknownNumberIsAWarning) {
    EXPECT_THAT(warnings_of("G43 H9"),
                HasSubstr("G43: length offset H9 is unknown and assumed to be 0"));
    EXPECT_THAT(error_of("G43 H-1"), HasSubstr("1:5: H-1"));
}

TEST(LengthOffset, StaysAcrossAToolChange) {
    const Ran ran = run_text("G43 H1\nT7 M6\n", shop(DialectId::fanuc));
    EXPECT_EQ(ran.run.state.modal.offsets.tool[2], 95.0);
    EXPECT_EQ(ran.run.state.modal.length_number, core::OffsetNumber(1));
}

TEST(LengthOffset, G431GivesItInTheBlock) {
    EXPECT_EQ(trace("G21 G43.1 Z12.5\nG0 Z0", DialectId::grbl),
              "use_tool_length_offset length=12.5\nstraight_traverse x=0 y=0 z=0\n");
    EXPECT_EQ(trace("G21 G43.1 X1 Z2\nG0 X0", DialectId::linuxcnc),
              "use_tool_length_offset length=2 x=1\nstraight_traverse x=0 y=0 z=-2\n");
}

TEST(LengthOffset, G431SharesItsWordsWithAMotionCodeOfItsBlock) {
    const std::string head = "G21 G90\nG0 X1 Y1 Z50\n";
    const std::string block = "G43.1 Z3 G0 X5\nG0 Z10";
    EXPECT_THAT(trace(head + block, DialectId::linuxcnc),
                HasSubstr("use_tool_length_offset length=3 x=5\n"
                          "straight_traverse x=5 y=1 z=3\n"
                          "straight_traverse x=5 y=1 z=10\n"));
    EXPECT_THAT(trace(head + "G91 G0 X5 G43.1 Z3\nX6", DialectId::linuxcnc),
                HasSubstr("straight_traverse x=1 y=1 z=50\nstraight_traverse x=7 y=1 z=50\n"));
    EXPECT_THAT(trace(head + "G0 X5 G43.1 Z3 G53", DialectId::linuxcnc),
                HasSubstr("straight_traverse x=0 y=1 z=0\n"));
    EXPECT_THAT(warnings_of(head + block, DialectId::linuxcnc),
                HasSubstr("each axis word of this block is a tool offset"));
    EXPECT_THAT(trace(head + "G1 X2 F100\nG43.1 X7 Z3\nG0 Z10", DialectId::linuxcnc),
                HasSubstr("length=3 x=7\nstraight_traverse x=-5 y=1 z=10\n"));
}

TEST(Homing, GoesThroughTheIntermediatePoint) {
    EXPECT_EQ(in_shop("G28 Z450"), "straight_traverse x=350 y=200 z=450\n"
                                   "straight_traverse x=350 y=200 z=420\n");
    EXPECT_EQ(in_shop("G91 G28 X0 Z0"), "straight_traverse x=350 y=200 z=420\n"
                                        "straight_traverse x=350 y=200 z=420\n");
    EXPECT_EQ(in_shop("G30 Z450"), "straight_traverse x=350 y=200 z=450\n"
                                   "straight_traverse x=350 y=200 z=370\n");
}

TEST(Homing, KnowsTheThirdReferencePointOnlyIfItIsStated) {
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas}) {
        for (const std::string_view text : {"G91 G30 P3 Z0", "G91 G30 P4 Z0"})
            EXPECT_THAT(error_of(text, dialect), HasSubstr("this reference position is not known"));
        EXPECT_EQ(in_shop("G30 P2 Z450", dialect), in_shop("G30 Z450", dialect));
        EXPECT_EQ(warnings_of("G21 G91 G30 P2 Z0\nM30", dialect), "");
    }
}

TEST(Homing, WithoutAxisWordsMovesAllAxes) {
    EXPECT_EQ(in_shop("G0 X0 Y0 Z0\nG28"), "straight_traverse x=0 y=0 z=0\n"
                                           "straight_traverse x=350 y=200 z=420\n");
}

TEST(Homing, TakesPrecedenceOverTheMotionCodeOfItsBlock) {
    EXPECT_EQ(in_shop("G1 F100\nG0 G91 G28 Z0\nG90 X1"), "straight_traverse x=350 y=200 z=420\n"
                                                         "straight_traverse x=350 y=200 z=420\n"
                                                         "straight_traverse x=1 y=200 z=420\n");
    EXPECT_EQ(error_of("G0 G28 Z0", DialectId::linuxcnc),
              "1:1: G28 and G0 both use the axis words of this block: split it into two blocks");
}

TEST(Homing, IsOneBlockWithSeveralMotions) {
    EXPECT_TRUE(run_text("G28 Z0\n").run.blocks[0].is_cycle);
}

TEST(Homing, SaysOnceThatHomeWasAssumed) {
    const std::string warnings = warnings_of(
        run_text("G21 G91 G28 Z0\nG28 X0\nM30\n", Environment{.dialect = DialectId::fanuc}).run);
    EXPECT_EQ(warnings, "G28: the home position is not given and assumed to be machine zero\n");
    EXPECT_EQ(warnings_of("G21 G91 G28 Z0\nM30\n"), "");
}

TEST(Homing, BringsAnUnknownAxisToAKnownPosition) {
    const Ran ran = run_text("G91 G28 Z0\n", Environment{.dialect = DialectId::fanuc});
    EXPECT_EQ(commands_of(ran.run), "straight_traverse\nstraight_traverse z=0\n");
}

TEST(Homing, G281StoresThePosition) {
    EXPECT_EQ(trace("G21 G0 X5 Z7\nG28.1\nG0 X0 Z0\nG28", DialectId::linuxcnc),
              "straight_traverse x=5 y=0 z=7\n"
              "straight_traverse x=0 y=0 z=0\n"
              "straight_traverse x=5 y=0 z=7\n");
}

} // namespace
} // namespace gcode
