#include "app/setup/stated_setup.h"

#include <algorithm>

#include "app/setup/machines/machine_preset.h"
#include "app/setup/setup_length.h"
#include "app/setup/toml_file.h"
#include "core/sim/tool_description.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

/// Reads the numbers of a text. Lengths become mm.
struct StatedNumbers {
    gcode::LengthUnit unit;

    std::optional<double> length(const toml::node* node) const {
        const auto number = node ? node->value<double>() : std::nullopt;
        return number ? std::optional(gcode::to_mm(*number, unit)) : std::nullopt;
    }
    std::optional<core::Vec3> point(const toml::node* node) const;
    std::optional<core::Aabb> box(const toml::node* node) const;
    std::optional<StatedBody::Cylinder> cylinder(const toml::node* node) const;
    PresetValues preset_values(const toml::table& table, const Preset& preset) const;
    PresetValues machine_values(const toml::table& table, const MachinePreset& machine) const;
    StatedBody body(const toml::table& table) const;
};

std::optional<core::Vec3> vector_in(const toml::node* node) {
    const toml::array* list = node ? node->as_array() : nullptr;
    if (!list || list->size() != 3) return std::nullopt;
    core::Vec3 v(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const auto number = list->get(static_cast<size_t>(axis))->value<double>();
        if (!number) return std::nullopt;
        v[axis] = *number;
    }
    return v;
}

std::optional<core::Vec3> StatedNumbers::point(const toml::node* node) const {
    auto v = vector_in(node);
    for (int axis = 0; v && axis < 3; ++axis) (*v)[axis] = gcode::to_mm((*v)[axis], unit);
    return v;
}

std::optional<core::Aabb> StatedNumbers::box(const toml::node* node) const {
    const toml::array* list = node ? node->as_array() : nullptr;
    if (!list || list->size() != 2) return std::nullopt;
    const auto a = point(list->get(0)), b = point(list->get(1));
    if (!a || !b) return std::nullopt;
    core::Aabb corners;
    corners.extend(*a);
    corners.extend(*b);
    return corners;
}

std::optional<StatedBody::Cylinder> StatedNumbers::cylinder(const toml::node* node) const {
    const toml::table* table = node ? node->as_table() : nullptr;
    if (!table) return std::nullopt;
    const std::string axis = (*table)["axis"].value_or(std::string("Z"));
    return StatedBody::Cylinder{
        length(table->get("radius")).value_or(0.0), length(table->get("height")).value_or(0.0),
        axis.size() == 1 && axis[0] >= 'X' && axis[0] <= 'Z' ? axis[0] - 'X' : 2};
}

PresetValues StatedNumbers::machine_values(const toml::table& table,
                                           const MachinePreset& machine) const {
    PresetValues values;
    for (const MachineSize& size : machine.sizes) {
        const toml::node* node = table.get(size.key);
        const auto value = !is_angle(size.unit) ? length(node)
                           : node               ? node->value<double>()
                                                : std::nullopt;
        if (value) values.emplace(size.key, *value);
    }
    return values;
}

PresetValues StatedNumbers::preset_values(const toml::table& table, const Preset& preset) const {
    PresetValues values;
    for (const PresetParameter& parameter : preset.parameters) {
        const toml::node* node = table.get(parameter.key);
        const auto value = parameter.measure == PresetMeasure::length ? length(node)
                           : node                                     ? node->value<double>()
                                                                      : std::nullopt;
        if (value) values.emplace(parameter.key, *value);
    }
    return values;
}

StatedBody StatedNumbers::body(const toml::table& table) const {
    StatedBody read;
    read.name = table["name"].value_or(std::string());
    read.box = box(table.get("box"));
    read.cylinder = cylinder(table.get("cylinder"));
    read.mesh = table["mesh"].value_or(std::string());
    read.solid = table["solid"].value_or(std::string());
    read.mesh_deviation = length(table.get("mesh_deviation"));
    if (table["mesh_unit"].value<std::string>() == "inch") read.mesh_unit = gcode::LengthUnit::inch;
    read.model = table["model"].value_or(std::string());
    read.preset = table["preset"].value_or(std::string());
    if (const Preset* preset = find_preset(read.preset))
        read.preset_values = preset_values(table, *preset);
    read.at = point(table.get("at")).value_or(core::Vec3(0.0));
    read.rotate_deg = vector_in(table.get("rotate_deg")).value_or(core::Vec3(0.0));
    read.frame = table["frame"].value_or(std::string("G54"));
    read.expendable = table["expendable"].value_or(false);
    read.moves = table.contains("move");
    read.tolerance = length(table.get("tolerance"));
    read.margin = length(table.get("margin"));
    read.line = table.source().begin.line;
    return read;
}

/// Calls a function for each table of a list of tables.
template <typename See>
void visit_tables(const toml::table& root, const char* list, const See& see) {
    const toml::array* tables = root[list].as_array();
    for (size_t i = 0; tables && i < tables->size(); ++i)
        if (const toml::table* table = tables->get(i)->as_table()) see(*table);
}

} // namespace

const StatedBody* StatedSetup::fixture(const std::string& name) const {
    const auto found = std::find_if(fixtures.begin(), fixtures.end(),
                                    [&](const StatedBody& body) { return body.name == name; });
    return found == fixtures.end() ? nullptr : &*found;
}

bool StatedSetup::has_tool(core::ToolNumber number) const {
    return std::find(tools.begin(), tools.end(), number) != tools.end();
}

bool StatedSetup::has_offset(const std::string& name) const {
    return std::find(offsets.begin(), offsets.end(), name) != offsets.end();
}

TomlPath path_of_offset(const std::string& text, const std::string& name) {
    const auto index = gcode::offset_of_name(name);
    const auto root = parsed_toml(text);
    const toml::table* const offsets = root ? (*root)["offsets"].as_table() : nullptr;
    if (index && offsets)
        for (const auto& [key, value] : *offsets)
            if (gcode::offset_of_name(key.str()) == index)
                return {"offsets", std::string(key.str())};
    return {"offsets", name};
}

std::optional<double> stated_tool_size(const std::string& text, core::ToolNumber number,
                                       const core::ToolSize& size) {
    std::optional<double> value;
    const auto root = parsed_toml(text);
    if (!root) return value;
    const StatedNumbers numbers{unit_of_setup(*root)};
    visit_tables(*root, "tool", [&](const toml::table& table) {
        if (table["number"].value<int>() != core::value_of(number)) return;
        value =
            size.is_angle() ? table[size.key].value<double>() : numbers.length(table.get(size.key));
    });
    return value;
}

StatedSetup stated_in(const std::string& text) {
    StatedSetup stated;
    const auto root = parsed_toml(text);
    if (!root) return stated;
    stated.length_unit = unit_of_setup(*root);
    const StatedNumbers numbers{stated.length_unit};
    if (const toml::table* stock = (*root)["stock"].as_table()) stated.stock = numbers.body(*stock);
    if (const toml::table* part = (*root)["part"].as_table()) stated.part = numbers.body(*part);
    visit_tables(*root, "fixture",
                 [&](const toml::table& table) { stated.fixtures.push_back(numbers.body(table)); });
    visit_tables(*root, "tool", [&](const toml::table& table) {
        if (const auto number = table["number"].value<int>())
            stated.tools.push_back(core::ToolNumber{*number});
    });
    if (const toml::table* offsets = (*root)["offsets"].as_table())
        for (const auto& [name, value] : *offsets) {
            const std::string key(name.str());
            const auto index = gcode::offset_of_name(key);
            const std::string known = index ? gcode::name_of_offset(*index) : key;
            stated.offsets.push_back(known);
            core::Vec3 origin(0.0);
            for (int axis = 0; axis < 3; ++axis)
                origin[axis] = numbers.length((*offsets)[key][std::string(1, "XYZ"[axis])].node())
                                   .value_or(0.0);
            stated.origins[known] = origin;
        }
    size_t allowances = 0;
    visit_tables(*root, "allowance", [&](const toml::table& table) {
        const size_t index = allowances++;
        const auto name = [&](size_t side) { return table["between"][side].value<std::string>(); };
        if (name(0) && name(1))
            stated.allowances.push_back(
                {index, {*name(0), *name(1)}, numbers.length(table.get("distance"))});
    });
    stated.machine_file = (*root)["machine"]["file"].value_or(std::string());
    stated.ini = (*root)["program"]["ini"].value_or(std::string());
    stated.machine_preset = (*root)["machine"]["preset"].value_or(std::string());
    if (const MachinePreset* machine = find_machine_preset(stated.machine_preset))
        stated.machine_values = numbers.machine_values(*(*root)["machine"].as_table(), *machine);
    stated.tool_library = (*root)["tool_library"].value_or(std::string());
    stated.has_no_fixtures = (*root)["fixtures"].value<std::string>() == "none";
    return stated;
}

} // namespace app
