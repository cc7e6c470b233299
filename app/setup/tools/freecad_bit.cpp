#include "app/setup/tools/freecad_bit.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <regex>

#include "app/base/text.h"
#include "app/setup/tools/json_file.h"
#include "app/setup/tools/tool_text.h"
#include "core/base/text.h"
#include "core/base/units.h"

namespace app {

using core::ToolDescription;
using core::ToolShape;
using nlohmann::json;

namespace {

/// Units by their names, and their sizes.
using Units = std::map<std::string, double, std::less<>>;

/// A number or a quantity in one of these units.
std::optional<double> quantity(const json& value, const Units& units) {
    if (value.is_number()) return value.get<double>();
    if (!value.is_string()) return std::nullopt;
    // A decimal number, or a fraction as in "1 1/2 in", and a unit.
    static const std::regex form(R"(\s*([+-]?)(?:(\d+[.,]?\d*(?:[eE][+-]?\d+)?|[.,]\d+))?)"
                                 R"((?:(?:^|[\s+-])\s*(\d+)/(\d+))?\s*([^\s\d.,/+-]\S*)?\s*)");
    static const std::regex fraction(R"(\s*([+-]?)()(\d+)/(\d+)\s*([^\s\d.,/+-]\S*)?\s*)");
    std::smatch match;
    const std::string text = value.get<std::string>();
    constexpr size_t longest = 64; // std::regex calls itself for each character
    if (text.size() > longest) return std::nullopt;
    if (!std::regex_match(text, match, fraction) && !std::regex_match(text, match, form))
        return std::nullopt;
    const auto unit = units.find(match[5].str());
    if (unit == units.end() || (!match[2].length() && !match[3].length())) return std::nullopt;
    std::string digits = match[2];
    std::replace(digits.begin(), digits.end(), ',', '.');
    double number = digits.empty() ? 0.0 : number_in(digits).value_or(core::infinity);
    if (match[3].length() > 0) {
        const auto above = number_in(match[3].str()), below = number_in(match[4].str());
        if (!above || !below || *below == 0.0) return std::nullopt;
        number += *above / *below;
    }
    if (!std::isfinite(number)) return std::nullopt;
    return (match[1] == "-" ? -number : number) * unit->second;
}

} // namespace

std::optional<double> freecad_length(const json& value) {
    static const Units units = {{"", 1.0},
                                {"mm", 1.0},
                                {"cm", 10.0},
                                {"dm", 100.0},
                                {"m", 1000.0},
                                {"um", 0.001},
                                {"\xC2\xB5m", 0.001},
                                {"\xCE\xBCm", 0.001},
                                {"in", core::mm_per_inch},
                                {"\"", core::mm_per_inch},
                                {"ft", 12.0 * core::mm_per_inch},
                                {"'", 12.0 * core::mm_per_inch},
                                {"mil", 0.001 * core::mm_per_inch},
                                {"thou", 0.001 * core::mm_per_inch}};
    return quantity(value, units);
}

std::optional<double> freecad_angle(const json& value) {
    static const Units units = {
        {"", 1.0}, {"deg", 1.0}, {"\xC2\xB0", 1.0}, {"rad", core::degrees_per_radian}};
    return quantity(value, units);
}

namespace {

core::Error bit_error(const std::filesystem::path& path, const std::string& why) {
    return {core::ErrorCode::syntax, {}, why, path.generic_string()};
}

/// The names of a parameter, which differ between versions.
using Names = std::initializer_list<const char*>;

/// A parameter by any of its names; null if there is none.
const json& parameter(const json& parameters, Names names) {
    for (const char* name : names)
        if (const json& found = member_at(parameters, name); !found.is_null()) return found;
    return member_at(parameters, "");
}

std::optional<double> angle(const json& parameters, Names names) {
    return freecad_angle(parameter(parameters, names));
}

std::optional<double> length(const json& parameters, Names names) {
    return freecad_length(parameter(parameters, names));
}

/// A length; empty if it is not above 0.
std::optional<double> length_above_0(const json& parameters, Names names) {
    const auto value = length(parameters, names);
    return value && *value > 0.0 ? value : std::nullopt;
}

std::optional<ToolShape> shape_of_bit(std::string shape) {
    shape = shape.substr(0, shape.find(".fcstd"));
    std::string letters;
    for (const char c : shape.substr(shape.find_last_of('/') + 1))
        if (std::isalpha(static_cast<unsigned char>(c)) != 0) letters += core::lower(c);
    return shape_in(freecad_shapes(), letters);
}

void read_angles(const json& parameters, ToolDescription& tool) {
    const auto cutting = angle(parameters, {"CuttingEdgeAngle", "cuttingAngle", "CuttingAngle"});
    const auto tip = angle(parameters, {"TipAngle"});
    if (has_size(tool.shape, &ToolDescription::point_deg)) tool.point_deg = tip;
    if (tool.shape == ToolShape::chamfer && cutting) tool.angle_deg = 0.5 * *cutting;
    if (tool.shape == ToolShape::dovetail && cutting) tool.angle_deg = 90.0 - *cutting;
    if (tool.shape == ToolShape::taper) tool.angle_deg = angle(parameters, {"TaperAngle"});
}

/// A slitting saw is a T-slot cutter with a thin head. The length of a bit is that of the whole
/// tool, of which a part is in the holder.
void read_lengths(const json& parameters, ToolDescription& tool) {
    tool.flute_length =
        length_above_0(parameters, {"CuttingEdgeHeight", "BladeThickness", "CuttingEdge"})
            .value_or(0.0);
    tool.shank_diameter = length_above_0(parameters, {"ShankDiameter", "ShaftDiameter"});
    const bool necked = tool.shape == ToolShape::dovetail || tool.shape == ToolShape::threadmill;
    if (necked) tool.neck_diameter = length_above_0(parameters, {"NeckDiameter"});
    if (necked && tool.neck_diameter)
        tool.neck_length = length_above_0(parameters, {"NeckHeight", "NeckLength"});
    if (tool.shape == ToolShape::threadmill)
        tool.flute_length = 0.0; // "Crest" is the width of one tooth
}

} // namespace

core::Result<FoundTool> tool_of_freecad_bit(const json& bit, int number,
                                            const std::filesystem::path& path) {
    FoundTool found;
    found.source = path.generic_string();
    found.tool.number = core::ToolNumber{number};
    found.tool.name = text_at(bit, "name");
    const std::string shape = text_at(bit, "shape");
    const auto known = shape_of_bit(shape);
    found.has_shape = known.has_value();
    found.tool.shape = known.value_or(ToolShape::flat);
    if (!bit.is_object()) return tl::unexpected(bit_error(path, "is not a tool bit"));
    const json& parameters = bit.contains("parameter") ? bit["parameter"] : bit;
    const auto diameter = length(parameters, {"Diameter"});
    if (!diameter || !(*diameter > 0.0))
        return tl::unexpected(
            bit_error(path, "the bit has no Diameter above 0 in a unit that is known"));
    found.tool.diameter = *diameter;
    read_angles(parameters, found.tool);
    read_lengths(parameters, found.tool);
    if (found.tool.shape == ToolShape::chamfer)
        found.tool.tip_diameter = length(parameters, {"TipDiameter"}).value_or(0.0);
    if (found.tool.shape == ToolShape::bull) {
        const auto flat = length(parameters, {"FlatRadius"});
        found.tool.corner_radius = length(parameters, {"CornerRadius", "TorusRadius"});
        if (!found.tool.corner_radius && flat) found.tool.corner_radius = 0.5 * *diameter - *flat;
    }
    if (found.tool.shape == ToolShape::taper) { // Diameter is that of the ball at the tip
        found.tool.corner_radius = 0.5 * *diameter;
        found.tool.diameter = length(parameters, {"TaperDiameter"}).value_or(2.0 * *diameter);
    }
    return found;
}

} // namespace app
