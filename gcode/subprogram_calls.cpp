#include <fmt/format.h>

#include "gcode/execution.h"
#include "gcode/flow.h"
#include "gcode/modes.h"
#include "gcode/subprogram.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// The line of the block that a word names, in a program of the library.
core::Result<uint32_t> block_named(Execution& execution, const Word& word, Place from,
                                   std::string_view where) {
    FEELER_TRY(const int number, whole_number(word));
    const auto line = line_of_block(execution.library, from.source, number, from.line);
    if (line) return *line;
    return core::fail(ErrorCode::syntax,
                      fmt::format("{}: there is no block N{} in {}", written(word), number, where),
                      word.span);
}

/// How often the call is made: its L word.
core::Result<int> rounds_of(Execution& execution) {
    const Word* word = execution.statement.word('L');
    if (!word) return 1;
    FEELER_TRY(const int rounds, whole_number(*word));
    if (rounds == 0) execution.warn(word->span, "L0: the subprogram is not run at all");
    return rounds;
}

core::Result<void> enter_rounds(Execution& execution, Place begin, std::string name, int rounds) {
    if (rounds == 0) return {};
    Frame frame{.called_from = {execution.state.next.source, execution.block.line},
                .begin = begin,
                .name = std::move(name),
                .shares_locals = true,
                .rounds_left = rounds - 1};
    return enter(execution.state, execution.environment, std::move(frame),
                 execution.statement.of(ModalGroup::subprogram)->word->span);
}

/// M97, and M98 with a Q alone: from a block of the same program on.
core::Result<void> call_block(Execution& execution, const Word& word) {
    const uint32_t source = execution.state.next.source;
    FEELER_TRY(const int rounds, rounds_of(execution));
    FEELER_TRY(const uint32_t line,
               block_named(execution, word, {source, execution.block.line}, "this program"));
    return enter_rounds(execution, {source, line}, fmt::format("N{:.12g}", word.value), rounds);
}

struct Called {
    int number;
    int rounds;
    Place begin;
};

/// The program that M98 means. Where no L stands, digits before the last four of P may be one.
core::Result<Called> called_by(Execution& execution, const Word& word, bool files_first) {
    FEELER_TRY(int number, whole_number(word));
    FEELER_TRY(int rounds, rounds_of(execution));
    const uint32_t source = execution.state.next.source;
    FEELER_TRY(std::optional<Place> begin,
               find_program(execution.library, source, number, files_first));
    const bool may_hold_rounds = execution.dialect.repeats_in_program_number && number > 9999
                                 && !execution.statement.word('L');
    if (!begin && may_hold_rounds) {
        rounds = number / 10000;
        number %= 10000;
        FEELER_TRY(begin, find_program(execution.library, source, number, files_first));
    }
    if (begin) return Called{number, rounds, *begin};
    return core::fail(
        ErrorCode::syntax,
        fmt::format("{}: {}", written(word), missing_program(execution.library, source, number)),
        word.span);
}

core::Result<void> call_program(Execution& execution, const CodeWord& entry) {
    const Word* program = execution.statement.word('P');
    const Word* block = execution.statement.word('Q');
    if (block && execution.dialect.has_o_words)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{}: M98 takes P and L only on this control", written(*block)),
            block->span);
    if (!program && block) return call_block(execution, *block);
    if (!program)
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{} does not say what to call: it needs a P word", written(*entry.word)),
            entry.word->span);
    const bool external = entry.code->tenths == tenths(198);
    FEELER_TRY(Called called, called_by(execution, *program, external));
    if (block) {
        FEELER_TRY(called.begin.line,
                   block_named(execution, *block, {called.begin.source, called.begin.line - 1},
                               fmt::format("O{}", called.number)));
    }
    return enter_rounds(execution, called.begin, fmt::format("O{}", called.number), called.rounds);
}

/// M99, in a subprogram and in the main program, with and without the block to go on at.
core::Result<void> come_back(Execution& execution, const CodeWord& entry) {
    InterpreterState& state = execution.state;
    const Word* target = execution.statement.word('P');
    const Frame& frame = state.frames.back();
    const bool inside = state.frames.size() > 1;
    if (target && execution.dialect.has_o_words)
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: M99 takes no P on this control", written(*target)),
                          target->span);
    if (inside && execution.dialect.has_o_words && !frame.shares_locals)
        return core::fail(ErrorCode::syntax,
                          "M99 belongs to what M98 calls; this subprogram was called by an O word "
                          "and ends with endsub or return",
                          entry.word->span);
    if (target) {
        const Place from =
            inside ? frame.called_from : Place{state.next.source, execution.block.line};
        FEELER_TRY(const uint32_t line,
                   block_named(execution, *target, from,
                               inside ? "the program that called" : "this program"));
        if (inside)
            leave_to(state, line);
        else
            state.next.line = line;
    } else if (inside) {
        const ModalState before = state.modal;
        leave(state);
        announce_modes(execution.result, entry.word->span.column, before, state.modal);
    } else {
        state.ending = Ending::main_return;
        if (execution.dialect.has_o_words) execution.emit(ProgramEnd{});
    }
    return {};
}

/// M96 jumps while an input is off. One that jumps back waits for it, so it will come.
core::Result<void> jump_on_input(Execution& execution, const CodeWord& entry) {
    const Word* target = execution.statement.word('P');
    if (!target)
        return core::fail(ErrorCode::missing_value,
                          "M96 does not say where to jump: it needs a P word", entry.word->span);
    const Place here{execution.state.next.source, execution.block.line};
    FEELER_TRY(const uint32_t line, block_named(execution, *target, here, "this program"));
    const Word* input = execution.statement.word('Q');
    const std::string name = input ? written(*input) : "its input";
    if (line <= execution.block.line) {
        execution.warn(entry.word->span,
                       fmt::format("M96 waits for {}: taken as on, so it goes on", name));
        return {};
    }
    execution.warn(entry.word->span,
                   fmt::format("M96: {} is taken as off, so it jumps; the blocks up to {} were "
                               "not looked at",
                               name, written(*target)));
    execution.state.next.line = line;
    return {};
}

/// Some controls read the block of a call for the call alone.
core::Result<void> check_company(const Execution& execution, const CodeWord& entry) {
    if (!execution.dialect.calls_stand_alone) return {};
    for (const Word& word : execution.block.words) {
        if (std::string_view("NMPLQ").find(word.letter) != std::string_view::npos) continue;
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: {} stands in a block of its own on this control",
                                      written(word), written(*entry.word)),
                          word.span);
    }
    return {};
}

} // namespace

core::Result<void> call_subprogram(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::subprogram);
    if (!entry) return {};
    if (auto checked = check_company(execution, *entry); !checked) return checked;
    switch (entry->code->tenths) {
    case tenths(96):
        return jump_on_input(execution, *entry);
    case tenths(97): {
        const Word* word = execution.statement.word('P');
        if (word) return call_block(execution, *word);
        return core::fail(ErrorCode::missing_value,
                          "M97 does not say which block to call: it needs a P word",
                          entry->word->span);
    }
    case tenths(99):
        return come_back(execution, *entry);
    default:
        return call_program(execution, *entry); // M98, M198
    }
}

} // namespace gcode
