#pragma once

#include <map>
#include <string>

#include "app/setup/tools/found_tool.h"
#include "core/base/result.h"

namespace gcode {
enum class LengthUnit : uint8_t;
}

namespace app {

/// The tools in a library file, by their numbers: FreeCAD's tool bits (.fctl with the bits beside
/// it or in ../Bit, .fctb) and its older tool tables (.json), Fusion 360's libraries (.json), and
/// LinuxCNC's tool table (.tbl, whose comments may name the shapes).
///
/// Units:  `unit` is that of a tool table's lengths; the others say theirs.
/// Errors: with the file: io when it or a bit cannot be read; syntax when it is no such library or
///         a tool in it makes no sense; a number that is there twice.
core::Result<std::map<core::ToolNumber, FoundTool>> read_tool_library(const std::string& path,
                                                                      gcode::LengthUnit unit);

} // namespace app
