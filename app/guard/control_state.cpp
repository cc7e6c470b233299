#include "app/guard/control_state.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/setup/control/offset_differences.h"
#include "app/setup/setup_file.h"
#include "gcode/language/canonical.h"

namespace app {
core::Result<ControlState> read_control_state(std::string_view line) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    ControlState state;
    try {
        state.work_offset = json.at("work_offset").get<int>();
        state.origin = json.at("origin").get<core::AxisValues>();
        state.rotation_deg = json.at("rotation").get<double>();
        state.tool = json.at("tool").get<int>();
        state.tool_length = json.at("tool_length").get<double>();
        state.is_homed = json.at("homed").get<bool>();
        state.is_mdi = json.value("mdi", false);
    } catch (const nlohmann::json::exception& error) {
        return core::fail(core::ErrorCode::syntax,
                          fmt::format("the status of LinuxCNC cannot be read: {}", error.what()));
    }
    return state;
}

std::string difference(const SetupFile& setup, const ControlState& control, double unit,
                       double tolerance) {
    if (!control.is_homed) return "The machine is not homed, so nobody knows where it is.";
    if (control.work_offset < 1 || control.work_offset > 9)
        return "LinuxCNC does not say which work offset it uses: select one, for example by G54.";
    const auto index = static_cast<size_t>(control.work_offset - 1);
    const std::string name = gcode::name_of_offset(index);
    if (!states_work_offset(setup, index))
        return fmt::format("{} is in use, and the set-up does not state it.", name);
    const gcode::AxisValues stated = setup.environment.work_offset(index);
    for (size_t axis = 0; axis < core::axis_count; ++axis) {
        const bool is_angle = core::is_rotary(axis);
        const double value = control.origin[axis] * (is_angle ? 1.0 : unit);
        if (std::abs(value - stated[axis]) <= tolerance) continue;
        return fmt::format("{} {} is {:.4f} on the control and {:.4f} in the set-up ({}).", name,
                           core::axis_letters[axis], value, stated[axis],
                           is_angle ? "degrees" : "mm");
    }
    if (!(std::abs(control.rotation_deg) <= tolerance))
        return fmt::format("{} is turned by {:.4f} degrees on the control and not in the set-up.",
                           name, control.rotation_deg);
    if (control.tool == 0) return {};
    const auto row = setup.environment.length_offsets.find(core::OffsetNumber{control.tool});
    const auto length = setup.environment.tool_lengths.find(core::ToolNumber{control.tool});
    const bool has_row = row != setup.environment.length_offsets.end();
    if (!has_row && length == setup.environment.tool_lengths.end())
        return fmt::format("Tool {} is in the spindle, and the set-up does not describe it.",
                           control.tool);
    const double in_setup = has_row ? row->second.length + row->second.wear : length->second;
    const double on_control = control.tool_length * unit;
    if (std::abs(on_control - in_setup) <= tolerance) return {};
    return fmt::format("The length of tool {} is {:.4f} on the control and {:.4f} in the set-up "
                       "(mm).",
                       control.tool, on_control, in_setup);
}

} // namespace app
