#include "app/setup/machine_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/sim/allowance.h"

namespace app {
namespace {

using core::LinkId;

/// Axes in the order in which a file lists them, and what it says they stand on.
struct AxisList {
    std::vector<size_t> order;
    std::array<std::string, core::axis_count> parents;
};

/// A direction must be that of a unit vector.
void read_direction(TableReader& table, core::MachineAxis& axis) {
    const auto direction = table.vector("direction");
    if (!direction) return;
    if (std::abs(glm::length(*direction) - 1.0) > 1e-9)
        table.refuse("direction", "must have length 1, as in [1, 0, 0]");
    axis.direction = *direction;
}

/// What an axis is unless the file says otherwise: along or about X, Y or Z by its letter.
core::MachineAxis plain_axis(size_t index) {
    core::MachineAxis axis;
    axis.direction[static_cast<int>(index % 3)] = 1.0;
    axis.side = core::is_rotary(index) ? core::Side::table : core::Side::tool;
    return axis;
}

void read_range(TableReader& table, core::MachineAxis& axis) {
    axis.min = table.number("min");
    axis.max = table.number("max");
    axis.home = table.number("home");
    axis.rapid = table.number("rapid");
    axis.acceleration = table.number("acceleration");
    if (axis.min && axis.max && *axis.min >= *axis.max) table.refuse("min", "must be below max");
    if (axis.rapid && *axis.rapid <= 0.0) table.refuse("rapid", "must be above 0");
    if (axis.acceleration && *axis.acceleration <= 0.0)
        table.refuse("acceleration", "must be above 0");
}

void read_axis(TableReader& table, core::Machine& machine, AxisList& list) {
    const auto name = table.word("name", {"X", "Y", "Z", "A", "B", "C", "U", "V", "W"});
    if (!name) return table.need("name");
    const size_t index = core::axis_letters.find((*name)[0]);
    if (std::find(list.order.begin(), list.order.end(), index) != list.order.end())
        table.refuse("name", fmt::format("\"{}\" is there twice", *name));
    const bool rotary = core::is_rotary(index);
    if (const auto kind = table.word("kind", {"linear", "rotary"}))
        if ((*kind == "rotary") != rotary)
            table.refuse("kind", fmt::format("= \"{}\": axis {} is {}: A, B and C are the rotary "
                                             "axes, all others are linear",
                                             *kind, *name, rotary ? "rotary" : "linear"));
    core::MachineAxis axis = plain_axis(index);
    if (const auto side = table.word("side", {"tool", "table"}))
        axis.side = *side == "tool" ? core::Side::tool : core::Side::table;
    list.parents[index] = table.string("parent").value_or("");
    read_direction(table, axis);
    if (rotary) {
        axis.point = table.vector("point").value_or(core::Vec3(0.0));
        axis.shortest_way = table.boolean("shortest_way").value_or(false);
    }
    read_range(table, axis);
    machine.axes[index] = axis;
    list.order.push_back(index);
    table.finish();
}

/// The linear axes must span space without tilting it.
void check_directions(TableReader& table, const core::Machine& machine) {
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = i + 1; j < 3; ++j)
            if (std::abs(glm::dot(machine.axes[i].direction, machine.axes[j].direction)) > 1e-9)
                table.refuse("axis", "directions must stand at right angles to each other");
}

/// The link that a text names; empty for one that is no axis of this machine.
std::optional<LinkId> link_named(const core::Machine& machine, const std::string& name) {
    if (name == "base") return LinkId::base;
    const size_t axis = name.size() == 1 ? core::axis_letters.find(name[0]) : std::string::npos;
    if (axis == std::string::npos || !machine.axes[axis].present) return std::nullopt;
    return core::link_of(axis);
}

/// Lets every axis stand on what its `parent` says, else on the axis of its side that was listed
/// before it. X, Y and Z that are not listed move the tool and come first.
void connect(TableReader& table, core::Machine& machine, AxisList list) {
    for (const size_t axis : {size_t{2}, size_t{1}, size_t{0}})
        if (std::find(list.order.begin(), list.order.end(), axis) == list.order.end())
            list.order.insert(list.order.begin(), axis);
    LinkId last[2] = {LinkId::base, LinkId::base};
    std::array<bool, core::axis_count> carries{};
    for (const size_t index : list.order) {
        core::MachineAxis& axis = machine.axes[index];
        axis.carrier = last[static_cast<size_t>(axis.side)];
        if (const std::string& parent = list.parents[index]; !parent.empty()) {
            const auto link = link_named(machine, parent);
            if (!link || *link == core::link_of(index))
                return table.refuse("axis", fmt::format("{}: parent \"{}\" is no other axis of "
                                                        "this machine, nor \"base\"",
                                                        core::axis_letters[index], parent));
            if (*link != LinkId::base && machine.axes[static_cast<size_t>(*link)].side != axis.side)
                return table.refuse("axis", fmt::format("{}: parent \"{}\" is on the other side "
                                                        "of the machine",
                                                        core::axis_letters[index], parent));
            axis.carrier = *link;
        }
        if (axis.carrier != LinkId::base) carries[static_cast<size_t>(axis.carrier)] = true;
        last[static_cast<size_t>(axis.side)] = core::link_of(index);
    }
    machine.spindle = machine.table = LinkId::base;
    for (const size_t index : list.order) {
        LinkId link = core::link_of(index);
        for (size_t steps = 0; link != LinkId::base; ++steps) {
            if (steps > core::axis_count)
                return table.refuse("axis", fmt::format("{}: its parents lead round to itself",
                                                        core::axis_letters[index]));
            link = machine.axes[static_cast<size_t>(link)].carrier;
        }
        if (carries[index]) continue;
        LinkId& end =
            machine.axes[index].side == core::Side::tool ? machine.spindle : machine.table;
        if (end != LinkId::base)
            return table.refuse(
                "axis",
                fmt::format("{} and {} both end the {} side: say with `parent` which of "
                            "them stands on the other",
                            core::axis_letters[static_cast<size_t>(end)], core::axis_letters[index],
                            machine.axes[index].side == core::Side::tool ? "tool" : "table"));
        end = core::link_of(index);
    }
}

/// A `[[body]]` of the machine. Frame: the machine's, all axes at 0.
void read_machine_body(TableReader& table, core::Machine& machine, const MeshSource& source) {
    core::MachineBody body;
    body.name = table.string("name").value_or("");
    if (body.name.empty()) return table.need("name");
    if (core::names_a_kind(body.name) && body.name != "nose")
        table.refuse("name", "is a word with a meaning of its own");
    for (const core::MachineBody& other : machine.bodies)
        if (other.name == body.name)
            table.refuse("name", fmt::format("\"{}\" is there twice", body.name));
    const std::string axis = table.string("axis").value_or("base");
    const auto link = link_named(machine, axis);
    if (!link)
        table.refuse("axis",
                     fmt::format("= \"{}\" is no axis of this machine, nor \"base\"", axis));
    body.link = link.value_or(LinkId::base);
    if (const auto shape = read_exact_body(table, source, core::Transform())) {
        body.body = *shape;
        machine.bodies.push_back(std::move(body));
    }
    table.finish();
}

} // namespace

void read_machine(TableReader& table, core::Machine& machine, const MeshSource& source) {
    AxisList list;
    for (TableReader& axis : table.tables("axis", "[[axis]]")) read_axis(axis, machine, list);
    if (!list.order.empty()) connect(table, machine, std::move(list));
    for (TableReader& body : table.tables("body", "[[body]]"))
        read_machine_body(body, machine, source);
    if (const auto rapid = table.word("rapid", {"straight", "dogleg"}))
        machine.rapid = *rapid == "dogleg" ? core::RapidStyle::dogleg : core::RapidStyle::straight;
    machine.corner_tolerance = table.number("corner_tolerance");
    if (machine.corner_tolerance && *machine.corner_tolerance < 0.0)
        table.refuse("corner_tolerance", "must be 0 or above");
    check_directions(table, machine);
    table.finish();
}

} // namespace app
