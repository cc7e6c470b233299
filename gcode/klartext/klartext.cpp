#include "gcode/klartext/klartext.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/exec/following.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/loop_detector.h"
#include "gcode/exec/state_digest.h"
#include "gcode/klartext/klartext_parser.h"
#include "gcode/language/error_rules.h"
#include "gcode/language/language.h"

namespace gcode {
namespace {

using core::ErrorCode;
using enum CommandKind;

/// Whether the block has a code of a group that takes effect at the start of the block.
bool begins_block(const Execution& execution, ModalGroup group, CodeNumber last) {
    const CodeWord* entry = execution.statement.of(group);
    return entry && entry->code->number != last;
}

bool ends_block(const Execution& execution, ModalGroup group, CodeNumber last) {
    const CodeWord* entry = execution.statement.of(group);
    return entry && entry->code->number == last;
}

/// The M128 or M129 of the block; FUNCTION TCPM and FUNCTION RESET TCPM are read as these. Null if
/// there is none.
const CodeWord* tip_control(const Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes())
        if (entry.code->number == m_code(128) || entry.code->number == m_code(129)) return &entry;
    return nullptr;
}

/// Switches tool centre point control. Where it cannot be followed, its blocks are undecided.
///
/// Source: HEIDENHAIN iTNC 530, user's manual, M128: the tip stays relative to the work, and the
///         coordinates turn with a tilting table. M128 acts at the start of its block, M129 at the
///         end. TNC 640, FUNCTION TCPM: AXIS POS and PATHCTRL AXIS do the same; with PATHCTRL
///         VECTOR the tool turns in the plane of its directions at the ends of a block.
void use_tip_control(Execution& execution, const CodeWord& entry) {
    const bool on = entry.code->number == m_code(128);
    const bool was_followed = execution.modal().offsets.follows_tip;
    const bool by_angles = on && klartext_of(execution.block).by_space_angles;
    if (klartext_of(execution.state).by_space_angles != by_angles)
        writable_klartext(execution.state).by_space_angles = by_angles;
    const bool is_followed = on ? !klartext_of(execution.block).turns_otherwise : was_followed;
    if (on && !is_followed && was_followed) switch_tip_control(execution, false);
    if (is_followed && switch_tip_control(execution, on)) {
        execution.modal().turns_in_plane = on && klartext_of(execution.block).turns_in_plane;
        return;
    }
    const core::SourceSpan where = entry.word->span;
    std::string_view code = execution.block.text.substr(where.column - 1, where.length);
    if (code.starts_with("FUNCTION")) code = on ? "FUNCTION TCPM" : "FUNCTION RESET TCPM";
    switch_following(execution, where, code, on ? FollowingSwitch::on : FollowingSwitch::off);
}

/// What tool centre point control does to a move with M91 is not known: the maker says to switch it
/// off before.
void check_machine_move(Execution& execution, core::SourceSpan where) {
    const ModalState& modal = execution.modal();
    if (!in_machine_coordinates(execution) || !modal.offsets.follows_tip || !is_work_turned(modal))
        return;
    lose_positions(
        execution, where,
        "M91 while M128 is on and a rotary axis is away from 0: how the axes move is not "
        "known. This block and later ones are not checked until X, Y and Z have been "
        "programmed again",
        "Program M129 before it.");
}

/// Checks the vectors of LN.
///
/// Source: HEIDENHAIN TNC 640, user's manual Klartext programming, "Three-dimensional tool
///         compensation": deltas of length and radius shift the tool along the normal.
core::Result<void> check_vectors(Execution& execution) {
    if (!klartext_of(execution.block).has_normal) return {};
    ModalState& modal = execution.modal();
    if (vector_words(execution.block, normal_letters) && klartext_of(execution.state).has_deltas)
        return refuse_statement(execution,
                                "the compensation of DL, DR and DR2 of TOOL CALL along the "
                                "normal is not supported yet: call the tool without them");
    const auto tool = tool_direction(execution);
    if (!tool && vector_words(execution.block, direction_letters))
        execution.warn(klartext_of(execution.block).span,
                       "TX, TY and TZ are ignored, because neither M128 nor FUNCTION TCPM is on");
    if (!tool) return {};
    if (!modal.offsets.machine) point_undescribed(modal, *tool);
    return {};
}

bool is_motion(CommandKind kind) {
    switch (kind) {
    case straight:
    case straight_polar:
    case arc:
    case arc_polar:
    case arc_of_radius:
    case tangent_arc:
    case tangent_polar:
        return true;
    default:
        return false;
    }
}

/// AXIS SPAT: the direction of the tool from the angles in space of the block.
///
/// Source: HEIDENHAIN TNC 640, user's manual Klartext programming, FUNCTION TCPM: with AXIS SPAT,
///         all three angles must be programmed. As SPA, SPB and SPC of PLANE SPATIAL.
core::Result<void> take_space_angles(Execution& execution) {
    const CommandKind kind = klartext_of(execution.block).kind;
    if (!klartext_of(execution.state).by_space_angles || !is_motion(kind)) return {};
    core::Vec3 angles(0.0);
    const Word* first = nullptr;
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        const Word* word = execution.statement.word("ABC"[i]);
        if (!word) continue;
        if (is_incremental(execution, *word))
            return refuse_statement(execution,
                                    "incremental angles under AXIS SPAT are not supported "
                                    "yet: program A, B and C as absolute angles");
        if (!first) first = word;
        angles[i] = word->value;
        ++count;
    }
    if (!first) return {};
    if (count != 3)
        return refuse_statement(execution, "under AXIS SPAT the direction of the tool needs all "
                                           "three of A, B and C");
    if (kind != straight)
        return refuse_statement(execution, "turning the tool under AXIS SPAT is only supported "
                                           "with L");
    if (glm::determinant(execution.modal().offsets.frame.linear) < 0.0)
        return refuse_statement(execution, "angles under AXIS SPAT while a mirror image is on are "
                                           "not supported yet: program LN with TX, TY and TZ");
    if (in_machine_coordinates(execution))
        return refuse_statement(execution, "M91 with angles under AXIS SPAT is not supported: "
                                           "program M129 before it");
    execution.tool_by_angles = ToolDirection{spatial_rotation(angles)[2], first};
    ModalState& modal = execution.modal();
    if (!modal.offsets.follows_tip || !modal.offsets.machine)
        point_undescribed(modal, *execution.tool_by_angles);
    return {};
}

/// M118 lets the operator shift the axes with the handwheel; M101 lets the control change to a
/// replacement tool.
void note_what_may_intervene(Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes()) {
        if (entry.code->number == m_code(118))
            execution.warn(entry.word->span,
                           "M118: shifts by the handwheel during the program are not checked");
        if (entry.code->number == m_code(101))
            execution.warn(entry.word->span,
                           "M101: changes to a replacement tool when the time of a tool is over "
                           "are not checked",
                           Severity::note);
    }
}

/// M126 and M127: rotary axes take the short way. M94: reduces their positions to less than a turn.
core::Result<void> turn_rotary_axes(Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes()) {
        const CodeNumber code = entry.code->number;
        const bool on = code == m_code(126);
        if ((on || code == m_code(127)) && klartext_of(execution.state).turns_short_way != on)
            writable_klartext(execution.state).turns_short_way = on;
        if (code != m_code(94)) continue;
        for (size_t axis = 3; axis < 6; ++axis) {
            const double angle = execution.modal().position[axis].value_or(0.0);
            if (angle < 0.0 || angle >= 360.0)
                return core::fail(
                    ErrorCode::unsupported,
                    fmt::format("M94 is not supported while axis {} is at {:g} degrees: turn it to "
                                "between 0 and 360 degrees first",
                                axis_letters[axis], angle),
                    entry.word->span);
        }
    }
    return {};
}

core::Result<void> take_feed(Execution& execution) {
    const CommandKind kind = klartext_of(execution.block).kind;
    if (kind == rounding || kind == chamfer) return {}; // it applies to the corner only
    if (const Word* word = execution.statement.word('E')) {
        if (!klartext_of(execution.state).call_feed)
            return core::fail(ErrorCode::missing_value,
                              "FAUTO: no TOOL CALL with F has been programmed yet", word->span);
        execution.modal().feed = klartext_of(execution.state).call_feed;
    }
    return set_feed(execution);
}

core::Result<void> program_error_of(const Execution& execution) {
    const Word* word = execution.statement.word('P');
    return core::fail(program_alarm,
                      fmt::format("FN 14: the program stops here with its own error {:.12g}",
                                  word ? word->value : 0.0),
                      klartext_of(execution.block).span);
}

core::Result<void> run_statement(Execution& execution) {
    switch (klartext_of(execution.block).kind) {
    case none:
    case note:
    case modes:
        return {};
    case plane:
        return set_plane(execution);
    case rounding:
    case chamfer:
        return make_corner(execution);
    case tool_call:
        return call_klartext_tool(execution);
    case tool_definition:
        return define_klartext_tool(execution);
    case cycle_definition:
        return define_cycle(execution);
    case read_system:
        return read_system_datum(execution);
    case program_error:
        return program_error_of(execution);
    default:
        return move_in_klartext(execution);
    }
}

/// M99 calls the cycle once; M89 calls it after each motion from its block on, until M99 or another
/// cycle.
core::Result<void> call_cycle(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    KlartextState& klartext = writable_klartext(execution.state);
    if (command.calls_from_here) klartext.calls_after_motions = true;
    const bool moves = is_motion(command.kind)
                       && (command.kind != straight || execution.statement.has_axis_word()
                           || tool_direction(execution));
    const bool calls =
        command.calls_cycle || command.calls_from_here || (klartext.calls_after_motions && moves);
    if (command.calls_cycle) klartext.calls_after_motions = false;
    return calls ? call_defined_cycle(execution) : core::Result<void>{};
}

core::Result<void> run_klartext_block(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    warn_of_unknown_m_codes(execution);
    note_what_may_intervene(execution);
    const CodeWord* const tip = tip_control(execution);
    if (tip && tip->code->number == m_code(128))
        use_tip_control(execution, *tip); // M129: at the end
    const bool late_spindle = ends_block(execution, ModalGroup::spindle, m_code(5));
    const bool late_coolant = ends_block(execution, ModalGroup::coolant, m_code(9));
    for (const auto step : {turn_rotary_axes, set_units, select_plane, take_feed})
        if (auto done = step(execution); !done) return done;
    if (begins_block(execution, ModalGroup::spindle, m_code(5)))
        if (auto done = turn_spindle(execution); !done) return done;
    if (begins_block(execution, ModalGroup::coolant, m_code(9)))
        if (auto done = set_coolant(execution); !done) return done;
    if (in_machine_coordinates(execution) && is_motion(command.kind) && command.kind != straight)
        return refuse_statement(execution, "M91 is only supported with L");
    if (auto done = check_vectors(execution); !done) return done;
    if (auto done = take_space_angles(execution); !done) return done;
    if (auto done = run_statement(execution); !done) return done;
    if (is_motion(command.kind)) check_machine_move(execution, command.span);
    const bool calls = command.calls_cycle || command.calls_from_here
                       || klartext_of(execution.state).calls_after_motions;
    if (calls)
        if (auto done = call_cycle(execution); !done) return done;
    if (late_spindle)
        if (auto done = turn_spindle(execution); !done) return done;
    if (late_coolant)
        if (auto done = set_coolant(execution); !done) return done;
    if (tip && tip->code->number == m_code(129)) use_tip_control(execution, *tip);
    return stop(execution);
}

} // namespace

core::Result<void> run_klartext(Execution& execution, const ModalState& before) {
    if (auto done = run_klartext_block(execution); !done) return done;
    const auto& commands = execution.result.commands;
    if (!klartext_of(execution.state).has_moved && !in_machine_coordinates(execution)
        && std::any_of(commands.begin(), commands.end(),
                       [](const CanonicalCommand& command) { return is_motion(command); }))
        writable_klartext(execution.state).has_moved = true;
    for (size_t axis = 3; axis < 6; ++axis)
        if (klartext_of(execution.state).turns_short_way
            && execution.statement.word(axis_letters[axis]))
            check_turn(execution, before, axis, Addressing::shortest, "M126");
    return {};
}

std::string words_of(const Execution& execution) {
    const core::SourceSpan where = klartext_of(execution.block).span;
    const std::string_view text = execution.block.text;
    const size_t begin = std::min<size_t>(where.column - 1, text.size());
    const std::string_view words = text.substr(begin, where.length);
    return std::string(words.substr(0, words.find_first_of(";~\r\n")));
}

tl::unexpected<core::Error> refuse_statement(const Execution& execution, std::string_view why) {
    return core::fail(ErrorCode::invalid_value, fmt::format("{}: {}", words_of(execution), why),
                      klartext_of(execution.block).span);
}

core::Result<double> klartext_feed(const Execution& execution) {
    const std::optional<double> feed = execution.modal().feed;
    if (feed && *feed > 0.0) return *feed;
    tl::unexpected<core::Error> error =
        refuse_statement(execution, feed ? "the feed rate is F0" : no_feed_yet);
    error.value().code = no_feed;
    return error;
}

double q_number(const Execution& execution, int number) {
    return execution.state.parameters->numbered(number).value_or(0.0);
}

double q_length(const Execution& execution, int number) {
    return to_mm(q_number(execution, number), execution.modal().unit);
}

namespace {

using core::OffsetNumber;
using core::ToolNumber;

// Q parameters with the data of the current tool.
constexpr int q_radius = 108, q_axis = 109, q_length_of_tool = 114;

void put_into_spindle(Execution& execution, ToolNumber tool) {
    ModalState& modal = execution.modal();
    if (modal.tool == tool) return;
    modal.selected_tool = modal.tool = tool;
    execution.emit(SelectTool{tool});
    if (modal.spindle != core::SpindleDirection::stopped) {
        modal.spindle = core::SpindleDirection::stopped;
        execution.emit(Spindle{modal.spindle, 0.0});
    }
    move_to_tool_change(execution);
    execution.emit(ChangeTool{tool == ToolNumber(0) ? std::nullopt : std::optional(tool)});
}

/// From the tool table, else of the tool of the set-up; empty if neither has it.
std::optional<double> radius_of(const Execution& execution, int number) {
    const Tables& tables = *execution.state.tables;
    const auto entry = tables.lengths.find(OffsetNumber(number));
    if (entry != tables.lengths.end() && entry->second.diameter != 0.0)
        return entry->second.diameter / 2.0 + entry->second.radius_wear;
    const auto tool = tables.tool_diameters.find(ToolNumber(number));
    if (tool == tables.tool_diameters.end()) return std::nullopt;
    return tool->second / 2.0;
}

/// Activates the length of the tool and sets the Q parameters with its size.
void use_length(Execution& execution, int number) {
    const std::optional<double> length =
        number == 0 ? std::optional(0.0) : length_under(*execution.state.tables, number);
    if (!length)
        execution.warn(
            klartext_of(execution.block).span,
            fmt::format("TOOL CALL: the length of tool {} is unknown and assumed to be 0", number));
    const Word* longer = execution.statement.word('L');
    const Word* wider = execution.statement.word('D');
    writable_klartext(execution.state).has_deltas = klartext_of(execution.block).has_corner_delta
                                                    || (longer && longer->value != 0.0)
                                                    || (wider && wider->value != 0.0);
    Offsets offsets = execution.modal().offsets;
    offsets.tool = {};
    const size_t normal = axes_of(execution.modal().plane).normal;
    offsets.tool[normal] = length.value_or(0.0) + (longer ? length_of(execution, *longer) : 0.0);
    change_offsets(execution, offsets);
    execution.modal().length_number = OffsetNumber(number);
    execution.emit(
        UseToolLengthOffset{OffsetNumber(number), offsets.tool, offsets.follows_tip,
                            lacks_length(*execution.state.tables, OffsetNumber(number))});
    std::optional<double> radius = radius_of(execution, number);
    if (radius && wider) *radius += length_of(execution, *wider);
    const LengthUnit unit = execution.modal().unit;
    Parameters& parameters = execution.state.parameters.write();
    parameters.set_numbered(q_radius, radius ? Value(from_mm(*radius, unit)) : Value{});
    parameters.set_numbered(q_axis, static_cast<double>(normal));
    parameters.set_numbered(q_length_of_tool, from_mm(offsets.tool[normal], unit));
}

/// Warns if the length of a tool in the program differs from the set-up.
void warn_of_other_length(Execution& execution, int number, double length, const Word& word) {
    const auto known = length_under(*execution.state.tables, number);
    if (!known || std::abs(*known - length) < 1e-6) return;
    execution.warn(word.span, fmt::format("{}: the tool table gives {:.4f} mm as the length of "
                                          "tool {}; the value from the program is used",
                                          written(word), *known, number));
}

} // namespace

namespace {

/// The number or name after TOOL CALL and TOOL DEF; empty if there is neither.
core::Result<std::optional<ToolNumber>> tool_of_block(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    if (!command.tool_name.empty()) return tool_of_name(execution, command.tool_name, command.span);
    const Word* tool = execution.statement.word('T');
    if (!tool) return std::nullopt;
    FEELER_TRY(const int number, whole_number(*tool, 0, 32767));
    return ToolNumber(number);
}

} // namespace

core::Result<void> call_klartext_tool(Execution& execution) {
    const Statement& statement = execution.statement;
    FEELER_TRY(const std::optional<ToolNumber> tool, tool_of_block(execution));
    if (tool) {
        put_into_spindle(execution, *tool);
        use_length(execution, value_of(*tool));
    } else if (statement.word('L')) {
        if (!execution.modal().tool)
            return refuse_statement(execution, "DL without a tool in the spindle");
        use_length(execution, value_of(*execution.modal().tool));
    }
    if (statement.word('F')) writable_klartext(execution.state).call_feed = execution.modal().feed;
    return set_speed(execution);
}

core::Result<void> define_klartext_tool(Execution& execution) {
    const Statement& statement = execution.statement;
    FEELER_TRY(const std::optional<ToolNumber> tool, tool_of_block(execution));
    if (!tool) return refuse_statement(execution, "the tool number is missing");
    const Word* length = statement.word('L');
    const Word* radius = statement.word('R');
    if (!length && !radius) { // preselection of the next tool
        execution.modal().selected_tool = *tool;
        execution.emit(SelectTool{*tool});
        return {};
    }
    const int number = value_of(*tool);
    if (length) warn_of_other_length(execution, number, length_of(execution, *length), *length);
    LengthOffset& entry = execution.state.tables.write().lengths[OffsetNumber(number)];
    if (length) entry.length = length_of(execution, *length);
    if (length) entry.wear = 0.0;
    if (radius) entry.diameter = 2.0 * length_of(execution, *radius);
    return {};
}

core::Result<void> read_system_datum(Execution& execution) {
    const Statement& statement = execution.statement;
    const auto number = [&](char letter) {
        const Word* word = statement.word(letter);
        return word ? core::round_to_integer(std::clamp(word->value, -1.0, 1e6)) : 0;
    };
    const long group = number('I'), item = number('N'), index = number('K');
    const bool machine = group == 240, program = group == 270;
    if (!(machine || program) || item != 1 || index < 1 || index > long(axis_count))
        return core::fail(ErrorCode::unsupported,
                          fmt::format("FN 18: ID{} NR{} IDX{} is not supported: only the positions "
                                      "can be read, ID240 NR1 and ID270 NR1",
                                      group, item, index),
                          klartext_of(execution.block).span);
    const ModalState& modal = execution.modal();
    const Position position =
        machine ? machine_from_program(modal.offsets, modal.position) : modal.position;
    const auto axis = static_cast<size_t>(index - 1);
    if (!position[axis])
        execution.warn(klartext_of(execution.block).span,
                       fmt::format("FN 18: the {} position is unknown and assumed to be 0; set "
                                   "[program] start in the set-up",
                                   axis_letters[axis]));
    const double value = position[axis].value_or(0.0);
    if (execution.environment.on_system_read) execution.environment.on_system_read(value);
    const double target = statement.word('Q')->value;
    execution.state.parameters.write().set_numbered(static_cast<int>(target), value);
    note_written(execution.state, key_of(target));
    return {};
}

namespace {

void add(Digest& digest, const DefinedCycle& cycle) {
    digest.add(number_of(2 * cycle.number + int(cycle.feed_of_call)));
    for (const double value : {cycle.clearance,   cycle.depth,       cycle.feed,
                               cycle.peck,        cycle.surface,     cycle.second_clearance,
                               cycle.dwell_above, cycle.dwell_below, cycle.retract_feed,
                               cycle.decrement,   cycle.breaks,      cycle.least_peck,
                               cycle.break_back,  cycle.break_every, cycle.stop_above,
                               cycle.stop_below,  cycle.start_depth, cycle.disengage,
                               cycle.pitch,       cycle.infeed,      cycle.diameter})
        digest.add(value);
}

void add(Digest& digest, const Transforms& transforms) {
    for (const auto kind : transforms.order) digest.add(number_of(int(kind)));
    add_all(digest, transforms.shift);
    for (const bool mirrored : transforms.mirrored) digest.add(uint64_t{mirrored});
    digest.add(transforms.turn_deg);
    digest.add(transforms.scale);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) digest.add(transforms.plane[column][row]);
}

} // namespace

void add(Digest& digest, const KlartextState& klartext) {
    add_all(digest, klartext.pole);
    digest.add(uint64_t{klartext.direction.has_value()});
    if (klartext.direction) add_all(digest, *klartext.direction);
    digest.add(uint64_t{klartext.corner.has_value()});
    if (klartext.corner) {
        for (const Position* position : {&klartext.corner->point, &klartext.corner->end})
            add_all(digest, *position);
        add_all(digest, klartext.corner->centre);
        digest.add(number_of(klartext.corner->turn + 4 * int(klartext.corner->is_done)));
    }
    add(digest, klartext.cycle);
    digest.add(number_of(int(klartext.calls_after_motions) + 2 * int(klartext.looks_ahead)
                         + 16 * int(klartext.has_deltas) + 32 * int(klartext.by_space_angles)
                         + 4 * int(klartext.turns_short_way) + 8 * int(klartext.has_moved)));
    digest.add(klartext.call_feed);
    digest.add(klartext.datum);
    add(digest, klartext.transforms);
}

namespace {

std::shared_ptr<LanguageState> begin_klartext(const Environment&) {
    return std::make_shared<StateOf<KlartextState>>();
}

} // namespace

const LanguageFunctions klartext_language = {.parse = parse_klartext,
                                             .index = klartext_index,
                                             .execute = run_klartext,
                                             .run_flow = run_klartext_flow,
                                             .begin = begin_klartext,
                                             .block_at = klartext_block,
                                             .lines_of = lines_of,
                                             .position_in_file = position_in_lines};

} // namespace gcode
