#include "app/debug/inspected_value.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "core/base/text.h"
#include "core/motion/machine.h"
#include "gcode/exec/probing.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/language/dialect.h"
#include "gcode/siemens/siemens_state.h"

namespace app {
namespace {

using core::ErrorCode;
using gcode::axis_letters;

/// The kind of value that an expression refers to.
enum class ValueKind : uint8_t {
    numbered, // parameter `letter` `index`
    named,    // #<name>
    declared, // $AA_IM[X] and names declared by a Siemens program
    modal,    // entry `index` of modal_table()
    axis,
    machine_axis,
    offset, // the whole work offset `index`
    origin, // one `axis` of the work offset `index`
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
        if (letter[0] == core::lower(axis_letters[axis])) return axis;
    return std::nullopt;
}

/// `machine.x`, `g54.x`, `g59.1.x`, `g52.x`: one axis of a position or offset.
std::optional<Reference> dotted(std::string_view text) {
    const size_t dot = text.rfind('.');
    if (dot == std::string_view::npos) return std::nullopt;
    const auto axis = axis_named(text.substr(dot + 1));
    const std::string_view of = text.substr(0, dot);
    if (!axis) return std::nullopt;
    if (of == "machine") return Reference{.kind = ValueKind::machine_axis, .axis = *axis};
    if (of == "g52") return Reference{.kind = ValueKind::local_origin, .axis = *axis};
    if (of == "g92") return Reference{.kind = ValueKind::axis_origin, .axis = *axis};
    if (const auto index = offset_named(core::upper_case(of)))
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

/// The reference in a text, which must be in lower case and without blanks.
std::optional<Reference> reference_in(std::string_view text) {
    if (text.empty()) return std::nullopt;
    if (const auto found = parameter(text)) return found;
    if (const auto axis = axis_named(text))
        return Reference{.kind = ValueKind::axis, .axis = *axis};
    if (const auto found = modal(text)) return found;
    if (const auto found = dotted(text)) return found;
    if (const auto index = offset_named(core::upper_case(text)))
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

/// The parameters of a state, for reading as a program would; they must not be written.
gcode::ProgramParameters parameters_of(const gcode::InterpreterState& control,
                                       const gcode::Environment& environment) {
    return {const_cast<gcode::InterpreterState&>(control), environment};
}

core::Result<InspectedValue> numbered(const Reference& asked,
                                      const gcode::InterpreterState& control,
                                      const gcode::Environment& environment) {
    const char letter = parameter_letter(gcode::dialect(environment.dialect));
    if (letter != core::upper(asked.letter))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("this control has no {}{}: its parameters are {}1, {}2, ...",
                                      core::upper_case(std::string(1, asked.letter)), asked.index,
                                      letter, letter));
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
                          fmt::format("'{}' is not a known variable", asked.name));
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
        text += fmt::format(", rotated {} deg", number_text(offset.rotation_deg));
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
        return axis_quantity(asked.axis, gcode::known_position(modal)[asked.axis]);
    case ValueKind::machine_axis:
        return axis_quantity(
            asked.axis,
            gcode::machine_from_program(modal.offsets, gcode::known_position(modal))[asked.axis]);
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
        const std::string axis = core::lower_case(std::string(1, letter));
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
    const std::string small = core::lower_case(word);
    return core::lower_case(value.text) == small
           || (!small.empty() && core::lower_case(value.meaning) == small);
}

bool names_value(const std::string& expression) {
    return reference_in(core::lower_case(without_blanks(expression))).has_value();
}

core::Result<InspectedValue> value_of(const std::string& expression,
                                      const gcode::InterpreterState& control,
                                      const gcode::Environment& environment) {
    const std::string text = core::lower_case(without_blanks(expression));
    if (const auto asked = reference_in(text)) return read(*asked, control, environment);
    const bool declares = gcode::dialect(environment.dialect).names_are_declared;
    if (declares && !text.empty() && parameters_of(control, environment).exists(text))
        return named({.kind = ValueKind::declared, .name = text}, control, environment);
    if (text.empty()) return core::fail(ErrorCode::invalid_value, "the name of a value is missing");
    const std::string nearest = core::nearest_name(text, all_names());
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("the control has no value '{}'; the nearest name is '{}'",
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
    const gcode::Position work = gcode::known_position(control.modal);
    const gcode::Position machine = gcode::machine_from_program(offsets, work);
    std::vector<NamedValue> values;
    for (const bool of_machine : {false, true}) {
        const gcode::Position& position = of_machine ? machine : work;
        for (size_t axis = 0; axis < gcode::axis_count; ++axis) {
            // Axes that the machine lacks always have the value 0.
            const bool tells = axis < 3 || work[axis].value_or(0.0) != 0.0
                               || machine[axis].value_or(0.0) != 0.0
                               || (offsets.machine && offsets.machine->axes[axis].present);
            const std::string letter = core::lower_case(std::string(1, axis_letters[axis]));
            if (tells)
                add(values, (of_machine ? "machine." : "") + letter,
                    axis_quantity(axis, position[axis]));
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
        const gcode::Value value = parameters.stored_value(static_cast<double>(number));
        // In LinuxCNC, local parameters are initially 0.
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
            add(values, "G92." + core::lower_case(std::string(1, axis_letters[axis])),
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
    const std::string start = core::lower_case(text);
    std::vector<std::string> names;
    for (std::string& name : all_names())
        if (core::lower_case(name).starts_with(start)) names.push_back(std::move(name));
    return names;
}

namespace {

using gcode::Dialect;
using State = gcode::InterpreterState;

/// A code and its meaning; in Klartext, which has no codes, only the meaning.
InspectedValue code(const Dialect& dialect, std::string text, std::string meaning) {
    if (dialect.language == gcode::Language::klartext) return {std::nullopt, std::move(meaning)};
    return {std::nullopt, std::move(text), std::move(meaning)};
}

const char* meaning_of(gcode::MotionCode motion) {
    switch (motion) {
    case gcode::MotionCode::rapid:
        return "rapid";
    case gcode::MotionCode::straight:
        return "feed";
    case gcode::MotionCode::arc_clockwise:
        return "arc clockwise";
    case gcode::MotionCode::arc_counterclockwise:
        return "arc counterclockwise";
    default:
        return "special";
    }
}

InspectedValue motion(const State& state, const Dialect& dialect) {
    if (state.modal.cycle) return code(dialect, written(state.modal.cycle->code), "cycle");
    if (!state.modal.motion) return {std::nullopt, "none"};
    return code(dialect, written(*state.modal.motion), meaning_of(*state.modal.motion));
}

InspectedValue plane(const State& state, const Dialect& dialect) {
    constexpr const char* codes[] = {"G17", "G18", "G19", "G17.1", "G18.1", "G19.1"};
    constexpr const char* names[] = {"XY", "ZX", "YZ", "UV", "WU", "VW"};
    const auto index = static_cast<size_t>(state.modal.plane);
    return code(dialect, codes[index], names[index]);
}

InspectedValue unit(const State& state, const Dialect& dialect) {
    const bool inch = state.modal.unit == gcode::LengthUnit::inch;
    if (dialect.language != gcode::Language::siemens)
        return code(dialect, inch ? "G20" : "G21", inch ? "inch" : "mm");
    const bool feeds_as_well = siemens_of(state).feeds_in_inches;
    return code(dialect, inch ? (feeds_as_well ? "G700" : "G70") : "G71", inch ? "inch" : "mm");
}

InspectedValue distance(const State& state, const Dialect& dialect) {
    const bool absolute = state.modal.distance == gcode::DistanceMode::absolute;
    return code(dialect, absolute ? "G90" : "G91", absolute ? "absolute" : "incremental");
}

const char* unit_of_feed(const State& state) {
    switch (state.modal.feed_mode) {
    case gcode::FeedMode::per_minute:
        return "mm/min";
    case gcode::FeedMode::per_turn:
        return "mm/rev";
    default:
        return "1/min";
    }
}

InspectedValue feed_mode(const State& state, const Dialect& dialect) {
    constexpr const char* codes[] = {"G94", "G93", "G95"};
    return code(dialect, codes[static_cast<size_t>(state.modal.feed_mode)], unit_of_feed(state));
}

InspectedValue feed(const State& state, const Dialect&) {
    if (!state.modal.feed) return {std::nullopt, "none"};
    return quantity(state.modal.feed, unit_of_feed(state));
}

InspectedValue speed(const State& state, const Dialect&) {
    return quantity(state.modal.speed, state.modal.surface_speed ? "m/min" : "rev/min");
}

InspectedValue spindle(const State& state, const Dialect&) {
    switch (state.modal.spindle) {
    case core::SpindleDirection::stopped:
        return {std::nullopt, "M5", "stopped"};
    case core::SpindleDirection::clockwise:
        return {std::nullopt, "M3", "clockwise"};
    default:
        return {std::nullopt, "M4", "counterclockwise"};
    }
}

InspectedValue coolant(const State& state, const Dialect&) {
    if (state.modal.mist && state.modal.flood) return {std::nullopt, "M7 M8", "mist and flood"};
    if (state.modal.mist) return {std::nullopt, "M7", "mist"};
    if (state.modal.flood) return {std::nullopt, "M8", "flood"};
    return {std::nullopt, "M9", "off"};
}

InspectedValue number_of(char letter, std::optional<int> number) {
    if (!number) return {std::nullopt, "none"};
    return {*number, fmt::format("{}{}", letter, *number)};
}

std::optional<int> plain(const std::optional<core::ToolNumber>& number) {
    return number ? std::optional(core::value_of(*number)) : std::nullopt;
}

InspectedValue tool(const State& state, const Dialect&) {
    return number_of('T', plain(state.modal.tool));
}

InspectedValue selected_tool(const State& state, const Dialect&) {
    return number_of('T', plain(state.modal.selected_tool));
}

/// The active length, along the axis on which it acts.
InspectedValue length(const State& state, const Dialect& dialect) {
    const bool turns = !dialect.length_needs_g43;
    return quantity(
        state.modal.offsets.tool[turns ? gcode::axes_of(state.modal.plane).normal : size_t{2}],
        "mm");
}

InspectedValue length_number(const State& state, const Dialect& dialect) {
    const auto& number = state.modal.length_number;
    return number_of(dialect.length_needs_g43 ? 'H' : 'T',
                     number ? std::optional(core::value_of(*number)) : std::nullopt);
}

InspectedValue offset(const State& state, const Dialect&) {
    return {std::nullopt, offset_name(state.modal.offsets.active)};
}

InspectedValue path(const State& state, const Dialect& dialect) {
    constexpr const char* codes[] = {"G61", "G61.1", "G64"};
    constexpr const char* names[] = {"exact path", "exact stop", "continuous"};
    const auto index = static_cast<size_t>(state.modal.path);
    const bool siemens = dialect.language == gcode::Language::siemens && index < 2;
    return code(dialect, siemens ? "G60" : codes[index], names[index]);
}

InspectedValue compensation(const State& state, const Dialect& dialect) {
    constexpr const char* codes[] = {"G40", "G41", "G42"};
    constexpr const char* names[] = {"off", "left", "right"};
    const auto index = static_cast<size_t>(state.modal.compensation);
    return code(dialect, codes[index], names[index]);
}

InspectedValue retract(const State& state, const Dialect& dialect) {
    const bool initial = state.modal.retract == gcode::RetractMode::initial_level;
    const char* meaning = initial ? "to the initial level" : "to R";
    if (dialect.language != gcode::Language::words) return {std::nullopt, meaning};
    return code(dialect, initial ? "G98" : "G99", meaning);
}

/// The coordinate transformations of the program, in words.
InspectedValue transform(const State& state, const Dialect&) {
    const gcode::Offsets& offsets = state.modal.offsets;
    const core::Mat3& linear = offsets.frame.linear;
    std::string text;
    const auto add = [&](bool holds, const char* words) {
        if (holds) text += (text.empty() ? "" : ", ") + std::string(words);
    };
    const double volume = glm::determinant(linear);
    add(offsets.tilted_plane || offsets.frame.tilts_tool, "tilted plane");
    add(offsets.follows_tip, "follows the tip");
    add(offsets.has_frame && volume < 0.0, "mirrored");
    add(offsets.has_frame && std::abs(std::abs(volume) - 1.0) > 1e-9, "scaled");
    add(offsets.has_frame && std::abs(linear[0][1]) > 1e-12, "turned");
    if (text.empty()) text = offsets.has_frame ? "shifted" : "none";
    return {std::nullopt, text};
}

constexpr ModalKind numeric = ModalKind::number, word = ModalKind::word;

constexpr ModalEntry entries[] = {
    {"motion", word, "", motion},
    {"plane", word, "G17,G18,G19,G17.1,G18.1,G19.1,XY,ZX,YZ,UV,WU,VW", plane},
    {"unit", word, "G20,G21,G70,G71,G700,mm,inch", unit},
    {"distance", word, "G90,G91,absolute,incremental", distance},
    {"feed_mode", word, "G93,G94,G95,mm/min,mm/rev,1/min", feed_mode},
    {"feed", numeric, "", feed},
    {"speed", numeric, "", speed},
    {"spindle", word, "M3,M4,M5,clockwise,counterclockwise,stopped", spindle},
    {"coolant", word, "M7,M8,M9,M7 M8,mist,flood,off,mist and flood", coolant},
    {"tool", numeric, "", tool},
    {"selected_tool", numeric, "", selected_tool},
    {"length", numeric, "", length},
    {"length_number", numeric, "", length_number},
    {"offset", word, "", offset},
    {"compensation", word, "G40,G41,G42,off,left,right", compensation},
    {"path", word, "G60,G61,G61.1,G64,exact path,exact stop,continuous", path},
    {"retract", word, "G98,G99,to the initial level,to R", retract},
    {"transform", word, "", transform}};

/// The whole number in a text; empty if the text is anything else.
std::optional<size_t> whole(std::string_view text) {
    size_t number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
    return number;
}

} // namespace

std::span<const ModalEntry> modal_table() { return entries; }

const ModalEntry* modal_entry(std::string_view name) {
    for (const ModalEntry& entry : entries)
        if (entry.name == name) return &entry;
    return nullptr;
}

std::vector<std::string> words_of(const ModalEntry& entry) {
    std::vector<std::string> words;
    for (size_t begin = 0; begin < entry.words.size();) {
        const size_t end = std::min(entry.words.find(',', begin), entry.words.size());
        words.emplace_back(entry.words.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

std::string offset_name(size_t index) {
    if (index == gcode::no_work_offset) return "G500";
    if (index < 6) return fmt::format("G{}", 54 + index);
    if (index < gcode::plain_offset_count) return fmt::format("G59.{}", index - 5);
    return fmt::format("G54.1P{}", index - gcode::plain_offset_count + 1);
}

std::optional<size_t> offset_named(std::string_view name) {
    for (size_t index = 0; index < gcode::plain_offset_count; ++index)
        if (name == offset_name(index)) return index;
    constexpr std::string_view numbered = "G54.1P";
    if (!name.starts_with(numbered)) return std::nullopt;
    const auto number = whole(name.substr(numbered.size()));
    if (!number || *number < 1 || *number > gcode::extended_offset_count) return std::nullopt;
    return gcode::plain_offset_count + *number - 1;
}

std::string number_text(double value) { return core::number_text(value, 4); }

InspectedValue quantity(std::optional<double> value, std::string_view unit) {
    if (!value) return {std::nullopt, "unknown"};
    return {value, number_text(*value) + (unit.empty() ? "" : " ") + std::string(unit)};
}

InspectedValue axis_quantity(size_t axis, std::optional<double> value) {
    return quantity(value, gcode::is_rotary(axis) ? "deg" : "mm");
}

} // namespace app
