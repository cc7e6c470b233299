#include "app/setup/setup_file.h"

#include <utility>

#include <fmt/format.h>

#include "app/setup/body_table.h"
#include "app/setup/ini_machine.h"
#include "app/setup/machine_table.h"
#include "app/setup/program_table.h"
#include "app/setup/rules_table.h"
#include "app/setup/table_reader.h"
#include "app/setup/toml_file.h"
#include "app/setup/tool_table.h"
#include "app/tools/tool_library.h"
#include "core/sim/allowance.h"

namespace app {
namespace {

constexpr const char* axis_keys[] = {"X", "Y", "Z", "A", "B", "C", "U", "V", "W"};
constexpr const char* offset_names[] = {"G54", "G55",   "G56",   "G57",  "G58",
                                        "G59", "G59.1", "G59.2", "G59.3"};

constexpr double largest_allowance = 1000.0; // mm; more is a slip of the finger

core::Result<toml::table> parse(const std::string& path) {
    auto parsed = read_toml(path);
    if (!parsed && parsed.error().message.find("'allowance'") != std::string::npos)
        parsed.error().message +=
            "; write the general allowance as an [[allowance]] with a distance and no between when "
            "there are others";
    return parsed;
}

/// The settings of the program's table and of the command line, in effect for all that follows: the
/// frames of bodies stand on the work offsets of a variables file.
void apply_settings(const ProgramSettings& settings, SetupFile& file,
                    std::optional<core::Error>& error) {
    if (error) return;
    auto notes = apply(settings, file.environment);
    if (!notes) {
        error = std::move(notes).error();
        return;
    }
    file.dialect = settings.dialect;
    file.tool_table = settings.tool_table;
    file.setup.tool_at_start = settings.tool_at_start;
    file.speed_by_hand = settings.speed_by_hand.value_or(false);
    file.setup.spindle_at_start =
        settings.spindle_at_start.value_or(core::SpindleDirection::stopped);
    file.assumptions.insert(file.assumptions.end(), notes->begin(), notes->end());
}

void read_offsets(TableReader& table, SetupFile& file) {
    for (size_t i = 0; i < std::size(offset_names); ++i) {
        auto offset = table.table(offset_names[i], fmt::format("[offsets] {}", offset_names[i]));
        if (!offset) continue;
        gcode::AxisValues& origin = file.environment.work_offsets[i];
        const gcode::AxisValues of_variables = std::exchange(origin, {});
        for (size_t axis = 0; axis < core::axis_count; ++axis)
            origin[axis] = offset->number_or(axis_keys[axis], 0.0);
        if (of_variables != gcode::AxisValues{} && of_variables != origin)
            file.assumptions.push_back(
                fmt::format("{} is where [offsets] puts it; the variables file puts it elsewhere",
                            offset_names[i]));
        offset->finish();
        file.offsets_set.insert(static_cast<int>(i));
    }
    table.finish();
}

/// One `[[allowance]]`; without `between` it is the general one, as `allowance = MM`. (TOML does
/// not let a number and a list share a name.)
void read_allowance(TableReader& table, core::Setup& setup) {
    core::AllowanceRule rule;
    const auto distance = table.number("distance");
    if (!distance) return table.need("distance");
    rule.distance = *distance;
    rule.contact = table.number_or("contact", 0.0);
    if (!(rule.distance >= 0.0 && rule.distance <= largest_allowance))
        table.refuse("distance", "must lie between 0 and 1000 mm");
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
    setup.allowance = root.number("allowance");
    if (setup.allowance && !(*setup.allowance >= 0.0 && *setup.allowance <= largest_allowance))
        root.refuse("allowance", "must lie between 0 and 1000 mm");
}

/// A name that no body has would make a rule that never counts.
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

/// The machine from its own file, whose mistakes carry its own name.
void read_machine_file(const std::string& path, core::Machine& machine,
                       std::vector<std::string>& assumptions, std::optional<core::Error>& error) {
    const auto parsed = parse(path);
    if (!parsed) {
        error = parsed.error();
    } else {
        TableReader table(*parsed, "machine", error);
        read_machine(table, machine, {std::filesystem::path(path).parent_path(), assumptions});
    }
    if (error && error->file.empty()) error->file = path;
}

void read_machine_table(TableReader& table, BodyContext& context,
                        std::optional<core::Error>& error) {
    core::Machine& machine = context.file.setup.machine;
    if (const auto name = table.string("file"))
        read_machine_file((context.folder / *name).string(), machine, context.file.assumptions,
                          error);
    read_machine(table, machine, context.meshes());
    const core::AxisPosition home = machine.home();
    if (home[0] && home[1] && home[2] && !context.file.environment.home) {
        gcode::AxisValues& values = context.file.environment.home.emplace();
        for (size_t axis = 0; axis < core::axis_count; ++axis)
            values[axis] = home[axis].value_or(0.0);
    }
}

void place_offsets(BodyContext& context) {
    const core::Machine& machine = context.file.setup.machine;
    context.frames.machine_from["machine"] = {};
    for (size_t i = 0; i < std::size(offset_names); ++i) {
        const gcode::AxisValues& set = context.file.environment.work_offsets[i];
        // The work lies along the machine's axes while the rotary ones stand at their offsets.
        gcode::AxisValues rotary{};
        for (size_t axis = 3; axis < 6; ++axis) rotary[axis] = set[axis];
        context.frames.machine_from[offset_names[i]] =
            core::machine_from_link(machine, machine.table, rotary).inverse()
            * core::translation(machine.place(set));
    }
}

/// Where the machine stands at the first block: as stated, else at home, axis by axis.
void settle_start(SetupFile& file) {
    const core::AxisPosition home = file.setup.machine.home();
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (!file.environment.start[i]) file.environment.start[i] = home[i];
        if (i < 3 || !file.setup.machine.axes[i].present || file.environment.start[i]) continue;
        file.environment.start[i] = 0.0;
        file.assumptions.push_back(
            fmt::format("axis {} stands at 0 at the first block", core::axis_letters[i]));
    }
    if (file.setup.machine.has_rotary())
        file.environment.machine = std::make_shared<const core::Machine>(file.setup.machine);
}

void read_bodies(TableReader& root, BodyContext& context) {
    if (auto stock = root.table("stock", "[stock]"))
        read_stock(*stock, context);
    else
        infer_stock(context);
    for (TableReader& fixture : root.tables("fixture", "[[fixture]]"))
        read_fixture(fixture, context);
    add_machine_bodies(root, context.file.setup);
    if (auto part = root.table("part", "[part]")) read_part(*part, context);
}

void read_root(TableReader& root, BodyContext& context, const ProgramSettings& over,
               std::optional<core::Error>& error) {
    SetupFile& file = context.file;
    core::Setup& setup = file.setup;
    setup.mesh_size = root.number_or("mesh_size", 0.5);
    if (!(setup.mesh_size > 0.0)) root.refuse("mesh_size", "must be above 0");
    if (const auto megabytes = root.number("memory_limit")) {
        if (!(*megabytes > 0.0)) root.refuse("memory_limit", "must be above 0, in MB");
        setup.memory_limit = *megabytes * 1e6;
    }
    ProgramSettings settings;
    if (auto table = root.table("program", "[program]"))
        settings = read_program_table(*table, context.folder);
    apply_settings(overlaid(std::move(settings), over), file, error);
    if (auto table = root.table("machine", "[machine]")) read_machine_table(*table, context, error);
    const std::string note = complete_machine(setup.machine, file.environment, true);
    if (!note.empty()) file.assumptions.push_back(note);
    if (auto table = root.table("offsets", "[offsets]")) read_offsets(*table, file);
    place_offsets(context);
    if (const auto library = root.string("tool_library")) {
        auto tools =
            read_tool_library((context.folder / *library).string(), file.environment.machine_unit);
        if (tools)
            file.library = *std::move(tools);
        else
            root.refuse_with(tools.error());
    }
    for (TableReader& table : root.tables("tool", "[[tool]]")) read_tool(table, context);
    for (TableReader& table : root.tables("length_offset", "[[length_offset]]"))
        read_length_offset(table, file);
    read_bodies(root, context);
    read_allowances(root, setup);
    check_allowance_names(root, setup);
    if (auto table = root.table("rules", "[rules]")) read_rules(*table, file);
    root.finish();
}

} // namespace

core::Result<SetupFile> read_setup(const std::string& path, const ProgramSettings& over) {
    SetupFile file;
    file.path = path;
    std::optional<core::Error> error;
    const auto parsed = parse(path);
    if (parsed) {
        BodyContext context{std::filesystem::path(path).parent_path(), {}, file};
        TableReader root(*parsed, "set-up", error);
        read_root(root, context, over, error);
        settle_start(file);
    } else {
        error = parsed.error();
    }
    if (!error) return file;
    if (error->file.empty()) error->file = path;
    return tl::unexpected(*error);
}

} // namespace app
