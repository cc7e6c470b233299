#include <cmath>

#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr char linear_letters[] = {'X', 'Y', 'Z'};
constexpr char rotary_letters[] = {'A', 'B', 'C'};

bool in_machine_coordinates(const Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    return action && action->code->tenths == tenths(53);
}

/// The angles of the words, which must be those where the axes already are.
core::Result<void> check_rotary_axes(const Execution& execution) {
    const ModalState& modal = execution.modal();
    for (size_t axis = 0; axis < 3; ++axis) {
        const Word* word = execution.statement.word(rotary_letters[axis]);
        if (!word) continue;
        const bool absolute = modal.distance == DistanceMode::absolute;
        const double target = absolute ? word->value : modal.rotary[axis] + word->value;
        if (target != modal.rotary[axis])
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{}: rotary axes are not supported yet", written(*word)),
                              word->span);
    }
    return {};
}

std::optional<MotionMode> motion_of(const CodeWord* entry) {
    if (!entry) return std::nullopt;
    return static_cast<MotionMode>(entry->code->tenths / 10); // G0 to G3
}

std::optional<double> distance_between(const Position& from, const Position& to) {
    double squared = 0.0;
    for (size_t axis = 0; axis < 3; ++axis) {
        if (from[axis] == to[axis]) continue;
        if (!from[axis] || !to[axis]) return std::nullopt;
        squared += (*to[axis] - *from[axis]) * (*to[axis] - *from[axis]);
    }
    return std::sqrt(squared);
}

core::Result<void> move_straight(Execution& execution, bool rapid) {
    FEELER_TRY(const Position end, target_of(execution));
    if (rapid) {
        execution.traverse(end);
        return {};
    }
    FEELER_TRY(const double rate,
               feed_rate(execution, distance_between(execution.modal().position, end)));
    execution.feed(end, rate);
    return {};
}

/// Whether the block has words that make the active motion move.
bool has_motion_words(const Execution& execution) {
    const Statement& statement = execution.statement;
    if (statement.taker_of_axis_words()) return false;
    if (statement.has_axis_word()) return true;
    const ModalState& modal = execution.modal();
    const bool arc = !modal.cycle
                     && (modal.motion == MotionMode::arc_clockwise
                         || modal.motion == MotionMode::arc_counterclockwise);
    return arc && (statement.word('I') || statement.word('J') || statement.word('K'));
}

/// G0 to G3 and the cycles become modal, even when another code takes the axis words.
core::Result<void> set_motion_mode(Execution& execution) {
    const Statement& statement = execution.statement;
    ModalState& modal = execution.modal();
    const CodeWord* taker = statement.taker_of_axis_words();
    const CodeWord* cycle = statement.of(ModalGroup::cycle);
    const std::optional<MotionMode> motion = motion_of(statement.of(ModalGroup::motion));
    const CodeWord* mover =
        cycle && cycle->code->uses_axes() ? cycle : statement.of(ModalGroup::motion);
    const bool homes = taker && taker->code->tenths != tenths(4) && statement.has_axis_word();
    if (mover && homes && execution.dialect.axis_words_serve_one_code)
        return core::fail(ErrorCode::syntax,
                          fmt::format("{} and {} both want the axis words of this block: write two "
                                      "blocks",
                                      written(*taker->word), written(*mover->word)),
                          mover->word->span);
    if (motion) {
        modal.motion = motion;
        modal.cycle.reset();
    }
    if (!cycle) return {};
    if (execution.dialect.cycles_are_motions && !motion) modal.motion.reset();
    if (cycle->code->tenths == tenths(80)) {
        modal.cycle.reset();
        return {};
    }
    if (!modal.cycle) modal.cycle = CannedCycle{};
    modal.cycle->code = cycle->code->tenths;
    return {};
}

core::Result<void> refuse_without_mode(const Execution& execution) {
    for (const Word& word : execution.block.words)
        if (std::string_view("XYZABC").find(word.letter) != std::string_view::npos)
            return core::fail(
                ErrorCode::missing_value,
                fmt::format("{}: no motion code is active; say G0, G1, G2 or G3", written(word)),
                word.span);
    return {};
}

/// RS274/NGC 3.5.14: G53 is for this block, and goes with G0 and G1 only. On Fanuc controls it is a
/// rapid whatever the motion code, and under G91 it is passed over.
core::Result<void> move_to_machine_place(Execution& execution) {
    ModalState& modal = execution.modal();
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const bool incremental = modal.distance == DistanceMode::incremental;
    if (execution.dialect.machine_move_needs_g90 && incremental)
        return core::fail(ErrorCode::unsupported,
                          "G53 under G91 is not the same on all controls of this kind: say G90",
                          action->word->span);
    if (execution.dialect.machine_move_is_rapid) return move_straight(execution, true);
    const bool straight = modal.motion == MotionMode::traverse || modal.motion == MotionMode::feed;
    if (modal.cycle || !straight)
        return core::fail(ErrorCode::syntax, "G53 needs G0 or G1", action->word->span);
    return move_straight(execution, modal.motion == MotionMode::traverse);
}

} // namespace

void Execution::traverse(const Position& end) {
    modal().position = end;
    emit(StraightTraverse{end});
}

void Execution::feed(const Position& end, double rate) {
    modal().position = end;
    emit(StraightFeed{end, rate});
}

const Word& moving_word(const Execution& execution) {
    const Statement& statement = execution.statement;
    for (const ModalGroup group : {ModalGroup::cycle, ModalGroup::motion})
        if (const CodeWord* entry = statement.of(group)) return *entry->word;
    for (const Word& word : execution.block.words)
        if (std::string_view("XYZABCIJK").find(word.letter) != std::string_view::npos) return word;
    return execution.block.words.front();
}

core::Result<Position> target_of(const Execution& execution) {
    if (auto checked = check_rotary_axes(execution); !checked)
        return tl::unexpected(std::move(checked).error());
    const ModalState& modal = execution.modal();
    const bool machine = in_machine_coordinates(execution);
    const Position to_machine = machine_minus_program(modal.offsets);
    Position target = modal.position;
    for (size_t axis = 0; axis < 3; ++axis) {
        const Word* word = execution.statement.word(linear_letters[axis]);
        if (!word) continue;
        const double length = length_of(execution, *word);
        if (machine)
            target[axis] =
                to_machine[axis] ? std::optional(length - *to_machine[axis]) : std::nullopt;
        else if (modal.distance == DistanceMode::absolute)
            target[axis] = length;
        else if (target[axis])
            *target[axis] += length;
    }
    return target;
}

core::Result<double> feed_rate(const Execution& execution, std::optional<double> path_length) {
    const ModalState& modal = execution.modal();
    const Word& mover = moving_word(execution);
    const auto refuse = [&](std::string_view why) {
        return core::fail(ErrorCode::missing_value, fmt::format("{}: {}", written(mover), why),
                          mover.span);
    };
    const bool inverse = modal.feed_mode == FeedMode::inverse_time;
    if (inverse && !execution.statement.word('F'))
        return refuse("under G93 every feed needs its own F word");
    if (!modal.feed) return refuse("this motion has no feed rate, no F word came before it");
    if (*modal.feed == 0.0) return refuse("this motion has the feed rate F0");
    if (modal.feed_mode == FeedMode::per_minute) return *modal.feed;
    if (inverse && !path_length)
        return refuse("G93 gives no feed rate here, where the motion starts is unknown");
    if (inverse) return *modal.feed * *path_length;
    if (modal.spindle == core::SpindleDirection::stopped || modal.speed == 0.0)
        return refuse("G95 gives no feed rate here, the spindle does not turn");
    return *modal.feed * modal.speed;
}

core::Result<void> move(Execution& execution) {
    if (auto set = set_motion_mode(execution); !set) return set;
    const bool cycle_words = execution.statement.of(ModalGroup::cycle) && execution.modal().cycle;
    if (!has_motion_words(execution) && !cycle_words) return {};
    const ModalState& modal = execution.modal();
    if (in_machine_coordinates(execution)) return move_to_machine_place(execution);
    if (modal.cycle) return run_canned_cycle(execution);
    if (!modal.motion) return refuse_without_mode(execution);
    const bool straight = modal.motion == MotionMode::traverse || modal.motion == MotionMode::feed;
    if (straight) return move_straight(execution, modal.motion == MotionMode::traverse);
    return move_along_arc(execution);
}

} // namespace gcode
