#include "app/tolerance/deviation.h"

#include <fmt/format.h>

#include "core/sim/setup.h"
#include "gcode/language/canonical.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

core::Vec3 along(int axis, double by) {
    core::Vec3 v(0.0);
    v[axis] = by;
    return v;
}

/// Changes the length of a tool in the control, in all entries that the program uses for it.
void change_length(gcode::Environment& environment, const Deviation& deviation, double by) {
    for (const core::OffsetNumber number : deviation.numbers) {
        const auto entry = environment.length_offsets.find(number);
        if (entry != environment.length_offsets.end()) {
            entry->second.length += by;
            continue;
        }
        const auto tool = environment.tool_lengths.find(core::ToolNumber{core::value_of(number)});
        if (tool != environment.tool_lengths.end()) tool->second += by;
    }
}

core::Result<core::ToolAssembly> with_stick_out(const core::ToolAssembly& tool, double by) {
    core::ToolDescription longer = tool.description;
    if (by > 0.0 && !longer.holder.empty()) {
        const double widest = longer.holder.front().lower_diameter;
        const double wide = longer.shank.empty() ? std::min(longer.diameter, widest)
                                                 : longer.shank.back().upper_diameter;
        longer.shank.push_back({wide, wide, by});
    }
    for (double left = -by; left > 0.0 && !longer.shank.empty();) {
        core::ConeStep& top = longer.shank.back();
        if (top.length > left) {
            const double part = 1.0 - left / top.length;
            top.upper_diameter =
                top.lower_diameter + part * (top.upper_diameter - top.lower_diameter);
            top.length -= left;
            break;
        }
        left -= top.length;
        longer.shank.pop_back();
    }
    if (longer.stick_out) *longer.stick_out += by;
    if (longer.gauge_length) *longer.gauge_length += by;
    if (longer.touched_off) *longer.touched_off += by;
    return core::assemble(longer);
}

} // namespace

const char* name_of(Quantity quantity) {
    switch (quantity) {
    case Quantity::work_offset:
        return "work offset";
    case Quantity::stock:
        return "stock";
    case Quantity::fixture:
        return "fixture";
    case Quantity::tool_length:
        return "tool length";
    case Quantity::stick_out:
        return "stick-out";
    default:
        return "tool diameter";
    }
}

std::string Deviation::subject() const {
    switch (quantity) {
    case Quantity::work_offset:
        return gcode::name_of_offset(offset);
    case Quantity::stock:
        return "stock";
    case Quantity::fixture:
        return fixture;
    default:
        return fmt::format("tool {}", core::value_of(tool));
    }
}

core::Result<core::ToolAssembly> with_diameter(const core::ToolAssembly& tool, double by) {
    core::ToolDescription wider = tool.description;
    wider.diameter += by;
    if (wider.shape == core::ToolShape::ball) wider.corner_radius.reset(); // half the diameter
    wider.holder.clear(); // only the flutes are used
    wider.gauge_length.reset();
    wider.touched_off.reset();
    FEELER_TRY(const core::ToolAssembly made, core::assemble(wider));
    core::ToolAssembly result = tool;
    result.parts[0] = made.parts[0];
    return result;
}

bool grows_with_diameter(const core::ToolAssembly& tool) {
    switch (tool.description.shape) {
    case core::ToolShape::flat:
    case core::ToolShape::ball:
    case core::ToolShape::bull:
    case core::ToolShape::drill:
        return !tool.parts.empty();
    default:
        return false;
    }
}

core::Result<void> deviate(const StatedWorld& world, const Deviation& deviation, double by) {
    core::Setup& setup = world.setup;
    switch (deviation.quantity) {
    case Quantity::work_offset:
        world.environment.writable_work_offset(
            deviation.offset)[static_cast<size_t>(deviation.axis)] += by;
        break;
    case Quantity::stock:
        setup.stock_mount.link_from_body.translation += along(deviation.axis, by);
        break;
    case Quantity::fixture:
        for (core::Fixture& fixture : setup.fixtures)
            if (fixture.name == deviation.fixture)
                fixture.mount.link_from_body.translation += along(deviation.axis, by);
        break;
    case Quantity::tool_length:
        change_length(world.environment, deviation, by);
        break;
    case Quantity::stick_out: {
        core::ToolAssembly& tool = setup.tools.at(deviation.tool);
        FEELER_TRY(tool, with_stick_out(tool, by));
        change_length(world.environment, deviation, by);
        break;
    }
    case Quantity::tool_diameter: {
        core::ToolAssembly& tool = setup.tools.at(deviation.tool);
        FEELER_TRY(tool, with_diameter(tool, by));
        break;
    }
    }
    return {};
}

} // namespace app
