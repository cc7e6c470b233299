#include "gcode/exec/following.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/motion/machine.h"
#include "core/motion/plane_turn.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

constexpr uint8_t all_linear = 0b111; // X, Y, Z

bool is_turned(const Offsets& offsets, const Position& program) {
    const Position machine = machine_from_program(offsets, program);
    for (size_t axis = 3; axis < 6; ++axis)
        if (!machine[axis] || is_away_from_zero(axis, *machine[axis])) return true;
    return false;
}

/// Tool centre point control or a tilted plane, which need the rotary axes of a machine.
bool follows_without_machine(const ModalState& modal) {
    return modal.offsets.follows_tip && !modal.offsets.machine;
}

bool tilts_without_machine(const ModalState& modal) {
    return modal.offsets.frame.tilts_tool && !is_fixed_to_work(modal.offsets);
}

bool may_follow(const ModalState& modal) {
    return modal.following.may_be_on || follows_without_machine(modal);
}

bool moves(const Execution& execution) {
    const auto& commands = execution.result.commands;
    return std::any_of(commands.begin(), commands.end(), is_motion);
}

/// Whether a rotary axis is away from 0 before, during or after the block.
bool is_turned_within(const Execution& execution, const ModalState& before) {
    const Offsets& offsets = execution.modal().offsets;
    if (is_turned(before.offsets, before.position)
        || is_turned(offsets, execution.modal().position))
        return true;
    for (size_t axis = 3; axis < 6; ++axis) // a full turn
        if (execution.modal().position[axis] != before.position[axis]) return true;
    const auto end_is_turned = [&](const auto& command) {
        if constexpr (requires { command.end; }) return is_turned(offsets, command.end);
        return false;
    };
    const auto& commands = execution.result.commands;
    return std::any_of(commands.begin(), commands.end(), [&](const CanonicalCommand& command) {
        return std::visit(end_is_turned, command);
    });
}

/// Whether the block brings an axis to a position that does not depend on where it was.
bool places(const Execution& execution, size_t axis) {
    const Word* word = execution.statement.word(axis_letters[axis]);
    const BlockCommands& result = execution.result;
    if (!word || (result.is_cycle && !result.goes_home)) return false;
    if ((execution.tool_by_angles || execution.loses_rotary_axes) && is_rotary(axis)) return false;
    if (result.goes_home) return true;
    const bool has_no_increments =
        in_machine_coordinates(execution) && execution.dialect.language == Language::words;
    return has_no_increments || !is_incremental(execution, *word);
}

uint8_t placed_axes(const Execution& execution) {
    uint8_t placed = 0;
    for (size_t axis = 0; axis < 3; ++axis)
        if (places(execution, axis)) placed |= static_cast<uint8_t>(1u << axis);
    return !mixes_axes(execution.modal().offsets) || placed == all_linear ? placed : uint8_t{0};
}

/// Not by words that are angles of a plane or offsets.
bool places_rotary_axes(const Execution& execution) {
    if (!moves(execution)) return false;
    int placed = 0;
    for (size_t axis = 3; axis < 6; ++axis) placed += places(execution, axis) ? 1 : 0;
    return placed >= 2;
}

core::SourceSpan place_of(const Execution& execution) {
    for (const Word& word : execution.block.words)
        if (axis_letters.find(word.letter) != std::string_view::npos) return word.span;
    return {.line = execution.block.line, .column = 1};
}

std::string name_of(const Execution& execution, const Following& following) {
    const std::string file =
        following.source == 0
            ? std::string()
            : fmt::format(" of {}", execution.library.program(following.source).file);
    return fmt::format("{} in line {}{}", following.code.data(), following.line, file);
}

void report(Execution& execution) {
    Following& following = execution.modal().following;
    if (std::exchange(following.is_said, true)) return;
    const std::string name = name_of(execution, following);
    std::string why =
        fmt::format("{} is not modelled: the linear axes follow the rotary axes", name);
    std::string cure = "Check this part of the program at the machine, or switch the "
                       "transformation off before it.";
    const bool follows_tip = follows_without_machine(execution.modal());
    const bool tilts = tilts_without_machine(execution.modal());
    if (following.line == 0 && following.code[0] != 0 && !follows_tip && !tilts) {
        why = fmt::format("{} is active from the start: the linear axes follow the rotary ones, "
                          "and where these are is not known",
                          following.code.data());
        cure = "State the values of its pins under [program.values] in the set-up, or describe the "
               "rotary axes of the machine as [[machine.axis]].";
    } else if (following.line == 0 || follows_tip || tilts) {
        why = fmt::format("{} needs the rotary axes of the machine, which are not described",
                          follows_tip ? "tool centre point control" : "a tilted plane");
        cure = "Describe the machine in a set-up, with its rotary axes as [[axis]].";
    } else if (following.is_unknown_code) {
        why = fmt::format("it is unknown what {} does: the linear axes may follow the rotary axes "
                          "from there on",
                          name);
        cure = fmt::format("If {} does not change how axes move, list it in machine_codes under "
                           "[program] in the set-up.",
                           following.code.data());
    }
    execution.result.warnings.push_back(
        {Severity::warning, place_of(execution),
         fmt::format(
             "{}. This block and later ones are not checked until the positions are certain "
             "again",
             why),
         core::rule_id("undecided"), std::move(cure)});
}

/// LinuxCNC: from now on, X, Y and Z are the tip of the tool as seen from the work, or the axes of
/// the machine.
void follow_in_world(Execution& execution, bool on) {
    Offsets offsets = execution.modal().offsets;
    if (offsets.has_world == on) return;
    offsets.follows_tip = offsets.has_world = on;
    change_offsets(execution, offsets);
    execution.emit(SetOffset{offsets});
}

/// Executes such a code, in a block without a motion. False if it may be anything else.
bool switches_as_in_samples(Execution& execution, const Word& word) {
    if (!is_switch_of_samples(execution, word) || moves(execution)) return false;
    const bool on = answer_to(execution.state, execution.environment,
                              ControlQuestion::m428_follows_tip, execution.block.line)
                    == (word.value == 428.0);
    follow_in_world(execution, on);
    return true;
}

/// Unknown M codes may switch a transformation.
void note_unknown_codes(Execution& execution) {
    for (const Word* word : execution.statement.unknown_m_codes)
        if (!switches_as_in_samples(execution, *word))
            switch_following(execution, word->span, written(*word), FollowingSwitch::perhaps);
}

} // namespace

bool is_switch_of_samples(const Execution& execution, const Word& word) {
    return execution.dialect.id == DialectId::linuxcnc && !execution.environment.kinematics
           && execution.modal().offsets.machine && (word.value == 428.0 || word.value == 429.0);
}

bool is_away_from_zero(size_t axis, double value) {
    constexpr double slack = 1e-9;
    return std::abs(is_rotary(axis) ? std::remainder(value, 360.0) : value) > slack;
}

void switch_following(Execution& execution, core::SourceSpan where, std::string_view code,
                      FollowingSwitch to) {
    ModalState& modal = execution.modal();
    Following& following = modal.following;
    const bool was_on = following.may_be_on;
    const bool keeps_name = was_on && to == FollowingSwitch::perhaps;
    if (to != FollowingSwitch::off && !keeps_name) {
        following.code.fill('\0');
        code.copy(following.code.data(), following.code.size() - 1);
        following.line = where.line;
        following.source = execution.state.next.source;
        following.is_unknown_code = to == FollowingSwitch::perhaps;
        following.is_said = false;
    }
    following.may_be_on = to != FollowingSwitch::off;
    if (to == FollowingSwitch::on && !was_on)
        execution.warn(where,
                       fmt::format("{}: motions are not checked while it is on and a rotary axis "
                                   "is away from 0",
                                   code),
                       Severity::note);
    // Program and machine coordinates part where the transformation changes with the work turned.
    if ((was_on || following.may_be_on) && is_turned(modal.offsets, modal.position))
        following.unknown_axes = all_linear;
}

bool switch_tip_control(Execution& execution, bool on) {
    const ModalState& modal = execution.modal();
    Offsets offsets = modal.offsets;
    if (!offsets.machine || offsets.tool[0] != 0.0 || offsets.tool[1] != 0.0) return false;
    if (offsets.follows_tip == on) return true;
    offsets.follows_tip = on;
    change_offsets(execution, offsets);
    execution.emit(UseToolLengthOffset{modal.length_number, offsets.tool, on,
                                       lacks_length(*execution.state.tables, modal.length_number)});
    return true;
}

core::Result<void> switch_kinematics(Execution& execution, core::SourceSpan where,
                                     std::string_view code, double number) {
    const SwitchableKinematics& kinematics = *execution.environment.kinematics;
    const size_t count = kinematics.types.size();
    if (!(number >= 0.0 && number < static_cast<double>(count)) || number != std::floor(number))
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("{}: {} has kinematics 0 to {}, not {:g}", code,
                                      kinematics.module, count - 1, number),
                          where);
    ModalState& modal = execution.modal();
    const SwitchableKinematics::Type type = kinematics.types[static_cast<size_t>(number)];
    const bool tip = type == SwitchableKinematics::Type::tip;
    const bool is_known =
        type == SwitchableKinematics::Type::axes || (tip && modal.offsets.machine != nullptr);
    follow_in_world(execution, is_known && tip);
    modal.kinematics = static_cast<int>(number);
    modal.following.awaits_sync = true;
    if (!is_known)
        switch_following(execution, where, code, FollowingSwitch::on);
    else if (modal.following.may_be_on)
        switch_following(execution, where, code, FollowingSwitch::off);
    return {};
}

void begin_kinematics(ModalState& modal, const Environment& environment) {
    if (!environment.kinematics) return;
    const SwitchableKinematics& kinematics = *environment.kinematics;
    const auto first =
        kinematics.types.empty() ? SwitchableKinematics::Type::axes : kinematics.types.front();
    if (first == SwitchableKinematics::Type::axes) return;
    if (first == SwitchableKinematics::Type::tip && modal.offsets.machine) {
        modal.offsets.follows_tip = modal.offsets.has_world = true;
        return;
    }
    Following& following = modal.following;
    following.code.fill('\0');
    kinematics.module.copy(following.code.data(), following.code.size() - 1);
    following.may_be_on = true;
}

void check_turn(Execution& execution, const ModalState& before, size_t axis, Addressing way,
                std::string_view code) {
    ModalState& modal = execution.modal();
    const Offsets& offsets = modal.offsets;
    if (offsets.machine && offsets.machine->axes[axis].shortest_way && way == Addressing::shortest)
        return;
    const double turn = modal.position[axis].value_or(0.0) - before.position[axis].value_or(0.0);
    constexpr double slack = 1e-9;
    const bool straight = way == Addressing::positive   ? turn > -slack
                          : way == Addressing::negative ? turn < slack
                                                        : std::abs(turn) < 180.0 + slack;
    if (straight) return;
    execution.result.path = core::PathCertainty::unknown;
    if (std::exchange(modal.following.said_turn, true)) return;
    execution.result.warnings.push_back(
        {Severity::warning, place_of(execution),
         fmt::format(
             "{}: axis {} turns by {:g} degrees the other way round, which is not modelled; "
             "blocks in which it does so are not checked",
             code, axis_letters[axis], turn > 0.0 ? 360.0 - turn : 360.0 + turn),
         core::rule_id("undecided"),
         "Program a position less than half a turn away, or an incremental angle."});
}

namespace {

/// DC, ACP and ACN of Siemens.
void check_turns(Execution& execution, const ModalState& before) {
    for (size_t axis = 3; axis < 6; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word || word->addressing <= Addressing::incremental) continue;
        constexpr std::string_view names[] = {"DC", "ACP", "ACN"};
        check_turn(execution, before, axis, word->addressing,
                   names[size_t(word->addressing) - size_t(Addressing::shortest)]);
    }
}

/// A move of a block, in program coordinates.
struct ProgramMove {
    Position from, to;
    bool is_arc;
};

/// The moves of a block, in order.
std::vector<ProgramMove> moves_of(const Execution& execution, const ModalState& before) {
    std::vector<ProgramMove> moves;
    Position here = before.position;
    for (const CanonicalCommand& command : execution.result.commands) {
        const auto* rapid = std::get_if<StraightTraverse>(&command);
        const auto* feed = std::get_if<StraightFeed>(&command);
        const auto* arc = std::get_if<ArcFeed>(&command);
        if (!rapid && !feed && !arc) continue;
        const Position& end = rapid ? rapid->end : feed ? feed->end : arc->end;
        moves.push_back({here, end, arc != nullptr});
        here = end;
    }
    return moves;
}

/// Whether a move that turns the tool in a plane goes the way that is assumed.
bool is_certain_turn(Execution& execution, const AxisValues& from, const AxisValues& to) {
    const auto turn =
        core::turn_in_plane(*execution.modal().offsets.machine, from, to, core::turn_error);
    if (!turn) return false;
    number_for(execution.state, execution.environment, ControlQuestion::pole_limit,
               execution.block.line); // a premise
    return turn->sine > sine_of_pole_limit(execution);
}

/// Marks the motions of a block that turn the tool in a plane, where they pass near to a pole or
/// are no straight lines: the control may turn the rotary axes otherwise.
void check_turns_in_plane(Execution& execution, const ModalState& before) {
    ModalState& modal = execution.modal();
    if (!modal.turns_in_plane || !modal.offsets.follows_tip || !modal.offsets.machine) return;
    const auto at = [&](const Position& program) {
        return values_or_zero(machine_from_program(modal.offsets, program));
    };
    bool is_certain = true;
    for (const ProgramMove& move : moves_of(execution, before))
        if (turns_between(move.from, move.to))
            is_certain = is_certain && !move.is_arc
                         && is_certain_turn(execution, at(move.from), at(move.to));
    if (is_certain) return;
    // Two positions of the rotary axes point the tool there, and the way decides which.
    if (tool_direction(execution)) modal.following.rotary_unknown = true;
    execution.result.path = std::max(execution.result.path, core::PathCertainty::doubtful);
    if (std::exchange(modal.following.said_pole, true)) return;
    execution.result.warnings.push_back(
        {Severity::warning, place_of(execution),
         "how the control turns the tool here is not known: it turns on an arc, or passes near to "
         "a direction that it keeps while a rotary axis turns (the pole). This block and others "
         "like it are measured with rotary axes that turn evenly, and are not proven clear",
         core::rule_id("undecided"),
         execution.dialect.id == DialectId::siemens
             ? "Turn the rotary axes in a block of their own, or with ORIAXES; if the machine has "
               "another limit, state \"MD24530\" under [control] in the set-up."
             : "Turn the rotary axes in a block of their own, or let each turn evenly."});
}

/// While the control follows the tip, an axis such as W of LinuxCNC's 5axiskins moves the tip along
/// the tool, which is a straight line only if the tool does not turn.
void check_length_axis(Execution& execution, const ModalState& before) {
    const Offsets& offsets = execution.modal().offsets;
    if (!offsets.machine || !offsets.machine->length_axis || !offsets.follows_tip) return;
    const size_t axis = *offsets.machine->length_axis;
    const std::vector<ProgramMove> moves = moves_of(execution, before);
    const bool is_met = std::any_of(moves.begin(), moves.end(), [&](const ProgramMove& move) {
        return move.from[axis] != move.to[axis] && turns_between(move.from, move.to);
    });
    if (!is_met) return;
    execution.result.path = core::PathCertainty::unknown;
    execution.result.warnings.push_back(
        {Severity::warning, place_of(execution),
         fmt::format(
             "{} and a rotary axis move at once while the control follows the tip, which is "
             "not followed yet: this block is not checked",
             axis_letters[axis]),
         core::rule_id("undecided"),
         fmt::format("Move {} in a block of its own.", axis_letters[axis])});
}

} // namespace

void lose_positions(Execution& execution, core::SourceSpan where, std::string why,
                    std::string cure) {
    Following& following = execution.modal().following;
    following.unknown_axes = all_linear;
    following.is_said = true;
    execution.result.warnings.push_back(
        {Severity::warning, where, std::move(why), core::rule_id("undecided"), std::move(cure)});
}

void lose_remapped(Execution& execution, const Word& word) {
    switch_following(execution, word.span, written(word), FollowingSwitch::perhaps);
    lose_positions(execution, word.span,
                   fmt::format("the ini file runs a subprogram in place of {}, which is only "
                               "followed if it is there and {} is alone in its line: what comes "
                               "after it is not checked until the positions are certain again",
                               written(word), written(word)),
                   "Program the code in a line of its own.");
    execution.result.path = core::PathCertainty::unknown;
}

void point_undescribed(ModalState& modal, const ToolDirection& tool) {
    const core::Vec3& d = tool.direction;
    modal.following.rotary_unknown = d.x != 0.0 || d.y != 0.0 || !(d.z > 0.0);
    modal.following.is_pointed = true;
}

bool is_work_turned(const ModalState& modal) {
    return modal.following.rotary_unknown || is_turned(modal.offsets, modal.position);
}

bool is_uncertain(const ModalState& modal) {
    if (modal.following.rotary_unknown) return true;
    if (modal.following.unknown_axes != 0 || tilts_without_machine(modal)) return true;
    return may_follow(modal) && is_turned(modal.offsets, modal.position);
}

void mark_uncertain_motions(Execution& execution, const ModalState& before) {
    note_unknown_codes(execution);
    ModalState& modal = execution.modal();
    Following& following = modal.following;
    check_turns(execution, before);
    check_turns_in_plane(execution, before);
    check_length_axis(execution, before);
    if (following.awaits_sync && moves(execution)) {
        following.awaits_sync = false;
        execution.result.path = core::PathCertainty::unknown;
        lose_positions(execution, place_of(execution),
                       "the control has read this block before the kinematics changed, so it still "
                       "counts from the old position: what comes from here on is not checked until "
                       "the positions are certain again",
                       "Program M66 E0 L0 after M68, and M68 instead of M67.");
    }
    if (modal.doubt)
        execution.result.path = std::max(execution.result.path, core::PathCertainty::doubtful);
    const bool follows = may_follow(before) || may_follow(modal);
    const bool tilts = tilts_without_machine(before) || tilts_without_machine(modal);
    if (!follows && !tilts && following.unknown_axes == 0 && !following.rotary_unknown) return;
    // G53.1 has turned the work to unknown angles, until a block programs two rotary axes. That one
    // still comes from there.
    const bool begins_unknown = before.following.rotary_unknown;
    following.rotary_unknown = (following.rotary_unknown && !places_rotary_axes(execution))
                               || (tilts && turns_to_plane(execution));
    if (places_rotary_axes(execution)) following.is_pointed = false;
    const auto is_on = [](const ModalState& modes) {
        return modes.offsets.follows_tip || modes.following.may_be_on;
    };
    if (is_on(before) && !is_on(modal)) {
        following.rotary_unknown = following.rotary_unknown || following.is_pointed;
        following.is_pointed = false;
        // Only the tip was known, and only while the control followed it.
        if (following.rotary_unknown) following.unknown_axes = all_linear;
    }
    const bool turned = is_turned_within(execution, before);
    const bool switches = follows_without_machine(before) != follows_without_machine(modal);
    if ((switches && turned) || (tilts && !tilts_without_machine(modal)))
        following.unknown_axes = all_linear;
    if (!moves(execution)) return;
    if ((follows && turned) || tilts || following.unknown_axes != 0 || begins_unknown
        || following.rotary_unknown) {
        execution.result.path = core::PathCertainty::unknown;
        report(execution);
    }
    const bool stays_uncertain = tilts_without_machine(modal)
                                 || (may_follow(modal) && is_turned(modal.offsets, modal.position));
    if (!stays_uncertain) following.unknown_axes &= static_cast<uint8_t>(~placed_axes(execution));
}

} // namespace gcode
