#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "gcode/modal_state.h"

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

} // namespace app
