#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/motion/machine.h"
#include "gcode/exec/following.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"
#include "gcode/siemens/siemens.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// Whether TRAORI is the transformation with the basic direction of the tool and without offsets.
bool is_plain(const Execution& execution) {
    const auto& arguments = siemens_of(execution.block).arguments;
    const auto is_left_out = [](const SiemensArgument& argument) {
        return argument.kind == SiemensArgument::Kind::nothing;
    };
    if (arguments.empty()) return true;
    const bool is_first = is_left_out(arguments[0])
                          || (arguments[0].kind == SiemensArgument::Kind::value
                              && !arguments[0].expression && arguments[0].plain == 1.0);
    return is_first && std::all_of(arguments.begin() + 1, arguments.end(), is_left_out);
}

/// As G500: the transformation may delete the frames.
void deselect_offset(Execution& execution) {
    delete_siemens_frame(execution);
    Offsets offsets = execution.modal().offsets;
    if (offsets.active == no_work_offset) return;
    offsets.active = no_work_offset;
    offsets.work = {};
    change_siemens_offsets(execution, offsets, execution.modal().offset_travel);
    execution.emit(SetOffset{offsets});
}

/// Whether the block moves a rotary axis that the machine has, by its own word.
bool programs_rotary_axes(const Execution& execution) {
    const Offsets& offsets = execution.modal().offsets;
    for (size_t axis = 3; axis < 6; ++axis)
        if (offsets.machine->axes[axis].present && execution.statement.word(axis_letters[axis]))
            return true;
    return false;
}

bool answer(Execution& execution, ControlQuestion question) {
    return answer_to(execution.state, execution.environment, question, execution.block.line);
}

/// Whether the tool turns in the plane of its directions at the ends of a block.
///
/// Source: SINUMERIK 840D sl, Programming Manual Job Planning, ORIWKS and ORIMKS: with ORIMKS the
///         rotary axes are interpolated linearly, with ORIWKS the tool moves in the plane of the
///         first and the last vector; MD21104 chooses the group of codes.
bool turns_in_plane(Execution& execution) {
    const SiemensState& siemens = siemens_of(execution.state);
    bool in_plane = !siemens.turns_in_machine;
    if (siemens.turns_by_axes == in_plane
        && answer(execution, ControlQuestion::orientation_by_code))
        in_plane = !siemens.turns_by_axes;
    if (!in_plane || tool_direction(execution) || !programs_rotary_axes(execution)) return in_plane;
    return answer(execution, ControlQuestion::axes_turn_in_plane);
}

/// Marks the block as not proven clear, and reports it the first time.
void doubt_block(Execution& execution, bool SiemensState::*said, std::string why,
                 std::string cure) {
    execution.result.path = std::max(execution.result.path, core::PathCertainty::doubtful);
    if (siemens_of(execution.state).*said) return;
    writable_siemens(execution.state).*said = true;
    const core::SourceSpan where = moving_word(execution).span;
    execution.result.warnings.push_back(
        {Severity::warning, where, std::move(why), core::rule_id("undecided"), std::move(cure)});
}

core::Result<void> check_direction_words(Execution& execution) {
    const auto words = vector_words(execution.block, direction_letters);
    if (!words) return {};
    ModalState& modal = execution.modal();
    const auto tool = tool_direction(execution);
    if (!tool)
        return core::fail(ErrorCode::invalid_value,
                          "A3, B3 and C3 turn the tool only while TRAORI is on: program TRAORI "
                          "before them",
                          words->word->span);
    if (!modal.offsets.machine) modal.following.rotary_unknown = turns_tool(*tool);
    const core::Mat3& frame = modal.offsets.frame.linear;
    const bool is_turned = modal.offsets.work.rotation_deg != 0.0 || frame != core::Mat3(1.0);
    constexpr double rounding = 1e-9;
    bool is_rotation = glm::determinant(frame) > 0.0;
    for (int axis = 0; axis < 3; ++axis)
        is_rotation = is_rotation && std::abs(glm::length(frame[axis]) - 1.0) < rounding;
    const char* const why =
        siemens_of(execution.state).turns_in_machine && is_turned
            ? "A3, B3 and C3 under ORIMKS while a frame turns the coordinates are not supported "
              "yet: program ORIWKS"
        : !is_rotation ? "A3, B3 and C3 under SCALE or MIRROR are not supported yet: program the "
                         "rotary axes"
                       : nullptr;
    if (why) return core::fail(ErrorCode::unsupported, why, tool->word->span);
    return {};
}

} // namespace

core::Result<void> switch_orientation(Execution& execution, const SiemensKeywordUse& use) {
    const bool on = use.keyword->action == SiemensAction::transformation;
    ModalState& modal = execution.modal();
    const bool was_followed = modal.offsets.follows_tip;
    if (modal.compensation != Side::none)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: program G40 before it, because cutter radius "
                                      "compensation must be off",
                                      use.keyword->name),
                          use.span);
    execution.column = use.span.column;
    const bool is_followed = on ? is_plain(execution) : was_followed;
    if (on && !is_followed && was_followed) switch_tip_control(execution, false);
    if (!is_followed || !switch_tip_control(execution, on)) {
        switch_following(execution, use.span, use.keyword->name,
                         on ? FollowingSwitch::on : FollowingSwitch::off);
        return {};
    }
    if (!answer(execution, ControlQuestion::frame_survives_traori)) deselect_offset(execution);
    return {};
}

void choose_orientation(Execution& execution, SiemensAction action) {
    SiemensState& siemens = writable_siemens(execution.state);
    switch (action) {
    case SiemensAction::orient_in_machine:
    case SiemensAction::orient_in_work:
        siemens.turns_in_machine = action == SiemensAction::orient_in_machine;
        break;
    case SiemensAction::smooth_orientation:
    case SiemensAction::plain_orientation:
        siemens.smooths_turning = action == SiemensAction::smooth_orientation;
        break;
    default:
        siemens.turns_by_axes = action == SiemensAction::orient_axes;
        siemens.turns_otherwise = action == SiemensAction::other_orientation;
    }
}

core::Result<void> prepare_orientation(Execution& execution) {
    if (auto done = check_direction_words(execution); !done) return done;
    ModalState& modal = execution.modal();
    modal.turns_in_plane = false;
    if (!modal.offsets.follows_tip) return {};
    const bool turns = tool_direction(execution) || programs_rotary_axes(execution);
    if (in_machine_coordinates(execution) && is_work_turned(modal)) {
        lose_positions(execution, moving_word(execution).span,
                       "machine coordinates while TRAORI is on and a rotary axis is away from 0: "
                       "how the axes move is not known. This block and later ones are not checked "
                       "until X, Y and Z have been programmed again",
                       "Program TRAFOOF before it.");
        return {};
    }
    if (axis_with_rotary_offset(modal.offsets) && (turns || is_work_turned(modal)))
        doubt_block(execution, &SiemensState::said_rotary_offset,
                    "TRAORI while a rotary axis has a work offset: whether the coordinates turn "
                    "with it is set at the machine. This block and others like it are measured as "
                    "if they did not, and are not proven clear",
                    "Set the offsets of the rotary axes to 0.");
    if (!turns) return {};
    if (modal.compensation != Side::none)
        return core::fail(
            ErrorCode::unsupported,
            "turning the tool between G41 or G42 and G40 is not supported yet: program "
            "G40 before this block",
            moving_word(execution).span);
    const SiemensState& siemens = siemens_of(execution.state);
    if (siemens.turns_otherwise || siemens.smooths_turning)
        doubt_block(
            execution, &SiemensState::said_turning,
            "the way in which the tool turns here (ORICONCW, ORICONCCW, ORIPATH, ORICURVE, "
            "ORISON) is not modelled: this block and others like it are measured with rotary "
            "axes that turn evenly, and are not proven clear",
            "Program ORIVECT or ORIAXES, and ORISOF.");
    else
        modal.turns_in_plane = turns_in_plane(execution);
    return {};
}

} // namespace gcode
