#include "app/setup/tool_table.h"

#include <fmt/format.h>

#include "app/setup/tool_holder.h"
#include "core/sim/centre_watch.h"

namespace app {
namespace {

void read_shape(TableReader& table, core::ToolDescription& tool) {
    const auto shape =
        table.word("shape", {"flat", "ball", "bull", "drill", "taper", "chamfer", "profile",
                             "tslot", "dovetail", "lollipop", "threadmill"});
    if (!shape) return table.need("shape");
    tool.shape = *core::tool_shape_named(*shape);
    tool.diameter = table.number_or("diameter", 0.0);
    tool.flute_length = table.number_or("flute_length", 0.0);
    tool.corner_radius = table.number("corner_radius");
    tool.point_deg = table.number("point_deg");
    tool.angle_deg = table.number("angle_deg");
    tool.tip_diameter = table.number_or("tip_diameter", 0.0);
    tool.neck_diameter = table.number("neck_diameter");
    tool.neck_length = table.number("neck_length");
    tool.pitch = table.number("pitch");
    tool.teeth = table.integer("teeth");
    tool.thread_deg = table.number("thread_deg");
    for (const std::vector<double>& row : table.rows("profile", 2))
        tool.outline.push_back({row[0], row[1]});
}

/// The share of the diameter that an end mill leaves standing when it cannot plunge and nobody says
/// how much it is.
constexpr double usual_centre = 0.5;

void read_centre(TableReader& table, core::ToolDescription& tool) {
    tool.cuts_at_centre = table.boolean("cuts_at_centre").value_or(true);
    const auto diameter = table.number("centre_diameter");
    if (diameter && tool.cuts_at_centre)
        table.refuse("centre_diameter", "is for tools with cuts_at_centre = false");
    if (!tool.cuts_at_centre)
        tool.centre_radius = 0.5 * diameter.value_or(usual_centre * tool.diameter);
}

} // namespace

std::vector<std::string> notes_on(const core::ToolDescription& tool) {
    std::vector<std::string> notes;
    const int number = core::value_of(tool.number);
    if (tool.holder.empty())
        notes.push_back(fmt::format(
            "tool {} has no holder in the set-up: only what is described is checked", number));
    if (!tool.cuts_at_centre)
        notes.push_back(
            fmt::format("tool {} does not cut within {:g} mm of its axis, where its face "
                        "is taken to stand back by {:.3g} mm",
                        number, tool.centre_radius, core::centre_recess(tool)));
    if (tool.shape == core::ToolShape::threadmill && !tool.pitch)
        notes.push_back(fmt::format("tool {} has no pitch: it cuts as the cylinder round its "
                                    "crests, so the threads are gone after it",
                                    number));
    return notes;
}

void read_tool(TableReader& table, BodyContext& context) {
    SetupFile& file = context.file;
    core::ToolDescription tool;
    const auto number = table.integer("number");
    if (!number) return table.need("number");
    tool.number = core::ToolNumber{*number};
    tool.name = table.string("name").value_or("");
    read_shape(table, tool);
    tool.shank = read_steps(table, "shank");
    tool.shank_diameter = table.number("shank_diameter");
    tool.stick_out = table.number("stick_out");
    tool.gauge_length = table.number("gauge_length");
    tool.touched_off = table.number("touched_off");
    read_holder(table, context, tool);
    const auto spindle = table.word("spindle", {"clockwise", "counterclockwise"});
    tool.cuts = spindle == "counterclockwise" ? core::SpindleDirection::counterclockwise
                                              : core::SpindleDirection::clockwise;
    read_centre(table, tool);
    table.finish();

    const auto assembled = core::assemble(tool);
    if (!assembled) return table.refuse_whole(assembled.error().message);
    if (!file.setup.tools.emplace(tool.number, *assembled).second)
        table.refuse("number", fmt::format("= {} is there twice", *number));
    file.environment.tool_lengths[tool.number] = assembled->length;
    file.environment.tool_diameters[tool.number] = assembled->description.diameter;
    for (std::string& note : notes_on(tool)) file.assumptions.push_back(std::move(note));
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
