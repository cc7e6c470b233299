#include <fmt/format.h>

#include "gcode/cycles.h"

namespace gcode {
namespace {

using core::ErrorCode;

core::Result<double> needed(const Execution& execution, const CodeWord& entry, char letter,
                            bool is_length) {
    if (const Word* word = execution.statement.word(letter))
        return is_length ? length_of(execution, *word) : word->value;
    return core::fail(ErrorCode::missing_value,
                      fmt::format("{} needs {} word", written(*entry.word),
                                  letter == 'I' || letter == 'L' ? fmt::format("an {}", letter)
                                                                 : fmt::format("a {}", letter)),
                      entry.word->span);
}

/// From a place in a direction.
Position placed(const Position& from, const PlaneAxes& axes, double distance, double degrees) {
    const core::Mat3 turn = turned_about(2, degrees);
    Position place = from;
    if (place[axes.first]) *place[axes.first] += distance * turn[0][0];
    if (place[axes.second]) *place[axes.second] += distance * turn[0][1];
    return place;
}

} // namespace

const CodeWord* hole_pattern(const Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    const bool is_pattern =
        entry && entry->code->tenths >= tenths(70) && entry->code->tenths <= tenths(72);
    return is_pattern ? entry : nullptr;
}

core::Result<std::vector<Position>> holes_of_pattern(const Execution& execution,
                                                     const CodeWord& entry, const Position& start) {
    FEELER_TRY(const double length, needed(execution, entry, 'I', true));
    if (auto said = needed(execution, entry, 'L', false); !said)
        return tl::unexpected(std::move(said).error());
    FEELER_TRY(const int count, whole_number(*execution.statement.word('L'), 1, 1000));
    const Word* angle = execution.statement.word('J');
    const double first = angle ? angle->value : 0.0;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    double step = 360.0 / count;
    if (entry.code->tenths == tenths(71)) {
        FEELER_TRY(step, needed(execution, entry, 'K', false));
    }
    std::vector<Position> holes;
    for (int i = 0; i < count; ++i)
        holes.push_back(entry.code->tenths == tenths(72)
                            ? placed(start, axes, i * length, first)
                            : placed(start, axes, length, first + i * step));
    return holes;
}

core::Result<void> run_hole_pattern(Execution& execution) {
    const CodeWord& entry = *hole_pattern(execution);
    if (execution.statement.of(ModalGroup::cycle)) return {}; // drilled where the cycle is run
    if (!execution.modal().cycle)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} has no cycle to drill its holes with: write one such as "
                                      "G81 with L0 before it",
                                      written(*entry.word)),
                          entry.word->span);
    return run_canned_cycle(execution);
}

} // namespace gcode
