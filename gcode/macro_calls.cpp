#include "gcode/macro_calls.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/canonical.h"
#include "gcode/execution.h"
#include "gcode/flow.h"
#include "gcode/subprogram.h"

namespace gcode {
namespace {

using core::ErrorCode;

// Fanuc B-64304, argument specification I, for A to Z. G, L, N, O and P have the places that are
// left, which G66.1 and the variables of the block before (#4101 and on) use.
constexpr size_t numbers[26] = {1,  2,  3,  7,  8,  9,  10, 11, 4,  5,  6,  12, 13,
                                14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26};

constexpr int most_offset_sets = 10;

bool is_offset(char letter) { return letter >= 'I' && letter <= 'K'; }

const Word* argument(const Execution& execution, char letter) {
    for (const Word* word : execution.statement.arguments)
        if (word->letter == letter) return word;
    return nullptr;
}

/// The words of the call's block but for its P and L.
std::vector<const Word*> words_of_call(const Execution& execution) {
    std::vector<const Word*> words;
    for (const Word* word : execution.statement.arguments)
        if (word->letter != 'P' && word->letter != 'L') words.push_back(word);
    return words;
}

/// The macro that G65 or G66 names, with its arguments.
core::Result<ModalMacro> named_macro(Execution& execution, const CodeWord& entry) {
    const Word* program = argument(execution, 'P');
    if (!program)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} does not say which macro: it needs a P word behind it",
                                      written(*entry.word)),
                          entry.word->span);
    FEELER_TRY(const int number, whole_number(*program));
    const uint32_t source = execution.state.next.source;
    FEELER_TRY(const std::optional<Place> begin, find_program(execution.library, source, number));
    if (!begin)
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: {}", written(*program),
                                      missing_program(execution.library, source, number)),
                          program->span);
    ModalMacro macro{.name = fmt::format("O{}", number), .begin = *begin};
    if (const Word* rounds = argument(execution, 'L')) {
        FEELER_TRY(macro.rounds, whole_number(*rounds));
        if (macro.rounds == 0) execution.warn(rounds->span, "L0: the macro is not run at all");
    }
    FEELER_TRY(macro.arguments, arguments_of(words_of_call(execution)));
    macro.each_block = entry.code->tenths == tenths(66, 1);
    return macro;
}

core::Result<void> enter_macro(Execution& execution, const ModalMacro& macro, size_t modal,
                               core::SourceSpan where) {
    if (macro.rounds == 0) return {};
    Frame frame{.called_from = {execution.state.next.source, execution.block.line},
                .begin = macro.begin,
                .name = macro.name,
                .locals = macro.arguments,
                .rounds_left = macro.rounds - 1,
                .modal_macro = modal};
    if (macro.rounds > 1 && modal == 0) frame.again = macro.arguments;
    return enter(execution.state, execution.environment, std::move(frame), where);
}

/// What G66 calls behind a motion, and G66.1 for every block.
core::Result<void> call_modal_macro(Execution& execution) {
    const size_t modal = modal_macro_in_effect(execution.state);
    if (modal == 0) return {};
    ModalMacro macro = execution.state.modal_macros[modal - 1];
    const auto& commands = execution.result.commands;
    if (!macro.each_block && std::none_of(commands.begin(), commands.end(), is_motion)) return {};
    if (macro.each_block) {
        FEELER_TRY(macro.arguments, arguments_of(execution.statement.arguments));
        if (execution.statement.code_count > 0)
            macro.arguments[argument_number('G')] = execution.statement.codes().back().word->value;
    }
    return enter_macro(execution, macro, modal, {.line = execution.block.line, .column = 1});
}

} // namespace

size_t argument_number(char letter) {
    return letter >= 'A' && letter <= 'Z' ? numbers[letter - 'A'] : 0;
}

core::Result<LocalParameters> arguments_of(const std::vector<const Word*>& words) {
    LocalParameters locals{};
    int set = 0;
    char last = '\0';
    for (const Word* word : words) {
        const char letter = word->letter;
        if (letter == 'N' || letter == 'O') continue;
        if (letter == 'G' || argument_number(letter) == 0)
            return core::fail(ErrorCode::syntax,
                              fmt::format("{} cannot be an argument of a macro: write it before "
                                          "the call",
                                          written(*word)),
                              word->span);
        if (!is_offset(letter)) {
            locals[argument_number(letter)] = word->value;
            continue;
        }
        if (letter <= last) ++set;
        last = letter;
        if (set == most_offset_sets)
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("{}: a macro takes I, J and K ten times at most", written(*word)),
                word->span);
        locals[argument_number(letter) + 3 * static_cast<size_t>(set)] = word->value;
    }
    return locals;
}

size_t modal_macro_in_effect(const InterpreterState& state) {
    if (state.modal_macros.empty()) return 0;
    for (auto frame = state.frames.rbegin(); frame != state.frames.rend(); ++frame)
        if (frame->modal_macro > 0)
            return std::min(frame->modal_macro - 1, state.modal_macros.size());
    return state.modal_macros.size();
}

bool blocks_are_arguments(const InterpreterState& state) {
    const size_t modal = modal_macro_in_effect(state);
    return modal > 0 && state.modal_macros[modal - 1].each_block;
}

core::Result<void> call_macro(Execution& execution) {
    InterpreterState& state = execution.state;
    const CodeWord* entry = execution.statement.of(ModalGroup::macro);
    if (!entry)
        return execution.statement.of(ModalGroup::subprogram) ? core::Result<void>{}
                                                              : call_modal_macro(execution);
    if (entry->code->tenths == tenths(67)) {
        if (!state.modal_macros.empty()) state.modal_macros.pop_back();
        return {};
    }
    FEELER_TRY(ModalMacro macro, named_macro(execution, *entry));
    if (entry->code->tenths == tenths(65))
        return enter_macro(execution, macro, 0, entry->word->span);
    if (state.modal_macros.size() == execution.dialect.deepest_calls)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: {} macros are called by every motion already: cancel "
                                      "them with G67",
                                      written(*entry->word), state.modal_macros.size()),
                          entry->word->span);
    const bool now = macro.each_block;
    state.modal_macros.push_back(std::move(macro));
    if (!now) return {};
    return enter_macro(execution, state.modal_macros.back(), state.modal_macros.size(),
                       entry->word->span);
}

core::Result<void> call(Execution& execution) {
    if (execution.state.ending != Ending::running) return {};
    if (auto called = call_subprogram(execution); !called) return called;
    return call_macro(execution);
}

} // namespace gcode
