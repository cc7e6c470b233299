#include <algorithm>

#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr std::string_view letters_that_need_a_code = "DEHIJKLPQR";
constexpr uint32_t bits_that_need_a_code = letter_bits(letters_that_need_a_code);
constexpr std::string_view letters_of_lengths = "XYZIJKF"; // Q and R are often none

/// The code of the motion or cycle that a block without one goes on with.
const Code* going_on(const Execution& execution) {
    const ModalState& modal = execution.modal();
    if (modal.cycle) return find_code('G', modal.cycle->code / 10.0, execution.dialect.id);
    if (modal.motion) return find_code('G', *modal.motion / 10.0, execution.dialect.id);
    return nullptr;
}

/// G30 P2, the place that G30 means by itself.
bool names_second_home(const Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const Word* place = execution.statement.word('P');
    return execution.dialect.p_names_more_places && action && action->code->tenths == tenths(30)
           && place && place->value == 2.0;
}

/// A P that makes G30 a place that nobody told.
core::Result<void> refuse_unknown_home(const Execution& execution) {
    const Statement& statement = execution.statement;
    const Word* place = statement.word('P');
    if (!place || !execution.dialect.p_names_more_places) return {};
    const CodeWord* action = statement.of(ModalGroup::action);
    if (action && action->code->tenths == tenths(30) && !names_second_home(execution))
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: G30 knows the second reference position only: go to "
                                      "another one with G53",
                                      written(*place)),
                          place->span);
    return {};
}

/// G54 P3, which is G54.1 P3. A P that another code of the block wants is that one's.
bool names_extended_offset(const Execution& execution) {
    const CodeWord* offset = execution.statement.of(ModalGroup::work_offset);
    return execution.dialect.has_extended_offsets && offset && offset->code->tenths == tenths(54);
}

bool is_used(const Execution& execution, char letter) {
    const Statement& statement = execution.statement;
    if (!statement.unknown_m_codes.empty()) return true;
    if (letter == 'H' && changes_length_alone(execution)) return true;
    if (letter == 'P' && names_extended_offset(execution)) return true;
    if (execution.modal().transforms.follows_vectors && letter >= 'I' && letter <= 'K') return true;
    if (letter == 'P' && names_second_home(execution)) return true;
    const auto uses = [&](const CodeWord& entry) { return entry.code->uses(letter); };
    if (std::any_of(statement.codes().begin(), statement.codes().end(), uses)) return true;
    if (statement.of(ModalGroup::motion) || statement.of(ModalGroup::cycle)) return false;
    const Code* modal = going_on(execution);
    return modal && modal->uses(letter);
}

core::Result<void> check_word(Execution& execution, const Word& word) {
    if (is_used(execution, word.letter)) return {};
    const bool exponent = word.letter == 'E'; // of a number, most likely
    const std::string message =
        fmt::format("{}: nothing in this block uses it{}", written(word),
                    exponent ? "; an exponent such as 1E3 is written out, and the extruder of a "
                               "3D printer is none of a milling machine's"
                             : "");
    if (exponent || execution.dialect.unused_words_are_errors)
        return core::fail(ErrorCode::syntax, message, word.span);
    execution.warn(word.span, message);
    return {};
}

} // namespace

double length_of(const Execution& execution, const Word& word) {
    return to_mm(word.value, execution.modal().unit);
}

core::Result<void> check_words(Execution& execution) {
    if (auto checked = refuse_unknown_home(execution); !checked) return checked;
    for (const Word* word : execution.statement.unknown_m_codes)
        execution.warn(word->span, fmt::format("{}: unknown here, so a code of the machine's "
                                               "builder; it is passed over",
                                               written(*word)));
    if (!(execution.statement.letters & bits_that_need_a_code)) return {};
    for (const char letter : letters_that_need_a_code)
        if (const Word* word = execution.statement.word(letter))
            if (auto checked = check_word(execution, *word); !checked) return checked;
    return {};
}

core::Result<void> note_assumed_units(Execution& execution) {
    if (execution.modal().unit_said || execution.state.said_unit
        || execution.statement.of(ModalGroup::units) || execution.statement.of(ModalGroup::macro))
        return {};
    for (const Word& word : execution.block.words) {
        if (letters_of_lengths.find(word.letter) == std::string_view::npos) continue;
        const bool inch = execution.modal().unit == LengthUnit::inch;
        execution.state.said_unit = true;
        execution.warn(word.span,
                       fmt::format("units not said (G20 or G21) before {}, taken as {}",
                                   written(word), inch ? "inches" : "millimetres"),
                       Severity::note);
        return {};
    }
    return {};
}

} // namespace gcode
