#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The position of the machine at the end of a program.
Position machine_after(std::string_view text, DialectId dialect = DialectId::fanuc) {
    const Ran ran = run_text(text, dialect);
    EXPECT_FALSE(ran.run.error) << (ran.run.error ? ran.run.error->message : "");
    return machine_from_program(ran.run.state.modal.offsets, ran.run.state.modal.position);
}

/// How each rapid of a program runs: as the machine does, as a dog-leg, or with axes that are
/// independent.
std::string rapid_styles(std::string_view text, DialectId dialect) {
    std::string styles;
    for (const BlockCommands& block : run_text(text, dialect).run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                styles += !rapid->style                                 ? "machine "
                          : *rapid->style == core::RapidStyle::straight ? "straight "
                          : *rapid->style == core::RapidStyle::dogleg   ? "dogleg "
                                                                        : "independent ";
    return styles;
}

TEST(RapidStyle, WaysInMachineCoordinatesAreDogLegsOnFanucOnly) {
    const std::string text = "G90 G0 X1. Y2.\nG53 X-5. Y-6.\nG28 X3. Y4.\nM30\n";
    EXPECT_EQ(rapid_styles(text, DialectId::fanuc), "machine dogleg machine dogleg ");
    EXPECT_EQ(rapid_styles(text, DialectId::haas), "machine machine machine machine ");
    EXPECT_EQ(rapid_styles(text, DialectId::linuxcnc), "machine machine machine machine ");
}

TEST(ExtendedOffsets, AreWrittenByL20AndSelectedByG541OrG54P) {
    EXPECT_EQ(machine_after("G90 G10 L20 P7 X10 Y20\nG54.1 P7\nG0 X1 Y2")[0], 11.0);
    EXPECT_EQ(machine_after("G90 G10 L20 P300 X10 Y20\nG54 P300\nG0 X1 Y2")[1], 22.0);
    EXPECT_EQ(machine_after("G90 G10 L20 P7 X10\nG54\nG0 X1")[0], 1.0);
    EXPECT_THAT(error_of("G54.1"), HasSubstr("needs a P word"));
    EXPECT_THAT(error_of("G54.1 P301"), HasSubstr("from 1 to 300"));
    EXPECT_THAT(error_of("G10 L20 P0 X1"), HasSubstr("from 1 to 300"));
}

TEST(ExtendedOffsets, HaasNamesTheFirstTwentyG110ToG129) {
    const DialectId haas = DialectId::haas;
    EXPECT_EQ(machine_after("G10 L20 P1 X10\nG110 G0 X1", haas)[0], 11.0);
    EXPECT_EQ(machine_after("G10 L20 P20 X10\nG129 G0 X1", haas)[0], 11.0);
    EXPECT_EQ(machine_after("G10 L20 P99 X10\nG154 P99 G0 X1", haas)[0], 11.0);
    EXPECT_THAT(error_of("G154 P100", haas), HasSubstr("from 1 to 99"));
    EXPECT_THAT(error_of("G110"), HasSubstr("G110: the dialect fanuc has no such code"));
}

TEST(ExtendedOffsets, APOfAnotherCodeIsNotAnOffset) {
    EXPECT_EQ(machine_after("G10 L20 P2 X10\nG54 G4 P2\nG0 X1")[0], 1.0);
}

TEST(ExternalOffset, IsAddedToEveryWorkOffset) {
    EXPECT_EQ(machine_after("G10 L2 P0 Z5\nG0 Z1")[2], 6.0);
    EXPECT_EQ(machine_after("G10 L2 P0 Z5\nG10 L2 P2 Z10\nG55 G0 Z1")[2], 16.0);
    EXPECT_EQ(machine_after("G10 L2 P0 Z5\nG91 G10 L2 P0 Z2\nG90 G54.1 P1 G0 Z1")[2], 8.0);
}

TEST(LengthOffset, EndsWithG28OnHaasOnly) {
    const char* program = "G10 L10 P5 R100\nG90 G43 H5 G0 Z9\nG91 G28 Z0\nG90 G0 Z1";
    EXPECT_EQ(machine_after(program, DialectId::haas)[2], 1.0);
    EXPECT_EQ(machine_after(program)[2], 101.0);
    EXPECT_THAT(warnings_of(std::string(program) + "\nM5", DialectId::haas), Not(HasSubstr("G49")));
}

TEST(LengthOffset, IsCancelledByMachineMovesOfItsAxisOnFanucUnlessEvoRestoresIt) {
    const auto z_after = [](std::string_view way, bool restores) {
        Environment environment = known_environment(DialectId::fanuc);
        environment.control.answers[ControlQuestion::length_is_reloaded] = restores;
        const Ran ran = run_text(
            "G10 L10 P5 R100\nG90 G43 H5 G0 Z9\n" + std::string(way) + "\nG90 G0 Z1", environment);
        return machine_from_program(ran.run.state.modal.offsets, ran.run.state.modal.position)[2];
    };
    for (const char* way : {"G91 G28 Z0", "G91 G30 Z0", "G53 G0 Z0", "G28"}) {
        EXPECT_EQ(z_after(way, false), 1.0) << way;
        EXPECT_EQ(z_after(way, true), 101.0) << way;
    }
    for (const char* way : {"G91 G28 X0 Y0", "G53 G0 X0", "G28 Y0"})
        EXPECT_EQ(z_after(way, false), 101.0) << way;
    EXPECT_EQ(z_after("G53 G0 Z0\nG43 H5", false), 101.0);
}

TEST(CoordinatePreset, OfG921MovesNothingAndClearsTheNamedAxes) {
    const char* shift = "G90 G0 X10 Y20\nG92 X0 Y0\nG0 X1 Y2\n";
    EXPECT_EQ(machine_after(std::string(shift) + "G92.1 X0\nG0 X1 Y2")[0], 1.0);
    EXPECT_EQ(machine_after(std::string(shift) + "G92.1 X0\nG0 X1 Y2")[1], 22.0);
    EXPECT_EQ(machine_after(std::string(shift) + "G92.1 X0 Y0 Z0")[0], 11.0);
    EXPECT_EQ(machine_after(std::string(shift) + "G92.1\nG0 X1 Y2")[1], 2.0);
}

TEST(ToolEntries, L10AndL11AreLengthAndWear) {
    EXPECT_EQ(machine_after("G10 L10 P5 R100\nG10 L11 P5 R-0.5\nG43 H5 G0 Z1")[2], 100.5);
    EXPECT_EQ(machine_after("G10 L10 P5 R100\nG91 G10 L10 P5 R2\nG90 G43 H5 G0 Z1")[2], 103.0);
    EXPECT_EQ(machine_after("G20 G10 L10 P5 R1\nG43 H5 G0 Z0")[2], 25.4);
    EXPECT_THAT(error_of("G10 L10 P5"), HasSubstr("needs an R word"));
}

TEST(ToolEntries, ANewLengthWaitsForTheNextG43) {
    const std::string text = "G21 G10 L10 P5 R100\nG43 H5 G0 Z1\nG10 L10 P5 R90\nZ2";
    EXPECT_EQ(machine_after(text)[2], 102.0);
    EXPECT_EQ(machine_after(text + "\nG43 H5 Z3")[2], 93.0);
    EXPECT_THAT(warnings_of(text), HasSubstr("H5 is in use"));
}

TEST(ToolEntries, L12IsARadiusOrADiameter) {
    const auto diameter = [](DialectId dialect) {
        const Ran ran = run_text("G10 L12 P5 R6\nG10 L13 P5 R1", dialect);
        return ran.run.state.tables->lengths.at(core::OffsetNumber(5));
    };
    EXPECT_EQ(diameter(DialectId::fanuc).diameter, 12.0);
    EXPECT_EQ(diameter(DialectId::fanuc).radius_wear, 1.0);
    EXPECT_EQ(diameter(DialectId::haas).diameter, 6.0);
    EXPECT_EQ(diameter(DialectId::haas).radius_wear, 0.5);
}

TEST(ToolEntries, ANewEntryKeepsTheLengthOfTheTool) {
    Environment environment = known_environment(DialectId::fanuc);
    environment.tool_lengths[core::ToolNumber(5)] = 70.0;
    const Ran ran = run_text("G10 L12 P5 R6\nG43 H5 G0 Z1", environment);
    EXPECT_EQ(ran.run.state.modal.offsets.tool[2], 70.0);
}

TEST(DataInput, LivesAndParametersArePassedOver) {
    EXPECT_EQ(error_of("G10 L3"), "");
    EXPECT_THAT(warnings_of("G10 L3"), HasSubstr("have no effect"));
    for (const std::string_view text : {"G10 L50\nN1020 P1 R88\nG11", "G10 L52\nG11"}) {
        EXPECT_EQ(error_of(text), "") << text;
        EXPECT_THAT(warnings_of(text), HasSubstr("what depends on them is not proven clear"))
            << text;
    }
    EXPECT_THAT(error_of("G10 L99 P1 X1"), HasSubstr("not supported yet"));
}

TEST(LocalOffset, ShiftsRotaryAxes) { EXPECT_EQ(machine_after("G52 A90\nG0 A10")[3], 100.0); }

TEST(Home, G29ReturnsByTheWayOfG28) {
    EXPECT_EQ(trace("G0 X50 Y50 Z10\nG91 G28 X5 Z20\nG90 G29 X1 Z2"),
              "straight_traverse x=50 y=50 z=10\n"
              "straight_traverse x=55 y=50 z=30\n"
              "straight_traverse x=0 y=50 z=0\n"
              "straight_traverse x=55 y=50 z=30\n"
              "straight_traverse x=1 y=50 z=2\n");
    EXPECT_THAT(error_of("G29 X1"), HasSubstr("no G28 came before it"));
}

TEST(Home, G27MovesAndSaysWhenItMissesTheReferencePoint) {
    EXPECT_EQ(warnings_of("G21 G0 X5\nG27 X0\nM30"), "");
    EXPECT_THAT(warnings_of("G21 G27 X5\nM30"), HasSubstr("the control stops here"));
    EXPECT_EQ(trace("G27 X5"), "straight_traverse x=5 y=0 z=0\n");
}

TEST(Skip, G31GoesToItsEndAndIsNotModal) {
    EXPECT_EQ(trace("G0 X1\nG31 Z-5 F100\nX2"), "straight_traverse x=1 y=0 z=0\n"
                                                "straight_probe x=1 y=0 z=-5 feed=100 towards=1 "
                                                "must_succeed=0\n"
                                                "straight_traverse x=2 y=0 z=-5\n");
    EXPECT_THAT(warnings_of("G21 G31 Z-5 F100"), HasSubstr("the whole move is checked"));
    EXPECT_THAT(error_of("G31 Z-5"), HasSubstr("no feed rate"));
}

} // namespace
} // namespace gcode
