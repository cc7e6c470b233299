#include "app/setup/setup_text.h"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/base/text.h"
#include "app/setup/coverage.h"
#include "app/setup/setup_file.h"
#include "gcode/language/canonical.h"
#include "gcode/language/control.h"
#include "gcode/language/dialect.h"

namespace app {
namespace {

std::string key(const char* name, double value) {
    return fmt::format("{} = {}\n", name, toml_number(value));
}

std::string cones(const char* name, const std::vector<core::ConeStep>& steps) {
    std::vector<std::string> rows;
    for (const core::ConeStep& s : steps)
        rows.push_back(fmt::format("[{}, {}, {}]", toml_number(s.lower_diameter),
                                   toml_number(s.upper_diameter), toml_number(s.length)));
    return rows.empty() ? "" : fmt::format("{} = [{}]\n", name, fmt::join(rows, ", "));
}

std::string outline(const core::ToolDescription& tool) {
    std::vector<std::string> rows;
    for (const auto& [r, z] : tool.outline)
        rows.push_back(fmt::format("[{}, {}]", toml_number(r), toml_number(z)));
    return rows.empty() ? "" : fmt::format("profile = [{}]\n", fmt::join(rows, ", "));
}

/// The keys that precede a size in the file.
std::string before(std::string_view key, const core::ToolDescription& tool) {
    if (key == "neck_diameter") return outline(tool);
    if (key == "shank_diameter")
        return (tool.teeth ? fmt::format("teeth = {}\n", *tool.teeth) : std::string())
               + cones("shank", tool.shank);
    return key == "gauge_length" ? cones("holder", tool.holder) : std::string();
}

std::string sizes(const core::ToolDescription& tool) {
    std::string text;
    for (const core::ToolSize& size : core::tool_sizes()) {
        text += before(size.key, tool);
        if (const auto value = size.of(tool)) text += key(size.key, *value);
    }
    if (tool.length_is_guess)
        text += "touched_off = \"unknown\"     # length that the control uses: 0 where it matters; "
                "state it, or remove this to use the true length\n";
    else if (tool.touched_off)
        text += fmt::format("touched_off = {}     # length that the control uses, matching the "
                            "work offset; remove it to use the true length\n",
                            toml_number(*tool.touched_off));
    return text;
}

} // namespace

std::string toml_number(double value) { return fmt::format("{}", value); }

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

std::string tool_table(const core::ToolDescription& tool) {
    std::string text = "\n[[tool]]\n";
    text += fmt::format("number = {}\n", core::value_of(tool.number));
    if (!tool.name.empty()) text += fmt::format("name = {}\n", toml_text(tool.name));
    text += fmt::format("shape = \"{}\"\n", core::name_of(tool.shape));
    if (tool.diameter == 0.0) text += key("diameter", 0.0);
    text += sizes(tool);
    if (tool.cuts == core::SpindleDirection::counterclockwise)
        text += "spindle = \"counterclockwise\"\n";
    if (!tool.cuts_at_centre)
        text += "cuts_at_centre = false\n" + key("centre_diameter", 2.0 * tool.centre_radius);
    if (tool.single_point) text += "single_point = true\n";
    return text;
}

std::string stock_table(const core::Solid& stock, std::string_view frame) {
    const auto triple = [](const core::Vec3& v) {
        return fmt::format("[{}, {}, {}]", toml_number(v.x), toml_number(v.y), toml_number(v.z));
    };
    std::string text = "\n[stock]";
    if (const auto* box = std::get_if<core::SolidBox>(&stock.shape)) {
        text += fmt::format("     # two corners\nbox = [{}, {}]\n", triple(box->box.min),
                            triple(box->box.max));
    } else if (const auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) {
        text += fmt::format(
            "     # base centre at `at`\ncylinder = {{ radius = {}, height = {}, axis = "
            "\"{}\" }}\nat = {}\n",
            toml_number(round->radius), toml_number(round->height), "XYZ"[round->axis],
            triple(round->base));
    } else {
        return {};
    }
    text += fmt::format("frame = {}\n", toml_text(frame));
    if (stock.tolerance > 0.0) text += key("tolerance", stock.tolerance);
    return text;
}

namespace {

/// A text as comment lines; a line end in it does not end the comment.
std::string comment(const std::string& text) {
    std::string lines;
    for (const char c : wrapped(utf8_text(text), 1, 2)) {
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

std::string program_text(const SetupFile& setup) {
    const gcode::Position& start = setup.environment.start;
    std::string text = "\n[program]\n";
    if (setup.dialect)
        text += fmt::format("dialect = \"{}\"\n", gcode::dialect(*setup.dialect).name);
    text += fmt::format("start = {{ X = {}, Y = {}, Z = {} }}     # machine coordinates\n",
                        toml_number(start[0].value_or(0.0)), toml_number(start[1].value_or(0.0)),
                        toml_number(start[2].value_or(0.0)));
    if (setup.environment.machine_unit == gcode::LengthUnit::inch) text += "unit = \"inch\"\n";
    if (const auto units = setup.environment.units_at_start)
        text += fmt::format("units_at_start = \"{}\"\n",
                            *units == gcode::LengthUnit::inch ? "inch" : "mm");
    if (setup.environment.counts_smallest_steps) text += "no_decimal_point = \"steps\"\n";
    if (setup.environment.block_delete) text += "block_delete = true\n";
    if (setup.setup.tool_at_start)
        text += fmt::format("tool_at_start = {}\n", core::value_of(*setup.setup.tool_at_start));
    if (setup.setup.spindle_at_start == core::SpindleDirection::clockwise)
        text += "spindle_at_start = \"clockwise\"     # the program never starts it\n";
    if (setup.speed_by_hand) text += "speed_by_hand = true     # the program has no S\n";
    return text;
}

/// The parameters of the control that a user should state, as comments.
std::string control_text(const SetupFile& setup) {
    if (!setup.dialect) return {};
    std::string text;
    for (const gcode::ControlParameter& parameter : gcode::control_parameters()) {
        if (!parameter.is_open() || parameter.key.empty()
            || gcode::find_parameter(parameter.key, *setup.dialect) != &parameter)
            continue;
        const gcode::ParameterValue& other = parameter.values[1];
        text += comment(fmt::format(
            "\"{}\" = {}, {}; {}: {}", parameter.key, parameter.choices(), parameter.name,
            other.word.empty() ? fmt::format("{:g}", other.number) : std::string(other.word),
            other.text));
    }
    return text.empty() ? text : "\n# [control]     # how the control is set\n" + text;
}

/// The axes with their assumed home.
std::string machine_text(const SetupFile& setup) {
    if (!setup.environment.home) return {};
    constexpr const char* directions[] = {"[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"};
    std::string text;
    if (setup.uses_other_axes)
        text +=
            "\n[machine]\nother_axes = \"not described\"     # remove it when all axes are below\n";
    for (size_t axis = 0; axis < 3; ++axis)
        text += fmt::format("\n[[machine.axis]]{}\nname = \"{}\"\ndirection = {}\nhome = {}\n",
                            axis == 0 ? "     # add min, max and rapid (mm/min)" : "",
                            gcode::axis_letters[axis], directions[axis],
                            toml_number((*setup.environment.home)[axis]));
    return text;
}

std::string offsets_text(const SetupFile& setup) {
    std::string text = "\n[offsets]     # machine coordinates of each origin\n";
    const auto add = [&](size_t index, const gcode::AxisValues& origin) {
        const std::string name = gcode::name_of_offset(index);
        const bool is_bare_key = name.find_first_of(". ") == std::string::npos;
        text +=
            fmt::format("{} = {{ X = {}, Y = {}, Z = {} }}\n", is_bare_key ? name : toml_text(name),
                        toml_number(origin[0]), toml_number(origin[1]), toml_number(origin[2]));
    };
    for (size_t i = 0; i < gcode::plain_offset_count; ++i)
        add(i, setup.environment.work_offsets[i]);
    for (const auto& [index, origin] : setup.environment.extended_offsets) add(index, origin);
    return text;
}

/// The work offset at whose origin the stock is mounted.
std::string stock_frame(const SetupFile& setup) {
    const core::Vec3& mount = setup.setup.stock_mount.link_from_body.translation;
    const auto is_mount = [&](const gcode::AxisValues& origin) {
        return core::Vec3(origin[0], origin[1], origin[2]) == mount;
    };
    for (size_t i = 0; i < gcode::plain_offset_count; ++i)
        if (is_mount(setup.environment.work_offsets[i])) return gcode::name_of_offset(i);
    for (const auto& [index, origin] : setup.environment.extended_offsets)
        if (is_mount(origin)) return gcode::name_of_offset(index);
    return "G54";
}

std::string rules_text(const SetupFile& setup) {
    if (setup.setup.rules.empty()) return {};
    std::string text = "\n[rules]\n";
    for (const auto& [rule, severity] : setup.setup.rules)
        text += fmt::format("{} = \"{}\"\n", rule, core::name_of(severity));
    return text;
}

/// What the file states and nobody knows yet.
std::string assumed_text(const SetupFile& setup) {
    std::vector<std::string> words;
    const auto add = [&](bool is_assumed, std::string_view word) {
        if (is_assumed) words.push_back(fmt::format("\"{}\"", word));
    };
    add(setup.stock_known == Known::inferred, "stock");
    add(setup.offsets_known == Known::inferred, "offsets");
    add(setup.infers_start, "start");
    if (words.empty()) return {};
    return fmt::format("assumed = [{}]     # remove each word when you have compared it with the "
                       "machine\n",
                       fmt::join(words, ", "));
}

} // namespace

std::string setup_text(const SetupFile& setup, const std::string& program) {
    std::string text = comment("Set-up inferred from the program " + program
                               + ", with these assumptions. Compare it with the real machine, "
                                 "add the fixtures, and check the program against it.");
    text += "#\n";
    for (const std::string& assumption : setup.assumptions) text += comment("- " + assumption);
    text += fmt::format("\nmesh_size = {}\n", toml_number(setup.setup.mesh_size));
    text += assumed_text(setup);
    if (setup.setup.allowance)
        text += fmt::format("allowance = {}\n", toml_number(*setup.setup.allowance));
    text += program_text(setup) + control_text(setup) + machine_text(setup) + offsets_text(setup)
            + stock_table(setup.setup.stock, stock_frame(setup));
    for (const auto& [tool_number, tool] : setup.setup.tools) text += tool_table(tool.description);
    return text + rules_text(setup);
}

} // namespace app
