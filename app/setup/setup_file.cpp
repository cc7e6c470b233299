#include "app/setup/setup_file.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/setup/autodesk_machine.h"
#include "app/setup/body_table.h"
#include "app/setup/control_table.h"
#include "app/setup/coverage.h"
#include "app/setup/ini_file.h"
#include "app/setup/machine_table.h"
#include "app/setup/program_settings.h"
#include "app/setup/table_reader.h"
#include "app/setup/toml_file.h"
#include "app/setup/tool_table.h"
#include "app/setup/tools/tool_library.h"
#include "core/base/file_reads.h"
#include "core/base/rule_table.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/sim/clearance.h"
#include "gcode/language/canonical.h"
#include "gcode/language/control.h"

namespace app {

/// Reads `[machine]` or a machine file. Values that it does not state are unchanged. A machine
/// without rotary axes gets those of the kinematics in the ini file.
///
/// Result: whether it states axes.
bool read_machine(TableReader& table, core::Machine& machine, const MeshSource& source,
                  const gcode::Environment& environment, bool has_own_axes = false);

namespace {

using core::LinkId;

/// Axes in file order, with the names of their parents.
struct AxisList {
    std::vector<size_t> order;
    std::array<std::string, core::axis_count> parents;
};

/// Reads a direction, which must be a unit vector.
void read_direction(TableReader& table, core::MachineAxis& axis) {
    const auto direction = table.vector("direction", Measure::plain);
    if (!direction) return;
    if (std::abs(glm::length(*direction) - 1.0) > 1e-9)
        table.refuse("direction", "must have length 1, as in [1, 0, 0]");
    axis.direction = *direction;
}

/// What coordinates of an axis are.
Measure measure_along(size_t axis) {
    return core::is_rotary(axis) ? Measure::angle : Measure::length;
}

/// Default of an axis: along or about X, Y or Z, by its letter.
core::MachineAxis plain_axis(size_t index) {
    core::MachineAxis axis;
    axis.direction[static_cast<int>(index % 3)] = 1.0;
    axis.side = core::is_rotary(index) ? core::Side::table : core::Side::tool;
    return axis;
}

void read_range(TableReader& table, core::MachineAxis& axis, Measure measure) {
    axis.min = table.number("min", measure);
    axis.max = table.number("max", measure);
    axis.home = table.number("home", measure);
    axis.rapid = table.number("rapid", measure);
    axis.acceleration = table.number("acceleration", measure);
    if (axis.min && axis.max && *axis.min >= *axis.max) table.refuse("min", "must be below max");
    if (axis.rapid && *axis.rapid <= 0.0) table.refuse("rapid", "must be above 0");
    if (axis.acceleration && *axis.acceleration <= 0.0)
        table.refuse("acceleration", "must be above 0");
}

/// How far the axis of rotation may be from where it is stated.
void read_tolerances(TableReader& table, core::MachineAxis& axis) {
    constexpr double most_mm = 5.0, most_degrees = 5.0; // more is a mistake
    const auto value = [&](const char* key, Measure measure, double most, const char* unit) {
        const auto read = table.number(key, measure);
        if (read && !(*read >= 0.0 && *read <= most))
            table.refuse(key, fmt::format("must be from 0 to {:g} {}", most, unit));
        return read.value_or(0.0);
    };
    axis.point_tolerance = value("point_tolerance", Measure::length, most_mm, "mm");
    axis.direction_tolerance = value("direction_tolerance", Measure::angle, most_degrees, "degrees")
                               / core::degrees_per_radian;
}

void read_axis(TableReader& table, core::Machine& machine, AxisList& list) {
    const auto name = table.word("name", {"X", "Y", "Z", "A", "B", "C", "U", "V", "W"});
    if (!name) return table.need("name");
    const size_t index = core::axis_letters.find((*name)[0]);
    if (std::find(list.order.begin(), list.order.end(), index) != list.order.end())
        table.refuse("name", fmt::format("\"{}\" is defined twice", *name));
    const bool rotary = core::is_rotary(index);
    if (const auto kind = table.word("kind", {"linear", "rotary"}))
        if ((*kind == "rotary") != rotary)
            table.refuse("kind", fmt::format("= \"{}\": axis {} is {}: A, B and C are the rotary "
                                             "axes, all others are linear",
                                             *kind, *name, rotary ? "rotary" : "linear"));
    for (const char* key : {"point", "home"}) table.limit_numbers(key);
    core::MachineAxis axis = plain_axis(index);
    if (const auto side = table.word("side", {"tool", "table"}))
        axis.side = *side == "tool" ? core::Side::tool : core::Side::table;
    list.parents[index] = table.string("parent").value_or("");
    read_direction(table, axis);
    if (rotary) {
        axis.point = table.vector("point", Measure::length).value_or(core::Vec3(0.0));
        axis.shortest_way = table.boolean("shortest_way").value_or(false);
        read_tolerances(table, axis);
    }
    read_range(table, axis, measure_along(index));
    machine.axes[index] = axis;
    list.order.push_back(index);
    table.finish();
}

/// Checks that the linear axes are perpendicular to each other.
void check_directions(TableReader& table, const core::Machine& machine) {
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = i + 1; j < 3; ++j)
            if (std::abs(glm::dot(machine.axes[i].direction, machine.axes[j].direction)) > 1e-9)
                table.refuse("axis", "directions must be perpendicular to each other");
}

/// The link of this name; empty if the machine has no such axis.
std::optional<LinkId> link_named(const core::Machine& machine, const std::string& name) {
    if (name == "base") return LinkId::base;
    const size_t axis = name.size() == 1 ? core::axis_letters.find(name[0]) : std::string::npos;
    if (axis == std::string::npos || !machine.axes[axis].present) return std::nullopt;
    return core::link_of(axis);
}

/// Connects every axis to its `parent`, else to the preceding axis on its side in the file. X, Y
/// and Z, if not listed, move the tool and come first.
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
                return table.refuse(
                    "axis",
                    fmt::format(
                        "{}: parent \"{}\" is neither another axis of this machine nor \"base\"",
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
                return table.refuse("axis", fmt::format("{}: its chain of parents is a loop",
                                                        core::axis_letters[index]));
            link = machine.axes[static_cast<size_t>(link)].carrier;
        }
        if (carries[index]) continue;
        LinkId& end =
            machine.axes[index].side == core::Side::tool ? machine.spindle : machine.table;
        if (end != LinkId::base)
            return table.refuse(
                "axis",
                fmt::format("{} and {} are both at the end of the {} side: state with `parent` "
                            "which of them carries the other",
                            core::axis_letters[static_cast<size_t>(end)], core::axis_letters[index],
                            machine.axes[index].side == core::Side::tool ? "tool" : "table"));
        end = core::link_of(index);
    }
}

/// Reads a `[[body]]` of the machine. Frame: the machine's, all axes at 0.
void read_machine_body(TableReader& table, core::Machine& machine, const MeshSource& source) {
    table.limit_numbers();
    core::MachineBody body;
    body.name = table.string("name").value_or("");
    if (body.name.empty()) return table.need("name");
    if (core::names_a_kind(body.name) && body.name != "nose")
        table.refuse("name", "is a reserved word");
    for (const core::MachineBody& other : machine.bodies)
        if (other.name == body.name)
            table.refuse("name", fmt::format("\"{}\" is defined twice", body.name));
    const std::string axis = table.string("axis").value_or("base");
    const auto link = link_named(machine, axis);
    if (!link)
        table.refuse("axis",
                     fmt::format("= \"{}\" is neither an axis of this machine nor \"base\"", axis));
    body.link = link.value_or(LinkId::base);
    if (const auto shape = read_exact_body(table, source, core::Transform())) {
        body.body = shape->body;
        body.deviation = shape->deviation;
        machine.bodies.push_back(std::move(body));
    }
    table.finish();
}

/// The axes of a machine that has axes of its own, together with those of a table that replace or
/// join them: what a table does not connect otherwise stays connected as it was.
AxisList with_axes_before(const core::Machine& before, const core::Machine& machine,
                          const AxisList& list) {
    AxisList whole;
    const auto stays = [&](size_t index) {
        return before.axes[index].present && list.parents[index].empty()
               && before.axes[index].side == machine.axes[index].side;
    };
    // From the base on: what follows without a parent is carried by the last.
    const auto depth = [&](size_t index) {
        size_t links = 0;
        for (LinkId link = core::link_of(index); link != LinkId::base && links <= core::axis_count;
             link = before.axes[static_cast<size_t>(link)].carrier)
            ++links;
        return links;
    };
    for (size_t index = 0; index < core::axis_count; ++index)
        if (stays(index)) whole.order.push_back(index);
    std::stable_sort(whole.order.begin(), whole.order.end(),
                     [&](size_t a, size_t b) { return depth(a) < depth(b); });
    for (const size_t index : whole.order) {
        const LinkId carrier = before.axes[index].carrier;
        whole.parents[index] =
            carrier == LinkId::base
                ? "base"
                : std::string(1, core::axis_letters[static_cast<size_t>(carrier)]);
    }
    for (const size_t index : list.order)
        if (!stays(index)) {
            whole.order.push_back(index);
            whole.parents[index] = list.parents[index];
        }
    return whole;
}

/// Whether the rapids of the machine are straight answers a question about the control, too.
void answer_rapids(const TableReader& table, SetupFile& file) {
    if (!table.has("rapid")) return;
    const bool is_straight = file.setup.machine.rapid == core::RapidStyle::straight;
    file.environment.control.answers[gcode::ControlQuestion::rapids_are_straight] =
        is_straight ? 1.0 : 0.0;
}

} // namespace

bool read_machine(TableReader& table, core::Machine& machine, const MeshSource& source,
                  const gcode::Environment& environment, bool has_own_axes) {
    AxisList list;
    const core::Machine before = machine;
    for (TableReader& axis : table.tables("axis", "[[axis]]")) read_axis(axis, machine, list);
    const bool has_axes = !list.order.empty();
    if (has_axes)
        connect(table, machine, has_own_axes ? with_axes_before(before, machine, list) : list);
    (void)take_rotary_axes(machine, environment);
    for (TableReader& body : table.tables("body", "[[body]]"))
        read_machine_body(body, machine, source);
    if (const auto rapid = table.word("rapid", {"straight", "dogleg"}))
        machine.rapid = *rapid == "dogleg" ? core::RapidStyle::dogleg : core::RapidStyle::straight;
    const auto tolerance = [&](const char* key) {
        const auto value = table.number(key, Measure::length);
        if (value && *value < 0.0) table.refuse(key, "must be 0 or above");
        return value;
    };
    machine.corner_tolerance = tolerance("corner_tolerance");
    machine.rapid_corner_tolerance = tolerance("rapid_corner_tolerance");
    check_directions(table, machine);
    table.finish();
    return has_axes;
}

namespace {

constexpr const char* axis_keys[] = {"X", "Y", "Z", "A", "B", "C", "U", "V", "W"};
/// Explains the error of a file that states allowances in two forms.
core::Error explained(core::Error error) {
    if (error.message.find("'allowance'") != std::string::npos)
        error.message += "; if there are [[allowance]] tables, write the general allowance as one "
                         "of them, with a distance and without between";
    return error;
}

/// Applies the settings of [program] and of the command line. Must come before the bodies are read:
/// their frames depend on the work offsets of a variables file.
void apply_settings(const ProgramSettings& given, SetupFile& file,
                    std::optional<core::Error>& error) {
    if (error) return;
    auto applied = apply(given, file.environment);
    if (!applied) {
        error = std::move(applied).error();
        return;
    }
    const ProgramSettings& settings = applied->settings;
    const std::vector<std::string>& notes = applied->notes;
    file.dialect = settings.dialect;
    file.tool_table = settings.tool_table;
    file.setup.tool_at_start = settings.tool_at_start;
    file.speed_by_hand = settings.speed_by_hand.value_or(false);
    file.setup.spindle_at_start =
        settings.spindle_at_start.value_or(core::SpindleDirection::stopped);
    file.assumptions.insert(file.assumptions.end(), notes.begin(), notes.end());
}

void read_offsets(TableReader& table, SetupFile& file) {
    table.limit_numbers();
    for (const std::string& name : table.keys()) {
        const auto index = gcode::offset_of_name(name);
        if (!index) continue; // refused below
        auto offset = table.table(name.c_str(), "[offsets] " + name);
        if (!offset) return;
        gcode::AxisValues& origin = file.environment.writable_work_offset(*index);
        const gcode::AxisValues of_variables = std::exchange(origin, {});
        for (size_t axis = 0; axis < core::axis_count; ++axis)
            origin[axis] = offset->number_or(axis_keys[axis], measure_along(axis), 0.0);
        // A variables file that has others has this one, too; it may be 0.
        const bool is_stored =
            of_variables != gcode::AxisValues{} || !file.environment.parameters.empty();
        if (is_stored && of_variables != origin)
            file.assumptions.push_back(fmt::format("{}{}", name, differs_from_variables));
        offset->finish();
        if (!file.offsets_set.insert(static_cast<int>(*index)).second)
            table.refuse(name.c_str(),
                         fmt::format("is the same work offset as {}, which is stated, "
                                     "too",
                                     gcode::name_of_offset(*index)));
    }
    for (size_t i = 0; i < gcode::plain_offset_count; ++i) table.allow(gcode::name_of_offset(i));
    table.finish();
}

/// Reads one `[[allowance]]`. Without `between` it is the general one, like `allowance = MM`: TOML
/// does not allow a number and a list of the same name.
void read_allowance(TableReader& table, core::Setup& setup) {
    core::AllowanceRule rule;
    const auto distance = table.number("distance", Measure::length);
    if (!distance) return table.need("distance");
    rule.distance = *distance;
    rule.contact = table.number_or("contact", Measure::length, 0.0);
    if (!(rule.distance >= 0.0 && rule.distance <= core::largest_allowance))
        table.refuse("distance", "must lie between 0 and " + table.shown(core::largest_allowance));
    if (rule.contact < 0.0) table.refuse("contact", "must not be negative");
    if (const auto names = table.strings("between", 2)) {
        rule.between = {(*names)[0], (*names)[1]};
        setup.allowances.push_back(rule);
    } else {
        setup.allowance = rule.distance;
    }
    table.finish();
}

void read_allowances(TableReader& root, core::Setup& setup) {
    if (root.is_list("allowance")) {
        for (TableReader& table : root.tables("allowance", "[[allowance]]"))
            read_allowance(table, setup);
        return;
    }
    setup.allowance = root.number("allowance", Measure::length);
    if (setup.allowance
        && !(*setup.allowance >= 0.0 && *setup.allowance <= core::largest_allowance))
        root.refuse("allowance", "must lie between 0 and " + root.shown(core::largest_allowance));
}

/// Refuses a rule with an unknown body name, which would never apply.
void check_allowance_names(TableReader& table, const core::Setup& setup) {
    for (const core::AllowanceRule& rule : setup.allowances) {
        for (const std::string& name : rule.between) {
            bool known = core::names_a_kind(name);
            for (const core::Fixture& fixture : setup.fixtures)
                known = known || name == fixture.name;
            for (const core::MachineBody& body : setup.machine.bodies)
                known = known || name == body.name;
            if (!known)
                table.refuse("allowance", fmt::format("between: there is no body \"{}\"", name));
        }
    }
}

void read_rules(TableReader& table, SetupFile& file) {
    file.allow_comments = table.boolean("allow_comments").value_or(false);
    for (const auto& [rule, severity] : read_severities(table, "allow_comments"))
        file.setup.rules[rule] = severity;
}

/// Reads a machine of Autodesk. Returns the letters of axes that it has and that are not described.
std::string read_library_machine(const std::string& path, SetupFile& file,
                                 std::optional<core::Error>& error) {
    auto read = read_autodesk_machine(path);
    if (!read) {
        error = std::move(read).error();
        return {};
    }
    TableReader table(read->machine, "machine", error);
    file.has_axes = read_machine(table, file.setup.machine,
                                 {std::filesystem::path(path).parent_path(), file.assumptions},
                                 file.environment);
    for (const std::string& note : read->notes)
        file.assumptions.push_back(fmt::format("{}: {}", path, note));
    if (error && error->file.empty()) error->file = path;
    return read->rotary;
}

/// Reads the machine from its own file. Errors name that file.
void read_machine_file(const std::string& path, SetupFile& file,
                       std::optional<core::Error>& error) {
    const auto parsed = read_toml(path);
    if (!parsed) {
        error = parsed.error();
    } else {
        TableReader table(*parsed, "machine", error);
        table.read_unit();
        read_control(table, file.control);
        file.has_axes = read_machine(table, file.setup.machine,
                                     {std::filesystem::path(path).parent_path(), file.assumptions},
                                     file.environment);
        answer_rapids(table, file);
    }
    if (error && error->file.empty()) error->file = path;
}

/// Reads the machine of a preset. Returns the letters of axes that it has and that are not
/// described.
std::string read_named_machine(TableReader& table, SetupFile& file,
                               std::optional<core::Error>& error) {
    const auto preset = read_machine_preset(table);
    if (!preset) return {};
    TableReader reader(preset->machine, "machine", error);
    file.has_axes =
        read_machine(reader, file.setup.machine, {{}, file.assumptions}, file.environment);
    file.assumptions.insert(file.assumptions.end(), preset->notes.begin(), preset->notes.end());
    return preset->others;
}

void read_machine_table(TableReader& table, BodyContext& context,
                        std::optional<core::Error>& error) {
    core::Machine& machine = context.file.setup.machine;
    // Axes whose places nobody has stated yet.
    std::string others = read_named_machine(table, context.file, error);
    if (const auto name = table.string("file")) {
        const std::string path = (context.folder / *name).generic_string();
        if (is_autodesk_machine(path))
            others = read_library_machine(path, context.file, error);
        else
            read_machine_file(path, context.file, error);
    }
    const bool leaves_axes_out = table.word("other_axes", {"not described"}).has_value();
    if (read_machine(table, machine, context.meshes(), context.file.environment,
                     context.file.has_axes))
        context.file.has_axes = true;
    answer_rapids(table, context.file);
    const bool lacks_axes = std::any_of(others.begin(), others.end(), [&](char letter) {
        return !machine.axes[core::axis_letters.find(letter)].present;
    });
    if (leaves_axes_out || lacks_axes) context.file.has_axes = false;
    const core::AxisPosition home = machine.home();
    if (home[0] && home[1] && home[2] && !context.file.environment.home) {
        gcode::AxisValues& values = context.file.environment.home.emplace();
        for (size_t axis = 0; axis < core::axis_count; ++axis)
            values[axis] = home[axis].value_or(0.0);
    }
}

void place_offsets(BodyContext& context) {
    const core::Machine& machine = context.file.setup.machine;
    const gcode::Environment& environment = context.file.environment;
    context.frames.machine_from["machine"] = {};
    const auto place = [&](size_t index) {
        context.frames.machine_from[gcode::name_of_offset(index)] =
            machine_from_offset(machine, environment.work_offset(index));
    };
    for (size_t i = 0; i < gcode::plain_offset_count; ++i) place(i);
    for (const auto& [index, origin] : environment.extended_offsets) place(index);
}

/// Whether a body of the set-up is placed in machine coordinates.
bool has_machine_frame(const toml::node& node) {
    if (const toml::array* list = node.as_array())
        return std::any_of(list->begin(), list->end(), has_machine_frame);
    const toml::table* table = node.as_table();
    return table && (*table)["frame"].value_or(std::string()) == "machine";
}

/// Whether nothing in a set-up says where the work is in the machine. A machine with rotary axes
/// relates to the work in too many ways to assume a place: there G54 is at machine zero.
bool states_no_work_position(const toml::table& root, const SetupFile& file) {
    for (const char* key : {"stock", "fixture", "part"})
        if (const toml::node* body = root.get(key); body && has_machine_frame(*body)) return false;
    for (const gcode::AxisValues& offset : file.environment.work_offsets)
        if (offset != gcode::AxisValues{}) return false;
    return file.offsets_set.empty() && file.environment.parameters.empty()
           && !file.setup.machine.has_rotary();
}

/// The highest point of a body as it is mounted, with all axes at 0.
double top_of(const core::Aabb& box, const core::Transform& machine_from_body) {
    double top = -core::infinity;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const core::Vec3 p((corner & 1U) != 0 ? box.max.x : box.min.x,
                           (corner & 2U) != 0 ? box.max.y : box.min.y,
                           (corner & 4U) != 0 ? box.max.z : box.min.z);
        top = std::max(top, (machine_from_body * p).z);
    }
    return top;
}

/// Where X, Y and Z are assumed to start: at machine zero, or above the highest body if machine
/// zero is too near to the work; within the limits of the axes.
core::Vec3 assumed_start(const SetupFile& file) {
    constexpr double room = 100.0, above = 500.0, usual_longest = 250.0; // mm
    const core::Setup& setup = file.setup;
    core::Vec3 start(0.0);
    double top = -core::infinity;
    if (file.needs_stock)
        top = setup.stock_mount.link_from_body.translation.z;
    else
        top = top_of(core::bounds(setup.stock), setup.stock_mount.link_from_body);
    for (const core::Fixture& fixture : setup.fixtures)
        if (!fixture.is_machine)
            top = std::max(top, top_of(core::bounds(fixture.body), fixture.mount.link_from_body));
    double longest = file.is_partial ? usual_longest : 0.0;
    for (const auto& [number, tool] : setup.tools) longest = std::max(longest, tool.length);
    if (top + longest + room > 0.0) start.z = top + longest + above;
    for (int axis = 0; axis < 3; ++axis) {
        const core::MachineAxis& range = setup.machine.axes[static_cast<size_t>(axis)];
        if (axis == 2 && range.max && start.z > *range.max) start.z = *range.max;
        if (range.max) start[axis] = std::min(start[axis], *range.max);
        if (range.min) start[axis] = std::max(start[axis], *range.min);
    }
    return start;
}

bool is_own(const core::Fixture& fixture) { return !fixture.is_machine; }

/// Whether a set-up leaves so much open that it is completed like one that states nothing.
bool is_partial(const SetupFile& file) {
    const core::Setup& setup = file.setup;
    const bool has_tools =
        !setup.tools.empty() || !file.library.empty() || !file.tool_table.empty();
    const bool has_work =
        !file.needs_stock || std::any_of(setup.fixtures.begin(), setup.fixtures.end(), is_own);
    return file.infers_frame || !has_tools || !has_work;
}

/// Whether a set-up describes nothing that an assumed start position could be compared with.
bool start_is_free(const SetupFile& file) {
    const std::vector<core::Fixture>& fixtures = file.setup.fixtures;
    return file.is_partial && std::none_of(fixtures.begin(), fixtures.end(), is_own);
}

/// Assumes a home position where the start position is assumed, too.
void assume_home(SetupFile& file) {
    if (!start_is_free(file) || file.environment.home) return;
    file.infers_home = true;
    gcode::AxisValues& values = file.environment.home.emplace();
    const core::AxisPosition home = file.setup.machine.home();
    for (size_t axis = 0; axis < 3; ++axis) values[axis] = home[axis].value_or(0.0);
    file.assumptions.push_back(
        "the set-up does not state the home position: machine zero is assumed");
}

/// Assumes the start position of X, Y and Z where nothing states it.
void assume_start(SetupFile& file) {
    const core::Vec3 assumed = assumed_start(file);
    const bool is_free = start_is_free(file);
    std::string axes;
    for (size_t i = 0; i < 3; ++i) {
        if (file.environment.start[i]) continue;
        file.environment.start[i] = assumed[static_cast<int>(i)];
        file.setup.start_is_assumed[i] = !is_free;
        file.infers_start = file.infers_start || is_free;
        axes += fmt::format("{}{}{}", axes.empty() ? "" : " ", core::axis_letters[i],
                            core::number_text(assumed[static_cast<int>(i)], 3));
    }
    if (axes.empty()) return;
    file.start_assumption = fmt::format(
        "the set-up does not state where the machine starts: {} (machine coordinates) is assumed",
        axes);
    file.assumptions.push_back(file.start_assumption);
}

/// Sets the machine position at the first block: as stated, else the home position, per axis.
void settle_start(SetupFile& file) {
    const core::AxisPosition home = file.setup.machine.home();
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (!file.environment.start[i]) file.environment.start[i] = home[i];
        if (i < 3 || !file.setup.machine.axes[i].present || file.environment.start[i]) continue;
        file.environment.start[i] = 0.0;
        file.assumptions.push_back(
            fmt::format("axis {} is at 0 at the first block", core::axis_letters[i]));
    }
    assume_start(file);
    assume_home(file);
    const auto& axes = file.setup.machine.axes;
    if (std::any_of(axes.begin() + 3, axes.end(), [](const auto& axis) { return axis.present; }))
        file.environment.machine = std::make_shared<const core::Machine>(file.setup.machine);
}

void read_bodies(TableReader& root, BodyContext& context) {
    context.has_only_stock = !root.has("fixture") && !root.has("part");
    if (auto stock = root.table("stock", "[stock]"))
        read_stock(*stock, context);
    else
        infer_stock(context);
    const auto fixtures = root.word("fixtures", {"none"});
    for (TableReader& fixture : root.tables("fixture", "[[fixture]]")) {
        if (fixtures) root.refuse("fixtures", "= \"none\" contradicts the [[fixture]] tables");
        read_fixture(fixture, context);
    }
    if (fixtures || !context.file.setup.fixtures.empty())
        context.file.fixtures_known = Known::described;
    if (!context.file.infers_frame) add_machine_bodies(root, context.file.setup);
    if (auto part = root.table("part", "[part]")) read_part(*part, context);
}

/// Removes the limits of all axes; whether there were any.
bool drop_limits(core::Machine& machine) {
    bool had_limits = false;
    for (core::MachineAxis& axis : machine.axes) {
        had_limits = had_limits || axis.min || axis.max;
        axis.min.reset();
        axis.max.reset();
    }
    return had_limits;
}

Known known_limits(const core::Machine& machine) {
    for (size_t i = 0; i < core::axis_count; ++i) {
        const core::MachineAxis& axis = machine.axes[i];
        if (axis.present && !core::is_rotary(i) && !(axis.min && axis.max)) return Known::missing;
    }
    return Known::described;
}

/// What the file states and calls assumed.
void read_assumed(TableReader& root, SetupFile& file) {
    for (const std::string& word :
         root.strings("assumed", 0).value_or(std::vector<std::string>{})) {
        if (std::find(assumed_words.begin(), assumed_words.end(), word) == assumed_words.end())
            return root.refuse("assumed", fmt::format("is a list of {}; \"{}\" is none of them",
                                                      fmt::join(assumed_words, ", "), word));
        file.assumed.insert(word);
    }
    file.infers_start = file.assumed.contains("start");
}

/// How far the gauge line is above the point that the control takes for it, mm. Empty: not the same
/// with all tools.
std::optional<double> gauge_shift(const core::Setup& setup) {
    constexpr double same = 1e-6; // mm
    std::optional<double> shift;
    for (const auto& [number, tool] : setup.tools) {
        if (shift && std::abs(*shift - tool.gauge_rise) > same) return std::nullopt;
        shift = tool.gauge_rise;
    }
    return shift.value_or(0.0);
}

/// Places the machine's bodies relative to the work, which was touched off with the tools: with the
/// length that the control uses, the work would be too high.
void place_machine_bodies(BodyContext& context) {
    SetupFile& file = context.file;
    core::Machine& machine = file.setup.machine;
    const auto shift = gauge_shift(file.setup);
    if (shift == 0.0) return;
    if (!shift || machine.has_rotary()) {
        const auto elsewhere = [&](const core::MachineBody& body) {
            return body.link != machine.spindle;
        };
        if (std::erase_if(machine.bodies, elsewhere) == 0) return;
        file.loses_machine = true;
        file.assumptions.push_back(
            "the length of the tools in the control is not the true one (touched_off), so where "
            "the work is on the machine is not known: only those machine bodies are checked that "
            "move with the spindle");
        return;
    }
    const bool has_bodies = !machine.bodies.empty();
    const core::Transform up = core::translation({0.0, 0.0, *shift});
    for (core::MachineBody& body : machine.bodies) body.place = up;
    context.frames.machine_from["machine"] = up;
    if (has_bodies)
        file.assumptions.push_back(fmt::format(
            "the tools are {0} mm {1} than the control knows (touched_off), so the work is {0} mm "
            "{2} on the machine than its work offset says",
            core::number_text(std::abs(*shift), 3), *shift > 0.0 ? "longer" : "shorter",
            *shift > 0.0 ? "lower" : "higher"));
}

void read_root(TableReader& root, const toml::table& text, BodyContext& context,
               const ProgramSettings& over, std::optional<core::Error>& error) {
    SetupFile& file = context.file;
    core::Setup& setup = file.setup;
    file.length_unit = root.read_unit();
    if (root.has("unit"))
        root.refuse("unit", "is a key of [program]; the unit of the lengths in this file is "
                            "length_unit");
    file.mesh_is_stated = root.has("mesh_size");
    read_assumed(root, file);
    setup.mesh_size = root.number_or("mesh_size", Measure::length, 0.5);
    if (!(setup.mesh_size > 0.0)) root.refuse("mesh_size", "must be above 0");
    if (const auto megabytes = root.number("memory_limit", Measure::plain)) {
        if (!(*megabytes > 0.0)) root.refuse("memory_limit", "must be above 0, in MB");
        setup.memory_limit = *megabytes * 1e6;
    }
    ProgramSettings settings;
    if (auto table = root.table("program", "[program]"))
        settings = read_program_table(*table, context.folder);
    apply_settings(overlaid(std::move(settings), over), file, error);
    if (auto table = root.table("machine", "[machine]")) read_machine_table(*table, context, error);
    read_control(root, file.control);
    if (!file.dialect && file.control.preset) file.dialect = file.control.preset->dialect;
    const std::string note = complete_machine(setup.machine, file.environment, true);
    file.has_axes |= file.environment.kinematics && file.environment.kinematics->machine;
    if (!note.empty()) file.assumptions.push_back(note);
    if (auto table = root.table("offsets", "[offsets]")) read_offsets(*table, file);
    file.infers_frame = states_no_work_position(text, file);
    if (file.infers_frame)
        file.assumptions.push_back("the set-up states no work offset: "
                                   + assume_machine_zero(file));
    place_offsets(context);
    if (const auto library = root.string("tool_library")) {
        auto tools = read_tool_library((context.folder / *library).generic_string(),
                                       file.environment.machine_unit);
        if (tools)
            file.library = *std::move(tools);
        else
            root.refuse_with(tools.error());
    }
    for (TableReader& table : root.tables("tool", "[[tool]]")) read_tool(table, context);
    for (const auto& [number, found] : file.library)
        if (!setup.tools.contains(number))
            file.environment.tool_names.emplace(found.tool.name, number);
    for (TableReader& table : root.tables("length_offset", "[[length_offset]]"))
        read_length_offset(table, file);
    place_machine_bodies(context);
    read_bodies(root, context);
    if (file.offsets_set.empty() && !file.infers_frame)
        for (const size_t offset : file.offsets_of_bodies)
            file.assumptions.push_back(fmt::format(
                "nothing states {}, in which bodies are positioned: it is at machine zero",
                gcode::name_of_offset(offset)));
    read_allowances(root, setup);
    check_allowance_names(root, setup);
    const bool has_assumed_offsets = file.assumed.contains("offsets") && !file.infers_frame;
    if (has_assumed_offsets)
        file.limits_need_offsets = known_limits(setup.machine) == Known::described;
    if (has_assumed_offsets && drop_limits(setup.machine))
        file.assumptions.push_back(
            "axis limits are not checked, because the work offsets are only assumed");
    file.limits_known = known_limits(setup.machine);
    if (auto table = root.table("rules", "[rules]")) read_rules(*table, file);
    file.is_partial = is_partial(file);
    root.finish();
}

} // namespace

core::Transform machine_from_offset(const core::Machine& machine, const core::AxisValues& origin,
                                    double rotation_deg) {
    core::AxisValues rotary{};
    for (size_t axis = 3; axis < 6; ++axis) rotary[axis] = origin[axis];
    return core::machine_from_link(machine, machine.table, rotary).inverse()
           * core::Transform{core::rotation_xyz_deg({0.0, 0.0, rotation_deg}),
                             machine.linear_position(origin)};
}

std::string assume_machine_zero(SetupFile& file) {
    constexpr double above_program = 500.0; // mm
    gcode::Environment& environment = file.environment;
    core::Machine& machine = file.setup.machine;
    const core::MachineAxis& z = machine.axes[2];
    const double top = z.max.value_or(z.home.value_or(environment.start[2].value_or(0.0)));
    for (gcode::AxisValues& offset : environment.work_offsets)
        offset = {0.0, 0.0, top - above_program};
    const core::AxisPosition home = machine.home();
    for (size_t axis = 0; axis < 3; ++axis)
        if (!environment.start[axis]) {
            environment.start[axis] = home[axis].value_or(axis == 2 ? top : 0.0);
            file.infers_start = file.infers_start || !home[axis];
        }
    file.infers_home = !environment.home;
    file.infers_second_home = !environment.second_home;
    if (file.infers_home) environment.home = gcode::AxisValues{0.0, 0.0, top};
    if (file.infers_second_home && top != 0.0)
        environment.second_home = gcode::AxisValues{0.0, 0.0, top};
    file.limits_need_offsets = known_limits(machine) == Known::described;
    const bool has_limits = drop_limits(machine);
    const bool is_zero = top == 0.0;
    return fmt::format(
        "all work offsets are equal; machine {}, which is also the start and home position, is "
        "{:g} mm above them{}",
        is_zero ? "zero" : "Z" + core::number_text(top, 3), above_program,
        has_limits || !machine.bodies.empty()
            ? "; axis limits and machine bodies that do not move with the tool are not checked"
            : "");
}

namespace {

core::Result<SetupFile> setup_of(const core::Result<toml::table>& parsed, const std::string& path,
                                 const ProgramSettings& over) {
    SetupFile file;
    file.path = path;
    std::optional<core::Error> error;
    if (parsed) {
        BodyContext context{std::filesystem::path(path).parent_path(), {}, file};
        TableReader root(*parsed, "set-up", error);
        read_root(root, *parsed, context, over, error);
        settle_start(file);
        file.frames = std::move(context.frames.machine_from);
    } else {
        error = explained(parsed.error());
    }
    if (!error) return file;
    return tl::unexpected(core::in_file(*std::move(error), path));
}

} // namespace

core::Result<SetupFile> read_setup(const std::string& path, const ProgramSettings& over) {
    return setup_of(read_toml(path), path, over);
}

core::Result<SetupFile> read_setup_text(const std::string& text, const std::string& path,
                                        const ProgramSettings& over) {
    return setup_of(parsed_toml(text), path, over);
}

std::string setup_next_to(const std::string& program) {
    const std::filesystem::path setup = std::filesystem::path(program).replace_extension(".toml");
    const bool is_one =
        setup.filename() != project_file_name && setup != program && core::is_there(setup);
    return is_one ? setup.generic_string() : std::string();
}

std::string required_rule(std::string_view word) {
    assert(word == required_words[0]);
    return core::rule_id("incomplete-setup");
}

core::RuleSeverities read_severities(TableReader& table, const std::string& but) {
    core::RuleSeverities severities;
    for (const std::string& rule : table.keys()) {
        if (rule == but) continue;
        const auto word = table.word(rule.c_str(), core::names_of(core::all_severities));
        if (!word) continue;
        if (!core::default_severity(rule)) {
            table.refuse(rule.c_str(),
                         fmt::format("is not the name of a rule; did you mean \"{}\"?",
                                     core::nearest_rule(rule)));
            continue;
        }
        severities[rule] = *core::find_named(core::all_severities, *word);
        if (rule == core::rule_id("collision") && severities[rule] != core::Severity::error)
            table.refuse(core::rule_id("collision"), "is always an error");
    }
    return severities;
}

} // namespace app
