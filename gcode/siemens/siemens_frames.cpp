#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gcode/exec/frame_codes.h"
#include "gcode/siemens/siemens.h"

namespace gcode {
namespace {

using core::ErrorCode;
using enum SiemensAction;

bool is_frame(SiemensAction action) { return action >= shift && action <= add_mirror; }

bool is_additive(SiemensAction action) {
    return action == add_shift || action == add_turn || action == add_space_turn
           || action == add_scale || action == add_mirror;
}

core::Mat3 rotation_of_words(const Execution& execution) {
    if (const Word* word = execution.statement.word('Q'))
        return turned_about(static_cast<int>(axes_of(execution.modal().plane).normal), word->value);
    // RPY, the default: about Z, then the new Y, then the new X.
    core::Mat3 turn(1.0);
    for (int axis = 2; axis >= 0; --axis)
        if (const Word* word = execution.statement.word(axis_letters[static_cast<size_t>(axis)]))
            turn = turn * turned_about(axis, word->value);
    return turn;
}

/// ROTS and AROTS: the plane of two angles in space, or a turn by one.
///
/// Source: SINUMERIK 840D sl, Function Manual Basic Functions, K2: Y turns X about Y to where the
///         plane meets ZX, X turns Y about X likewise; X and Y leave X in the old ZX plane, Z and X
///         leave Z in the old YZ plane, and Y and Z leave Y in the old XY plane.
core::Result<core::Mat3> rotation_in_space(const Execution& execution, core::SourceSpan where) {
    std::array<const Word*, 3> words{};
    int count = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        words[axis] = execution.statement.word(axis_letters[axis]);
        count += words[axis] ? 1 : 0;
    }
    if (count == 3 || (count > 0 && execution.statement.word('Q')))
        return core::fail(ErrorCode::syntax, "ROTS and AROTS take one or two angles, or RPL",
                          where);
    if (count < 2) return rotation_of_words(execution);
    // The plane of the first and second axis in cyclic order; the third is its normal.
    const int normal = !words[2] ? 2 : !words[1] ? 1 : 0;
    const int first = (normal + 1) % 3, second = (normal + 2) % 3;
    const auto plane = plane_by_projections(words[static_cast<size_t>(second)]->value,
                                            words[static_cast<size_t>(first)]->value);
    if (!plane)
        return core::fail(ErrorCode::invalid_value, "the angles in space define no plane", where);
    core::Mat3 rotation(0.0);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            rotation[(first + column) % 3][(first + row) % 3] = (*plane)[column][row];
    return rotation;
}

/// The transformation of one statement; for TRANS also along the axes other than X, Y and Z.
core::Result<ProgramFrame> step_of(const Execution& execution, const SiemensKeywordUse& use,
                                   AxisValues& others) {
    const SiemensAction action = use.keyword->action;
    ProgramFrame step;
    if (action == space_turn || action == add_space_turn) {
        FEELER_TRY(step.linear, rotation_in_space(execution, use.span));
        return step;
    }
    if (action == turn || action == add_turn) {
        step.linear = rotation_of_words(execution);
        return step;
    }
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word) continue;
        const auto index = static_cast<int>(axis);
        const bool shifts = action == shift || action == add_shift;
        if (shifts && axis >= 3) {
            others[axis] += axis_value(execution, axis, *word);
        } else if (axis >= 3) {
            return core::fail(
                ErrorCode::unsupported,
                fmt::format("{}: only X, Y and Z can be scaled or mirrored here", written(*word)),
                word->span);
        } else if (shifts) {
            step.shift[index] = axis_value(execution, axis, *word);
        } else if (action == SiemensAction::mirror || action == add_mirror) {
            step.linear[index][index] = -1.0;
        } else if (word->value == 0.0) {
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("{}: a scaling factor must not be 0", written(*word)),
                              word->span);
        } else {
            step.linear[index][index] = word->value;
        }
    }
    return step;
}

/// Activates the frame. A shift alone becomes the local offset and needs no frame.
void use_frame(Execution& execution, const ProgramFrame& own, const AxisValues& others) {
    SiemensState& siemens = writable_siemens(execution.state);
    siemens.frame = own;
    ProgramFrame frame{siemens.swivel.linear * own.linear,
                       siemens.swivel.shift + siemens.swivel.linear * own.shift};
    const core::Vec3& tool_axis = frame.linear[2];
    frame.tilts_tool = std::abs(tool_axis.x) > 1e-12 || std::abs(tool_axis.y) > 1e-12;
    Offsets offsets = execution.modal().offsets;
    offsets.tilted_plane = siemens.swivels;
    offsets.local = others;
    const bool shifts_alone = frame.linear == core::Mat3(1.0);
    offsets.has_frame = !shifts_alone;
    offsets.frame = shifts_alone ? ProgramFrame{} : frame;
    if (shifts_alone)
        for (int axis = 0; axis < 3; ++axis)
            offsets.local[static_cast<size_t>(axis)] = frame.shift[axis];
    if (offsets == execution.modal().offsets) return;
    change_siemens_offsets(execution, offsets, execution.modal().offset_travel);
    execution.emit(SetOffset{offsets});
}

} // namespace

void delete_siemens_frame(Execution& execution) { use_frame(execution, {}, {}); }

void use_swivelled_plane(Execution& execution, const ProgramFrame& plane, bool is_on) {
    SiemensState& siemens = writable_siemens(execution.state);
    siemens.swivel = plane;
    siemens.swivels = is_on;
    use_frame(execution, siemens_of(execution.state).frame, execution.modal().offsets.local);
}

core::Result<void> change_siemens_frame(Execution& execution) {
    for (const SiemensKeywordUse& use : siemens_of(execution.block).keywords) {
        const SiemensAction action = use.keyword->action;
        if (!is_frame(action)) continue;
        if (execution.modal().compensation != Side::none)
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{} between G41 or G42 and G40 is not supported yet: "
                                          "cancel cutter radius compensation first",
                                          use.keyword->name),
                              use.span);
        if (siemens_of(execution.state).turns_with_tool)
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{} while TOROT is on is not supported yet: program "
                                          "TOROTOF before it",
                                          use.keyword->name),
                              use.span);
        if (execution.statement.of(ModalGroup::motion))
            return core::fail(
                ErrorCode::syntax,
                fmt::format("{} must be in a block by itself: its axis words are not positions",
                            use.keyword->name),
                use.span);
        execution.column = use.span.column;
        const bool adds = is_additive(action);
        AxisValues others = adds ? execution.modal().offsets.local : AxisValues{};
        others[0] = others[1] = others[2] = 0.0;
        FEELER_TRY(const ProgramFrame step, step_of(execution, use, others));
        ProgramFrame frame = adds ? siemens_of(execution.state).frame : ProgramFrame{};
        frame.shift += frame.linear * step.shift;
        frame.linear = frame.linear * step.linear;
        use_frame(execution, frame, others);
    }
    return {};
}

} // namespace gcode
