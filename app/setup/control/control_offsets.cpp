#include "app/setup/control/control_offsets.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/control/offset_store.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/tools/tool_file.h"
#include "core/base/file_reads.h"
#include "core/base/text.h"
#include "gcode/language/canonical.h"
#include "gcode/language/control.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

using gcode::ControlQuestion;

constexpr size_t largest_table = size_t(16) << 20; // bytes

core::Error not_offsets(const std::string& path) {
    return {core::ErrorCode::syntax,
            {},
            "is no file with offsets that is known: neither LinuxCNC's variables (.var) or tool "
            "table (.tbl), nor blocks with G10 (Fanuc, Haas), nor Haas's tool offsets (.ofs)",
            path};
}

bool has_offset_block(const std::vector<std::string>& lines) {
    return std::any_of(lines.begin(), lines.end(),
                       [](const std::string& line) { return has_offset_code(code_of(line)); });
}

/// The words of the first line with code.
std::vector<std::string> first_words(const std::vector<std::string>& lines) {
    for (const std::string& line : lines)
        if (line.find('#') != 0)
            if (auto words = words_of_line(code_of(line)); !words.empty()) return words;
    return {};
}

/// A parameter of a variables file and what it is: one of nine coordinates, or a rotation.
struct VariablePlace {
    ControlOrigin* origin;
    size_t axis; // axis_count: the rotation
    std::string name;
};

std::optional<VariablePlace> place_of_variable(int number, ControlOffsets& offsets) {
    const auto first = [number](int from) { return static_cast<size_t>(number - from); };
    if (number >= 5211 && number <= 5219)
        return VariablePlace{&offsets.shift, first(5211),
                             fmt::format("G92 {}", core::axis_letters[first(5211)])};
    if (number < 5221 || number > 5390) return std::nullopt;
    const size_t index = first(5221) / 20, axis = first(5221) % 20;
    if (axis > core::axis_count || index >= gcode::plain_offset_count) return std::nullopt;
    const char letter = axis < core::axis_count ? core::axis_letters[axis] : 'R';
    return VariablePlace{&offsets.work[index], axis,
                         fmt::format("{} {}", gcode::name_of_offset(index), letter)};
}

/// Lines of a variables file, by parameter.
std::map<int, uint32_t> lines_of_variables(const std::vector<std::string>& lines) {
    std::map<int, uint32_t> numbers;
    for (size_t i = 0; i < lines.size(); ++i)
        if (const auto words = words_of_line(lines[i]); !words.empty())
            if (const auto number = number_in(words[0]))
                numbers.emplace(static_cast<int>(*number), static_cast<uint32_t>(i + 1));
    return numbers;
}

/// Source: LinuxCNC documentation, "Parameters": 5210 is 1 while the offset of G92 in 5211 to 5219
///         is on; 5221 and up, with 20 numbers for each of nine work offsets, of which the tenth is
///         the rotation about Z.
core::Result<void> read_variable_offsets(const std::vector<std::string>& lines,
                                         const OffsetStore& store) {
    FEELER_TRY(const auto variables, read_variables(store.path));
    const auto places = lines_of_variables(lines);
    const bool is_shifted = variables.contains(5210) && variables.at(5210) != 0.0;
    for (const auto& [number, value] : variables) {
        const auto place = place_of_variable(number, store.offsets);
        if (!place || (place->origin == &store.offsets.shift && !is_shifted)) continue;
        const uint32_t line = places.at(number);
        if (place->axis == core::axis_count)
            store.put(place->origin->rotation_deg, store.angle(value, line), place->name);
        else
            store.put(place->origin->axes[place->axis],
                      store.coordinate(place->axis, value, store.reading.unit, line), place->name);
    }
    return {};
}

/// Source: LinuxCNC documentation, "Tool Table Format". An entry without D has no diameter.
core::Result<void> read_table_offsets(const std::vector<std::string>& lines,
                                      const OffsetStore& store) {
    FEELER_TRY(const auto table, read_tool_file(store.path, store.reading.unit));
    std::map<int, uint32_t> places;
    for (size_t i = 0; i < lines.size(); ++i)
        for (const std::string& word : words_of_line(code_of(lines[i])))
            if (const auto number = number_in(std::string_view(word).substr(1));
                word[0] == 'T' && number)
                places.emplace(static_cast<int>(*number), static_cast<uint32_t>(i + 1));
    for (const auto& [key, entry] : table) {
        const int number = core::value_of(key);
        ControlToolOffset& tool = store.offsets.tools[key];
        const auto put = [&](std::optional<ControlValue>& place, double mm, char what) {
            ControlValue value = store.length(mm, gcode::LengthUnit::mm, places[number]);
            value.in_inches = store.reading.unit == gcode::LengthUnit::inch;
            store.put(place, value, fmt::format("{}{}", what, number));
        };
        put(tool.length, entry.length, 'H');
        if (entry.diameter != 0.0) put(tool.diameter, entry.diameter, 'D');
    }
    return {};
}

core::Result<std::string> text_of_table(const std::string& path) {
    if (std::string why = core::why_no_file(path); !why.empty())
        return tl::unexpected(core::Error{core::ErrorCode::io, {}, std::move(why), path});
    auto bytes = core::file_bytes(path, largest_table);
    if (!bytes) return tl::unexpected(core::Error{core::ErrorCode::io, {}, "cannot be read", path});
    if (bytes->size() > largest_table)
        return tl::unexpected(core::Error{
            core::ErrorCode::io, {}, "is larger than 16 MiB, too large for offsets", path});
    return *std::move(bytes);
}

/// Says in which unit a file is read that states none.
void note_unit(const OffsetStore& store) {
    if (store.reading.unit_is_stated) return;
    store.note(
        fmt::format("states no unit and is read in {}: if that is wrong, state --machine-unit "
                    "or unit under [program]",
                    store.reading.unit == gcode::LengthUnit::inch ? "inches" : "mm"));
}

core::Result<void> read_one(const OffsetStore& store) {
    FEELER_TRY(const std::string text, text_of_table(store.path));
    const size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    if (first != std::string::npos && text[first] == '<') {
        note_unit(store);
        return read_haas_offsets(text, store);
    }
    FEELER_TRY(std::vector<std::string> lines, lines_of_file(store.path));
    if (!lines.empty() && lines[0].starts_with("\xEF\xBB\xBF")) lines[0].erase(0, 3);
    if (has_offset_block(lines)) return read_offset_blocks(lines, store);
    const std::vector<std::string> words = first_words(lines);
    const bool is_table =
        !words.empty() && std::any_of(words.begin(), words.end(), [](const std::string& word) {
            return word[0] == 'T' && number_in(word.substr(1));
        });
    const bool is_list = words.size() >= 2 && number_in(words[0]) && number_in(words[1]);
    if (!is_table && !is_list) return tl::unexpected(not_offsets(store.path));
    note_unit(store);
    return is_table ? read_table_offsets(lines, store) : read_variable_offsets(lines, store);
}

/// The answer to a question about a control: stated, else the one that is assumed.
double answer_of(const gcode::Environment& environment, ControlQuestion question) {
    if (const auto stated = environment.control.number(question)) return *stated;
    const auto* parameter = gcode::find_parameter(question, environment.dialect);
    return parameter && !parameter->values.empty() ? parameter->values[0].answer : 0.0;
}

} // namespace

ControlReading reading_of(const SetupFile& setup, gcode::LengthUnit program_unit) {
    const gcode::Environment& environment = setup.environment;
    ControlReading reading{.dialect = environment.dialect};
    reading.unit_is_stated =
        environment.machine_unit_is_stated || environment.units_at_start.has_value();
    reading.unit = environment.machine_unit_is_stated
                       ? environment.machine_unit
                       : environment.units_at_start.value_or(program_unit);
    reading.sizes_are_radii = answer_of(environment, ControlQuestion::radii_are_entered) != 0.0;
    reading.counts_smallest_steps = environment.counts_smallest_steps;
    double factor = 1.0;
    if (environment.control.answer(ControlQuestion::increment_is_finer).value_or(false))
        factor = 0.1;
    if (environment.control.answer(ControlQuestion::increment_is_coarser).value_or(false))
        factor = 10.0;
    for (double* step : {&reading.step_mm, &reading.step_inch, &reading.step_deg}) *step *= factor;
    return reading;
}

core::Result<ControlOffsets> read_control_offsets(const std::vector<std::string>& paths,
                                                  const ControlReading& reading) {
    ControlOffsets offsets;
    for (const std::string& path : paths)
        if (auto read = read_one({offsets, reading, path}); !read)
            return tl::unexpected(core::in_file(std::move(read).error(), path));
    return offsets;
}

ControlValue OffsetStore::length(double written, gcode::LengthUnit unit, uint32_t line) const {
    return {gcode::to_mm(written, unit), unit == gcode::LengthUnit::inch, path, line};
}

ControlValue OffsetStore::angle(double degrees, uint32_t line) const {
    return {degrees, false, path, line};
}

ControlValue OffsetStore::coordinate(size_t axis, double written, gcode::LengthUnit unit,
                                     uint32_t line) const {
    return gcode::is_rotary(axis) ? angle(written, line) : length(written, unit, line);
}

void OffsetStore::put(std::optional<ControlValue>& place, ControlValue value,
                      const std::string& name) const {
    if (place && place->value != value.value)
        note(fmt::format("line {}: {} was {:.3f} before ({}, line {}); the last value counts",
                         value.line, name, place->value, place->file, place->line));
    place = std::move(value);
}

void OffsetStore::note(const std::string& text) const {
    offsets.notes.push_back(fmt::format("{}: {}", path, text));
}

} // namespace app
