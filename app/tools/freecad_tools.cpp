#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "app/setup/text_lines.h"
#include "app/tools/json_tools.h"
#include "app/tools/tool_text.h"
#include "app/tools/tool_words.h"
#include "core/base/file_reads.h"

namespace app {
namespace {

using core::ErrorCode;
using core::ToolDescription;
using core::ToolShape;
using nlohmann::json;

core::Error error(const std::filesystem::path& path, const std::string& why) {
    return {ErrorCode::syntax, {}, why, path.string()};
}

/// "5.0000 mm", "1/4 in", "60 °" or a plain number; lengths in mm.
std::optional<double> quantity(const json& value) {
    if (value.is_number()) return value.get<double>();
    if (!value.is_string()) return std::nullopt;
    const std::vector<TextNumber> numbers = numbers_of(plain_capitals(value.get<std::string>()));
    if (numbers.size() != 1) return std::nullopt;
    const TextNumber& number = numbers[0];
    const bool inch = number.suffix == "IN" || number.suffix == "\"";
    if (number.suffix == "M") return 1000.0 * number.value;
    return number.value * (inch ? 25.4 : 1.0);
}

/// A parameter by any of its names; they changed over the versions.
std::optional<double> parameter(const json& parameters, std::initializer_list<const char*> names) {
    if (!parameters.is_object()) return std::nullopt;
    for (const char* name : names)
        if (const auto found = parameters.find(name); found != parameters.end())
            return quantity(*found);
    return std::nullopt;
}

std::optional<ToolShape> shape_of_bit(std::string shape) {
    shape = shape.substr(0, shape.find(".fcstd"));
    std::string letters;
    for (const char c : shape.substr(shape.find_last_of('/') + 1))
        if (std::isalpha(static_cast<unsigned char>(c)) != 0)
            letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    static const std::map<std::string, ToolShape> shapes = {{"endmill", ToolShape::flat},
                                                            {"ballend", ToolShape::ball},
                                                            {"ballnose", ToolShape::ball},
                                                            {"bullnose", ToolShape::bull},
                                                            {"torus", ToolShape::bull},
                                                            {"chamfer", ToolShape::chamfer},
                                                            {"vbit", ToolShape::chamfer},
                                                            {"drill", ToolShape::drill},
                                                            {"dovetail", ToolShape::dovetail},
                                                            {"slittingsaw", ToolShape::tslot},
                                                            {"threadmill", ToolShape::threadmill},
                                                            {"reamer", ToolShape::flat},
                                                            {"tap", ToolShape::flat},
                                                            {"taperedballnose", ToolShape::taper}};
    const auto found = shapes.find(letters);
    if (found == shapes.end()) return std::nullopt;
    return found->second;
}

void read_angles(const json& parameters, ToolDescription& tool) {
    const auto cutting =
        parameter(parameters, {"CuttingEdgeAngle", "cuttingAngle", "CuttingAngle"});
    const auto tip = parameter(parameters, {"TipAngle"});
    if (tool.shape == ToolShape::drill) tool.point_deg = tip;
    if (tool.shape == ToolShape::chamfer && cutting) tool.angle_deg = 0.5 * *cutting;
    if (tool.shape == ToolShape::dovetail && cutting) tool.angle_deg = 90.0 - *cutting;
    if (tool.shape == ToolShape::taper) tool.angle_deg = parameter(parameters, {"TaperAngle"});
}

/// A slitting saw is a T-slot cutter with a thin head.
void read_lengths(const json& parameters, ToolDescription& tool) {
    tool.flute_length =
        parameter(parameters, {"CuttingEdgeHeight", "BladeThickness", "CuttingEdge"}).value_or(0.0);
    tool.shank_diameter = parameter(parameters, {"ShankDiameter", "ShaftDiameter"});
    const auto length = parameter(parameters, {"Length", "OverallLength"});
    if (length && *length > tool.flute_length) tool.stick_out = length;
    const bool necked = tool.shape == ToolShape::dovetail || tool.shape == ToolShape::threadmill;
    if (necked) tool.neck_diameter = parameter(parameters, {"NeckDiameter"});
    if (necked && tool.neck_diameter)
        tool.neck_length = parameter(parameters, {"NeckHeight", "NeckLength"});
    if (tool.shape == ToolShape::threadmill) tool.flute_length = 0.0; // "Crest" is a tooth
}

core::Result<FoundTool> tool_of_bit(const json& bit, int number,
                                    const std::filesystem::path& path) {
    FoundTool found;
    found.source = path.string();
    found.tool.number = core::ToolNumber{number};
    found.tool.name = text_at(bit, "name");
    const std::string shape = text_at(bit, "shape");
    const auto known = shape_of_bit(shape);
    found.has_shape = known.has_value();
    found.tool.shape = known.value_or(ToolShape::flat);
    if (!bit.is_object()) return tl::unexpected(error(path, "is no tool bit"));
    const json& parameters = bit.contains("parameter") ? bit["parameter"] : bit;
    const auto diameter = parameter(parameters, {"Diameter"});
    if (!diameter) return tl::unexpected(error(path, "the bit has no Diameter"));
    found.tool.diameter = *diameter;
    read_angles(parameters, found.tool);
    read_lengths(parameters, found.tool);
    if (found.tool.shape == ToolShape::chamfer)
        found.tool.tip_diameter = parameter(parameters, {"TipDiameter"}).value_or(0.0);
    if (found.tool.shape == ToolShape::bull) {
        const auto flat = parameter(parameters, {"FlatRadius"});
        found.tool.corner_radius = parameter(parameters, {"CornerRadius", "TorusRadius"});
        if (!found.tool.corner_radius && flat) found.tool.corner_radius = 0.5 * *diameter - *flat;
    }
    if (found.tool.shape == ToolShape::taper) // its Diameter is that of the ball at the tip
        found.tool.corner_radius = 0.5 * *diameter,
        found.tool.diameter = parameter(parameters, {"TaperDiameter"}).value_or(2.0 * *diameter);
    return found;
}

/// The bits of a library lie beside it, in ../Bit, or where its path says.
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
        const auto found = entry.find(key);
        return found == entry.end() ? 0.0 : quantity(*found).value_or(0.0);
    };
    const std::string type = text_at(entry, "tooltype");
    FoundTool found;
    found.source = path.string();
    ToolDescription& tool = found.tool;
    tool.number = core::ToolNumber{number};
    tool.name = text_at(entry, "name");
    tool.diameter = size("diameter");
    const auto shape = shape_of_words(plain_capitals(type == "Undefined" ? tool.name : type));
    found.has_shape = shape.has_value();
    tool.shape = shape.value_or(ToolShape::flat);
    if (type == "CornerRound" || type == "Engraver") tool.shape = ToolShape::chamfer;
    if (tool.shape == ToolShape::tslot && type.starts_with("Slot")) tool.shape = ToolShape::flat;
    const double corner = size("cornerRadius"), angle = size("cuttingEdgeAngle");
    const bool flat = tool.shape == ToolShape::flat || tool.shape == ToolShape::bull;
    if (flat && corner > 0.0 && 2.0 * corner <= tool.diameter) {
        tool.shape = ToolShape::bull;
        tool.corner_radius = corner;
    }
    if (angle > 0.0 && angle < 180.0) {
        if (tool.shape == ToolShape::drill) tool.point_deg = angle;
        if (tool.shape == ToolShape::chamfer) tool.angle_deg = 0.5 * angle;
    }
    if (tool.shape == ToolShape::chamfer) tool.tip_diameter = 2.0 * size("flatRadius");
    tool.flute_length = size("cuttingEdgeHeight");
    if (tool.flute_length < 0.5 * tool.diameter) tool.flute_length = 0.0; // often left as it was
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
        if (!named) return tl::unexpected(error(path, "each of tools needs nr and path"));
        const std::string name = entry["path"];
        const auto place = find_bit(path, name);
        if (!place)
            return tl::unexpected(error(path, fmt::format("there is no bit {} beside it or in "
                                                          "../Bit",
                                                          name)));
        FEELER_TRY(const json bit, read_json(*place));
        FEELER_TRY(const FoundTool tool, tool_of_bit(bit, entry["nr"].get<int>(), *place));
        if (auto wrong = add_tool(tools, tool, path); !wrong) return tl::unexpected(wrong.error());
    }
    return tools;
}

core::Result<ToolMap> tools_of_freecad_bit(const json& bit, const std::filesystem::path& path) {
    ToolMap tools;
    FEELER_TRY(const FoundTool tool, tool_of_bit(bit, 1, path));
    if (auto wrong = add_tool(tools, tool, path); !wrong) return tl::unexpected(wrong.error());
    return tools;
}

core::Result<ToolMap> tools_of_freecad_table(const json& table, const std::filesystem::path& path) {
    ToolMap tools;
    if (!table.is_object()) return tl::unexpected(error(path, "Tools must map numbers to tools"));
    for (const auto& [key, entry] : table.items()) {
        const auto number = number_in(key);
        if (!number || !entry.is_object())
            return tl::unexpected(error(path, fmt::format("'{}' is no number of a tool", key)));
        const FoundTool tool = freecad_tool(entry, static_cast<int>(*number), path);
        if (auto wrong = add_tool(tools, tool, path); !wrong) return tl::unexpected(wrong.error());
    }
    return tools;
}

} // namespace app
