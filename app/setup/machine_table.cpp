#include "app/setup/machine_table.h"

#include <fmt/format.h>

namespace app {
namespace {

/// A direction must be that of a unit vector along X, Y or Z.
void read_direction(TableReader& table, core::MachineAxis& axis) {
    const auto direction = table.vector("direction");
    if (!direction) return;
    if (std::abs(glm::length(*direction) - 1.0) > 1e-9)
        table.refuse("direction", "must have length 1, as in [1, 0, 0]");
    axis.direction = *direction;
}

void read_axis(TableReader& table, core::Machine& machine) {
    const auto name = table.word("name", {"X", "Y", "Z", "A", "B", "C", "U", "V", "W"});
    if (!name) return table.need("name");
    const auto kind = table.word("kind", {"linear", "rotary"}).value_or("linear");
    if (kind == "rotary" || (*name != "X" && *name != "Y" && *name != "Z"))
        return table.refuse("name", fmt::format("= \"{}\": this version knows the linear axes X, "
                                                "Y and Z only",
                                                *name));
    core::MachineAxis& axis = machine.axes[static_cast<size_t>((*name)[0] - 'X')];
    table.word("side", {"tool", "table"}); // the same for the relative motion of linear axes
    table.string("parent");
    read_direction(table, axis);
    axis.min = table.number("min");
    axis.max = table.number("max");
    axis.home = table.number("home");
    axis.rapid = table.number("rapid");
    axis.acceleration = table.number("acceleration");
    if (axis.min && axis.max && *axis.min >= *axis.max) table.refuse("min", "must be below max");
    if (axis.rapid && *axis.rapid <= 0.0) table.refuse("rapid", "must be above 0");
    if (axis.acceleration && *axis.acceleration <= 0.0)
        table.refuse("acceleration", "must be above 0");
    table.finish();
}

/// The axes must span space without tilting it.
void check_directions(TableReader& table, const core::Machine& machine) {
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = i + 1; j < 3; ++j)
            if (std::abs(glm::dot(machine.axes[i].direction, machine.axes[j].direction)) > 1e-9)
                table.refuse("axis", "directions must stand at right angles to each other");
}

} // namespace

void read_machine(TableReader& table, core::Machine& machine) {
    for (TableReader& axis : table.tables("axis", "[[axis]]")) read_axis(axis, machine);
    if (!table.tables("body", "[[body]]").empty())
        table.refuse("body", "is not supported by this version: bodies of the machine itself are "
                             "not checked yet; what stands on the table can be a [[fixture]]");
    if (const auto rapid = table.word("rapid", {"straight", "dogleg"}))
        machine.rapid = *rapid == "dogleg" ? core::RapidStyle::dogleg : core::RapidStyle::straight;
    check_directions(table, machine);
    table.finish();
}

} // namespace app
