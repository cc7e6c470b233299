#include <fmt/format.h>

#include "app/tools/json_tools.h"
#include "app/tools/tool_text.h"
#include "app/tools/tool_words.h"

namespace app {
namespace {

using core::ToolDescription;
using core::ToolShape;
using nlohmann::json;

std::optional<ToolShape> shape_of_type(const std::string& type) {
    static const std::map<std::string, ToolShape> shapes = {{"flat end mill", ToolShape::flat},
                                                            {"ball end mill", ToolShape::ball},
                                                            {"bull nose end mill", ToolShape::bull},
                                                            {"face mill", ToolShape::flat},
                                                            {"tapered mill", ToolShape::taper},
                                                            {"chamfer mill", ToolShape::chamfer},
                                                            {"lollipop mill", ToolShape::lollipop},
                                                            {"slot mill", ToolShape::tslot},
                                                            {"dovetail mill", ToolShape::dovetail},
                                                            {"thread mill", ToolShape::threadmill},
                                                            {"drill", ToolShape::drill},
                                                            {"spot drill", ToolShape::drill},
                                                            {"center drill", ToolShape::drill},
                                                            {"counter sink", ToolShape::chamfer},
                                                            {"reamer", ToolShape::flat},
                                                            {"boring bar", ToolShape::flat},
                                                            {"counter bore", ToolShape::flat}};
    if (const auto found = shapes.find(type); found != shapes.end()) return found->second;
    return shape_of_words(plain_capitals(type));
}

/// One tool of the library, whose sizes are in its unit.
struct Reader {
    const json& tool;
    double unit; // mm

    std::optional<double> plain(const char* key) const {
        const auto geometry = tool.find("geometry");
        if (geometry == tool.end() || !geometry->is_object()) return std::nullopt;
        const auto found = geometry->find(key);
        if (found == geometry->end() || !found->is_number()) return std::nullopt;
        return found->get<double>();
    }
    std::optional<double> size(const char* key) const {
        const auto value = plain(key);
        return value && *value > 0.0 ? std::optional(*value * unit) : std::nullopt;
    }
};

void read_shape(const Reader& reader, ToolDescription& made) {
    const auto corner = reader.size("RE");
    const auto flank = reader.plain("TA"), point = reader.plain("SIG");
    if (made.shape == ToolShape::bull || made.shape == ToolShape::tslot)
        made.corner_radius = corner;
    if (made.shape == ToolShape::flat && corner && 2.0 * *corner < made.diameter) {
        made.shape = ToolShape::bull;
        made.corner_radius = corner;
    }
    if (made.shape == ToolShape::drill) made.point_deg = point;
    if (made.shape == ToolShape::chamfer || made.shape == ToolShape::dovetail)
        made.angle_deg = flank;
    if (made.shape == ToolShape::chamfer && !flank && point) made.angle_deg = 0.5 * *point;
    if (made.shape == ToolShape::chamfer)
        made.tip_diameter = reader.size("tip-diameter").value_or(0.0);
    if (made.shape == ToolShape::lollipop) made.neck_diameter = reader.size("shoulder-diameter");
    if (made.shape == ToolShape::threadmill) made.pitch = reader.size("TP");
    if (made.shape == ToolShape::taper) { // DC is measured at the tip
        made.tip_diameter = made.diameter;
        made.corner_radius = corner;
        made.angle_deg = flank;
        made.diameter = std::max(reader.size("SFDM").value_or(0.0), 1.5 * made.tip_diameter);
    }
}

/// The holder's segments stand from the tool's end up.
void read_holder(const json& tool, ToolDescription& made) {
    const auto holder = tool.find("holder");
    if (holder == tool.end() || !holder->is_object() || !holder->contains("segments")
        || !(*holder)["segments"].is_array())
        return;
    const double unit = text_at(*holder, "unit") == "inches" ? 25.4 : 1.0;
    for (const json& segment : (*holder)["segments"]) {
        if (!segment.is_object()) continue;
        const double height = number_at(segment, "height") * unit;
        const double lower = number_at(segment, "lower-diameter") * unit;
        const double upper = number_at(segment, "upper-diameter") * unit;
        if (height > 0.0 && std::max(lower, upper) > 0.0)
            made.holder.push_back({lower, upper, height});
    }
}

std::optional<int> number_of(const json& tool) {
    const auto post = tool.find("post-process");
    if (post == tool.end() || !post->is_object()) return std::nullopt;
    const auto number = post->find("number");
    if (number == post->end() || !number->is_number_integer()) return std::nullopt;
    return number->get<int>();
}

FoundTool fusion_tool(const json& entry, int number, const std::filesystem::path& path) {
    const Reader reader{entry, text_at(entry, "unit") == "inches" ? 25.4 : 1.0};
    FoundTool found;
    found.source = path.string();
    found.tool.number = core::ToolNumber{number};
    found.tool.name = text_at(entry, "description");
    found.tool.diameter = reader.size("DC").value_or(0.0);
    const auto shape = shape_of_type(text_at(entry, "type"));
    found.has_shape = shape.has_value();
    found.tool.shape = shape.value_or(ToolShape::flat);
    read_shape(reader, found.tool);
    found.tool.flute_length = reader.size("LCF").value_or(0.0);
    found.tool.shank_diameter = reader.size("SFDM");
    found.tool.stick_out = reader.size("LB");
    read_holder(entry, found.tool);
    return found;
}

} // namespace

core::Result<ToolMap> tools_of_fusion_library(const json& library,
                                              const std::filesystem::path& path) {
    ToolMap tools;
    for (const json& entry : library["data"]) {
        if (!entry.is_object()) continue;
        const std::string type = text_at(entry, "type");
        const auto number = number_of(entry);
        if (!number || type == "holder" || type == "probe" || type.starts_with("turning")) continue;
        if (tools.contains(core::ToolNumber{*number})) continue; // a library of variants: the first
        const FoundTool tool = fusion_tool(entry, *number, path);
        if (tool.tool.diameter > 0.0) tools.emplace(tool.tool.number, tool);
    }
    if (tools.empty())
        return tl::unexpected(core::Error{
            core::ErrorCode::syntax, {}, "holds no milling tool with a number", path.string()});
    return tools;
}

} // namespace app
