#pragma once

#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/setup/tools/found_tool.h"
#include "core/base/result.h"
#include "core/sim/setup.h"
#include "gcode/language/environment.h"

namespace core {
struct CadNames;
}

namespace gcode {
struct ControlPreset;
}

namespace app {

class TableReader;
enum class Known : uint8_t;
struct ProgramSettings;

/// What a set-up or machine file states about the control.
struct StatedControl {
    const gcode::ControlPreset* preset = nullptr;
    std::map<std::string, double> parameters; // by the maker's number, such as "5006#6"
    // gcode::SettingValue by the name of the setting, such as "1240"
    std::map<std::string, std::variant<bool, double, gcode::Position, std::string>> settings;
};

/// Puts the stated parameters of a control into the environment, whose dialect is known, and into
/// the machine. Returns notes about parameters that this control does not have.
///
/// Errors: those of the start-up code.
core::Result<std::vector<std::string>>
apply(const StatedControl& control, gcode::Environment& environment, core::Machine& machine);

/// A `[[tool]]` without a shape, or with a size that is "unknown": it states only some values of a
/// tool, and the rest is inferred.
struct PartialTool {
    core::ToolDescription tool;   // values of the stated keys
    std::set<std::string> stated; // keys, without those that are "unknown"
    core::SourceSpan where;       // in the set-up file
};

/// The bodies of a document from which a set-up is made: what their tables state.
struct ImportedBodies {
    std::string document;    // its path
    std::string stock, part; // names of bodies in it; or empty
};

/// The end of an assumption about an offset that the set-up states otherwise than the control.
inline constexpr std::string_view differs_from_variables =
    " is taken from [offsets]; the variables file has another value";

/// A set-up file that has been read.
struct SetupFile {
    std::string path; // as the user gave it
    // In which the file states lengths, or would if it was inferred: that of the program.
    gcode::LengthUnit length_unit = gcode::LengthUnit::mm;
    core::Setup setup;
    gcode::Environment environment;
    std::optional<gcode::DialectId> dialect; // empty: to be recognised
    StatedControl control;
    std::set<int> offsets_set;                // indices of the work offsets in the file, 0 is G54
    std::set<size_t> offsets_used;            // work offsets in which the program moves
    std::set<size_t> offsets_of_bodies;       // in which bodies stand, and whose place is assumed
    bool names_offset_of_bodies = false;      // not only by default
    std::set<core::ToolNumber> tools_used;    // that the program calls or has in the spindle
    std::set<core::ToolNumber> guessed_tools; // of which a size that matters is a guess
    std::set<core::OffsetNumber> lengths_set; // numbers of the length offsets in the file
    std::map<core::ToolNumber, FoundTool> library; // from tool_library, for tools without [[tool]]
    std::map<core::ToolNumber, PartialTool> partial_tools;
    std::string tool_table;                        // path of the control's tool table
    bool needs_stock = false;                      // infer it from the program
    std::optional<double> stock_margin;            // added around an inferred stock, mm
    std::string stock_frame = "G54";               // frame of the stock's coordinates
    std::map<std::string, core::Transform> frames; // poses of the named frames in the machine
    std::map<core::ToolNumber, std::string> inferred_tools; // with the reason, a sentence
    std::map<core::ToolNumber, FoundTool> found_tools;      // likewise, what their sources state
    std::vector<std::string> import_notes;                  // about the file of --from
    ImportedBodies imported_bodies;
    std::string inferred_stock;   // reason; empty: stated
    std::string stock_comment;    // the same with lengths in the unit of the file
    bool speed_by_hand = false;   // M3 starts the spindle without S
    bool allow_comments = false;  // (feeler: allow RULE) in the program has effect
    bool is_inferred = false;     // no file was read
    bool has_axes = false;        // it states all of the machine's axes
    bool uses_other_axes = false; // the program moves axes that no machine describes
    bool infers_frame = false;    // no work offset is stated
    // It does not describe a job yet, for which it would have to state work offsets, tools, and a
    // stock or a fixture. What it leaves open is inferred as if it stated nothing.
    bool is_partial = false;
    bool mesh_is_stated = false; // the mesh size
    bool touches_off = false;    // assumed: Z is touched off with each tool
    bool loses_machine = false; // machine bodies are left out: nobody knows where the work is on it
    Known stock_known{}, fixtures_known{}, offsets_known{}, limits_known{}; // missing
    bool limits_need_offsets = false; // the limits were dropped because no work offset is stated
    std::string stock_mismatch;       // how the program's own stock differs; empty: it does not
    bool infers_start = false;        // the start position, with the work offsets
    bool infers_home = false, infers_second_home = false; // likewise the reference points
    std::set<std::string> assumed; // words of `assumed`: what the file states without knowing it
    std::string start_assumption;  // of a start position that nothing states; or empty
    std::string not_judged;        // why motions are not checked; empty if they are
    std::vector<std::string> assumptions; // facts that the file does not state, and mesh repairs
    std::shared_ptr<core::CadNames> cad_names; // of the solids in CAD files; or null
};

/// Reads a set-up (TOML) and every file that it names; relative paths are relative to the file.
/// `over` replaces settings under [program].
/// Errors: with file, line and column: a missing file, invalid TOML, an unknown key, an invalid
///         value, an open mesh, an impossible tool.
core::Result<SetupFile> read_setup(const std::string& path, const ProgramSettings& over);

/// Reads a set-up from its text, as if it were in a file.
///
/// Errors: as read_setup.
core::Result<SetupFile> read_setup_text(const std::string& text, const std::string& path,
                                        const ProgramSettings& over);

/// Assumes a place of the work in the machine: all work offsets are equal and far below the highest
/// position of the machine, where it starts and has its home unless stated otherwise. Axis limits
/// are dropped, because they would be compared with a guess. Returns the assumption as a clause.
std::string assume_machine_zero(SetupFile& file);

/// Pose of a work offset in the machine. The frame is aligned with the machine axes, or turned by
/// `rotation_deg` about Z, when the rotary axes are at their offsets.
core::Transform machine_from_offset(const core::Machine& machine, const core::AxisValues& origin,
                                    double rotation_deg = 0.0);

/// What a set-up can state and call assumed at the same time: words of the key `assumed`.
inline constexpr std::array<std::string_view, 3> assumed_words = {"stock", "offsets", "start"};

/// The name of the project file, which assigns set-ups to the programs of a folder.
constexpr const char* project_file_name = "feeler.toml";

/// The set-up next to a program, `plate.toml` for `plate.nc`; empty if there is none. A project
/// file is not a set-up. A folder or a broken link of that name is returned and fails when read.
std::string setup_next_to(const std::string& program);

/// The rule that reports the lack of what a word of `require` names.
std::string required_rule(std::string_view word);

/// The severities in a table `[rules]`, by rule. The key `but`, if any, is left to the caller. An
/// unknown rule is an error that suggests the nearest name.
core::RuleSeverities read_severities(TableReader& table, const std::string& but = {});

} // namespace app
