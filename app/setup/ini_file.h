#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace core {
struct Machine;
}
namespace gcode {
enum class LengthUnit : uint8_t;
struct Environment;
} // namespace gcode

namespace app {

/// What an ini file of LinuxCNC says about how programs are read. Paths are resolved against the
/// file's folder; empty where the file says nothing.
struct IniFile {
    std::optional<gcode::LengthUnit> machine_unit; // [TRAJ] LINEAR_UNITS
    std::string parameters;                        // [RS274NGC] PARAMETER_FILE
    std::string tool_table;                        // [EMCIO] TOOL_TABLE
    std::vector<std::string> search_path; // [DISPLAY] PROGRAM_PREFIX, [RS274NGC] SUBROUTINE_PATH
    std::string startup_code;             // [RS274NGC] RS274NGC_STARTUP_CODE
    std::string wrapped_axes;             // letters of those with WRAPPED_ROTARY = 1
    std::map<std::string, double> values; // all numbers, as programs name them: _ini[traj]x
};

/// Errors: io when it cannot be read; syntax, with its line, for units that are neither mm nor
///         inches; unsupported for #INCLUDE.
core::Result<IniFile> read_ini(const std::string& path);

/// Gives the axes of a machine the limits, speeds, accelerations and homes that LinuxCNC's ini file
/// states and nobody else did: [AXIS_X], or [AXIS_0] of older files, and [JOINT_0] of a machine
/// whose joints are its axes, in the order of X Y Z A B C U V W.
///
/// `places`: limits and homes, too; they mean nothing where work offsets are made up.
///
/// Result: what a user should know of it; empty where nothing was taken.
std::string complete_machine(core::Machine& machine, const gcode::Environment& environment,
                             bool places);

/// The folders in a list that ':' separates.
std::vector<std::string> split_search_path(const std::string& text);

} // namespace app
