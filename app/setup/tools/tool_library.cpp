#include "app/setup/tools/tool_library.h"

#include <cctype>
#include <charconv>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/setup/tools/found_tool.h"
#include "app/setup/tools/freecad_bit.h"
#include "app/setup/tools/fusion_library.h"
#include "app/setup/tools/json_file.h"
#include "app/setup/tools/tool_file.h"
#include "app/setup/tools/tool_text.h"
#include "core/base/file_reads.h"
#include "core/base/result.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "gcode/language/tables.h"

namespace app {

using ToolMap = std::map<core::ToolNumber, FoundTool>;

/// FreeCAD: a library that names its bits, or a single bit, which becomes tool 1.
core::Result<ToolMap> tools_of_freecad_library(const nlohmann::json& library,
                                               const std::filesystem::path& path);
core::Result<ToolMap> tools_of_freecad_bit(const nlohmann::json& bit,
                                           const std::filesystem::path& path);

/// FreeCAD's older tables: tools by number, mm and degrees.
core::Result<ToolMap> tools_of_freecad_table(const nlohmann::json& table,
                                             const std::filesystem::path& path);

/// Adds a tool to the map.
///
/// Errors: invalid_value if its number is taken or its diameter is not above 0.
core::Result<void> add_tool(ToolMap& tools, const FoundTool& tool,
                            const std::filesystem::path& path);

namespace {

using core::ErrorCode;
using core::ToolNumber;

bool has_numbers_as_keys(const nlohmann::json& json) {
    if (!json.is_object() || json.empty()) return false;
    for (const auto& [key, value] : json.items())
        if (!number_in(key) || !value.is_object()) return false;
    return true;
}

core::Result<ToolMap> tools_of_json(const std::filesystem::path& path) {
    FEELER_TRY(const nlohmann::json json, read_json(path));
    if (json.is_object() && json.contains("tools") && json["tools"].is_array())
        return tools_of_freecad_library(json, path);
    if (json.is_object() && json.contains("parameter") && json.contains("shape"))
        return tools_of_freecad_bit(json, path);
    if (json.is_object() && json.contains("data") && json["data"].is_array())
        return tools_of_fusion_library(json, path);
    if (json.is_object() && json.contains("Tools"))
        return tools_of_freecad_table(json["Tools"], path);
    if (json.is_array() && !json.empty() && json[0].is_object() && json[0].contains("Tools"))
        return tools_of_freecad_table(json[0]["Tools"], path);
    if (has_numbers_as_keys(json)) return tools_of_freecad_table(json, path);
    return tl::unexpected(
        core::Error{ErrorCode::syntax,
                    {},
                    "is not a tool library of FreeCAD or Fusion 360 (tools, data, "
                    "Tools or parameter is missing)",
                    path.generic_string()});
}

/// The comment after the semicolon in each line of a tool table, by tool number.
std::map<int, std::string> names_in_table(const std::vector<std::string>& lines) {
    std::map<int, std::string> names;
    for (const std::string& line : lines) {
        const size_t semicolon = line.find(';');
        if (semicolon == std::string::npos) continue;
        for (const std::string& word : words_of_line(line.substr(0, semicolon)))
            if (word[0] == 'T' || word[0] == 't')
                if (const auto number = number_in(std::string_view(word).substr(1)))
                    names[static_cast<int>(*number)] = line.substr(semicolon + 1);
    }
    return names;
}

core::Result<ToolMap> tools_of_table(const std::string& path, gcode::LengthUnit unit) {
    FEELER_TRY(const auto offsets, read_tool_file(path, unit));
    FEELER_TRY(const std::vector<std::string> lines, lines_of_file(path));
    std::map<int, std::string> names = names_in_table(lines);
    ToolMap tools;
    for (const auto& [number, offset] : offsets) {
        if (offset.diameter <= 0.0) continue; // a touch probe, or an empty entry
        ToolText text = read_tool_text(names[core::value_of(number)], unit);
        FoundTool found;
        found.has_shape = text.shape.has_value();
        found.source = path;
        if (!text.shape) text.shape = core::ToolShape::flat;
        text.diameter = offset.diameter;
        const auto tool = tool_of_text(text);
        if (!tool) continue;
        found.tool = *tool;
        found.tool.number = ToolNumber{core::value_of(number)};
        if (offset.length > 0.0) found.tool.gauge_length = offset.length;
        tools.emplace(found.tool.number, found);
    }
    return tools;
}

} // namespace

core::Result<void> add_tool(ToolMap& tools, const FoundTool& tool,
                            const std::filesystem::path& path) {
    const int number = core::value_of(tool.tool.number);
    const auto refuse = [&](const std::string& why) {
        return tl::unexpected(core::Error{ErrorCode::invalid_value,
                                          {},
                                          fmt::format("tool {} {}", number, why),
                                          path.generic_string()});
    };
    if (!(tool.tool.diameter > 0.0)) return refuse("has no diameter");
    if (!tools.emplace(tool.tool.number, tool).second) return refuse("is defined twice");
    return {};
}

core::Result<std::map<ToolNumber, FoundTool>> read_tool_library(const std::string& path,
                                                                gcode::LengthUnit unit) {
    const std::string extension =
        core::lower_case(std::filesystem::path(path).extension().generic_string());
    if (extension == ".json" || extension == ".fctl" || extension == ".fctb")
        return tools_of_json(path);
    if (extension == ".tools") return tools_of_fusion_archive(path);
    if (extension == ".hsmlib") return tools_of_hsm_library(path);
    if (extension == ".tbl") return tools_of_table(path, unit);
    return tl::unexpected(core::Error{ErrorCode::unsupported,
                                      {},
                                      "is not a tool library: known types are .fctl, .fctb, "
                                      ".json, .tools, .hsmlib and .tbl",
                                      path});
}

namespace {

using core::ToolDescription;
using core::ToolShape;
using nlohmann::json;

core::Error error(const std::filesystem::path& path, const std::string& why) {
    return {ErrorCode::syntax, {}, why, path.generic_string()};
}

/// Finds a bit of a library: next to it, in ../Bit, or at the given path.
std::optional<std::filesystem::path> find_bit(const std::filesystem::path& library,
                                              const std::string& name) {
    const std::filesystem::path folder = library.parent_path();
    for (const std::filesystem::path& candidate :
         {folder / name, folder.parent_path() / "Bit" / name, folder / "Bit" / name,
          folder / std::filesystem::path(name).filename(),
          folder.parent_path() / "Bit" / std::filesystem::path(name).filename()})
        if (core::is_file(candidate)) return candidate;
    return std::nullopt;
}

FoundTool freecad_tool(const json& entry, int number, const std::filesystem::path& path) {
    const auto size = [&](const char* key) {
        return freecad_length(member_at(entry, key)).value_or(0.0);
    };
    const std::string type = text_at(entry, "tooltype");
    FoundTool found;
    found.source = path.generic_string();
    ToolDescription& tool = found.tool;
    tool.number = core::ToolNumber{number};
    tool.name = text_at(entry, "name");
    tool.diameter = size("diameter");
    const auto shape = shape_of_words(plain_capitals(type == "Undefined" ? tool.name : type));
    found.has_shape = shape.has_value();
    tool.shape = shape.value_or(ToolShape::flat);
    if (type == "CornerRound" || type == "Engraver") tool.shape = ToolShape::chamfer;
    if (tool.shape == ToolShape::tslot && type.starts_with("Slot")) tool.shape = ToolShape::flat;
    const double corner = size("cornerRadius");
    const double angle = freecad_angle(member_at(entry, "cuttingEdgeAngle")).value_or(0.0);
    const bool flat = tool.shape == ToolShape::flat || tool.shape == ToolShape::bull;
    if (flat && corner > 0.0 && 2.0 * corner <= tool.diameter) {
        tool.shape = ToolShape::bull;
        tool.corner_radius = corner;
    }
    if (angle > 0.0 && angle < 180.0) {
        if (has_size(tool.shape, &ToolDescription::point_deg)) tool.point_deg = angle;
        if (tool.shape == ToolShape::chamfer) tool.angle_deg = 0.5 * angle;
    }
    if (tool.shape == ToolShape::chamfer) tool.tip_diameter = 2.0 * size("flatRadius");
    tool.flute_length = size("cuttingEdgeHeight");
    if (tool.flute_length < 0.5 * tool.diameter) tool.flute_length = 0.0; // often left at a default
    if (const double length = size("lengthOffset"); length > 0.0) tool.gauge_length = length;
    return found;
}

} // namespace

core::Result<ToolMap> tools_of_freecad_library(const json& library,
                                               const std::filesystem::path& path) {
    ToolMap tools;
    for (const json& entry : library["tools"]) {
        const bool named = entry.is_object() && entry.contains("nr")
                           && entry["nr"].is_number_integer() && entry.contains("path")
                           && entry["path"].is_string();
        if (!named) return tl::unexpected(error(path, "each entry of tools needs nr and path"));
        const std::string name = entry["path"];
        const auto bit_path = find_bit(path, name);
        if (!bit_path)
            return tl::unexpected(error(path, fmt::format("there is no bit {} next to it or in "
                                                          "../Bit",
                                                          name)));
        FEELER_TRY(const json bit, read_json(*bit_path));
        FEELER_TRY(const FoundTool tool,
                   tool_of_freecad_bit(bit, entry["nr"].get<int>(), *bit_path));
        if (auto wrong = add_tool(tools, tool, path); !wrong) return tl::unexpected(wrong.error());
    }
    return tools;
}

core::Result<ToolMap> tools_of_freecad_bit(const json& bit, const std::filesystem::path& path) {
    ToolMap tools;
    FEELER_TRY(const FoundTool tool, tool_of_freecad_bit(bit, 1, path));
    if (auto wrong = add_tool(tools, tool, path); !wrong) return tl::unexpected(wrong.error());
    return tools;
}

core::Result<ToolMap> tools_of_freecad_table(const json& table, const std::filesystem::path& path) {
    ToolMap tools;
    if (!table.is_object()) return tl::unexpected(error(path, "Tools must map numbers to tools"));
    for (const auto& [key, entry] : table.items()) {
        const auto number = number_in(key);
        if (!number || !entry.is_object())
            return tl::unexpected(error(path, fmt::format("'{}' is not a tool number", key)));
        const FoundTool tool = freecad_tool(entry, static_cast<int>(*number), path);
        if (auto wrong = add_tool(tools, tool, path); !wrong) return tl::unexpected(wrong.error());
    }
    return tools;
}

} // namespace app
