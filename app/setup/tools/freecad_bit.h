#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "app/setup/tools/found_tool.h"
#include "core/base/result.h"

namespace app {

/// "5.0000 mm", "1/4 in", "60 °" or a plain number; lengths in mm.
std::optional<double> freecad_quantity(const nlohmann::json& value);

/// A tool bit of FreeCAD: its `shape` and the sizes in `parameter`, as a .fctb holds them.
///
/// Errors: syntax, with the file, if it is no bit or has no diameter.
core::Result<FoundTool> tool_of_freecad_bit(const nlohmann::json& bit, int number,
                                            const std::filesystem::path& path);

} // namespace app
