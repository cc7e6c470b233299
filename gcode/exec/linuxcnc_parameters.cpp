#include "gcode/exec/linuxcnc_parameters.h"

#include <array>

#include <fmt/format.h>

#include "gcode/language/codes.h"
#include "gcode/language/lexer.h"

namespace gcode {
namespace {

constexpr int first_home = 5161, second_home = 5181, g92_is_on = 5210, first_g92 = 5211;
constexpr int active_offset = 5220, first_offset = 5221, offset_step = 20, rotation_at = 9;
constexpr int tool_number = 5400, first_tool_offset = 5401, tool_diameter = 5410;
constexpr int tool_front = 5411, tool_back = 5412, tool_orientation = 5413;
constexpr int first_position = 5420;

bool is_axis_of(int number, int first) {
    return number >= first && number < first + static_cast<int>(axis_count);
}

/// A value in the units of a parameter; angles are not converted.
double shown(double value, size_t axis, LengthUnit unit) {
    return is_rotary(axis) ? value : from_mm(value, unit);
}
double taken(double value, size_t axis, LengthUnit unit) {
    return is_rotary(axis) ? value : to_mm(value, unit);
}

Value of_position(const Position& position, int number, int first, LengthUnit unit) {
    const auto axis = static_cast<size_t>(number - first);
    return shown(position[axis].value_or(0.0), axis, unit);
}

/// The work offset of a parameter number, and which of its values.
struct OffsetParameter {
    size_t offset;
    int value; // 0 to 8: an axis; 9: the rotation
};

std::optional<OffsetParameter> offset_parameter(int number) {
    if (number < first_offset) return std::nullopt;
    const int offset = (number - first_offset) / offset_step;
    const int value = (number - first_offset) % offset_step;
    if (offset >= static_cast<int>(plain_offset_count) || value > rotation_at) return std::nullopt;
    return OffsetParameter{static_cast<size_t>(offset), value};
}

Value of_tool(const InterpreterState& state, const Environment& environment, int number) {
    const ModalState& modal = state.modal;
    const int tool = modal.tool ? value_of(*modal.tool) : 0;
    if (number == tool_number) return static_cast<double>(tool);
    const auto entry = state.tables->lengths.find(core::OffsetNumber(tool));
    const LengthOffset known =
        entry != state.tables->lengths.end() ? entry->second : LengthOffset{};
    // Values of the tool in the spindle, whether or not its offset is active.
    if (is_axis_of(number, first_tool_offset)) {
        const auto axis = static_cast<size_t>(number - first_tool_offset);
        const double value =
            axis == 2 ? length_under(*state.tables, tool).value_or(0.0) : known.shift[axis];
        return shown(tool == 0 ? 0.0 : value, axis, environment.machine_unit);
    }
    if (number == tool_diameter)
        return from_mm(diameter_under(*state.tables, tool).value_or(0.0), environment.machine_unit);
    if (number == tool_front) return known.front_deg;
    if (number == tool_back) return known.back_deg;
    return static_cast<double>(known.orientation);
}

/// The motion code in tenths, as in #<_motion_mode>.
double motion_mode(const ModalState& modal) {
    if (modal.cycle) return tenths_of(modal.cycle->code);
    const std::optional<CodeNumber> motion = modal.motion ? number_of(*modal.motion) : std::nullopt;
    return tenths_of(motion.value_or(g_code(80)));
}

double coordinate_system(const ModalState& modal) {
    const auto index = static_cast<double>(modal.offsets.active);
    return index < 6 ? 540.0 + 10.0 * index : 590.0 + index - 5.0;
}

double compensation_code(const ModalState& modal) {
    if (modal.compensation == Side::none) return 400.0;
    return modal.compensation == Side::left ? 410.0 : 420.0;
}

struct Named {
    std::string_view name;
    double (*value)(const InterpreterState& state);
};

constexpr Named named_values[] = {
    {"_motion_mode", [](const InterpreterState& s) { return motion_mode(s.modal); }},
    {"_plane",
     [](const InterpreterState& s) {
         constexpr double codes[] = {170, 180, 190, 171, 181, 191};
         return codes[static_cast<size_t>(s.modal.plane)];
     }},
    {"_ccomp", [](const InterpreterState& s) { return compensation_code(s.modal); }},
    {"_metric", [](const InterpreterState& s) { return truth(s.modal.unit == LengthUnit::mm); }},
    {"_imperial",
     [](const InterpreterState& s) { return truth(s.modal.unit == LengthUnit::inch); }},
    {"_absolute",
     [](const InterpreterState& s) { return truth(s.modal.distance == DistanceMode::absolute); }},
    {"_incremental",
     [](const InterpreterState& s) {
         return truth(s.modal.distance == DistanceMode::incremental);
     }},
    {"_inverse_time",
     [](const InterpreterState& s) { return truth(s.modal.feed_mode == FeedMode::inverse_time); }},
    {"_units_per_minute",
     [](const InterpreterState& s) { return truth(s.modal.feed_mode == FeedMode::per_minute); }},
    {"_units_per_rev",
     [](const InterpreterState& s) { return truth(s.modal.feed_mode == FeedMode::per_turn); }},
    {"_coord_system", [](const InterpreterState& s) { return coordinate_system(s.modal); }},
    {"_tool_offset",
     [](const InterpreterState& s) { return truth(s.modal.offsets.tool != AxisValues{}); }},
    {"_retract_r_plane",
     [](const InterpreterState& s) { return truth(s.modal.retract == RetractMode::r_level); }},
    {"_retract_old_z",
     [](const InterpreterState& s) {
         return truth(s.modal.retract == RetractMode::initial_level);
     }},
    {"_spindle_rpm_mode", [](const InterpreterState& s) { return truth(!s.modal.surface_speed); }},
    {"_spindle_css_mode", [](const InterpreterState& s) { return truth(s.modal.surface_speed); }},
    {"_ijk_absolute_mode",
     [](const InterpreterState& s) {
         return truth(s.modal.arc_distance == DistanceMode::absolute);
     }},
    {"_lathe_diameter_mode",
     [](const InterpreterState& s) { return truth(s.modal.diameter_mode); }},
    {"_lathe_radius_mode", [](const InterpreterState& s) { return truth(!s.modal.diameter_mode); }},
    {"_spindle_on",
     [](const InterpreterState& s) {
         return truth(s.modal.spindle != core::SpindleDirection::stopped);
     }},
    {"_spindle_cw",
     [](const InterpreterState& s) {
         return truth(s.modal.spindle == core::SpindleDirection::clockwise);
     }},
    {"_mist", [](const InterpreterState& s) { return truth(s.modal.mist); }},
    {"_flood", [](const InterpreterState& s) { return truth(s.modal.flood); }},
    {"_speed_override", [](const InterpreterState& s) { return truth(s.modal.speed_override); }},
    {"_feed_override", [](const InterpreterState& s) { return truth(s.modal.feed_override); }},
    {"_adaptive_feed", [](const InterpreterState& s) { return truth(s.modal.adaptive_feed); }},
    {"_feed_hold", [](const InterpreterState& s) { return truth(s.modal.feed_hold); }},
    {"_feed",
     [](const InterpreterState& s) {
         const double feed = s.modal.feed.value_or(0.0);
         const bool is_time = s.modal.feed_mode == FeedMode::inverse_time;
         return is_time ? feed : from_mm(feed, s.modal.unit);
     }},
    {"_rpm", [](const InterpreterState& s) { return s.modal.speed; }},
    {"_current_tool",
     [](const InterpreterState& s) {
         return s.modal.tool ? static_cast<double>(value_of(*s.modal.tool)) : 0.0;
     }},
    {"_selected_tool",
     [](const InterpreterState& s) {
         const auto& tool = s.modal.selected_tool;
         return tool ? static_cast<double>(value_of(*tool)) : 0.0;
     }},
    {"_line", [](const InterpreterState& s) { return static_cast<double>(s.next.line) - 1.0; }},
    {"_call_level",
     [](const InterpreterState& s) { return static_cast<double>(s.frames.size()) - 1.0; }},
    {"_remap_level", [](const InterpreterState&) { return 0.0; }},
    {"_task", [](const InterpreterState&) { return 1.0; }}, // 0 in a preview only
    {"_vmajor", [](const InterpreterState&) { return 2.9; }},
    {"_vminor", [](const InterpreterState&) { return 0.0; }},
};

} // namespace

std::optional<Value> linuxcnc_parameter(const InterpreterState& state,
                                        const Environment& environment, int number) {
    const ModalState& modal = state.modal;
    const LengthUnit unit = environment.machine_unit;
    if (number < first_home || number >= first_position + static_cast<int>(axis_count))
        return std::nullopt;
    if (is_axis_of(number, first_home)) return of_position(modal.home, number, first_home, unit);
    if (is_axis_of(number, second_home))
        return of_position(modal.second_home, number, second_home, unit);
    if (number == g92_is_on) return truth(modal.axis_offset_on);
    if (is_axis_of(number, first_g92))
        return of_position(modal.suspended_axis, number, first_g92, unit);
    if (number == active_offset) return static_cast<double>(modal.offsets.active + 1);
    if (const auto parameter = offset_parameter(number)) {
        const WorkOffset offset = work_offset(*state.tables, parameter->offset);
        if (parameter->value == rotation_at) return offset.rotation_deg;
        const auto axis = static_cast<size_t>(parameter->value);
        return shown(offset.origin[axis], axis, unit);
    }
    if (number >= tool_number && number <= tool_orientation)
        return of_tool(state, environment, number);
    if (is_axis_of(number, first_position))
        return of_position(modal.position, number, first_position, modal.unit);
    return std::nullopt;
}

std::optional<Value> linuxcnc_parameter(const InterpreterState& state,
                                        const Environment& environment, std::string_view name) {
    if (name.size() < 2 || name[0] != '_') return std::nullopt;
    if (name.starts_with("_ini[")) {
        const auto found = environment.ini_values.find(std::string(name));
        if (found == environment.ini_values.end()) return std::nullopt;
        return Value{found->second};
    }
    if (name.starts_with("_hal[")) {
        if (environment.kinematics && name == "_hal[motion.switchkins-type]")
            return Value{static_cast<double>(state.modal.kinematics)};
        const auto found = environment.hal_values.find(std::string(name));
        if (found == environment.hal_values.end()) return std::nullopt;
        return Value{found->second};
    }
    if (name.size() == 2 || name.starts_with("_abs_")) {
        const size_t axis = axis_letters.find(upper(name.back()));
        if (axis != std::string_view::npos && (name.size() == 2 || name.size() == 6)) {
            const ModalState& modal = state.modal;
            const Position position =
                name.size() == 2
                    ? modal.position
                    : machine_from_program(counted_offsets(modal.offsets), modal.position);
            return shown(position[axis].value_or(0.0), axis, modal.unit);
        }
    }
    for (const Named& entry : named_values)
        if (entry.name == name) return entry.value(state);
    const bool of_calls = name == "_value" || name == "_value_returned";
    if (of_calls && !state.parameters->named().contains(name)) return Value{0.0};
    return std::nullopt;
}

bool sets_linuxcnc_position(int number) {
    return is_axis_of(number, first_home) || is_axis_of(number, second_home)
           || is_axis_of(number, first_g92) || offset_parameter(number);
}

core::Result<bool> set_linuxcnc_parameter(InterpreterState& state, const Environment& environment,
                                          int number, Value value, core::SourceSpan where) {
    const LengthUnit unit = environment.machine_unit;
    const double given = value.value_or(0.0);
    if ((number >= tool_number && number <= tool_orientation) || is_axis_of(number, first_position))
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("#{} is read-only and cannot be set", number), where);
    const auto take = [&](Position& position, int first) {
        const auto axis = static_cast<size_t>(number - first);
        position[axis] = taken(given, axis, unit);
    };
    if (is_axis_of(number, first_home)) {
        take(state.modal.home, first_home);
    } else if (is_axis_of(number, second_home)) {
        take(state.modal.second_home, second_home);
    } else if (is_axis_of(number, first_g92)) {
        take(state.modal.suspended_axis, first_g92);
    } else if (const auto parameter = offset_parameter(number)) {
        WorkOffset& offset = writable_work_offset(state.tables.write(), parameter->offset);
        const auto axis = static_cast<size_t>(parameter->value);
        if (parameter->value == rotation_at)
            offset.rotation_deg = given;
        else
            offset.origin[axis] = taken(given, axis, unit);
    } else {
        return number == g92_is_on || number == active_offset;
    }
    return true;
}

void restore_offsets(InterpreterState& state, const Environment& environment) {
    if (dialect(environment.dialect).system_parameters != SystemParameters::rs274) return;
    const auto stored = [&](int number) {
        const auto found = environment.parameters.find(number);
        return found != environment.parameters.end() ? found->second : 0.0;
    };
    ModalState& modal = state.modal;
    const double active = stored(active_offset);
    if (active >= 1.0 && active <= static_cast<double>(plain_offset_count))
        modal.offsets.active = static_cast<size_t>(active) - 1;
    modal.offsets.work = work_offset(*state.tables, modal.offsets.active);
    if (stored(g92_is_on) == 0.0) return;
    modal.axis_offset_on = true;
    modal.offsets.axis = modal.suspended_axis;
}

} // namespace gcode
