#pragma once

#include <filesystem>
#include <map>

#include <nlohmann/json.hpp>

#include "app/tools/found_tool.h"
#include "core/base/result.h"

namespace app {

using ToolMap = std::map<core::ToolNumber, FoundTool>;

/// The JSON in a file.
///
/// Errors: io and syntax, with the file.
core::Result<nlohmann::json> read_json(const std::filesystem::path& path);

/// A text or number of an object; what else stands there, or nothing, is empty or 0.
std::string text_at(const nlohmann::json& object, const char* key);
double number_at(const nlohmann::json& object, const char* key);

/// FreeCAD: a library, which names its bits, or a single bit, which becomes tool 1.
core::Result<ToolMap> tools_of_freecad_library(const nlohmann::json& library,
                                               const std::filesystem::path& path);
core::Result<ToolMap> tools_of_freecad_bit(const nlohmann::json& bit,
                                           const std::filesystem::path& path);

/// FreeCAD's older tables: tools by number, mm and degrees.
core::Result<ToolMap> tools_of_freecad_table(const nlohmann::json& table,
                                             const std::filesystem::path& path);

/// Fusion 360 and HSM. A tool's number is that of its post process.
core::Result<ToolMap> tools_of_fusion_library(const nlohmann::json& library,
                                              const std::filesystem::path& path);

/// Puts a tool in the map.
///
/// Errors: invalid_value when its number was there before or its diameter is none.
core::Result<void> add_tool(ToolMap& tools, const FoundTool& tool,
                            const std::filesystem::path& path);

} // namespace app
