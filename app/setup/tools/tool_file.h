#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/base/ids.h"
#include "core/base/result.h"

namespace gcode {
enum class LengthUnit : uint8_t;
struct LengthOffset;
} // namespace gcode

namespace app {

/// The offsets in a LinuxCNC tool table, by tool number: `T3 P3 Z53.0 D5.0 ;comment` on each line.
///
/// Units:  `unit` is that of the file's lengths.
/// Errors: io if the file cannot be read; syntax, with its line, for any other text, a missing T
///         word or a duplicate number.
core::Result<std::map<core::OffsetNumber, gcode::LengthOffset>>
read_tool_file(const std::string& path, gcode::LengthUnit unit);

} // namespace app
