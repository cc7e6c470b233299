#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "gcode/lower/lowering.h"
#include "tests/gcode/klartext_programs.h"

namespace gcode {

inline constexpr double tool_length = 83.5;

/// A trunnion: C turns on A, which tilts about X; their axes do not meet.
inline core::Machine trunnion() {
    core::Machine machine;
    machine.axes[3] = {.direction = {1, 0, 0}, .side = core::Side::table, .point = {-3, 7, -401}};
    machine.axes[5] = {.direction = {0, 0, 1},
                       .side = core::Side::table,
                       .point = {-5, 4, 0},
                       .carrier = core::link_of(3)};
    machine.table = core::link_of(5);
    return machine;
}

/// A head that swivels about Y on a fork that turns about Z.
inline core::Machine fork_head() {
    core::Machine machine;
    machine.axes[5] = {
        .direction = {0, 0, 1}, .side = core::Side::tool, .carrier = core::link_of(2)};
    machine.axes[4] = {.direction = {0, 1, 0},
                       .side = core::Side::tool,
                       .point = {0, 0, 180},
                       .carrier = core::link_of(5)};
    machine.spindle = core::link_of(4);
    return machine;
}

inline Environment environment_of(const core::Machine& machine, DialectId dialect) {
    Environment environment = known_environment(dialect);
    environment.machine = std::make_shared<const core::Machine>(machine);
    environment.work_offsets[0] = {-12.0, 31.0, -380.0};
    environment.tool_lengths[core::ToolNumber(1)] = tool_length;
    return environment;
}

/// The motions of a program on a machine.
struct Driven {
    std::vector<core::Motion> motions;
    std::string warnings;
    std::vector<core::PathCertainty> paths; // of the blocks with motions
};

inline Driven driven(const std::string& text, const Environment& environment) {
    const Ran ran = run_text(text, environment);
    EXPECT_FALSE(ran.run.error) << ran.run.error->message;
    Driven found;
    Lowering lowering = initial_lowering(environment);
    for (const BlockCommands& block : ran.run.blocks) {
        const size_t before = found.motions.size();
        for (const core::Event& event : lower(block, lowering))
            if (const auto* motion = std::get_if<core::Motion>(&event))
                found.motions.push_back(*motion);
        if (found.motions.size() > before) found.paths.push_back(block.path);
        for (const Warning& warning : block.warnings) found.warnings += warning.message + "\n";
    }
    return found;
}

inline Driven driven_klartext(const std::string& lines, const core::Machine& machine) {
    return driven(klartext_program("TOOL CALL 1 Z S5000\n" + lines),
                  environment_of(machine, DialectId::heidenhain));
}

/// The same motions, with or without a path of the tip, and the same certainty of each block.
inline void expect_same_motions(const Driven& a, const Driven& b) {
    ASSERT_EQ(a.motions.size(), b.motions.size());
    for (size_t i = 0; i < a.motions.size(); ++i) {
        const core::Motion &one = a.motions[i], &other = b.motions[i];
        ASSERT_EQ(one.tip.has_value(), other.tip.has_value()) << i;
        for (size_t axis = 0; axis < 6; ++axis)
            ASSERT_NEAR(one.to[axis].value_or(-1e9), other.to[axis].value_or(1e9), 1e-9) << i;
        if (one.tip) {
            EXPECT_LT(glm::distance(one.tip->to, other.tip->to), 1e-9) << i;
        }
    }
    EXPECT_EQ(a.paths, b.paths);
}

/// Motions to the same positions but for the rounding of programmed directions.
inline void expect_same_ends(const Driven& a, const Driven& b) {
    ASSERT_EQ(a.motions.size(), b.motions.size());
    for (size_t i = 0; i < a.motions.size(); ++i)
        for (size_t axis = 0; axis < 6; ++axis)
            ASSERT_NEAR(a.motions[i].to[axis].value_or(0.0), b.motions[i].to[axis].value_or(0.0),
                        1e-6);
    EXPECT_EQ(a.paths, b.paths);
}

/// The same motions, all with a path of the tip and all certain.
inline void expect_same_tip_paths(const Driven& a, const Driven& b, size_t count) {
    EXPECT_EQ(a.motions.size(), count);
    for (const core::Motion& motion : a.motions) EXPECT_TRUE(motion.tip);
    for (const core::PathCertainty path : a.paths) EXPECT_EQ(path, core::PathCertainty{});
    expect_same_motions(a, b);
}

inline core::AxisValues values_of(const core::AxisPosition& position) {
    core::AxisValues values{};
    for (size_t axis = 0; axis < values.size(); ++axis) values[axis] = position[axis].value_or(0.0);
    return values;
}

/// The work offset of environment_of().
inline const core::Vec3 datum(-12.0, 31.0, -380.0);

/// Rotations of a point as the manual draws them, by hand.
inline core::Vec3 about_x(const core::Vec3& p, double degrees) {
    const double c = std::cos(degrees * M_PI / 180.0), s = std::sin(degrees * M_PI / 180.0);
    return {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
}
inline core::Vec3 about_y(const core::Vec3& p, double degrees) {
    const double c = std::cos(degrees * M_PI / 180.0), s = std::sin(degrees * M_PI / 180.0);
    return {c * p.x + s * p.z, p.y, -s * p.x + c * p.z};
}
inline core::Vec3 about_z(const core::Vec3& p, double degrees) {
    const double c = std::cos(degrees * M_PI / 180.0), s = std::sin(degrees * M_PI / 180.0);
    return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

} // namespace gcode
