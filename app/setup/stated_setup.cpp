#include "app/setup/stated_setup.h"

#include <algorithm>

#include "app/setup/toml_file.h"
#include "core/sim/tool_description.h"

namespace app {
namespace {

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

std::optional<core::Aabb> box_in(const toml::node* node) {
    const toml::array* list = node ? node->as_array() : nullptr;
    if (!list || list->size() != 2) return std::nullopt;
    const auto a = vector_in(list->get(0)), b = vector_in(list->get(1));
    if (!a || !b) return std::nullopt;
    core::Aabb box;
    box.extend(*a);
    box.extend(*b);
    return box;
}

std::optional<StatedBody::Cylinder> cylinder_in(const toml::node* node) {
    const toml::table* table = node ? node->as_table() : nullptr;
    if (!table) return std::nullopt;
    const std::string axis = (*table)["axis"].value_or(std::string("Z"));
    return StatedBody::Cylinder{(*table)["radius"].value_or(0.0), (*table)["height"].value_or(0.0),
                                axis.size() == 1 && axis[0] >= 'X' && axis[0] <= 'Z' ? axis[0] - 'X'
                                                                                     : 2};
}

StatedBody body_in(const toml::table& table) {
    StatedBody body;
    body.name = table["name"].value_or(std::string());
    body.box = box_in(table.get("box"));
    body.cylinder = cylinder_in(table.get("cylinder"));
    body.mesh = table["mesh"].value_or(std::string());
    body.model = table["model"].value_or(std::string());
    body.at = vector_in(table.get("at")).value_or(core::Vec3(0.0));
    body.rotate_deg = vector_in(table.get("rotate_deg")).value_or(core::Vec3(0.0));
    body.frame = table["frame"].value_or(std::string("G54"));
    body.expendable = table["expendable"].value_or(false);
    body.tolerance = table["tolerance"].value<double>();
    body.margin = table["margin"].value<double>();
    body.line = table.source().begin.line;
    return body;
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

std::optional<double> stated_tool_size(const std::string& text, core::ToolNumber number,
                                       const core::ToolSize& size) {
    std::optional<double> value;
    const auto root = parsed_toml(text);
    if (!root) return value;
    visit_tables(*root, "tool", [&](const toml::table& table) {
        if (table["number"].value<int>() == core::value_of(number))
            value = table[size.key].value<double>();
    });
    return value;
}

StatedSetup stated_in(const std::string& text) {
    StatedSetup stated;
    const auto root = parsed_toml(text);
    if (!root) return stated;
    if (const toml::table* stock = (*root)["stock"].as_table()) stated.stock = body_in(*stock);
    if (const toml::table* part = (*root)["part"].as_table()) stated.part = body_in(*part);
    visit_tables(*root, "fixture",
                 [&](const toml::table& table) { stated.fixtures.push_back(body_in(table)); });
    visit_tables(*root, "tool", [&](const toml::table& table) {
        if (const auto number = table["number"].value<int>())
            stated.tools.push_back(core::ToolNumber{*number});
    });
    if (const toml::table* offsets = (*root)["offsets"].as_table())
        for (const auto& [name, value] : *offsets) {
            const std::string known(name.str());
            stated.offsets.push_back(known);
            core::Vec3 origin(0.0);
            for (int axis = 0; axis < 3; ++axis)
                origin[axis] = (*offsets)[known][std::string(1, "XYZ"[axis])].value_or(0.0);
            stated.origins[known] = origin;
        }
    stated.machine_file = (*root)["machine"]["file"].value_or(std::string());
    stated.tool_library = (*root)["tool_library"].value_or(std::string());
    stated.has_no_fixtures = (*root)["fixtures"].value<std::string>() == "none";
    return stated;
}

} // namespace app
