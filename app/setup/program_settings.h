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

/// What a user says about the control that reads a program, on the command line or under [program]
/// of a set-up. Empty where nothing was said.
struct ProgramSettings {
    std::optional<gcode::DialectId> dialect;
    std::optional<bool> block_delete;
    core::AxisPosition start{}; // machine coordinates, mm and degrees
    std::optional<gcode::LengthUnit> machine_unit;
    std::optional<uint64_t> max_blocks;
    std::optional<bool> counts_smallest_steps; // X1000 is 1 mm on Fanuc and Haas
    std::string ini, parameters, tool_table;   // paths
    std::vector<std::string> search_path;
    std::set<int> machine_codes; // M codes of the machine's builder
    std::optional<core::ToolNumber> tool_at_start;
    std::optional<core::SpindleDirection> spindle_at_start;
    std::optional<bool> speed_by_hand; // the spindle turns though no S says how fast
};

/// Both together; what `over` says wins.
ProgramSettings overlaid(ProgramSettings settings, const ProgramSettings& over);

/// Puts settings and the files they name into an environment, and gives what a user should know of
/// them. Offsets and reference points of a variables file become those of the environment. What an
/// ini file says counts where the settings themselves say nothing.
///
/// Errors: of the files, with file and line.
core::Result<std::vector<std::string>> apply(const ProgramSettings& settings,
                                             gcode::Environment& environment);

/// The place in a text such as `X=10,Y=-5.5,A=90` or `X10 Y-5.5`: mm and degrees; axes that are not
/// named stay unknown. Empty when it is no such text.
std::optional<core::AxisPosition> position_in(const std::string& text);

/// Reads `[program]` of a set-up; relative paths start from `folder`.
ProgramSettings read_program_table(TableReader& table, const std::filesystem::path& folder);

/// The numbered parameters of a LinuxCNC variables file: a number and its value on each line.
///
/// Errors: io when it cannot be read; syntax, with its line, for one that says something else or a
///         number that no parameter has.
core::Result<std::map<int, double>> read_variables(const std::string& path);

} // namespace app
