#include "gcode/decimal_points.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/statement.h"

namespace gcode {
namespace {

template <typename Wanted>
bool has_code(const Block& block, char letter, Wanted wanted) {
    return std::any_of(block.words.begin(), block.words.end(), [&](const Word& word) {
        return word.letter == letter && !word.expression && wanted(word.value);
    });
}

/// Whether X, Y, Z, I and J of a block are something else than lengths.
bool has_other_meanings(const Block& block) {
    return has_code(block, 'G', [](double code) {
        return code == 4.0 || code == 10.0 || code == 65.0 || code == 66.0 || code == 66.1;
    });
}

bool is_cycle(double code) { return code >= 73.0 && code <= 89.0 && code != 80.0; }

} // namespace

void note_points(const Block& block, InterpreterState& state, BlockResult& result) {
    DecimalPoints& points = state.points;
    if (points.said || has_other_meanings(block)) return;
    for (const Word& word : block.words) {
        const bool is_length =
            std::string_view("XYZIJ").find(word.letter) != std::string_view::npos;
        if (!is_length || word.expression || word.value == 0.0) continue;
        (word.has_point ? points.present : points.missing) = true;
        if (!points.present || !points.missing) continue;
        points.said = true;
        result.warnings.push_back(
            {Severity::warning, word.span,
             fmt::format("{} has {} decimal point, lengths before it have {}: those without one "
                         "are taken as whole units; a control set to count its smallest steps "
                         "makes them a thousandth or less",
                         written(word), word.has_point ? "a" : "no",
                         word.has_point ? "none" : "one"),
             "missing-decimal-point", "Write every length with a decimal point."});
        return;
    }
}

void count_smallest_steps(Block& block, const ModalState& modal) {
    const bool waits = has_code(block, 'G', [](double code) { return code == 4.0; });
    if (waits) return; // X is a time, and counts milliseconds anyway
    const bool to_inch = has_code(block, 'G', [](double code) { return code == 20.0; });
    const bool to_mm = has_code(block, 'G', [](double code) { return code == 21.0; });
    const bool inch = to_inch || (modal.unit == LengthUnit::inch && !to_mm);
    const bool cycle = modal.cycle || has_code(block, 'G', is_cycle);
    const bool calls = has_code(block, 'M', [](double code) { return code >= 96.0; });
    const bool turns = has_code(block, 'G', [](double code) { return code == 68.0; });
    for (Word& word : block.words) {
        if (word.has_point || word.expression) continue;
        if (std::string_view("XYZABCUVWIJKRQrc").find(word.letter) == std::string_view::npos)
            continue;
        if ((word.letter == 'K' && cycle) || (word.letter == 'Q' && calls)) continue;
        const bool angle =
            (word.letter >= 'A' && word.letter <= 'C') || (word.letter == 'R' && turns);
        word.value /= inch && !angle ? 10000.0 : 1000.0;
    }
}

} // namespace gcode
