#include <fmt/format.h>

#include "gcode/execution.h"
#include "gcode/frame_codes.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// The angles of I, J and K, degrees; 0 where a word is not there.
core::Vec3 angles_of(const Execution& execution) {
    core::Vec3 angles(0.0);
    for (int i = 0; i < 3; ++i)
        if (const Word* word = execution.statement.word("IJK"[i])) angles[i] = word->value;
    return angles;
}

/// I about X, J about Y and K about Z of the work coordinates, in the order that Q's digits say.
core::Result<core::Mat3> by_roll_pitch_yaw(const Execution& execution) {
    const core::Vec3 angles = angles_of(execution);
    int order = 123;
    if (const Word* word = execution.statement.word('Q')) {
        FEELER_TRY(order, whole_number(*word, 111, 333));
        const int digits[] = {order / 100, order / 10 % 10, order % 10};
        int found = 0;
        for (const int digit : digits)
            if (digit >= 1 && digit <= 3) found |= 1 << digit;
        if (found != 0b1110)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("{}: the order of the rotations is 1, 2 and 3, each once",
                                          written(*word)),
                              word->span);
    }
    core::Mat3 axes(1.0);
    for (const int digit : {order / 100, order / 10 % 10, order % 10})
        axes = turned_about(digit - 1, angles[digit - 1]) * axes;
    return axes;
}

core::Result<core::Mat3> axes_of_plane(const Execution& execution) {
    const Word* word = execution.statement.word('P');
    int form = 0;
    if (word) {
        FEELER_TRY(form, whole_number(*word, 0, 4));
    }
    const core::Vec3 angles = angles_of(execution);
    if (form == 1) return by_roll_pitch_yaw(execution);
    if (form != 0)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: planes by points, vectors or projected angles are not "
                                      "supported yet: give Euler angles, G68.2 X Y Z I J K",
                                      written(*word)),
                          word->span);
    // About Z, then about the new X, then about the new Z.
    return turned_about(2, angles[0]) * turned_about(0, angles[1]) * turned_about(2, angles[2]);
}

/// What a rotary axis of the machine counts more than that of the program.
double rotary_offset(const Offsets& offsets, size_t axis) {
    return offsets.work.origin[axis] + offsets.local[axis] + offsets.axis[axis].value_or(0.0)
           + offsets.tool[axis];
}

/// The values of the machine's axes with the tool along a direction of the program's coordinates.
core::Result<AxisValues> pointed(const Execution& execution, const Word& word,
                                 const core::Vec3& direction) {
    const Offsets& offsets = execution.modal().offsets;
    const Position place = machine_from_program(offsets, execution.modal().position);
    AxisValues values{};
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (is_rotary(axis) && offsets.machine->axes[axis].present && !place[axis])
            return core::fail(
                ErrorCode::missing_value,
                fmt::format("{}: turns the tool, and where axis {} stands is not known: say it "
                            "under [program] start, or the machine's home",
                            written(word), axis_letters[axis]),
                word.span);
        values[axis] = place[axis].value_or(0.0);
    }
    const core::Vec3 in_work =
        turned_about(2, offsets.work.rotation_deg) * (offsets.frame.linear * direction);
    const core::Vec3 in_table =
        table_from_work(offsets, in_work) - table_from_work(offsets, core::Vec3(0.0));
    if (const auto found = core::point_tool(*offsets.machine, values, in_table)) return *found;
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("{}: no rotary axes of this machine turn the tool that way "
                                  "within their limits",
                                  written(word)),
                      word.span);
}

core::Result<void> turn_rotary_axes(Execution& execution, const Word& word) {
    const Offsets& offsets = execution.modal().offsets;
    FEELER_TRY(const AxisValues values, pointed(execution, word, core::Vec3(0.0, 0.0, 1.0)));
    Position machine = machine_from_program(offsets, execution.modal().position);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (is_rotary(axis) && offsets.machine->axes[axis].present) machine[axis] = values[axis];
    execution.traverse(program_from_machine(offsets, machine));
    return {};
}

} // namespace

core::Result<void> set_tilted_plane(Execution& execution) {
    TiltedPlane plane;
    for (int axis = 0; axis < 3; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[static_cast<size_t>(axis)]))
            plane.origin[axis] = length_of(execution, *word);
    FEELER_TRY(plane.axes, axes_of_plane(execution));
    execution.modal().transforms.tilt = plane;
    return {};
}

core::Result<void> turn_tool_to_plane(Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes()) {
        if (entry.code->letter != 'G' || entry.code->tenths != tenths(53, 1)) continue;
        if (!execution.modal().transforms.tilt)
            return core::fail(ErrorCode::invalid_value,
                              "G53.1 turns the tool to a tilted plane, and none is set: write "
                              "G68.2 before it",
                              entry.word->span);
        if (execution.modal().offsets.machine) return turn_rotary_axes(execution, *entry.word);
        if (execution.modal().offsets.frame.tilts_tool)
            execution.warn(entry.word->span,
                           "G53.1 turns rotary axes as the machine's build says: where they go is "
                           "not followed");
    }
    return {};
}

core::Result<void> point_by_vector(const Execution& execution, Position& target) {
    const ModalState& modal = execution.modal();
    if (!modal.transforms.follows_vectors || !modal.offsets.machine) return {};
    const core::Vec3 direction = angles_of(execution);
    const Word* word = nullptr;
    for (const char letter : {'I', 'J', 'K'})
        if (const Word* found = execution.statement.word(letter)) word = found;
    if (!word) return {};
    if (!(glm::length(direction) > 0.0))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: I, J and K give the tool no direction", written(*word)),
                          word->span);
    FEELER_TRY(const AxisValues values, pointed(execution, *word, direction));
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (is_rotary(axis) && modal.offsets.machine->axes[axis].present)
            target[axis] = values[axis] - rotary_offset(modal.offsets, axis);
    return {};
}

} // namespace gcode
