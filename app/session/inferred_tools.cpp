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

/// The plainest tool of that width, when the sizes that were found contradict each other.
core::ToolAssembly plain_tool(const core::ToolDescription& tool) {
    FoundTool plain;
    plain.tool.number = tool.number;
    plain.tool.diameter = tool.diameter;
    plain.tool.touched_off = tool.touched_off;
    const auto assembled = core::assemble(complete(plain).tool);
    return assembled ? *assembled : core::ToolAssembly{.description = plain.tool, .parts = {}};
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

FoundTool unknown_tool(ToolNumber number, bool mills, gcode::LengthUnit unit) {
    FoundTool guess;
    guess.tool.number = number;
    guess.tool.shape = mills ? core::ToolShape::flat : core::ToolShape::drill;
    guess.tool.diameter = usual_diameter(unit);
    guess.has_shape = true;
    guess.source = fmt::format("its use alone: it {}, and nothing is said about it",
                               mills ? "cuts sideways" : "only goes up and down");
    return guess;
}

std::string put_tool(SetupFile& file, const FoundTool& found, double least_flutes,
                     double control_length) {
    CompleteTool whole = complete(found, least_flutes);
    core::ToolDescription& tool = whole.tool;
    if (file.is_inferred) tool.touched_off = control_length;
    // The control's table knows how long a tool is, if it knows it at all.
    const auto entry =
        file.environment.length_offsets.find(core::OffsetNumber{core::value_of(tool.number)});
    const bool longer = entry != file.environment.length_offsets.end()
                        && entry->second.length > tool.stick_out.value_or(0.0);
    if (!file.is_inferred && longer && !tool.gauge_length) tool.gauge_length = entry->second.length;
    auto assembled = core::assemble(tool);
    if (!assembled) {
        whole.assumed = fmt::format("{}; it is taken as a flat end mill of {:g} mm",
                                    assembled.error().message, tool.diameter);
        assembled = plain_tool(tool);
    }
    file.environment.tool_lengths[tool.number] = assembled->length;
    file.environment.tool_diameters[tool.number] = assembled->description.diameter;
    file.setup.tools.insert_or_assign(tool.number, *std::move(assembled));
    return whole.assumed;
}

} // namespace app
