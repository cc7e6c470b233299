#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/motion/event.h"

namespace gcode {
enum class DialectId : uint8_t;
enum class LengthUnit : uint8_t;
struct Environment;
} // namespace gcode

namespace app {

class TableReader;

/// What the user states about the control, on the command line or in [program] of a set-up. Empty
/// values are not stated.
struct ProgramSettings {
    std::optional<gcode::DialectId> dialect;
    std::optional<bool> block_delete;
    core::AxisPosition start{}; // machine coordinates, mm and degrees
    std::optional<gcode::LengthUnit> machine_unit;
    std::optional<gcode::LengthUnit> units_at_start; // of the program, until it states one
    std::optional<uint64_t> max_blocks;
    std::optional<bool> counts_smallest_steps; // Fanuc, Haas: X1000 is 1 mm
    std::string ini, parameters, tool_table;   // paths
    bool ignores_tables = false;               // those that the ini file names: variables and tools
    std::vector<std::string> search_path;
    std::set<int> machine_codes; // M codes of the machine builder
    std::optional<core::ToolNumber> tool_at_start;
    std::optional<core::SpindleDirection> spindle_at_start;
    std::map<int, double> values; // of variables that only the machine knows, by number
    std::map<std::string, std::optional<double>, std::less<>> named_values; // as in ControlSettings
    std::optional<bool> measured_offsets_are_stated; // what probing sets is in the set-up
    std::optional<bool> speed_by_hand; // the spindle turns although the program has no S
};

/// Merges settings; those of `over` take precedence.
ProgramSettings overlaid(ProgramSettings settings, const ProgramSettings& over);

/// Settings together with what their ini file adds.
struct AppliedSettings {
    ProgramSettings settings;
    std::vector<std::string> notes; // for the user
};

/// Applies settings and the files they name to an environment. Offsets and reference points of a
/// variables file become those of the environment. An ini file supplies only what the settings do
/// not state; without a dialect, the program is one for LinuxCNC.
///
/// Errors: those of the files, with file and line.
core::Result<AppliedSettings> apply(const ProgramSettings& settings,
                                    gcode::Environment& environment);

/// Executes the start-up code of the environment once, for its errors.
core::Result<void> check_startup_code(const gcode::Environment& environment);

/// A position such as `X=10,Y=-5.5,A=90` or `X10 Y-5.5`, in mm and degrees; axes that are not named
/// stay unknown. Empty if the text has another form.
std::optional<core::AxisPosition> position_in(const std::string& text);

/// Reads the key `dialect` of a table.
std::optional<gcode::DialectId> read_dialect(TableReader& table);

/// Reads `[program]` of a set-up; relative paths refer to `folder`.
ProgramSettings read_program_table(TableReader& table, const std::filesystem::path& folder);

/// The numbered parameters of a LinuxCNC variables file: a number and its value on each line.
///
/// Errors: io if the file cannot be read; syntax, with its line, for any other text or an invalid
///         parameter number.
core::Result<std::map<int, double>> read_variables(const std::string& path);

} // namespace app
