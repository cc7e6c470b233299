#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/hal_settings.h"
#include "core/base/result.h"

namespace core {
struct Machine;
}
namespace gcode {
enum class LengthUnit : uint8_t;
struct Environment;
struct ToolChangeMotion;
} // namespace gcode

namespace app {

/// The settings in a LinuxCNC ini file that affect how programs are read; empty if not stated.
/// Paths are resolved against the file's folder.
struct IniFile {
    // [EMCIO] TOOL_CHANGE_POSITION: 3, 6 or 9 numbers for X Y Z, A B C and U V W, in units of the
    // machine; TOOL_CHANGE_QUILL_UP, TOOL_CHANGE_AT_G30, TOOL_CHANGE_WITH_SPINDLE_ON
    std::vector<double> tool_change_position;
    bool quill_up = false, tool_change_at_g30 = false, tool_change_with_spindle_on = false;
    std::string kinematics;          // [KINS] KINEMATICS: the name of the module
    std::string kinematics_settings; // what follows it, such as sparm=identityfirst
    std::string coordinates;         // [TRAJ] COORDINATES: the letter of each joint
    HalSettings hal;                 // [HAL] HALCMD, HALFILE; [DISPLAY] PYVCP
    // [RS274NGC] REMAP: codes such as M428 with the subprogram that runs in their place.
    std::map<std::string, std::string> remaps;
    std::vector<std::string> other_remaps; // codes that more than a plain subprogram replaces
    std::vector<std::string> unread_files; // with HAL commands or a panel
    std::string locking_indexers; // letters of axes, or joints, that only turn on their own
    std::optional<gcode::LengthUnit> machine_unit; // [TRAJ] LINEAR_UNITS
    std::string parameters;                        // [RS274NGC] PARAMETER_FILE
    std::string tool_table;                        // [EMCIO] TOOL_TABLE
    std::vector<std::string> search_path; // [DISPLAY] PROGRAM_PREFIX, [RS274NGC] SUBROUTINE_PATH
    std::string startup_code;             // [RS274NGC] RS274NGC_STARTUP_CODE
    std::string wrapped_axes;             // letters of axes with WRAPPED_ROTARY = 1
    std::map<std::string, double> values; // all numbers, by their names in programs: _ini[traj]x
};

/// Errors: io if the file cannot be read; syntax, with its line, for units that are neither mm nor
///         inches, and for a tool change position of fewer than three numbers; unsupported for
///         #INCLUDE, and for kinematics that move linear axes while rotary ones turn.
core::Result<IniFile> read_ini(const std::string& path);

/// What the machine of an ini file does at a tool change.
gcode::ToolChangeMotion tool_change_motion(const IniFile& ini, gcode::LengthUnit machine_unit);

/// Adds the rotary axes of the kinematics in an ini file to a machine that has none.
///
/// Result: a note for the user if the machine has other ones; else empty.
std::string take_rotary_axes(core::Machine& machine, const gcode::Environment& environment);

/// Whether a machine puts the tool and the work as the kinematics of an environment do, which must
/// be known.
bool has_axes_of_kinematics(const core::Machine& machine, const gcode::Environment& environment);

/// take_rotary_axes, and adds limits, speeds, accelerations and homes from a LinuxCNC ini file to
/// axes of a machine that lack them: from [AXIS_X], or [AXIS_0] of older files, and [JOINT_0] of a
/// machine whose joints are its axes, in the order X Y Z A B C U V W.
///
/// `with_positions`: also take limits and homes, which are meaningless if the work offsets are
/// assumed.
///
/// Result: a note for the user; empty if nothing was taken.
std::string complete_machine(core::Machine& machine, const gcode::Environment& environment,
                             bool with_positions);

/// Whether the servo period of an ini file is longer than 1 ms: only up to this it is known how
/// LinuxCNC rounds corners.
bool has_slow_servo(const IniFile& ini);

/// Splits a list of folders at ':', or at ';' on Windows.
std::vector<std::string> split_search_path(const std::string& text);

} // namespace app
