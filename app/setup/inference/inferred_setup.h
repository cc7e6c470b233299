#pragma once

#include <map>
#include <memory>
#include <string>

#include "app/setup/tools/found_tool.h"
#include "core/base/ids.h"
#include "core/base/result.h"

namespace core {
struct Solid;
}
namespace gcode {
enum class LengthUnit : uint8_t;
struct Program;
} // namespace gcode

namespace app {

struct Coverage;
struct ProgramSettings;
struct SetupFile;

/// A set-up without any information about the machine: no fixtures, no axis limits, machine zero
/// high above program zero, all work offsets equal.
///
/// Errors: those of the files that the settings name.
core::Result<SetupFile> bare_setup(const ProgramSettings& settings);

/// A complete set-up from a program alone.
///
/// Errors: those of the files that the settings name; unsupported for a dialect that cannot be
///         read.
core::Result<SetupFile> infer_setup(const gcode::Program& program, const ProgramSettings& settings);

/// Adds what a set-up does not state and the program implies: tools from its comments and from the
/// set-up's library, the stock from the program or its cutting moves; if the set-up is partial,
/// also unknown tools, and a spindle switched on by hand. Stated values stay. Every guess becomes
/// an assumption. So a set-up that states little is completed as one that states nothing.
///
/// Errors: a tool table that cannot be read.
core::Result<void> complete_setup(SetupFile& file, const gcode::Program& program);

/// The set-up in a text, completed as a partial one, whatever it states.
///
/// `path`: of its file. Errors: those of the text and of the files that it names.
core::Result<SetupFile> completed_setup(const std::string& text, const std::string& path,
                                        const gcode::Program& program,
                                        const ProgramSettings& settings);

/// Whether the stock of a complete set-up is the one that the program states.
bool is_stock_of_program(const SetupFile& file);

/// Whether a stock is the one that `feeler setup` writes for programs that are not known to cut.
bool stands_for_no_stock(const core::Solid& stock);

/// What is known of a complete set-up, without holders and motion, which only a run shows.
std::shared_ptr<const Coverage> coverage_of(const SetupFile& file);

/// Tools that the set-up lacks, from its library, the program's comments and the control's tool
/// table, in this order of precedence.
struct SuggestedTools {
    std::map<core::ToolNumber, FoundTool> tools;
    std::optional<FoundTool> in_spindle; // for a program without tool calls
};

/// Errors: those of the tool table's file.
core::Result<SuggestedTools> suggested_tools(const SetupFile& file, const gcode::Program& program);

/// A tool of which only the use is known. `mills`: it cuts sideways; empty: it cuts nothing.
FoundTool unknown_tool(core::ToolNumber number, std::optional<bool> mills, gcode::LengthUnit unit);

/// Adds a tool to the set-up, completed with usual sizes. In a bare set-up the tool counts as
/// touched off with `control_length`.
///
/// Result: the assumptions.
std::string put_tool(SetupFile& file, const FoundTool& found, double least_flutes,
                     double control_length);

} // namespace app
