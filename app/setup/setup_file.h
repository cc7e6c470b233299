#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "app/setup/tools/found_tool.h"
#include "core/base/result.h"
#include "core/sim/setup.h"
#include "gcode/language/environment.h"

namespace app {

class TableReader;
struct ProgramSettings;

/// A set-up file that has been read.
struct SetupFile {
    std::string path; // as the user gave it
    core::Setup setup;
    gcode::Environment environment;
    std::optional<gcode::DialectId> dialect;  // empty: to be recognised
    std::set<int> offsets_set;                // indices of the work offsets in the file, 0 is G54
    std::set<core::OffsetNumber> lengths_set; // numbers of the length offsets in the file
    std::map<core::ToolNumber, FoundTool> library; // from tool_library, for tools without [[tool]]
    std::string tool_table;                        // path of the control's tool table
    bool needs_stock = false;                      // infer it from the program
    std::optional<double> stock_margin;            // added around an inferred stock, mm
    std::string stock_frame = "G54";               // frame of the stock's coordinates
    std::map<core::ToolNumber, std::string> inferred_tools; // with the reason, a sentence
    std::string inferred_stock;                             // reason; empty: stated
    bool speed_by_hand = false;                             // M3 starts the spindle without S
    bool allow_comments = false;          // (feeler: allow RULE) in the program has effect
    bool is_inferred = false;             // no file was read
    std::string not_judged;               // why motions are not checked; empty if they are
    std::vector<std::string> assumptions; // facts that the file does not state, and mesh repairs
};

/// Reads a set-up (TOML) and every file that it names; relative paths are relative to the file.
/// `over` replaces settings under [program].
/// Errors: with file, line and column: a missing file, invalid TOML, an unknown key, an invalid
///         value, an open mesh, an impossible tool.
core::Result<SetupFile> read_setup(const std::string& path, const ProgramSettings& over);

/// The name of the project file, which assigns set-ups to the programs of a folder.
constexpr const char* project_file_name = "feeler.toml";

/// The set-up next to a program, `plate.toml` for `plate.nc`; empty if there is none. A project
/// file is not a set-up. A folder or a broken link of that name is returned and fails when read.
std::string setup_next_to(const std::string& program);

/// The severities in a table `[rules]`, by rule. The key `but`, if any, is left to the caller. An
/// unknown rule is an error that suggests the nearest name.
core::RuleSeverities read_severities(TableReader& table, const std::string& but = {});

} // namespace app
