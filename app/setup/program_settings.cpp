#include "app/setup/program_settings.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "app/setup/ini_file.h"
#include "app/setup/tool_file.h"
#include "app/setup/variables_file.h"
#include "core/base/file_reads.h"

namespace app {
namespace {

template <typename T>
void replace(T& value, const T& over) {
    if (over != T{}) value = over;
}

/// Takes the nine numbers from `first` on out of the parameters; empty when none is there.
std::optional<gcode::AxisValues> take_place(gcode::Environment& environment, int first) {
    std::optional<gcode::AxisValues> place;
    for (size_t axis = 0; axis < gcode::axis_count; ++axis) {
        const auto found = environment.parameters.find(first + static_cast<int>(axis));
        if (found == environment.parameters.end()) continue;
        if (!place) place.emplace();
        (*place)[axis] = gcode::is_rotary(axis)
                             ? found->second
                             : gcode::to_mm(found->second, environment.machine_unit);
        environment.parameters.erase(found);
    }
    return place;
}

/// LinuxCNC keeps the reference points at #5161 and #5181 and the work offsets at #5221, 20 numbers
/// for each.
void take_places(gcode::Environment& environment) {
    if (const auto home = take_place(environment, 5161)) environment.home = *home;
    if (const auto second = take_place(environment, 5181)) environment.second_home = *second;
    for (size_t i = 0; i < gcode::plain_offset_count; ++i)
        if (const auto offset = take_place(environment, 5221 + 20 * static_cast<int>(i)))
            environment.work_offsets[i] = *offset;
}

/// A file that an ini file names, or nothing: LinuxCNC writes some of them only when it ends.
std::string existing(const std::string& path, const ProgramSettings& settings,
                     std::vector<std::string>& notes) {
    if (path.empty() || core::is_there(path)) return path;
    notes.push_back(fmt::format("{}: there is no {}; it is taken as empty", settings.ini, path));
    return {};
}

/// The settings with what their ini file adds; what only programs see goes to the environment.
core::Result<ProgramSettings> with_ini(ProgramSettings settings, gcode::Environment& environment,
                                       std::vector<std::string>& notes) {
    if (settings.ini.empty()) return settings;
    FEELER_TRY(const IniFile ini, read_ini(settings.ini));
    environment.ini_values = ini.values;
    ProgramSettings stated;
    stated.machine_unit = ini.machine_unit;
    stated.parameters = existing(ini.parameters, settings, notes);
    stated.tool_table = existing(ini.tool_table, settings, notes);
    stated.search_path = ini.search_path;
    if (!ini.startup_code.empty())
        notes.push_back(fmt::format("{}: RS274NGC_STARTUP_CODE is not run before the program; if "
                                    "it matters, put it there: {}",
                                    settings.ini, ini.startup_code));
    if (!ini.wrapped_axes.empty())
        notes.push_back(
            fmt::format("{}: WRAPPED_ROTARY of {} is not followed: an absolute place is "
                        "taken as so many degrees, not as a direction and an angle",
                        settings.ini, ini.wrapped_axes));
    return overlaid(stated, settings);
}

} // namespace

ProgramSettings overlaid(ProgramSettings settings, const ProgramSettings& over) {
    replace(settings.dialect, over.dialect);
    replace(settings.block_delete, over.block_delete);
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        replace(settings.start[axis], over.start[axis]);
    replace(settings.machine_unit, over.machine_unit);
    replace(settings.max_blocks, over.max_blocks);
    replace(settings.counts_smallest_steps, over.counts_smallest_steps);
    replace(settings.ini, over.ini);
    replace(settings.parameters, over.parameters);
    replace(settings.tool_table, over.tool_table);
    replace(settings.search_path, over.search_path);
    replace(settings.machine_codes, over.machine_codes);
    replace(settings.tool_at_start, over.tool_at_start);
    replace(settings.spindle_at_start, over.spindle_at_start);
    replace(settings.speed_by_hand, over.speed_by_hand);
    return settings;
}

core::Result<std::vector<std::string>> apply(const ProgramSettings& given,
                                             gcode::Environment& environment) {
    std::vector<std::string> notes;
    FEELER_TRY(const ProgramSettings settings, with_ini(given, environment, notes));
    if (settings.dialect) environment.dialect = *settings.dialect;
    if (settings.block_delete) environment.block_delete = *settings.block_delete;
    if (settings.machine_unit) environment.machine_unit = *settings.machine_unit;
    if (settings.max_blocks) environment.limits.blocks = *settings.max_blocks;
    if (settings.counts_smallest_steps)
        environment.counts_smallest_steps = *settings.counts_smallest_steps;
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        replace(environment.start[axis], settings.start[axis]);
    replace(environment.search_path, settings.search_path);
    replace(environment.known_m_codes, settings.machine_codes);
    if (!settings.parameters.empty()) {
        FEELER_TRY(environment.parameters, read_variables(settings.parameters));
        take_places(environment);
    }
    if (!settings.tool_table.empty()) {
        FEELER_TRY(environment.length_offsets,
                   read_tool_file(settings.tool_table, environment.machine_unit));
    }
    return notes;
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
        const auto letter = static_cast<char>(std::toupper(static_cast<unsigned char>(*at)));
        const size_t axis = gcode::axis_letters.find(letter);
        if (axis >= gcode::axis_count || position[axis]) return std::nullopt;
        at = skip(at + 1, " \t=");
        if (at != end && *at == '+') ++at;
        double value = 0.0;
        const auto [behind, failure] = std::from_chars(at, end, value);
        if (failure != std::errc() || !std::isfinite(value)) return std::nullopt;
        position[axis] = value;
        at = behind;
        any = true;
    }
    return any ? std::optional(position) : std::nullopt;
}

} // namespace app
