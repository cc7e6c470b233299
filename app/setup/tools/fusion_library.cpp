#include "app/setup/tools/fusion_library.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/setup/tools/fusion_tool.h"
#include "app/setup/tools/json_file.h"
#include "app/setup/tools/tool_text.h"
#include "core/base/file_reads.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "core/formats/xml_document.h"
#include "core/formats/zip_archive.h"

namespace app {
namespace {

using core::ConeStep;
using nlohmann::json;

constexpr int highest_tool_number = 99999999;

/// mm in a unit of a library; empty if it is not known.
std::optional<double> unit_of(const std::string& name) {
    const std::string unit = core::lower_case(trimmed(name));
    if (unit.find("inch") != std::string::npos || unit == "in") return core::mm_per_inch;
    if (unit.empty() || unit.find("millimet") != std::string::npos || unit == "mm") return 1.0;
    return std::nullopt;
}

core::Error unit_error(const std::string& unit, const std::string& path) {
    return {core::ErrorCode::syntax,
            {},
            fmt::format("has a tool in the unit \"{}\", which is not known: use millimeters or "
                        "inches",
                        unit),
            path};
}

/// A number with a unit and nothing else, such as `6 mm`; empty for formulas. Lengths in mm; those
/// without a unit are multiplied by `unit`.
std::optional<double> plain_quantity(const std::string& text, double unit) {
    const std::string capitals = plain_capitals(text);
    if (capitals.find_first_of("+*/()") != std::string::npos) return std::nullopt;
    const std::vector<TextNumber> numbers = numbers_of(capitals);
    if (numbers.size() != 1 || !numbers[0].prefix.empty()) return std::nullopt;
    const std::string& suffix = numbers[0].suffix;
    if (suffix == "MM") return numbers[0].value;
    if (suffix == "CM") return 10.0 * numbers[0].value;
    if (suffix == "IN" || suffix == "INCH" || suffix == "\"")
        return core::mm_per_inch * numbers[0].value;
    if (suffix == "DEG") return numbers[0].value;
    return suffix.empty() ? std::optional(unit * numbers[0].value) : std::nullopt;
}

/// Reads the sizes of one tool. Libraries hold numbers, and formulas beside those that have any.
struct FusionEntry {
    const json& tool;
    double unit; // mm

    std::optional<double> number(const char* key, const char* expression, double factor) const {
        const json& value = member_at(member_at(tool, "geometry"), key);
        if (value.is_number()) return factor * value.get<double>();
        if (!expression) return std::nullopt;
        return plain_quantity(text_at(member_at(tool, "expressions"), expression), factor);
    }
    std::optional<double> length(const char* key, const char* expression = nullptr) const {
        const auto value = number(key, expression, unit);
        return value && *value > 0.0 ? value : std::nullopt;
    }
    std::optional<double> angle(const char* key, const char* expression = nullptr) const {
        const auto value = number(key, expression, 1.0);
        return value && *value > 0.0 ? value : std::nullopt;
    }
};

/// The segments of a holder or shaft, from the tip up.
///
/// Result: empty if a size is no number.
std::optional<std::vector<ConeStep>> segments_of(const json& part, double unit) {
    std::vector<ConeStep> steps;
    const json& segments = member_at(part, "segments");
    if (segments.is_null()) return steps;
    if (!segments.is_array()) return std::nullopt;
    for (const json& segment : segments) {
        for (const char* key : {"height", "lower-diameter", "upper-diameter"})
            if (!member_at(segment, key).is_number()) return std::nullopt;
        const double height = number_at(segment, "height") * unit;
        const double lower = number_at(segment, "lower-diameter") * unit;
        const double upper = number_at(segment, "upper-diameter") * unit;
        if (height > 0.0 && std::min(lower, upper) >= 0.0 && std::max(lower, upper) > 0.0)
            steps.push_back({lower, upper, height});
    }
    return steps;
}

/// The unit of a part of a tool, which may have one of its own that is known.
double unit_of_part(const json& part, double unit_of_tool) {
    const std::string unit = text_at(part, "unit");
    return unit.empty() ? unit_of_tool : unit_of(unit).value_or(unit_of_tool);
}

/// The `unit` of a tool or of a part of it; anything but a text as it is written.
std::string stated_unit(const json& part) {
    const json& unit = member_at(part, "unit");
    return unit.is_null() || unit.is_string() ? text_at(part, "unit") : unit.dump();
}

std::string unit_of_tool(const json& tool) {
    const std::string unit = stated_unit(tool);
    return unit.empty() ? text_at(member_at(tool, "expressions"), "tool_unit") : unit;
}

/// A unit in a tool that is not known.
std::optional<std::string> unknown_unit(const json& tool) {
    for (const std::string& unit : {unit_of_tool(tool), stated_unit(member_at(tool, "holder")),
                                    stated_unit(member_at(tool, "shaft"))})
        if (!unit_of(unit)) return unit;
    return std::nullopt;
}

void read_holder_of(const FusionEntry& entry, FusionTool& tool) {
    const json& holder = member_at(entry.tool, "holder");
    const double unit = unit_of_part(holder, entry.unit);
    const auto steps = segments_of(holder, unit);
    tool.is_damaged_above |= !steps;
    tool.holder = steps.value_or(std::vector<ConeStep>());
    const double own = number_at(holder, "gaugeLength") * unit;
    const auto whole = entry.length("assemblyGaugeLength");
    if (own > 0.0)
        tool.holder_length = own;
    else if (whole && tool.body_length && *whole > *tool.body_length)
        tool.holder_length = *whole - *tool.body_length;
}

/// The number by which programs call a tool; 0 if it has none.
int post_number_of(const json& tool) {
    const json& number = member_at(member_at(tool, "post-process"), "number");
    const std::optional<double> value = number.is_number()   ? number.get<double>()
                                        : number.is_string() ? number_in(number.get<std::string>())
                                                             : std::nullopt;
    const bool is_whole = value && *value == std::floor(*value);
    return is_whole && *value > 0.0 && *value <= highest_tool_number ? static_cast<int>(*value) : 0;
}

std::string name_of_tool(const json& tool) {
    for (const char* key : {"description", "product-id"})
        if (std::string name = trimmed(text_at(tool, key)); !name.empty()) return name;
    return trimmed(text_at(member_at(tool, "post-process"), "comment"));
}

void read_sizes(const FusionEntry& entry, FusionTool& tool) {
    tool.diameter = entry.length("DC", "tool_diameter");
    tool.largest_diameter = entry.length("DCX");
    tool.corner_radius = entry.length("RE", "tool_cornerRadius");
    tool.flank_deg = entry.angle("TA", "tool_taperAngle");
    tool.point_deg = entry.angle("SIG", "tool_tipAngle");
    tool.tip_diameter = entry.length("tip-diameter", "tool_tipDiameter");
    tool.tip_length = entry.length("tip-length", "tool_tipLength");
    tool.flute_length = entry.length("LCF", "tool_fluteLength");
    tool.shoulder_length = entry.length("shoulder-length", "tool_shoulderLength");
    tool.shoulder_diameter = entry.length("shoulder-diameter", "tool_shoulderDiameter");
    tool.shank_diameter = entry.length("SFDM", "tool_shaftDiameter");
    tool.body_length = entry.length("LB", "tool_bodyLength");
    tool.pitch = entry.length("TP", "tool_threadPitch");
}

FusionTool fusion_tool(const json& json_tool) {
    const FusionEntry entry{json_tool, unit_of(unit_of_tool(json_tool)).value_or(1.0)};
    FusionTool tool;
    tool.type = text_at(json_tool, "type");
    tool.name = name_of_tool(json_tool);
    tool.number = post_number_of(json_tool);
    read_sizes(entry, tool);
    const json& hand = member_at(member_at(json_tool, "geometry"), "HAND");
    tool.is_left_hand = tool.type == "tap left hand" || (hand.is_boolean() && !hand.get<bool>());
    const json& shaft = member_at(json_tool, "shaft");
    const auto steps = segments_of(shaft, unit_of_part(shaft, entry.unit));
    tool.shaft = steps.value_or(std::vector<ConeStep>());
    tool.is_damaged_above = !steps;
    if (!steps) tool.body_length.reset();
    read_holder_of(entry, tool);
    return tool;
}

// --- HSM
// ------------------------------------------------------------------------------------------

std::optional<double> attribute_of(const pugi::xml_node& node, const char* name, double factor) {
    const auto number = number_in(trimmed(node.attribute(name).as_string()));
    return number && *number > 0.0 ? std::optional(factor * *number) : std::nullopt;
}

/// The sections of a holder are points of its outline: a diameter, and the length over which it is
/// reached. A length of 0 is a step.
std::vector<ConeStep> sections_of(const pugi::xml_node& holder, double unit) {
    std::vector<ConeStep> steps;
    std::optional<double> below;
    for (const pugi::xml_node& section : holder.children("section")) {
        const double diameter = attribute_of(section, "diameter", unit).value_or(0.0);
        const double length = attribute_of(section, "length", unit).value_or(0.0);
        const double lower = below.value_or(diameter);
        if (length > 0.0 && std::max(lower, diameter) > 0.0)
            steps.push_back({lower, diameter, length});
        below = diameter;
    }
    return steps;
}

/// Whether `taper-angle` is the angle of the whole tip instead of that of the flank from the axis.
bool has_point_angle(const std::string& type) {
    return type.ends_with("drill") || type.starts_with("counter") || type.starts_with("tap ")
           || type == "reamer";
}

void read_body(const pugi::xml_node& body, double unit, FusionTool& tool) {
    tool.diameter = attribute_of(body, "diameter", unit);
    tool.corner_radius = attribute_of(body, "corner-radius", unit);
    const auto angle = attribute_of(body, "taper-angle", 1.0);
    const auto second = attribute_of(body, "taper-angle2", 1.0);
    (has_point_angle(tool.type) ? tool.point_deg : tool.flank_deg) = angle;
    if (has_point_angle(tool.type)) tool.flank_deg = second;
    tool.tip_diameter = attribute_of(body, "tip-diameter", unit);
    tool.tip_length = attribute_of(body, "tip-length", unit);
    tool.flute_length = attribute_of(body, "flute-length", unit);
    tool.shoulder_length = attribute_of(body, "shoulder-length", unit);
    tool.shoulder_diameter = attribute_of(body, "shoulder-diameter", unit);
    tool.shank_diameter = attribute_of(body, "shaft-diameter", unit);
    tool.body_length = attribute_of(body, "body-length", unit);
    tool.pitch = attribute_of(body, "thread-pitch", unit);
}

FusionTool hsm_tool(const pugi::xml_node& node) {
    const double unit = unit_of(node.attribute("unit").as_string()).value_or(1.0);
    FusionTool tool;
    tool.type = node.attribute("type").as_string();
    for (const char* key : {"description", "product-id"})
        if (tool.name.empty()) tool.name = trimmed(node.child_value(key));
    const auto number = attribute_of(node.child("nc"), "number", 1.0);
    if (number && *number <= highest_tool_number) tool.number = static_cast<int>(*number);
    read_body(node.child("body"), unit, tool);
    tool.is_left_hand =
        tool.type == "tap left hand"
        || node.child("motion").attribute("clockwise").as_string() == std::string_view("no");
    tool.shaft = sections_of(node.child("shaft"), unit);
    tool.holder = sections_of(node.child("holder"), unit);
    return tool;
}

/// The name of an element without that of its namespace.
std::string_view local_name(const pugi::xml_node& node) {
    const std::string_view name = node.name();
    return name.substr(name.find(':') + 1);
}

/// Libraries are `tool-library`; those of older versions are `tool-table`.
bool is_hsm_library(const pugi::xml_node& root) {
    return local_name(root) == "tool-library" || local_name(root) == "tool-table";
}

} // namespace

core::Result<std::map<core::ToolNumber, FoundTool>>
tools_of_fusion_library(const nlohmann::json& library, const std::filesystem::path& path) {
    NumberedTools tools(path.generic_string());
    for (const json& entry : member_at(library, "data"))
        if (entry.is_object() && !is_no_rotating_cutter(text_at(entry, "type"))) {
            if (const auto unit = unknown_unit(entry))
                return tl::unexpected(unit_error(*unit, path.generic_string()));
            tools.add(fusion_tool(entry));
        }
    return tools.result();
}

core::Result<std::map<core::ToolNumber, FoundTool>>
tools_of_fusion_archive(const std::string& path) {
    FEELER_TRY(const core::ZipArchive archive, core::ZipArchive::open(path));
    std::string name = "tools.json";
    for (const std::string& each : archive.names())
        if (!archive.contains(name) && core::lower_case(each).ends_with(".json")) name = each;
    if (!archive.contains(name))
        return tl::unexpected(
            core::Error{core::ErrorCode::syntax,
                        {},
                        "is an archive without tools.json, so no library of Fusion 360",
                        path});
    FEELER_TRY(const std::string text, archive.read(name, core::largest_member));
    FEELER_TRY(const json library, parse_json(text, path));
    return tools_of_fusion_library(library, path);
}

core::Result<std::map<core::ToolNumber, FoundTool>> tools_of_hsm_library(const std::string& path) {
    if (std::string why = core::why_no_file(path); !why.empty())
        return tl::unexpected(core::Error{core::ErrorCode::io, {}, std::move(why), path});
    const auto bytes = core::file_bytes(path, core::largest_member);
    if (!bytes || bytes->size() > core::largest_member)
        return tl::unexpected(core::Error{
            core::ErrorCode::io, {}, bytes ? "is larger than 64 MiB" : "cannot be read", path});
    FEELER_TRY(const core::XmlDocument xml, core::XmlDocument::parse(*bytes, path));
    NumberedTools tools(path);
    for (const pugi::xml_node& root : xml.root().children()) {
        if (!is_hsm_library(root)) continue;
        for (const pugi::xml_node& node : root.children("tool"))
            if (!is_no_rotating_cutter(node.attribute("type").as_string())) {
                const std::string unit = node.attribute("unit").as_string();
                if (!unit_of(unit)) return tl::unexpected(unit_error(unit, path));
                tools.add(hsm_tool(node));
            }
        return tools.result();
    }
    return tl::unexpected(
        core::Error{core::ErrorCode::syntax,
                    {},
                    "is XML, but no tool library of HSM (tool-library is missing)",
                    path});
}

} // namespace app
