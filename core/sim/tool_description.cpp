#include "core/sim/tool_description.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "core/base/units.h"

namespace core {
namespace {

namespace shape_table {

using enum ToolShape;
using Group = ToolSize::Group;

constexpr ToolShapeEntry shapes[] = {
    {flat, "flat", "a flat end mill"},         {ball, "ball", "a ball end mill"},
    {bull, "bull", "a bull nose end mill"},    {drill, "drill", "a drill", false, true},
    {taper, "taper", "a tapered mill"},        {chamfer, "chamfer", "a chamfer mill"},
    {tslot, "tslot", "a T-slot cutter", true}, {dovetail, "dovetail", "a dovetail cutter", true},
    {lollipop, "lollipop", "a lollipop"},      {threadmill, "threadmill", "a thread mill", true},
    {profile, "profile", "a form tool"}};

constexpr ShapeSet no_profile = {flat,    ball,  bull,     drill,    taper,
                                 chamfer, tslot, dovetail, lollipop, threadmill};
constexpr ShapeSet all_shapes = {flat,  ball,     bull,     drill,      taper,  chamfer,
                                 tslot, dovetail, lollipop, threadmill, profile};

// clang-format off
constexpr ToolSize sizes[] = {
    {"diameter", "Diameter", "mm", &ToolDescription::diameter, Group::diameter,
     all_shapes, all_shapes, {profile}},
    {"flute_length", "Flute length", "mm", &ToolDescription::flute_length, Group::length,
     all_shapes, all_shapes, {lollipop, profile}},
    {"corner_radius", "Corner radius", "mm", &ToolDescription::corner_radius, Group::edge,
     {flat, ball, bull, taper, chamfer, tslot, dovetail}, {bull, taper, chamfer, tslot, dovetail},
     all_shapes},
    {"point_deg", "Point angle", "deg", &ToolDescription::point_deg, Group::edge,
     {drill}, {drill}},
    {"angle_deg", "Flank from axis", "deg", &ToolDescription::angle_deg, Group::edge,
     {taper, chamfer, dovetail}, {taper, chamfer, dovetail}},
    {"tip_diameter", "Tip diameter", "mm", &ToolDescription::tip_diameter, Group::edge,
     {taper, chamfer}, {taper, chamfer}, all_shapes},
    {"neck_diameter", "Neck diameter", "mm", &ToolDescription::neck_diameter, Group::length,
     no_profile, {tslot, dovetail, lollipop, threadmill}},
    {"neck_length", "Neck length", "mm", &ToolDescription::neck_length, Group::length,
     no_profile, {}},
    {"pitch", "Pitch", "mm", &ToolDescription::pitch, Group::edge, {threadmill}, {threadmill}},
    {"thread_deg", "Thread angle", "deg", &ToolDescription::thread_deg, Group::edge,
     {threadmill}, {}},
    {"shank_diameter", "Shank diameter", "mm", &ToolDescription::shank_diameter, Group::length,
     all_shapes, all_shapes},
    {"stick_out", "Stick-out", "mm", &ToolDescription::stick_out, Group::length,
     all_shapes, all_shapes},
    {"gauge_length", "Gauge length", "mm", &ToolDescription::gauge_length, Group::length,
     all_shapes, {}}};
// clang-format on

} // namespace shape_table
} // namespace

std::span<const ToolShapeEntry> tool_shapes() { return shape_table::shapes; }

const char* name_of(ToolShape shape) { return tool_shapes()[static_cast<size_t>(shape)].name; }

const char* description_of(ToolShape shape) {
    return tool_shapes()[static_cast<size_t>(shape)].description;
}

bool cuts_undercuts(ToolShape shape) {
    return tool_shapes()[static_cast<size_t>(shape)].cuts_undercuts;
}

bool only_drills(ToolShape shape) { return tool_shapes()[static_cast<size_t>(shape)].only_drills; }

std::optional<ToolShape> tool_shape_named(const std::string& name) {
    for (const ToolShapeEntry& entry : tool_shapes())
        if (name == entry.name) return entry.shape;
    return std::nullopt;
}

std::span<const ToolSize> tool_sizes() { return shape_table::sizes; }

bool has_size(ToolShape shape, ToolSize::Member member) {
    return std::ranges::any_of(tool_sizes(), [&](const ToolSize& size) {
        return size.member == member && size.shapes.contains(shape);
    });
}

std::optional<double> ToolSize::of(const ToolDescription& tool) const {
    if (const auto* always = std::get_if<0>(&member)) {
        const double value = tool.*(*always);
        return value == 0.0 ? std::nullopt : std::optional(value);
    }
    return tool.*std::get<1>(member);
}

void ToolSize::put(ToolDescription& tool, std::optional<double> value) const {
    if (const auto* always = std::get_if<0>(&member))
        tool.*(*always) = value.value_or(0.0);
    else
        tool.*std::get<1>(member) = value;
}

std::string shown(const ToolDescription& tool, double mm) {
    return fmt::format("{:g}", tool.is_in_inches ? mm / mm_per_inch : mm);
}

const char* unit_of(const ToolDescription& tool) { return tool.is_in_inches ? "in" : "mm"; }

tl::unexpected<Error> tool_error(const ToolDescription& tool, const std::string& why) {
    return fail(ErrorCode::invalid_value, fmt::format("tool {}: {}", value_of(tool.number), why));
}

namespace {

constexpr double longest_length = 2000.0; // mm; more is taken for a typing error

/// Fails if the tool has a dimension that does not apply to its shape.
Result<void> check_shape_keys(const ToolDescription& tool) {
    const auto refused = [&](const char* key) {
        return tool_error(
            tool, fmt::format("{} does not apply to shape \"{}\"", key, name_of(tool.shape)));
    };
    for (const ToolSize& size : tool_sizes()) {
        const auto value = size.of(tool);
        const bool is_absent = !value || (*value == 0.0 && size.zero.contains(tool.shape));
        if (!is_absent && !size.shapes.contains(tool.shape)) return refused(size.key);
    }
    if (!tool.outline.empty() && tool.shape != ToolShape::profile) return refused("profile");
    if (tool.teeth && tool.shape != ToolShape::threadmill) return refused("teeth");
    return {};
}

Result<void> check_length(const ToolDescription& tool, const ToolSize& size, double value) {
    if (!std::isfinite(value) || value < 0.0 || (value == 0.0 && !size.zero.contains(tool.shape)))
        return tool_error(tool, fmt::format("{} must be above 0", size.key));
    if (value > longest_length)
        return tool_error(tool, fmt::format("{0} = {1} {3} is implausible: the maximum is {2} {3}",
                                            size.key, shown(tool, value),
                                            shown(tool, longest_length), unit_of(tool)));
    return {};
}

} // namespace

double total_length(const std::vector<ConeStep>& steps) {
    double sum = 0.0;
    for (const ConeStep& step : steps) sum += step.length;
    return sum;
}

Result<void> check_keys(const ToolDescription& tool) {
    if (auto wrong = check_shape_keys(tool); !wrong) return wrong;
    for (const ToolSize& size : tool_sizes()) {
        if (size.is_angle()) continue;
        const bool is_required = std::holds_alternative<double ToolDescription::*>(size.member);
        const auto value = size.of(tool);
        if (!value && !is_required) continue;
        if (auto wrong = check_length(tool, size, value.value_or(0.0)); !wrong) return wrong;
    }
    const bool outlined = tool.shape == ToolShape::profile;
    if (tool.centre_radius != 0.0
        && !(tool.centre_radius > 0.0 && (outlined || 2.0 * tool.centre_radius < tool.diameter)))
        return tool_error(
            tool, fmt::format("centre_diameter {} must be above 0 and below diameter {}",
                              shown(tool, 2.0 * tool.centre_radius), shown(tool, tool.diameter)));
    return {};
}

} // namespace core
