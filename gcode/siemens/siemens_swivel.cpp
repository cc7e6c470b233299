#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "gcode/exec/following.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/siemens/siemens.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// The parameters of CYCLE800; those that are left out are 0.
struct Swivel {
    double retract = 0.0;     // _FR
    int state = 0;            // _ST
    int mode = 57;            // _MODE
    core::Vec3 before, after; // X0 Y0 Z0 and X1 Y1 Z1, mm
    core::Vec3 angles;        // in the order of the mode
    int direction = 0;        // _DIR
    double way_back = 0.0;    // _FR_I, mm
    bool knows_places = true; // the set-up states the places of these swivel data
    size_t given = 0;         // parameters

    bool adds() const { return std::abs(state) % 10 == 1; }
    bool keeps_tip() const { return std::abs(state) / 10 % 10 == 1; }
};

Swivel swivel_of(const Execution& execution, const std::vector<std::optional<double>>& values) {
    const auto value = [&](size_t i) { return i < values.size() ? values[i].value_or(0.0) : 0.0; };
    const auto whole = [&](size_t i) { return static_cast<int>(std::clamp(value(i), -1e9, 1e9)); };
    const auto lengths = [&](size_t i) {
        const LengthUnit unit = execution.modal().unit;
        return core::Vec3(to_mm(value(i), unit), to_mm(value(i + 1), unit),
                          to_mm(value(i + 2), unit));
    };
    Swivel swivel{.retract = value(0),
                  .state = whole(2),
                  .before = lengths(4),
                  .after = lengths(10),
                  .angles = {value(7), value(8), value(9)},
                  .direction = whole(13),
                  .way_back = to_mm(value(14), execution.modal().unit),
                  .given = values.size()};
    if (values.size() > 3 && values[3]) swivel.mode = whole(3);
    return swivel;
}

/// The axis of an angle by the mode, 1 to 3; 0: none.
int axis_of_angle(const Swivel& swivel, int angle) { return (swivel.mode >> (2 * angle)) & 3; }

/// By projection angles about X and Y, and a turn in the plane.
///
/// Source: SINUMERIK 828D, Operating Manual Turning 01/2015, 9.6: with the angles XY or YX, X of
///         the plane stays in the old ZX plane. Function Manual Basic Functions, K2: their signs.
core::Result<core::Mat3> projected_rotation(const Swivel& swivel, core::SourceSpan where) {
    const int first = axis_of_angle(swivel, 0), second = axis_of_angle(swivel, 1);
    const bool is_known =
        first + second == 3 && first != 0 && second != 0 && axis_of_angle(swivel, 2) == 3;
    if (!is_known)
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("CYCLE800: projection angles are only supported about X and Y, "
                        "with a third one about Z, not in mode {}",
                        swivel.mode),
            where);
    const double about_x = swivel.angles[first == 1 ? 0 : 1];
    const double about_y = swivel.angles[first == 1 ? 1 : 0];
    const auto plane = plane_by_projections(about_y, about_x);
    if (!plane)
        return core::fail(ErrorCode::invalid_value,
                          "CYCLE800: the projection angles define no plane", where);
    return *plane * turned_about(2, swivel.angles[2]);
}

/// The rotation of the plane.
///
/// Source: SINUMERIK 840D sl, Programming Manual Job Planning, CYCLE800: _MODE. Bits 7 and 6: how
///         the angles are given; axis by axis, two bits for each axis, in the order of rotation.
core::Result<core::Mat3> rotation_of(const Swivel& swivel, core::SourceSpan where) {
    const int form = (swivel.mode >> 6) & 3;
    if (form == 2) return projected_rotation(swivel, where);
    if (form == 1) // solid angle: about Z, then about the new Y
        return turned_about(2, swivel.angles[0]) * turned_about(1, swivel.angles[1]);
    if (form != 0)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("CYCLE800: mode {} (by rotary axes) is not supported yet: "
                                      "give the angles axis by axis, mode 57",
                                      swivel.mode),
                          where);
    core::Mat3 rotation(1.0);
    for (int i = 0; i < 3; ++i)
        if (const int axis = axis_of_angle(swivel, i); axis != 0)
            rotation = rotation * turned_about(axis - 1, swivel.angles[i]);
        else if (swivel.angles[i] != 0.0)
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("CYCLE800: mode {} names no axis for its angle {}", swivel.mode, i + 1),
                where);
    return rotation;
}

/// The kinds of retract, _FR.
constexpr double along_z = 1.0, along_z_then_xy = 2.0, along_tool = 4.0, along_tool_by = 5.0;

/// The way that a retract takes through machine coordinates; empty if it is not known, or if it
/// would lower the tool.
///
/// Source: SINUMERIK 840D sl, Turning, Operating Manual 06/2019, swivel plane: the kinds of
/// retract.
///         Commissioning Manual 12/2017, 15.7: the machine builder states its positions.
std::vector<Position> way_of_retract(const Execution& execution, const Swivel& swivel) {
    const Offsets& offsets = execution.modal().offsets;
    const Position now = machine_from_program(offsets, execution.modal().position);
    Position above = now;
    if (swivel.retract == along_z || swivel.retract == along_z_then_xy) {
        if (!swivel.knows_places) return {};
        above[2] = execution.environment.swivel_retract[2];
    } else if (swivel.retract == along_tool || swivel.retract == along_tool_by) {
        if (!offsets.machine || !is_upright(*offsets.machine, now) || !now[2]) return {};
        above[2] = offsets.machine->axes[2].max;
        if (swivel.retract == along_tool_by) above[2] = *now[2] + swivel.way_back;
    } else {
        return {};
    }
    constexpr double farthest = 1e6; // mm; no machine has such a place
    for (const auto& place : {above[2], execution.environment.swivel_retract[0],
                              execution.environment.swivel_retract[1]})
        if (place && !(std::abs(*place) < farthest)) return {};
    if (!above[2] || (now[2] && *above[2] < *now[2])) return {};
    if (swivel.retract == along_tool_by && !(swivel.way_back > 0.0)) return {};
    if (swivel.retract != along_z_then_xy) return {above};
    Position aside = above;
    for (size_t axis = 0; axis < 2; ++axis) {
        aside[axis] = execution.environment.swivel_retract[axis];
        if (!aside[axis]) return {};
    }
    return {above, aside};
}

void retract(Execution& execution, const Swivel& swivel, core::SourceSpan where) {
    const std::vector<Position> way = way_of_retract(execution, swivel);
    for (const Position& machine : way)
        execution.traverse(program_from_machine(execution.modal().offsets, machine));
    if (!way.empty()) return;
    const bool is_stated = swivel.retract == along_z || swivel.retract == along_z_then_xy;
    lose_positions(
        execution, where,
        "CYCLE800: where it retracts before the swivel is not known. That move is not "
        "checked, nor are later ones until X, Y and Z have been programmed again",
        std::string(is_stated
                        ? "State under [control] to where it retracts, above where the tool is: "
                          "\"CYCLE800 Z\", and \"CYCLE800 X\" and \"CYCLE800 Y\" if it "
                          "does along them. Or retract"
                        : "Retract")
            + " before the cycle, and call it with 0 as its first parameter.");
}

/// Turns the rotary axes to the plane.
core::Result<void> turn_to_plane(Execution& execution, const Swivel& swivel,
                                 core::SourceSpan where) {
    FEELER_TRY(const AxisValues values,
               axes_along_z(execution, where, "CYCLE800", swivel.direction > 0 ? 1 : -1, true));
    if (const auto tilt = core::tilting_axis(*execution.modal().offsets.machine))
        execution.warn(
            where,
            fmt::format("CYCLE800: its direction is taken for the sign of axis {}; which "
                        "axis it refers to is set at the machine",
                        axis_letters[*tilt]),
            Severity::note);
    const auto go = [&](const Position& end) { execution.traverse(end); };
    if (swivel.keeps_tip())
        turn_about_tip(execution, values, 0.0, go);
    else
        go(turned_in_place(execution.modal().offsets, execution.modal().position, values));
    return {};
}

/// With direction 0 the control only computes the plane, for rotary axes that are in its position
/// already. Others would move the coordinates in a way that only the control knows.
core::Result<void> check_tool_is_in_plane(const Execution& execution, core::SourceSpan where) {
    constexpr double rounding = 5e-5; // radians, of programmed angles
    FEELER_TRY(const double off, angle_to_plane(execution, where, "CYCLE800"));
    if (off <= rounding) return {};
    return core::fail(
        ErrorCode::unsupported,
        fmt::format("CYCLE800 with direction 0 does not turn the rotary axes, and the "
                    "tool is {:.3g} degrees from the plane: turn them to the plane "
                    "before it, or give the direction -1 or 1",
                    off * core::degrees_per_radian),
        where);
}

} // namespace

core::Result<void> swivel(Execution& execution, const SiemensKeywordUse& use) {
    FEELER_TRY(const auto values, cycle_values(execution, use));
    Swivel swivel = swivel_of(execution, values);
    const auto& arguments = siemens_of(execution.block).arguments;
    const std::string name(arguments.size() > 1 ? arguments[1].text : std::string_view());
    std::string& known = writable_siemens(execution.state).swivel_data;
    if (name == "0") // no swivel data
        swivel = {.retract = swivel.retract, .knows_places = false};
    else if (known.empty())
        known = name;
    else if (!name.empty() && name != known)
        swivel.knows_places = false; // they are those of the first data in the program
    FEELER_TRY(const core::Mat3 rotation, rotation_of(swivel, use.span));
    if (execution.modal().compensation != Side::none)
        return core::fail(ErrorCode::unsupported,
                          "CYCLE800 between G41 or G42 and G40 is not supported yet: cancel "
                          "cutter radius compensation first",
                          use.span);
    if (siemens_of(execution.state).turns_with_tool)
        return core::fail(ErrorCode::unsupported,
                          "CYCLE800 while TOROT is on is not supported yet: program TOROTOF before "
                          "it",
                          use.span);
    const bool changes_plane = swivel.given > 0 || siemens_of(execution.state).swivels;
    if (changes_plane && is_within_save(execution.state))
        return core::fail(
            ErrorCode::unsupported,
            "CYCLE800 in a subprogram with SAVE is not supported yet: call it outside", use.span);
    execution.column = use.span.column;
    const bool deletes = !swivel.adds();
    if (!deletes && siemens_of(execution.state).frame != ProgramFrame{})
        return core::fail(ErrorCode::unsupported,
                          "CYCLE800 that adds a plane while TRANS, ROT, SCALE or MIRROR is on is "
                          "not supported yet: give the whole plane in one call",
                          use.span);
    if (deletes) delete_siemens_frame(execution);
    if (swivel.retract != 0.0) retract(execution, swivel, use.span);
    const ProgramFrame before = deletes ? ProgramFrame{} : siemens_of(execution.state).swivel;
    const ProgramFrame step{rotation, swivel.before + rotation * swivel.after};
    const ProgramFrame plane{before.linear * step.linear,
                             before.shift + before.linear * step.shift};
    const bool is_level = plane.linear == core::Mat3(1.0);
    const bool has_machine = execution.modal().offsets.machine != nullptr;
    const bool turns = swivel.given > 0 && swivel.direction != 0;
    if (turns && has_machine)
        if (auto done = check_free_axis(execution, plane.linear, use.span, "CYCLE800", true); !done)
            return done;
    use_swivelled_plane(execution, plane, !is_level);
    if (!turns && !is_level && has_machine) return check_tool_is_in_plane(execution, use.span);
    if (!turns) return {};
    if (has_machine) return turn_to_plane(execution, swivel, use.span);
    execution.modal().following.rotary_unknown = !is_level;
    return {};
}

} // namespace gcode
