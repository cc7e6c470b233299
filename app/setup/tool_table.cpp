#include "app/setup/tool_table.h"

#include <set>
#include <string>

#include <fmt/format.h>

#include "app/setup/body_table.h"
#include "app/setup/holder_library.h"
#include "app/setup/holders/holder_preset.h"
#include "app/setup/setup_file.h"
#include "app/setup/table_reader.h"
#include "core/geom/mesh_file.h"
#include "core/geom/profile.h"
#include "core/sim/rules/rules.h"

namespace app {
namespace {

/// A value that nobody has stated, for a size of a tool.
constexpr const char* unknown_size = "unknown";

bool is_unknown(TableReader& table, const char* key) {
    return table.is_text(key) && table.string(key) == unknown_size;
}

/// The sizes that the table calls unknown.
std::set<std::string> unknown_sizes(TableReader& table) {
    std::set<std::string> keys;
    for (const core::ToolSize& size : core::tool_sizes())
        if (is_unknown(table, size.key)) keys.insert(size.key);
    return keys;
}

void read_size(TableReader& table, const core::ToolSize& size, core::ToolDescription& tool) {
    if (is_unknown(table, size.key)) return;
    size.put(tool, table.number(size.key, size.is_angle() ? Measure::angle : Measure::length));
}

void read_shape(TableReader& table, core::ToolDescription& tool) {
    std::vector<std::string_view> names;
    for (const core::ToolShapeEntry& entry : core::tool_shapes()) names.emplace_back(entry.name);
    const auto shape = table.word("shape", names);
    if (shape) tool.shape = *core::tool_shape_named(*shape);
    for (const core::ToolSize& size : core::tool_sizes()) read_size(table, size, tool);
    tool.teeth = table.integer("teeth");
    for (const std::vector<double>& row : table.rows("profile", Measure::length, 2))
        tool.outline.push_back({row[0], row[1]});
}

/// Diameter of the uncut centre of an end mill that cannot plunge, as a fraction of its diameter,
/// if not stated.
constexpr double usual_centre = 0.5;

void read_centre(TableReader& table, core::ToolDescription& tool) {
    tool.cuts_at_centre = table.boolean("cuts_at_centre").value_or(true);
    const auto diameter = table.number("centre_diameter", Measure::length);
    if (diameter && tool.cuts_at_centre)
        table.refuse("centre_diameter", "is for tools with cuts_at_centre = false");
    if (!tool.cuts_at_centre)
        tool.centre_radius = 0.5 * diameter.value_or(usual_centre * tool.diameter);
}

/// The length in the control: a number, or "unknown", which is checked as 0.
void read_touched_off(TableReader& table, core::ToolDescription& tool) {
    constexpr const char* key = "touched_off";
    if (!table.is_text(key)) {
        tool.touched_off = table.number(key, Measure::length);
    } else if (table.word(key, {"unknown"})) {
        tool.touched_off = 0.0;
        tool.length_is_guess = true;
    }
}

} // namespace

std::vector<std::string> notes_on(const core::ToolDescription& tool) {
    std::vector<std::string> notes;
    const int number = core::value_of(tool.number);
    if (tool.holder.empty())
        notes.push_back(fmt::format(
            "tool {} has no holder in the set-up: only the tool itself is checked", number));
    if (!tool.cuts_at_centre)
        notes.push_back(fmt::format("tool {} does not cut within {:g} mm of its axis; its face is "
                                    "assumed to be {:.3g} mm higher there",
                                    number, tool.centre_radius, core::centre_recess(tool)));
    if (has_size(tool.shape, &core::ToolDescription::pitch) && !tool.pitch)
        notes.push_back(fmt::format("tool {} has no pitch: it cuts like a cylinder around its "
                                    "crests, which removes the threads",
                                    number));
    return notes;
}

namespace {

void refuse_twice(TableReader& table, const core::ToolDescription& tool) {
    table.refuse("number", fmt::format("= {} is defined twice", core::value_of(tool.number)));
}

/// Adds a tool of which the table states only some values.
void add_partial(TableReader& table, const core::ToolDescription& tool, SetupFile& file) {
    if (!tool.outline.empty() && tool.shape != core::ToolShape::profile)
        return table.refuse("profile", "needs shape = \"profile\"");
    if (!tool.name.empty()) file.environment.tool_names.emplace(tool.name, tool.number);
    for (const core::ToolSize& size : core::tool_sizes()) {
        const auto value = size.of(tool);
        const std::string_view key = size.key;
        const bool may_be_zero = size.is_angle() || key == "corner_radius" || key == "tip_diameter";
        const bool is_stated = table.has(size.key) && !is_unknown(table, size.key);
        if (is_stated && value && (*value < 0.0 || (*value == 0.0 && !may_be_zero)))
            return table.refuse(size.key, may_be_zero ? "must not be negative" : "must be above 0");
    }
    PartialTool partial{tool, {}, {table.line(), 0, 0}};
    const std::set<std::string> unknown = unknown_sizes(table);
    for (const std::string& key : table.keys())
        if (!unknown.contains(key)) partial.stated.insert(key);
    if (file.setup.tools.contains(tool.number)
        || !file.partial_tools.emplace(tool.number, std::move(partial)).second)
        refuse_twice(table, tool);
}

} // namespace

void read_tool(TableReader& table, BodyContext& context) {
    table.limit_numbers();
    SetupFile& file = context.file;
    core::ToolDescription tool;
    const auto number = table.integer("number");
    if (!number) return table.need("number");
    tool.number = core::ToolNumber{*number};
    tool.is_in_inches = table.unit() == gcode::LengthUnit::inch;
    tool.name = table.string("name").value_or("");
    read_shape(table, tool);
    tool.shank = read_steps(table, "shank");
    read_touched_off(table, tool);
    tool.single_point = table.boolean("single_point").value_or(false);
    read_holder(table, context, tool);
    const auto spindle = table.word("spindle", {"clockwise", "counterclockwise"});
    tool.cuts = spindle == "counterclockwise" ? core::SpindleDirection::counterclockwise
                                              : core::SpindleDirection::clockwise;
    read_centre(table, tool);
    table.finish();
    if (!table.has("shape") || !unknown_sizes(table).empty()) return add_partial(table, tool, file);

    const auto assembled = core::assemble(tool);
    if (!assembled) return table.refuse_whole(assembled.error().message);
    if (file.partial_tools.contains(tool.number)
        || !file.setup.tools.emplace(tool.number, *assembled).second)
        refuse_twice(table, tool);
    file.environment.tool_names.emplace(tool.name, tool.number);
    file.environment.tool_lengths[tool.number] = assembled->length;
    if (tool.length_is_guess) file.environment.guessed_lengths.insert(tool.number);
    file.environment.tool_diameters[tool.number] = assembled->description.diameter;
    for (std::string& note : notes_on(tool)) file.assumptions.push_back(std::move(note));
}

void read_length_offset(TableReader& table, SetupFile& file) {
    table.limit_numbers();
    const auto number = table.integer("number");
    if (!number) return table.need("number");
    gcode::LengthOffset offset;
    const auto length = table.number("length", Measure::length);
    if (!length) return table.need("length");
    offset.length = *length;
    offset.wear = table.number_or("wear", Measure::length, 0.0);
    offset.diameter = table.number_or("diameter", Measure::length, 0.0);
    table.finish();
    const core::OffsetNumber key{*number};
    if (!file.lengths_set.insert(key).second)
        table.refuse("number", fmt::format("= {} is defined twice", *number));
    file.environment.length_offsets[key] = offset; // replaces the entry of a tool table
}

namespace {

constexpr double mesh_tolerance = 0.005; // mm by which cones may be larger than the mesh
constexpr double same_level = 0.01;      // mm; meshes have single precision

void put_holder(TableReader& table, core::Result<std::vector<core::ConeStep>> cones,
                core::ToolDescription& tool) {
    if (!cones) return table.refuse("holder", "= " + cones.error().message);
    tool.holder = *std::move(cones);
}

void read_named(TableReader& table, BodyContext& context, core::ToolDescription& tool) {
    const std::string name = table.string("holder").value_or("");
    const auto file = table.string("holder_file");
    if (!file) return put_holder(table, holder_cones(name), tool);
    const auto library = read_holder_library((context.folder / *file).generic_string());
    if (!library) return table.refuse_with(library.error());
    const auto found = library->find(name);
    if (found == library->end())
        return table.refuse("holder", fmt::format("\"{}\" is not in {}: {}", name, *file,
                                                  names_like(*library, name)));
    tool.holder = found->second;
}

/// Reads `{ preset = "NAME", length = 70, ... }`.
void read_preset_holder(TableReader& table, core::ToolDescription& tool) {
    auto sizes = table.table("holder", table.name() + " holder");
    if (!sizes) return;
    const auto name = sizes->string("preset");
    if (!name) return sizes->need("preset");
    const auto named = holder_named(*name);
    if (!named) return sizes->refuse("preset", "= " + named.error().message);
    PresetValues values = read_preset_values(*sizes, named->holder->preset);
    if (values.contains("length") && named->values.contains("length"))
        sizes->refuse("length", "is part of the name already");
    values.insert(named->values.begin(), named->values.end());
    sizes->finish();
    put_holder(table, holder_cones(*named->holder, values), tool);
}

void read_mesh_holder(TableReader& table, BodyContext& context, core::ToolDescription& tool) {
    const auto read = read_mesh_file(table, "holder_mesh", context.meshes());
    if (!read) return;
    const core::Mesh* mesh = &read->mesh;
    const std::string name = table.string("holder_mesh").value_or("");
    const double lowest = mesh->bounds().min.z;
    if (std::abs(lowest) > same_level)
        return table.refuse(
            "holder_mesh",
            fmt::format(
                "= \"{}\": the origin must be in its lower face, but the mesh begins at Z {:g}",
                name, lowest));
    tool.holder = cones_of_profile(core::revolved_hull(*mesh, mesh_tolerance));
    tool.holder_deviation = read->deviation;
    context.file.assumptions.push_back(
        fmt::format("tool {}: its holder is the smallest body of revolution that contains {}",
                    core::value_of(tool.number), name));
}

} // namespace

std::vector<core::ConeStep> read_steps(TableReader& table, const char* key) {
    std::vector<core::ConeStep> steps;
    if (table.row_length(key) == 2) {
        auto cones = cones_of_outline(table.rows(key, Measure::length, 2), table.unit());
        if (!cones) table.refuse(key, cones.error().message);
        return cones ? *std::move(cones) : steps;
    }
    for (const std::vector<double>& row : table.rows(key, Measure::length, 3))
        steps.push_back({row[0], row[1], row[2]});
    return steps;
}

void read_holder(TableReader& table, BodyContext& context, core::ToolDescription& tool) {
    if (table.has("holder") && table.has("holder_mesh"))
        return table.refuse("holder_mesh", "cannot be combined with holder");
    if (table.is_text("holder")) return read_named(table, context, tool);
    if (table.is_table("holder") && !table.has("holder_file"))
        return read_preset_holder(table, tool);
    if (table.has("holder_file"))
        return table.refuse("holder_file", "needs holder = \"NAME\" to choose one of its holders");
    if (table.has("holder_mesh")) return read_mesh_holder(table, context, tool);
    for (const char* absent : {"holder_file", "holder_mesh"}) table.string(absent);
    tool.holder = read_steps(table, "holder");
}

} // namespace app
