#include <algorithm>
#include <charconv>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/following.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"
#include "gcode/language/lexer.h"

namespace gcode {
namespace {

using core::ErrorCode;
using core::OffsetNumber;
using core::ToolNumber;

/// Whether nobody stated the length under an offset number.
bool is_guess(const Execution& execution, std::optional<OffsetNumber> number) {
    if (!number || value_of(*number) == 0) return false;
    if (execution.state.tables->lengths.contains(*number)) return false;
    const ToolNumber tool{value_of(*number)};
    return !execution.environment.tool_lengths.contains(tool)
           || execution.environment.guessed_lengths.contains(tool);
}

/// Whether a change of the length offset moves an axis in this block although the block does not
/// say where to.
///
/// Source: Fanuc B-63943EN-1, 12.5.2: with TOS = 1 a block without a move command does not move.
bool moves_by_change(Execution& execution, const AxisValues& offset, bool is_by_guess) {
    const ModalState& modal = execution.modal();
    const bool are_positions =
        modal.distance == DistanceMode::absolute || in_machine_coordinates(execution);
    const auto is_left_out = [&](size_t axis) {
        const bool is_said = execution.statement.word(axis_letters[axis]) && are_positions;
        const bool changes = offset[axis] != modal.offsets.tool[axis] || (axis == 2 && is_by_guess);
        return changes && !is_said && modal.position[axis];
    };
    if (!is_left_out(0) && !is_left_out(1) && !is_left_out(2)) return false;
    return answer_to(execution.state, execution.environment, ControlQuestion::length_change_moves,
                     execution.block.line);
}

/// A move in Z by a length that nobody stated: it can end anywhere.
void lose_height(Execution& execution) {
    execution.modal().position[2].reset();
    execution.result.warnings.push_back(
        {Severity::warning,
         {execution.block.line, execution.column, 0},
         "Z moves by the tool length, which is not stated: where it goes is not known",
         core::rule_id("undecided"),
         "State touched_off, or the holder and the stick-out, of each tool in the set-up."});
}

/// While kinematics of LinuxCNC follow the tip, another length makes the linear axes jump, unless
/// the rotary ones are at 0.
void lose_place_of_tip(Execution& execution, const AxisValues& offset) {
    const ModalState& modal = execution.modal();
    if (offset == modal.offsets.tool || !is_work_turned(modal)) return;
    lose_positions(execution, {execution.block.line, execution.column, 0},
                   "the tool length changes while the control follows the tip and a rotary axis is "
                   "away from 0: the linear axes jump. This block and later ones are not checked "
                   "until the positions are certain again",
                   "Change the length with the rotary axes at 0, or after M429.");
}

void use_offset(Execution& execution, std::optional<OffsetNumber> number, const AxisValues& offset,
                bool follows_tip = false) {
    ModalState& modal = execution.modal();
    Offsets offsets = modal.offsets;
    offsets.tool = offset;
    follows_tip |= offsets.has_world;
    offsets.follows_tip = follows_tip;
    if (offsets.has_world) lose_place_of_tip(execution, offset);
    const bool is_by_guess =
        number != modal.length_number
        && (is_guess(execution, number) || is_guess(execution, modal.length_number));
    const bool moves = moves_by_change(execution, offset, is_by_guess);
    const Position position = modal.position;
    const AxisValues old = modal.offsets.tool;
    change_offsets(execution, offsets);
    modal.length_number = number;
    execution.emit(UseToolLengthOffset{number, offset, follows_tip,
                                       lacks_length(*execution.state.tables, number)});
    if (!moves) return;
    // The programmed position stays, so the machine moves: with the axes of this block, or alone.
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (offset[axis] != old[axis]) modal.position[axis] = position[axis];
    if (is_by_guess) return lose_height(execution);
    if (execution.statement.has_axis_word()) return;
    if (modal.motion == MotionCode::straight && modal.feed)
        execution.feed(modal.position, *modal.feed);
    else
        execution.traverse(modal.position);
}

/// The axis along which the length of G43 and G44 acts. The parameters for it matter only where
/// another axis than Z comes into question.
///
/// Source: Fanuc B-63943EN-1, 12.5.2: types A (Z), B (normal to the plane), C (as programmed).
size_t length_axis(Execution& execution) {
    constexpr size_t z = 2;
    const auto asks = [&](ControlQuestion question) {
        return answer_to(execution.state, execution.environment, question, execution.block.line);
    };
    const bool has_x = execution.statement.word('X'), has_y = execution.statement.word('Y');
    const bool names_other = has_x != has_y && !execution.statement.word('Z');
    if (names_other && asks(ControlQuestion::length_follows_axis)) return has_x ? 0 : 1;
    const size_t normal = axes_of(execution.modal().plane).normal;
    if (normal < z && asks(ControlQuestion::length_follows_plane)) return normal;
    return z;
}

/// The tool offset with a number: `length` along an axis, usually Z, the table's values along the
/// others.
AxisValues offset_under(const Execution& execution, int number, double length, size_t along = 2) {
    AxisValues offset{};
    const auto& lengths = execution.state.tables->lengths;
    if (const auto entry = lengths.find(OffsetNumber(number)); entry != lengths.end())
        offset = entry->second.shift;
    offset[along] = length;
    return offset;
}

/// The offset number of G43: its H word, else as defined by the dialect.
core::Result<std::optional<int>> length_number(const Execution& execution) {
    if (const Word* word = execution.statement.word('H')) {
        FEELER_TRY(const int number, whole_number(*word));
        if (number != 0 || !execution.dialect.bare_h0_is_tool) return number;
    }
    const ModalState& modal = execution.modal();
    if (execution.dialect.bare_length_offset_is_tool)
        return modal.tool ? std::optional(value_of(*modal.tool)) : std::nullopt;
    return modal.length_number ? std::optional(value_of(*modal.length_number)) : std::nullopt;
}

core::Result<void> use_table_length(Execution& execution, const Word& word, double sign,
                                    bool follows_tip = false) {
    FEELER_TRY(const std::optional<int> number, length_number(execution));
    execution.modal().length_sign = sign;
    const core::SourceSpan where = word.span;
    if (!number) {
        execution.warn(where, fmt::format("{} has no H word, and {}: no length offset is applied",
                                          written(word),
                                          execution.dialect.bare_length_offset_is_tool
                                              ? "no tool is in the spindle to take it from"
                                              : "no length offset is active whose H would stay"));
        use_offset(execution, std::nullopt, {}, follows_tip);
        return {};
    }
    const std::optional<double> length =
        *number == 0 ? std::optional(0.0) : length_under(*execution.state.tables, *number);
    if (!length)
        execution.warn(where, fmt::format("{}: length offset H{} is unknown and assumed to be 0",
                                          written(word), *number));
    const size_t along = follows_tip ? 2 : length_axis(execution);
    use_offset(execution, OffsetNumber(*number),
               offset_under(execution, *number, sign * length.value_or(0.0), along), follows_tip);
    const auto& tool = execution.modal().tool;
    if (tool && *number != 0 && *number != value_of(*tool))
        execution.result.warnings.push_back(
            {Severity::warning, where,
             fmt::format("{}: H{} is not the offset of T{}, the tool in the spindle", written(word),
                         *number, value_of(*tool)),
             core::rule_id("offset-not-tool"), fmt::format("Use H{}.", value_of(*tool))});
    return {};
}

/// G43.1: the offset is given in the block.
core::Result<void> use_given_offset(Execution& execution) {
    AxisValues offset = execution.modal().offsets.tool;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]))
            offset[axis] = axis_value(execution, axis, *word);
    use_offset(execution, std::nullopt, offset);
    return {};
}

/// G43.2: adds another offset, from the table or the block, to the active one.
core::Result<void> add_table_offset(Execution& execution, const Word& word) {
    AxisValues sum = execution.modal().offsets.tool;
    const Word* number = execution.statement.word('H');
    AxisValues more{};
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* value = execution.statement.word(axis_letters[axis]))
            more[axis] = axis_value(execution, axis, *value);
    if (number) {
        FEELER_TRY(const int entry, whole_number(*number));
        const std::optional<double> length = length_under(*execution.state.tables, entry);
        if (!length)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("{}: length offset H{} is unknown", written(word), entry),
                              number->span);
        more = offset_under(execution, entry, *length);
    } else if (!execution.statement.has_axis_word()) {
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{} needs an H word, or axis words with the offset", written(word)),
            word.span);
    }
    for (size_t axis = 0; axis < axis_count; ++axis) sum[axis] += more[axis];
    use_offset(execution, execution.modal().length_number, sum);
    return {};
}

/// G43.4, G43.5 and G234 of Haas: the control keeps the tip on the programmed path relative to the
/// work.
core::Result<void> use_tool_centre_control(Execution& execution, const CodeWord& entry) {
    if (auto checked = check_dynamic_offset_is_off(execution, entry); !checked) return checked;
    ProgramTransforms transforms = execution.modal().transforms;
    transforms.follows_vectors = entry.code->number == g_code(43, 5);
    use_transforms(execution, transforms);
    if (!execution.modal().offsets.machine)
        execution.warn(entry.word->span,
                       fmt::format("{}: treated as G43: without a machine in the set-up, rotary "
                                   "axes are followed in program coordinates",
                                   written(*entry.word)),
                       Severity::note);
    return use_table_length(execution, *entry.word, +1.0, true);
}

/// Ends G43.5: with a plain length offset or none, moves no longer specify the tool direction.
void leave_vectors(Execution& execution) {
    if (!execution.modal().transforms.follows_vectors) return;
    ProgramTransforms transforms = execution.modal().transforms;
    transforms.follows_vectors = false;
    use_transforms(execution, transforms);
}

} // namespace

void reload_length(Execution& execution) {
    const ModalState& modal = execution.modal();
    const int number = value_of(*modal.length_number);
    const double length = length_under(*execution.state.tables, number).value_or(0.0);
    Offsets offsets = modal.offsets;
    // The axis along which the length acts stays.
    size_t along = 2;
    for (const size_t axis : {size_t{0}, size_t{1}})
        if (offsets.tool[axis] != 0.0 && offsets.tool[2] == 0.0) along = axis;
    offsets.tool = offset_under(execution, number, modal.length_sign * length, along);
    change_offsets(execution, offsets);
    execution.emit(UseToolLengthOffset{modal.length_number, offsets.tool, offsets.follows_tip,
                                       lacks_length(*execution.state.tables, modal.length_number)});
}

bool changes_length_alone(const Execution& execution) {
    const auto uses = [](const CodeWord& entry) { return entry.code->uses('H'); };
    const std::span<const CodeWord> codes = execution.statement.codes();
    return execution.dialect.lone_h_is_length_offset && execution.modal().length_sign != 0.0
           && execution.statement.word('H') && !execution.statement.of(ModalGroup::tool_length)
           && std::none_of(codes.begin(), codes.end(), uses);
}

namespace {

/// The tools of the set-up with this name; if there is none, those whose name differs in case only.
std::vector<ToolNumber> tools_named(const Environment& environment, std::string_view name) {
    std::vector<ToolNumber> exact, similar;
    const auto same_letter = [](char a, char b) { return upper(a) == upper(b); };
    for (const auto& [known, number] : environment.tool_names) {
        if (known.empty()) continue;
        if (known == name) exact.push_back(number);
        if (std::ranges::equal(known, name, same_letter)) similar.push_back(number);
    }
    return exact.empty() ? similar : exact;
}

/// A number that no tool of the set-up has, and none whose name it lacks.
ToolNumber free_tool_number(const Environment& environment, const std::vector<NamedTool>& named) {
    std::set<ToolNumber> taken;
    for (const auto& [name, number] : environment.tool_names) taken.insert(number);
    for (const NamedTool& tool : named) taken.insert(tool.number);
    int number = 1;
    while (taken.contains(ToolNumber(number))) ++number;
    return ToolNumber(number);
}

std::string list_of(const std::vector<ToolNumber>& numbers) {
    std::string list;
    for (const ToolNumber number : numbers)
        list += fmt::format("{}{}", list.empty() ? "" : " or ", value_of(number));
    return list;
}

} // namespace

ToolNumber tool_of_name(Execution& execution, std::string_view name, core::SourceSpan where) {
    const Environment& environment = execution.environment;
    const std::vector<ToolNumber> found = tools_named(environment, name);
    if (found.size() > 1) {
        execution.modal().doubt |= tool_is_in_doubt;
        execution.result.warnings.push_back(
            {Severity::warning, where,
             fmt::format("\"{}\" is the name of tool {}: which of them the control takes is not "
                         "known; tool {} is checked here",
                         name, list_of(found), value_of(found[0])),
             core::rule_id("undecided"),
             "Check the program with each of these tools alone under this name."});
    }
    if (!found.empty()) return found[0];
    int number = 0;
    const char* end = name.data() + name.size();
    const auto read = std::from_chars(name.data(), end, number);
    if (read.ec == std::errc() && read.ptr == end && number >= 0) return ToolNumber(number);
    std::vector<NamedTool>& named = execution.state.named_tools;
    const auto known = std::find_if(named.begin(), named.end(),
                                    [&](const NamedTool& tool) { return tool.name == name; });
    if (known != named.end()) return known->number;
    const ToolNumber chosen = free_tool_number(environment, named);
    named.push_back({std::string(name), chosen});
    const bool has_tools = !environment.tool_names.empty();
    execution.warn(where,
                   fmt::format("\"{}\" is tool {} here: {}", name, value_of(chosen),
                               has_tools ? "the set-up has no tool of this name"
                                         : "tool names are numbered in order of appearance"),
                   has_tools ? Severity::warning : Severity::note);
    return chosen;
}

namespace {

/// Whether M6 takes the tool of an earlier T, and T of its own block is for the next M6. The
/// builder of the machine decides it; it matters only where another tool waits.
bool takes_waiting_tool(Execution& execution, ToolNumber called) {
    const ModalState& modal = execution.modal();
    const CodeWord* change = execution.statement.of(ModalGroup::tool_change);
    if (!change || change->code->number != m_code(6) || !modal.selected_tool
        || modal.selected_tool == modal.tool || modal.selected_tool == called)
        return false;
    return answer_to(execution.state, execution.environment, ControlQuestion::change_takes_waiting,
                     execution.block.line);
}

/// Selects the tool that T of a block with M6 calls for the next M6, if it was not selected before.
core::Result<void> select_waiting(Execution& execution) {
    const Word* word = execution.statement.word('T');
    if (!word) return {};
    FEELER_TRY(const int number, whole_number(*word));
    if (execution.modal().selected_tool == ToolNumber(number)) return {};
    execution.modal().selected_tool = ToolNumber(number);
    execution.emit(SelectTool{ToolNumber(number)});
    return {};
}

} // namespace

core::Result<void> select_tool(Execution& execution) {
    const Word* word = execution.statement.word('T');
    if (!word) return {};
    FEELER_TRY(const int number, whole_number(*word));
    if (takes_waiting_tool(execution, ToolNumber(number))) return {};
    const auto& table = execution.state.tables->lengths;
    if (execution.dialect.tool_entries_by_axes && number != 0 && !table.empty()
        && !length_under(*execution.state.tables, number))
        execution.warn(word->span, fmt::format("{}: this tool is not in the tool table: a control "
                                               "with this table stops here",
                                               written(*word)));
    execution.modal().selected_tool = ToolNumber(number);
    execution.emit(SelectTool{ToolNumber(number)});
    return {};
}

core::Result<void> change_tool(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_change);
    if (!entry) return {};
    ModalState& modal = execution.modal();
    execution.column = entry->word->span.column;
    if (entry->code->number == m_code(61)) return name_tool(execution);
    if (!modal.selected_tool)
        return core::fail(ErrorCode::missing_value,
                          "M6 has no tool to change to: no T word has been programmed yet",
                          entry->word->span);
    const bool exchanges = modal.tool && modal.tool != modal.selected_tool;
    modal.tool = modal.selected_tool;
    // RS274/NGC 3.6.3: the spindle is stopped when the tool change is complete.
    if (modal.spindle != core::SpindleDirection::stopped
        && !execution.environment.tool_change.keeps_spindle_running) {
        modal.spindle = core::SpindleDirection::stopped;
        execution.emit(Spindle{modal.spindle, 0.0});
    }
    if (!execution.environment.tool_change.is_stated)
        answer_to(execution.state, execution.environment, ControlQuestion::change_moves,
                  execution.block.line);
    // Haas mill operator's manual 96-8000, M06: Z goes to machine zero first and stays there. With
    // the called tool in the spindle already, the control need not move.
    move_to_tool_change(execution, exchanges);
    const bool empty = *modal.tool == ToolNumber(0);
    execution.emit(ChangeTool{empty ? std::nullopt : modal.tool});
    return select_waiting(execution);
}

core::Result<void> set_tool_length(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_length);
    ModalState& modal = execution.modal();
    if (!entry && changes_length_alone(execution))
        return use_table_length(execution, *execution.statement.word('H'), modal.length_sign,
                                modal.offsets.follows_tip);
    if (!entry) return {};
    leave_vectors(execution);
    switch (entry->code->number) {
    case g_code(43):
        return use_table_length(execution, *entry->word, +1.0);
    case g_code(44):
        return use_table_length(execution, *entry->word, -1.0);
    case g_code(43, 2):
        return add_table_offset(execution, *entry->word);
    case g_code(43, 4):
    case g_code(43, 5):
    case g_code(234):
        return use_tool_centre_control(execution, *entry);
    case g_code(43, 1):
        modal.length_sign = 0.0;
        return use_given_offset(execution);
    default: // G49
        cancel_length_offset(execution);
        if (entry->code->uses_axes() && execution.statement.has_axis_word())
            execution.warn(entry->word->span,
                           fmt::format("{} takes the axis words of this block, and nothing moves",
                                       written(*entry->word)));
        return {};
    }
}

void cancel_length_offset(Execution& execution) {
    execution.modal().length_sign = 0.0;
    use_offset(execution, std::nullopt, {});
}

// Fanuc B-63844EN, 14.1.2: G53, G28 and G30 cancel the offset along the axes that they move, and
// the code on display stays G43. With parameter 5001#6 (EVO) = 1 the next block restores it;
// otherwise the next G43, G44 or H does. If it is not stated, the question is asked only where the
// program goes on to a Z without one of these.
void leave_length_behind(Execution& execution, const std::array<bool, axis_count>& moved) {
    ModalState& modal = execution.modal();
    constexpr ControlQuestion restores = ControlQuestion::length_is_reloaded;
    const ControlSettings& control = execution.environment.control;
    if (modal.length_sign == 0.0 || !find_parameter(restores, execution.environment.dialect))
        return;
    if (control.answer(restores).value_or(!control.reports_premises)) return;
    const auto leaves = [&](size_t axis) {
        const bool is_offset = modal.offsets.tool[axis] != 0.0
                               || (axis == 2 && is_guess(execution, modal.length_number));
        return moved[axis] && is_offset;
    };
    if (!leaves(0) && !leaves(1) && !leaves(2)) return;
    Offsets offsets = modal.offsets;
    offsets.tool = {};
    change_offsets(execution, offsets); // moves nothing, unlike G49
    if (!control.answer(restores)) modal.length_left = modal.length_number;
    modal.length_number.reset();
    execution.emit(UseToolLengthOffset{std::nullopt, {}, offsets.follows_tip});
    execution.state.rules.length_cancelled = modal.tool.has_value();
}

namespace {

/// Whether the length offset that a move to machine coordinates cancelled counts again in this
/// block. The same parameter decides when a length counts that G10 writes, of which its own words
/// speak.
bool length_returns(Execution& execution) {
    constexpr ControlQuestion question = ControlQuestion::length_is_reloaded;
    InterpreterState& state = execution.state;
    const bool is_new = is_open(state, execution.environment, question);
    const bool returns = answer_to(state, execution.environment, question, execution.block.line);
    if (!is_new) return returns;
    constexpr std::string_view effects[] = {
        "the length offset that G28, G30 or G53 cancelled counts from the next G43, G44 or H",
        "the length offset that G28, G30 or G53 cancelled counts from the next block"};
    std::vector<Reading>& readings = state.readings.write().met.back().readings;
    for (size_t i = 0; i < std::min(readings.size(), std::size(effects)); ++i)
        readings[i].effect = effects[i];
    return returns;
}

} // namespace

core::Result<void> take_length_up(Execution& execution) {
    ModalState& modal = execution.modal();
    const bool is_new =
        execution.statement.of(ModalGroup::tool_length) || execution.statement.word('H');
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const bool goes_home =
        action && (action->code->number == g_code(28) || action->code->number == g_code(30));
    const bool is_in_work =
        execution.statement.word('Z') && !in_machine_coordinates(execution) && !goes_home;
    if (!is_new && !is_in_work) return {};
    const auto number = std::exchange(modal.length_left, std::nullopt);
    if (is_new || !length_returns(execution)) return {};
    modal.length_number = number;
    reload_length(execution);
    execution.state.rules.length_cancelled = false;
    return {};
}

namespace {

core::Result<int> tool_of_entry(const Execution& execution) {
    const Word* word = execution.statement.word('P');
    if (!word)
        return core::fail(ErrorCode::missing_value, "G10 needs a P word, the number of the tool",
                          execution.statement.of(ModalGroup::action)->word->span);
    return whole_number(*word, 1, 99999);
}

core::Result<void> need_a_value(const Execution& execution) {
    const Statement& statement = execution.statement;
    for (const char letter : {'R', 'I', 'J', 'Q'})
        if (statement.word(letter)) return {};
    if (statement.has_axis_word()) return {};
    return core::fail(ErrorCode::missing_value,
                      "G10 has no value for the tool table: it needs an axis word, R, I, J or Q",
                      statement.of(ModalGroup::action)->word->span);
}

/// Reads the radius, the angles and the orientation of a turning tool, for L1, L10 and L11.
core::Result<void> take_shape(const Execution& execution, LengthOffset& entry) {
    const Statement& statement = execution.statement;
    if (const Word* word = statement.word('R')) entry.diameter = 2.0 * length_of(execution, *word);
    if (const Word* word = statement.word('I')) entry.front_deg = word->value;
    if (const Word* word = statement.word('J')) entry.back_deg = word->value;
    if (const Word* word = statement.word('Q')) {
        FEELER_TRY(entry.orientation, whole_number(*word, 0, 9));
    }
    return {};
}

/// The offsets for which L10 and L11 compare the position: the active ones, or those of G59.3.
Offsets reading_offsets(const Execution& execution, bool in_last_offset) {
    Offsets offsets = execution.modal().offsets;
    offsets.tool = {};
    if (in_last_offset) offsets.axis = zero_position;
    if (in_last_offset) offsets.work = work_offset(*execution.state.tables, plain_offset_count - 1);
    return offsets;
}

/// The tool offset of an entry, as a position.
Position shift_of(const LengthOffset& entry) {
    Position shift;
    for (size_t axis = 0; axis < axis_count; ++axis)
        shift[axis] = axis == 2 ? entry.length : entry.shift[axis];
    return shift;
}

/// Sets the tool offsets for which the current position has the given coordinates. Rotated axes
/// that are not named keep their offsets in rotated coordinates.
core::Result<void> take_offsets_here(const Execution& execution, bool in_last_offset,
                                     LengthOffset& entry) {
    const ModalState& modal = execution.modal();
    const Position machine = machine_from_program(counted_offsets(modal.offsets), modal.position);
    const Offsets offsets = counted_offsets(reading_offsets(execution, in_last_offset));
    Offsets only_turned;
    only_turned.work.rotation_deg = offsets.work.rotation_deg;
    const Position read = program_from_machine(offsets, machine);
    Position off = program_from_machine(only_turned, shift_of(entry));
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word) continue;
        if (!read[axis])
            return core::fail(
                ErrorCode::missing_value,
                fmt::format("{}: this needs a known position, and the {} position is unknown",
                            written(*word), axis_letters[axis]),
                word->span);
        off[axis] = *read[axis] - axis_value(execution, axis, *word);
    }
    const Position shift = machine_from_program(only_turned, off);
    for (size_t axis = 0; axis < axis_count; ++axis)
        (axis == 2 ? entry.length : entry.shift[axis]) = *shift[axis];
    return {};
}

} // namespace

core::Result<void> write_tool_entry(Execution& execution, int kind) {
    FEELER_TRY(const int tool, tool_of_entry(execution));
    if (auto checked = need_a_value(execution); !checked) return checked;
    std::map<OffsetNumber, LengthOffset>& lengths = execution.state.tables.write().lengths;
    LengthOffset entry;
    if (const auto known = lengths.find(OffsetNumber(tool)); known != lengths.end())
        entry = known->second;
    else if (const auto length = length_under(*execution.state.tables, tool))
        entry.length = *length;
    if (auto taken = take_shape(execution, entry); !taken) return taken;
    if (kind == 1) {
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (const Word* word = execution.statement.word(axis_letters[axis]))
                (axis == 2 ? entry.length : entry.shift[axis]) = axis_value(execution, axis, *word);
    } else if (auto taken = take_offsets_here(execution, kind == 11, entry); !taken) {
        return taken;
    }
    lengths[OffsetNumber(tool)] = entry;
    return {};
}

core::Result<void> name_tool(Execution& execution) {
    const Word* word = execution.statement.word('Q');
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          "M61 needs a Q word, the number of the tool in the spindle",
                          execution.statement.of(ModalGroup::tool_change)->word->span);
    FEELER_TRY(const int tool, whole_number(*word));
    // emccanon.cc of LinuxCNC 2.9: CHANGE_TOOL_NUMBER empties the list of feeds that are still to
    // be joined, where other commands make them first.
    if (execution.modal().holds_feed)
        return core::fail(ErrorCode::unsupported,
                          "LinuxCNC leaves out the straight feed before this M61; program G4 P0 "
                          "between them",
                          execution.statement.of(ModalGroup::tool_change)->word->span);
    const std::optional<core::ToolNumber> before = execution.modal().tool;
    if (before && *before != ToolNumber(tool))
        execution.warn(
            word->span,
            fmt::format("M61 changes no tool: tool {} stays in the spindle unless somebody "
                        "changes it by hand. From here on the program is checked with "
                        "tool {}",
                        core::value_of(*before), tool));
    execution.modal().tool = ToolNumber(tool);
    execution.emit(NameTool{tool == 0 ? std::nullopt : std::optional(ToolNumber(tool))});
    return {};
}

} // namespace gcode
