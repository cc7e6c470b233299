#pragma once

#include <map>

#include "app/setup/tools/found_tool.h"
#include "core/base/ids.h"
#include "core/base/result.h"

namespace gcode {
enum class LengthUnit : uint8_t;
struct Program;
} // namespace gcode

namespace app {

struct ProgramSettings;
struct SetupFile;

/// A set-up for a program about which nothing else is known: no fixtures, a machine without limits,
/// its zero high above the program's, all work offsets at one place.
///
/// Errors: of the files that the settings name.
core::Result<SetupFile> bare_setup(const ProgramSettings& settings);

/// A whole set-up from a program alone.
///
/// Errors: of the files that the settings name; unsupported for a dialect that cannot be read.
core::Result<SetupFile> infer_setup(const gcode::Program& program, const ProgramSettings& settings);

/// Adds what a set-up leaves open and the program tells: tools from its comments and from the
/// set-up's library, the stock from the cutting moves; of a bare set-up also tools of which nothing
/// is known, and a spindle that is switched on by hand. What is there stays. Every guess becomes an
/// assumption.
///
/// Errors: invalid_value when there is no stock and the program cuts nothing that it could be
///         inferred from; a tool table that cannot be read.
core::Result<void> complete_setup(SetupFile& file, const gcode::Program& program);

/// Tools that the set-up lacks, by what its library, the program's comments and the control's table
/// say, in this order.
struct OfferedTools {
    std::map<core::ToolNumber, FoundTool> tools;
    std::optional<FoundTool> in_spindle; // of a program that calls no tool
};

/// Errors: of the tool table's file.
core::Result<OfferedTools> offered_tools(const SetupFile& file, const gcode::Program& program);

/// A tool of which only the use is known.
FoundTool unknown_tool(core::ToolNumber number, bool mills, gcode::LengthUnit unit);

/// Puts a tool in its place, completed by what such tools usually have. In a bare set-up the
/// control's length is its length.
///
/// Result: what is assumed.
std::string put_tool(SetupFile& file, const FoundTool& found, double least_flutes,
                     double control_length);

} // namespace app
