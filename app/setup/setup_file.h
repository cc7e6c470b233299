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

/// A set-up file, read and put in its place.
struct SetupFile {
    std::string path; // as the user gave it
    core::Setup setup;
    gcode::Environment environment;
    std::optional<gcode::DialectId> dialect;  // empty: recognise it
    std::set<int> offsets_set;                // the work offsets that the file states, 0 is G54
    std::set<core::OffsetNumber> lengths_set; // the length offsets that it states
    std::map<core::ToolNumber, FoundTool> library; // of tool_library, for tools that are not here
    std::string tool_table;                        // of the control, which knows diameters too
    bool needs_stock = false;                      // it is to be inferred from the program
    std::optional<double> stock_margin;            // round what is inferred
    std::string stock_frame = "G54";               // that the stock's coordinates count in
    std::map<core::ToolNumber, std::string> inferred_tools; // by what, in a sentence
    std::string inferred_stock;                             // by what; empty: it is stated
    bool speed_by_hand = false;                             // M3 turns the spindle without an S
    bool allow_comments = false;          // (feeler: allow RULE) in the program counts
    bool is_inferred = false;             // no file: everything is
    std::string not_judged;               // why the motions of the program are not; empty: they are
    std::vector<std::string> assumptions; // what the file leaves open or what had to be repaired
};

/// Reads a set-up (TOML) and every file it names; relative paths are relative to the file. What
/// `over` says replaces what stands under [program].
///
/// Errors: with file, line and column: no file, no TOML, an unknown key, a wrong value, a mesh that
///         is no solid, a tool that cannot be.
core::Result<SetupFile> read_setup(const std::string& path, const ProgramSettings& over);
core::Result<SetupFile> read_setup(const std::string& path);

/// The name of the file that says what the programs of a folder are checked against.
constexpr const char* project_file_name = "feeler.toml";

/// The set-up that stands beside a program under its name, `plate.toml` for `plate.nc`; empty when
/// there is none. A project file is none. What has that name counts, also a link that leads nowhere
/// or a folder: whoever reads it then says so.
std::string setup_beside(const std::string& program);

/// The severities that a table `[rules]` gives to rules by name; the key `but`, if any, is left to
/// the caller. A name that is no rule is refused with the nearest that is one.
core::RuleSeverities read_severities(TableReader& table, const std::string& but = {});

} // namespace app
