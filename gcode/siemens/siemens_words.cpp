#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/motion/machine.h"
#include "gcode/exec/following.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"
#include "gcode/siemens/siemens.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr std::string_view siemens_length_letters = "XYZIJKF";

/// Whether a word other than those of axes, modes and tools is used in its block.
bool is_used(const Execution& execution, const Word& word) {
    const auto* motion = execution.statement.of(ModalGroup::motion);
    const MotionCode code = (motion ? motion_of(motion->code->number) : execution.modal().motion)
                                .value_or(MotionCode::straight);
    const bool by_point = use_of(execution, SiemensAction::arc_by_point)
                          || code == MotionCode::arc_through_point
                          || code == MotionCode::tangent_arc;
    const bool straight = is_straight(code);
    switch (word.letter) {
    case 'Q':
        return use_of(execution, SiemensAction::turn) || use_of(execution, SiemensAction::add_turn)
               || use_of(execution, SiemensAction::space_turn)
               || use_of(execution, SiemensAction::add_space_turn);
    case 't': // A3, B3, C3
    case 'u':
    case 'v':
    case 'w': // A2, B2, C2
    case 'x':
    case 'y':
        return true;
    case 'i':
    case 'j':
    case 'k':
        return by_point;
    case 'I':
    case 'J':
    case 'K':
    case 'R':
    case 'P':
    case 'E':
        return !straight || by_point;
    default:
        return word.letter != 'H'; // H goes to the PLC
    }
}

void warn_of_unused(Execution& execution) {
    for (const Word& word : execution.block.words) {
        if (is_used(execution, word)) continue;
        const std::string_view written =
            execution.block.text.substr(word.span.column - 1, word.span.length);
        execution.warn(word.span, fmt::format("{}: no code in this block uses this word", written));
    }
}

void note_assumed_siemens_units(Execution& execution) {
    ModalState& modal = execution.modal();
    if (modal.unit_said || execution.state.said_unit) return;
    for (const Word& word : execution.block.words) {
        if (siemens_length_letters.find(word.letter) == std::string_view::npos) continue;
        execution.state.said_unit = true;
        modal.unit = first_unit(execution.state, execution.environment, execution.block.line);
        execution.warn(
            word.span,
            fmt::format("no units (G70, G71, G700 or G710) programmed before {}; {} assumed",
                        written(word), modal.unit == LengthUnit::inch ? "inches" : "millimetres"),
            Severity::note);
        return;
    }
}

/// G70 and G71 affect lengths only; G700 and G710 also feeds, which are in mm otherwise.
core::Result<void> set_siemens_feed(Execution& execution) {
    const CodeWord* units = execution.statement.of(ModalGroup::units);
    ModalState& modal = execution.modal();
    if (units) {
        const CodeNumber code = units->code->number;
        const bool inch = code == g_code(70) || code == g_code(700);
        modal.unit = inch ? LengthUnit::inch : LengthUnit::mm;
        modal.unit_said = true;
        if (code == g_code(700) || code == g_code(710))
            writable_siemens(execution.state).feeds_in_inches = code == g_code(700);
    }
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const Word* word = execution.statement.word('F');
    if (!word || (action && action->code->number == g_code(4))) return {};
    if (word->value < 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a feed rate must not be negative", written(*word)),
                          word->span);
    const LengthUnit unit =
        siemens_of(execution.state).feeds_in_inches ? LengthUnit::inch : LengthUnit::mm;
    modal.feed = modal.feed_mode == FeedMode::inverse_time ? word->value : to_mm(word->value, unit);
    modal.feed_unit = unit;
    return {};
}

/// Sets the feed mode that belongs to the codes of constant surface speed: G95 with G96 and G97,
/// G94 with G961 and G971.
void set_mode_of_surface_speed(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::spindle_mode);
    if (!entry) return;
    const CodeNumber code = entry->code->number;
    ModalState& modal = execution.modal();
    const FeedMode before = modal.feed_mode;
    if (code == g_code(96) || code == g_code(97)) modal.feed_mode = FeedMode::per_turn;
    if (code == g_code(961) || code == g_code(971)) modal.feed_mode = FeedMode::per_minute;
    if (modal.feed_mode != before) modal.feed.reset();
    modal.surface_speed = code == g_code(96) || code == g_code(961) || code == g_code(962);
    execution.column = entry->word->span.column;
    execution.emit(UseSpindleMode{modal.surface_speed, modal.speed, 0.0});
}

core::Result<void> set_siemens_speed(Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const bool others = action
                        && (action->code->number == g_code(4) || action->code->number == g_code(25)
                            || action->code->number == g_code(26));
    return others ? core::Result<void>{} : set_speed(execution);
}

/// The plane of CYCLE800 or TOROT does not turn with an axis that the program turns afterwards.
core::Result<void> check_swivelled_axes(const Execution& execution) {
    const Offsets& offsets = execution.modal().offsets;
    if (!siemens_of(execution.state).swivels || !offsets.machine) return {};
    const bool is_torot = siemens_of(execution.state).turns_with_tool;
    const char* const plane = is_torot ? "TOROT" : "CYCLE800";
    const char* const cancel = is_torot ? "TOROTOF" : "CYCLE800()";
    for (size_t axis = 3; axis < 6; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]);
            word && offsets.machine->axes[axis].present)
            return core::fail(
                ErrorCode::unsupported,
                fmt::format("{}: turning a rotary axis while a plane of {} is on is not supported "
                            "yet: program {} before it",
                            written(*word), plane, cancel),
                word->span);
    if (vector_words(execution.block, direction_letters)
        || vector_words(execution.block, angle_letters))
        return core::fail(ErrorCode::unsupported,
                          fmt::format("turning the tool while a plane of {} is on is not supported "
                                      "yet: program {} before it",
                                      plane, cancel),
                          {.line = execution.block.line, .column = 1});
    return {};
}

} // namespace

core::Result<void> use_siemens_words(Execution& execution) {
    if (auto done = check_swivelled_axes(execution); !done) return done;
    warn_of_unknown_m_codes(execution);
    warn_of_unused(execution);
    if (auto done = set_feed_mode(execution); !done) return done;
    set_mode_of_surface_speed(execution);
    if (auto done = set_siemens_feed(execution); !done) return done;
    note_assumed_siemens_units(execution);
    return set_siemens_speed(execution);
}

core::Result<void> select_siemens_offset(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::work_offset);
    if (!entry) return {};
    const int code = static_cast<int>(core::round_to_integer(entry->word->value));
    Offsets offsets = execution.modal().offsets;
    // G505 is the fifth settable offset; G54 to G57 are the first four.
    offsets.active = code == 500  ? no_work_offset
                     : code <= 57 ? static_cast<size_t>(code - 54)
                                  : static_cast<size_t>(code - 505 + 4);
    offsets.work = offsets.active == no_work_offset
                       ? WorkOffset{}
                       : work_offset(*execution.state.tables, offsets.active);
    execution.column = entry->word->span.column;
    const bool is_plain = offsets.active < plain_offset_count;
    if (code >= 505 && is_plain)
        execution.warn(entry->word->span,
                       fmt::format("G{} is the offset called {} in the set-up", code,
                                   name_of_offset(offsets.active)),
                       Severity::note);
    else if (code >= 505 && !execution.environment.extended_offsets.contains(offsets.active))
        execution.warn(entry->word->span,
                       fmt::format("G{}: this offset is unknown and assumed to be zero", code));
    change_siemens_offsets(execution, offsets, execution.modal().offset_travel);
    execution.emit(SetOffset{offsets});
    return {};
}

namespace {

/// A point of the machine to which G74 or G75 moves; empty where the set-up does not state it.
struct MachinePoint {
    Position position;
    std::string_view what, key; // "fixed point", and how to state it
};

MachinePoint point_of(const Execution& execution, const CodeWord& entry) {
    if (entry.code->number == g_code(74))
        return {execution.modal().home, "reference point", "`home` of the axes"};
    MachinePoint point{{}, "fixed point", "MD30600 under [control]"};
    if (const auto& stated = execution.environment.fixed_point)
        std::copy(stated->begin(), stated->end(), point.position.begin());
    return point;
}

bool names(const Execution& execution, size_t axis) {
    return execution.statement.word(axis_letters[axis]) != nullptr;
}

/// The point is not stated: where the axes of the block go is not known.
void assume_machine_zero(Execution& execution, const CodeWord& entry, const MachinePoint& point) {
    const std::string code = written(*entry.word);
    if (!execution.environment.control.reports_premises) {
        if (!execution.state.said_home)
            execution.warn(entry.word->span, fmt::format("{}: the {} is not given and assumed to "
                                                         "be machine zero",
                                                         code, point.what));
        execution.state.said_home = true;
        return;
    }
    Following& following = execution.modal().following;
    uint8_t unknown = following.unknown_axes;
    for (size_t axis = 0; axis < 3; ++axis)
        if (names(execution, axis) || mixes_axes(execution.modal().offsets))
            unknown |= static_cast<uint8_t>(1u << axis);
    lose_positions(execution, entry.word->span,
                   fmt::format("{}: the {} is not stated. This move is not checked, nor are later "
                               "ones until the axes have been programmed again",
                               code, point.what),
                   fmt::format("State {} in the set-up.", point.key));
    following.unknown_axes = unknown;
    execution.result.is_cycle = true; // its words are no positions
}

/// Where a rotary axis turns while others move, nothing bounds the path.
void doubt_rotary_axes(Execution& execution) {
    size_t linear = 0, rotary = 0;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (names(execution, axis)) ++(is_rotary(axis) ? rotary : linear);
    if (rotary == 0 || rotary + linear < 2) return;
    execution.result.path = std::max(execution.result.path, core::PathCertainty::doubtful);
    execution.result.warnings.push_back(
        {Severity::warning, execution.statement.of(ModalGroup::action)->word->span,
         "each axis moves at its own speed here, rotary axes too: the straight way is checked, and "
         "is not proven clear",
         core::rule_id("undecided"),
         "Move the linear axes and the rotary axes in separate blocks."});
}

core::Result<void> check_fixed_point(Execution& execution) {
    const SiemensKeywordUse* point = use_of(execution, SiemensAction::fixed_point);
    if (!point) return {};
    FEELER_TRY(const double number, value_of_argument(flow_step_of(execution), point->value));
    if (number == 1.0) return {};
    return core::fail(
        ErrorCode::unsupported,
        fmt::format("FP={:.12g}: only the first fixed point is known to the set-up", number),
        point->span);
}

} // namespace

/// Source: SINUMERIK 840D sl, Programming Manual Fundamentals, G74 and G75: each axis moves on its
///         own, without interpolation.
core::Result<void> go_to_fixed_position(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    ModalState& modal = execution.modal();
    if (modal.offsets.follows_tip)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{} is not possible while TRAORI is on: program TRAFOOF before "
                        "it",
                        written(*entry.word)),
            entry.word->span);
    if (!execution.statement.has_axis_word())
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} has no axis word: it needs words such as X1=0 Y1=0 Z1=0",
                                      written(*entry.word)),
                          entry.word->span);
    if (auto checked = check_fixed_point(execution); !checked) return checked;
    const MachinePoint point = point_of(execution, entry);
    const Position& position = point.position;
    if (!(position[0] && position[1] && position[2])) assume_machine_zero(execution, entry, point);
    Position machine = machine_from_program(modal.offsets, modal.position);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (names(execution, axis)) machine[axis] = position[axis].value_or(0.0);
    const Position end = program_from_machine(modal.offsets, machine);
    const bool turned = mixes_axes(modal.offsets);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (names(execution, axis) || (turned && axis < 3)) modal.position[axis] = end[axis];
    execution.column = entry.word->span.column;
    execution.emit(StraightTraverse{modal.position, core::RapidStyle::independent});
    doubt_rotary_axes(execution);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (names(execution, axis)) forget_travel(execution, axis);
    return {};
}

core::Result<void> run_siemens_cycle(Execution& execution, const SiemensKeywordUse& use) {
    if (use.keyword->action == SiemensAction::swivel) return swivel(execution, use);
    if (use.keyword->action == SiemensAction::smoothing) return {}; // see set_siemens_path
    return run_hole_cycle(execution, use);
}

} // namespace gcode
