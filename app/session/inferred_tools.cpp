#include "app/session/inferred_tools.h"

#include <fmt/format.h>

#include "app/tools/program_tools.h"
#include "app/tools/tool_library.h"

namespace app {
namespace {

using core::ToolNumber;

/// The size of a tool of which nothing is known.
double usual_diameter(gcode::LengthUnit unit) {
    return unit == gcode::LengthUnit::inch ? 6.35 : 6.0;
}

void put_in_place(SetupFile& file, core::ToolDescription tool, const std::string& assumed) {
    tool.touched_off = file.is_inferred;
    // The control's table knows how long it is, if it knows the tool.
    const auto entry =
        file.environment.length_offsets.find(core::OffsetNumber{core::value_of(tool.number)});
    if (!file.is_inferred && entry != file.environment.length_offsets.end() && !tool.gauge_length
        && entry->second.length > tool.stick_out.value_or(0.0))
        tool.gauge_length = entry->second.length;
    auto assembled = core::assemble(tool);
    if (!assembled) { // sizes that contradict each other: the plainest tool of that width
        file.assumptions.push_back(
            fmt::format("{}; it is taken as a flat end mill", assembled.error().message));
        core::ToolDescription plain;
        plain.number = tool.number;
        plain.diameter = tool.diameter;
        plain.touched_off = tool.touched_off;
        assembled = core::assemble(complete({plain, true, true, "what is left of it"}).tool);
        if (!assembled) return;
    }
    file.assumptions.push_back(assumed);
    file.environment.tool_lengths[tool.number] = assembled->length;
    file.environment.tool_diameters[tool.number] = assembled->description.diameter;
    file.setup.tools.insert_or_assign(tool.number, *std::move(assembled));
}

} // namespace

core::Result<OfferedTools> offered_tools(const SetupFile& file, const gcode::Program& program) {
    OfferedTools offered;
    offered.tools = file.library;
    ProgramTools named =
        tools_of_program(program, unit_of_program(program, file.environment.machine_unit));
    offered.tools.merge(named.tools);
    offered.in_spindle = std::move(named.in_spindle);
    if (!file.tool_table.empty()) {
        FEELER_TRY(auto table, read_tool_library(file.tool_table, file.environment.machine_unit));
        offered.tools.merge(table);
    }
    return offered;
}

void add_tool(SetupFile& file, const FoundTool& found) {
    const CompleteTool whole = complete(found);
    put_in_place(file, whole.tool, whole.assumed);
}

void add_unknown_tool(SetupFile& file, ToolNumber number, bool mills, gcode::LengthUnit unit) {
    FoundTool guess;
    guess.tool.number = number;
    guess.tool.shape = mills ? core::ToolShape::flat : core::ToolShape::drill;
    guess.tool.diameter = usual_diameter(unit);
    guess.has_shape = true;
    const CompleteTool whole = complete(guess);
    put_in_place(file, whole.tool,
                 fmt::format("nothing is said about tool {}: it is taken as a {} of {:g} mm, "
                             "because it {}",
                             core::value_of(number), mills ? "flat end mill" : "drill",
                             guess.tool.diameter,
                             mills ? "cuts sideways" : "only goes up and down"));
}

} // namespace app
