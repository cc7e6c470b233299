#include "app/setup/setup_changes.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/body_table.h"
#include "app/setup/machines/machine_preset.h"
#include "app/setup/presets/preset.h"
#include "app/setup/setup_length.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "app/setup/toml_file.h"
#include "app/setup/tools/found_tool.h"
#include "core/base/text.h"
#include "core/cad/cad_file.h"
#include "core/dbm/solid.h"
#include "core/sim/clearance.h"
#include "core/sim/tool_description.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

using core::ErrorCode;
using core::Result;

/// A chain of changes of a text; after an error nothing more is done.
class Changes {
public:
    explicit Changes(std::string text) : text_(std::move(text)) {}

    void set(const TomlPath& path, const std::string& value) {
        if (text_) text_ = toml_with_value(*text_, path, value);
    }
    void erase(const TomlPath& path) {
        if (text_) text_ = toml_without(*text_, path);
    }
    void apply(const std::function<Result<std::string>(const std::string&)>& change) {
        if (text_) text_ = change(*text_);
    }
    /// Whether the text so far has a value; false after an error.
    bool has(const TomlPath& path) const { return text_ && toml_has(*text_, path); }
    Result<std::string> text() && { return std::move(text_); }

private:
    Result<std::string> text_;
};

/// The element of a list of tables whose key has a value.
template <typename Value>
std::optional<size_t> index_of(const toml::table& root, const char* list, const char* key,
                               const Value& value) {
    const toml::array* tables = root[list].as_array();
    for (size_t i = 0; tables && i < tables->size(); ++i)
        if (const toml::table* table = tables->get(i)->as_table())
            if ((*table)[key].value<Value>() == value) return i;
    return std::nullopt;
}

std::optional<TomlPath> path_of(const char* list, const std::optional<size_t>& index) {
    return index ? std::optional(TomlPath{list, *index}) : std::nullopt;
}

toml::table root_of(const std::string& text) {
    auto parsed = parsed_toml(text);
    return parsed ? *std::move(parsed) : toml::table{};
}

/// The preset that a body in a set-up names; null if it names none that is known.
const Preset* preset_of(const std::string& text, const BodyPath& body) {
    const toml::table root = root_of(text);
    const toml::node* node = &root;
    const TomlPath path = body / "preset";
    for (const TomlPath::Step& step : path.steps()) {
        const auto* key = std::get_if<std::string>(&step);
        if (key)
            node = node->is_table() ? node->as_table()->get(*key) : nullptr;
        else
            node = node->is_array() ? node->as_array()->get(std::get<size_t>(step)) : nullptr;
        if (!node) return nullptr;
    }
    return find_preset(node->value_or(std::string()));
}

/// Removes the keys of the parameters of a body's preset, apart from those that another one has.
void drop_preset_values(Changes& changes, const BodyPath& body, const Preset* preset,
                        const Preset* other) {
    if (!preset) return;
    for (const PresetParameter& parameter : preset->parameters)
        if (!other || !other->parameter(parameter.key))
            changes.erase(body / std::string(parameter.key));
}

/// Removes the keys of a body's shape, apart from one. `preset`: that of the body before.
void keep_shape(Changes& changes, const BodyPath& body, std::string_view shape,
                const Preset* preset) {
    for (const char* key : {"box", "cylinder", "mesh", "model", "preset", "margin"})
        if (key != shape) changes.erase(body / key);
    if (shape != "mesh")
        for (const char* key : {"mesh_unit", "solid", "mesh_deviation"}) changes.erase(body / key);
    if (shape != "preset") drop_preset_values(changes, body, preset, nullptr);
}

bool is_zero(const core::Vec3& v) { return v == core::Vec3(0.0); }

/// Sets a vector with this text, unless it is 0 and not there.
void set_vector(Changes& changes, const TomlPath& path, const core::Vec3& value,
                const std::string& written) {
    if (!is_zero(value) || changes.has(path)) changes.set(path, written);
}

/// Whether bodies other than the stock stand in the frame of a body.
bool carries_others(const toml::table& root, const std::string& name) {
    const auto is_carried = [&](const toml::node& node) {
        const toml::table* table = node.as_table();
        return table && (*table)["frame"].value<std::string>() == name;
    };
    const toml::array* fixtures = root["fixture"].as_array();
    return (root["part"].node() && is_carried(*root["part"].node()))
           || (fixtures && std::any_of(fixtures->begin(), fixtures->end(), is_carried));
}

/// Visits the names in `between` of all allowances: path and name.
void visit_between(const toml::table& root,
                   const std::function<void(const TomlPath&, const std::string&)>& see) {
    const toml::array* rules = root["allowance"].as_array();
    for (size_t i = 0; rules && i < rules->size(); ++i)
        for (size_t side = 0; side < 2; ++side)
            if (const auto name = root["allowance"][i]["between"][side].value<std::string>())
                see(TomlPath{"allowance", i, "between", side}, *name);
}

/// The bodies that stand in a frame, in words: the stock, the part, fixtures by their names. A body
/// without a frame stands in G54.
std::vector<std::string> bodies_in_offset(const toml::table& root, size_t offset) {
    std::vector<std::string> names;
    const auto see = [&](const toml::node* node, const std::string& name) {
        const toml::table* table = node ? node->as_table() : nullptr;
        if (table
            && gcode::offset_of_name((*table)["frame"].value_or(std::string("G54"))) == offset)
            names.push_back(name);
    };
    see(root.get("stock"), "the stock");
    see(root.get("part"), "the part");
    const toml::array* fixtures = root["fixture"].as_array();
    for (size_t i = 0; fixtures && i < fixtures->size(); ++i)
        see(fixtures->get(i),
            fmt::format("\"{}\"", root["fixture"][i]["name"].value_or(std::string())));
    return names;
}

Result<void> check_new_name(const std::string& text, const std::string& name) {
    if (name.empty()) return core::fail(ErrorCode::invalid_value, "a fixture needs a name");
    if (const std::string why = why_no_fixture_name(name); !why.empty())
        return core::fail(ErrorCode::invalid_value, fmt::format("\"{}\" {}", name, why));
    if (path_of_fixture(text, name))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("there is a fixture \"{}\" already", name));
    return {};
}

tl::unexpected<core::Error> no_fixture(const std::string& name) {
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("there is no fixture \"{}\" in the set-up", name));
}

/// A value as TOML.
std::string value_text(const toml::node& value) {
    if (const auto text = value.value<std::string>()) return toml_text(*text);
    std::ostringstream text;
    value.visit([&](const auto& v) { text << v; });
    return text.str();
}

/// The lines of a table without its header, from a text that begins with it.
std::string body_of(const std::string& table) {
    const size_t header = table.find("]");
    const size_t end = table.find('\n', header);
    return table.substr(end + 1);
}

} // namespace

std::optional<BodyPath> path_of_fixture(const std::string& text, std::string_view name) {
    return path_of("fixture", index_of(root_of(text), "fixture", "name", std::string(name)));
}

std::optional<TomlPath> path_of_tool(const std::string& text, core::ToolNumber number) {
    return path_of("tool",
                   index_of(root_of(text), "tool", "number", int64_t{core::value_of(number)}));
}

Result<std::string> with_stock(const std::string& text, const core::Solid& stock,
                               std::string_view frame) {
    const TomlPath path = "stock";
    const bool is_new = !toml_has(text, path);
    Changes changes(text);
    if (const auto* box = std::get_if<core::SolidBox>(&stock.shape)) {
        for (const char* key : {"at", "rotate_deg"}) changes.erase(path / key);
        changes.apply([&](const std::string& t) { return with_box(t, path, box->box); });
    } else if (const auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) {
        changes.erase(path / "rotate_deg");
        changes.apply([&](const std::string& t) {
            return with_cylinder(t, path, round->radius, round->height, round->axis);
        });
        changes.apply(
            [&](const std::string& t) { return with_pose(t, path, round->base, core::Vec3(0.0)); });
    } else {
        return core::fail(ErrorCode::unsupported, "only a box or a cylinder can be stated here");
    }
    if (is_new) changes.set(path / "frame", toml_text(frame));
    changes.apply([](const std::string& t) { return with_known(t, "stock"); });
    return std::move(changes).text();
}

Result<std::string> with_box(const std::string& text, const BodyPath& body, const core::Aabb& box) {
    const gcode::LengthUnit unit = unit_of_setup(text);
    Changes changes(text);
    changes.set(body / "box",
                fmt::format("[{}, {}]", setup_point(box.min, unit), setup_point(box.max, unit)));
    keep_shape(changes, body, "box", preset_of(text, body));
    return std::move(changes).text();
}

Result<std::string> with_cylinder(const std::string& text, const BodyPath& body, double radius,
                                  double height, int axis) {
    const gcode::LengthUnit unit = unit_of_setup(text);
    Changes changes(text);
    changes.set(body / "cylinder",
                fmt::format("{{ radius = {}, height = {}, axis = \"{}\" }}",
                            setup_length(radius, unit), setup_length(height, unit), "XYZ"[axis]));
    keep_shape(changes, body, "cylinder", preset_of(text, body));
    return std::move(changes).text();
}

Result<std::string> with_mesh(const std::string& text, const BodyPath& body,
                              const std::string& file) {
    Changes changes(text);
    changes.set(body / "mesh", toml_text(file));
    changes.erase(body / "solid"); // of another file
    if (core::is_cad_file(file))
        changes.erase(body / "mesh_unit");
    else
        changes.erase(body / "mesh_deviation");
    keep_shape(changes, body, "mesh", preset_of(text, body));
    return std::move(changes).text();
}

Result<std::string> with_preset(const std::string& text, const BodyPath& body,
                                std::string_view name) {
    const Preset* preset = find_preset(name);
    if (!preset) return core::fail(ErrorCode::invalid_value, unknown_preset_text(name));
    Changes changes(text);
    changes.set(body / "preset", toml_text(name));
    keep_shape(changes, body, "preset", nullptr);
    drop_preset_values(changes, body, preset_of(text, body), preset);
    return std::move(changes).text();
}

Result<std::string> with_preset_value(const std::string& text, const BodyPath& body,
                                      std::string_view key, std::optional<double> value) {
    const Preset* preset = preset_of(text, body);
    if (!preset) return core::fail(ErrorCode::invalid_value, "this body has no preset");
    const TomlPath path = body / std::string(key);
    const bool is_known = preset->parameter(key) != nullptr;
    if (!value && is_known) return toml_without(text, path);
    if (const auto valid = check_preset_value(*preset, key, value.value_or(0.0)); !valid)
        return tl::unexpected(valid.error());
    const bool is_length = preset->parameter(key)->measure == PresetMeasure::length;
    return toml_with_value(
        text, path, is_length ? setup_length(*value, unit_of_setup(text)) : setup_number(*value));
}

Result<std::string> with_mesh_deviation(const std::string& text, const BodyPath& body,
                                        double deviation) {
    constexpr int decimals = 7; // the least deviation in inches has six
    return toml_with_value(
        text, body / "mesh_deviation",
        core::number_text(gcode::from_mm(deviation, unit_of_setup(text)), decimals));
}

Result<std::string> with_mesh_unit(const std::string& text, const BodyPath& body,
                                   gcode::LengthUnit unit) {
    if (unit == gcode::LengthUnit::mm) return toml_without(text, body / "mesh_unit");
    return toml_with_value(text, body / "mesh_unit", "\"inch\"");
}

Result<std::string> with_pose(const std::string& text, const BodyPath& body, const core::Vec3& at,
                              const core::Vec3& rotate_deg) {
    Changes changes(text);
    set_vector(changes, body / "at", at, setup_point(at, unit_of_setup(text)));
    set_vector(changes, body / "rotate_deg", rotate_deg, setup_vector(rotate_deg));
    return std::move(changes).text();
}

Result<std::string> with_fixture(const std::string& text, const std::string& name,
                                 const std::string& lines) {
    if (const auto fits = check_new_name(text, name); !fits) return tl::unexpected(fits.error());
    Changes changes(text);
    changes.erase("fixtures");
    changes.apply([&](const std::string& t) {
        return toml_with_table(t, "fixture", "name = " + toml_text(name) + "\n" + lines);
    });
    return std::move(changes).text();
}

Result<std::string> with_copied_fixture(const std::string& text, const std::string& name,
                                        const std::string& copy) {
    const auto path = path_of_fixture(text, name);
    if (!path) return no_fixture(name);
    if (const auto fits = check_new_name(text, copy); !fits) return tl::unexpected(fits.error());
    const size_t index = std::get<size_t>(path->steps()[1]);
    FEELER_TRY(const std::string body, toml_body_of(text, "fixture", index));
    FEELER_TRY(const std::string more, toml_with_table(text, "fixture", body));
    const size_t last = root_of(more)["fixture"].as_array()->size() - 1;
    Changes changes(more);
    changes.set({"fixture", last, "name"}, toml_text(copy));
    changes.erase({"fixture", last, "move"});
    return std::move(changes).text();
}

Result<std::string> without_fixture(const std::string& text, const std::string& name) {
    const auto path = path_of_fixture(text, name);
    if (!path) return no_fixture(name);
    const toml::table root = root_of(text);
    if (carries_others(root, name))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("other bodies are positioned relative to \"{}\": give them "
                                      "another frame first",
                                      name));
    bool is_named = false;
    visit_between(root, [&](const TomlPath&, const std::string& other) {
        is_named = is_named || other == name;
    });
    if (is_named)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("a minimum clearance ([[allowance]]) names \"{}\": remove it "
                                      "first",
                                      name));
    return toml_without(text, *path);
}

Result<std::string> with_renamed_fixture(const std::string& text, const std::string& name,
                                         const std::string& other) {
    const auto path = path_of_fixture(text, name);
    if (!path) return no_fixture(name);
    if (other == name) return text;
    if (const auto fits = check_new_name(text, other); !fits) return tl::unexpected(fits.error());
    Changes changes(text);
    changes.set(*path / "name", toml_text(other));
    const toml::table root = root_of(text);
    visit_between(root, [&](const TomlPath& at, const std::string& named) {
        if (named == name) changes.set(at, toml_text(other));
    });
    const toml::array* fixtures = root["fixture"].as_array();
    for (size_t i = 0; fixtures && i < fixtures->size(); ++i)
        if (root["fixture"][i]["frame"].value<std::string>() == name)
            changes.set({"fixture", i, "frame"}, toml_text(other));
    if (root["part"]["frame"].value<std::string>() == name)
        changes.set({"part", "frame"}, toml_text(other));
    return std::move(changes).text();
}

std::string free_name(const std::string& text, const std::string& name) {
    const bool is_reserved = !why_no_fixture_name(name).empty();
    if (is_reserved) return free_name(text, name + "-1");
    if (!path_of_fixture(text, name)) return name;
    std::string stem = name; // "clamp-1" becomes "clamp-2"
    while (!stem.empty() && stem.back() >= '0' && stem.back() <= '9') stem.pop_back();
    if (stem == name || stem.empty()) stem = name + "-";
    int number = 2;
    while (path_of_fixture(text, stem + std::to_string(number))) ++number;
    return stem + std::to_string(number);
}

Result<std::string> with_tool_value(const std::string& text, core::ToolNumber number,
                                    const std::string& key,
                                    const std::optional<std::string>& value) {
    const auto path = path_of_tool(text, number);
    if (path && value) return toml_with_value(text, *path / key, *value);
    if (path) return toml_without(text, *path / key);
    if (!value) return text;
    return toml_with_table(
        text, "tool", fmt::format("number = {}\n{} = {}\n", core::value_of(number), key, *value));
}

Result<std::string> with_tool_size(const std::string& text, core::ToolNumber number,
                                   const core::ToolSize& size, double value) {
    if (value == 0.0) return with_tool_value(text, number, size.key, std::nullopt);
    return with_tool_value(text, number, size.key,
                           size.is_angle() ? setup_number(value)
                                           : setup_length(value, unit_of_setup(text)));
}

namespace {

/// The text with these lines as the `[[tool]]` of a number. Values that stay keep their comments.
/// `kept`: keys that stay if the lines have none of them.
Result<std::string> with_tool_lines(const std::string& text, core::ToolNumber number,
                                    const std::string& lines,
                                    const std::set<std::string>& kept = {}) {
    const auto path = path_of_tool(text, number);
    if (!path) return toml_with_table(text, "tool", lines);
    const toml::table wanted = root_of(lines);
    const toml::table root = root_of(text);
    const size_t index = std::get<size_t>(path->steps()[1]);
    const toml::table* before = root["tool"][index].as_table();
    const bool replaces_kept = std::any_of(
        kept.begin(), kept.end(), [&](const std::string& key) { return wanted.contains(key); });
    Changes changes(text);
    for (const auto& [key, value] : *before) {
        const std::string name(key.str());
        const bool stays = wanted.contains(name) || (!replaces_kept && kept.contains(name));
        if (!stays) changes.erase(*path / name);
    }
    for (const auto& [key, value] : wanted) {
        const toml::node* old = before->get(key);
        const std::string now = value_text(value);
        if (!old || value_text(*old) != now) changes.set(*path / std::string(key.str()), now);
    }
    return std::move(changes).text();
}

} // namespace

Result<std::string> with_tool(const std::string& text, const core::ToolDescription& tool) {
    return with_tool_lines(text, tool.number, body_of(tool_table(tool, unit_of_setup(text))));
}

Result<std::string> with_found_tool(const std::string& text, const FoundTool& tool) {
    return with_tool_lines(text, tool.tool.number, found_tool_lines(tool, unit_of_setup(text)),
                           {"holder", "holder_file", "holder_mesh", "mesh_unit"});
}

Result<std::string> with_bare_tool(const std::string& text, core::ToolNumber number) {
    if (path_of_tool(text, number)) return text;
    return toml_with_table(text, "tool", fmt::format("number = {}\n", core::value_of(number)));
}

Result<std::string> without_tool(const std::string& text, core::ToolNumber number) {
    const auto path = path_of_tool(text, number);
    return path ? toml_without(text, *path) : Result<std::string>(text);
}

namespace {

Result<void> check_new_number(const std::string& text, core::ToolNumber number) {
    if (core::value_of(number) < 0)
        return core::fail(ErrorCode::invalid_value, "the number of a tool is 0 or above");
    if (path_of_tool(text, number))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("there is a tool {} already: choose another number",
                                      core::value_of(number)));
    return {};
}

std::string number_text(core::ToolNumber number) { return std::to_string(core::value_of(number)); }

} // namespace

Result<std::string> with_copied_tool(const std::string& text, core::ToolNumber number,
                                     core::ToolNumber copy) {
    const auto path = path_of_tool(text, number);
    if (!path) return text;
    if (const auto fits = check_new_number(text, copy); !fits) return tl::unexpected(fits.error());
    FEELER_TRY(const std::string body,
               toml_body_of(text, "tool", std::get<size_t>(path->steps()[1])));
    FEELER_TRY(const std::string more, toml_with_table(text, "tool", body));
    const size_t last = root_of(more)["tool"].as_array()->size() - 1;
    return toml_with_value(more, {"tool", last, "number"}, number_text(copy));
}

Result<std::string> with_tool_number(const std::string& text, core::ToolNumber number,
                                     core::ToolNumber other) {
    const auto path = path_of_tool(text, number);
    if (!path || number == other) return text;
    if (const auto fits = check_new_number(text, other); !fits) return tl::unexpected(fits.error());
    const TomlPath at_start{"program", "tool_at_start"};
    const bool is_held = root_of(text)["program"]["tool_at_start"].value<int64_t>()
                         == int64_t{core::value_of(number)};
    Changes changes(text);
    changes.set(*path / "number", number_text(other));
    if (is_held) changes.set(at_start, number_text(other));
    return std::move(changes).text();
}

Result<std::string> with_offset(const std::string& text, const std::string& name,
                                const core::Vec3& origin) {
    const TomlPath path = path_of_offset(text, name);
    const bool is_new = !toml_has(text, path);
    const gcode::LengthUnit unit = unit_of_setup(text);
    Changes changes(text);
    if (is_new)
        changes.set(path, fmt::format("{{ X = {}, Y = {}, Z = {} }}", setup_length(origin.x, unit),
                                      setup_length(origin.y, unit), setup_length(origin.z, unit)));
    for (int axis = 0; axis < 3 && !is_new; ++axis)
        changes.set(path / std::string(1, "XYZ"[axis]), setup_length(origin[axis], unit));
    changes.apply([](const std::string& t) { return with_known(t, "offsets"); });
    return std::move(changes).text();
}

Result<std::string> without_offset(const std::string& text, const std::string& name) {
    const auto offset = gcode::offset_of_name(name);
    const TomlPath path = path_of_offset(text, name);
    if (offset && toml_has(text, path))
        if (const auto bodies = bodies_in_offset(root_of(text), *offset); !bodies.empty())
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("{} {} positioned in {}: give {} another frame first",
                                          fmt::join(bodies, ", "),
                                          bodies.size() == 1 ? "is" : "are", name,
                                          bodies.size() == 1 ? "it" : "them"));
    FEELER_TRY(std::string left, toml_without(text, path));
    const toml::table root = root_of(left);
    const toml::table* offsets = root["offsets"].as_table();
    if (offsets && offsets->empty()) return toml_without(left, "offsets");
    return left;
}

Result<std::string> with_part_tolerance(const std::string& text, double tolerance) {
    return toml_with_value(text, {"part", "tolerance"},
                           setup_length(tolerance, unit_of_setup(text)));
}

namespace {

Result<void> check_allowance(const std::string& text, double distance) {
    if (distance >= 0.0 && distance <= core::largest_allowance) return {};
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("a minimum clearance lies between 0 and {}",
                                  setup_length(core::largest_allowance, unit_of_setup(text))));
}

} // namespace

Result<std::string> with_allowance(const std::string& text, std::optional<double> distance) {
    if (const auto fits = check_allowance(text, distance.value_or(0.0)); !fits)
        return tl::unexpected(fits.error());
    const toml::table root = root_of(text);
    const toml::array* rules = root["allowance"].as_array();
    const std::string value = setup_length(distance.value_or(0.0), unit_of_setup(root));
    if (!rules)
        return distance ? toml_with_value(text, "allowance", value)
                        : toml_without(text, "allowance");
    for (size_t i = 0; i < rules->size(); ++i) {
        if (root["allowance"][i]["between"]) continue;
        return distance ? toml_with_value(text, {"allowance", i, "distance"}, value)
                        : toml_without(text, {"allowance", i});
    }
    if (!distance) return text;
    return toml_with_table(text, "allowance", "distance = " + value + "\n");
}

Result<std::string> with_pair_allowance(const std::string& text, size_t index, double distance) {
    if (const auto fits = check_allowance(text, distance); !fits)
        return tl::unexpected(fits.error());
    return toml_with_value(text, {"allowance", index, "distance"},
                           setup_length(distance, unit_of_setup(text)));
}

Result<std::string> without_pair_allowance(const std::string& text, size_t index) {
    return toml_without(text, {"allowance", index});
}

Result<std::string> with_new_pair_allowance(const std::string& text,
                                            const std::array<std::string, 2>& between,
                                            double distance) {
    const gcode::LengthUnit unit = unit_of_setup(text);
    std::string list = text;
    // TOML has no number and list of one name: the general one becomes a member of the list.
    const toml::table root = root_of(text);
    if (const auto general = root["allowance"].value<double>()) {
        FEELER_TRY(list, toml_without(list, "allowance"));
        FEELER_TRY(list, toml_with_table(list, "allowance",
                                         "distance = " + setup_number(*general) + "\n"));
    }
    return toml_with_table(list, "allowance",
                           fmt::format("between = [{}, {}]\ndistance = {}\n", toml_text(between[0]),
                                       toml_text(between[1]), setup_length(distance, unit)));
}

Result<std::string> with_known(const std::string& text, std::string_view word) {
    const toml::table root = root_of(text);
    const toml::array* words = root["assumed"].as_array();
    std::vector<std::string> left;
    for (size_t i = 0; words && i < words->size(); ++i)
        if (const auto one = root["assumed"][i].value<std::string>(); one && *one != word)
            left.push_back(toml_text(*one));
    if (!words || left.size() == words->size()) return text;
    if (left.empty()) return toml_without(text, "assumed");
    return toml_with_value(text, "assumed", fmt::format("[{}]", fmt::join(left, ", ")));
}

namespace {

/// The preset of the machine; null if it has none that is known.
const MachinePreset* machine_preset_of(const std::string& text) {
    const toml::table root = root_of(text);
    return find_machine_preset(root["machine"]["preset"].value_or(std::string()));
}

/// Removes the keys of the sizes of the machine's preset, apart from those that another one has.
void drop_machine_values(Changes& changes, const std::string& text, const MachinePreset* other) {
    const MachinePreset* const preset = machine_preset_of(text);
    if (!preset) return;
    for (const MachineSize& size : preset->sizes)
        if (!other || !other->size(size.key)) changes.erase({"machine", std::string(size.key)});
}

} // namespace

Result<std::string> with_machine_file(const std::string& text, const std::string& file) {
    Changes changes(text);
    drop_machine_values(changes, text, nullptr);
    changes.erase({"machine", "preset"});
    if (file.empty())
        changes.erase({"machine", "file"});
    else
        changes.set({"machine", "file"}, toml_text(file));
    return std::move(changes).text();
}

Result<std::string> with_machine_preset(const std::string& text, std::string_view name) {
    const MachinePreset* const preset = find_machine_preset(name);
    if (!preset) return core::fail(ErrorCode::invalid_value, unknown_machine_text(name));
    Changes changes(text);
    drop_machine_values(changes, text, preset);
    changes.erase({"machine", "file"});
    changes.set({"machine", "preset"}, toml_text(name));
    return std::move(changes).text();
}

Result<std::string> with_machine_value(const std::string& text, std::string_view key,
                                       std::optional<double> value) {
    const MachinePreset* const preset = machine_preset_of(text);
    if (!preset) return core::fail(ErrorCode::invalid_value, "the machine has no preset");
    const TomlPath path{"machine", std::string(key)};
    const MachineSize* const size = preset->size(key);
    if (!value && size) return toml_without(text, path);
    if (const auto valid = check_machine_value(*preset, key, value.value_or(0.0)); !valid)
        return tl::unexpected(valid.error());
    return toml_with_value(text, path,
                           is_angle(size->unit) ? setup_number(*value)
                                                : setup_length(*value, unit_of_setup(text)));
}

} // namespace app
