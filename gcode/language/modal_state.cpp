#include "gcode/language/modal_state.h"

#include <cmath>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"

namespace gcode {
namespace {

/// Applies a linear map to X, Y and Z. Results that depend on an unknown axis are unknown.
void map(const core::Mat3& linear, Position& position) {
    const Position before = position;
    for (int row = 0; row < 3; ++row) {
        std::optional<double> sum = 0.0;
        for (int column = 0; column < 3; ++column) {
            const double factor = linear[column][row]; // column-major
            if (factor == 0.0) continue;
            const std::optional<double>& value = before[static_cast<size_t>(column)];
            if (sum && value)
                *sum += factor * *value;
            else
                sum.reset();
        }
        position[static_cast<size_t>(row)] = sum;
    }
}

core::Mat3 turned_about_z(double degrees) {
    const double angle = core::radians_of(degrees);
    core::Mat3 turn(1.0);
    turn[0][0] = turn[1][1] = core::cos(angle);
    turn[0][1] = core::sin(angle);
    turn[1][0] = -turn[0][1];
    return turn;
}

void add(Position& position, const AxisValues& values, double sign) {
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (position[axis]) *position[axis] += sign * values[axis];
}

void add(Position& position, const Position& values, double sign) {
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (position[axis] && values[axis])
            *position[axis] += sign * *values[axis];
        else
            position[axis].reset();
    }
}

AxisValues shift_of(const ProgramFrame& frame) {
    return {frame.shift.x, frame.shift.y, frame.shift.z};
}

/// Machine from table coordinates, with the rotary axes at the values for which X, Y and Z of the
/// work offset are valid: those stored in it, or 0.
core::Transform machine_from_table(const Offsets& offsets) {
    AxisValues rotary{};
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (is_rotary(axis) && !offsets.has_world) rotary[axis] = offsets.work.origin[axis];
    return core::machine_from_link(*offsets.machine, offsets.machine->table, rotary);
}

/// The values of all axes that the machine has; empty if one of them is unknown.
std::optional<AxisValues> known_values(const Offsets& offsets, const Position& position) {
    AxisValues values{};
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (offsets.machine->axes[axis].present && !position[axis]) return std::nullopt;
        values[axis] = position[axis].value_or(0.0);
    }
    return values;
}

void forget_linear(Position& position) {
    for (size_t axis = 0; axis < 3; ++axis) position[axis].reset();
}

/// Replaces the tip position in work coordinates by the linear axis values that reach it.
void reach_from_work(const Offsets& offsets, Position& position) {
    const auto values = known_values(offsets, position);
    std::optional<AxisValues> reached;
    if (values)
        reached =
            core::reach_tip(*offsets.machine, *values,
                            table_from_work(offsets, {(*values)[0], (*values)[1], (*values)[2]}),
                            offsets.machine->controlled_length(offsets.tool[2], *values));
    if (!reached) return forget_linear(position);
    for (size_t axis = 0; axis < 3; ++axis) position[axis] = (*reached)[axis];
}

/// The inverse: replaces linear axis values by the tip position in work coordinates.
void put_in_work(const Offsets& offsets, Position& position) {
    const auto values = known_values(offsets, position);
    if (!values) return forget_linear(position);
    const double length = offsets.machine->controlled_length(offsets.tool[2], *values);
    const core::Vec3 tip =
        machine_from_table(offsets) * core::tip_position(*offsets.machine, *values, length);
    for (size_t axis = 0; axis < 3; ++axis)
        position[axis] = glm::dot(tip, offsets.machine->axes[axis].direction);
}

/// The tool offset without its length, which counts along the tool.
AxisValues without_length(AxisValues tool) {
    tool[2] = 0.0;
    return tool;
}

} // namespace

double to_mm(double programmed, LengthUnit unit) {
    return unit == LengthUnit::inch ? programmed * core::mm_per_inch : programmed;
}

double from_mm(double length, LengthUnit unit) {
    return unit == LengthUnit::inch ? length / core::mm_per_inch : length;
}

core::Vec3 table_from_work(const Offsets& offsets, const core::Vec3& work) {
    return machine_from_table(offsets).inverse()
           * offsets.machine->linear_position({work.x, work.y, work.z});
}

Position machine_minus_program(const Offsets& offsets) {
    Position total = offsets.axis;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (total[axis])
            *total[axis] += offsets.work.origin[axis] + offsets.local[axis] + offsets.tool[axis];
    return total;
}

Position machine_from_program(const Offsets& offsets, const Position& program) {
    Position position = program;
    if (!mixes_axes(offsets)) {
        add(position, machine_minus_program(offsets), +1.0);
        return position;
    }
    if (offsets.has_frame) {
        map(offsets.frame.linear, position);
        add(position, shift_of(offsets.frame), +1.0);
    }
    add(position, offsets.axis, +1.0);
    add(position, offsets.local, +1.0);
    if (offsets.work.rotation_deg != 0.0) map(turned_about_z(offsets.work.rotation_deg), position);
    add(position, offsets.work.origin, +1.0);
    if (is_fixed_to_work(offsets)) {
        add(position, without_length(offsets.tool), +1.0);
        reach_from_work(offsets, position);
    } else {
        add(position, offsets.tool, +1.0);
    }
    return position;
}

Position program_from_machine(const Offsets& offsets, const Position& machine) {
    Position position = machine;
    if (!mixes_axes(offsets)) {
        add(position, machine_minus_program(offsets), -1.0);
        return position;
    }
    if (is_fixed_to_work(offsets)) {
        put_in_work(offsets, position);
        add(position, without_length(offsets.tool), -1.0);
    } else {
        add(position, offsets.tool, -1.0);
    }
    add(position, offsets.work.origin, -1.0);
    if (offsets.work.rotation_deg != 0.0) map(turned_about_z(-offsets.work.rotation_deg), position);
    add(position, offsets.local, -1.0);
    add(position, offsets.axis, -1.0);
    if (offsets.has_frame) {
        add(position, shift_of(offsets.frame), -1.0);
        map(glm::inverse(offsets.frame.linear), position);
    }
    return position;
}

Offsets counted_offsets(Offsets offsets) {
    if (offsets.has_world) offsets.follows_tip = offsets.has_world = false;
    return offsets;
}

Offsets without_rotary_tool(Offsets offsets) {
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (is_rotary(axis)) offsets.tool[axis] = 0.0;
    return offsets;
}

namespace {

struct Direction {
    double cosine, sine;
};

Direction direction_of(double degrees) {
    const double quarters = degrees / 90.0;
    if (quarters == std::floor(quarters)) {
        constexpr Direction exact[] = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
        const double turn = quarters - 4.0 * std::floor(quarters / 4.0);
        return exact[static_cast<size_t>(turn)];
    }
    const double angle = core::radians_of(degrees);
    return {core::cos(angle), core::sin(angle)};
}

/// Appends a linear map with fixed point `kept` to a frame.
void add_about(ProgramFrame& frame, const core::Mat3& linear, const core::Vec3& fixed_point) {
    frame.linear = linear * frame.linear;
    frame.shift = linear * (frame.shift - fixed_point) + fixed_point;
}

void add_mirror_and_scaling(ProgramFrame& frame, const ProgramTransforms& transforms) {
    core::Mat3 reflected(1.0);
    for (int axis = 0; axis < 3; ++axis)
        if (transforms.mirror.axes[static_cast<size_t>(axis)]) reflected[axis][axis] = -1.0;
    if (reflected != core::Mat3(1.0)) add_about(frame, reflected, transforms.mirror.position);
    if (!transforms.scaling) return;
    core::Mat3 stretched(1.0);
    for (int axis = 0; axis < 3; ++axis) stretched[axis][axis] = transforms.scaling->factors[axis];
    add_about(frame, stretched, transforms.scaling->centre);
}

} // namespace

core::Mat3 turned_about(int axis, double degrees) {
    const Direction direction = direction_of(degrees);
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    core::Mat3 turn(1.0);
    turn[first][first] = turn[second][second] = direction.cosine;
    turn[first][second] = direction.sine;
    turn[second][first] = -direction.sine;
    return turn;
}

ProgramFrame frame_of(const ProgramTransforms& transforms) {
    ProgramFrame frame;
    add_mirror_and_scaling(frame, transforms);
    if (const auto& rotation = transforms.rotation) {
        const double degrees = rotation->is_reversed ? -rotation->degrees : rotation->degrees;
        add_about(frame, turned_about(rotation->normal, degrees), rotation->centre);
    }
    if (const auto& tilt = transforms.tilt) {
        frame.linear = tilt->axes * frame.linear;
        frame.shift = tilt->axes * frame.shift + tilt->origin;
        frame.tilts_tool = tilt->axes[2] != core::Vec3(0.0, 0.0, 1.0);
    }
    frame.tilts_tool |= transforms.follows_vectors;
    return frame;
}

core::Vec3 scaled_point(const ProgramTransforms& transforms, const core::Vec3& position) {
    ProgramFrame frame;
    add_mirror_and_scaling(frame, transforms);
    return frame.linear * position + frame.shift;
}

void change_offsets(ModalState& modal, const Offsets& offsets) {
    if (mixes_axes(modal.offsets) || mixes_axes(offsets)) {
        modal.position =
            program_from_machine(offsets, machine_from_program(modal.offsets, modal.position));
        modal.offsets = offsets;
        return;
    }
    const Position before = machine_minus_program(modal.offsets);
    const Position after = machine_minus_program(offsets);
    modal.offsets = offsets;
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (before[axis] == after[axis]) continue;
        std::optional<double>& position = modal.position[axis];
        if (position && before[axis] && after[axis])
            *position += *before[axis] - *after[axis];
        else
            position.reset();
    }
}

} // namespace gcode
