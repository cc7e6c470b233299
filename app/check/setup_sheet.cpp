#include "app/check/setup_sheet.h"

#include <algorithm>
#include <array>

#include "app/check/prepared_check.h"
#include "app/setup/holder_library.h"
#include "app/setup/setup_file.h"
#include "app/setup/tools/found_tool.h"
#include "core/sim/tool_assembly.h"

namespace app {
namespace {

/// The keys of all fields in which the tools differ, including shape and holder.
std::set<std::string> differing_keys(const core::ToolDescription& a,
                                     const core::ToolDescription& b) {
    std::set<std::string> keys;
    if (a.shape != b.shape) keys.insert("shape");
    for (const core::ToolSize& field : fields_of(b.shape))
        if (field.of(a) != field.of(b)) keys.insert(field.key);
    const auto same = [](const core::ConeStep& one, const core::ConeStep& two) {
        return one.lower_diameter == two.lower_diameter && one.upper_diameter == two.upper_diameter
               && one.length == two.length;
    };
    if (!std::equal(a.holder.begin(), a.holder.end(), b.holder.begin(), b.holder.end(), same))
        keys.insert("holder");
    return keys;
}

bool are_equal(const core::Solid& a, const core::Solid& b) {
    if (a.shape.index() != b.shape.index()) return false;
    if (const auto* box = std::get_if<core::SolidBox>(&a.shape)) {
        const auto& other = std::get<core::SolidBox>(b.shape);
        return box->box.min == other.box.min && box->box.max == other.box.max;
    }
    if (const auto* round = std::get_if<core::SolidCylinder>(&a.shape)) {
        const auto& other = std::get<core::SolidCylinder>(b.shape);
        return round->base == other.base && round->radius == other.radius
               && round->height == other.height && round->axis == other.axis;
    }
    return true; // a mesh is never edited
}

SheetTool sheet_tool(const SetupFile& file, const core::ToolAssembly& tool,
                     const SetupEdits& edits) {
    SheetTool shown;
    shown.tool = editable(tool.description);
    const core::ToolNumber number = tool.description.number;
    if (const auto why = file.inferred_tools.find(number); why != file.inferred_tools.end())
        shown.why = why->second;
    if (file.is_inferred || !shown.why.empty()) shown.source = SetupSource::inferred;
    if (const auto edit = edits.tools.find(number); edit != edits.tools.end())
        shown.stated = edit->second.stated;
    return shown;
}

} // namespace

const char* name_of(SetupSource source) {
    switch (source) {
    case SetupSource::file:
        return "set-up";
    case SetupSource::inferred:
        return "inferred";
    case SetupSource::usual:
        return "usual";
    case SetupSource::stated:
        return "stated";
    }
    return "";
}

SetupSheet sheet_of(const SetupFile& file, const core::Setup& setup, const SetupEdits& edits) {
    SetupSheet sheet;
    sheet.path = file.path;
    sheet.frame = file.stock_frame;
    sheet.stock = setup.stock;
    sheet.stock_why = file.inferred_stock;
    if (edits.stock)
        sheet.stock_source = SetupSource::stated;
    else if (file.needs_stock)
        sheet.stock_source = SetupSource::inferred;
    for (const auto& [number, tool] : setup.tools)
        sheet.tools.push_back(sheet_tool(file, tool, edits));
    sheet.allowance = setup.allowance;
    if (edits.allowance)
        sheet.allowance_source = SetupSource::stated;
    else if (!setup.allowance)
        sheet.allowance_source = SetupSource::usual;
    if (file.is_inferred) sheet.tool_at_start = setup.tool_at_start;
    return sheet;
}

SetupEdits edits_between(const SetupSheet& shown, const SetupSheet& wanted, SetupEdits made) {
    if (!are_equal(shown.stock, wanted.stock)) made.stock = wanted.stock;
    if (shown.allowance != wanted.allowance) made.allowance = wanted.allowance;
    for (size_t i = 0; i < std::min(shown.tools.size(), wanted.tools.size()); ++i) {
        const core::ToolDescription& tool = wanted.tools[i].tool;
        const std::set<std::string> keys = differing_keys(shown.tools[i].tool, tool);
        if (keys.empty()) continue;
        StatedTool& stated = made.tools[tool.number];
        stated.tool = tool;
        stated.stated.insert(keys.begin(), keys.end());
    }
    if (!made.tools.empty() && !made.tool_at_start) made.tool_at_start = shown.tool_at_start;
    return made;
}

namespace {

using core::ToolDescription;
using core::ToolShape;
using core::ToolSize;

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

std::vector<ToolSize> fields_of(ToolShape shape) {
    std::vector<ToolSize> fields;
    for (const ToolSize& size : core::tool_sizes())
        if (size.shown.contains(shape)) fields.push_back(size);
    std::stable_sort(fields.begin(), fields.end(),
                     [](const ToolSize& a, const ToolSize& b) { return a.group < b.group; });
    return fields;
}

std::vector<ToolShape> stateable_shapes() {
    std::vector<ToolShape> shapes;
    for (const core::ToolShapeEntry& entry : core::tool_shapes())
        if (entry.shape != ToolShape::profile) shapes.push_back(entry.shape);
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
    for (const ToolSize& size : core::tool_sizes())
        if (!size.shapes.contains(ToolShape::profile)) // a profile has only the sizes of all shapes
            size.put(tool, std::nullopt);
    tool.teeth.reset();
    tool.outline.clear();
    tool.shape = shape;
    for (const ToolSize& size : fields_of(shape)) size.put(tool, size.of(before));
    FoundTool found{.tool = tool, .has_shape = true};
    const ToolDescription completed = complete(found).tool;
    if (core::assemble(completed)) return completed;
    // Lengths of the old shape do not suit the new one.
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
