#include "app/setup/program_table.h"

#include <fmt/format.h>

namespace app {
namespace {

constexpr double highest_machine_code = 9999.0;

std::string path_of(TableReader& table, const char* key, const std::filesystem::path& folder) {
    const auto name = table.string(key);
    return name ? (folder / *name).string() : std::string();
}

void read_start(TableReader& table, gcode::Position& start) {
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        start[axis] = table.number(std::string(1, gcode::axis_letters[axis]).c_str());
    table.finish();
}

void read_machine_codes(TableReader& table, std::set<int>& codes) {
    for (const double code : table.numbers("machine_codes", 0).value_or(std::vector<double>{})) {
        if (code >= 0.0 && code <= highest_machine_code && code == static_cast<int>(code))
            codes.insert(static_cast<int>(code));
        else
            table.refuse("machine_codes", fmt::format("{} is not the number of an M code", code));
    }
}

} // namespace

ProgramSettings read_program_table(TableReader& table, const std::filesystem::path& folder) {
    ProgramSettings settings;
    if (const auto name = table.word("dialect", {"linuxcnc", "fanuc", "haas", "grbl", "siemens",
                                                 "siemens-iso", "heidenhain"}))
        settings.dialect = gcode::dialect_named(*name);
    settings.block_delete = table.boolean("block_delete");
    if (auto start = table.table("start", "[program] start")) read_start(*start, settings.start);
    if (const auto unit = table.word("unit", {"mm", "inch"}))
        settings.machine_unit = *unit == "mm" ? gcode::LengthUnit::mm : gcode::LengthUnit::inch;
    if (const auto steps = table.word("no_decimal_point", {"units", "steps"}))
        settings.counts_smallest_steps = *steps == "steps";
    settings.parameters = path_of(table, "parameters", folder);
    settings.tool_table = path_of(table, "tool_table", folder);
    for (const std::string& name :
         table.strings("search_path", 0).value_or(std::vector<std::string>{}))
        settings.search_path.push_back((folder / name).string());
    if (const auto blocks = table.integer("max_blocks")) {
        if (*blocks < 1) table.refuse("max_blocks", "must be above 0");
        settings.max_blocks = static_cast<uint64_t>(*blocks);
    }
    settings.speed_by_hand = table.boolean("speed_by_hand");
    if (const auto tool = table.integer("tool_at_start"))
        settings.tool_at_start = core::ToolNumber{*tool};
    if (const auto spindle =
            table.word("spindle_at_start", {"stopped", "clockwise", "counterclockwise"}))
        settings.spindle_at_start = *spindle == "clockwise" ? core::SpindleDirection::clockwise
                                    : *spindle == "stopped"
                                        ? core::SpindleDirection::stopped
                                        : core::SpindleDirection::counterclockwise;
    read_machine_codes(table, settings.machine_codes);
    table.finish();
    return settings;
}

} // namespace app
