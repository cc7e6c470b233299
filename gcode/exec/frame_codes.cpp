#include "gcode/exec/frame_codes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "core/motion/plane_turn.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/following.h"
#include "gcode/exec/modes.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// A coordinate of a centre: from its word, else the current position.
core::Result<double> centre_along(const Execution& execution, const CodeWord& entry, size_t axis) {
    if (const Word* word = execution.statement.word(axis_letters[axis]))
        return axis_value(execution, axis, *word);
    if (const auto& position = execution.modal().position[axis]) return *position;
    return core::fail(
        ErrorCode::missing_value,
        fmt::format(
            "{} has no {} word for its centre, and the {} position is unknown: add the word",
            written(*entry.word), axis_letters[axis], axis_letters[axis]),
        entry.word->span);
}

core::Result<double> factor_of(Execution& execution, const Word& word) {
    const bool counts = execution.dialect.scale_without_point_is_thousandths && !word.has_point;
    double factor = word.value;
    if (counts) {
        const double unit = number_for(execution.state, execution.environment,
                                       ControlQuestion::scale_unit, word.span.line);
        factor = unit == 0.00001 ? word.value / 100000.0 : word.value / 1000.0;
    }
    if (factor == 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a scaling factor must not be 0", written(word)),
                          word.span);
    if (counts && std::abs(factor) < 0.05)
        execution.warn(word.span, fmt::format("{}: without a decimal point this control counts "
                                              "small steps, so the scaling factor is {:.4g}",
                                              written(word), factor));
    return factor;
}

/// G51. An axis with a scale factor of 1 needs no centre.
core::Result<void> set_scaling(Execution& execution, const CodeWord& entry) {
    const Statement& statement = execution.statement;
    const Word* all = statement.word('P');
    Scaling scaling;
    bool said = false;
    for (int axis = 0; axis < 3; ++axis) {
        const Word* word = all ? all : statement.word("IJK"[axis]);
        if (!word) continue;
        said = true;
        FEELER_TRY(scaling.factors[axis], factor_of(execution, *word));
    }
    const auto stored = execution.environment.control.number(ControlQuestion::scale_default);
    if (!said && !stored)
        return core::fail(ErrorCode::missing_value,
                          "G51 has no scaling factor: add P, or I, J and K; a factor stored in the "
                          "parameters of the control is not known here (state \"5411\", or on "
                          "Haas \"setting 71\", under [control])",
                          entry.word->span);
    if (!said) scaling.factors = core::Vec3(*stored);
    constexpr ControlQuestion scales = ControlQuestion::scales_z;
    const bool may_leave_out_z = find_parameter(scales, execution.environment.dialect);
    if (scaling.factors[2] != 1.0 && may_leave_out_z
        && !answer_to(execution.state, execution.environment, scales, execution.block.line))
        scaling.factors[2] = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        if (scaling.factors[axis] == 1.0) continue;
        FEELER_TRY(scaling.centre[axis], centre_along(execution, entry, static_cast<size_t>(axis)));
    }
    execution.modal().transforms.scaling = scaling;
    return {};
}

/// G51.1, and Haas's G101: mirrors the named axes in addition to earlier ones. G101 mirrors them
/// about the zero of the work offset, whatever the value of the word.
///
/// Source: Haas mill operator's manual 96-8000, G101.
void set_mirror(Execution& execution, bool is_about_zero) {
    MirrorImage& mirror = execution.modal().transforms.mirror;
    for (size_t axis = 0; axis < 3; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word) continue;
        mirror.axes[axis] = true;
        mirror.position[static_cast<int>(axis)] =
            is_about_zero ? 0.0 : axis_value(execution, axis, *word);
    }
}

/// G50.1, G100: cancels mirroring of the named axes, or of all.
void cancel_mirror(Execution& execution) {
    MirrorImage& mirror = execution.modal().transforms.mirror;
    const bool all = !execution.statement.has_axis_word();
    for (size_t axis = 0; axis < 3; ++axis)
        if (all || execution.statement.word(axis_letters[axis])) {
            mirror.axes[axis] = false;
            mirror.position[static_cast<int>(axis)] = 0.0;
        }
}

/// The angle of G68; with G91 it may be relative to the previous angle.
core::Result<double> rotation_angle(Execution& execution, const CodeWord& entry) {
    const Word* word = execution.statement.word('R');
    const ControlSettings& control = execution.environment.control;
    const auto stored = control.number(ControlQuestion::rotation_default);
    if (!word && stored) return *stored;
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          "G68 has no angle: add R; an angle stored in the parameters of the "
                          "control is not known here (state \"5410\", or on Haas "
                          "\"setting 72\", under [control])",
                          entry.word->span);
    const auto& before = execution.modal().transforms.rotation;
    if (execution.modal().distance == DistanceMode::absolute || !before) return word->value;
    constexpr ControlQuestion question = ControlQuestion::rotation_adds;
    const bool is_parameter = find_parameter(question, execution.environment.dialect);
    const bool adds =
        !is_parameter
        || answer_to(execution.state, execution.environment, question, word->span.line);
    if (!is_parameter || !(control.answer(question) || control.reports_premises))
        execution.warn(word->span,
                       fmt::format("{}: assumed to be relative to the previous angle, which with "
                                   "G91 depends on a parameter of the control; use G90 to be sure",
                                   written(*word)));
    return (adds ? before->degrees : 0.0) + word->value;
}

/// G68: both words of the centre are absolute, even with G91.
core::Result<void> set_rotation(Execution& execution, const CodeWord& entry) {
    ModalState& modal = execution.modal();
    for (const char letter : {'I', 'J', 'K'})
        if (const Word* word = execution.statement.word(letter))
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{}: G68 with I, J or K (rotation about any axis) is not "
                                          "supported yet: use G68.2",
                                          written(*word)),
                              word->span);
    const PlaneAxes axes = axes_of(modal.plane);
    FEELER_TRY(const double degrees, rotation_angle(execution, entry));
    core::Vec3 centre(0.0);
    // The words of the centre are coordinates without the old rotation.
    ProgramTransforms without = modal.transforms;
    if (without.rotation) {
        without.rotation.reset();
        use_transforms(execution, without);
    }
    for (const size_t axis : {axes.first, axes.second}) {
        FEELER_TRY(centre[static_cast<int>(axis)], centre_along(execution, entry, axis));
    }
    const std::array<bool, 3>& mirrored = modal.transforms.mirror.axes;
    modal.transforms.before_rotation = modal.position;
    modal.transforms.rotation =
        PlaneRotation{.normal = static_cast<int>(axes.normal),
                      .centre = scaled_point(modal.transforms, centre),
                      .degrees = degrees,
                      .is_reversed = mirrored[axes.first] != mirrored[axes.second]};
    return {};
}

/// Reports changes of the frame while cutter radius compensation is on as an error.
core::Result<void> check_contour_is_off(const Execution& execution, const CodeWord& entry) {
    const ModalState& modal = execution.modal();
    const CodeNumber code = entry.code->number;
    const bool is_on = modal.offsets.has_frame;
    const bool cancels = code == g_code(50) || code == g_code(50, 1) || code == g_code(69)
                         || code == g_code(255) || code == g_code(269);
    if (modal.compensation == Side::none || entry.code->group == ModalGroup::polar
        || (cancels && !is_on))
        return {};
    return core::fail(ErrorCode::unsupported,
                      fmt::format("{} between G41 or G42 and G40 is not supported yet: cancel "
                                  "cutter radius compensation first",
                                  written(*entry.word)),
                      entry.word->span);
}

/// The plane of a dynamic work offset: the axes of the machine, about the origin of the work offset
/// on the table. Rotary axes whose position is unknown are taken to be at 0.
TiltedPlane plane_on_table(const ModalState& modal) {
    const Offsets& offsets = modal.offsets;
    const AxisValues values = values_or_zero(machine_from_program(offsets, modal.position));
    const core::Mat3 table =
        core::machine_from_link(*offsets.machine, offsets.machine->table, values).rotation;
    return {.axes = turned_about(2, -offsets.work.rotation_deg) * glm::transpose(table),
            .follows_table = true};
}

/// G254.
///
/// Source: Haas mill operator's manual, G254: the control applies the offsets between the position
///         of the work as programmed and as the rotary axes have turned it; the work offsets of
///         rotary axes must be 0.
core::Result<void> set_dynamic_offset(Execution& execution, const CodeWord& entry) {
    ModalState& modal = execution.modal();
    if (!modal.offsets.machine) {
        switch_following(execution, entry.word->span, written(*entry.word), FollowingSwitch::on);
        return {};
    }
    if (modal.offsets.follows_tip)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: cancel tool centre point control before it, with G49",
                                      written(*entry.word)),
                          entry.word->span);
    if (modal.transforms.tilt && !has_dynamic_offset(modal.transforms))
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}: cancel the tilted plane before it, with G269, or G69 after G68.2",
                        written(*entry.word)),
            entry.word->span);
    const Position machine = machine_from_program(modal.offsets, modal.position);
    for (size_t axis = 3; axis < 6; ++axis)
        if (modal.offsets.machine->axes[axis].present && !machine[axis])
            return core::fail(ErrorCode::missing_value,
                              fmt::format("{}: the position of axis {} is unknown: set [program] "
                                          "start or the machine's home in the set-up",
                                          written(*entry.word), axis_letters[axis]),
                              entry.word->span);
    if (const auto axis = axis_with_rotary_offset(modal.offsets))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: the work offset of axis {} must be 0",
                                      written(*entry.word), axis_letters[*axis]),
                          entry.word->span);
    modal.transforms.tilt = plane_on_table(modal);
    return {};
}

core::Result<void> change_transforms(Execution& execution, const CodeWord& entry) {
    ProgramTransforms& transforms = execution.modal().transforms;
    switch (entry.code->number) {
    case g_code(50):
        transforms.scaling.reset();
        return {};
    case g_code(51):
        return set_scaling(execution, entry);
    case g_code(50, 1):
    case g_code(100):
        cancel_mirror(execution);
        return {};
    case g_code(51, 1):
    case g_code(101):
        set_mirror(execution, entry.code->number == g_code(101));
        return {};
    case g_code(68):
        return set_rotation(execution, entry);
    case g_code(68, 2):
    case g_code(68, 3):
    case g_code(68, 4):
    case g_code(268):
        if (auto checked = check_dynamic_offset_is_off(execution, entry); !checked) return checked;
        for (const char letter : {'A', 'B', 'C', 'U', 'V', 'W'})
            if (const Word* word = execution.statement.word(letter))
                return core::fail(ErrorCode::unsupported,
                                  fmt::format("{}: in a block with {} it is not supported yet: "
                                              "program it in a block of its own",
                                              written(*word), written(*entry.word)),
                                  word->span);
        return set_tilted_plane(execution);
    case g_code(254):
        return set_dynamic_offset(execution, entry);
    case g_code(255):
    case g_code(269):
        if (transforms.tilt
            && transforms.tilt->follows_table == (entry.code->number == g_code(255)))
            transforms.tilt.reset();
        if (entry.code->number == g_code(255) && !execution.modal().offsets.machine)
            switch_following(execution, entry.word->span, written(*entry.word),
                             FollowingSwitch::off);
        return {};
    case g_code(69):
        transforms.rotation.reset();
        if (!has_dynamic_offset(transforms)) transforms.tilt.reset();
        transforms.before_rotation.reset();
        return {};
    case g_code(15):
        transforms.polar.reset();
        return {};
    default: // G16
        if (!transforms.polar) transforms.polar = PolarPositions{};
        return {};
    }
}

/// G54.4, workpiece setting error compensation: P0 cancels it. Other numbers shift and turn the
/// coordinates by values that the operator has measured.
core::Result<void> check_setting_error(const Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes()) {
        if (entry.code->number != g_code(54, 4)) continue;
        const Word* word = execution.statement.word('P');
        if (word && word->value == 0.0) continue;
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: compensation of the error of a clamped workpiece is not "
                                      "supported yet, only G54.4 P0, which cancels it",
                                      written(*entry.word)),
                          entry.word->span);
    }
    return {};
}

} // namespace

void use_transforms(Execution& execution, const ProgramTransforms& transforms) {
    ModalState& modal = execution.modal();
    modal.transforms = transforms;
    Offsets offsets = modal.offsets;
    offsets.frame = frame_of(transforms);
    offsets.has_frame = offsets.frame != ProgramFrame{};
    offsets.tilted_plane = transforms.tilt.has_value();
    if (offsets == modal.offsets) return;
    change_offsets(execution, offsets);
    execution.emit(SetOffset{offsets});
}

core::Result<void> set_frame(Execution& execution) {
    using enum ModalGroup;
    for (const ModalGroup group : {mirror, scaling, rotation, polar}) {
        const CodeWord* entry = execution.statement.of(group);
        if (!entry) continue;
        if (auto checked = check_contour_is_off(execution, *entry); !checked) return checked;
        if (auto changed = change_transforms(execution, *entry); !changed) return changed;
        use_transforms(execution, execution.modal().transforms);
    }
    if (auto done = check_setting_error(execution); !done) return done;
    return turn_tool_to_plane(execution);
}

core::Result<void> check_arc_in_frame(const Execution& execution, const PlaneAxes& axes) {
    const auto& scaling = execution.modal().transforms.scaling;
    if (!scaling) return {};
    const double first = scaling->factors[static_cast<int>(axes.first)];
    const double second = scaling->factors[static_cast<int>(axes.second)];
    if (std::abs(first) == std::abs(second)) return {};
    const Word& mover = moving_word(execution);
    return core::fail(ErrorCode::unsupported,
                      fmt::format("{}: G51 scales {} by {:.6g} and {} by {:.6g}, and the scaled "
                                  "centre does not fit an arc between the scaled end points: use "
                                  "the same factor for both, or program the arc with R",
                                  written(mover), axis_letters[axes.first], first,
                                  axis_letters[axes.second], second),
                      mover.span);
}

namespace {

/// The angles from I, J and K, degrees; 0 for missing words.
core::Vec3 angles_of(const Execution& execution) {
    core::Vec3 angles(0.0);
    for (int i = 0; i < 3; ++i)
        if (const Word* word = execution.statement.word("IJK"[i])) angles[i] = word->value;
    return angles;
}

/// I about X, J about Y and K about Z of the work coordinates, in the order of the digits of Q.
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
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format(
                    "{}: the order of the rotations must have the digits 1, 2 and 3 once each",
                    written(*word)),
                word->span);
    }
    core::Mat3 axes(1.0);
    for (const int digit : {order / 100, order / 10 % 10, order % 10})
        axes = turned_about(digit - 1, angles[digit - 1]) * axes;
    return axes;
}

/// G268 of Haas.
bool is_feature_plane(const Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::rotation);
    return entry && entry->code->number == g_code(268);
}

tl::unexpected<core::Error> refuse_plane(const Execution& execution, const std::string& why) {
    const Word& code = *execution.statement.of(ModalGroup::rotation)->word;
    return core::fail(ErrorCode::invalid_value, fmt::format("{}: {}", written(code), why),
                      code.span);
}

core::Result<core::Mat3> axes_of_plane(const Execution& execution) {
    const Word* word = execution.statement.word('P');
    int form = 0;
    if (word) {
        FEELER_TRY(form, whole_number(*word, 0, 4));
    }
    const core::Vec3 angles = angles_of(execution);
    if (is_feature_plane(execution)) {
        if (!execution.statement.word('Q'))
            return core::fail(ErrorCode::unsupported,
                              "G268: without Q, the order of the rotations is not known: program "
                              "Q, such as Q123",
                              execution.statement.of(ModalGroup::rotation)->word->span);
        return by_roll_pitch_yaw(execution);
    }
    if (form == 1) return by_roll_pitch_yaw(execution);
    if (form == 4) {
        // I turns X about Y, J turns Y about X, and K turns the plane about its Z.
        const auto plane = plane_by_projections(angles[0], angles[1]);
        if (!plane) return refuse_plane(execution, "the projected angles define no plane");
        return *plane * turned_about(2, angles[2]);
    }
    // About Z, then about the new X, then about the new Z.
    return turned_about(2, angles[0]) * turned_about(0, angles[1]) * turned_about(2, angles[2]);
}

/// The machine axis values now; errors if the position of a rotary axis is unknown.
core::Result<AxisValues> values_now(const Execution& execution, core::SourceSpan where,
                                    const std::string& what) {
    const Offsets& offsets = execution.modal().offsets;
    const Position position = machine_from_program(offsets, execution.modal().position);
    AxisValues values{};
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (is_rotary(axis) && offsets.machine->axes[axis].present && !position[axis])
            return core::fail(
                ErrorCode::missing_value,
                fmt::format("{}: this tilts the tool, but the position of axis {} is unknown: set "
                            "[program] start or the machine's home in the set-up",
                            what, axis_letters[axis]),
                where);
        values[axis] = position[axis].value_or(0.0);
    }
    return values;
}

tl::unexpected<core::Error> fail_to_tilt(const std::string& what, core::SourceSpan where) {
    return core::fail(
        ErrorCode::invalid_value,
        fmt::format(
            "{}: the rotary axes of this machine cannot tilt the tool that way within their limits",
            what),
        where);
}

/// A word as the program has it.
std::string words_at(const Execution& execution, const Word& word) {
    return std::string(execution.block.text.substr(word.span.column - 1, word.span.length));
}

/// Machine axis values that point the tool in a direction of the program coordinates.
core::Result<AxisValues> pointed(const Execution& execution, const Word& word,
                                 const core::Vec3& direction) {
    const Offsets& offsets = execution.modal().offsets;
    FEELER_TRY(const AxisValues values,
               values_now(execution, word.span, words_at(execution, word)));
    const auto ways =
        core::ways_to_point_tool(*offsets.machine, values, direction_in_table(offsets, direction));
    if (ways.empty()) return fail_to_tilt(words_at(execution, word), word.span);
    // A tool that turns in a plane gets to the position on its way, which may not be the nearest.
    const bool in_plane = execution.modal().turns_in_plane && offsets.follows_tip;
    const auto is_on_way = [&](const AxisValues& way) {
        const auto turn = core::turn_in_plane(*offsets.machine, values, way, core::turn_error);
        return turn && turn->sine > sine_of_pole_limit(execution);
    };
    const auto found = in_plane ? std::find_if(ways.begin(), ways.end(), is_on_way) : ways.begin();
    return found == ways.end() ? ways.front() : *found;
}

/// The sign of the tilting axis that P of G53.1 and G53.6 chooses; 0: any will do.
core::Result<int> sign_of_turn(Execution& execution) {
    const Word* word = execution.statement.word('P');
    if (!word) return 0;
    FEELER_TRY(const int choice, whole_number(*word, 0, 2));
    if (choice == 0 || !execution.modal().offsets.machine) return 0;
    const bool is_positive = answer_to(execution.state, execution.environment,
                                       ControlQuestion::p1_is_positive, execution.block.line)
                             == (choice == 1);
    return is_positive ? 1 : -1;
}

/// `about_tip`: the tip stays where it is on the work; otherwise the linear axes stay.
core::Result<void> turn_rotary_axes(Execution& execution, const Word& word, bool about_tip) {
    const ModalState& modal = execution.modal();
    FEELER_TRY(const int sign, sign_of_turn(execution));
    FEELER_TRY(const AxisValues values,
               sign != 0 ? axes_along_z(execution, word.span, written(word), sign)
                         : pointed(execution, word, core::Vec3(0.0, 0.0, 1.0)));
    if (about_tip)
        turn_about_tip(execution, values, 0.0,
                       [&](const Position& end) { execution.traverse(end); });
    else
        execution.traverse(turned_in_place(modal.offsets, modal.position, values));
    return {};
}

/// X, Y and Z of a block, which are absolute; 0 for missing words.
core::Vec3 point_of(const Execution& execution) {
    core::Vec3 point(0.0);
    for (int axis = 0; axis < 3; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[static_cast<size_t>(axis)]))
            point[axis] = length_of(execution, *word);
    return point;
}

/// G68.4: a plane in the coordinates of the one that is on.
bool adds_to_plane(const Execution& execution) {
    return execution.statement.of(ModalGroup::rotation)->code->number == g_code(68, 4);
}

/// Switches a plane on, which G68.4 states in the coordinates of the one before.
void use_plane(Execution& execution, const TiltedPlane& plane) {
    std::optional<TiltedPlane>& tilt = execution.modal().transforms.tilt;
    tilt = tilt && adds_to_plane(execution)
               ? TiltedPlane{.axes = tilt->axes * plane.axes,
                             .origin = tilt->origin + tilt->axes * plane.origin}
               : plane;
}

/// The block of a plane that must come next: "G68.2 P2 Q3".
std::string name_of_next(const BegunPlane& begun) {
    return fmt::format("G68.{} P{} Q{}", begun.adds ? 4 : 2, begun.by_points ? 2 : 3, begun.next);
}

/// A plane through three points: X points from the first to the second, and the third is on the
/// side of +Y.
core::Result<TiltedPlane> plane_through(const Execution& execution, const core::Vec3& first,
                                        const core::Vec3& second, const core::Vec3& third) {
    constexpr double least_sine = 1e-3; // below, rounded coordinates decide the direction
    const core::Vec3 x = second - first, side = third - first;
    const core::Vec3 normal = glm::cross(x, side);
    const double most = glm::length(x) * glm::length(side);
    if (!(most > 0.0) || !(glm::length(normal) > least_sine * most))
        return refuse_plane(execution, "the three points are on one line, or two are the same");
    const core::Vec3 along_x = glm::normalize(x), along_z = glm::normalize(normal);
    return TiltedPlane{.axes = core::Mat3(along_x, glm::cross(along_z, along_x), along_z),
                       .origin = first};
}

/// A plane with these directions of X and Z, perpendicular but for rounding.
core::Result<TiltedPlane> plane_along(const Execution& execution, const core::Vec3& origin,
                                      const core::Vec3& x, const core::Vec3& z) {
    constexpr double rounding = 2e-3;
    const double lengths = glm::length(x) * glm::length(z);
    if (!(lengths > 0.0)) return refuse_plane(execution, "a direction I J K has no length");
    if (std::abs(glm::dot(x, z)) > rounding * lengths)
        return refuse_plane(execution, "the directions of X (Q1) and Z (Q2) must be perpendicular");
    const core::Vec3 along_z = glm::normalize(z);
    const core::Vec3 along_y = glm::normalize(glm::cross(along_z, x));
    return TiltedPlane{.axes = core::Mat3(glm::cross(along_y, along_z), along_y, along_z),
                       .origin = origin};
}

/// A block of G68.2 or G68.4 with P2 or P3, of which the last one sets the plane. A shift or a
/// rotation of the plane is refused: programs differ in what they mean by it.
core::Result<void> add_to_plane(Execution& execution, bool by_points) {
    const auto refuse_words = [&](std::string_view letters) -> core::Result<void> {
        for (const char letter : letters)
            if (const Word* word = execution.statement.word(letter); word && word->value != 0.0)
                return core::fail(
                    ErrorCode::unsupported,
                    fmt::format("{}: not supported yet in this block of {} P{}", written(*word),
                                written(*execution.statement.of(ModalGroup::rotation)->word),
                                by_points ? 2 : 3),
                    word->span);
        return {};
    };
    const bool adds = adds_to_plane(execution);
    std::optional<BegunPlane>& begun = execution.modal().transforms.begun_plane;
    const Word* which = execution.statement.word('Q');
    int block = 0;
    if (which) {
        FEELER_TRY(block, whole_number(*which, 0, by_points ? 3 : 2));
    }
    const bool begins = !begun && (block == 1 || (block == 0 && by_points && which));
    if (!begins && !begun)
        return refuse_plane(execution, fmt::format("P{} begins with Q1", by_points ? 2 : 3));
    if (!begins && (begun->by_points != by_points || begun->adds != adds || begun->next != block))
        return refuse_plane(execution, name_of_next(*begun) + " must come next");
    if (begins) begun = BegunPlane{.by_points = by_points, .adds = adds};
    begun->next = block + 1;
    const core::Vec3 point = point_of(execution), direction = angles_of(execution);
    if (by_points) {
        if (auto done = refuse_words(block == 0 ? "XYZIJKR" : "IJKR"); !done) return done;
        if (block == 0) return {};
        if (block < 3) {
            begun->points[static_cast<size_t>(block) - 1] = point;
            return {};
        }
        FEELER_TRY(const TiltedPlane plane,
                   plane_through(execution, begun->points[0], begun->points[1], point));
        use_plane(execution, plane);
    } else {
        if (auto done = refuse_words(block == 1 ? "R" : "XYZR"); !done) return done;
        if (block == 1) {
            begun->points = {point, direction};
            return {};
        }
        FEELER_TRY(const TiltedPlane plane,
                   plane_along(execution, begun->points[0], begun->points[1], direction));
        use_plane(execution, plane);
    }
    begun.reset();
    return {};
}

/// X, Y and Z of the plane of G68.3, whose Z is the direction of the tool, in work coordinates.
///
/// Source: Fanuc 30i, A-79976E, "Specifying tilted working plane based on the tool axis direction":
///         X is the product of the vertical axis (parameter 12321) and Z. Within the angle of
///         parameter 12322 the tool counts as parallel to the vertical axis, and X, Y and Z are
///         then the axes of the work in a fixed order.
core::Result<core::Mat3> axes_by_tool(Execution& execution, const CodeWord& entry,
                                      const core::Vec3& tool) {
    const auto axis =
        static_cast<int>(number_for(execution.state, execution.environment,
                                    ControlQuestion::vertical_axis, execution.block.line))
        - 1;
    core::Vec3 vertical(0.0);
    vertical[axis] = 1.0;
    const core::Vec3 x = glm::cross(vertical, tool);
    const double angle = // 0 to 180
        core::degrees_per_radian * core::atan2(glm::length(x), glm::dot(vertical, tool));
    constexpr double rounding = 1e-7, most_unknown = 5.0; // degrees
    if (angle >= 180.0 - rounding)
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("{}: the tool points against {}, and the manual of the control "
                        "does not say where X of the plane is then",
                        written(*entry.word), "XYZ"[axis]),
            entry.word->span);
    constexpr ControlQuestion question = ControlQuestion::vertical_limit;
    if (!execution.environment.control.number(question) && angle > rounding
        && angle <= most_unknown)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{}: the tool is within {:.2g} degrees of {}, and whether it "
                                      "counts as parallel is not known: state parameter \"12322\" "
                                      "under [control]",
                                      written(*entry.word), angle, "XYZ"[axis]),
                          entry.word->span);
    double limit = 0.0;
    if (angle > rounding)
        limit = number_for(execution.state, execution.environment, question, execution.block.line);
    if (limit == 0.0) limit = 1.0; // as the manual has it
    if (angle <= limit) {
        core::Mat3 axes(0.0);
        for (int i = 0; i < 3; ++i) axes[i][(axis + 1 + i) % 3] = 1.0;
        return axes;
    }
    const core::Vec3 along_x = glm::normalize(x);
    return core::Mat3(along_x, glm::cross(tool, along_x), tool);
}

/// G68.3.
core::Result<void> set_plane_of_tool(Execution& execution, const CodeWord& entry) {
    ModalState& modal = execution.modal();
    const Statement& statement = execution.statement;
    if (!modal.offsets.machine)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{}: the direction of the tool is not known: describe the "
                                      "rotary axes as [[machine.axis]] in the set-up",
                                      written(*entry.word)),
                          entry.word->span);
    if (modal.transforms.tilt)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: another tilted plane is on: program G69 before it",
                                      written(*entry.word)),
                          entry.word->span);
    const std::string_view letters = "XYZ";
    const auto stated = std::count_if(letters.begin(), letters.end(), [&](char letter) {
        return statement.word(letter) != nullptr;
    });
    if (stated != 0 && stated != 3)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} needs all of X, Y and Z, or none of them for the present "
                                      "position",
                                      written(*entry.word)),
                          entry.word->span);
    TiltedPlane plane{.origin = point_of(execution)};
    if (stated == 0) {
        Offsets on_work = modal.offsets;
        on_work.tilted_plane = true;
        const Position tip =
            program_from_machine(on_work, machine_from_program(modal.offsets, modal.position));
        core::Vec3 position(0.0);
        for (size_t axis = 0; axis < 3; ++axis) {
            if (!tip[axis])
                return core::fail(ErrorCode::missing_value,
                                  fmt::format("{}: the {} position is unknown: state the origin "
                                              "with X, Y and Z",
                                              written(*entry.word), axis_letters[axis]),
                                  entry.word->span);
            position[static_cast<int>(axis)] = *tip[axis];
        }
        plane.origin = modal.offsets.frame.linear * position + modal.offsets.frame.shift;
    }
    FEELER_TRY(const core::Mat3 tool,
               tool_axes_in_work(execution, entry.word->span, written(*entry.word)));
    FEELER_TRY(plane.axes, axes_by_tool(execution, entry, tool[2]));
    if (const Word* word = statement.word('R')) plane.axes *= turned_about(2, word->value);
    modal.transforms.tilt = plane;
    return {};
}

} // namespace

core::Result<void> set_tilted_plane(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::rotation);
    if (entry.code->number == g_code(68, 3)) return set_plane_of_tool(execution, entry);
    if (entry.code->number == g_code(68, 4) && !execution.modal().transforms.tilt)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{} adds to a tilted plane, but none is set: program G68.2 "
                                      "first",
                                      written(*entry.word)),
                          entry.word->span);
    const Word* form = is_feature_plane(execution) ? nullptr : execution.statement.word('P');
    if (form && (form->value == 2.0 || form->value == 3.0))
        return add_to_plane(execution, form->value == 2.0);
    TiltedPlane plane{.origin = point_of(execution)};
    FEELER_TRY(plane.axes, axes_of_plane(execution));
    use_plane(execution, plane);
    return {};
}

bool has_dynamic_offset(const ProgramTransforms& transforms) {
    return transforms.tilt && transforms.tilt->follows_table;
}

double sine_of_pole_limit(const Execution& execution) {
    const double limit =
        current_number(execution.state, execution.environment, ControlQuestion::pole_limit);
    return core::sin(limit / core::degrees_per_radian);
}

core::Result<void> check_dynamic_offset_is_off(const Execution& execution, const CodeWord& entry) {
    if (!has_dynamic_offset(execution.modal().transforms)) return {};
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("{}: cancel the dynamic work offset before it, with G255",
                                  written(*entry.word)),
                      entry.word->span);
}

namespace {

tl::unexpected<core::Error> fail_incomplete(const Execution& execution, const BegunPlane& begun) {
    return core::fail(
        ErrorCode::invalid_value,
        fmt::format("the tilted plane is not complete: {} must come before this block",
                    name_of_next(begun)),
        {.line = execution.block.line, .column = 1});
}

bool is_turn_to_plane(const CodeWord& entry) {
    const CodeNumber code = entry.code->number;
    return code == g_code(53, 1) || code == g_code(53, 6) || code == g_code(253);
}

} // namespace

bool turns_to_plane(const Execution& execution) {
    const auto codes = execution.statement.codes();
    return std::any_of(codes.begin(), codes.end(), is_turn_to_plane);
}

core::Result<void> turn_tool_to_plane(Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes()) {
        if (!is_turn_to_plane(entry)) continue;
        const std::string name = written(*entry.word);
        constexpr std::pair<char, std::string_view> refused[] = {
            {'R', "turning about another point than the tip"},
            {'H', "changing the tool length with the turn"}};
        for (const auto& [letter, what] : refused)
            if (const Word* word = execution.statement.word(letter); word && word->value != 0.0)
                return core::fail(ErrorCode::unsupported,
                                  fmt::format("{}: {} is not supported yet: program {} without {}",
                                              written(*word), what, name, letter),
                                  word->span);
        if (const auto& begun = execution.modal().transforms.begun_plane)
            return fail_incomplete(execution, *begun);
        if (!execution.modal().transforms.tilt)
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("{} needs a tilted plane, but none is set: program {} first", name,
                            entry.code->number == g_code(253) ? "G268" : "G68.2"),
                entry.word->span);
        if (execution.modal().offsets.machine)
            return turn_rotary_axes(execution, *entry.word, entry.code->number == g_code(53, 6));
        if (execution.modal().offsets.frame.tilts_tool)
            execution.warn(entry.word->span,
                           fmt::format("{} moves rotary axes as the machine is built: without a "
                                       "machine in the set-up these moves are not followed",
                                       name));
    }
    return {};
}

core::Result<void> check_dynamic_offset(const Execution& execution, const ModalState& before) {
    const ModalState& modal = execution.modal();
    if (!has_dynamic_offset(modal.transforms) || !has_dynamic_offset(before.transforms)) return {};
    const core::SourceSpan where{.line = execution.block.line, .column = 1};
    const bool turned = turns_between(before.position, modal.position);
    const Offsets &now = modal.offsets, &then = before.offsets;
    const bool shifted = now.active != then.active || now.work != then.work
                         || now.local != then.local || now.axis != then.axis;
    if (!turned && !shifted) return {};
    return core::fail(ErrorCode::unsupported,
                      turned
                          ? "a rotary axis turns while G254 is on, and the manual of the control "
                            "asks for G255 before: program G255 before this block, and G254 after "
                            "it"
                          : "a work offset changes while G254 is on: program G255 before this "
                            "block, and G254 after it",
                      where);
}

core::Result<void> check_plane_is_complete(const Execution& execution, const ModalState& before) {
    const auto& begun = before.transforms.begun_plane;
    if (!begun || execution.modal().transforms.begun_plane != begun) return {};
    const auto& words = execution.block.words;
    const bool is_empty = std::all_of(words.begin(), words.end(),
                                      [](const Word& word) { return word.letter == 'N'; });
    if (is_empty) return {};
    return fail_incomplete(execution, *begun);
}

AxisValues values_or_zero(const Position& position) {
    AxisValues values{};
    for (size_t axis = 0; axis < axis_count; ++axis) values[axis] = position[axis].value_or(0.0);
    return values;
}

bool is_upright(const core::Machine& machine, const Position& position) {
    constexpr double rounding = 1e-9;
    for (size_t axis = 3; axis < 6; ++axis)
        if (machine.axes[axis].present && machine.axes[axis].side == core::Side::tool
            && !position[axis])
            return false;
    const AxisValues values = values_or_zero(position);
    const core::Vec3 up(0.0, 0.0, 1.0);
    const core::Vec3 tool = core::machine_from_link(machine, machine.spindle, values).rotation * up;
    return glm::distance(tool, up) < rounding;
}

bool turns_between(const Position& from, const Position& to) {
    return !std::equal(from.begin() + 3, from.begin() + 6, to.begin() + 3);
}

std::optional<size_t> axis_with_rotary_offset(const Offsets& offsets) {
    for (size_t axis = 3; axis < 6; ++axis)
        if (offsets.machine->axes[axis].present && rotary_offset(offsets, axis) != 0.0) return axis;
    return std::nullopt;
}

double rotary_offset(const Offsets& offsets, size_t axis) {
    return offsets.work.origin[axis] + offsets.local[axis] + offsets.axis[axis].value_or(0.0)
           + offsets.tool[axis];
}

Position turned_in_place(const Offsets& offsets, const Position& program, const AxisValues& to) {
    Position there;
    std::copy(to.begin(), to.end(), there.begin());
    return turned_in_place(offsets, program, there);
}

Position turned_in_place(const Offsets& offsets, const Position& program, const Position& to) {
    Position machine = machine_from_program(offsets, program);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (is_rotary(axis) && offsets.machine->axes[axis].present) machine[axis] = to[axis];
    return program_from_machine(offsets, machine);
}

core::Result<core::Mat3> tool_axes_in_work(const Execution& execution, core::SourceSpan where,
                                           const std::string& what) {
    const Offsets& offsets = execution.modal().offsets;
    FEELER_TRY(const AxisValues values, values_now(execution, where, what));
    const core::Mat3 work = turned_about(2, offsets.work.rotation_deg);
    core::Mat3 table_from_axes;
    for (int axis = 0; axis < 3; ++axis)
        table_from_axes[axis] =
            table_from_work(offsets, work[axis]) - table_from_work(offsets, core::Vec3(0.0));
    return glm::transpose(table_from_axes) * core::tool_frame(*offsets.machine, values);
}

core::Vec3 direction_in_table(const Offsets& offsets, const core::Vec3& direction) {
    const core::Vec3 in_work =
        turned_about(2, offsets.work.rotation_deg) * (offsets.frame.linear * direction);
    return table_from_work(offsets, in_work) - table_from_work(offsets, core::Vec3(0.0));
}

void turn_about_tip(Execution& execution, const AxisValues& to, double below,
                    const std::function<void(const Position&)>& go) {
    const Offsets kept = execution.modal().offsets;
    const auto use = [&](const Offsets& offsets) {
        change_offsets(execution, offsets);
        execution.emit(SetOffset{offsets});
    };
    Offsets about_tip = kept;
    about_tip.follows_tip = true;
    about_tip.tool[2] += below;
    use(about_tip);
    Position end = execution.modal().position;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (is_rotary(axis) && kept.machine->axes[axis].present)
            end[axis] = to[axis] - rotary_offset(about_tip, axis);
    go(end);
    use(kept);
}

core::Result<double> angle_to_plane(const Execution& execution, core::SourceSpan where,
                                    const std::string& what) {
    const Offsets& offsets = execution.modal().offsets;
    FEELER_TRY(const AxisValues values, values_now(execution, where, what));
    const core::Vec3 tool = core::tool_frame(*offsets.machine, values)[2];
    const core::Vec3 plane = direction_in_table(offsets, core::Vec3(0.0, 0.0, 1.0));
    return core::atan2(glm::length(glm::cross(tool, plane)), glm::dot(tool, plane));
}

std::optional<core::Mat3> plane_by_projections(double about_y, double about_x) {
    const core::Vec3 x = turned_about(1, about_y)[0], y = turned_about(0, about_x)[1];
    const core::Vec3 normal = glm::cross(x, y);
    constexpr double least_sine = 1e-3; // below, rounded angles decide the direction
    if (!(glm::length(normal) > least_sine)) return std::nullopt;
    const core::Vec3 z = glm::normalize(normal);
    return core::Mat3(x, glm::cross(z, x), z);
}

core::Result<AxisValues> axes_along_z(Execution& execution, core::SourceSpan where,
                                      const std::string& what, int sign, bool may_be_other) {
    const Offsets& offsets = execution.modal().offsets;
    FEELER_TRY(const AxisValues values, values_now(execution, where, what));
    const auto tilt = core::tilting_axis(*offsets.machine);
    auto ways = core::ways_to_point_tool(*offsets.machine, values,
                                         direction_in_table(offsets, core::Vec3(0.0, 0.0, 1.0)));
    // An axis without limits may stand whole turns away from the position that is meant.
    const auto is_other = [&](const AxisValues& way) {
        if (!tilt) return false;
        const core::MachineAxis& axis = offsets.machine->axes[*tilt];
        const bool is_limited = axis.min && axis.max;
        return sign * (is_limited ? way[*tilt] : std::remainder(way[*tilt], 360.0)) < 0.0;
    };
    if (!may_be_other || !std::all_of(ways.begin(), ways.end(), is_other))
        std::erase_if(ways, is_other);
    if (ways.empty()) return fail_to_tilt(what, where);
    if (ways.size() > 1)
        execution.warn(where,
                       fmt::format("{}: of the positions of the rotary axes that tilt the tool "
                                   "that way, the control is assumed to take the nearest: {} at "
                                   "{:.4g}, not {:.4g} degrees",
                                   what, axis_letters[*tilt], ways[0][*tilt], ways[1][*tilt]),
                       Severity::note);
    return ways.front();
}

core::Result<void> check_free_axis(const Execution& execution, const core::Mat3& plane,
                                   core::SourceSpan where, const std::string& what,
                                   bool also_turned) {
    constexpr double rounding = 1e-9;
    const ModalState& modal = execution.modal();
    if (glm::distance(plane[2], core::Vec3(0.0, 0.0, 1.0)) > rounding) return {};
    const bool is_turned = glm::distance(plane[0], core::Vec3(1.0, 0.0, 0.0)) > rounding;
    const Position machine = machine_from_program(modal.offsets, modal.position);
    for (size_t axis = 3; axis < 6; ++axis) {
        const core::MachineAxis& own = modal.offsets.machine->axes[axis];
        const bool is_free = own.present && std::abs(own.direction.z) > 1.0 - rounding;
        if (is_free
            && ((also_turned && is_turned) || is_away_from_zero(axis, machine[axis].value_or(0.0))))
            return core::fail(
                ErrorCode::unsupported,
                fmt::format("{}: a level plane that is turned, or with axis {} away from 0, is not "
                            "supported yet, because controls differ: turn {} to 0 first",
                            what, axis_letters[axis], axis_letters[axis]),
                where);
    }
    return {};
}

std::optional<ToolDirection> vector_words(const Block& block, std::string_view letters) {
    ToolDirection found;
    for (const Word& word : block.words)
        if (const size_t axis = letters.find(word.letter); axis != std::string_view::npos) {
            found.direction[static_cast<int>(axis)] = word.value;
            found.word = &word;
        }
    return found.word ? std::optional(found) : std::nullopt;
}

std::optional<ToolDirection> tool_direction(const Execution& execution) {
    const ModalState& modal = execution.modal();
    if (modal.transforms.follows_vectors) return vector_words(execution.block, "IJK");
    if (!modal.offsets.follows_tip && !modal.following.may_be_on) return std::nullopt;
    if (execution.tool_by_angles) return execution.tool_by_angles;
    const auto tool = vector_words(execution.block, direction_letters);
    return tool ? tool : vector_words(execution.block, normal_letters);
}

core::Result<void> point_by_vector(const Execution& execution, Position& target) {
    const ModalState& modal = execution.modal();
    if (!modal.offsets.machine) return {};
    const auto tool = tool_direction(execution);
    if (!tool) return {};
    if (!(glm::length(tool->direction) > 0.0))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a direction of 0, 0, 0 is no tool direction",
                                      words_at(execution, *tool->word)),
                          tool->word->span);
    FEELER_TRY(const AxisValues values, pointed(execution, *tool->word, tool->direction));
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (is_rotary(axis) && modal.offsets.machine->axes[axis].present)
            target[axis] = values[axis] - rotary_offset(modal.offsets, axis);
    return {};
}

} // namespace gcode
