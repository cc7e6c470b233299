#include <fmt/format.h>

#include "gcode/iso/iso.h"

namespace gcode {
namespace {

using core::ErrorCode;

core::Result<void> refuse_line(const Word& word, ErrorCode code, std::string_view why, int error) {
    return core::fail(
        code,
        fmt::format("{}: {}; Grbl does not run this line (error {})", written(word), why, error),
        word.span);
}

bool is_axis_command(CodeNumber code) {
    switch (code) {
    case g_code(10):
    case g_code(28):
    case g_code(30):
    case g_code(43, 1):
    case g_code(49):
    case g_code(92):
        return true;
    default:
        return motion_of(code).has_value();
    }
}

bool needs_axis_words(CodeNumber code) {
    const std::optional<MotionCode> motion = motion_of(code);
    return code == g_code(10) || code == g_code(92) || (motion && !is_straight(motion));
}

/// The axis word that is written first; null if there is none.
const Word* first_axis_word(const Execution& execution) {
    for (const Word& word : execution.block.words)
        if (axis_letters.find(word.letter) != std::string_view::npos) return &word;
    return nullptr;
}

/// Whether G80 is active in this block.
bool is_motion_cancelled(const Execution& execution) {
    if (execution.statement.of(ModalGroup::cycle)) return true;
    return !execution.statement.of(ModalGroup::motion) && execution.modal().motion_cancelled;
}

} // namespace

bool has_axis_commands(const Execution& execution) { return execution.dialect.has_axis_commands; }

core::Result<void> check_axis_commands(Execution& execution) {
    const Statement& statement = execution.statement;
    const CodeWord* command = nullptr;
    for (const CodeWord& entry : statement.codes()) {
        if (!is_axis_command(entry.code->number)) continue;
        if (command)
            return refuse_line(*entry.word, ErrorCode::syntax,
                               fmt::format("{} in the same block is a command for the axes, too",
                                           written(*command->word)),
                               24);
        command = &entry;
    }
    const Word* axis = first_axis_word(execution);
    if (command && command->code->number == g_code(43, 1)
        && (statement.letters & axis_letter_bits) != letter_bit('Z'))
        return refuse_line(*command->word, ErrorCode::syntax, "it takes Z and no other axis word",
                           37);
    if (axis && is_motion_cancelled(execution))
        return refuse_line(*axis, ErrorCode::missing_value,
                           "an axis word while G80 is active: program G0 or G1 first", 31);
    if (command && !axis && needs_axis_words(command->code->number))
        return refuse_line(*command->word, ErrorCode::missing_value, "it has no axis word", 26);
    return {};
}

core::Result<void> check_end_of_arc(const Execution& execution) {
    if (!execution.dialect.has_axis_commands) return {};
    const Statement& statement = execution.statement;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const char first = axis_letters[axes.first], second = axis_letters[axes.second];
    if (statement.word(first) || statement.word(second)) return {};
    return refuse_line(moving_word(execution), ErrorCode::missing_value,
                       fmt::format("an arc needs {} or {}, also for a full circle", first, second),
                       statement.has_axis_word() ? 32 : 36);
}

} // namespace gcode
