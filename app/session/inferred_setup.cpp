#include "app/session/inferred_setup.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/session/inferred_tools.h"
#include "app/session/program_survey.h"
#include "app/tools/program_tools.h"

namespace app {
namespace {

using core::Aabb;
using core::ToolNumber;
using core::Vec3;

constexpr double zero_above_program = 500.0; // mm, of the machine
constexpr double below_the_cuts = 2.0;       // mm of stock under the deepest cut
constexpr double smallest_height = 1.0;

/// Adds the tools that the program uses and the set-up has not.
core::Result<void> complete_tools(SetupFile& file, const gcode::Program& program,
                                  const ProgramSurvey& seen) {
    FEELER_TRY(OfferedTools offered, offered_tools(file, program));
    const gcode::LengthUnit unit = unit_of_program(program, file.environment.machine_unit);
    const auto mills = [&](ToolNumber number) {
        const auto found = seen.mills.find(number);
        return found == seen.mills.end() || found->second;
    };
    std::vector<ToolNumber> wanted = seen.tools;
    const bool only_empties = seen.tools.empty() && seen.empties_spindle;
    if (file.is_inferred && only_empties) wanted.push_back(ToolNumber{0}); // T0 M6, and it cuts
    for (const ToolNumber number : wanted) {
        if (file.setup.tools.contains(number)) continue;
        const auto found = offered.tools.find(number);
        if (found != offered.tools.end())
            add_tool(file, found->second);
        else if (file.is_inferred)
            add_unknown_tool(file, number, mills(number), unit);
    }
    if (seen.calls_tools || !file.setup.tools.empty()) return {};
    if (offered.in_spindle) {
        FoundTool held = *offered.in_spindle;
        if (core::value_of(held.tool.number) == 0) held.tool.number = ToolNumber{1};
        add_tool(file, held);
    } else if (file.is_inferred) {
        add_unknown_tool(file, ToolNumber{1}, mills(ToolNumber{0}), unit);
    }
    return {};
}

SurveyTools sizes(const SetupFile& file, bool calls_tools) {
    SurveyTools known;
    for (const auto& [number, tool] : file.setup.tools) {
        double widest = 0.0;
        for (const core::ToolPart& part : tool.parts)
            if (part.kind == core::PartKind::flutes) widest = core::bounds(part.profile).max.x;
        known.lengths[number] = tool.length;
        known.radii[number] = widest;
    }
    // A motion before any call is one of the only tool there is.
    if (!calls_tools && file.setup.tools.size() == 1) {
        const ToolNumber only = file.setup.tools.begin()->first;
        known.lengths[ToolNumber{0}] = known.lengths[only];
        known.radii[ToolNumber{0}] = known.radii[only];
    }
    return known;
}

/// Where the top of the material lies, and why, in the frame of the stock.
struct Top {
    double z = 0.0;
    std::string why;
};

Top top_of(const ProgramSurvey& seen, double origin) {
    constexpr double near = 2.0, share = 0.25; // how far above zero ramps and leads begin
    const double lowest = seen.lowest - origin;
    if (!seen.cuts_sideways)
        return lowest < 0.0 ? Top{0.0, "at Z0, where cuts go below it"}
                            : Top{lowest + smallest_height, "just above the deepest feed"};
    const double highest = seen.highest_cut - origin;
    const bool at_zero = lowest < 0.0 && highest <= std::max(near, -share * lowest);
    if (at_zero) return {0.0, "at Z0, where cuts go below it"};
    return {highest, "at the highest cut"};
}

core::Result<void> complete_stock(SetupFile& file, const ProgramSurvey& seen) {
    if (!seen.feeds && !file.is_inferred)
        return core::fail(core::ErrorCode::invalid_value,
                          "[stock] is missing, and the program has no cutting move that it could "
                          "be inferred from");
    const Vec3 origin = file.setup.stock_mount.link_from_body.translation;
    const double margin = file.stock_margin.value_or(0.0);
    Aabb box{{-5, -5, -5}, {5, 5, 0}};
    std::string why = "the program cuts nothing, so the stock is a cube of 10 mm at its zero";
    if (seen.feeds) {
        const Top top = top_of(seen, origin.z);
        const Vec3 sides(margin, margin, 0.0);
        box = {seen.cutting.min - origin - sides, seen.cutting.max - origin + sides};
        box.min.z = seen.lowest - origin.z - std::max(margin, below_the_cuts);
        box.max.z = std::max(top.z, box.min.z + smallest_height);
        why = fmt::format("the stock is what the tools reach on cutting moves{}: X {:.3f} to "
                          "{:.3f}, Y {:.3f} to {:.3f}, Z {:.3f} ({:g} mm below the deepest cut) to "
                          "{:.3f} ({})",
                          margin > 0.0 ? fmt::format(" and {:g} mm around", margin) : "", box.min.x,
                          box.max.x, box.min.y, box.max.y, box.min.z,
                          std::max(margin, below_the_cuts), box.max.z, top.why);
    }
    const double tolerance = file.setup.stock.tolerance;
    file.setup.stock = {core::SolidBox{box}, tolerance};
    file.assumptions.push_back(why);
    return {};
}

/// Large stocks take a coarser model, so that its memory stays that of an ordinary one.
void choose_mesh_size(SetupFile& file) {
    constexpr double cells = 600.0, finest = 0.5;
    const auto* box = std::get_if<core::SolidBox>(&file.setup.stock.shape);
    if (!file.is_inferred || !box) return;
    const Vec3 size = box->box.size();
    const double longest = std::max({size.x, size.y, size.z});
    file.setup.mesh_size = std::max(finest, std::ceil(10.0 * longest / cells) / 10.0);
}

} // namespace

core::Result<SetupFile> bare_setup(const ProgramSettings& settings) {
    SetupFile file;
    file.is_inferred = file.needs_stock = true;
    FEELER_TRY(const std::vector<std::string> notes, apply(settings, file.environment));
    file.dialect = settings.dialect;
    file.tool_table = settings.tool_table;
    for (gcode::AxisValues& offset : file.environment.work_offsets)
        offset = {0.0, 0.0, -zero_above_program};
    file.setup.stock_mount.link_from_body = core::translation({0.0, 0.0, -zero_above_program});
    for (size_t axis = 0; axis < 3; ++axis)
        if (!file.environment.start[axis]) file.environment.start[axis] = 0.0;
    file.assumptions = notes;
    file.assumptions.push_back(
        fmt::format("no set-up: no fixtures, no limits of axes; all work offsets are at one place, "
                    "and the machine's zero, where it starts, is {:g} mm above it",
                    zero_above_program));
    file.assumptions.push_back("every tool was touched off: the control knows its true length");
    return file;
}

core::Result<void> complete_setup(SetupFile& file, const gcode::Program& program) {
    const ProgramSurvey first = survey(program, file.environment, sizes(file, true));
    if (auto wrong = complete_tools(file, program, first); !wrong) return wrong;
    if (file.is_inferred && !first.turns_spindle) {
        file.setup.spindle_at_start = core::SpindleDirection::clockwise;
        file.assumptions.push_back(
            "the program never starts the spindle: it is switched on by hand");
    }
    if (!file.needs_stock) return {};
    const ProgramSurvey seen = survey(program, file.environment, sizes(file, first.calls_tools));
    if (auto wrong = complete_stock(file, seen); !wrong) return wrong;
    choose_mesh_size(file);
    return {};
}

} // namespace app
