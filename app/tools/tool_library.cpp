#include "app/tools/tool_library.h"

#include <fmt/format.h>

#include "app/setup/text_lines.h"
#include "app/setup/tool_file.h"
#include "app/tools/json_tools.h"
#include "app/tools/tool_text.h"
#include "core/base/file_reads.h"

namespace app {
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
    return tl::unexpected(core::Error{ErrorCode::syntax,
                                      {},
                                      "is no tool library of FreeCAD or Fusion 360 (tools, data, "
                                      "Tools or parameter is missing)",
                                      path.string()});
}

/// What stands behind the semicolon in each line of a tool table, by the number in its T word.
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
        if (offset.diameter <= 0.0) continue; // a touch probe, or nothing known
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

core::Result<nlohmann::json> read_json(const std::filesystem::path& path) {
    if (std::string why = core::why_no_file(path); !why.empty())
        return tl::unexpected(core::Error{ErrorCode::io, {}, std::move(why), path.string()});
    const std::optional<std::string> bytes = core::file_bytes(path);
    if (!bytes)
        return tl::unexpected(core::Error{ErrorCode::io, {}, "cannot be read", path.string()});
    nlohmann::json json = nlohmann::json::parse(*bytes, nullptr, false);
    if (json.is_discarded())
        return tl::unexpected(core::Error{ErrorCode::syntax, {}, "is no JSON", path.string()});
    return json;
}

std::string text_at(const nlohmann::json& object, const char* key) {
    if (!object.is_object()) return {};
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

double number_at(const nlohmann::json& object, const char* key) {
    if (!object.is_object()) return 0.0;
    const auto found = object.find(key);
    return found != object.end() && found->is_number() ? found->get<double>() : 0.0;
}

core::Result<void> add_tool(ToolMap& tools, const FoundTool& tool,
                            const std::filesystem::path& path) {
    const int number = core::value_of(tool.tool.number);
    const auto refuse = [&](const std::string& why) {
        return tl::unexpected(core::Error{
            ErrorCode::invalid_value, {}, fmt::format("tool {} {}", number, why), path.string()});
    };
    if (!(tool.tool.diameter > 0.0)) return refuse("has no diameter");
    if (!tools.emplace(tool.tool.number, tool).second) return refuse("is there twice");
    return {};
}

core::Result<std::map<ToolNumber, FoundTool>> read_tool_library(const std::string& path,
                                                                gcode::LengthUnit unit) {
    const std::string extension = std::filesystem::path(path).extension().string();
    if (extension == ".json" || extension == ".fctl" || extension == ".fctb")
        return tools_of_json(path);
    if (extension == ".tbl") return tools_of_table(path, unit);
    return tl::unexpected(core::Error{ErrorCode::unsupported,
                                      {},
                                      "is no tool library by its name: .fctl, .fctb, .json and "
                                      ".tbl are known",
                                      path});
}

} // namespace app
