#include "app/setup/setup_text.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/base/text.h"
#include "app/setup/coverage.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_length.h"
#include "app/setup/table_reader.h"
#include "core/sim/tool_assembly.h"
#include "gcode/language/canonical.h"
#include "gcode/language/dialect.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

using gcode::LengthUnit;

std::string length_key(const char* name, double mm, LengthUnit unit) {
    return fmt::format("{} = {}\n", name, exact_length(mm, unit));
}

std::string cones(const char* name, const std::vector<core::ConeStep>& steps, LengthUnit unit) {
    std::vector<std::string> rows;
    for (const core::ConeStep& s : steps)
        rows.push_back(fmt::format("[{}, {}, {}]", exact_length(s.lower_diameter, unit),
                                   exact_length(s.upper_diameter, unit),
                                   exact_length(s.length, unit)));
    return rows.empty() ? "" : fmt::format("{} = [{}]\n", name, fmt::join(rows, ", "));
}

std::string outline(const core::ToolDescription& tool, LengthUnit unit) {
    std::vector<std::string> rows;
    for (const auto& [r, z] : tool.outline)
        rows.push_back(fmt::format("[{}, {}]", exact_length(r, unit), exact_length(z, unit)));
    return rows.empty() ? "" : fmt::format("profile = [{}]\n", fmt::join(rows, ", "));
}

/// The keys that precede a size in the file.
std::string before(std::string_view key, const core::ToolDescription& tool, LengthUnit unit) {
    if (key == "neck_diameter") return outline(tool, unit);
    if (key == "shank_diameter")
        return (tool.teeth ? fmt::format("teeth = {}\n", *tool.teeth) : std::string())
               + cones("shank", tool.shank, unit);
    return key == "gauge_length" ? cones("holder", tool.holder, unit) : std::string();
}

std::string touched_off(const core::ToolDescription& tool, LengthUnit unit) {
    if (tool.length_is_guess)
        return "touched_off = \"unknown\"     # length that the control uses: 0 where it matters; "
               "state it, or remove this to use the true length\n";
    if (!tool.touched_off) return {};
    return fmt::format("touched_off = {}     # length that the control uses, matching the work "
                       "offset; remove it to use the true length\n",
                       exact_length(*tool.touched_off, unit));
}

std::string sizes(const core::ToolDescription& tool, LengthUnit unit) {
    std::string text;
    for (const core::ToolSize& size : core::tool_sizes()) {
        text += before(size.key, tool, unit);
        const auto value = size.of(tool);
        if (value && size.is_angle())
            text += fmt::format("{} = {}\n", size.key, toml_number(*value));
        else if (value)
            text += length_key(size.key, *value, unit);
    }
    return text + touched_off(tool, unit);
}

void round_cones(std::vector<core::ConeStep>& steps, LengthUnit unit) {
    for (core::ConeStep& step : steps)
        step = {rounded_length(step.lower_diameter, unit),
                rounded_length(step.upper_diameter, unit), rounded_length(step.length, unit)};
}

/// A tool with rounded lengths.
core::ToolDescription rounded_tool(core::ToolDescription tool, LengthUnit unit) {
    for (const core::ToolSize& size : core::tool_sizes())
        if (const auto value = size.of(tool); value && !size.is_angle())
            size.put(tool, rounded_length(*value, unit));
    for (auto& [r, z] : tool.outline) {
        r = rounded_length(r, unit);
        z = rounded_length(z, unit);
    }
    round_cones(tool.shank, unit);
    round_cones(tool.holder, unit);
    if (tool.touched_off) tool.touched_off = rounded_length(*tool.touched_off, unit);
    tool.centre_radius = 0.5 * rounded_length(2.0 * tool.centre_radius, unit);
    return tool;
}

} // namespace

std::string toml_text(std::string_view text) {
    std::string safe;
    for (const char c : utf8_text(text)) {
        const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
        if (c == '"' || c == '\\') safe += '\\';
        if (is_control)
            safe += fmt::format("\\u{:04x}", c);
        else
            safe += c;
    }
    return "\"" + safe + "\"";
}

std::string tool_table(const core::ToolDescription& exact, LengthUnit unit) {
    core::ToolDescription tool = exact;
    if (unit == LengthUnit::inch) tool = rounded_tool(exact, unit);
    if (!core::assemble(tool)) tool = exact;
    std::string text = "\n[[tool]]\n";
    text += fmt::format("number = {}\n", core::value_of(tool.number));
    if (!tool.name.empty()) text += fmt::format("name = {}\n", toml_text(tool.name));
    text += fmt::format("shape = \"{}\"\n", core::name_of(tool.shape));
    if (tool.diameter == 0.0) text += length_key("diameter", 0.0, unit);
    text += sizes(tool, unit);
    if (tool.cuts == core::SpindleDirection::counterclockwise)
        text += "spindle = \"counterclockwise\"\n";
    if (!tool.cuts_at_centre)
        text += "cuts_at_centre = false\n"
                + length_key("centre_diameter", 2.0 * tool.centre_radius, unit);
    if (tool.single_point) text += "single_point = true\n";
    return text;
}

namespace {

/// A text as comment lines; a line end in it does not end the comment.
std::string comment(const std::string& text) {
    std::string lines;
    for (const char c : wrapped(utf8_text(text), 1)) {
        const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
        lines += is_control && c != '\n' ? ' ' : c;
    }
    std::string commented;
    for (size_t at = 0; at < lines.size();) {
        const size_t end = std::min(lines.find('\n', at), lines.size());
        commented += "#" + lines.substr(at, end - at) + "\n";
        at = end + 1;
    }
    return commented;
}

/// A line of the file with a remark in a common column. `is_known`: else it is commented out.
std::string line(bool is_known, const std::string& statement, const std::string& remark = {}) {
    constexpr size_t column = 30;
    std::string text = (is_known ? "" : "#") + statement;
    if (remark.empty()) return text + "\n";
    text.resize(std::max(text.size() + 2, column), ' ');
    return text + "# " + remark + "\n";
}

std::string stated(std::string_view key, const std::string& value) {
    return fmt::format("{} = {}", key, value);
}

/// Writes a length of which the set-up is to state a value, or to assume it.
using WrittenLength = std::string (*)(double mm, LengthUnit unit);

WrittenLength written_length(bool is_known) { return is_known ? setup_length : assumed_length; }

std::string position_text(const gcode::Position& position, WrittenLength length, LengthUnit unit) {
    std::vector<std::string> axes;
    for (size_t i = 0; i < position.size(); ++i)
        if (position[i] && (i < 3 || *position[i] != 0.0))
            axes.push_back(fmt::format("{} = {}", core::axis_letters[i],
                                       core::is_rotary(i) ? setup_number(*position[i])
                                                          : length(*position[i], unit)));
    return fmt::format("{{ {} }}", fmt::join(axes, ", "));
}

std::string origin_text(const gcode::AxisValues& origin, LengthUnit unit) {
    gcode::Position position;
    for (size_t i = 0; i < position.size(); ++i) position[i] = origin[i];
    return position_text(position, assumed_length, unit);
}

/// A path as it is stated in a file of this folder.
std::string path_text(const std::string& path, const std::string& folder) {
    std::error_code failed;
    const auto near = std::filesystem::proximate(path, folder.empty() ? "." : folder, failed);
    return toml_text((failed ? std::filesystem::path(path) : near).generic_string());
}

/// What the options of the command line state.
std::string options_text(const SetupFile& setup, const SetupOrigin& origin) {
    const ProgramSettings& options = origin.settings;
    const gcode::Environment& environment = setup.environment;
    std::string text;
    const auto state = [&](const char* key, const std::string& value) {
        text += line(true, stated(key, value));
    };
    if (environment.machine_unit == gcode::LengthUnit::inch) state("unit", "\"inch\"");
    if (const auto units = environment.units_at_start)
        state("units_at_start", *units == gcode::LengthUnit::inch ? "\"inch\"" : "\"mm\"");
    if (environment.counts_smallest_steps) state("no_decimal_point", "\"steps\"");
    if (environment.block_delete) state("block_delete", "true");
    if (options.max_blocks) state("max_blocks", fmt::format("{}", *options.max_blocks));
    if (!options.ini.empty()) state("ini", path_text(options.ini, origin.folder));
    if (!options.parameters.empty())
        state("parameters", path_text(options.parameters, origin.folder));
    if (!options.tool_table.empty())
        state("tool_table", path_text(options.tool_table, origin.folder));
    std::vector<std::string> folders;
    for (const std::string& path : options.search_path)
        folders.push_back(path_text(path, origin.folder));
    if (!folders.empty()) state("search_path", fmt::format("[{}]", fmt::join(folders, ", ")));
    return text;
}

std::string program_text(const SetupFile& setup, const SetupOrigin& origin) {
    const std::optional<core::ToolNumber> tool = setup.setup.tool_at_start;
    std::string text = "\n[program]\n";
    if (setup.dialect)
        text += line(true, stated("dialect", toml_text(gcode::dialect(*setup.dialect).name)));
    text += options_text(setup, origin);
    text +=
        line(!setup.infers_start,
             stated("start", position_text(setup.environment.start,
                                           written_length(!setup.infers_start), setup.length_unit)),
             "machine coordinates");
    if (tool)
        text += line(false, stated("tool_at_start", fmt::format("{}", core::value_of(*tool))),
                     "it cuts before the first tool call");
    if (setup.setup.spindle_at_start == core::SpindleDirection::clockwise)
        text +=
            line(false, stated("spindle_at_start", "\"clockwise\""), "the program never starts it");
    if (setup.speed_by_hand)
        text += line(false, stated("speed_by_hand", "true"), "the program has no S");
    return text;
}

/// The axes with their assumed home.
std::string machine_text(const SetupFile& setup) {
    std::string text =
        "\n" + line(false, "[machine]", "or preset = \"haas-vf-2\", file = \"MACHINE.toml\"");
    if (setup.uses_other_axes)
        text += line(false, stated("other_axes", "\"not described\""),
                     "remove it when all axes are below");
    const gcode::AxisValues home = setup.environment.home.value_or(gcode::AxisValues{});
    std::vector<std::string> axes;
    for (size_t axis = 0; axis < 3; ++axis)
        axes.push_back(fmt::format("{{ name = \"{}\", home = {} }}", core::axis_letters[axis],
                                   assumed_length(home[axis], setup.length_unit)));
    return text
           + comment(fmt::format("  add min, max and rapid ({}/min) of each axis",
                                 setup.length_unit == LengthUnit::inch ? "inches" : "mm"))
           + line(false, stated("axis", fmt::format("[{}]", fmt::join(axes, ", "))));
}

} // namespace

std::string offset_name(const SetupFile& setup, size_t index) {
    return setup.environment.dialect == gcode::DialectId::siemens
               ? gcode::siemens_name_of_offset(index)
               : gcode::name_of_offset(index);
}

namespace {

std::string offset_key(const SetupFile& setup, size_t index) {
    const std::string name = offset_name(setup, index);
    return name.find_first_of(". ") == std::string::npos ? name : toml_text(name);
}

} // namespace

std::string offsets_header() {
    return "\n" + line(false, "[offsets]", "machine coordinates of each origin, without a tool");
}

std::string offset_line(const SetupFile& setup, size_t index) {
    return line(false,
                stated(offset_key(setup, index),
                       origin_text(setup.environment.work_offset(index), setup.length_unit)));
}

namespace {

/// The work offsets of the program.
std::string offsets_text(const SetupFile& setup) {
    std::string text = offsets_header();
    std::set<size_t> used = setup.offsets_used;
    if (used.empty()) used.insert(0);
    for (const size_t index : used) text += offset_line(setup, index);
    return text;
}

} // namespace

std::string stock_frame(const SetupFile& setup) {
    const core::Vec3& mount = setup.setup.stock_mount.link_from_body.translation;
    const auto is_mount = [&](size_t index) {
        const gcode::AxisValues origin = setup.environment.work_offset(index);
        return core::Vec3(origin[0], origin[1], origin[2]) == mount;
    };
    for (const size_t index : setup.offsets_used)
        if (is_mount(index)) return gcode::name_of_offset(index);
    return "G54";
}

namespace {

/// The lines that name a body of the imported document.
std::string imported_body_text(const SetupFile& setup, const std::string& name,
                               const std::string& folder) {
    return fmt::format("mesh = {}\nsolid = {}\nframe = {}\n",
                       path_text(setup.imported_bodies.document, folder), toml_text(name),
                       toml_text(stock_frame(setup)));
}

/// A `[stock]` that gives the stock of a set-up; empty for a mesh that is in no document.
std::string stock_table(const SetupFile& setup, const std::string& folder) {
    if (!setup.imported_bodies.stock.empty())
        return "[stock]\n" + imported_body_text(setup, setup.imported_bodies.stock, folder);

    const core::Solid& stock = setup.setup.stock;
    const WrittenLength written = written_length(setup.stock_known == Known::described);
    const auto length = [&](double mm) { return written(mm, setup.length_unit); };
    const auto point = [&](const core::Vec3& p) {
        return fmt::format("[{}, {}, {}]", length(p.x), length(p.y), length(p.z));
    };
    std::string text = "[stock]";
    if (const auto* box = std::get_if<core::SolidBox>(&stock.shape)) {
        text += fmt::format("                       # two corners\nbox = [{}, {}]\n",
                            point(box->box.min), point(box->box.max));
    } else if (const auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) {
        text += fmt::format("                       # base centre at `at`\ncylinder = {{ radius = "
                            "{}, height = {}, axis = "
                            "\"{}\" }}\nat = {}\n",
                            length(round->radius), length(round->height), "XYZ"[round->axis],
                            point(round->base));
    } else {
        return {};
    }
    text += fmt::format("frame = {}\n", toml_text(stock_frame(setup)));
    if (stock.tolerance > 0.0) text += line(true, stated("tolerance", length(stock.tolerance)));
    return text;
}

/// A table as lines that are commented out.
std::string commented_out(const std::string& table) {
    std::string text;
    for (size_t at = 0; at < table.size();) {
        const size_t end = std::min(table.find('\n', at), table.size());
        text += (end > at ? "#" : "") + table.substr(at, end - at) + "\n";
        at = end + 1;
    }
    return text;
}

bool has_stock(const SetupFile& setup) {
    const core::Vec3 size = core::bounds(setup.setup.stock).size();
    return std::min({size.x, size.y, size.z}) > 0.0 && setup.not_judged.empty()
           && setup.stock_known != Known::missing;
}

} // namespace

std::string part_text(const SetupFile& setup, const std::string& folder) {
    const std::string& part = setup.imported_bodies.part;
    return part.empty() ? "" : "\n[part]\n" + imported_body_text(setup, part, folder);
}

std::string stock_text(const SetupFile& setup, const std::string& folder) {
    if (!has_stock(setup)) return {};
    const std::string table = stock_table(setup, folder);
    const std::string& words =
        setup.stock_comment.empty() ? setup.inferred_stock : setup.stock_comment;
    const std::string why = words.empty() ? "" : comment(words);
    if (table.empty()) return {};
    return "\n" + why + (setup.stock_known == Known::described ? table : commented_out(table));
}

namespace {

core::Vec3 in_unit(const core::Vec3& mm, LengthUnit unit) {
    return {gcode::from_mm(mm.x, unit), gcode::from_mm(mm.y, unit), gcode::from_mm(mm.z, unit)};
}

/// An example: a plate below the stock, where it is not in the way.
std::string fixture_text(const SetupFile& setup) {
    const bool is_inch = setup.length_unit == LengthUnit::inch;
    const double gap = is_inch ? 0.5 : 10.0, thickness = is_inch ? 1.0 : 20.0;
    const double size = is_inch ? 4.0 : 100.0;
    core::Aabb box{core::Vec3(0.0, 0.0, -size), core::Vec3(size, size, 0.0)};
    if (has_stock(setup)) {
        const core::Aabb stock = core::bounds(setup.setup.stock);
        box = {in_unit(stock.min, setup.length_unit), in_unit(stock.max, setup.length_unit)};
    }
    const double top = std::floor(box.min.z - gap);
    const core::Vec3 low(std::floor(box.min.x), std::floor(box.min.y), top - thickness);
    const core::Vec3 high(std::ceil(box.max.x), std::ceil(box.max.y), top);
    return "\n"
           + comment("Examples of a fixture: a plate below the stock, mesh = \"VISE.stl\", or "
                     "preset = \"vise-6\"; \"feeler presets\" lists all presets.")
           + line(false, "[[fixture]]") + line(false, stated("name", "\"plate\""))
           + line(false,
                  stated("box", fmt::format("[{}, {}]", setup_vector(low), setup_vector(high))))
           + line(false, stated("frame", toml_text(stock_frame(setup))));
}

/// What a source says about a tool, and as comments what is assumed.
std::string partial_tool_text(const FoundTool& found, const core::ToolDescription& whole,
                              LengthUnit unit) {
    std::string text =
        "\n"
        + comment(fmt::format("{}, according to {}", core::description_of(found.tool.shape),
                              found.source))
        + "[[tool]]\n"
        + line(true, stated("number", fmt::format("{}", core::value_of(whole.number))));
    if (!whole.name.empty()) text += line(false, stated("name", toml_text(whole.name)));
    for (const core::ToolSize& size : core::tool_sizes()) {
        const auto value = size.of(whole);
        if (!value || !size.shapes.contains(whole.shape)) continue;
        const std::string_view key = size.key;
        const bool is_diameter = key == "diameter";
        const bool is_known =
            found.is_described && size.of(found.tool) && (!is_diameter || found.has_diameter);
        if (key == "shank_diameter" && !is_known) continue;
        const std::string written =
            size.is_angle() ? setup_number(*value) : written_length(is_known)(*value, unit);
        text += line(is_known, stated(key, written),
                     key == "stick_out" ? "from the tip to the holder" : "");
    }
    return text + line(false, stated("holder", "\"BT40-ER32\""), "or other cones, see the manual");
}

/// A size with a remark, or "unknown" with what is assumed.
std::string size_line(const core::ToolSize& size, double value, bool is_known, LengthUnit unit) {
    const std::string written = size.is_angle() ? toml_number(value) : exact_length(value, unit);
    if (is_known)
        return line(true, stated(size.key, written),
                    std::string_view(size.key) == "stick_out" ? "from the tip to the holder" : "");
    const std::string assumed = size.is_angle() ? setup_number(value) : assumed_length(value, unit);
    return line(true, stated(size.key, "\"unknown\""), assumed + " is assumed");
}

/// The sizes that a source states. With a shape, "unknown" says which are assumed; without one all
/// others are.
std::string found_sizes(const FoundTool& found, const core::ToolDescription& whole,
                        LengthUnit unit) {
    std::string text;
    for (const core::ToolSize& size : core::tool_sizes()) {
        text += before(size.key, found.tool, unit);
        const auto said = size.of(found.tool), used = size.of(whole);
        const bool is_replaced = used && used != said;
        if (said && !is_replaced)
            text += size_line(size, *said, true, unit);
        else if (is_replaced && found.has_shape)
            text += size_line(size, *used, false, unit);
    }
    return text;
}

/// The tool that stands for one whose sizes no tool can have.
FoundTool without_contradictions(const FoundTool& found) {
    if (core::assemble(complete(found).tool)) return found;
    FoundTool plain{.tool = {}, .has_shape = true, .source = found.source};
    plain.tool.number = found.tool.number;
    plain.tool.name = found.tool.name;
    plain.tool.diameter = found.tool.diameter;
    plain.assumed = {"that it is a flat end mill, because its sizes contradict each other,"};
    return plain;
}

std::string found_lines(const FoundTool& found, const core::ToolDescription& whole,
                        LengthUnit unit) {
    const core::ToolDescription& tool = found.tool;
    std::string text = line(true, stated("number", fmt::format("{}", core::value_of(tool.number))));
    if (!tool.name.empty()) text += line(true, stated("name", toml_text(tool.name)));
    if (found.has_shape)
        text += line(true, stated("shape", fmt::format("\"{}\"", core::name_of(tool.shape))));
    text += found_sizes(found, whole, unit);
    if (tool.cuts == core::SpindleDirection::counterclockwise)
        text += line(true, stated("spindle", "\"counterclockwise\""));
    return text;
}

/// What a library says about a tool, and what is assumed.
std::string library_tool_text(const FoundTool& listed, const core::ToolDescription& whole,
                              LengthUnit unit) {
    const FoundTool found = without_contradictions(listed);
    std::string about =
        fmt::format("{}, according to {}", core::description_of(found.tool.shape), found.source);
    if (!found.assumed.empty())
        about += fmt::format("; {} {} assumed", fmt::join(found.assumed, ", "),
                             found.assumed.size() == 1 ? "is" : "are");
    std::string text = "\n" + comment(about) + "[[tool]]\n" + found_lines(found, whole, unit)
                       + touched_off(whole, unit);
    if (found.tool.holder.empty())
        text += line(false, stated("holder", "\"BT40-ER32\""), "or other cones, see the manual");
    return text;
}

} // namespace

std::string found_tool_lines(const FoundTool& listed, LengthUnit unit) {
    const FoundTool found = without_contradictions(listed);
    return found_lines(found, complete(found).tool, unit);
}

std::string tool_text(const SetupFile& setup, core::ToolNumber number) {
    const core::ToolDescription& tool = setup.setup.tools.at(number).description;
    const auto found = setup.found_tools.find(number);
    if (found == setup.found_tools.end()) return tool_table(tool, setup.length_unit);
    return setup.library.contains(number)
               ? library_tool_text(found->second, tool, setup.length_unit)
               : partial_tool_text(found->second, tool, setup.length_unit);
}

std::string setup_text(const SetupFile& setup, const SetupOrigin& origin) {
    std::string text = comment("Set-up of the program " + origin.program + ".");
    for (const std::string& note : setup.import_notes) text += comment("- " + note);
    text += "#\n"
            + comment("A line that begins with # and no blank is an assumption or an example. "
                      "Remove the # when you have compared it with the machine, and that of the "
                      "[table] above it.");
    text += "\n";
    if (setup.length_unit == LengthUnit::inch)
        text += line(true, stated(length_unit_key, "\"inch\""), "of all lengths in this file");
    text += line(false, stated("mesh_size", setup_length(setup.setup.mesh_size, setup.length_unit)))
            + line(false, stated("fixtures", "\"none\""), "or describe them below");
    text += program_text(setup, origin) + machine_text(setup) + offsets_text(setup)
            + stock_text(setup, origin.folder) + part_text(setup, origin.folder)
            + fixture_text(setup);
    for (const auto& [number, tool] : setup.setup.tools) text += tool_text(setup, number);
    return text;
}

} // namespace app
