#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "gcode/exec/following.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/klartext/klartext.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

constexpr double rounding = 1e-9;

double value_of(const Execution& execution, char letter) {
    const Word* word = execution.statement.word(letter);
    return word ? word->value : 0.0;
}

core::Vec3 vector_of(const Execution& execution, const char* letters) {
    return {value_of(execution, letters[0]), value_of(execution, letters[1]),
            value_of(execution, letters[2])};
}

/// The axes with this normal, and X as near as possible to a direction.
core::Result<core::Mat3> axes_with(const Execution& execution, const core::Vec3& normal,
                                   const core::Vec3& along, const char* parallel) {
    const core::Vec3 y = glm::cross(normal, along);
    if (!(glm::length(y) > rounding * glm::length(normal) * glm::length(along)))
        return refuse_statement(execution, parallel);
    const core::Vec3 z = glm::normalize(normal), across = glm::normalize(y);
    return core::Mat3(glm::cross(across, z), across, z);
}

/// The plane at positions of the rotary axes.
core::Result<core::Mat3> axial_plane(const Execution& execution) {
    const Offsets& offsets = execution.modal().offsets;
    using Kind = Transforms::Kind;
    for (const Kind kind : klartext_of(execution.state).transforms.order)
        if (kind == Kind::turn || kind == Kind::mirror)
            return refuse_statement(execution, "PLANE AXIAL while a rotation or a mirror image is "
                                               "on is not supported yet: use PLANE SPATIAL");
    if (!offsets.machine)
        return refuse_statement(execution, "this needs the rotary axes of the machine: describe "
                                           "them in a set-up as [[machine.axis]]");
    AxisValues values{};
    const Position now = machine_from_program(offsets, execution.modal().position);
    for (size_t axis = 3; axis < 6; ++axis) {
        const Word* word = execution.statement.word("IJK"[axis - 3]);
        if (word && !offsets.machine->axes[axis].present)
            return refuse_statement(execution,
                                    fmt::format("this machine has no axis {}", axis_letters[axis]));
        values[axis] = word ? word->value : now[axis].value_or(0.0);
    }
    return turned_about(2, -offsets.work.rotation_deg) * core::tool_frame(*offsets.machine, values);
}

/// The directions of the axes of the plane, as columns, in the coordinates in which it is defined.
///
/// Source: Heidenhain TNC 640 user's manual Klartext programming, "The PLANE function".
core::Result<core::Mat3> axes_of_plane(const Execution& execution) {
    const core::Vec3 first = vector_of(execution, "IJK"), second = vector_of(execution, "LNO");
    switch (klartext_of(execution.block).plane) {
    case PlaneForm::spatial:
        return spatial_rotation(first);
    case PlaneForm::relative:
        return klartext_of(execution.state).transforms.plane * spatial_rotation(first);
    case PlaneForm::euler:
        return turned_about(2, first[0]) * turned_about(0, first[1]) * turned_about(2, first[2]);
    case PlaneForm::vector:
        return axes_with(execution, second, first,
                         "the normal vector is 0, or parallel to the base vector");
    case PlaneForm::points:
        return axes_with(execution, glm::cross(second - first, vector_of(execution, "PQR") - first),
                         second - first, "the three points are on a line");
    case PlaneForm::axial:
        return axial_plane(execution);
    case PlaneForm::reset:
        break;
    }
    return core::Mat3(1.0);
}

/// Whether the statement itself says where the rotary axes have to be.
bool states_positions(const KlartextLine& command) {
    return command.kind == CommandKind::plane
           && (command.plane == PlaneForm::axial || command.plane == PlaneForm::reset);
}

/// The axis that TABLE ROT turns: that of the table which is nearest to the work, if it is parallel
/// to the tool, and the plane is level and so does not tilt it.
std::optional<size_t> axis_of_table_rotation(const Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    const core::Mat3& plane = klartext_of(execution.state).transforms.plane;
    if (!command.turns_table || states_positions(command)
        || glm::distance(plane[2], core::Vec3(0.0, 0.0, 1.0)) > rounding)
        return std::nullopt;
    const core::Machine& machine = *execution.modal().offsets.machine;
    const auto axis = core::axis_next_to_work(machine);
    const bool is_free = axis && std::abs(machine.axes[*axis].direction.z) > 1.0 - rounding;
    return is_free ? axis : std::nullopt;
}

/// TABLE ROT: turns X of the plane to X of the machine.
///
/// Source: HEIDENHAIN TNC7, user's manual, "Transformation types": COORD ROT and TABLE ROT differ
///         only in a free rotary axis.
core::Result<void> turn_table(const Execution& execution, size_t axis, AxisValues& values) {
    const Offsets& offsets = execution.modal().offsets;
    const core::Machine& machine = *offsets.machine;
    const core::Vec3 x(1.0, 0.0, 0.0);
    const auto off = [&](double angle) { // between X of the plane and X of the machine
        AxisValues turned = values;
        turned[axis] = angle;
        return glm::distance(core::machine_from_link(machine, machine.table, turned).rotation
                                 * direction_in_table(offsets, x),
                             x);
    };
    const core::Vec3 there = direction_in_table(offsets, x);
    double angle = core::degrees_per_radian * core::atan2(there.y, there.x);
    if (off(-angle) < off(angle)) angle = -angle;
    if (glm::determinant(offsets.frame.linear) < 0.0 || off(angle) > 1e-9)
        return refuse_statement(execution, "TABLE ROT of a level plane is not supported yet for "
                                           "this machine or after a mirror image: use COORD ROT");
    const core::MachineAxis& own = machine.axes[axis];
    angle += 360.0 * core::round((values[axis] - angle) / 360.0);
    for (const double turns : {0.0, -360.0, 360.0}) {
        const double end = angle + turns;
        if (end < own.min.value_or(end) - rounding || end > own.max.value_or(end) + rounding)
            continue;
        values[axis] = end;
        return {};
    }
    return refuse_statement(execution,
                            fmt::format("TABLE ROT: axis {} cannot turn to {:.6g} degrees within "
                                        "its limits",
                                        axis_letters[axis], angle));
}

/// Where the rotary axes have to be for the plane that is on; linear axes as they are.
core::Result<AxisValues> axes_for_plane(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    const Offsets& offsets = execution.modal().offsets;
    const Position now = machine_from_program(offsets, execution.modal().position);
    if (states_positions(command)) {
        AxisValues values{};
        for (size_t axis = 0; axis < axis_count; ++axis) {
            const bool turns = axis >= 3 && axis < 6 && offsets.machine->axes[axis].present;
            const Word* word = turns ? execution.statement.word("IJK"[axis - 3]) : nullptr;
            const bool returns = turns && command.plane == PlaneForm::reset;
            values[axis] = word ? word->value : returns ? 0.0 : now[axis].value_or(0.0);
        }
        return values;
    }
    FEELER_TRY(AxisValues values,
               axes_along_z(execution, command.span, words_of(execution), command.solution));
    if (const auto axis = axis_of_table_rotation(execution))
        if (auto done = turn_table(execution, *axis, values); !done)
            return tl::unexpected(std::move(done).error());
    return values;
}

/// MB: along the tool, before the rotary axes turn. To the limit of Z if that is known.
void retract(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    if (!command.retracts) return;
    const Offsets& offsets = execution.modal().offsets;
    Position end = execution.modal().position;
    if (execution.statement.word('H') && end[2]) {
        *end[2] += length_of(execution, *execution.statement.word('H'));
        return execution.traverse(end);
    }
    Position machine = machine_from_program(offsets, execution.modal().position);
    const auto limit = offsets.machine ? offsets.machine->axes[2].max : std::optional<double>();
    if (limit && is_upright(*offsets.machine, machine)) {
        machine[2] = *limit;
        return execution.traverse(program_from_machine(offsets, machine));
    }
    lose_positions(execution, command.span,
                   fmt::format("{}: how far MB MAX retracts is not known. This block and later "
                               "ones are not checked until X, Y and Z have been programmed again",
                               words_of(execution)),
                   "State the limits of the axes in the set-up, or retract in a block before it.");
}

void go(Execution& execution, const Position& end) {
    const std::optional<double> feed = execution.modal().feed;
    if (klartext_of(execution.block).rapid || !feed || !(*feed > 0.0))
        execution.traverse(end);
    else
        execution.feed(end, *feed);
}

/// Whether the positions of the rotary axes for the plane are certain.
core::Result<void> check_positions(const Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    const Offsets& offsets = execution.modal().offsets;
    if (const auto axis = axis_with_rotary_offset(offsets))
        return refuse_statement(execution,
                                fmt::format("a tilted plane while axis {} has an offset is not "
                                            "supported yet: set its offset to 0",
                                            axis_letters[*axis]));
    if (states_positions(command)) return {};
    const auto& order = klartext_of(execution.state).transforms.order;
    const bool is_on = std::find(order.begin(), order.end(), Transforms::Kind::tilt) != order.end();
    if (!is_on || axis_of_table_rotation(execution)) return {};
    return check_free_axis(execution, klartext_of(execution.state).transforms.plane, command.span,
                           words_of(execution), false);
}

} // namespace

core::Mat3 spatial_rotation(const core::Vec3& angles) {
    return turned_about(2, angles.z) * turned_about(1, angles.y) * turned_about(0, angles.x);
}

core::Result<AxisValues> calculate_plane(Execution& execution) {
    if (auto done = check_positions(execution); !done)
        return tl::unexpected(std::move(done).error());
    FEELER_TRY(const AxisValues values, axes_for_plane(execution));
    for (size_t axis = 3; axis < 6; ++axis) {
        const int number = 120 + static_cast<int>(axis) - 3;
        execution.state.parameters.write().set_numbered(number, values[axis]);
        note_written(execution.state, key_of(number));
    }
    return values;
}

core::Result<void> set_plane(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    FEELER_TRY(const core::Mat3 axes, axes_of_plane(execution));
    const bool is_on = command.plane != PlaneForm::reset;
    if (execution.modal().offsets.follows_tip && command.plane_move != PlaneMove::stay)
        return refuse_statement(execution, "turning the rotary axes to a plane while M128 is on is "
                                           "not supported yet: program M129 before it");
    retract(execution);
    if (auto done = use_plane(execution, is_on ? std::optional(axes) : std::nullopt); !done)
        return done;
    const bool stays = command.plane_move == PlaneMove::stay;
    if (!execution.modal().offsets.machine) {
        if (!stays) execution.modal().following.rotary_unknown = is_on;
        return {};
    }
    FEELER_TRY(const AxisValues values, calculate_plane(execution));
    if (stays) return {};
    const Word* distance = execution.statement.word('D');
    if (command.plane_move == PlaneMove::move)
        turn_about_tip(execution, values, distance ? length_of(execution, *distance) : 0.0,
                       [&](const Position& end) { go(execution, end); });
    else
        go(execution,
           turned_in_place(execution.modal().offsets, execution.modal().position, values));
    return {};
}

} // namespace gcode
