#include <numbers>

#include <fmt/format.h>

#include "core/base/units.h"
#include "gcode/cycles/cycles.h"
#include "gcode/cycles/threading.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// Passes run at the programmed feed. Afterwards the control leaves the override on, even if M49 or
/// M50 had switched it off.
void enable_feed_override(Execution& execution, bool enabled) {
    execution.emit(EnableOverride{OverrideKind::feed, enabled});
}

core::Result<void> check_thread(const Execution& execution) {
    const ModalState& modal = execution.modal();
    const core::SourceSpan where = moving_word(execution).span;
    if (!execution.statement.has_axis_word())
        return core::fail(ErrorCode::missing_value,
                          "G76 has no axis word: it needs Z, the end of the thread", where);
    for (const char letter : {'A', 'B', 'C'})
        if (const Word* word = execution.statement.word(letter))
            return core::fail(
                ErrorCode::syntax,
                fmt::format("{}: G76 does not move rotary axes: move {} in an earlier block",
                            written(*word), letter),
                word->span);
    if (modal.compensation != Side::none)
        return core::fail(ErrorCode::syntax,
                          "G76: no threading is allowed while cutter radius compensation is on: "
                          "cancel it with G40 first",
                          where);
    if (modal.spindle == core::SpindleDirection::stopped)
        return core::fail(ErrorCode::missing_value,
                          "G76: the spindle is stopped: start it with M3 or M4 first", where);
    if (!modal.position[0] || !modal.position[2])
        return core::fail(ErrorCode::missing_value,
                          "G76: the start position is unknown: move X and Z first, or set "
                          "[program] start in the set-up",
                          where);
    return {};
}

core::Result<ThreadingWords> words_of(const Execution& execution) {
    const Statement& statement = execution.statement;
    // A word with the value -1 counts as missing.
    const auto value = [&](char letter) -> std::optional<double> {
        const Word* word = statement.word(letter);
        return word && word->value != -1.0 ? std::optional(word->value) : std::nullopt;
    };
    const double scale = execution.modal().diameter_mode ? 0.5 : 1.0;
    const auto height = [&](char letter) -> std::optional<double> {
        const Word* word = statement.word(letter);
        return word ? std::optional(scale * length_of(execution, *word)) : std::nullopt;
    };
    ThreadingWords words;
    words.i = height('I'), words.j = height('J'), words.k = height('K');
    if (value('P')) words.pitch = length_of(execution, *statement.word('P'));
    words.degression = value('R').value_or(words.degression);
    words.compound_angle = value('Q').value_or(0.0) * core::radians_per_degree;
    if (value('E')) words.taper_length = length_of(execution, *statement.word('E'));
    if (const Word* word = statement.word('H')) {
        FEELER_TRY(words.spring_passes, whole_number(*word, -1));
    }
    if (const Word* word = statement.word('L')) {
        FEELER_TRY(words.tapered_ends, whole_number(*word));
    }
    return words;
}

void emit_moves(Execution& execution, const std::vector<ThreadingMove>& moves,
                const Position& last) {
    ModalState& modal = execution.modal();
    bool threads = false;
    for (size_t i = 0; i < moves.size(); ++i) {
        const ThreadingMove& move = moves[i];
        Position end = i + 1 == moves.size() ? last : modal.position;
        end[0] = move.end.x, end[2] = move.end.z;
        const bool threaded = threads;
        threads = move.pitch.has_value();
        if (!threads) {
            execution.traverse(end);
            if (threaded) enable_feed_override(execution, true);
        } else {
            if (!threaded) enable_feed_override(execution, false);
            execution.emit(ThreadFeed{end, *move.pitch, false});
            modal.position = end;
        }
    }
}

} // namespace

core::Result<void> cut_thread(Execution& execution) {
    if (auto checked = check_thread(execution); !checked) return checked;
    const Position& from = execution.modal().position;
    FEELER_TRY(const ThreadingWords words, words_of(execution));
    FEELER_TRY(const Position last, target_of(execution));
    FEELER_TRY(const std::vector<ThreadingMove> moves,
               placed(threading_moves({*from[0], *from[2]}, {*last[0], *last[2]}, words),
                      moving_word(execution).span));
    execution.result.is_cycle = true;
    emit_moves(execution, moves, last);
    return {};
}

} // namespace gcode
