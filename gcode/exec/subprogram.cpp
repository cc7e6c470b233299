#include "gcode/exec/subprogram.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gcode/exec/execution.h"
#include "gcode/exec/flow.h"
#include "gcode/exec/loop_detector.h"
#include "gcode/exec/modes.h"
#include "gcode/exec/readings.h"
#include "gcode/language/canonical.h"
#include "gcode/language/codes.h"
#include "gcode/language/flow_index.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

constexpr std::array<std::string_view, 11> endings = {
    "", ".nc", ".NC", ".ngc", ".tap", ".TAP", ".txt", ".TXT", ".cnc", ".CNC", ".gcode"};

/// File names of a program number: O1234.nc, O1234, 1234.nc ..., also with leading zeros.
std::vector<std::string> file_names(int number) {
    std::vector<std::string> digits;
    for (const int width : {1, 4, 5, 8}) {
        std::string written = fmt::format("{:0{}}", number, width);
        if (std::find(digits.begin(), digits.end(), written) == digits.end())
            digits.push_back(std::move(written));
    }
    std::vector<std::string> names;
    for (const std::string& some : digits)
        for (const std::string_view prefix : {"O", "o", ""})
            for (const std::string_view ending : endings)
                names.push_back(fmt::format("{}{}{}", prefix, some, ending));
    return names;
}

/// The first line after a tape mark and program number.
uint32_t first_line(const Program& program, const FlowIndex& index) {
    uint32_t line = 1;
    for (; line <= program.line_count(); ++line) {
        const std::string_view text = program.line(line);
        const size_t first = text.find_first_not_of(" \t");
        if (first != std::string_view::npos && text[first] != '%') break;
    }
    const FlowMark* mark = index.at(line);
    return mark && mark->kind == FlowKind::program_number ? line + 1 : line;
}

std::optional<ProgramLine> start_in(ProgramLibrary& library, uint32_t source, int number) {
    const FlowMark* mark = library.index(source).first(FlowKind::program_number, label_of(number));
    if (!mark) return std::nullopt;
    return ProgramLine{source, mark->line + 1};
}

std::optional<ProgramLine> start_in_programs(ProgramLibrary& library, uint32_t source, int number) {
    if (const auto own = start_in(library, source, number)) return own;
    return source == 0 ? std::nullopt : start_in(library, 0, number);
}

/// A file named for the program need not contain its number, on controls without O words.
core::Result<std::optional<ProgramLine>> start_in_files(ProgramLibrary& library, int number) {
    FEELER_TRY(const std::optional<uint32_t> source, library.find(file_names(number)));
    if (!source) return std::nullopt;
    if (const auto numbered = start_in(library, *source, number)) return numbered;
    if (library.dialect().has_o_words) return std::nullopt;
    return ProgramLine{*source, first_line(library.program(*source), library.index(*source))};
}

} // namespace

core::Result<std::optional<ProgramLine>> find_program(ProgramLibrary& library, uint32_t source,
                                                      int number, bool files_first) {
    if (!files_first)
        if (const auto start = start_in_programs(library, source, number)) return start;
    FEELER_TRY(const std::optional<ProgramLine> start, start_in_files(library, number));
    if (start || !files_first) return start;
    return start_in_programs(library, source, number);
}

std::string missing_program(ProgramLibrary& library, uint32_t source, int number) {
    constexpr size_t most_named = 8;
    const FlowIndex& index = library.index(source);
    std::vector<std::string> others;
    for (const FlowMark& mark : index.marks)
        if (mark.kind == FlowKind::program_number && others.size() < most_named)
            others.push_back("O" + mark.name);
    std::string message = fmt::format(
        "there is no program O{} in this file, and no file such as O{}.nc in ", number, number);
    if (library.search_path().empty())
        message += "a search path (none is set)";
    else
        message += fmt::format("{}", fmt::join(library.search_path(), ", "));
    if (!others.empty()) message += fmt::format("; this file has {}", fmt::join(others, ", "));
    if (index.line_of_number(number, 1, UINT32_MAX))
        message += fmt::format("; it has a block N{}, which {} calls", number,
                               find_code(m_code(97), library.dialect().id)
                                   ? fmt::format("M97 P{}", number)
                                   : fmt::format("M98 Q{}", number));
    return message;
}

namespace {

using core::ErrorCode;

/// Why a word has no usable number, if it depends on a variable that the program does not set.
std::string cause_of(const Execution& execution, const Word& word) {
    if (!word.is_unknown) return {};
    const ProgramParameters parameters(execution.state, execution.environment);
    (void)evaluate(execution.block.pool, word.expression, execution.block.line, parameters,
                   execution.dialect.arithmetic);
    return cause_of_number(parameters);
}

/// The error for a P word with the number of a program that does not exist.
tl::unexpected<core::Error> no_program(Execution& execution, const Word& word, int number) {
    const std::string cause = cause_of(execution, word);
    const std::string message =
        cause.empty() ? missing_program(execution.library, execution.state.next.source, number)
                      : fmt::format("there is no program O{}{}", number, cause);
    return core::fail(ErrorCode::syntax, fmt::format("{}: {}", written(word), message), word.span);
}

/// The line of the block that a word refers to, in a program of the library.
core::Result<uint32_t> block_named(Execution& execution, const Word& word, ProgramLine from,
                                   std::string_view where) {
    FEELER_TRY(const int number, whole_number(word));
    const auto line = line_of_block(execution.library, from.source, number, from.line);
    if (line) return *line;
    return core::fail(ErrorCode::syntax,
                      fmt::format("{}: there is no block N{} in {}{}", written(word), number, where,
                                  cause_of(execution, word)),
                      word.span);
}

/// The number of repetitions of a call, from its L word.
core::Result<int> rounds_of(Execution& execution) {
    const Word* word = execution.statement.word('L');
    if (!word) return 1;
    FEELER_TRY(const int rounds, whole_number(*word));
    if (rounds == 0) execution.warn(word->span, "L0: the subprogram is not run");
    return rounds;
}

core::Result<void> enter_rounds(Execution& execution, ProgramLine begin, std::string name,
                                int rounds) {
    if (rounds == 0) return {};
    Frame frame{.called_from = {execution.state.next.source, execution.block.line},
                .begin = begin,
                .name = std::move(name),
                .shares_locals = true,
                .rounds_left = rounds - 1};
    return enter(execution.state, execution.environment, std::move(frame),
                 execution.statement.of(ModalGroup::subprogram)->word->span);
}

/// M97, and M98 with Q only: calls the same program from a block on.
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
    ProgramLine begin;
};

/// The program that M98 calls. Without L, digits before the last four of P may be the repetitions.
core::Result<Called> called_by(Execution& execution, const Word& word, bool files_first) {
    FEELER_TRY(int number, whole_number(word));
    FEELER_TRY(int rounds, rounds_of(execution));
    const uint32_t source = execution.state.next.source;
    FEELER_TRY(std::optional<ProgramLine> begin,
               find_program(execution.library, source, number, files_first));
    const bool may_hold_rounds = execution.dialect.repeats_in_program_number && number > 9999
                                 && !execution.statement.word('L');
    if (!begin && may_hold_rounds) {
        rounds = number / 10000;
        number %= 10000;
        FEELER_TRY(begin, find_program(execution.library, source, number, files_first));
    }
    if (begin) return Called{number, rounds, *begin};
    return no_program(execution, word, number);
}

core::Result<void> call_program(Execution& execution, const CodeWord& entry) {
    const Word* program = execution.statement.word('P');
    const Word* block = execution.statement.word('Q');
    if (block && execution.dialect.has_o_words)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{}: on this control M98 takes only P and L", written(*block)),
            block->span);
    if (!program && block) return call_block(execution, *block);
    if (!program)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} needs a P word, the number of the program to call",
                                      written(*entry.word)),
                          entry.word->span);
    const bool external = entry.code->number == m_code(198);
    FEELER_TRY(Called called, called_by(execution, *program, external));
    if (block) {
        FEELER_TRY(called.begin.line,
                   block_named(execution, *block, {called.begin.source, called.begin.line - 1},
                               fmt::format("O{}", called.number)));
    }
    return enter_rounds(execution, called.begin, fmt::format("O{}", called.number), called.rounds);
}

/// M99 in the main program: starts it again, unless a pass has ended in the same state before. All
/// further passes would be like the one that followed.
void begin_again(Execution& execution) {
    InterpreterState& state = execution.state;
    ProgramLibrary& library = execution.library;
    state.next = {0, first_line(library.program(0), library.index(0))};
    state.loops.write() = {};
    const uint64_t now = digest_of(state);
    const bool is_known =
        std::find(state.passes.begin(), state.passes.end(), now) != state.passes.end();
    if (is_known || state.passes.size() + 1 >= most_passes) {
        state.ending = ProgramStatus::main_return;
        if (execution.dialect.has_o_words) execution.emit(ProgramEnd{});
    }
    if (!is_known) state.passes.push_back(now);
}

/// M99, in a subprogram or the main program, with or without the block to continue at.
core::Result<void> come_back(Execution& execution, const CodeWord& entry) {
    InterpreterState& state = execution.state;
    const Word* target = execution.statement.word('P');
    const Frame& frame = state.frames.back();
    const bool inside = state.frames.size() > 1;
    if (target && execution.dialect.has_o_words)
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: on this control M99 takes no P", written(*target)),
                          target->span);
    if (inside && execution.dialect.has_o_words && !frame.shares_locals)
        return core::fail(ErrorCode::syntax,
                          "M99 ends only subprograms called with M98; this one was called with an "
                          "O word and must end with endsub or return",
                          entry.word->span);
    if (target) {
        const ProgramLine from =
            inside ? frame.called_from : ProgramLine{state.next.source, execution.block.line};
        FEELER_TRY(
            const uint32_t line,
            block_named(execution, *target, from, inside ? "the calling program" : "this program"));
        if (inside)
            leave_to(state, line);
        else
            state.next.line = line;
    } else if (inside) {
        const ModalState before = state.modal;
        leave(state);
        announce_modes(execution.result, entry.word->span.column, before, state.modal);
    } else {
        begin_again(execution);
    }
    return {};
}

/// M96 jumps while an input is off. A backward jump waits for the input, which is assumed to come
/// on.
core::Result<void> jump_on_input(Execution& execution, const CodeWord& entry) {
    const Word* target = execution.statement.word('P');
    if (!target)
        return core::fail(ErrorCode::missing_value, "M96 needs a P word, the block to jump to",
                          entry.word->span);
    const ProgramLine here{execution.state.next.source, execution.block.line};
    FEELER_TRY(const uint32_t line, block_named(execution, *target, here, "this program"));
    const Word* input = execution.statement.word('Q');
    const std::string name = input ? fmt::format("input {:g}", input->value) : "its input";
    if (line <= execution.block.line) {
        execution.warn(
            entry.word->span,
            fmt::format("M96 waits for {}: assumed to be on, so the program continues", name));
        return {};
    }
    if (!execution.environment.control.reports_premises)
        execution.warn(entry.word->span, fmt::format("M96: {} is assumed to be off, so the program "
                                                     "jumps; the blocks up to {} were not checked",
                                                     name, written(*target)));
    if (outcome_of_input(execution.state, execution.environment, execution.block, name, true))
        execution.state.next.line = line;
    return {};
}

/// On some controls a call must be alone in its block.
core::Result<void> check_company(const Execution& execution, const CodeWord& entry) {
    if (!execution.dialect.calls_stand_alone) return {};
    for (const Word& word : execution.block.words) {
        if (std::string_view("NMPLQ").find(word.letter) != std::string_view::npos) continue;
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: on this control {} must be in a block by itself",
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
    switch (entry->code->number) {
    case m_code(96):
        return jump_on_input(execution, *entry);
    case m_code(97): {
        const Word* word = execution.statement.word('P');
        if (word) return call_block(execution, *word);
        return core::fail(ErrorCode::missing_value, "M97 needs a P word, the block to call",
                          entry->word->span);
    }
    case m_code(99):
        return come_back(execution, *entry);
    default:
        return call_program(execution, *entry); // M98, M198
    }
}

namespace {

// Fanuc B-64304, argument specification I, for A to Z. G, L, N, O and P have the remaining numbers,
// which G66.1 and the variables of earlier blocks (#4101 and up) use.
constexpr size_t numbers[26] = {1,  2,  3,  7,  8,  9,  10, 11, 4,  5,  6,  12, 13,
                                14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26};

constexpr int most_offset_sets = 10;

bool is_offset(char letter) { return letter >= 'I' && letter <= 'K'; }

const Word* argument(const Execution& execution, char letter) {
    for (const Word* word : execution.statement.arguments)
        if (word->letter == letter) return word;
    return nullptr;
}

/// The words of the call's block except P and L.
std::vector<const Word*> words_of_call(const Execution& execution) {
    std::vector<const Word*> words;
    for (const Word* word : execution.statement.arguments)
        if (word->letter != 'P' && word->letter != 'L') words.push_back(word);
    return words;
}

/// The arguments with unpredictable values, one bit for each number. Of repeated I, J and K, all
/// count as such.
uint64_t unpredictable_arguments(const std::vector<const Word*>& words) {
    uint64_t bits = 0;
    for (const Word* word : words)
        for (size_t number = argument_number(word->letter);
             word->is_unknown && number > 0 && number < std::tuple_size_v<LocalParameters>;
             number += 3) {
            bits |= uint64_t{1} << number;
            if (!is_offset(word->letter)) break;
        }
    return bits;
}

/// What the arguments with unpredictable values stand for.
UnknownValues unknown_arguments(Execution& execution, const std::vector<const Word*>& words) {
    const ProgramParameters parameters(execution.state, execution.environment);
    UnknownValues values;
    for (const Word* word : words) {
        const auto& arguments = execution.state.readings->arguments;
        const auto found = arguments.find(word->span.column);
        if (!word->is_unknown || found == arguments.end()) continue;
        UnknownValue value = found->second;
        // Of repeated I, J and K it is not said which one has the value.
        if (is_offset(word->letter)) value.identity = no_identity;
        const uint64_t bits = unpredictable_arguments({word});
        for (size_t number = 1; number < std::tuple_size_v<LocalParameters>; ++number)
            if (bits >> number & 1U) parameters.keep_argument(values, number, value);
    }
    return values;
}

/// The macro called by G65 or G66, with its arguments.
core::Result<ModalMacro> named_macro(Execution& execution, const CodeWord& entry) {
    const Word* program = argument(execution, 'P');
    if (!program)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} must be followed by a P word, the number of the macro",
                                      written(*entry.word)),
                          entry.word->span);
    FEELER_TRY(const int number, whole_number(*program));
    const uint32_t source = execution.state.next.source;
    FEELER_TRY(const std::optional<ProgramLine> begin,
               find_program(execution.library, source, number));
    if (!begin) return no_program(execution, *program, number);
    ModalMacro macro{.name = fmt::format("O{}", number), .begin = *begin};
    if (const Word* rounds = argument(execution, 'L')) {
        FEELER_TRY(macro.rounds, whole_number(*rounds));
        if (macro.rounds == 0) execution.warn(rounds->span, "L0: the macro is not run");
    }
    const std::vector<const Word*> words = words_of_call(execution);
    FEELER_TRY(macro.arguments, arguments_of(words));
    macro.unpredictable = unpredictable_arguments(words);
    macro.unknown = unknown_arguments(execution, words);
    macro.each_block = entry.code->number == g_code(66, 1);
    return macro;
}

core::Result<void> enter_macro(Execution& execution, const ModalMacro& macro, size_t modal,
                               core::SourceSpan where) {
    if (macro.rounds == 0) return {};
    Frame frame{.called_from = {execution.state.next.source, execution.block.line},
                .begin = macro.begin,
                .name = macro.name,
                .locals = macro.arguments,
                .unpredictable_locals = macro.unpredictable,
                .unknown = macro.unknown,
                .rounds_left = macro.rounds - 1,
                .modal_macro = modal};
    if (macro.rounds > 1 && modal == 0)
        frame.again = {macro.arguments, macro.unpredictable, macro.unknown};
    return enter(execution.state, execution.environment, std::move(frame), where);
}

/// Calls the macro of G66 after a motion, or that of G66.1 for a block.
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
            return core::fail(
                ErrorCode::syntax,
                fmt::format("{} cannot be a macro argument: program it before the call",
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
                fmt::format("{}: a macro call may have at most ten sets of I, J and K",
                            written(*word)),
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
    if (entry->code->number == g_code(67)) {
        if (!state.modal_macros.empty()) state.modal_macros.pop_back();
        return {};
    }
    FEELER_TRY(ModalMacro macro, named_macro(execution, *entry));
    if (entry->code->number == g_code(65))
        return enter_macro(execution, macro, 0, entry->word->span);
    if (state.modal_macros.size() == execution.dialect.deepest_calls)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}: {} modal macros are already active: cancel them with G67",
                        written(*entry->word), state.modal_macros.size()),
            entry->word->span);
    const bool now = macro.each_block;
    state.modal_macros.push_back(std::move(macro));
    if (!now) return {};
    return enter_macro(execution, state.modal_macros.back(), state.modal_macros.size(),
                       entry->word->span);
}

core::Result<void> call(Execution& execution) {
    if (execution.state.ending != ProgramStatus::running) return {};
    if (auto called = call_subprogram(execution); !called) return called;
    return call_macro(execution);
}

} // namespace gcode
