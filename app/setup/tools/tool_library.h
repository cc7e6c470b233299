#pragma once

#include <map>
#include <string>

#include "app/setup/tools/found_tool.h"
#include "core/base/result.h"

namespace gcode {
enum class LengthUnit : uint8_t;
}

namespace app {

/// The tools in a library file, by number: FreeCAD's tool bits (.fctl with the bits next to it or
/// in ../Bit, .fctb) and its older tool tables (.json), Fusion 360's libraries (.json, .tools),
/// those of HSM (.hsmlib), and LinuxCNC's tool table (.tbl, whose comments may name the shapes).
///
/// Units:  `unit` is that of a tool table's lengths; the others state theirs.
/// Errors: with the file: io if it or a bit cannot be read; syntax if it is not such a library or
///         contains an invalid tool; a duplicate number.
core::Result<std::map<core::ToolNumber, FoundTool>> read_tool_library(const std::string& path,
                                                                      gcode::LengthUnit unit);

} // namespace app
