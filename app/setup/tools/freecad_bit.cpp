#include "app/setup/tools/freecad_bit.h"

#include <cctype>

#include "app/setup/tools/json_file.h"
#include "app/setup/tools/tool_text.h"
#include "core/base/text.h"
#include "core/base/units.h"

namespace app {

using core::ToolDescription;
using core::ToolShape;
using nlohmann::json;

std::optional<double> freecad_quantity(const json& value) {
    if (value.is_number()) return value.get<double>();
    if (!value.is_string()) return std::nullopt;
    const std::vector<TextNumber> numbers = numbers_of(plain_capitals(value.get<std::string>()));
    if (numbers.size() != 1) return std::nullopt;
    const TextNumber& number = numbers[0];
    const bool inch = number.suffix == "IN" || number.suffix == "\"";
    if (number.suffix == "M") return 1000.0 * number.value;
    return number.value * (inch ? core::mm_per_inch : 1.0);
}

namespace {

core::Error bit_error(const std::filesystem::path& path, const std::string& why) {
    return {core::ErrorCode::syntax, {}, why, path.generic_string()};
}

/// A parameter by any of its names, which differ between versions.
std::optional<double> parameter(const json& parameters, std::initializer_list<const char*> names) {
    if (!parameters.is_object()) return std::nullopt;
    for (const char* name : names)
        if (const auto found = parameters.find(name); found != parameters.end())
            return freecad_quantity(*found);
    return std::nullopt;
}

std::optional<ToolShape> shape_of_bit(std::string shape) {
    shape = shape.substr(0, shape.find(".fcstd"));
    std::string letters;
    for (const char c : shape.substr(shape.find_last_of('/') + 1))
        if (std::isalpha(static_cast<unsigned char>(c)) != 0) letters += core::lower(c);
    return shape_in(freecad_shapes(), letters);
}

void read_angles(const json& parameters, ToolDescription& tool) {
    const auto cutting =
        parameter(parameters, {"CuttingEdgeAngle", "cuttingAngle", "CuttingAngle"});
    const auto tip = parameter(parameters, {"TipAngle"});
    if (has_size(tool.shape, &ToolDescription::point_deg)) tool.point_deg = tip;
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
    const auto diameter = parameter(parameters, {"Diameter"});
    if (!diameter) return tl::unexpected(bit_error(path, "the bit has no Diameter"));
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
    if (found.tool.shape == ToolShape::taper) // Diameter is that of the ball at the tip
        found.tool.corner_radius = 0.5 * *diameter,
        found.tool.diameter = parameter(parameters, {"TaperDiameter"}).value_or(2.0 * *diameter);
    return found;
}

} // namespace app
