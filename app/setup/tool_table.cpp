#include "app/setup/tool_table.h"

#include <fmt/format.h>

namespace app {
namespace {

using core::ToolShape;

std::optional<ToolShape> shape_named(const std::string& name) {
    static const std::map<std::string, ToolShape> shapes = {
        {"flat", ToolShape::flat},      {"ball", ToolShape::ball},
        {"bull", ToolShape::bull},      {"drill", ToolShape::drill},
        {"taper", ToolShape::taper},    {"chamfer", ToolShape::chamfer},
        {"profile", ToolShape::profile}};
    const auto found = shapes.find(name);
    if (found == shapes.end()) return std::nullopt;
    return found->second;
}

std::vector<core::ConeStep> cones(TableReader& table, const char* key) {
    std::vector<core::ConeStep> steps;
    for (const std::vector<double>& row : table.rows(key, 3))
        steps.push_back({row[0], row[1], row[2]});
    return steps;
}

void read_shape(TableReader& table, core::ToolDescription& tool) {
    const auto shape =
        table.word("shape", {"flat", "ball", "bull", "drill", "taper", "chamfer", "profile",
                             "tslot", "dovetail", "lollipop", "threadmill"});
    if (!shape) return table.need("shape");
    const auto known = shape_named(*shape);
    if (!known)
        return table.refuse("shape", fmt::format("\"{}\" is not supported by this version; give "
                                                 "the outline as a profile instead",
                                                 *shape));
    tool.shape = *known;
    tool.diameter = table.number_or("diameter", 0.0);
    tool.flute_length = table.number_or("flute_length", 0.0);
    tool.corner_radius = table.number("corner_radius");
    tool.point_deg = table.number("point_deg");
    tool.angle_deg = table.number("angle_deg");
    tool.tip_diameter = table.number_or("tip_diameter", 0.0);
    for (const std::vector<double>& row : table.rows("profile", 2))
        tool.outline.push_back({row[0], row[1]});
}

} // namespace

void read_tool(TableReader& table, SetupFile& file) {
    core::ToolDescription tool;
    const auto number = table.integer("number");
    if (!number) return table.need("number");
    tool.number = core::ToolNumber{*number};
    tool.name = table.string("name").value_or("");
    read_shape(table, tool);
    tool.shank = cones(table, "shank");
    tool.holder = cones(table, "holder");
    const auto spindle = table.word("spindle", {"clockwise", "counterclockwise"});
    tool.cuts = spindle == "counterclockwise" ? core::SpindleDirection::counterclockwise
                                              : core::SpindleDirection::clockwise;
    tool.cuts_at_centre = table.boolean("cuts_at_centre").value_or(true);
    table.finish();

    const auto assembled = core::assemble(tool);
    if (!assembled) return table.refuse_whole(assembled.error().message);
    if (!file.setup.tools.emplace(tool.number, *assembled).second)
        table.refuse("number", fmt::format("= {} is there twice", *number));
    file.environment.tool_lengths[tool.number] = assembled->length;
    if (tool.diameter > 0.0) file.environment.tool_diameters[tool.number] = tool.diameter;
    if (tool.holder.empty())
        file.assumptions.push_back(fmt::format(
            "tool {} has no holder in the set-up: only what is described is checked", *number));
    if (!tool.cuts_at_centre)
        file.assumptions.push_back(fmt::format(
            "tool {} does not cut at its centre; this version cuts as if it did", *number));
}

void read_length_offset(TableReader& table, SetupFile& file) {
    const auto number = table.integer("number");
    if (!number) return table.need("number");
    gcode::LengthOffset offset;
    const auto length = table.number("length");
    if (!length) return table.need("length");
    offset.length = *length;
    offset.wear = table.number_or("wear", 0.0);
    offset.diameter = table.number_or("diameter", 0.0);
    table.finish();
    const core::OffsetNumber key{*number};
    if (!file.lengths_set.insert(key).second)
        table.refuse("number", fmt::format("= {} is there twice", *number));
    file.environment.length_offsets[key] = offset; // a tool table may have had another
}

} // namespace app
