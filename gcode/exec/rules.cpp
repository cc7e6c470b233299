#include "gcode/exec/rules.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/language/canonical.h"

namespace gcode {
namespace {

using core::SourceSpan;

/// Whether the block has the motion of a tool change, and none of its own words.
bool only_changes_tool(const Execution& execution) {
    const Statement& statement = execution.statement;
    return statement.of(ModalGroup::tool_change) && !statement.has_axis_word()
           && !statement.of(ModalGroup::action);
}

bool moves(const Execution& execution) {
    if (only_changes_tool(execution)) return false;
    const auto& commands = execution.result.commands;
    return std::any_of(commands.begin(), commands.end(), is_motion);
}

bool has_code(const Execution& execution, ModalGroup group, CodeNumber number) {
    const CodeWord* entry = execution.statement.of(group);
    return entry && entry->code->number == number;
}

/// G28, G30, G53: targets in machine coordinates. G53.1 moves only rotary axes.
bool moves_in_machine_coordinates(const Execution& execution) {
    if (turns_to_plane(execution)) return true;
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    if (!action) return false;
    return action->code->number == g_code(28) || action->code->number == g_code(30)
           || is_machine_move(action->code->number);
}

void advise(Execution& execution, SourceSpan where, std::string_view rule, std::string message,
            std::string cure, Severity severity = Severity::warning) {
    execution.result.warnings.push_back(
        {severity, where, std::move(message), rule, std::move(cure)});
}

/// Lists the active modes that rotate, scale or offset the path, for a message.
std::string left_over(const ModalState& modal, bool at_end) {
    std::string found;
    const auto add = [&](bool on, std::string_view what) {
        if (on) found += fmt::format("{}{}", found.empty() ? "" : ", ", what);
    };
    const ProgramTransforms& transforms = modal.transforms;
    add(modal.compensation != Side::none, "cutter radius compensation (G41 or G42)");
    add(!at_end && modal.cycle.has_value(), "a canned cycle");
    add(transforms.scaling.has_value(), "scaling (G51)");
    add(transforms.rotation.has_value(), "rotation (G68)");
    add(transforms.mirror.axes != MirrorImage{}.axes, "a mirror image");
    add(transforms.tilt && !has_dynamic_offset(transforms), "a tilted plane (G68.2)");
    // A work offset that a program sets at an unknown position makes this offset unknown, too.
    add(at_end && modal.axis_offset_on && modal.offsets.axis != zero_position,
        "an axis offset (G92)");
    return found;
}

void check_tool_change(Execution& execution, const ModalState& before) {
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_change);
    if (!entry || entry->code->number != m_code(6)) return;
    RuleState& memory = execution.state.rules;
    const ModalState& modal = execution.modal();
    const bool has_tool = modal.tool && core::value_of(*modal.tool) != 0;
    memory.lacks_length =
        has_tool && execution.dialect.length_needs_g43 && !modal.length_is_tools();
    memory.g43_lacks_h = memory.length_cancelled = false;
    memory.increments_stay =
        before.distance == DistanceMode::incremental && modal.distance == DistanceMode::incremental;
    if (const std::string on = left_over(before, false); !on.empty())
        advise(execution, entry->word->span, core::rule_id("state-left-over"),
               fmt::format("{}: still active at this tool change: {}", written(*entry->word), on),
               "Cancel it before the tool change.");
}

/// Whether a code turns on a length offset, but no H says which.
bool names_no_length(const Execution& execution, CodeNumber code) {
    const bool takes_number = code == g_code(43) || code == g_code(44) || code == g_code(43, 4)
                              || code == g_code(43, 5) || code == g_code(234);
    return takes_number && !execution.modal().length_number;
}

void check_length_codes(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_length);
    if (!entry) return;
    RuleState& memory = execution.state.rules;
    const bool cancels = entry->code->number == g_code(49);
    memory.length_cancelled = cancels && !memory.lacks_length && execution.dialect.length_needs_g43
                              && execution.modal().tool.has_value();
    if (!cancels) memory.lacks_length = false;
    memory.g43_lacks_h = names_no_length(execution, entry->code->number);
    if (memory.g43_lacks_h) {
        const auto& tool = execution.modal().tool;
        memory.lacks_length = tool && core::value_of(*tool) != 0;
    }
}

/// The first Z move in work coordinates shows whether the program handles the tool length.
void check_length(Execution& execution, const ModalState& before) {
    RuleState& memory = execution.state.rules;
    if (!memory.lacks_length && !memory.length_cancelled) return;
    const ModalState& modal = execution.modal();
    if (moves_in_machine_coordinates(execution) || modal.position[2] == before.position[2]) return;
    if (!moves(execution)) return; // a frame changed the coordinates, not the position
    // The tool change moved Z, with the length of the tool before.
    if (execution.statement.of(ModalGroup::tool_change) && !execution.statement.word('Z')) return;
    const int tool = modal.tool ? core::value_of(*modal.tool) : 0;
    const SourceSpan where = moving_word(execution).span;
    const std::string cure = memory.g43_lacks_h
                                 ? fmt::format("Add H{} to the block with G43 or G44.", tool)
                                 : fmt::format("Add G43 H{} before the first Z move.", tool);
    if (memory.lacks_length && modal.length_sign != 0.0 && modal.length_number)
        advise(execution, where, core::rule_id("missing-length-offset"),
               fmt::format("tool {} is in the spindle, but H{}, the length offset of another tool, "
                           "is still active",
                           tool, core::value_of(*modal.length_number)),
               cure);
    else if (memory.lacks_length)
        advise(execution, where, core::rule_id("missing-length-offset"),
               fmt::format("tool {} moves in Z without a length offset{}: Z refers to the gauge "
                           "line, not to the tip",
                           tool, memory.g43_lacks_h ? ", because G43 or G44 has no H" : ""),
               cure);
    else if (before.position[2] && modal.position[2] < before.position[2])
        advise(execution, where, core::rule_id("length-offset-cancelled"),
               fmt::format("tool {} moves down after its length offset was cancelled{}", tool,
                           modal.length_sign != 0.0 ? " by a move to machine coordinates" : ""),
               cure);
    else
        return; // moves up after G49
    memory.lacks_length = memory.length_cancelled = false;
}

void check_work_offset(Execution& execution) {
    RuleState& memory = execution.state.rules;
    if (execution.statement.of(ModalGroup::work_offset)) memory.offset_is_fresh = true;
    if (!memory.offset_is_fresh || !moves(execution) || moves_in_machine_coordinates(execution))
        return;
    memory.offset_is_fresh = false;
    const Tables& tables = *execution.state.tables;
    const size_t active = execution.modal().offsets.active;
    const WorkOffset unset{};
    if (execution.modal().offsets.work != unset || active >= plain_offset_count) return;
    for (size_t other = 0; other < plain_offset_count; ++other) {
        if (tables.work[other] == unset) continue;
        const auto name = [](size_t index) {
            return index < 6 ? fmt::format("G{}", 54 + index) : fmt::format("G59.{}", index - 5);
        };
        advise(execution, moving_word(execution).span, core::rule_id("work-offset-unset"),
               fmt::format("{} is active but has never been set, while {} is set", name(active),
                           name(other)),
               fmt::format("Set {}, or use the work offset the job was set up in.", name(active)));
        return;
    }
}

void check_increments(Execution& execution) {
    RuleState& memory = execution.state.rules;
    if (!memory.increments_stay) return;
    if (execution.modal().distance == DistanceMode::absolute) memory.increments_stay = false;
    if (!memory.increments_stay || !moves(execution) || moves_in_machine_coordinates(execution))
        return;
    memory.increments_stay = false;
    advise(execution, moving_word(execution).span, core::rule_id("incremental-left-on"),
           "the first move of this tool is incremental: G91 has been active since before the tool "
           "change",
           "Add G90 after the tool change.");
}

void check_machine_moves(Execution& execution, const ModalState& before) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    if (!action || !moves(execution)) return;
    const ModalState& modal = execution.modal();
    if (is_machine_move(action->code->number)) {
        std::string on = left_over(modal, false);
        if (modal.distance == DistanceMode::incremental)
            on += fmt::format("{}G91", on.empty() ? "" : ", ");
        if (!on.empty())
            advise(execution, action->word->span, core::rule_id("machine-move-with-state"),
                   fmt::format("{}: move in machine coordinates while active: {}",
                               written(*action->word), on),
                   "Cancel it before G53.");
        return;
    }
    const bool homes = action->code->number == g_code(28) || action->code->number == g_code(30);
    const Word* word = execution.statement.word('Z');
    if (!homes || !word || modal.distance == DistanceMode::incremental) return;
    const auto* between = std::get_if<StraightTraverse>(&execution.result.commands.front());
    if (!between || !between->end[2]) return;
    const std::optional<double>& from = before.position[2];
    if (from ? *between->end[2] >= *from : *between->end[2] > 0.0) return;
    advise(execution, action->word->span, core::rule_id("home-through-part"),
           fmt::format(
               "{} {}: with G90 the move to home first goes down to Z{:.3f} in work coordinates",
               written(*action->word), written(*word), *between->end[2]),
           "Use G91 G28 Z0, or G53 with a position in machine coordinates.");
}

void check_units(Execution& execution, const ModalState& before) {
    const CodeWord* entry = execution.statement.of(ModalGroup::units);
    if (!entry || !execution.state.rules.has_moved || execution.modal().unit == before.unit) return;
    advise(execution, entry->word->span, core::rule_id("units-jump"),
           fmt::format("{}: the units change in the middle of the program: from here on the same "
                       "numbers are 25.4 times as {}",
                       written(*entry->word),
                       execution.modal().unit == LengthUnit::inch ? "long" : "short"),
           "Use one unit throughout the program.");
}

void check_end(Execution& execution) {
    if (!has_code(execution, ModalGroup::stopping, m_code(2))
        && !has_code(execution, ModalGroup::stopping, m_code(30)))
        return;
    const std::string on = left_over(execution.modal(), true);
    if (on.empty()) return;
    advise(
        execution, execution.statement.of(ModalGroup::stopping)->word->span,
        core::rule_id("state-left-over"),
        fmt::format(
            "still active at the end of the program: {}; the next program may start with it", on),
        "Cancel it before the end.");
}

void check_block_delete(Execution& execution) {
    RuleState& memory = execution.state.rules;
    const bool switched = execution.block.block_delete || execution.block.words_before_slash;
    if (!switched || memory.said_block_delete) return;
    memory.said_block_delete = true;
    if (execution.dialect.block_delete == BlockDelete::none) {
        if (execution.environment.block_delete)
            execution.warn({.line = execution.block.line, .column = 1},
                           "block delete has no effect: the control does not have it and runs the "
                           "blocks with '/'");
        return;
    }
    advise(
        execution, {.line = execution.block.line, .column = 1}, core::rule_id("block-delete"),
        "blocks with '/' are run here; with block delete on at the machine, the path is different",
        "Also check the program with --block-delete on.", Severity::note);
}

} // namespace

void check_modal_rules(Execution& execution, const ModalState& before) {
    RuleState& memory = execution.state.rules;
    check_block_delete(execution);
    if (execution.statement.code_count > 0) {
        check_tool_change(execution, before);
        check_length_codes(execution);
        check_machine_moves(execution, before);
        check_units(execution, before);
        check_end(execution);
    }
    if (memory.waits() || execution.statement.of(ModalGroup::work_offset)) {
        check_length(execution, before);
        check_work_offset(execution);
        check_increments(execution);
    }
    memory.has_moved = memory.has_moved || moves(execution);
}

} // namespace gcode
