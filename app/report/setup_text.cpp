#include "app/report/setup_text.h"

#include <fmt/format.h>

#include "app/report/text_layout.h"
#include "app/setup/setup_tables.h"
#include "app/setup/utf8_text.h"

namespace app {
namespace {

constexpr const char* offset_keys[] = {"G54", "G55",       "G56",       "G57",      "G58",
                                       "G59", "\"G59.1\"", "\"G59.2\"", "\"G59.3\""};

/// Lines of a comment; what a program says must not end it.
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
    if (setup.environment.counts_smallest_steps) text += "no_decimal_point = \"steps\"\n";
    if (setup.environment.block_delete) text += "block_delete = true\n";
    if (setup.setup.tool_at_start)
        text += fmt::format("tool_at_start = {}\n", core::value_of(*setup.setup.tool_at_start));
    if (setup.setup.spindle_at_start == core::SpindleDirection::clockwise)
        text += "spindle_at_start = \"clockwise\"     # the program never starts it\n";
    if (setup.speed_by_hand) text += "speed_by_hand = true     # the program has no S\n";
    return text;
}

/// The axes with the home that was assumed.
std::string machine_text(const SetupFile& setup) {
    if (!setup.environment.home) return {};
    constexpr const char* directions[] = {"[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"};
    std::string text;
    for (size_t axis = 0; axis < 3; ++axis)
        text += fmt::format("\n[[machine.axis]]{}\nname = \"{}\"\ndirection = {}\nhome = {}\n",
                            axis == 0 ? "     # add min, max and rapid (mm/min)" : "",
                            gcode::axis_letters[axis], directions[axis],
                            toml_number((*setup.environment.home)[axis]));
    return text;
}

std::string offsets_text(const SetupFile& setup) {
    std::string text = "\n[offsets]     # machine coordinates of each origin\n";
    for (size_t i = 0; i < std::size(offset_keys); ++i) {
        const gcode::AxisValues& origin = setup.environment.work_offsets[i];
        text += fmt::format("{} = {{ X = {}, Y = {}, Z = {} }}\n", offset_keys[i],
                            toml_number(origin[0]), toml_number(origin[1]), toml_number(origin[2]));
    }
    return text;
}

std::string rules_text(const SetupFile& setup) {
    if (setup.setup.rules.empty()) return {};
    std::string text = "\n[rules]\n";
    for (const auto& [rule, severity] : setup.setup.rules)
        text += fmt::format("{} = \"{}\"\n", rule, core::name_of(severity));
    return text;
}

} // namespace

std::string setup_text(const SetupFile& setup, const std::string& program) {
    std::string text = comment("What the program " + program
                               + " says about its set-up, and what was assumed where it says "
                                 "nothing. Compare it with what stands in the machine, add the "
                                 "fixtures, and check the program against it.");
    text += "#\n";
    for (const std::string& assumption : setup.assumptions) text += comment("- " + assumption);
    text += fmt::format("\nmesh_size = {}\n", toml_number(setup.setup.mesh_size));
    if (setup.setup.allowance)
        text += fmt::format("allowance = {}\n", toml_number(*setup.setup.allowance));
    text += program_text(setup) + machine_text(setup) + offsets_text(setup)
            + stock_table(setup.setup.stock, "G54");
    for (const auto& [tool_number, tool] : setup.setup.tools) text += tool_table(tool.description);
    return text + rules_text(setup);
}

} // namespace app
