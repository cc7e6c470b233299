#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/guard/live_motion.h"
#include "app/setup/hal_settings.h"
#include "app/setup/linuxcnc_kinematics.h"
#include "app/setup/program_settings.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "tests/app/linuxcnc_module.h"
#include "tests/gcode/driven_machine.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

using test_support::EmcPose;
using test_support::LinuxcncModule;

/// A module with values for its pins, in LinuxCNC and in the set-up.
struct Example {
    std::string module, coordinates;
    int tip; // the number of its kinematics that follow the tip
    std::vector<std::pair<std::string, double>> pins;
    std::string length_pin;
    double length_base = 0.0; // what the length pin holds without a tool
};

std::vector<Example> examples() {
    const std::vector<std::pair<std::string, double>> tilting_a = {
        {"xyzac-trt-kins.x-rot-point", -12.5},
        {"xyzac-trt-kins.y-rot-point", 31.0},
        {"xyzac-trt-kins.z-rot-point", -77.0},
        {"xyzac-trt-kins.y-offset", 20.0},
        {"xyzac-trt-kins.z-offset", 10.0}};
    const std::vector<std::pair<std::string, double>> tilting_b = {
        {"xyzbc-trt-kins.x-rot-point", -12.5},
        {"xyzbc-trt-kins.y-rot-point", 31.0},
        {"xyzbc-trt-kins.z-rot-point", -77.0},
        {"xyzbc-trt-kins.x-offset", -8.0},
        {"xyzbc-trt-kins.z-offset", 10.0}};
    const std::vector<std::pair<std::string, double>> two_tables = {
        {"xyzab_tdr_kins.x-rot-point", -50.0},
        {"xyzab_tdr_kins.y-rot-point", -49.0},
        {"xyzab_tdr_kins.z-rot-point", -100.0},
        {"xyzab_tdr_kins.x-offset", -20.0},
        {"xyzab_tdr_kins.z-offset", -10.0}};
    return {{"xyzac-trt-kins", "XYZAC", 0, tilting_a, "xyzac-trt-kins.tool-offset"},
            {"xyzbc-trt-kins", "XYZBC", 0, tilting_b, "xyzbc-trt-kins.tool-offset"},
            {"xyzab_tdr_kins", "XYZAB", 1, two_tables, "xyzab_tdr_kins.tool-offset-z"},
            {"5axiskins", "XYZBCW", 0, {}, "5axiskins.pivot-length", 250.0}};
}

/// The machine that the HAL commands of an example describe.
std::shared_ptr<const core::Machine> machine_of(const Example& example) {
    HalSettings hal;
    for (const auto& [pin, value] : example.pins)
        hal.add("setp " + pin + " " + std::to_string(value), {});
    if (example.length_base != 0.0) {
        for (const char* command :
             {"loadusr -W 5axisgui", "loadrt sum2 names=pivotsum",
              "net :gui-pivot-len <= 5axisgui.pivot_len", "net :gui-pivot-len => pivotsum.in0",
              "net :tool-len <= motion.tooloffset.z", "net :tool-len => pivotsum.in1",
              "net :pivot-len <= pivotsum.out", "net :pivot-len => 5axiskins.pivot-length"})
            hal.add(command, {});
    } else {
        hal.add("net tool motion.tooloffset.z " + example.length_pin, {});
    }
    const auto found = linuxcnc_kinematics(example.module, "", hal, {});
    EXPECT_TRUE(found);
    EXPECT_EQ(found->notes.size(), 1u); // where the axes are
    return found->switches.machine;
}

/// The joints of a position, by the letters of an example.
std::vector<double> joints_at(const Example& example, const core::AxisValues& values) {
    std::vector<double> joints(16, 0.0);
    for (size_t i = 0; i < example.coordinates.size(); ++i)
        joints[i] = values[core::axis_letters.find(example.coordinates[i])];
    return joints;
}

/// Random positions of the axes; the tip as Feeler and as LinuxCNC computes it, and back.
TEST(LinuxcncKinematics, AgreeWithTheModulesOfLinuxcnc) {
    std::mt19937 random(28);
    std::uniform_real_distribution<double> linear(-400.0, 400.0), angle(-400.0, 400.0),
        length(0.0, 200.0);
    for (const Example& example : examples()) {
        const auto machine = machine_of(example);
        ASSERT_TRUE(machine) << example.module;
        LinuxcncModule module(example.module);
        module.use(example.tip);
        for (const auto& [pin, value] : example.pins) module.set(pin, value);
        double farthest = 0.0;
        for (int sample = 0; sample < 2000; ++sample) {
            core::AxisValues values{};
            for (size_t axis = 0; axis < core::axis_count; ++axis)
                if (example.coordinates.find(core::axis_letters[axis]) != std::string::npos)
                    values[axis] = core::is_rotary(axis) ? angle(random) : linear(random);
            const double tool = length(random);
            module.set(example.length_pin, example.length_base + tool);
            std::vector<double> joints = joints_at(example, values);
            const EmcPose pose = module.forward(joints.data());
            // LinuxCNC counts Z without the tool length.
            const core::Vec3 theirs(pose.x, pose.y, pose.z - tool);
            const double own_length = machine->controlled_length(tool, values);
            const core::Vec3 ours = core::tip_position(*machine, values, own_length);
            farthest = std::max(farthest, glm::length(ours - theirs));
            ASSERT_LT(glm::length(ours - theirs), 1e-9) << example.module << " " << sample;

            std::vector<double> back(16, 0.0);
            module.inverse(pose, back.data());
            const auto reached = core::reach_tip(*machine, values, theirs, own_length);
            ASSERT_TRUE(reached);
            const std::vector<double> ours_back = joints_at(example, *reached);
            for (size_t joint = 0; joint < 3; ++joint)
                ASSERT_NEAR(ours_back[joint], back[joint], 1e-9) << example.module;
        }
        EXPECT_GT(farthest, 0.0) << example.module; // they are not the same code
    }
}

/// A motion as feeler_tp writes it into the ring, in these units.
feeler_segment queued(const Example& example, LinuxcncModule& module, const core::AxisValues& from,
                      const core::AxisValues& to, double tool) {
    feeler_segment motion{};
    motion.shape = FEELER_LINE;
    motion.tool_length = tool;
    motion.joints = static_cast<uint32_t>(example.coordinates.size());
    const auto joints = [&](double part, bool is_aside, double(&joint)[FEELER_JOINTS]) {
        constexpr double offset[] = FEELER_ASIDE;
        core::AxisValues at{};
        for (size_t i = 0; i < core::axis_count; ++i)
            at[i] = from[i] + part * (to[i] - from[i]) + (is_aside && i < 3 ? offset[i] : 0.0);
        const EmcPose pose{at[0], at[1], at[2], at[3], at[4], at[5], at[6], at[7], at[8]};
        module.inverse(pose, joint);
    };
    std::copy(from.begin(), from.end(), motion.from);
    std::copy(to.begin(), to.end(), motion.to);
    joints(0.0, false, motion.joint_from);
    joints(FEELER_BETWEEN, true, motion.joint_aside);
    joints(1.0, false, motion.joint_to);
    return motion;
}

/// The guard finds out which kinematics LinuxCNC uses, and what its joints do, from the motions in
/// the ring; and that pins are not those of the set-up.
TEST(LinuxcncKinematics, AreRecognizedInQueuedMotions) {
    std::mt19937 random(29);
    std::uniform_real_distribution<double> linear(-400.0, 400.0), angle(-400.0, 400.0),
        length(10.0, 200.0);
    for (const double unit : {1.0, 25.4})
        for (const Example& example : examples()) {
            LinuxcncModule module(example.module);
            for (const auto& [pin, value] : example.pins) module.set(pin, value);
            HalSettings hal;
            for (const auto& [pin, value] : example.pins)
                hal.add("setp " + pin + " " + std::to_string(value), {});
            hal.add("setp " + example.length_pin + " " + std::to_string(example.length_base), {});
            gcode::SwitchableKinematics switches =
                linuxcnc_kinematics(example.module, "", hal, {}, unit)->switches;
            const auto machine = switches.machine;
            ASSERT_TRUE(machine) << example.module;
            const ControlKinematics kinematics(unit, std::move(switches), *machine, 0.01);
            size_t recognized = 0, alike = 0;
            for (int sample = 0; sample < 500; ++sample) {
                core::AxisValues from{}, to{};
                for (size_t axis = 0; axis < core::axis_count; ++axis) {
                    if (example.coordinates.find(core::axis_letters[axis]) == std::string::npos)
                        continue;
                    from[axis] = core::is_rotary(axis) ? angle(random) : linear(random);
                    to[axis] = core::is_rotary(axis) ? angle(random) : linear(random);
                }
                to[8] = from[8]; // W bends the way of the tip
                if (sample % 5 == 0) to[4] = from[4] + 720.0;
                const bool is_tip = sample % 2 == 0;
                module.use(is_tip ? example.tip : 1 - example.tip);
                const double tool = length(random);
                module.set(example.length_pin, example.length_base + tool);
                const feeler_segment motion = queued(example, module, from, to, tool);
                const LiveMotion read = kinematics.read(motion);
                ASSERT_EQ(read.problem, "") << example.module << " " << sample;
                ASSERT_EQ(read.follows_tip, is_tip) << example.module << " " << sample;
                for (size_t joint = 0; joint < example.coordinates.size(); ++joint) {
                    const size_t axis = core::axis_letters.find(example.coordinates[joint]);
                    const double scale = core::is_rotary(axis) ? 1.0 : unit;
                    EXPECT_NEAR(read.axes_from[axis], scale * motion.joint_from[joint], 1e-7);
                    EXPECT_NEAR(read.axes_to[axis], scale * motion.joint_to[joint], 1e-7);
                }
                ++recognized;

                if (!is_tip) continue;
                // A tool, or a pivot, that the control has otherwise.
                module.set(example.length_pin, example.length_base + tool + 0.1);
                const feeler_segment elsewhere = queued(example, module, from, to, tool);
                const LiveMotion other = kinematics.read(elsewhere);
                if (other.problem.empty()) // it makes hardly any difference near to a level table
                    ++alike;
                else
                    EXPECT_THAT(other.problem, ::testing::HasSubstr("kinematics"));
                for (size_t joint = 0; joint < example.coordinates.size(); ++joint) {
                    const size_t axis = core::axis_letters.find(example.coordinates[joint]);
                    const double scale = core::is_rotary(axis) ? 1.0 : unit;
                    if (other.problem.empty()) {
                        EXPECT_NEAR(other.axes_to[axis], scale * elsewhere.joint_to[joint], 0.0101);
                    }
                }
            }
            EXPECT_EQ(recognized, 500u);
            EXPECT_LT(alike, 5u);
            feeler_segment unanswered{};
            unanswered.shape = FEELER_LINE;
            EXPECT_NE(kinematics.read(unanswered).problem, "");
        }
}

/// LinuxCNC as it moves, with its module: positions of the program are those of its world, which it
/// shifts by offsets and takes through the kinematics.
class Control {
public:
    Control(const Example& example, LinuxcncModule& module) : example_(example), module_(module) {
        module_.use(example_.tip);
    }

    core::AxisValues joints{};
    core::AxisValues work{}, shift{}; // G54 and G92
    double tool = 0.0;
    bool follows_tip = true;

    /// The position that LinuxCNC shows without offsets.
    core::AxisValues world() {
        if (!follows_tip) return joints;
        module_.set(example_.length_pin, example_.length_base + tool);
        const EmcPose pose = module_.forward(joints_at(example_, joints).data());
        return {pose.x, pose.y, pose.z, joints[3], joints[4], joints[5], 0.0, 0.0, joints[8]};
    }

    void go_to(const core::AxisValues& to) {
        joints = to;
        if (!follows_tip) return;
        module_.set(example_.length_pin, example_.length_base + tool);
        std::vector<double> found(16, 0.0);
        module_.inverse({to[0], to[1], to[2], to[3], to[4], to[5], 0.0, 0.0, to[8]}, found.data());
        for (size_t axis = 0; axis < 3; ++axis) joints[axis] = found[axis];
    }

    double offset(size_t axis) const { return work[axis] + shift[axis] + (axis == 2 ? tool : 0.0); }

private:
    const Example& example_;
    LinuxcncModule& module_;
};

/// Random programs that switch kinematics, set offsets and move in all ways. The axes are where
/// LinuxCNC's module puts them.
TEST(LinuxcncKinematics, MoveTheAxesAsLinuxcncDoes) {
    std::mt19937 random(29);
    const auto any = [&](double least, double most) {
        return std::round(std::uniform_real_distribution<double>(least, most)(random) * 1e3) / 1e3;
    };
    for (const Example& example : examples()) {
        LinuxcncModule module(example.module);
        for (const auto& [pin, value] : example.pins) module.set(pin, value);
        gcode::Environment environment = gcode::known_environment(gcode::DialectId::linuxcnc);
        environment.machine = machine_of(example);
        environment.work_offsets[0] = {3.0, -7.0, 11.0};
        environment.tool_lengths[core::ToolNumber(1)] = 60.0;
        auto& kinematics = environment.kinematics.emplace();
        using Type = gcode::SwitchableKinematics::Type;
        kinematics.types = {example.tip == 0 ? Type::tip : Type::axes,
                            example.tip == 0 ? Type::axes : Type::tip};
        kinematics.output = 3;
        Control control(example, module);
        control.work = environment.work_offsets[0];
        std::string program =
            fmt::format("G21 G90 G94 F500\nT1 M6\nM68 E3 Q{}\nM66 E0 L0\n", example.tip);
        std::vector<core::AxisValues> expected;
        const std::string axes = example.coordinates;
        for (int line = 0; line < 400; ++line) {
            const double kind = any(0.0, 20.0);
            const auto some_axes = [&] {
                std::string some;
                for (const char axis : axes)
                    if (any(0.0, 1.0) < 0.6) some += axis;
                // Else the block is not measured.
                if (control.follows_tip && some.find_first_of("ABC") != some.npos)
                    std::erase(some, 'W');
                return some.empty() ? std::string("X") : some;
            };
            const auto value_for = [&](char axis) {
                return core::is_rotary(core::axis_letters.find(axis)) ? any(-120.0, 120.0)
                                                                      : any(-200.0, 200.0);
            };
            core::AxisValues world = control.world();
            if (kind < 11.0) {
                std::string words;
                for (const char letter : some_axes()) {
                    const size_t axis = core::axis_letters.find(letter);
                    const double value = value_for(letter);
                    words += fmt::format(" {}{:.3f}", letter, value);
                    world[axis] = value + control.offset(axis);
                }
                program += (kind < 5.0 ? "G0" : "G1") + words + "\n";
                control.go_to(world);
                expected.push_back(control.joints);
            } else if (kind < 13.0) {
                std::string words;
                for (const char letter : some_axes()) {
                    const double value = value_for(letter);
                    words += fmt::format(" {}{:.3f}", letter, value);
                    world[core::axis_letters.find(letter)] = value;
                }
                program += "G53 G0" + words + "\n";
                control.go_to(world);
                expected.push_back(control.joints);
            } else if (kind < 15.0) {
                control.follows_tip = !control.follows_tip;
                const int type = control.follows_tip ? example.tip : 1 - example.tip;
                program += fmt::format("M68 E3 Q{}\nM66 E0 L0\n", type);
            } else if (kind < 16.0) {
                std::string words;
                for (const char letter : axes) {
                    const double value = value_for(letter) / 10.0;
                    words += fmt::format(" {}{:.4f}", letter, value);
                    control.work[core::axis_letters.find(letter)] = value;
                }
                program += "G10 L2 P1" + words + "\n";
            } else if (kind < 17.5) {
                const double value = value_for('X');
                const size_t axis = core::axis_letters.find(axes[3]);
                program += fmt::format("G10 L20 P1 Y{:.3f} {}{:.3f}\n", value, axes[3], value);
                control.work[1] += world[1] - control.offset(1) - value;
                control.work[axis] += world[axis] - control.offset(axis) - value;
            } else if (kind < 18.5) {
                const double value = value_for('X');
                program += fmt::format("G92 X{:.3f}\n", value);
                control.shift[0] += world[0] - control.offset(0) - value;
            } else {
                // The tool length changes with the rotary axes at 0, where nothing jumps.
                std::string words;
                for (size_t i = 3; i < 5; ++i) {
                    words += fmt::format(" {}0", axes[i]);
                    world[core::axis_letters.find(axes[i])] = 0.0;
                }
                program += "G53 G0" + words + "\n";
                control.go_to(world);
                expected.push_back(control.joints);
                control.tool = control.tool == 0.0 ? 60.0 : 0.0;
                program += control.tool == 0.0 ? "G49\n" : "G43 H1\n";
            }
        }
        const gcode::Driven found = gcode::driven(program, environment);
        EXPECT_EQ(found.warnings.find("not checked"), std::string::npos) << found.warnings;
        std::vector<core::AxisValues> reached;
        for (const core::Motion& motion : found.motions)
            reached.push_back(gcode::values_of(motion.to));
        ASSERT_EQ(reached.size(), expected.size()) << example.module;
        for (size_t i = 0; i < expected.size(); ++i)
            for (size_t axis = 0; axis < core::axis_count; ++axis)
                ASSERT_NEAR(reached[i][axis], expected[i][axis], 1e-6)
                    << example.module << " motion " << i << " axis " << axis << "\n"
                    << program;
    }
}

/// W moves the tip on a line that is straight only if the tool does not turn meanwhile.
TEST(LinuxcncKinematics, DoNotMeasureWTogetherWithARotaryAxis) {
    gcode::Environment environment = gcode::known_environment(gcode::DialectId::linuxcnc);
    environment.machine = machine_of(examples()[3]);
    environment.tool_lengths[core::ToolNumber(1)] = 60.0;
    environment.kinematics.emplace().types = {gcode::SwitchableKinematics::Type::tip,
                                              gcode::SwitchableKinematics::Type::axes};
    const auto last = [&](const std::string& lines) {
        return gcode::driven("G21 G90 G94 F500\nT1 M6\nG43 H1\nG0 X0 Y0 Z20 B30 W0\nG0 W3\n"
                                 + lines,
                             environment)
            .paths.back();
    };
    using core::PathCertainty;
    EXPECT_EQ(last("G0 W5\n"), PathCertainty::known);
    EXPECT_EQ(last("G1 W5 X3\n"), PathCertainty::known);
    EXPECT_EQ(last("G0 B20\n"), PathCertainty::known);
    EXPECT_EQ(last("G53 G0 C180\n"), PathCertainty::known);
    for (const char* block : {"G0 W5 B20\n", "G1 W5 C1\n", "G53 G0 C180 W5\n", "G28\n"})
        EXPECT_EQ(last(block), PathCertainty::unknown) << block;
    EXPECT_EQ(last("G0 W5 B20\nG0 X5\n"), PathCertainty::known) << "its end is known";
}

/// Without the ini file, M428 has two readings on a machine with rotary axes.
TEST(LinuxcncKinematics, AreSwitchedByM428AsTheUserStates) {
    gcode::Environment environment = gcode::known_environment(gcode::DialectId::linuxcnc);
    environment.machine = machine_of(examples()[0]);
    const std::string program = "G21 G90\nM428\nG0 A30\nM429\nG0 A0\n";
    const auto follows = [&](double m428_is_tip) {
        environment.control.answers[gcode::ControlQuestion::m428_follows_tip] = m428_is_tip;
        const gcode::Driven found = gcode::driven(program, environment);
        EXPECT_EQ(found.motions.size(), 2u);
        return std::pair(found.motions.front().tip.has_value(),
                         found.motions.back().tip.has_value());
    };
    EXPECT_EQ(follows(1.0), std::pair(true, false));
    EXPECT_EQ(follows(0.0), std::pair(false, true));
}

TEST(LinuxcncKinematics, KnowWhichOfThemIsActiveAtTheStart) {
    using Type = gcode::SwitchableKinematics::Type;
    HalSettings hal;
    hal.add("net sel <= motion.analog-out-03 => motion.switchkins-type", {});
    const auto first = [&](const std::string& module, const std::string& settings) {
        return linuxcnc_kinematics(module, settings, hal, {})->switches.types.front();
    };
    EXPECT_EQ(first("xyzac-trt-kins", ""), Type::tip);
    EXPECT_EQ(first("xyzac-trt-kins", "sparm=identityfirst"), Type::axes);
    EXPECT_EQ(first("xyzab_tdr_kins", ""), Type::axes);
    EXPECT_EQ(first("xyzacb_trsrn", ""), Type::axes);
    EXPECT_EQ(linuxcnc_kinematics("xyzac-trt-kins", "", hal, {})->switches.output, 3);
    EXPECT_FALSE(linuxcnc_kinematics("genhexkins", "", hal, {}));
}

TEST(LinuxcncKinematics, HavePinsInTheUnitOfTheMachine) {
    const test_support::ScopedFolder folder;
    const auto pivot = [&](const std::string& unit) {
        ProgramSettings settings;
        settings.ini =
            folder.write("mill.ini", "[TRAJ]\nLINEAR_UNITS = " + unit
                                         + "\n[KINS]\nKINEMATICS = xyzac-trt-kins\n"
                                           "[HAL]\nHALCMD = setp xyzac-trt-kins.y-offset 2\n");
        gcode::Environment environment;
        const auto applied = apply(settings, environment);
        EXPECT_TRUE(applied.has_value());
        return environment.kinematics.value().machine->axes[3].point.y;
    };
    EXPECT_DOUBLE_EQ(pivot("mm"), 2.0);
    EXPECT_DOUBLE_EQ(pivot("inch"), 50.8);
}

/// The guard compares the tables of the control with the set-up, so it must not read them itself.
TEST(LinuxcncKinematics, AreReadWithoutTheTablesOfTheControl) {
    const test_support::ScopedFolder folder;
    folder.write("tool.tbl", "T1 P1 Z50\n");
    ProgramSettings settings;
    settings.ini = folder.write("mill.ini", "[EMCIO]\nTOOL_TABLE = tool.tbl\n[KINS]\nKINEMATICS = "
                                            "xyzac-trt-kins\n[HAL]\nHALCMD = setp "
                                            "xyzac-trt-kins.y-offset 2\n");
    for (const bool ignores : {false, true}) {
        settings.ignores_tables = ignores;
        gcode::Environment environment;
        ASSERT_TRUE(apply(settings, environment).has_value());
        EXPECT_EQ(environment.length_offsets.empty(), ignores);
        EXPECT_TRUE(environment.kinematics.has_value());
    }
}

/// The tip of a nutating head, against rotations written down by hand.
TEST(LinuxcncKinematics, OfANutatingHeadTurnAboutAnInclinedAxis) {
    HalSettings hal;
    for (const char* command :
         {"setp xyzacb_trsrn_kins.nut-angle 45", "setp xyzacb_trsrn_kins.z-pivot 100",
          "setp xyzacb_trsrn_kins.y-rot-axis -300", "setp xyzacb_trsrn_kins.z-rot-axis -500",
          "net t motion.tooloffset.z xyzacb_trsrn_kins.tool-offset-z"})
        hal.add(command, {});
    const auto found = linuxcnc_kinematics("xyzacb_trsrn", "", hal, {});
    ASSERT_TRUE(found && found->switches.machine);
    const core::Machine& machine = *found->switches.machine;
    // Half a turn about an axis at 45 degrees between +Y and +Z lays the tool along Y.
    core::AxisValues values{};
    values[4] = 180.0;
    const core::Vec3 tip = core::tip_position(machine, values, 50.0);
    EXPECT_NEAR(tip.x, 0.0, 1e-9);
    EXPECT_NEAR(tip.y, -150.0, 1e-9);
    EXPECT_NEAR(tip.z, 100.0, 1e-9);
    values[5] = 90.0; // and then about Z
    const core::Vec3 turned = core::tip_position(machine, values, 50.0);
    EXPECT_NEAR(turned.x, 150.0, 1e-9);
    EXPECT_NEAR(turned.y, 0.0, 1e-9);
}

TEST(HalSettings, AreValuesOfPinsAndTheirSignals) {
    HalSettings hal;
    const std::map<std::string, double> ini = {{"_ini[kins]deep", 12.0}};
    for (const char* command :
         {"# a comment", "setp k.one 1.5 # as measured", "net two k.two other.two", "sets two -3",
          "newsig three float", "linksp three k.three", "setp k.four [KINS]DEEP",
          "net panel k.five pyvcp.depth-f", "net open k.six", "loadrt sum2 names=s,t",
          "net x k.seven t.out", "setp t.in0 5", "setp t.in1 2", "setp t.gain1 -1",
          "setp k.eight TRUE", "k.nine = 4", "setp k.ten \"10\"", "setp k.eleven [KINS](DEEP)",
          "setp k.twelve unknown"})
        hal.add(command, ini);
    EXPECT_EQ(hal.value("k.one"), 1.5);
    EXPECT_EQ(hal.value("k.two"), -3.0);
    EXPECT_EQ(hal.value("k.four"), 12.0);
    EXPECT_EQ(hal.value("k.three"), std::nullopt); // nobody sets the signal
    EXPECT_EQ(hal.value("k.five"), std::nullopt);
    EXPECT_EQ(hal.value("k.six"), std::nullopt);
    EXPECT_EQ(hal.value("k.seven"), 3.0);
    EXPECT_EQ(hal.value("k.eight"), 1.0);
    EXPECT_EQ(hal.value("k.nine"), 4.0);
    EXPECT_EQ(hal.value("k.ten"), 10.0);
    EXPECT_EQ(hal.value("k.eleven"), 12.0);
    EXPECT_EQ(hal.value("k.twelve"), std::nullopt);
    EXPECT_EQ(hal.value("k.unconnected"), 0.0);
    EXPECT_EQ(hal.values().at("_hal[k.two]"), -3.0);
    hal.add("source more.hal", {});
    EXPECT_EQ(hal.value("k.unconnected"), std::nullopt);
}

} // namespace
} // namespace app
