#include "core/sim/tool_description.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

namespace core {
namespace {

constexpr std::pair<const char*, ToolShape> shapes[] = {
    {"flat", ToolShape::flat},         {"ball", ToolShape::ball},
    {"bull", ToolShape::bull},         {"drill", ToolShape::drill},
    {"taper", ToolShape::taper},       {"chamfer", ToolShape::chamfer},
    {"tslot", ToolShape::tslot},       {"dovetail", ToolShape::dovetail},
    {"lollipop", ToolShape::lollipop}, {"threadmill", ToolShape::threadmill},
    {"profile", ToolShape::profile}};

} // namespace

const char* name_of(ToolShape shape) {
    for (const auto& [name, known] : shapes)
        if (known == shape) return name;
    return "";
}

std::optional<ToolShape> tool_shape_named(const std::string& name) {
    for (const auto& [known, shape] : shapes)
        if (name == known) return shape;
    return std::nullopt;
}

tl::unexpected<Error> tool_error(const ToolDescription& tool, const std::string& why) {
    return fail(ErrorCode::invalid_value, fmt::format("tool {}: {}", value_of(tool.number), why));
}

namespace {

using Shapes = std::initializer_list<ToolShape>;

/// A key that only some shapes have.
struct ShapeKey {
    const char* name;
    bool given;
    Shapes shapes;
};

constexpr double longest_length = 2000.0; // mm; more is a slip of the finger

Result<void> check_shape_keys(const ToolDescription& tool) {
    using enum ToolShape;
    const auto is_set = [](const std::optional<double>& size) { return size && *size != 0.0; };
    const Shapes no_profile = {flat,    ball,  bull,     drill,    taper,
                               chamfer, tslot, dovetail, lollipop, threadmill};
    const ShapeKey keys[] = {{"corner_radius",
                              is_set(tool.corner_radius),
                              {flat, ball, bull, taper, chamfer, tslot, dovetail}},
                             {"point_deg", tool.point_deg.has_value(), {drill}},
                             {"angle_deg", tool.angle_deg.has_value(), {taper, chamfer, dovetail}},
                             {"tip_diameter", tool.tip_diameter != 0.0, {taper, chamfer}},
                             {"profile", !tool.outline.empty(), {profile}},
                             {"neck_diameter", tool.neck_diameter.has_value(), no_profile},
                             {"neck_length", tool.neck_length.has_value(), no_profile},
                             {"pitch", tool.pitch.has_value(), {threadmill}},
                             {"teeth", tool.teeth.has_value(), {threadmill}},
                             {"thread_deg", tool.thread_deg.has_value(), {threadmill}}};
    for (const ShapeKey& key : keys)
        if (key.given
            && std::find(key.shapes.begin(), key.shapes.end(), tool.shape) == key.shapes.end())
            return tool_error(tool, fmt::format("{} means nothing for shape \"{}\"", key.name,
                                                name_of(tool.shape)));
    return {};
}

/// A length; zero is one only where the key may as well be absent.
struct Length {
    const char* key;
    double value;
    bool may_be_zero;
};

Result<void> check_length(const ToolDescription& tool, const Length& length) {
    if (!std::isfinite(length.value) || length.value < 0.0
        || (length.value == 0.0 && !length.may_be_zero))
        return tool_error(tool, fmt::format("{} must be above 0", length.key));
    if (length.value > longest_length)
        return tool_error(tool, fmt::format("{} = {:g} mm is larger than any tool ({:g} mm)",
                                            length.key, length.value, longest_length));
    return {};
}

} // namespace

Result<void> check_keys(const ToolDescription& tool) {
    if (auto wrong = check_shape_keys(tool); !wrong) return wrong;
    const bool outlined = tool.shape == ToolShape::profile;
    const bool ball = tool.shape == ToolShape::lollipop;
    const Length lengths[] = {{"diameter", tool.diameter, outlined},
                              {"flute_length", tool.flute_length, outlined || ball},
                              {"tip_diameter", tool.tip_diameter, true},
                              {"corner_radius", tool.corner_radius.value_or(0.0), true},
                              {"neck_diameter", tool.neck_diameter.value_or(1.0), false},
                              {"neck_length", tool.neck_length.value_or(1.0), false},
                              {"pitch", tool.pitch.value_or(1.0), false},
                              {"shank_diameter", tool.shank_diameter.value_or(1.0), false},
                              {"stick_out", tool.stick_out.value_or(1.0), false},
                              {"gauge_length", tool.gauge_length.value_or(1.0), false}};
    for (const Length& length : lengths)
        if (auto wrong = check_length(tool, length); !wrong) return wrong;
    if (tool.centre_radius != 0.0
        && !(tool.centre_radius > 0.0 && (outlined || 2.0 * tool.centre_radius < tool.diameter)))
        return tool_error(tool, fmt::format("centre_diameter {:g} must be above 0 and below "
                                            "diameter {:g}",
                                            2.0 * tool.centre_radius, tool.diameter));
    return {};
}

} // namespace core
