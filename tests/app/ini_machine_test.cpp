#include <fstream>

#include <gtest/gtest.h>

#include "app/setup/ini_file.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "gcode/language/dialect.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

/// The machine of a set-up whose program is read with this ini file.
core::Machine machine_of(const std::string& ini, const std::string& axes = "") {
    const test_support::ScopedFolder folder;
    std::ofstream(folder / "mill.ini") << ini;
    std::ofstream(folder / "setup.toml") << "[program]\ndialect = \"linuxcnc\"\n[stock]\nbox = "
                                            "[[0,0,0],[1,1,1]]\n[offsets]\nG54 = { X = 1 }\n"
                                         << axes;
    ProgramSettings settings;
    settings.ini = folder / "mill.ini";
    const auto file = read_setup(folder / "setup.toml", settings);
    EXPECT_TRUE(file) << (file ? "" : file.error().message);
    return file ? file->setup.machine : core::Machine{};
}

constexpr const char* metric = "[TRAJ]\nLINEAR_UNITS = mm\n"
                               "[AXIS_X]\nMIN_LIMIT = -5\nMAX_LIMIT = 500\nMAX_VELOCITY = 50\n"
                               "MAX_ACCELERATION = 750\n[JOINT_0]\nHOME = 1\n"
                               "[AXIS_Y]\nMAX_LIMIT = 300\n[JOINT_1]\nHOME = 2\n"
                               "[JOINT_2]\nMIN_LIMIT = -100\nHOME = 3\n";

TEST(IniMachine, HasTheLimitsSpeedsAndHomesOfTheFile) {
    const core::Machine machine = machine_of(metric);
    EXPECT_EQ(machine.axes[0].min, -5.0);
    EXPECT_EQ(machine.axes[0].max, 500.0);
    EXPECT_EQ(machine.axes[0].rapid, 3000.0);
    EXPECT_EQ(machine.axes[0].acceleration, 750.0);
    EXPECT_EQ(machine.axes[0].home, 1.0);
    EXPECT_EQ(machine.axes[1].min, std::nullopt);
    EXPECT_EQ(machine.axes[1].max, 300.0);
    EXPECT_EQ(machine.axes[1].home, 2.0);
    EXPECT_EQ(machine.axes[2].min, -100.0);
    EXPECT_EQ(machine.axes[2].home, 3.0);
}

/// An axis that replaces one of a machine file leaves the others connected as they were.
TEST(IniMachine, KeepsTheChainOfAMachineFile) {
    const std::string file =
        "file = \"" + std::string(FEELER_SOURCE_DIR) + "/assets/machines/mill3.toml\"\n";
    const auto with = [&](const std::string& axes) {
        return machine_of("", "[machine]\n" + file + axes);
    };
    const core::Machine plain = with(""),
                        lower = with("[[machine.axis]]\nname = \"Z\"\nmin = -300\n"),
                        shorter =
                            with("[[machine.axis]]\nname = \"X\"\nside = \"table\"\nmax = 0\n"),
                        rotary = with("[[machine.axis]]\nname = \"A\"\npoint = [0, 0, -100]\n");
    EXPECT_EQ(plain.axes[0].carrier, core::link_of(1));
    EXPECT_EQ(plain.table, core::link_of(0));
    EXPECT_EQ(lower.axes[0].carrier, core::link_of(1));
    EXPECT_EQ(lower.table, core::link_of(0));
    EXPECT_EQ(lower.spindle, core::link_of(2));
    EXPECT_EQ(lower.axes[2].min, -300.0);
    EXPECT_EQ(shorter.axes[0].carrier, core::link_of(1));
    EXPECT_EQ(shorter.table, core::link_of(0));
    EXPECT_EQ(rotary.axes[3].carrier, core::link_of(0)) << "on the end of the table side";
    EXPECT_EQ(rotary.table, core::link_of(3));
}

/// A set-up in a folder of its own, with an ini file and a tool table.
core::Result<SetupFile> read_with_ini(const std::string& program_table,
                                      const ProgramSettings& options = {}) {
    const test_support::ScopedFolder folder;
    std::filesystem::create_directories(folder / "control");
    std::ofstream(folder / "control/mill.ini")
        << metric << "[EMCIO]\nTOOL_TABLE = mill.tbl\nTOOL_CHANGE_QUILL_UP = 1\n";
    std::ofstream(folder / "control/mill.tbl") << "T3 P3 Z-25.5 D6\n";
    std::ofstream(folder / "setup.toml")
        << "[program]\n"
        << program_table << "[stock]\nbox = [[0,0,0],[1,1,1]]\n[offsets]\nG54 = { X = 1 }\n";
    return read_setup(folder / "setup.toml", options);
}

TEST(IniMachine, CanBeNamedInTheSetup) {
    const auto file = read_with_ini("ini = \"control/mill.ini\"\n");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->setup.machine.axes[0].max, 500.0);
    EXPECT_TRUE(file->environment.tool_change.quill_up);
    EXPECT_EQ(file->dialect, gcode::DialectId::linuxcnc);
    EXPECT_TRUE(file->tool_table.ends_with("control/mill.tbl")) << file->tool_table;
    EXPECT_EQ(file->environment.length_offsets.count(core::OffsetNumber{3}), 1u);
}

TEST(IniMachine, LeavesTheDialectThatIsStated) {
    const auto file = read_with_ini("ini = \"control/mill.ini\"\ndialect = \"fanuc\"\n");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->dialect, gcode::DialectId::fanuc);
}

TEST(IniMachine, IsTheOneOfTheOptionsIfBothAreStated) {
    ProgramSettings options;
    options.ini = "/missing/other.ini";
    const auto file = read_with_ini("ini = \"control/mill.ini\"\n", options);
    ASSERT_FALSE(file);
    EXPECT_NE(file.error().file.find("other.ini"), std::string::npos);
}

TEST(IniMachine, CountsInTheFilesUnit) {
    const core::Machine machine =
        machine_of("[TRAJ]\nLINEAR_UNITS = inch\n[AXIS_Z]\nMIN_LIMIT = -4\nMAX_VELOCITY = 1\n");
    EXPECT_DOUBLE_EQ(machine.axes[2].min.value_or(0.0), -101.6);
    EXPECT_DOUBLE_EQ(machine.axes[2].rapid.value_or(0.0), 1524.0);
}

TEST(IniMachine, GivesWayToWhatTheSetupSays) {
    const core::Machine machine = machine_of(
        metric, "[[machine.axis]]\nname = \"X\"\nmax = 400\n[[machine.axis]]\nname = \"Y\"\n"
                "[[machine.axis]]\nname = \"Z\"\n");
    EXPECT_EQ(machine.axes[0].max, 400.0);
    EXPECT_EQ(machine.axes[0].min, -5.0);
}

TEST(IniMachine, SaysThatThePositionOfARotaryAxisIsUnknown) {
    gcode::Environment environment;
    environment.ini_values = {{"_ini[axis_a]max_velocity", 30.0}, {"_ini[joint_0]home", 0.0}};
    core::Machine machine;
    const std::string note = complete_machine(machine, environment, true);
    EXPECT_NE(note.find("axis A"), std::string::npos) << note;
    EXPECT_FALSE(machine.axes[3].present);
}

TEST(IniMachine, TakesNoLimitsForAnInferredSetup) {
    gcode::Environment environment;
    environment.ini_values = {{"_ini[axis_x]max_limit", 30.0}, {"_ini[axis_x]max_velocity", 10.0}};
    core::Machine machine;
    EXPECT_FALSE(complete_machine(machine, environment, false).empty());
    EXPECT_EQ(machine.axes[0].max, std::nullopt);
    EXPECT_EQ(machine.axes[0].rapid, 600.0);
}

TEST(IniFile, HasTheToolChangePositionInUnitsOfTheMachine) {
    const test_support::ScopedFolder folder;
    const auto motion_of = [&](const std::string& keys) {
        std::ofstream(folder / "mill.ini") << "[EMCIO]\n" << keys;
        const auto ini = read_ini(folder / "mill.ini");
        EXPECT_TRUE(ini);
        return tool_change_motion(*ini, gcode::LengthUnit::inch);
    };
    const auto none = motion_of("");
    EXPECT_EQ(none.position, gcode::Position{});
    EXPECT_FALSE(none.quill_up || none.goes_to_second_home || none.keeps_spindle_running);
    const auto three = motion_of("TOOL_CHANGE_POSITION = 1 -2 0.5\nTOOL_CHANGE_QUILL_UP = 1\n");
    EXPECT_EQ(three.position[0], 25.4);
    EXPECT_EQ(three.position[1], -50.8);
    EXPECT_EQ(three.position[2], 12.7);
    EXPECT_EQ(three.position[3], std::nullopt);
    EXPECT_TRUE(three.quill_up);
    const auto nine = motion_of("TOOL_CHANGE_POSITION = 1 2 3 90 0 0 4 0 0\n"
                                "TOOL_CHANGE_AT_G30 = YES\nTOOL_CHANGE_WITH_SPINDLE_ON = 1\n");
    EXPECT_EQ(nine.position[3], 90.0) << "degrees";
    EXPECT_EQ(nine.position[6], 101.6);
    EXPECT_TRUE(nine.goes_to_second_home && nine.keeps_spindle_running);
    std::ofstream(folder / "mill.ini") << "[EMCIO]\nTOOL_CHANGE_POSITION = 1 2\n";
    EXPECT_FALSE(read_ini(folder / "mill.ini"));
}

} // namespace
} // namespace app
