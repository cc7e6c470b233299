#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/exec/startup.h"
#include "gcode/lower/lowering.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// The last path mode of a program, as the machine gets it.
core::PathModeChange mode_of(std::string_view text, const Environment& environment) {
    const Ran ran = run_text(text, environment);
    EXPECT_FALSE(ran.run.error) << (ran.run.error ? ran.run.error->message : "");
    core::PathModeChange last;
    Lowering lowering;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (std::holds_alternative<SetPathMode>(command))
                last = std::get<core::PathModeChange>(lowering.lower(command).at(0));
    return last;
}

core::PathModeChange mode_of(std::string_view text, DialectId dialect) {
    return mode_of(text, known_environment(dialect));
}

core::PathModeChange siemens_mode(std::string_view text) {
    return mode_of(text, DialectId::siemens);
}

TEST(PathMode, OfLinuxcncRoundsRapidsAsFeeds) {
    const auto mode = mode_of("G21\nG64 P0.1\n", DialectId::linuxcnc);
    EXPECT_EQ(mode.tolerance, 0.1);
    EXPECT_EQ(mode.joining, 0.1) << "Q defaults to P";
    EXPECT_EQ(mode.rapid_tolerance, 0.1);
    EXPECT_FALSE(mode.between_kinds);
    EXPECT_EQ(mode_of("G21\nG64 P0.1 Q0.02\n", DialectId::linuxcnc).joining, 0.02);
    const auto unlimited = mode_of("G21\nG64 P0.1\nG64\n", DialectId::linuxcnc);
    EXPECT_EQ(unlimited.tolerance, std::nullopt);
    EXPECT_EQ(unlimited.rapid_tolerance, std::nullopt);
    EXPECT_FALSE(unlimited.rapids_keep_speed) << "there is nothing to meet";
    Environment described = known_environment(DialectId::linuxcnc);
    described.control.follows_start = true;
    EXPECT_TRUE(mode_of("G21\nG64 P0.1\nG64\n", described).rapids_keep_speed);
    EXPECT_FALSE(mode_of("G21\nG64\nG64 P0.1\n", described).rapids_keep_speed);
    EXPECT_FALSE(mode_of("G21\nG61\n", described).rapids_keep_speed);
}

TEST(PathMode, OfSiemensHasTheDistancesOfG641) {
    const auto mode = siemens_mode("G71\nG641 ADIS=0.5 ADISPOS=2\n");
    EXPECT_EQ(mode.distance, 0.5);
    EXPECT_EQ(mode.rapid_distance, 2.0);
    EXPECT_EQ(mode.tolerance, std::nullopt);
    EXPECT_TRUE(mode.between_kinds);
    EXPECT_EQ(siemens_mode("G71\nADIS=0.5\nG641\n").distance, 0.5) << "the value is kept";
    EXPECT_EQ(siemens_mode("G71\nR1=3 ADIS=R1/2\nG641\n").distance, 1.5);
    EXPECT_EQ(siemens_mode("G70\nG641 ADIS=0.1\n").distance, 2.54);
    EXPECT_EQ(siemens_mode("G71\nG641 ADIS=0.5\nG64\n").distance, std::nullopt);
    EXPECT_EQ(siemens_mode("G71\nG641 ADIS=0.5\nG60\n").blending, core::Blending::exact_stop);
    EXPECT_EQ(siemens_mode("G71\nG641 ADIS=0.5\nG60\nG641\n").distance, 0.5);
}

TEST(PathMode, OfSiemensHasTheToleranceOfTheContour) {
    const auto mode = siemens_mode("G71\nG642 CTOL=0.03\n");
    EXPECT_EQ(mode.tolerance, 0.03);
    EXPECT_EQ(mode.rapid_tolerance, 0.03);
    EXPECT_EQ(mode.joining, 0.0);
    EXPECT_EQ(siemens_mode("G71\nCOMPCAD\nG642 CTOL=0.03\n").joining, 0.03);
    EXPECT_EQ(siemens_mode("G71\nCOMPCAD\nG642 CTOL=0.03\nCOMPOF\n").joining, 0.0);
    const auto cycle = siemens_mode("G71\nCYCLE832(0.05,_ROUGH,1)\n");
    EXPECT_EQ(cycle.tolerance, 0.05);
    EXPECT_EQ(cycle.joining, 0.05);
    EXPECT_EQ(siemens_mode("G71\nCYCLE832(0.05,_ROUGH,1)\nCYCLE832(0,_OFF,1)\n").tolerance,
              std::nullopt);
    EXPECT_EQ(siemens_mode("G71\nG642\n").tolerance, std::nullopt) << "that of the machine";
}

TEST(PathMode, OfHaasHasTheAccuracyOfG187) {
    const auto mode = mode_of("O1\nG21\nG187 P1 E0.5\n", DialectId::haas);
    EXPECT_EQ(mode.tolerance, 0.5);
    EXPECT_EQ(mode.rapid_tolerance, std::nullopt) << "each rapid ends in position";
    EXPECT_EQ(mode_of("O1\nG20\nG187 E0.01\n", DialectId::haas).tolerance, 0.254);
    EXPECT_EQ(mode_of("O1\nG21\nG187 E0.5\nG61\nG64\n", DialectId::haas).tolerance, 0.5);
    EXPECT_EQ(mode_of("O1\nG21\nG187 E0.5\nG187 P2\n", DialectId::haas).tolerance, std::nullopt);
    EXPECT_EQ(mode_of("O1\nG21\nG187 E0.\n", DialectId::haas).blending, core::Blending::exact_stop);
}

TEST(PathMode, OfHeidenhainHasTheToleranceOfCycle32) {
    const auto mode = [](const char* tolerance) {
        return mode_of(std::string("BEGIN PGM T MM\nCYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 ")
                           + tolerance + "\nCYCL DEF 32.2 HSC-MODE:1 TA0.5\nEND PGM T MM\n",
                       DialectId::heidenhain);
    };
    EXPECT_EQ(mode("T0.05").tolerance, 0.05);
    EXPECT_EQ(mode("T0.05").rapid_tolerance, 0.05);
    EXPECT_EQ(mode("").tolerance, std::nullopt);
}

// Tool change positions.

Environment with_change(const ToolChangeMotion& motion) {
    Environment environment = known_environment(DialectId::linuxcnc);
    environment.start[0] = 1.0;
    environment.tool_change = motion;
    return environment;
}

std::string changed(const ToolChangeMotion& motion, std::string_view before = "") {
    const Ran ran =
        run_text("G21 G90 M3 S100\n" + std::string(before) + "T1 M6\n", with_change(motion));
    EXPECT_FALSE(ran.run.error);
    std::string text;
    for (const CanonicalCommand& command : ran.run.blocks.back().commands)
        text += to_text(command) + "\n";
    return text;
}

TEST(ToolChangeMotion, MovesBeforeTheToolIsChanged) {
    ToolChangeMotion motion;
    EXPECT_THAT(changed(motion), testing::Not(HasSubstr("straight_traverse")));
    motion.position[0] = 50.0;
    motion.position[1] = 115.0;
    motion.position[2] = -2.0;
    EXPECT_THAT(changed(motion), HasSubstr("spindle direction=stopped speed=0\n"
                                           "straight_traverse x=50 y=115 z=-2\n"
                                           "change_tool tool=1\n"));
}

TEST(ToolChangeMotion, RaisesTheQuillFirst) {
    ToolChangeMotion motion{.quill_up = true, .goes_to_second_home = true};
    motion.position[0] = 7.0;
    EXPECT_THAT(changed(motion, "G0 Z-9\n"), HasSubstr("straight_traverse x=1 y=0 z=0\n"
                                                       "straight_traverse x=0 y=0 z=-50\n"
                                                       "straight_traverse x=7 y=0 z=-50\n"
                                                       "change_tool"));
}

TEST(ToolChangeMotion, IsInMachineCoordinates) {
    Environment environment = with_change({.quill_up = true});
    environment.work_offsets[0] = {10.0, 20.0, -30.0};
    environment.tool_change.position[1] = 5.0;
    const Ran ran = run_text("G21 G90 G54\nG43.1 Z4\nG0 X0 Y0 Z0\nT1 M6\nG0 X1\n", environment);
    const std::string text = commands_of(ran.run);
    EXPECT_THAT(text, HasSubstr("straight_traverse x=0 y=0 z=26\n"
                                "straight_traverse x=0 y=-15 z=26\n"
                                "change_tool tool=1\n"));
    EXPECT_THAT(text, HasSubstr("straight_traverse x=1 y=-15 z=26\n")) << "it stays there";
}

TEST(ToolChangeMotion, MayKeepTheSpindleRunning) {
    EXPECT_THAT(changed({.keeps_spindle_running = true}),
                testing::Not(HasSubstr("spindle direction=stopped")));
}

// Start-up code.

TEST(StartupCode, SetsModesBeforeTheFirstBlock) {
    Environment environment = known_environment(DialectId::linuxcnc);
    environment.startup_code = "G20 G91 G64 P0.01";
    const Ran ran = run_text("G1 X1 F10\n", environment);
    EXPECT_THAT(commands_of(ran.run), HasSubstr("straight_feed x=25.4 y=0 z=0 feed=254\n"));
    EXPECT_EQ(initial_state(environment).modal.path_tolerance, 0.254);
}

TEST(StartupCode, MayNotMove) {
    Environment environment = known_environment(DialectId::linuxcnc);
    environment.startup_code = "G21 G0 X1";
    InterpreterState state;
    EXPECT_FALSE(run_startup_code(state, environment));
    environment.startup_code = "G21 Gx";
    EXPECT_FALSE(run_startup_code(state, environment));
    environment.startup_code = "G21";
    EXPECT_TRUE(run_startup_code(state, environment));
}

// Wrapped rotary axes.

TEST(WrappedRotary, TurnsInTheDirectionOfTheSign) {
    Environment environment = known_environment(DialectId::linuxcnc);
    environment.wrapped_axes = "A";
    const auto angles = [&](std::string_view text) {
        const Ran ran = run_text("G21 G90\n" + std::string(text), environment);
        return ran.run.error ? ran.run.error->message : commands_of(ran.run);
    };
    EXPECT_THAT(angles("G0 A90\nG0 A10\nG0 A-350\nG0 A-20\nG91 A5\n"),
                HasSubstr("straight_traverse x=0 y=0 z=0 a=90\n"
                          "straight_traverse x=0 y=0 z=0 a=370\n"
                          "straight_traverse x=0 y=0 z=0 a=350\n"
                          "straight_traverse x=0 y=0 z=0 a=20\n"
                          "straight_traverse x=0 y=0 z=0 a=25\n"));
    EXPECT_THAT(angles("G0 A360\n"), HasSubstr("below 360"));
}

} // namespace
} // namespace gcode
