#include "app/setup/control_table.h"

#include <algorithm>
#include <array>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/table_reader.h"
#include "core/base/text.h"
#include "core/motion/machine.h"
#include "gcode/language/control.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/language/lexer.h"

namespace app {
namespace {

using gcode::ControlParameter;
using gcode::ControlSetting;

void read_preset(TableReader& table, const char* key, StatedControl& control) {
    std::vector<std::string_view> names;
    for (const gcode::ControlPreset& preset : gcode::control_presets())
        names.push_back(preset.name);
    if (!table.has(key)) return;
    if (!table.is_text(key))
        return table.refuse(
            key, fmt::format("must be the name of a control in quotes: {}", fmt::join(names, " ")));
    const std::string name = core::lower_case(table.string(key).value_or(""));
    control.preset = gcode::find_preset(name);
    if (!control.preset) table.word(key, names); // refuses it
}

std::vector<std::string> known_keys() {
    std::vector<std::string> keys = {"preset"};
    for (const ControlParameter& parameter : gcode::control_parameters())
        if (!parameter.key.empty()) keys.emplace_back(parameter.key);
    for (const ControlSetting& setting : gcode::control_settings()) keys.emplace_back(setting.key);
    return keys;
}

/// The key that was probably meant: that of a parameter with this name, such as "5006#6" for TOS,
/// else a word that differs in few letters; empty if there is none. Another number is another
/// parameter.
std::string suggestion(const std::string& key) {
    std::string plain; // "SETTING_9" is "setting 9"
    for (const char c : key) {
        const bool is_digit = c >= '0' && c <= '9';
        if (is_digit && !plain.empty() && plain.back() >= 'a' && plain.back() <= 'z') plain += ' ';
        plain += c == '_' || c == '-' ? ' ' : core::lower(c);
    }
    for (const ControlParameter& parameter : gcode::control_parameters()) {
        const std::string name = core::lower_case(parameter.name);
        if (!parameter.key.empty() && name.ends_with(fmt::format("({})", core::lower_case(key))))
            return std::string(parameter.key);
    }
    const std::vector<std::string> keys = known_keys();
    if (std::find(keys.begin(), keys.end(), plain) != keys.end()) return plain;
    const std::string nearest = core::nearest_name(key, keys);
    const auto without_bit = [](std::string_view name) { return name.substr(0, name.find('#')); };
    const bool has_digit = std::any_of(key.begin(), key.end(), gcode::is_digit);
    const bool is_meant = has_digit
                              ? without_bit(key) == without_bit(nearest)
                              : nearest.starts_with(key) || core::edit_distance(key, nearest) <= 3;
    return is_meant ? nearest : std::string();
}

template <typename Row>
const Row* row_named(std::span<const Row> rows, std::string_view key) {
    const auto found =
        std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.key == key; });
    return found == rows.end() ? nullptr : &*found;
}

/// The number of a value that is written as a word, such as "INCH".
std::optional<double> number_of_word(const ControlParameter& parameter, std::string_view word) {
    for (const gcode::ParameterValue& value : parameter.values)
        if (!value.word.empty() && value.word == word) return value.number;
    return std::nullopt;
}

/// A position with the coordinates of its linear axes in mm.
gcode::Position in_mm(gcode::Position position, gcode::LengthUnit unit) {
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        if (position[axis] && !core::is_rotary(axis))
            position[axis] = gcode::to_mm(*position[axis], unit);
    return position;
}

/// What a parameter measures. LinuxCNC's lengths are in a unit that the file does not decide.
Measure measure_of(std::span<const gcode::DialectId> dialects, bool is_length) {
    const bool is_of_file =
        is_length
        && std::find(dialects.begin(), dialects.end(), gcode::DialectId::linuxcnc)
               == dialects.end();
    return is_of_file ? Measure::length : Measure::plain;
}

void read_parameter(TableReader& table, const char* key, const ControlParameter& parameter,
                    StatedControl& control) {
    const gcode::ParameterRange& range = parameter.range;
    const Measure measure = measure_of(parameter.dialects, range.unit == "mm");
    const auto refuse = [&] {
        if (measure == Measure::length && table.unit() == gcode::LengthUnit::inch)
            return table.refuse(key,
                                fmt::format("must lie between {} and {}", table.shown(range.lowest),
                                            table.shown(range.highest)));
        std::string values;
        for (const gcode::ParameterValue& value : parameter.values)
            values += fmt::format("; {}: {}",
                                  value.word.empty() ? fmt::format("{:g}", value.number)
                                                     : std::string(value.word),
                                  value.text);
        table.refuse(key, fmt::format("must be {}{}", parameter.choices(), values));
    };
    std::optional<double> number;
    if (table.is_text(key)) {
        const auto word = table.string(key);
        if (word) number = number_of_word(parameter, *word);
        if (word && !number) return refuse();
    } else {
        number = table.number(key, measure);
    }
    if (!number) return;
    if (!parameter.answer_of(*number)) return refuse();
    control.parameters[key] = *number;
}

/// A list of coordinates in the order of the axes, or a table such as { X = 0, Y = 0, Z = 0 }.
///
/// `measure`: of the linear axes.
std::optional<gcode::Position> read_position(TableReader& table, const char* key, Measure measure) {
    gcode::Position position;
    if (table.is_list(key)) {
        const auto lengths = table.numbers(key, measure, 0);
        const auto numbers = table.numbers(key, Measure::plain, 0);
        if (!lengths || !numbers) return std::nullopt;
        if (numbers->empty() || numbers->size() % 3 != 0 || numbers->size() > gcode::axis_count) {
            table.refuse(key, "must have 3, 6 or 9 coordinates, in the order X Y Z A B C U V W");
            return std::nullopt;
        }
        for (size_t axis = 0; axis < numbers->size(); ++axis)
            position[axis] = core::is_rotary(axis) ? (*numbers)[axis] : (*lengths)[axis];
        return position;
    }
    auto axes = table.table(key, fmt::format("[control] {}", key));
    if (!axes) return std::nullopt;
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        position[axis] = axes->number(std::string(1, gcode::axis_letters[axis]).c_str(),
                                      core::is_rotary(axis) ? Measure::angle : measure);
    axes->finish();
    if (!position[0] || !position[1] || !position[2]) {
        table.refuse(key, "must state X, Y and Z");
        return std::nullopt;
    }
    return position;
}

void read_setting(TableReader& table, const char* key, const ControlSetting& setting,
                  StatedControl& control) {
    const auto keep = [&](auto value) {
        if (value) control.settings[key] = *std::move(value);
    };
    switch (setting.kind) {
    case gcode::SettingKind::flag:
        return keep(table.boolean(key));
    case gcode::SettingKind::number:
        return keep(table.number(key, Measure::plain));
    case gcode::SettingKind::length:
        return keep(table.number(key, measure_of(setting.dialects, true)));
    case gcode::SettingKind::position:
        return keep(read_position(table, key, measure_of(setting.dialects, true)));
    case gcode::SettingKind::text:
        return keep(table.string(key));
    }
}

void read_key(TableReader& table, const char* key, StatedControl& control) {
    if (const auto* parameter = row_named(gcode::control_parameters(), key))
        return read_parameter(table, key, *parameter, control);
    if (const auto* setting = row_named(gcode::control_settings(), key))
        return read_setting(table, key, *setting, control);
    const std::string meant = suggestion(key);
    table.refuse(key, "is not a parameter that Feeler knows; "
                          + (meant.empty() ? std::string("the manual lists them under "
                                                         "\"The control\"")
                                           : fmt::format("did you mean \"{}\"?", meant)));
}

/// W of LinuxCNC's 5axiskins, if the set-up has no axis of that name. It is at 0 at the start.
void take_length_axis(gcode::Environment& environment, core::Machine& machine) {
    if (!environment.kinematics || !environment.kinematics->machine) return;
    const core::Machine& known = *environment.kinematics->machine;
    if (!known.length_axis || machine.axes[*known.length_axis].present) return;
    machine.length_axis = known.length_axis;
    machine.axes[*known.length_axis] = known.axes[*known.length_axis];
    std::optional<double>& start = environment.start[*known.length_axis];
    start = start.value_or(0.0);
    if (environment.machine) environment.machine = std::make_shared<const core::Machine>(machine);
}

void answer(const ControlParameter& parameter, double number, gcode::Environment& environment,
            core::Machine& machine) {
    const double answer = *parameter.answer_of(number);
    environment.control.answers[parameter.question] = answer;
    // G70 of Siemens does not concern feeds.
    const bool is_unit = parameter.question == gcode::ControlQuestion::starts_in_inches
                         && environment.dialect != gcode::DialectId::siemens;
    if (is_unit && !environment.units_at_start)
        environment.units_at_start =
            answer != 0.0 ? gcode::LengthUnit::inch : gcode::LengthUnit::mm;
    if (parameter.question == gcode::ControlQuestion::point_is_implied)
        environment.counts_smallest_steps = answer == 0.0;
    if (parameter.question == gcode::ControlQuestion::rapids_are_straight)
        machine.rapid = answer != 0.0 ? core::RapidStyle::straight : core::RapidStyle::dogleg;
    if (parameter.question == gcode::ControlQuestion::w_has_no_motor)
        take_length_axis(environment, machine);
}

/// Coordinates of the linear axes are in the unit of LinuxCNC's machine; elsewhere in mm.
gcode::SettingValue in_mm(gcode::SettingValue value, const gcode::Environment& environment) {
    const auto* position = std::get_if<gcode::Position>(&value);
    if (!position || environment.dialect != gcode::DialectId::linuxcnc) return value;
    return in_mm(*position, environment.machine_unit);
}

} // namespace

void read_control(TableReader& root, StatedControl& control) {
    if (root.has("control") && !root.is_table("control"))
        return read_preset(root, "control", control);
    auto table = root.table("control", "[control]");
    if (!table) return;
    read_preset(*table, "preset", control);
    for (const std::string& key : table->keys())
        if (key != "preset") read_key(*table, key.c_str(), control);
    table->finish();
}

core::Result<std::vector<std::string>>
apply(const StatedControl& control, gcode::Environment& environment, core::Machine& machine) {
    std::vector<std::string> notes;
    const std::string_view dialect = gcode::dialect(environment.dialect).name;
    const auto has_no_effect = [&](std::string_view key) {
        notes.push_back(fmt::format("\"{}\" under [control] has no effect for {}", key, dialect));
    };
    if (control.preset && control.preset->dialect == environment.dialect)
        for (const auto& [key, number] : control.preset->values)
            if (const auto* parameter = gcode::find_parameter(key, environment.dialect))
                answer(*parameter, number, environment, machine);
    if (control.preset && control.preset->dialect != environment.dialect)
        notes.push_back(fmt::format("the control {} has no effect: the program is read as {}",
                                    control.preset->name, dialect));
    for (const auto& [key, number] : control.parameters) {
        if (const auto* parameter = gcode::find_parameter(key, environment.dialect))
            answer(*parameter, number, environment, machine);
        else
            has_no_effect(key);
    }
    for (const auto& [key, value] : control.settings) {
        if (const auto* setting = gcode::find_setting(key, environment.dialect))
            setting->set(environment, in_mm(value, environment));
        else
            has_no_effect(key);
    }
    if (control.settings.contains("RS274NGC_STARTUP_CODE"))
        if (auto run = check_startup_code(environment); !run) return tl::unexpected(run.error());
    return notes;
}

} // namespace app
