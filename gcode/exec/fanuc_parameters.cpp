#include "gcode/exec/fanuc_parameters.h"

#include <cmath>
#include <span>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/modes.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"

namespace gcode {
namespace {

using core::OffsetNumber;

constexpr int milliseconds_timer = 3001, hours_timer = 3002, date = 3011, time_of_day = 3012;
constexpr int tool_of_8000s = 8550;
constexpr double seconds_of_block = 1.0;

/// Variables whose meaning depends on how the control stores tool offsets.
enum class Stored : uint8_t {
    always_so,
    as_size,   // a diameter, or a radius on a control on which radii are entered
    as_wear,   // of H, or of H and D; or the only value of the number
    as_length, // of H, or of H and D
};

/// A range of variables for consecutive axes, offsets or tools.
struct Range {
    int first, last;
    Value (*read)(const InterpreterState& state, int index);
    void (*write)(InterpreterState& state, int index, double value); // null: read-only
    Stored stored = Stored::always_so;
};

double shown(const InterpreterState& state, size_t axis, double value) {
    return is_rotary(axis) ? value : from_mm(value, state.modal.unit);
}

double taken(const InterpreterState& state, size_t axis, double value) {
    return is_rotary(axis) ? value : to_mm(value, state.modal.unit);
}

Value shown(const InterpreterState& state, size_t axis, std::optional<double> value) {
    return value ? Value(shown(state, axis, *value)) : Value{};
}

// --- positions ---

Value block_end(const InterpreterState& state, int index) {
    const auto axis = static_cast<size_t>(index);
    return shown(state, axis, state.modal.position[axis]);
}

Value machine_position(const InterpreterState& state, int index) {
    const auto axis = static_cast<size_t>(index);
    return shown(state, axis,
                 machine_from_program(state.modal.offsets, state.modal.position)[axis]);
}

/// The position of the gauge line in program coordinates: includes the tool offset.
Value work_position(const InterpreterState& state, int index) {
    const auto axis = static_cast<size_t>(index);
    std::optional<double> position = state.modal.position[axis];
    if (position) *position += state.modal.offsets.tool[axis];
    return shown(state, axis, position);
}

Value tool_compensation(const InterpreterState& state, int index) {
    const auto axis = static_cast<size_t>(index);
    return shown(state, axis, state.modal.offsets.tool[axis]);
}

// --- work offsets ---

/// Activates the values of the table without moving the machine.
void use_work_offset(InterpreterState& state) {
    Offsets offsets = state.modal.offsets;
    offsets.work = work_offset(*state.tables, offsets.active);
    for (size_t axis = 0; axis < axis_count; ++axis)
        offsets.work.origin[axis] += state.tables->external[axis];
    change_offsets(state.modal, offsets);
}

Value local_offset(const InterpreterState& state, int index) {
    const auto axis = static_cast<size_t>(index);
    return shown(state, axis, state.modal.offsets.local[axis]);
}

/// Without moving the machine, as G52 does.
void set_local_offset_of(InterpreterState& state, int index, double value) {
    const auto axis = static_cast<size_t>(index);
    Offsets offsets = state.modal.offsets;
    offsets.local[axis] = taken(state, axis, value);
    change_offsets(state.modal, offsets);
}

constexpr int stride = 20; // variables per offset

Value external_offset(const InterpreterState& state, int index) {
    const auto axis = static_cast<size_t>(index);
    return shown(state, axis, state.tables->external[axis]);
}

void set_external_offset(InterpreterState& state, int index, double value) {
    const auto axis = static_cast<size_t>(index);
    state.tables.write().external[axis] = taken(state, axis, value);
    use_work_offset(state);
}

Value offset_at(const InterpreterState& state, size_t from, int index) {
    const auto axis = static_cast<size_t>(index % stride);
    if (axis >= axis_count) return {};
    const auto which = from + static_cast<size_t>(index / stride);
    return shown(state, axis, work_offset(*state.tables, which).origin[axis]);
}

void set_offset_at(InterpreterState& state, size_t from, int index, double value) {
    const auto axis = static_cast<size_t>(index % stride);
    if (axis >= axis_count) return;
    const auto which = from + static_cast<size_t>(index / stride);
    writable_work_offset(state.tables.write(), which).origin[axis] = taken(state, axis, value);
    use_work_offset(state);
}

Value plain_offset(const InterpreterState& state, int index) { return offset_at(state, 0, index); }
void set_plain_offset(InterpreterState& state, int index, double value) {
    set_offset_at(state, 0, index, value);
}
Value extended_offset(const InterpreterState& state, int index) {
    return offset_at(state, plain_offset_count, index);
}
void set_extended_offset(InterpreterState& state, int index, double value) {
    set_offset_at(state, plain_offset_count, index, value);
}

// --- tool offsets ---

enum class Part : uint8_t { length, length_wear, diameter, diameter_wear };

LengthOffset entry_of(const InterpreterState& state, int number) {
    const auto& lengths = state.tables->lengths;
    if (const auto entry = lengths.find(OffsetNumber(number)); entry != lengths.end())
        return entry->second;
    return {.length = length_under(*state.tables, number).value_or(0.0)};
}

template <Part part>
Value tool_part(const InterpreterState& state, int index) {
    const LengthOffset entry = entry_of(state, index + 1);
    double value = entry.length;
    if (part == Part::length_wear) value = entry.wear;
    if (part == Part::diameter) value = entry.diameter;
    if (part == Part::diameter_wear) value = entry.radius_wear * 2.0;
    return from_mm(value, state.modal.unit);
}

template <Part part>
void set_tool_part(InterpreterState& state, int index, double value) {
    LengthOffset entry = entry_of(state, index + 1);
    const double length = to_mm(value, state.modal.unit);
    if (part == Part::length) entry.length = length;
    if (part == Part::length_wear) entry.wear = length;
    if (part == Part::diameter) entry.diameter = length;
    if (part == Part::diameter_wear) entry.radius_wear = length / 2.0;
    const auto number = OffsetNumber(index + 1);
    state.tables.write().lengths[number] = entry;
    const ModalState& modal = state.modal;
    if (modal.length_sign == 0.0 || modal.length_number != number) return;
    Offsets offsets = modal.offsets;
    offsets.tool[2] = modal.length_sign * (entry.length + entry.wear);
    change_offsets(state.modal, offsets);
}

/// Haas: data of the tool whose number is in #8550.
template <Part part>
Value named_tool_part(const InterpreterState& state, int) {
    const double tool = state.parameters->numbered(tool_of_8000s).value_or(0.0);
    if (!(tool >= 1.0 && tool <= 200.0)) return {};
    return tool_part<part>(state, static_cast<int>(core::round_to_integer(tool)) - 1);
}

// --- the control ---

Value modal_group(const InterpreterState& state, int index) { return fanuc_mode(state, index + 1); }

Value said_word(const InterpreterState& state, int index) {
    return state.said[static_cast<size_t>(index) + 1];
}

Value number_of_extended_offset(const InterpreterState& state, int) {
    const size_t active = state.modal.offsets.active;
    return active < plain_offset_count ? 0.0 : static_cast<double>(active - plain_offset_count + 1);
}

Value tool_in_spindle(const InterpreterState& state, int) {
    return state.modal.tool ? Value(core::value_of(*state.modal.tool)) : Value{};
}

Value spindle_speed(const InterpreterState& state, int) {
    return state.modal.spindle == core::SpindleDirection::stopped ? 0.0 : state.modal.speed;
}

// Programs are checked without a clock: it is always noon on 1 January 2020.
Value day(const InterpreterState&, int) { return 20200101.0; }
Value noon(const InterpreterState&, int) { return 120000.0; }

using enum Part;

constexpr Range common_ranges[] = {
    {date, date, day, nullptr},
    {time_of_day, time_of_day, noon, nullptr},
    {4001, 4022, modal_group, nullptr},
    {4101, 4126, said_word, nullptr},
    {4130, 4130, number_of_extended_offset, nullptr},
    {5001, 5009, block_end, nullptr},
    {5021, 5029, machine_position, nullptr},
    {5081, 5089, tool_compensation, nullptr},
    {5221, 5329, plain_offset, set_plain_offset},
    {7001, 7400, extended_offset, set_extended_offset},
};

constexpr Range fanuc_ranges[] = {
    {2001, 2200, tool_part<length_wear>, set_tool_part<length_wear>, Stored::as_wear},
    {2201, 2400, tool_part<length>, set_tool_part<length>, Stored::as_length},
    {5041, 5049, work_position, nullptr},
    {5201, 5209, external_offset, set_external_offset},
    {7401, 7960, [](const InterpreterState& s, int i) { return extended_offset(s, i + 400); },
     [](InterpreterState& s, int i, double v) { set_extended_offset(s, i + 400, v); }},
    {10001, 10999, tool_part<length_wear>, set_tool_part<length_wear>, Stored::as_wear},
    {11001, 11999, tool_part<length>, set_tool_part<length>, Stored::as_length},
    {12001, 12999, tool_part<diameter_wear>, set_tool_part<diameter_wear>, Stored::as_size},
    {13001, 13999, tool_part<diameter>, set_tool_part<diameter>, Stored::as_size},
    {14001, 19980, extended_offset, set_extended_offset},
};

constexpr Range haas_ranges[] = {
    {2001, 2200, tool_part<length>, set_tool_part<length>},
    {2201, 2400, tool_part<length_wear>, set_tool_part<length_wear>},
    {2401, 2600, tool_part<diameter>, set_tool_part<diameter>, Stored::as_size},
    {2601, 2800, tool_part<diameter_wear>, set_tool_part<diameter_wear>, Stored::as_size},
    {3026, 3026, tool_in_spindle, nullptr},
    {3027, 3027, spindle_speed, nullptr},
    {5041, 5049, block_end, nullptr}, // the tip: without the tool offset
    // Haas mill operator's manual 96-8000, system variables: G52 work offset.
    {5201, 5206, local_offset, set_local_offset_of},
    {8553, 8553, named_tool_part<length>, nullptr},
    {8554, 8554, named_tool_part<length_wear>, nullptr},
    {8555, 8555, named_tool_part<diameter>, nullptr, Stored::as_size},
    {8556, 8556, named_tool_part<diameter_wear>, nullptr, Stored::as_size},
    {14001, 15980, extended_offset, set_extended_offset},
};

const Range* range_of(std::span<const Range> ranges, int number) {
    for (const Range& range : ranges)
        if (number >= range.first && number <= range.last) return &range;
    return nullptr;
}

const Range* range_of(const Environment& environment, int number) {
    if (number < 2001) return nullptr;
    if (const Range* common = range_of(common_ranges, number)) return common;
    const bool haas = dialect(environment.dialect).system_parameters == SystemParameters::haas;
    return haas ? range_of(haas_ranges, number) : range_of(fanuc_ranges, number);
}

/// Variables stored as written, initially 0: inputs and outputs, timers, switches, counters.
bool is_zero_at_first(int number) {
    return (number >= 1000 && number <= 1135) || (number >= 3001 && number <= 3010)
           || number == 3901 || number == 3902;
}

bool enters_radii(const InterpreterState& state, const Environment& environment) {
    constexpr ControlQuestion question = ControlQuestion::radii_are_entered;
    return !find_parameter(question, environment.dialect)
           || current_number(state, environment, question) != 0.0;
}

/// Sets a value or wear of H that the same number also has under D, by the type of the memory.
void set_shared_offset(InterpreterState& state, const Environment& environment, const Range& range,
                       int index, double value, uint32_t line) {
    const auto memory = static_cast<OffsetMemory>(
        number_for(state, environment, ControlQuestion::offset_memory, line));
    const bool is_wear = range.stored == Stored::as_wear;
    if (is_wear && memory == OffsetMemory::one_value) {
        set_tool_part<length_wear>(state, index, 0.0);
        set_tool_part<diameter_wear>(state, index, 0.0);
        set_tool_part<diameter>(state, index, size_factor(state, environment, line) * value);
        set_tool_part<length>(state, index, value);
        return;
    }
    range.write(state, index, value);
    if (memory == OffsetMemory::separate) return;
    const double size = size_factor(state, environment, line) * value;
    if (is_wear)
        set_tool_part<diameter_wear>(state, index, size);
    else
        set_tool_part<diameter>(state, index, size);
}

} // namespace

double size_factor(InterpreterState& state, const Environment& environment, uint32_t line) {
    constexpr ControlQuestion question = ControlQuestion::radii_are_entered;
    const bool is_radius = !find_parameter(question, environment.dialect)
                           || answer_to(state, environment, question, line);
    return is_radius ? 2.0 : 1.0;
}

bool is_size_of_tool(const Environment& environment, int number) {
    const Range* range = range_of(environment, number);
    return range && range->stored == Stored::as_size;
}

std::optional<Value> fanuc_parameter(const InterpreterState& state, const Environment& environment,
                                     int number) {
    if (number < 1000) return std::nullopt;
    if (const Range* range = range_of(environment, number)) {
        // As set by the program or stated, whatever the type of the memory.
        if (range->stored == Stored::as_wear)
            if (const Value set = state.parameters->numbered(number)) return set;
        Value value = range->read(state, number - range->first);
        if (range->stored == Stored::as_size && value && enters_radii(state, environment))
            *value /= 2.0;
        return value;
    }
    if (is_zero_at_first(number)) return Value(state.parameters->numbered(number).value_or(0.0));
    // The position at which the last G31 made contact; if there was none, the current position.
    if (number >= 5061 && number <= 5069 && !state.parameters->numbered(number))
        return work_position(state, number - 5061);
    return std::nullopt;
}

core::Result<bool> set_fanuc_parameter(InterpreterState& state, const Environment& environment,
                                       int number, Value value, core::SourceSpan where) {
    const Range* range = range_of(environment, number);
    if (!range) return false;
    if (!range->write)
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("#{} is read-only and cannot be set", number), where);
    const int index = number - range->first;
    double set = value.value_or(0.0);
    const Offsets before = state.modal.offsets;
    switch (range->stored) {
    case Stored::as_size:
        range->write(state, index, size_factor(state, environment, where.line) * set);
        break;
    case Stored::as_wear:
        state.parameters.write().set_numbered(number, set);
        [[fallthrough]];
    case Stored::as_length:
        set_shared_offset(state, environment, *range, index, set, where.line);
        if (state.modal.offsets.tool != before.tool
            && !answer_to(state, environment, ControlQuestion::length_is_reloaded, where.line))
            change_offsets(state.modal, before);
        break;
    case Stored::always_so:
        range->write(state, index, set);
    }
    return true;
}

void forget_offset_as_set(InterpreterState& state, int number) {
    for (const int first : {2000, 10000})
        if (state.parameters->numbered(first + number))
            state.parameters.write().set_numbered(first + number, {});
}

bool is_modelled_variable(const Environment& environment, int number) {
    const bool is_haas = dialect(environment.dialect).system_parameters == SystemParameters::haas;
    return range_of(environment, number) || is_zero_at_first(number)
           || (is_haas && number == tool_of_8000s);
}

bool sets_fanuc_offset(const Environment& environment, int number) {
    const Range* range = range_of(environment, number);
    return range && range->write;
}

bool is_of_clock(double number) {
    return number == milliseconds_timer || number == hours_timer || number == date
           || number == time_of_day;
}

void advance_timers(InterpreterState& state) {
    for (const auto& [timer, units] :
         {std::pair{milliseconds_timer, 1000.0}, {hours_timer, 1.0 / 3600.0}})
        if (const Value value = state.parameters->numbered(timer))
            state.parameters.write().set_numbered(timer, *value + units * seconds_of_block);
}

} // namespace gcode
