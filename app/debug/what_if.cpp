#include "app/debug/what_if.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/check/run_state.h"
#include "app/debug/inspected_value.h"
#include "core/base/text.h"
#include "core/sim/clearance.h"
#include "core/sim/leg/check_memory.h"
#include "core/sim/setup.h"
#include "core/sim/tool_assembly.h"

namespace app {
namespace {

using core::ErrorCode;

/// Drops bounds that are carried from block to block: they hold for the old bodies only. Keeps the
/// cuts into fixtures.
void forget_bounds(core::SimulatorState& machine) {
    core::CheckMemory& memory = machine.memory;
    memory.bounds.clear();
    memory.deciding.reset();
    memory.margin = 0.0;
    memory.hints = {};
    memory.near_places = {};
    memory.cutters.clear();
    memory.turning_parts.clear();
}

std::string numbers_of(const auto& map) {
    std::string text;
    for (const auto& [number, entry] : map)
        text += fmt::format("{}T{}", text.empty() ? "" : ", ", core::value_of(number));
    return text;
}

core::Result<void> check_number(double value, const std::string& of) {
    if (std::isfinite(value)) return {};
    return core::fail(ErrorCode::invalid_value, fmt::format("{}: the value is not a number", of));
}

core::Result<void> change(const ToolLengthChange& change, core::Setup& setup, RunState& state) {
    const auto found = setup.tools.find(change.tool);
    if (found == setup.tools.end())
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("the set-up has no tool T{}{}", core::value_of(change.tool),
                                      setup.tools.empty() ? "; it has no tools"
                                                          : "; it has " + numbers_of(setup.tools)));
    FEELER_TRY(core::ToolAssembly tool, stretched(found->second, change.length));
    found->second = std::move(tool);
    // The required height of its holder was computed for the old tool.
    state.machine.rules.reaches.erase(change.tool);
    forget_bounds(state.machine);
    if (state.machine.tool == change.tool)
        track_changed_length(state.lengths, setup, state.machine);
    return {};
}

/// Fails if the control has read ahead, so that its position differs from that of the machine.
core::Result<void> check_that_nothing_waits(const RunState& state) {
    if (!has_pending_blocks(state.control)) return {};
    return core::fail(ErrorCode::unsupported,
                      "the control reads ahead here, for cutter radius compensation or a "
                      "corner: change the offset before G41 or G42, or after G40");
}

/// Activates other offsets. The machine does not move.
void use(const gcode::Offsets& offsets, RunState& state) {
    gcode::change_offsets(state.control.modal, offsets);
    state.lowering.offsets.work = offsets.work;
    state.lowering.offsets.tool = offsets.tool;
}

/// The axis along which the active length acts: Z after G43, else the tool axis at the tool call.
size_t length_axis(const gcode::ModalState& modal) {
    if (modal.length_sign != 0.0) return 2;
    for (size_t axis = 0; axis < 3; ++axis)
        if (modal.offsets.tool[axis] != 0.0) return axis;
    return gcode::axes_of(modal.plane).normal;
}

/// The offsets with the active length replaced. Keeps what was added to it.
gcode::Offsets with_length(const gcode::ModalState& modal, double before, double length) {
    gcode::Offsets offsets = modal.offsets;
    const double sign = modal.length_sign != 0.0 ? modal.length_sign : 1.0;
    double& counted = offsets.tool[length_axis(modal)];
    counted = counted == sign * before ? sign * length : counted + sign * (length - before);
    return offsets;
}

core::Result<void> change(const LengthOffsetOverride& change, core::Setup& setup, RunState& state) {
    const int number = core::value_of(change.number);
    if (number <= 0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("there is no length offset H{}: they count from 1", number));
    if (auto wrong = check_number(change.length, fmt::format("H{}", number)); !wrong) return wrong;
    const gcode::ModalState& modal = state.control.modal;
    const bool is_on = modal.length_number == change.number;
    if (is_on)
        if (auto waits = check_that_nothing_waits(state); !waits) return waits;
    const double before = gcode::length_under(*state.control.tables, number).value_or(0.0);
    gcode::LengthOffset& entry = state.control.tables.write().lengths[change.number];
    entry.length = change.length;
    entry.wear = 0.0;
    if (!is_on) return {};
    const gcode::Offsets offsets = with_length(modal, before, change.length);
    core::LengthOffsetChange& counted = state.machine.length_offset;
    if (counted.number == change.number) {
        counted.length += change.length - before;
        counted.is_assumed = false;
    }
    use(offsets, state);
    track_changed_length(state.lengths, setup, state.machine);
    return {};
}

core::Result<void> change(const WorkOffsetChange& change, core::Setup& setup, RunState& state) {
    if (change.index >= gcode::work_offset_count)
        return core::fail(ErrorCode::invalid_value, "there is no such work offset");
    if (change.axis >= gcode::axis_count || !setup.machine.axes[change.axis].present)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: the machine of the set-up has no such axis",
                                      change.axis < gcode::axis_count
                                          ? std::string(1, gcode::axis_letters[change.axis])
                                          : fmt::format("axis {}", change.axis)));
    if (auto wrong = check_number(change.origin, offset_name(change.index)); !wrong) return wrong;
    const bool is_on = state.control.modal.offsets.active == change.index;
    if (is_on)
        if (auto waits = check_that_nothing_waits(state); !waits) return waits;
    gcode::Tables& tables = state.control.tables.write();
    gcode::writable_work_offset(tables, change.index).origin[change.axis] = change.origin;
    // The heights of feed moves were relative to the old origin.
    state.offsets.erase(change.index);
    if (!is_on) return {};
    gcode::Offsets offsets = state.control.modal.offsets;
    offsets.work.origin[change.axis] = change.origin + tables.external[change.axis];
    use(offsets, state);
    return {};
}

core::Result<void> change(const AllowanceChange& change, core::Setup& setup, RunState& state) {
    if (change.distance && !(*change.distance >= 0.0 && *change.distance <= 1000.0))
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{} is not a valid minimum clearance: it must be from 0 to 1000 mm",
                        number_text(*change.distance)));
    setup.allowance = change.distance;
    setup.search_limit = core::search_limit_of(setup);
    forget_bounds(state.machine);
    return {};
}

/// The mounted fixture of this name. A fixture that the program moves has several entries.
core::Result<size_t> fixture_named(const core::Setup& setup, const std::vector<bool>& are_there,
                                   const std::string& name) {
    std::vector<std::string> names;
    for (size_t i = 0; i < setup.fixtures.size(); ++i) {
        if (setup.fixtures[i].is_machine) continue;
        if (setup.fixtures[i].name == name && are_there[i]) return i;
        names.push_back(setup.fixtures[i].name);
    }
    if (std::find(names.begin(), names.end(), name) != names.end())
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{} was removed from the machine before this block", name));
    if (names.empty())
        return core::fail(ErrorCode::invalid_value, "the set-up has no fixture that can be moved");
    return core::fail(ErrorCode::invalid_value,
                      names.size() > 12
                          ? fmt::format("there is no fixture '{}'; the nearest name is '{}'", name,
                                        core::nearest_name(name, names))
                          : fmt::format("there is no fixture '{}'; there {} {}", name,
                                        names.size() == 1 ? "is" : "are", fmt::join(names, ", ")));
}

core::Result<void> change(const MovedFixture& change, core::Setup& setup, RunState& state) {
    FEELER_TRY(const size_t index,
               fixture_named(setup, state.machine.mounted_fixtures, change.name));
    for (int axis = 0; axis < 3; ++axis)
        if (auto wrong = check_number(change.by[axis], change.name); !wrong) return wrong;
    core::Transform& link_from_body = setup.fixtures[index].mount.link_from_body;
    link_from_body =
        core::translation(setup.stock_mount.link_from_body.rotation * change.by) * link_from_body;
    // Cuts into the fixture were made at its old position.
    state.machine.memory.cuts.erase(index);
    forget_bounds(state.machine);
    return {};
}

std::string text(const ToolLengthChange& change) {
    return fmt::format("T{} is {} mm long", core::value_of(change.tool),
                       number_text(change.length));
}

std::string text(const LengthOffsetOverride& change) {
    return fmt::format("H{} is {} mm", core::value_of(change.number), number_text(change.length));
}

std::string text(const WorkOffsetChange& change) {
    return fmt::format("{} has its origin at {}{}", offset_name(change.index),
                       gcode::axis_letters[change.axis], number_text(change.origin));
}

std::string text(const AllowanceChange& change) {
    if (!change.distance) return "the minimum clearances are the default ones";
    return fmt::format("the minimum clearance is {} mm", number_text(*change.distance));
}

std::string text(const MovedFixture& change) {
    std::string way;
    for (int axis = 0; axis < 3; ++axis)
        if (change.by[axis] != 0.0)
            way += fmt::format("{}{} mm along {}", way.empty() ? "" : ", ",
                               number_text(change.by[axis]), "XYZ"[axis]);
    return fmt::format("{} is moved by {}", change.name, way.empty() ? "nothing" : way);
}

} // namespace

std::string text_of(const WhatIf& change) {
    return std::visit([](const auto& one) { return text(one); }, change);
}

core::Result<void> apply(const WhatIf& what, core::Setup& setup, RunState& state) {
    return std::visit([&](const auto& one) { return change(one, setup, state); }, what);
}

namespace {

using core::ConeStep;

constexpr double least_step = 1e-9; // mm; anything shorter is a rounding error

/// Removes the upper end of a shank.
void shorten(std::vector<ConeStep>& shank, double by) {
    while (by > least_step) {
        ConeStep& top = shank.back();
        if (top.length <= by + least_step) {
            by -= top.length;
            shank.pop_back();
            continue;
        }
        const double left = (top.length - by) / top.length;
        top.upper_diameter = top.lower_diameter + left * (top.upper_diameter - top.lower_diameter);
        top.length -= by;
        by = 0.0;
    }
}

/// Lengthens the visible shank. Without a visible shank, increases the stick-out.
core::Result<void> lengthen(core::ToolDescription& tool, double by) {
    std::vector<ConeStep>& shank = tool.shank;
    if (shank.empty()) {
        FEELER_TRY(const core::ToolHead head, core::tool_head(tool));
        tool.stick_out = head.length + by;
        return {};
    }
    const ConeStep top = shank.back();
    if (top.lower_diameter == top.upper_diameter)
        shank.back().length += by;
    else
        shank.push_back({top.upper_diameter, top.upper_diameter, by});
    return {};
}

void add(std::optional<double>& length, double by) {
    if (length) *length += by;
}

} // namespace

core::Result<core::ToolAssembly> stretched(const core::ToolAssembly& tool, double length) {
    const int number = core::value_of(tool.description.number);
    if (!std::isfinite(length) || !(length > 0.0))
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("T{}: the length must be a number above 0", number));
    const double by = length - tool.length;
    if (std::abs(by) <= least_step) return tool;
    core::ToolDescription description = tool.description;
    add(description.gauge_length, by);
    add(description.touched_off, by);
    const bool has_holder = !description.holder.empty();
    if (!has_holder && !description.stick_out && description.gauge_length)
        return core::assemble(description);
    const double shank = core::total_length(description.shank);
    if (-by > shank + least_step)
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("T{} can be no shorter than {} mm: {}", number,
                                      number_text(tool.length - shank),
                                      has_holder ? "there the holder reaches the flutes"
                                                 : "there only the flutes are left"));
    add(description.stick_out, by);
    if (by < 0.0)
        shorten(description.shank, -by);
    else if (auto done = lengthen(description, by); !done)
        return tl::unexpected(done.error());
    return core::assemble(description);
}

} // namespace app
