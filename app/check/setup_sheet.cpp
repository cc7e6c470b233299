#include "app/check/setup_sheet.h"

#include <algorithm>
#include <array>

#include "app/setup/coverage.h"
#include "app/setup/holders/holder_preset.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "core/sim/setup.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

SheetTool sheet_tool(const SetupFile& file, const core::ToolAssembly& tool) {
    SheetTool shown;
    shown.tool = editable(tool.description);
    const core::ToolNumber number = tool.description.number;
    if (const auto why = file.inferred_tools.find(number); why != file.inferred_tools.end())
        shown.why = why->second;
    if (file.is_inferred || !shown.why.empty()) shown.source = SetupSource::assumed;
    if (const auto found = file.found_tools.find(number); found != file.found_tools.end())
        shown.is_guess = !found->second.is_described;
    const auto partial = file.partial_tools.find(number);
    if (partial != file.partial_tools.end()) {
        shown.stated = partial->second.stated;
        // It is used in another way.
        if (partial->second.tool.shape != shown.tool.shape) shown.stated.erase("shape");
    }
    return shown;
}

/// A tool that the program uses and the set-up lacks.
SheetTool missing_tool(core::ToolNumber number) {
    SheetTool missing{.source = SetupSource::assumed, .is_described = false};
    missing.tool.number = number;
    return missing;
}

std::vector<SheetOffset> sheet_offsets(const SetupFile& file) {
    std::set<size_t> shown(file.offsets_used.begin(), file.offsets_used.end());
    for (const int index : file.offsets_set) shown.insert(static_cast<size_t>(index));
    if (shown.empty()) shown.insert(0);
    std::vector<SheetOffset> offsets;
    for (const size_t index : shown) {
        const gcode::AxisValues& origin = file.environment.work_offset(index);
        const bool is_stated = file.offsets_set.contains(static_cast<int>(index))
                               || (!file.environment.parameters.empty() && !file.infers_frame);
        offsets.push_back({gcode::name_of_offset(index),
                           {origin[0], origin[1], origin[2]},
                           is_stated && !file.assumed.contains("offsets") ? SetupSource::stated
                                                                          : SetupSource::assumed,
                           file.offsets_used.contains(index),
                           offset_name(file, index)});
    }
    return offsets;
}

} // namespace

const char* name_of(SetupSource source) {
    switch (source) {
    case SetupSource::stated:
        return "stated";
    case SetupSource::assumed:
        return "assumed";
    case SetupSource::usual:
        return "default";
    }
    return "";
}

const SheetTool* SetupSheet::tool(core::ToolNumber number) const {
    const auto found = std::find_if(tools.begin(), tools.end(), [&](const SheetTool& one) {
        return one.tool.number == number;
    });
    return found == tools.end() ? nullptr : &*found;
}

const SheetOffset* SetupSheet::offset(const std::string& name) const {
    const auto found = std::find_if(offsets.begin(), offsets.end(),
                                    [&](const SheetOffset& one) { return one.name == name; });
    return found == offsets.end() ? nullptr : &*found;
}

SetupSheet sheet_of(const SetupFile& file, const core::Setup& setup) {
    SetupSheet sheet;
    sheet.path = file.path;
    sheet.frame = file.needs_stock ? stock_frame(file) : file.stock_frame;
    sheet.stock = setup.stock;
    sheet.stock_why = file.stock_comment.empty() ? file.inferred_stock : file.stock_comment;
    const bool is_assumed = file.needs_stock || file.assumed.contains("stock");
    if (is_assumed) sheet.stock_source = SetupSource::assumed;
    for (const auto& [number, tool] : setup.tools) sheet.tools.push_back(sheet_tool(file, tool));
    for (const core::ToolNumber number : file.tools_used)
        if (!setup.tools.contains(number)) sheet.tools.push_back(missing_tool(number));
    std::sort(sheet.tools.begin(), sheet.tools.end(),
              [](const SheetTool& a, const SheetTool& b) { return a.tool.number < b.tool.number; });
    for (const auto& [number, found] : file.library) sheet.library.push_back(found);
    sheet.offsets = sheet_offsets(file);
    sheet.allowance = setup.allowance;
    const core::Transform stock_from_machine = setup.stock_mount.link_from_body.inverse();
    for (const auto& [name, pose] : file.frames)
        sheet.frames.emplace(name, stock_from_machine * pose);
    sheet.cad_names = file.cad_names;
    sheet.knows_fixtures = file.fixtures_known != Known::missing;
    sheet.has_machine = file.has_axes;
    return sheet;
}

namespace {

using core::ToolDescription;
using core::ToolShape;
using core::ToolSize;

bool is_cylinder(const std::vector<core::ConeStep>& steps) {
    return steps.size() == 1 && steps[0].lower_diameter == steps[0].upper_diameter;
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
    return name_of_holder(tool.holder);
}

} // namespace app
