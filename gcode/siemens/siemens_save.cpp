#include <algorithm>

#include "gcode/exec/flow.h"
#include "gcode/exec/modes.h"
#include "gcode/siemens/siemens.h"

namespace gcode {
namespace {

/// The offsets at the call with the tool length of now, which acts along the axis of the restored
/// plane where it follows the plane.
Offsets restored_offsets(const ModalState& now, const ModalState& saved, bool length_follows) {
    Offsets offsets = saved.offsets;
    offsets.tool = now.offsets.tool;
    offsets.follows_tip = now.offsets.follows_tip;
    offsets.machine = now.offsets.machine;
    const size_t from = axes_of(now.plane).normal, to = axes_of(saved.plane).normal;
    if (length_follows && from != to) {
        offsets.tool[to] = now.offsets.tool[from];
        offsets.tool[from] = 0.0;
    }
    return offsets;
}

void restore_offsets(ModalState& modal, const Offsets& offsets) {
    const Position before = modal.position;
    change_offsets(modal, offsets);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (before[axis] && modal.position[axis])
            modal.offset_travel[axis] += *before[axis] - *modal.position[axis];
}

void restore_groups(ModalState& modal, const ModalState& saved) {
    modal.motion = saved.motion;
    modal.plane = saved.plane;
    modal.distance = saved.distance;
    modal.unit = saved.unit;
    modal.diameter_mode = saved.diameter_mode;
    if (modal.feed_mode != saved.feed_mode) modal.feed.reset();
    modal.feed_mode = saved.feed_mode;
    modal.surface_speed = saved.surface_speed;
    modal.compensation = saved.compensation;
    modal.compensation_radius = saved.compensation_radius;
    constexpr uint8_t of_groups = rapids_are_in_doubt | approach_is_in_doubt; // RTLIOF, KONT
    modal.doubt = static_cast<uint8_t>((modal.doubt & ~of_groups) | (saved.doubt & of_groups));
}

/// Source: SINUMERIK 840D sl, Programming Manual Job Planning, "Subprograms with SAVE mechanism":
///         the modal G functions and the complete current frame are as before the call. Feed,
///         speed, M functions, the tool and D stay as the subprogram has left them.
void restore_modes_of_call(InterpreterState& state, const Frame& frame) {
    ModalState& modal = state.modal;
    const ModalState& saved = **frame.saved;
    const SiemensState& before =
        static_cast<const StateOf<SiemensState>&>(*frame.saved_language).value;
    SiemensState& siemens = writable_siemens(state);
    const bool length_follows = modal.diameter_mode || siemens.length_follows_plane;
    const Offsets offsets = restored_offsets(modal, saved, length_follows);
    // A contour to which the tool returns from elsewhere is not modelled.
    const bool returns = saved.compensation != Side::none
                         && (modal.tool != saved.tool || modal.compensation != saved.compensation
                             || modal.offsets != offsets);
    restore_groups(modal, saved);
    if (returns) modal.doubt |= approach_is_in_doubt;
    restore_offsets(modal, offsets);
    siemens.frame = before.frame;
    siemens.feeds_in_inches = before.feeds_in_inches;
    const bool changes_path =
        siemens.path_code != before.path_code || siemens.compresses != before.compresses;
    siemens.path_code = before.path_code;
    siemens.compresses = before.compresses;
    siemens.corner_code = before.corner_code;
    siemens.turns_by_axes = before.turns_by_axes;
    siemens.turns_in_machine = before.turns_in_machine;
    siemens.turns_otherwise = before.turns_otherwise;
    siemens.smooths_turning = before.smooths_turning;
    siemens.turns_along_path = before.turns_along_path;
    siemens.angles = before.angles;
    if (changes_path) set_corner_tolerances(siemens, modal);
}

} // namespace

void save_siemens_modes(const InterpreterState& state, Frame& frame) {
    frame.restore = restore_modes_of_call;
    frame.saved.write() = state.modal;
    frame.saved_language = state.language.now();
}

bool is_within_save(const InterpreterState& state) {
    return std::any_of(state.frames.begin(), state.frames.end(),
                       [](const Frame& frame) { return frame.restore != nullptr; });
}

void return_to_caller(InterpreterState& state, BlockCommands& result, uint32_t column) {
    const ModalState before = state.modal;
    leave(state);
    announce_modes(result, column, before, state.modal);
}

} // namespace gcode
