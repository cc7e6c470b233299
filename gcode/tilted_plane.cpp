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
        if (execution.modal().offsets.frame.tilts_tool)
            execution.warn(entry.word->span,
                           "G53.1 turns rotary axes as the machine's build says: where they go is "
                           "not followed");
    }
    return {};
}

} // namespace gcode
