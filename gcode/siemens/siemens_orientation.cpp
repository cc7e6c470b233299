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

/// Whether A2, B2 and C2 are Euler angles; otherwise they are RPY angles.
///
/// Source: SINUMERIK 840D sl, Programming Manual Job Planning, orientation angles: with MD21102 the
///         codes ORIEULER (the default) and ORIRPY choose, otherwise MD21100.
core::Result<bool> are_euler_angles(Execution& execution, core::SourceSpan where) {
    const SiemensAngles said = siemens_of(execution.state).angles;
    const auto& stated = execution.environment.control.answer(ControlQuestion::angles_by_code);
    const bool by_code = said == SiemensAngles::not_said
                             ? stated.value_or(false)
                             : answer(execution, ControlQuestion::angles_by_code);
    if (!by_code) return answer(execution, ControlQuestion::angles_are_euler);
    if (said == SiemensAngles::other)
        return core::fail(
            ErrorCode::unsupported,
            "A2, B2 and C2 under ORIRPY2, ORIAXPOS, ORIVIRT1 or ORIVIRT2 are not supported yet: "
            "program the direction of the tool as A3= B3= C3=",
            where);
    return said != SiemensAngles::rpy;
}

/// The direction of the tool from A2, B2 and C2.
///
/// Source: SINUMERIK 840D sl, Programming Manual Job Planning, orientation angles. Euler: Z is
///         turned about Z by A2 and about the new X by B2. RPY: about Z by C2, the new Y by B2 and
///         the new X by A2.
core::Result<void> take_angles(Execution& execution) {
    const auto words = vector_words(execution.block, angle_letters);
    if (!words) return {};
    const core::Vec3& angles = words->direction;
    const core::Vec3 by_euler = (turned_about(2, angles[0]) * turned_about(0, angles[1]))[2];
    const core::Vec3 by_rpy =
        (turned_about(2, angles[2]) * turned_about(1, angles[1]) * turned_about(0, angles[0]))[2];
    constexpr double same = 1e-12;
    bool is_euler = true;
    if (glm::distance(by_euler, by_rpy) > same) {
        FEELER_TRY(is_euler, are_euler_angles(execution, words->word->span));
    }
    const auto has = [&](char letter) {
        const auto& all = execution.block.words;
        return std::any_of(all.begin(), all.end(),
                           [&](const Word& word) { return word.letter == letter; });
    };
    // Where only this reading has RPY angles, the program means others.
    const bool is_stated =
        siemens_of(execution.state).angles == SiemensAngles::rpy
        || execution.environment.control.answer(ControlQuestion::angles_are_euler);
    const bool is_complete = has(angle_letters[0]) && has(angle_letters[1])
                             && (is_euler || !is_stated || has(angle_letters[2]));
    if (!is_complete)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("the direction of the tool needs {} in one block",
                                      is_euler ? "both A2 and B2" : "all of A2, B2 and C2"),
                          words->word->span);
    execution.tool_by_angles = ToolDirection{is_euler ? by_euler : by_rpy, words->word};
    return {};
}

core::Result<void> check_direction_words(Execution& execution) {
    auto words = vector_words(execution.block, direction_letters);
    if (words && execution.tool_by_angles)
        return core::fail(ErrorCode::syntax,
                          "a direction of the tool by A2, B2 and C2 and by A3, B3 and C3 in one "
                          "block",
                          words->word->span);
    if (execution.tool_by_angles) words = execution.tool_by_angles;
    if (!words) return {};
    ModalState& modal = execution.modal();
    const auto tool = tool_direction(execution);
    if (!tool)
        return core::fail(ErrorCode::invalid_value,
                          "A2 to C3 turn the tool only while TRAORI is on: program TRAORI before "
                          "them",
                          words->word->span);
    if (!modal.offsets.machine) point_undescribed(modal, *tool);
    if (modal.offsets.machine && programs_rotary_axes(execution))
        return core::fail(ErrorCode::syntax,
                          "a block cannot have both a direction of the tool and positions of "
                          "rotary axes",
                          tool->word->span);
    const core::Mat3& frame = modal.offsets.frame.linear;
    const bool is_turned = modal.offsets.work.rotation_deg != 0.0 || frame != core::Mat3(1.0);
    constexpr double rounding = 1e-9;
    bool is_rotation = glm::determinant(frame) > 0.0;
    for (int axis = 0; axis < 3; ++axis)
        is_rotation = is_rotation && std::abs(glm::length(frame[axis]) - 1.0) < rounding;
    const char* const why =
        siemens_of(execution.state).turns_in_machine && is_turned
            ? "A2 to C3 under ORIMKS while a frame turns the coordinates are not supported "
              "yet: program ORIWKS"
        : !is_rotation ? "A2 to C3 under SCALE or MIRROR are not supported yet: program the "
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
    if (siemens_of(execution.state).turns_with_tool)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{} while TOROT is on is not supported yet: program TOROTOF "
                                      "before it",
                                      use.keyword->name),
                          use.span);
    writable_siemens(execution.state).turns_to_path = false;
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
    case SiemensAction::euler_angles:
    case SiemensAction::rpy_angles:
    case SiemensAction::other_angles:
        siemens.angles = action == SiemensAction::euler_angles ? SiemensAngles::euler
                         : action == SiemensAction::rpy_angles ? SiemensAngles::rpy
                                                               : SiemensAngles::other;
        break;
    default:
        siemens.turns_by_axes = action == SiemensAction::orient_axes;
        siemens.turns_otherwise = action == SiemensAction::other_orientation;
        siemens.turns_along_path = action == SiemensAction::orient_along_path;
    }
}

namespace {

/// The axes of the frame of TOROT, in work coordinates.
core::Result<core::Mat3> axes_of_tool_frame(Execution& execution, const SiemensKeywordUse& use) {
    FEELER_TRY(const core::Mat3 tool,
               tool_axes_in_work(execution, use.span, std::string(use.keyword->name)));
    const core::Vec3 z = tool[2], x_axis(1.0, 0.0, 0.0), y_axis(0.0, 1.0, 0.0);
    constexpr double least = 1e-9;
    const auto axes = static_cast<ToolFrameAxes>(number_for(execution.state, execution.environment,
                                                            ControlQuestion::tool_frame_axes,
                                                            execution.block.line));
    const core::Vec3 in_zx = glm::cross(y_axis, z), in_yz = glm::cross(z, x_axis);
    const bool is_defined = axes == ToolFrameAxes::x_in_zx   ? glm::length(in_zx) > least
                            : axes == ToolFrameAxes::y_in_yz ? glm::length(in_yz) > least
                            : axes == ToolFrameAxes::between ? z.z > least - 1.0
                                                             : true;
    if (!is_defined)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: the tool lies so that the directions of X and Y are not "
                                      "defined",
                                      use.keyword->name),
                          use.span);
    core::Vec3 x = tool[0];
    if (axes == ToolFrameAxes::x_in_zx) x = glm::normalize(in_zx);
    if (axes == ToolFrameAxes::y_in_yz) x = glm::cross(glm::normalize(in_yz), z);
    if (axes == ToolFrameAxes::between) // the least rotation from the old axes
        x = core::Vec3(1.0 - z.x * z.x / (1.0 + z.z), -z.x * z.y / (1.0 + z.z), -z.x);
    return core::Mat3(x, glm::cross(z, x), z);
}

} // namespace

/// Source: SINUMERIK 840D sl, Programming Manual Fundamentals, frame generation according to tool
///         orientation; Function Manual Basic Functions, K2: frame rotation in tool direction. The
///         frame acts before that of the program.
core::Result<void> use_tool_frame(Execution& execution, const SiemensKeywordUse& use) {
    const SiemensState& siemens = siemens_of(execution.state);
    const bool on = use.keyword->action == SiemensAction::tool_frame;
    execution.column = use.span.column;
    if (!on && !siemens.turns_with_tool) return {};
    if (!on && is_within_save(execution.state))
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("{}: not supported yet in a subprogram with SAVE", use.keyword->name),
            use.span);
    if (!on) {
        writable_siemens(execution.state).turns_with_tool = false;
        use_swivelled_plane(execution, {}, false);
        return {};
    }
    const Offsets& offsets = execution.modal().offsets;
    const bool is_other_on =
        siemens.frame != ProgramFrame{} || (siemens.swivels && !siemens.turns_with_tool);
    const char* const why =
        !offsets.machine || !offsets.follows_tip
            ? "only supported while TRAORI is on, on a machine with described rotary axes"
        : is_other_on ? "not supported yet while CYCLE800, TRANS, ROT, SCALE or MIRROR is on"
        : is_within_save(execution.state) ? "not supported yet in a subprogram with SAVE"
        : axis_with_rotary_offset(offsets)
            ? "not supported yet while a rotary axis has a work offset"
        : execution.modal().compensation != Side::none ? "only supported after G40"
                                                       : nullptr;
    if (why)
        return core::fail(ErrorCode::unsupported, fmt::format("{}: {}", use.keyword->name, why),
                          use.span);
    FEELER_TRY(const core::Mat3 axes, axes_of_tool_frame(execution, use));
    writable_siemens(execution.state).turns_with_tool = true;
    use_swivelled_plane(execution, {.linear = axes}, true);
    return {};
}

core::Result<void> prepare_orientation(Execution& execution) {
    if (auto done = take_angles(execution); !done) return done;
    if (auto done = check_direction_words(execution); !done) return done;
    ModalState& modal = execution.modal();
    modal.turns_in_plane = false;
    if (use_of(execution, SiemensAction::angle_to_path))
        writable_siemens(execution.state).turns_to_path = true;
    const bool follows_path =
        siemens_of(execution.state).turns_along_path || siemens_of(execution.state).turns_to_path;
    if (follows_path && (modal.offsets.follows_tip || modal.following.may_be_on)) {
        modal.following.rotary_unknown = modal.following.is_said = true;
        execution.loses_rotary_axes = true;
        doubt_block(execution, &SiemensState::said_path,
                    "the tool follows the direction of the path and the normal of the surface here "
                    "(ORIPATH, LEAD, TILT), which is not modelled. This block and later ones are "
                    "not proven clear until TRAFOOF, and until two rotary axes have been "
                    "programmed by their positions after it",
                    "Program the direction of the tool as A3= B3= C3=, with ORIVECT or ORIAXES.");
    }
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
            "the way in which the tool turns here (ORICONCW, ORICONCCW, ORICURVE, "
            "ORISON) is not modelled: this block and others like it are measured with rotary "
            "axes that turn evenly, and are not proven clear",
            "Program ORIVECT or ORIAXES, and ORISOF.");
    else
        modal.turns_in_plane = turns_in_plane(execution);
    return {};
}

} // namespace gcode
