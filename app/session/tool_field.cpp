#include "app/session/tool_field.h"

#include <algorithm>
#include <array>

#include "app/setup/holder_library.h"
#include "app/tools/found_tool.h"
#include "core/sim/tool_assembly.h"
#include "core/sim/tool_head.h"

namespace app {
namespace {

using core::ToolDescription;
using core::ToolShape;

/// A field and the shapes that have it; none: all of them.
struct ShapedField {
    ToolField field;
    std::vector<ToolShape> shapes;
};

const std::vector<ShapedField>& all_fields() {
    using enum ToolShape;
    using T = ToolDescription;
    static const std::vector<ShapedField> fields = {
        {{"diameter", "Diameter", "mm", &T::diameter}, {}},
        {{"corner_radius", "Corner radius", "mm", &T::corner_radius},
         {bull, taper, chamfer, tslot, dovetail}},
        {{"point_deg", "Point angle", "deg", &T::point_deg}, {drill}},
        {{"angle_deg", "Flank from axis", "deg", &T::angle_deg}, {taper, chamfer, dovetail}},
        {{"tip_diameter", "Tip diameter", "mm", &T::tip_diameter}, {taper, chamfer}},
        {{"pitch", "Pitch", "mm", &T::pitch}, {threadmill}},
        {{"flute_length", "Flute length", "mm", &T::flute_length}, {}},
        {{"neck_diameter", "Neck diameter", "mm", &T::neck_diameter},
         {tslot, dovetail, lollipop, threadmill}},
        {{"shank_diameter", "Shank diameter", "mm", &T::shank_diameter}, {}},
        {{"stick_out", "Stick-out", "mm", &T::stick_out}, {}},
    };
    return fields;
}

bool is_of(const ShapedField& field, ToolShape shape) {
    return field.shapes.empty()
           || std::find(field.shapes.begin(), field.shapes.end(), shape) != field.shapes.end();
}

bool is_cylinder(const std::vector<core::ConeStep>& steps) {
    return steps.size() == 1 && steps[0].lower_diameter == steps[0].upper_diameter;
}

bool are_equal(const std::vector<core::ConeStep>& a, const std::vector<core::ConeStep>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& two) {
        return one.lower_diameter == two.lower_diameter && one.upper_diameter == two.upper_diameter
               && one.length == two.length;
    });
}

} // namespace

std::optional<double> ToolField::of(const ToolDescription& tool) const {
    if (const auto* always = std::get_if<0>(&member)) {
        const double value = tool.*(*always);
        return value == 0.0 ? std::nullopt : std::optional(value);
    }
    return tool.*std::get<1>(member);
}

void ToolField::put(ToolDescription& tool, std::optional<double> value) const {
    if (const auto* always = std::get_if<0>(&member))
        tool.*(*always) = value.value_or(0.0);
    else
        tool.*std::get<1>(member) = value;
}

std::vector<ToolField> fields_of(ToolShape shape) {
    std::vector<ToolField> fields;
    for (const ShapedField& field : all_fields())
        if (is_of(field, shape)) fields.push_back(field.field);
    return fields;
}

std::span<const ToolShape> stateable_shapes() {
    using enum ToolShape;
    static constexpr std::array shapes = {flat,    ball,  bull,     drill,    taper,
                                          chamfer, tslot, dovetail, lollipop, threadmill};
    return shapes;
}

ToolDescription editable(ToolDescription tool) {
    const auto head = core::tool_head(tool);
    if (!head || tool.shape == ToolShape::profile) return tool;
    if (tool.shank.empty() || is_cylinder(tool.shank)) {
        if (!tool.shank.empty()) tool.shank_diameter = tool.shank[0].lower_diameter;
        const double shank = tool.shank.empty() ? 0.0 : tool.shank[0].length;
        tool.stick_out = tool.stick_out.value_or(head->length + shank);
        tool.shank.clear();
    } else {
        tool.stick_out.reset();
        tool.shank_diameter.reset();
    }
    if (!tool.holder.empty()) tool.gauge_length.reset();
    return tool;
}

ToolDescription reshaped(ToolDescription tool, ToolShape shape) {
    const ToolDescription before = tool;
    for (const ShapedField& field : all_fields())
        if (!field.shapes.empty()) field.field.put(tool, std::nullopt);
    tool.teeth.reset();
    tool.thread_deg.reset();
    tool.neck_length.reset();
    tool.outline.clear();
    tool.shape = shape;
    for (const ToolField& field : fields_of(shape)) field.put(tool, field.of(before));
    FoundTool found{.tool = tool, .has_shape = true};
    const ToolDescription kept = complete(found).tool;
    if (core::assemble(kept)) return kept;
    // Its lengths do not suit the shape.
    found.tool.flute_length = 0.0;
    found.tool.stick_out.reset();
    return complete(found).tool;
}

std::string holder_name(const ToolDescription& tool) {
    if (tool.holder.empty()) return {};
    for (const auto& [name, cones] : shipped_holder_library())
        if (are_equal(cones, tool.holder)) return name;
    return {};
}

} // namespace app
