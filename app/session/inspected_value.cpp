#include "app/session/inspected_value.h"

#include <charconv>

#include <fmt/format.h>

#include "app/session/modal_table.h"
#include "app/session/value_text.h"
#include "core/base/nearest_name.h"
#include "gcode/program_parameters.h"

namespace app {
namespace {

using core::ErrorCode;
using gcode::axis_letters;

/// What an expression means.
enum class ValueKind : uint8_t {
    numbered, // `index` behind `letter`
    named,    // #<name>
    declared, // $AA_IM[X] and what a program of Siemens declares
    modal,    // `index` of the table
    axis,
    machine_axis,
    offset, // all of the origin `index`
    origin, // its `axis`
    local_origin,
    axis_origin,
    length,
    diameter,
};

struct Reference {
    ValueKind kind;
    size_t index = 0;
    size_t axis = 0;
    char letter = '\0';
    std::string name = {};
};

std::string without_blanks(std::string_view text) {
    std::string rest;
    for (const char c : text)
        if (c != ' ' && c != '\t') rest.push_back(c);
    return rest;
}

std::optional<size_t> index_in(std::string_view text) {
    size_t number = 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    if (read.ec != std::errc() || read.ptr != end || number > 1000000) return std::nullopt;
    return number;
}

std::optional<size_t> axis_named(std::string_view letter) {
    if (letter.size() != 1) return std::nullopt;
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        if (letter[0] == static_cast<char>(axis_letters[axis] - 'A' + 'a')) return axis;
    return std::nullopt;
}

std::string upper_case(std::string_view small) {
    std::string text(small);
    for (char& c : text)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return text;
}

/// `machine.x`, `g54.x`, `g59.1.x`, `g52.x`: something of which an axis is asked.
std::optional<Reference> dotted(std::string_view text) {
    const size_t dot = text.rfind('.');
    if (dot == std::string_view::npos) return std::nullopt;
    const auto axis = axis_named(text.substr(dot + 1));
    const std::string_view of = text.substr(0, dot);
    if (!axis) return std::nullopt;
    if (of == "machine") return Reference{.kind = ValueKind::machine_axis, .axis = *axis};
    if (of == "g52") return Reference{.kind = ValueKind::local_origin, .axis = *axis};
    if (of == "g92") return Reference{.kind = ValueKind::axis_origin, .axis = *axis};
    if (const auto index = offset_named(upper_case(of)))
        return Reference{.kind = ValueKind::origin, .index = *index, .axis = *axis};
    return std::nullopt;
}

std::optional<Reference> parameter(std::string_view text) {
    if (text.starts_with("#<") && text.ends_with(">") && text.size() > 3)
        return Reference{.kind = ValueKind::named,
                         .name = std::string(text.substr(2, text.size() - 3))};
    if (text.front() == '$' && text.size() > 1)
        return Reference{.kind = ValueKind::declared, .name = std::string(text)};
    if (text.front() != '#' && text.front() != 'r' && text.front() != 'q') return std::nullopt;
    const auto number = index_in(text.substr(1));
    if (!number) return std::nullopt;
    return Reference{.kind = ValueKind::numbered, .index = *number, .letter = text.front()};
}

std::optional<Reference> modal(std::string_view text) {
    if (text == "f") text = "feed";
    if (text == "s") text = "speed";
    if (text == "t") text = "tool";
    const auto table = modal_table();
    for (size_t index = 0; index < table.size(); ++index)
        if (table[index].name == text) return Reference{.kind = ValueKind::modal, .index = index};
    return std::nullopt;
}

/// What the text, in small letters and without blanks, means.
std::optional<Reference> reference_in(std::string_view text) {
    if (text.empty()) return std::nullopt;
    if (const auto found = parameter(text)) return found;
    if (const auto axis = axis_named(text))
        return Reference{.kind = ValueKind::axis, .axis = *axis};
    if (const auto found = modal(text)) return found;
    if (const auto found = dotted(text)) return found;
    if (const auto index = offset_named(upper_case(text)))
        return Reference{.kind = ValueKind::offset, .index = *index};
    if (text.front() != 'h' && text.front() != 'd') return std::nullopt;
    const auto number = index_in(text.substr(1));
    if (!number) return std::nullopt;
    return Reference{.kind = text.front() == 'h' ? ValueKind::length : ValueKind::diameter,
                     .index = *number};
}

char parameter_letter(const gcode::Dialect& dialect) {
    return dialect.language == gcode::Language::klartext ? 'Q' : dialect.parameter_letter.front();
}

InspectedValue plain(gcode::Value value) {
    return value ? quantity(value) : InspectedValue{std::nullopt, "not set"};
}

/// Reads the parameters of a state as a program would; nothing is written.
gcode::ProgramParameters parameters_of(const gcode::InterpreterState& control,
                                       const gcode::Environment& environment) {
    return {const_cast<gcode::InterpreterState&>(control), environment};
}

core::Result<InspectedValue> numbered(const Reference& asked,
                                      const gcode::InterpreterState& control,
                                      const gcode::Environment& environment) {
    const char letter = parameter_letter(gcode::dialect(environment.dialect));
    if (letter != (asked.letter == '#' ? '#' : static_cast<char>(asked.letter - 'a' + 'A')))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("this control has no {}{}: its parameters are {}1, {}2, ...",
                                      upper_case(std::string(1, asked.letter)), asked.index, letter,
                                      letter));
    FEELER_TRY(const gcode::Value value,
               parameters_of(control, environment).numbered(static_cast<double>(asked.index), {}));
    return plain(value);
}

core::Result<InspectedValue> named(const Reference& asked, const gcode::InterpreterState& control,
                                   const gcode::Environment& environment) {
    const gcode::ProgramParameters parameters = parameters_of(control, environment);
    if (!parameters.exists(asked.name)) {
        if (asked.name.front() != '$') return InspectedValue{std::nullopt, "not set"};
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("'{}' is no variable that is known here", asked.name));
    }
    FEELER_TRY(const gcode::Value value, parameters.named(asked.name, {}));
    return plain(value);
}

std::string text_of(const gcode::WorkOffset& offset) {
    std::string text;
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        if (axis < 3 || offset.origin[axis] != 0.0)
            text += fmt::format("{}{}{}", text.empty() ? "" : " ", axis_letters[axis],
                                number_text(offset.origin[axis]));
    if (offset.rotation_deg != 0.0)
        text += fmt::format(", turned {} deg", number_text(offset.rotation_deg));
    return text;
}

InspectedValue of_table(std::optional<double> value) {
    return value ? quantity(value, "mm") : InspectedValue{std::nullopt, "not in the table"};
}

core::Result<InspectedValue> read(const Reference& asked, const gcode::InterpreterState& control,
                                  const gcode::Environment& environment) {
    const gcode::ModalState& modal = control.modal;
    const gcode::Tables& tables = *control.tables;
    switch (asked.kind) {
    case ValueKind::numbered:
        return numbered(asked, control, environment);
    case ValueKind::named:
    case ValueKind::declared:
        return named(asked, control, environment);
    case ValueKind::modal:
        return modal_table()[asked.index].read(control, gcode::dialect(environment.dialect));
    case ValueKind::axis:
        return axis_quantity(asked.axis, modal.position[asked.axis]);
    case ValueKind::machine_axis:
        return axis_quantity(
            asked.axis, gcode::machine_from_program(modal.offsets, modal.position)[asked.axis]);
    case ValueKind::offset:
        return InspectedValue{std::nullopt, text_of(gcode::work_offset(tables, asked.index))};
    case ValueKind::origin:
        return axis_quantity(asked.axis,
                             gcode::work_offset(tables, asked.index).origin[asked.axis]);
    case ValueKind::local_origin:
        return axis_quantity(asked.axis, modal.offsets.local[asked.axis]);
    case ValueKind::axis_origin:
        return axis_quantity(asked.axis, modal.offsets.axis[asked.axis]);
    case ValueKind::length:
        return of_table(gcode::length_under(tables, static_cast<int>(asked.index)));
    default:
        return of_table(gcode::diameter_under(tables, static_cast<int>(asked.index)));
    }
}

std::vector<std::string> all_names() {
    std::vector<std::string> names;
    for (const ModalEntry& entry : modal_table()) names.emplace_back(entry.name);
    for (const char letter : axis_letters) {
        const std::string axis = lowered(std::string(1, letter));
        names.push_back(axis);
        names.push_back("machine." + axis);
    }
    for (size_t index = 0; index < gcode::plain_offset_count; ++index) {
        names.push_back(offset_name(index));
        for (const char* axis : {".x", ".y", ".z"}) names.push_back(offset_name(index) + axis);
    }
    for (const char* axis : {".x", ".y", ".z"}) {
        names.push_back(std::string("G52") + axis);
        names.push_back(std::string("G92") + axis);
    }
    return names;
}

void add(std::vector<NamedValue>& values, std::string name, InspectedValue value) {
    values.push_back({std::move(name), std::move(value)});
}

} // namespace

bool is_word(const InspectedValue& value, std::string_view word) {
    const std::string small = lowered(word);
    return lowered(value.text) == small || (!small.empty() && lowered(value.meaning) == small);
}

bool names_value(const std::string& expression) {
    return reference_in(lowered(without_blanks(expression))).has_value();
}

core::Result<InspectedValue> value_of(const std::string& expression,
                                      const gcode::InterpreterState& control,
                                      const gcode::Environment& environment) {
    const std::string text = lowered(without_blanks(expression));
    if (const auto asked = reference_in(text)) return read(*asked, control, environment);
    const bool declares = gcode::dialect(environment.dialect).names_are_declared;
    if (declares && !text.empty() && parameters_of(control, environment).exists(text))
        return named({.kind = ValueKind::declared, .name = text}, control, environment);
    if (text.empty()) return core::fail(ErrorCode::invalid_value, "no value is named");
    const std::string nearest = core::nearest_name(text, all_names());
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("'{}' is no value of the control; the nearest name is '{}'",
                                  expression, nearest));
}

std::vector<NamedValue> modal_values(const gcode::InterpreterState& control,
                                     const gcode::Environment& environment) {
    std::vector<NamedValue> values;
    for (const ModalEntry& entry : modal_table())
        add(values, std::string(entry.name),
            entry.read(control, gcode::dialect(environment.dialect)));
    return values;
}

std::vector<NamedValue> axis_values(const gcode::InterpreterState& control) {
    const gcode::Offsets& offsets = control.modal.offsets;
    const gcode::Position& work = control.modal.position;
    const gcode::Position machine = gcode::machine_from_program(offsets, work);
    std::vector<NamedValue> values;
    for (const bool of_machine : {false, true}) {
        const gcode::Position& place = of_machine ? machine : work;
        for (size_t axis = 0; axis < gcode::axis_count; ++axis) {
            // Axes that a machine lacks stand at 0 for ever.
            const bool tells = axis < 3 || work[axis].value_or(0.0) != 0.0
                               || machine[axis].value_or(0.0) != 0.0
                               || (offsets.machine && offsets.machine->axes[axis].present);
            const std::string letter = lowered(std::string(1, axis_letters[axis]));
            if (tells)
                add(values, (of_machine ? "machine." : "") + letter,
                    axis_quantity(axis, place[axis]));
        }
    }
    return values;
}

std::vector<NamedValue> parameter_values(const gcode::InterpreterState& control,
                                         const gcode::Environment& environment) {
    const gcode::Dialect& dialect = gcode::dialect(environment.dialect);
    const gcode::ProgramParameters parameters = parameters_of(control, environment);
    const char letter = parameter_letter(dialect);
    std::vector<NamedValue> values;
    const auto numbers = std::max(control.parameters->numbered_count(),
                                  static_cast<size_t>(dialect.local_count) + 1);
    for (size_t number = 1; number < numbers; ++number) {
        const bool is_local = static_cast<int>(number) <= dialect.local_count;
        const gcode::Value value = parameters.kept(static_cast<double>(number));
        // LinuxCNC's local ones are 0 before anything is said.
        if (!value || (is_local && !dialect.unset_is_vacant && *value == 0.0)) continue;
        const bool is_zero =
            static_cast<int>(number) == gcode::highest_parameter && dialect.has_parameter_zero;
        add(values, fmt::format("{}{}", letter, is_zero ? 0 : number), quantity(value));
    }
    for (const auto& [name, value] : control.frames.back().named)
        add(values, dialect.names_are_declared ? name : fmt::format("#<{}>", name),
            quantity(value));
    for (const auto& [name, value] : control.parameters->named())
        add(values, fmt::format("#<{}>", name), quantity(value));
    return values;
}

std::vector<NamedValue> offset_values(const gcode::InterpreterState& control) {
    const gcode::Tables& tables = *control.tables;
    const gcode::Offsets& offsets = control.modal.offsets;
    std::vector<NamedValue> values;
    for (size_t index = 0; index < tables.work.size(); ++index) {
        const gcode::WorkOffset offset = gcode::work_offset(tables, index);
        if (index == offsets.active || offset != gcode::WorkOffset{})
            add(values, offset_name(index), {std::nullopt, text_of(offset)});
    }
    if (offsets.local != gcode::AxisValues{})
        add(values, "G52", {std::nullopt, text_of(gcode::WorkOffset{offsets.local, 0.0})});
    for (size_t axis = 0; axis < gcode::axis_count; ++axis)
        if (offsets.axis[axis] != 0.0)
            add(values, "G92." + lowered(std::string(1, axis_letters[axis])),
                axis_quantity(axis, offsets.axis[axis]));
    for (const auto& [number, entry] : tables.lengths)
        add(values, fmt::format("H{}", core::value_of(number)),
            quantity(entry.length + entry.wear, "mm"));
    for (const auto& [tool, length] : tables.tool_lengths)
        if (!tables.lengths.contains(core::OffsetNumber(core::value_of(tool))))
            add(values, fmt::format("H{}", core::value_of(tool)), quantity(length, "mm"));
    return values;
}

std::vector<std::string> names_beginning(const std::string& text) {
    const std::string start = lowered(text);
    std::vector<std::string> names;
    for (std::string& name : all_names())
        if (lowered(name).starts_with(start)) names.push_back(std::move(name));
    return names;
}

} // namespace app
