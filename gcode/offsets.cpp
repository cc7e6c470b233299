#include "gcode/offsets.h"

#include <cmath>
#include <numbers>

namespace gcode {
namespace {

/// A linear map of X, Y and Z. What depends on an axis that nobody knows is not known either.
void map(const core::Mat3& linear, Position& position) {
    const Position before = position;
    for (int row = 0; row < 3; ++row) {
        std::optional<double> sum = 0.0;
        for (int column = 0; column < 3; ++column) {
            const double factor = linear[column][row]; // by columns
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
    const double angle = degrees * std::numbers::pi / 180.0;
    core::Mat3 turn(1.0);
    turn[0][0] = turn[1][1] = std::cos(angle);
    turn[0][1] = std::sin(angle);
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

} // namespace

Position machine_minus_program(const Offsets& offsets) {
    Position total = offsets.axis;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (total[axis])
            *total[axis] += offsets.work.origin[axis] + offsets.local[axis] + offsets.tool[axis];
    return total;
}

Position machine_from_program(const Offsets& offsets, const Position& program) {
    Position place = program;
    if (!offsets.has_frame && offsets.work.rotation_deg == 0.0) {
        add(place, machine_minus_program(offsets), +1.0);
        return place;
    }
    if (offsets.has_frame) {
        map(offsets.frame.linear, place);
        add(place, shift_of(offsets.frame), +1.0);
    }
    add(place, offsets.axis, +1.0);
    add(place, offsets.local, +1.0);
    if (offsets.work.rotation_deg != 0.0) map(turned_about_z(offsets.work.rotation_deg), place);
    add(place, offsets.work.origin, +1.0);
    add(place, offsets.tool, +1.0);
    return place;
}

Position program_from_machine(const Offsets& offsets, const Position& machine) {
    Position place = machine;
    if (!offsets.has_frame && offsets.work.rotation_deg == 0.0) {
        add(place, machine_minus_program(offsets), -1.0);
        return place;
    }
    add(place, offsets.tool, -1.0);
    add(place, offsets.work.origin, -1.0);
    if (offsets.work.rotation_deg != 0.0) map(turned_about_z(-offsets.work.rotation_deg), place);
    add(place, offsets.local, -1.0);
    add(place, offsets.axis, -1.0);
    if (offsets.has_frame) {
        add(place, shift_of(offsets.frame), -1.0);
        map(glm::inverse(offsets.frame.linear), place);
    }
    return place;
}

Offsets without_rotary_tool(Offsets offsets) {
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (is_rotary(axis)) offsets.tool[axis] = 0.0;
    return offsets;
}

core::AxisPosition linear_axes(const Position& position) {
    return {position[0], position[1], position[2]};
}

} // namespace gcode
