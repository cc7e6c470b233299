#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "gcode/cycles/cycles.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/rules.h"
#include "gcode/iso/iso.h"
#include "gcode/iso/plain_words.h"
#include "gcode/language/flow_index.h"
#include "gcode/language/language.h"

namespace gcode {

const LanguageFunctions iso_language = {.parse = parse_iso,
                                        .index = iso_index,
                                        .execute = execute_iso,
                                        .run_flow = run_iso_flow,
                                        .read_plain = read_plain_words};

namespace {

constexpr uint64_t groups(std::initializer_list<ModalGroup> these) {
    uint64_t bits = 0;
    for (const ModalGroup group : these) bits |= uint64_t{1} << static_cast<unsigned>(group);
    return bits;
}

/// The step for one kind of word. It runs only if the block has one of its groups or letters. A
/// step with neither always runs, or when the state requires it.
struct ExecutionStep {
    core::Result<void> (*take)(Execution&);
    uint64_t groups = 0;
    uint32_t letters = 0;
    bool (*is_due)(const Execution&) = nullptr;

    constexpr bool concerns_all() const { return groups == 0 && letters == 0; }
    bool concerns(const Execution& execution) const {
        if (concerns_all()) return !is_due || is_due(execution);
        return (groups & execution.statement.groups) || (letters & execution.statement.letters);
    }
};

bool lacks_units(const Execution& execution) {
    return !execution.modal().unit_said && !execution.state.said_unit;
}

bool has_comments(const Execution& execution) { return !execution.block.comments.empty(); }

bool has_left_length(const Execution& execution) {
    return execution.modal().length_left.has_value();
}

bool is_compensated(const Execution& execution) {
    return execution.modal().compensation != Side::none
           || execution.statement.of(ModalGroup::cutter_radius);
}

bool may_call(const Execution& execution) {
    return !execution.state.modal_macros.empty() || execution.statement.of(ModalGroup::subprogram)
           || execution.statement.of(ModalGroup::macro);
}

using enum ModalGroup;

// NISTIR 6556, table 8: the order in which the words of a block take effect, regardless of how they
// are written. The distance mode comes earlier than there: where a change of the length offset
// moves Z, it depends on the mode of the block.
constexpr ExecutionStep execution_steps[] = {
    {check_words},
    {check_axis_commands, 0, 0, has_axis_commands},
    {note_assumed_units, 0, 0, lacks_units},
    {say_message, 0, 0, has_comments},
    {set_feed_mode, groups({feed_mode})},
    {set_feed, 0, letter_bits("F")},
    {set_speed, 0, letter_bits("S")},
    {set_spindle_mode, groups({spindle_mode})},
    {select_tool, 0, letter_bits("T")},
    {switch_machine, groups({other})},
    {change_tool, groups({tool_change})},
    {turn_spindle, groups({spindle})},
    {save_or_restore_modes, groups({other})},
    {set_coolant, groups({coolant})},
    {set_overrides, groups({overrides})},
    {dwell, groups({action})},
    {select_plane, groups({plane})},
    {set_units, groups({units})},
    {set_diameter_mode, groups({diameter})},
    {set_cutter_radius, 0, 0, is_compensated},
    {set_distance_mode, groups({distance, arc_distance})},
    {take_length_up, 0, 0, has_left_length},
    {set_tool_length, groups({tool_length}), letter_bits("H")},
    {select_offset, groups({work_offset})},
    {set_path_mode, groups({path_control})},
    {set_retract_mode, groups({retract})},
    {set_frame, groups({mirror, scaling, rotation, polar, other})},
    {act, groups({action})},
    {move},
    {clear_offset_after_move, groups({action})},
    {ask_for_corner, 0, corner_bit},
    {stop, groups({stopping})},
    {call, 0, 0, may_call},
};

constexpr uint64_t groups_of_steps = [] {
    uint64_t bits = 0;
    for (const ExecutionStep& step : execution_steps) bits |= step.groups;
    return bits;
}();

constexpr uint32_t letters_of_steps = [] {
    uint32_t bits = 0;
    for (const ExecutionStep& step : execution_steps) bits |= step.letters;
    return bits;
}();

constexpr size_t steps_for_all =
    std::count_if(std::begin(execution_steps), std::end(execution_steps),
                  [](const ExecutionStep& step) { return step.concerns_all(); });

/// The steps for a block with moves only.
constexpr std::array<ExecutionStep, steps_for_all> steps_of_moves = [] {
    std::array<ExecutionStep, steps_for_all> found{};
    std::copy_if(std::begin(execution_steps), std::end(execution_steps), found.begin(),
                 [](const ExecutionStep& step) { return step.concerns_all(); });
    return found;
}();

} // namespace

namespace {

/// G290 after G291: the program continues in the Siemens language.
core::Result<void> leave_iso(Execution& execution) {
    if (!execution.statement.of(ModalGroup::other)) return {};
    for (const CodeWord& entry : execution.statement.codes())
        if (entry.code->number == g_code(290)) execution.state.is_iso_mode = false;
    return {};
}

core::Result<void> take_steps(Execution& execution) {
    const Statement& statement = execution.statement;
    const bool only_moves =
        !(statement.groups & groups_of_steps) && !(statement.letters & letters_of_steps);
    const std::span<const ExecutionStep> wanted =
        only_moves ? std::span<const ExecutionStep>(steps_of_moves) : execution_steps;
    for (const ExecutionStep& step : wanted)
        if (step.concerns(execution))
            if (auto done = step.take(execution); !done) return done;
    return {};
}

} // namespace

core::Result<void> execute_iso(Execution& execution, const ModalState& before) {
    if (auto taken = take_steps(execution); !taken) return taken;
    check_modal_rules(execution, before);
    return execution.state.is_iso_mode ? leave_iso(execution) : core::Result<void>{};
}

core::Result<void> act(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    if (!entry) return {};
    switch (entry->code->number) {
    case g_code(10):
        return write_offset(execution);
    case g_code(12):
    case g_code(13):
        return mill_circular_pocket(execution);
    case g_code(22):
        return forbid_area(execution);
    case g_code(35):
    case g_code(36):
    case g_code(136):
        return measure(execution);
    case g_code(174):
    case g_code(184):
        return tap_to_point(execution);
    case g_code(27):
        return check_home(execution);
    case g_code(29):
        return return_from_home(execution);
    case g_code(60):
        return move_one_way(execution);
    case g_code(31):
        return skip_move(execution);
    case g_code(70):
    case g_code(71):
    case g_code(72):
        return run_hole_pattern(execution);
    case g_code(28):
    case g_code(30):
        return go_home(execution);
    case g_code(28, 1):
    case g_code(30, 1):
        return store_home(execution);
    case g_code(52):
        return set_local_offset(execution);
    case g_code(92, 1):
        return execution.dialect.clears_offset_after_move ? core::Result<void>{}
                                                          : set_axis_offset(execution);
    case g_code(92):
    case g_code(92, 2):
    case g_code(92, 3):
        return set_axis_offset(execution);
    default:
        return {}; // G4 and G53 have steps of their own
    }
}

core::Result<void> clear_offset_after_move(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    const bool clears = entry && entry->code->number == g_code(92, 1);
    if (!clears || !execution.dialect.clears_offset_after_move) return {};
    return set_axis_offset(execution);
}

} // namespace gcode
