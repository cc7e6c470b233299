#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "app/setup/tools/found_tool.h"
#include "core/base/result.h"

namespace app {

/// A length in mm: "5.0000 mm", "1/4 in" or a plain number; empty for anything else.
std::optional<double> freecad_length(const nlohmann::json& value);

/// An angle in degrees: "60 °", "60 deg" or a plain number; empty for anything else.
std::optional<double> freecad_angle(const nlohmann::json& value);

/// A tool bit of FreeCAD: its `shape` and the sizes in `parameter`, as a .fctb holds them.
///
/// Errors: syntax, with the file, if it is no bit or has no diameter.
core::Result<FoundTool> tool_of_freecad_bit(const nlohmann::json& bit, int number,
                                            const std::filesystem::path& path);

} // namespace app
