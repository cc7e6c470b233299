#include "app/setup/program_settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/ini_file.h"
#include "app/setup/linuxcnc_kinematics.h"
#include "app/setup/table_reader.h"
#include "app/setup/tools/tool_file.h"
#include "core/base/file_reads.h"
#include "core/base/text.h"
#include "gcode/exec/interpreter.h"
#include "gcode/exec/startup.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/language/parameters.h"

namespace app {
namespace {

template <typename T>
void replace(T& value, const T& over) {
    if (over != T{}) value = over;
}

/// Moves nine numbers, from parameter `first` on, out of the parameters; empty if none is set.
std::optional<gcode::AxisValues> take_position(gcode::Environment& environment, int first) {
    std::optional<gcode::AxisValues> position;
    for (size_t axis = 0; axis < gcode::axis_count; ++axis) {
        const auto found = environment.parameters.find(first + static_cast<int>(axis));
        if (found == environment.parameters.end()) continue;
        if (!position) position.emplace();
        (*position)[axis] = gcode::is_rotary(axis)
                                ? found->second
                                : gcode::to_mm(found->second, environment.machine_unit);
        environment.parameters.erase(found);
    }
    return position;
}

/// LinuxCNC stores the reference points from #5161 and #5181 and the work offsets from #5221, with
/// 20 numbers for each.
void take_positions(gcode::Environment& environment) {
    if (const auto home = take_position(environment, 5161)) environment.home = *home;
    if (const auto second = take_position(environment, 5181)) environment.second_home = *second;
    for (size_t i = 0; i < gcode::plain_offset_count; ++i)
        if (const auto offset = take_position(environment, 5221 + 20 * static_cast<int>(i)))
            environment.work_offsets[i] = *offset;
}

/// The path of a file named in an ini file; empty, with a note, if it does not exist: LinuxCNC
/// writes some files only when it ends.
std::string existing(const std::string& path, const ProgramSettings& settings,
                     std::vector<std::string>& notes) {
    if (path.empty() || core::is_there(path)) return path;
    notes.push_back(fmt::format("{}: {} does not exist; treated as empty", settings.ini, path));
    return {};
}

/// The kinematics of an ini file, and the values of its HAL pins.
void take_kinematics(const IniFile& ini, const ProgramSettings& settings,
                     gcode::Environment& environment, std::vector<std::string>& notes) {
    environment.hal_values = ini.hal.values();
    for (const auto& [name, value] : settings.named_values)
        if (value && name.starts_with("_hal[")) environment.hal_values[name] = *value;
    environment.remaps = ini.remaps;
    for (const std::string& code : ini.other_remaps)
        notes.push_back(
            fmt::format("{}: REMAP of {} is ignored, because it has more than ngc=: the "
                        "code counts as LinuxCNC's own",
                        settings.ini, code));
    const gcode::LengthUnit unit =
        settings.machine_unit.value_or(ini.machine_unit.value_or(environment.machine_unit));
    auto kinematics = linuxcnc_kinematics(ini.kinematics, ini.kinematics_settings, ini.hal,
                                          settings.named_values, gcode::to_mm(1.0, unit));
    if (!kinematics) return;
    if (!ini.coordinates.empty()
        && ini.kinematics_settings.find("coordinates=") == std::string::npos)
        kinematics->switches.coordinates = ini.coordinates;
    environment.kinematics = std::move(kinematics->switches);
    for (const std::string& file : ini.unread_files)
        notes.push_back(fmt::format("{}: {} could not be read; what it sets and connects is not "
                                    "taken into account",
                                    settings.ini, file));
    for (const std::string& note : kinematics->notes)
        notes.push_back(fmt::format("{}: {}", settings.ini, note));
}

/// The subprograms of remapped codes may be beside the ini file instead of in its folders for
/// subprograms.
void add_folder_of_remaps(const IniFile& ini, const std::string& path,
                          std::vector<std::string>& search_path, std::vector<std::string>& notes) {
    const std::filesystem::path own = std::filesystem::path(path).parent_path();
    for (const auto& [code, name] : ini.remaps) {
        const auto has_it = [file = name + ".ngc"](const std::filesystem::path& folder) {
            return core::is_there((folder / file).generic_string());
        };
        if (std::any_of(search_path.begin(), search_path.end(), has_it)) continue;
        if (has_it(own)) {
            notes.push_back(
                fmt::format("{}: {}.ngc, which runs in place of {}, is beside this file "
                            "and not in SUBROUTINE_PATH",
                            path, name, code));
            search_path.push_back(own.empty() ? "." : own.generic_string());
        } else {
            notes.push_back(fmt::format("{}: {}.ngc, which runs in place of {}, is not in "
                                        "SUBROUTINE_PATH: what {} does is not known",
                                        path, name, code, code));
        }
    }
}

/// Completes the settings from their ini file; values that only programs use go to the environment.
core::Result<ProgramSettings> with_ini(ProgramSettings settings, gcode::Environment& environment,
                                       std::vector<std::string>& notes) {
    if (settings.ini.empty()) return settings;
    FEELER_TRY(const IniFile ini, read_ini(settings.ini));
    environment.ini_values = ini.values;
    ProgramSettings stated;
    stated.dialect = gcode::DialectId::linuxcnc;
    environment.tool_change = tool_change_motion(
        ini, settings.machine_unit.value_or(ini.machine_unit.value_or(environment.machine_unit)));
    if (!ini.locking_indexers.empty())
        notes.push_back(fmt::format("{}: LOCKING_INDEXER of {} is ignored: in a block with several "
                                    "axes, it turns with the others instead of before them",
                                    settings.ini, ini.locking_indexers));
    if (has_slow_servo(ini))
        notes.push_back(fmt::format("{}: SERVO_PERIOD is longer than 1 ms, so LinuxCNC may leave "
                                    "corners by more than is taken into account",
                                    settings.ini));
    stated.machine_unit = ini.machine_unit;
    if (!settings.ignores_tables) {
        stated.parameters = existing(ini.parameters, settings, notes);
        stated.tool_table = existing(ini.tool_table, settings, notes);
    }
    stated.search_path = ini.search_path;
    environment.startup_code = ini.startup_code;
    environment.wrapped_axes = ini.wrapped_axes;
    take_kinematics(ini, settings, environment, notes);
    add_folder_of_remaps(ini, settings.ini, stated.search_path, notes);
    return overlaid(stated, settings);
}

} // namespace

core::Result<void> check_startup_code(const gcode::Environment& environment) {
    gcode::Environment plain = environment;
    plain.dialect = gcode::DialectId::linuxcnc;
    plain.startup_code.clear();
    gcode::InterpreterState state = gcode::initial_state(plain);
    plain.startup_code = environment.startup_code;
    return gcode::run_startup_code(state, plain);
}

ProgramSettings overlaid(ProgramSettings settings, const ProgramSettings& over) {
    replace(settings.dialect, over.dialect);
    replace(settings.block_delete, over.block_delete);
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        replace(settings.start[axis], over.start[axis]);
    replace(settings.machine_unit, over.machine_unit);
    replace(settings.units_at_start, over.units_at_start);
    replace(settings.max_blocks, over.max_blocks);
    replace(settings.counts_smallest_steps, over.counts_smallest_steps);
    replace(settings.ini, over.ini);
    replace(settings.parameters, over.parameters);
    replace(settings.tool_table, over.tool_table);
    settings.ignores_tables = settings.ignores_tables || over.ignores_tables;
    replace(settings.search_path, over.search_path);
    replace(settings.machine_codes, over.machine_codes);
    replace(settings.tool_at_start, over.tool_at_start);
    replace(settings.spindle_at_start, over.spindle_at_start);
    replace(settings.values, over.values);
    replace(settings.named_values, over.named_values);
    replace(settings.speed_by_hand, over.speed_by_hand);
    replace(settings.measured_offsets_are_stated, over.measured_offsets_are_stated);
    return settings;
}

core::Result<AppliedSettings> apply(const ProgramSettings& given, gcode::Environment& environment) {
    AppliedSettings applied;
    std::vector<std::string>& notes = applied.notes;
    FEELER_TRY(applied.settings, with_ini(given, environment, notes));
    const ProgramSettings& settings = applied.settings;
    if (settings.dialect) environment.dialect = *settings.dialect;
    if (settings.block_delete) {
        environment.block_delete = *settings.block_delete;
        environment.control.answers[gcode::ControlQuestion::blocks_are_deleted] =
            environment.block_delete;
    }
    if (settings.machine_unit) environment.machine_unit = *settings.machine_unit;
    environment.machine_unit_is_stated |= settings.machine_unit.has_value();
    if (settings.units_at_start) environment.units_at_start = settings.units_at_start;
    if (settings.max_blocks) environment.limits.blocks = *settings.max_blocks;
    if (settings.counts_smallest_steps) {
        environment.counts_smallest_steps = *settings.counts_smallest_steps;
        environment.control.answers[gcode::ControlQuestion::point_is_implied] =
            !*settings.counts_smallest_steps;
    }
    environment.control.values = settings.values;
    environment.control.named_values = settings.named_values;
    environment.measured_offsets_are_stated = settings.measured_offsets_are_stated.value_or(false);
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        replace(environment.start[axis], settings.start[axis]);
    replace(environment.search_path, settings.search_path);
    replace(environment.known_m_codes, settings.machine_codes);
    if (!settings.parameters.empty()) {
        FEELER_TRY(environment.parameters, read_variables(settings.parameters));
        take_positions(environment);
    }
    if (!settings.tool_table.empty()) {
        FEELER_TRY(environment.length_offsets,
                   read_tool_file(settings.tool_table, environment.machine_unit));
    }
    if (!environment.startup_code.empty()) {
        if (const auto run = check_startup_code(environment); !run)
            return tl::unexpected(core::in_file(run.error(), settings.ini));
        notes.push_back(fmt::format("{}: RS274NGC_STARTUP_CODE is executed before the program: {}",
                                    settings.ini, environment.startup_code));
    }
    return applied;
}

std::optional<gcode::Position> position_in(const std::string& text) {
    gcode::Position position;
    bool any = false;
    const char* const end = text.data() + text.size();
    const auto skip = [end](const char* at, std::string_view characters) {
        while (at != end && characters.find(*at) != std::string_view::npos) ++at;
        return at;
    };
    for (const char* at = skip(text.data(), " \t,"); at != end; at = skip(at, " \t,")) {
        const char letter = core::upper(*at);
        const size_t axis = gcode::axis_letters.find(letter);
        if (axis >= gcode::axis_count || position[axis]) return std::nullopt;
        at = skip(at + 1, " \t=");
        if (at != end && *at == '+') ++at;
        double value = 0.0;
        const auto [rest, failure] = std::from_chars(at, end, value);
        if (failure != std::errc() || !std::isfinite(value)) return std::nullopt;
        position[axis] = value;
        at = rest;
        any = true;
    }
    return any ? std::optional(position) : std::nullopt;
}

namespace {

constexpr double highest_machine_code = 9999.0;

std::string path_of(TableReader& table, const char* key, const std::filesystem::path& folder) {
    const auto name = table.string(key);
    return name ? (folder / *name).generic_string() : std::string();
}

void read_start(TableReader& table, gcode::Position& start) {
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        start[axis] = table.number(std::string(1, gcode::axis_letters[axis]).c_str(),
                                   gcode::is_rotary(axis) ? Measure::angle : Measure::length);
    table.finish();
}

void read_machine_codes(TableReader& table, std::set<int>& codes) {
    for (const double code :
         table.numbers("machine_codes", Measure::plain, 0).value_or(std::vector<double>{})) {
        if (code >= 0.0 && code <= highest_machine_code && code == static_cast<int>(code))
            codes.insert(static_cast<int>(code));
        else
            table.refuse("machine_codes", fmt::format("{} is not the number of an M code", code));
    }
}

/// The number of a variable such as #500, R5 or Q12; empty for any other name.
std::optional<int> variable_number(std::string_view name) {
    if (name.size() < 2 || std::string_view("#RQ").find(name[0]) == std::string_view::npos)
        return std::nullopt;
    int number = 0;
    const auto [end, failure] = std::from_chars(name.data() + 1, name.data() + name.size(), number);
    if (failure != std::errc() || end != name.data() + name.size()) return std::nullopt;
    if (number == 0 && name[0] == 'R') return gcode::highest_parameter;
    if (number < 0 || number > gcode::highest_parameter) return std::nullopt;
    return number;
}

/// The name of a global variable of LinuxCNC, such as #<_depth>, without `#<>`; empty for others.
std::string global_name(const std::string& name) {
    const bool is_global = name.starts_with("#<_") && name.ends_with('>');
    return is_global ? core::lower_case(name.substr(2, name.size() - 3)) : "";
}

void read_values(TableReader& table, ProgramSettings& settings) {
    for (const std::string& name : table.keys()) {
        const std::string global = global_name(name);
        if (!global.empty() && table.is_text(name.c_str())) {
            if (table.word(name.c_str(), {"unset"})) settings.named_values[global];
            continue;
        }
        const auto value = table.number(name.c_str(), Measure::plain); // in the program's unit
        const auto number = variable_number(name);
        if (!number && global.empty())
            table.refuse(
                name.c_str(),
                "is not the name of a variable, such as \"#500\", R5, Q12 or \"#<_name>\"");
        else if (value && number)
            settings.values[*number] = *value;
        else if (value)
            settings.named_values[global] = *value;
    }
    table.finish();
}

} // namespace

std::optional<gcode::DialectId> read_dialect(TableReader& table) {
    return gcode::dialect_named(table.word("dialect", gcode::dialect_names()).value_or(""));
}

ProgramSettings read_program_table(TableReader& table, const std::filesystem::path& folder) {
    ProgramSettings settings;
    settings.dialect = read_dialect(table);
    settings.block_delete = table.boolean("block_delete");
    table.limit_numbers("start");
    if (auto start = table.table("start", "[program] start")) read_start(*start, settings.start);
    if (const auto unit = table.word("unit", {"mm", "inch"}))
        settings.machine_unit = *unit == "mm" ? gcode::LengthUnit::mm : gcode::LengthUnit::inch;
    if (const auto units = table.word("units_at_start", {"mm", "inch"}))
        settings.units_at_start = *units == "mm" ? gcode::LengthUnit::mm : gcode::LengthUnit::inch;
    if (const auto steps = table.word("no_decimal_point", {"units", "steps"}))
        settings.counts_smallest_steps = *steps == "steps";
    settings.ini = path_of(table, "ini", folder);
    settings.parameters = path_of(table, "parameters", folder);
    settings.tool_table = path_of(table, "tool_table", folder);
    for (const std::string& name :
         table.strings("search_path", 0).value_or(std::vector<std::string>{}))
        settings.search_path.push_back((folder / name).generic_string());
    if (const auto blocks = table.integer("max_blocks")) {
        if (*blocks < 1) table.refuse("max_blocks", "must be above 0");
        settings.max_blocks = static_cast<uint64_t>(*blocks);
    }
    if (auto values = table.table("values", "[program.values]")) read_values(*values, settings);
    settings.speed_by_hand = table.boolean("speed_by_hand");
    if (table.word("measured_offsets", {"as stated"})) settings.measured_offsets_are_stated = true;
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

core::Result<std::map<int, double>> read_variables(const std::string& path) {
    FEELER_TRY(const std::vector<std::string> lines, lines_of_file(path));
    std::map<int, double> variables;
    for (size_t line = 1; line <= lines.size(); ++line) {
        const std::vector<std::string> words = words_of_line(lines[line - 1]);
        if (words.empty() || words[0][0] == ';' || words[0][0] == '#') continue;
        const auto number = number_in(words[0]);
        const auto value = words.size() > 1 ? number_in(words[1]) : std::nullopt;
        const bool more = words.size() > 2 && words[2][0] != ';' && words[2][0] != '#';
        if (!number || !value || more)
            return tl::unexpected(line_error(
                path, line, "expected a parameter number and its value, as in 5221 -350.0"));
        if (!(*number >= 1.0 && *number <= gcode::highest_parameter)
            || *number != static_cast<int>(*number))
            return tl::unexpected(
                line_error(path, line, fmt::format("there is no parameter #{}", words[0])));
        if (!variables.emplace(static_cast<int>(*number), *value).second)
            return tl::unexpected(
                line_error(path, line, fmt::format("#{} is defined twice", words[0])));
    }
    return variables;
}

} // namespace app
