#include "gcode/exec/assignments.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/exec/fanuc_parameters.h"
#include "gcode/exec/readings.h"
#include "gcode/language/error_rules.h"

namespace gcode {
namespace {

core::Result<Value> value_of(const Assigning& assigning, Expression expression) {
    return evaluate(assigning.block.pool, expression, assigning.block.line, assigning.parameters,
                    assigning.dialect.arithmetic);
}

bool calls_macro(const Block& block) {
    return std::any_of(block.words.begin(), block.words.end(), [](const Word& word) {
        return word.letter == 'G' && word.value >= 65.0 && word.value < 67.0;
    });
}

/// The value of a word. In lengths and angles, but not in macro arguments, ROUND may round to the
/// least increment of the control.
///
/// Source: Fanuc 30i user's manual B-63944EN, "Arithmetic and logic operation", ROUND; Haas mill
///         operator's manual 96-8000, "Notes on functions".
core::Result<Value> value_of_word(const Assigning& assigning, const Word& word) {
    Arithmetic arithmetic = assigning.dialect.arithmetic;
    if (arithmetic.rounds_lengths_to_steps && counts_increments(word.letter)
        && !calls_macro(assigning.block)) {
        const bool angle = word.letter >= 'A' && word.letter <= 'C';
        arithmetic.steps_in_one = assigning.inch && !angle ? 10000.0 : 1000.0;
    }
    return evaluate(assigning.block.pool, word.expression, assigning.block.line,
                    assigning.parameters, arithmetic);
}

} // namespace

bool is_dwell(const Block& block) {
    return std::any_of(block.words.begin(), block.words.end(), [](const Word& word) {
        return word.letter == 'G' && !word.expression && word.value == 4.0;
    });
}

namespace {

/// A feed or speed in place of one that only the machine knows, so that the path is checked to its
/// end.
double assumed_rate(const Assigning& assigning, char letter) {
    if (letter == 'S') return 1000.0;
    const FeedMode mode = assigning.parameters.state().modal.feed_mode;
    if (mode == FeedMode::inverse_time) return 1.0;
    const double rate = mode == FeedMode::per_turn ? 0.1 : 100.0;
    return assigning.inch ? rate / 25.0 : rate;
}

void assume_rate(const Assigning& assigning, const Word& word, Value& value) {
    if (value.value_or(0.0) > 0.0) return;
    value = assumed_rate(assigning, word.letter);
    const std::string& name = assigning.parameters.unpredictable_reads().front();
    auto& reported = assigning.parameters.state().readings.write().reported;
    if (!reported.insert(fmt::format("{} of {}", word.letter, name)).second) return;
    assigning.result.warnings.push_back(
        {Severity::note, word.span,
         fmt::format("{} depends on {}, which only the machine knows here; {}{:g} is assumed, and "
                     "that the {}",
                     word.letter, name, word.letter, *value,
                     word.letter == 'F' ? "tool moves" : "spindle turns")});
}

/// Marks a word whose value is unpredictable. Feeds, speeds and dwells do not change the path;
/// arguments of macros are followed.
void note_unknown(const Assigning& assigning, Word& word, Value& value) {
    if (assigning.parameters.unpredictable_reads().empty()) return;
    if (!assigning.parameters.environment().control.reports_premises) return;
    if (word.letter == 'N') return;
    if (is_dwell(assigning.block)) {
        value = value.value_or(0.0);
        return;
    }
    if (calls_macro(assigning.block))
        if (auto unknown = assigning.parameters.unknown_value(assigning.block.pool, word.expression,
                                                              assigning.block.line))
            assigning.parameters.state().readings.write().arguments.insert_or_assign(
                word.span.column, *std::move(unknown));
    const bool is_rate = word.letter == 'F' || word.letter == 'S';
    if (is_rate && !calls_macro(assigning.block)) return assume_rate(assigning, word, value);
    word.is_unknown = true;
    if (!calls_macro(assigning.block))
        report_unknown(assigning.parameters, assigning.result, word.span,
                       std::string(1, word.letter));
}

/// Evaluates the words and removes those whose value is vacant (Fanuc).
core::Result<void> work_out_words(const Assigning& assigning) {
    std::vector<Word>& words = assigning.block.words;
    size_t used = 0;
    for (size_t i = 0; i < words.size(); ++i) {
        Word& word = words[i];
        if (word.expression) {
            assigning.parameters.forget_reads();
            FEELER_TRY(Value value, value_of_word(assigning, word));
            note_unknown(assigning, word, value);
            if (!value && !word.is_unknown) continue;
            word.value = value.value_or(0.0);
        }
        if (used != i) words[used] = word;
        ++used;
    }
    words.resize(used);
    return {};
}

core::Result<Value> right_side(const Assigning& assigning, const Assignment& entry) {
    assigning.parameters.forget_reads();
    if (!entry.value) return Value(entry.plain);
    return value_of(assigning, entry.value);
}

bool follows_values(const Assigning& assigning) {
    return assigning.parameters.environment().control.reports_premises;
}

core::Result<double> number_of(const Assigning& assigning, const Assignment& entry) {
    if (entry.is_named) return 0.0;
    FEELER_TRY(const Value number, value_of(assigning, entry.number));
    return number.value_or(0.0);
}

/// What the last right side stands for; empty if its value is known.
std::optional<UnknownValue> unknown_value(const Assigning& assigning, const Assignment& entry) {
    if (!entry.value) return std::nullopt;
    return assigning.parameters.unknown_value(assigning.block.pool, entry.value,
                                              assigning.block.line);
}

/// Reports an offset that is set to a value that only the machine knows: all positions under it
/// depend on it. Called after both sides have been evaluated.
void note_unknown_offset(const Assigning& assigning, const Assignment& entry, double number) {
    const Environment& environment = assigning.parameters.environment();
    if (entry.is_named || assigning.parameters.unpredictable_reads().empty()) return;
    constexpr double most = 1e9; // far above all numbers of parameters
    const auto parameter =
        static_cast<int>(core::round_to_integer(std::clamp(number, -most, most)));
    if (!sets_the_machine(environment, parameter)) return;
    report_unknown(assigning.parameters, assigning.result, entry.span,
                   fmt::format("{}{:g}", assigning.dialect.parameter_letter, number));
}

core::Result<void> set(const Assigning& assigning, const Assignment& entry, double number,
                       Value value, std::optional<UnknownValue> unknown) {
    ProgramParameters& parameters = assigning.parameters;
    if (entry.is_named) {
        const std::string& name = assigning.block.pool.names[entry.name];
        const auto old = parameters.exists(name) ? parameters.named(name, entry.span)
                                                 : core::Result<Value>(Value{});
        if (auto done = parameters.set_named(name, value, entry.span); !done) return done;
        if (follows_values(assigning)) parameters.mark_named(name, std::move(unknown));
        assigning.undos.push_back({true, 0.0, name, *old});
        return {};
    }
    const Value old = parameters.stored_value(number);
    if (auto done = parameters.set_numbered(number, value, entry.span); !done) return done;
    if (follows_values(assigning)) parameters.mark_numbered(number, std::move(unknown));
    assigning.undos.push_back({false, number, {}, old});
    return execute_alarm(assigning.block, assigning.dialect, number, value, entry.span,
                         assigning.result);
}

/// Evaluates all right-hand sides before setting the first parameter.
core::Result<void> assign(const Assigning& assigning) {
    std::vector<Value>& values = assigning.values;
    values.clear();
    std::vector<double> numbers;
    std::vector<std::optional<UnknownValue>> unknown;
    for (const Assignment& entry : assigning.block.assignments) {
        FEELER_TRY(const Value value, right_side(assigning, entry));
        unknown.push_back(unknown_value(assigning, entry));
        values.push_back(value);
        FEELER_TRY(const double number, number_of(assigning, entry));
        note_unknown_offset(assigning, entry, number);
        numbers.push_back(number);
    }
    for (size_t i = 0; i < numbers.size(); ++i)
        if (auto done = set(assigning, assigning.block.assignments[i], numbers[i], values[i],
                            std::move(unknown[i]));
            !done)
            return done;
    return {};
}

core::Result<void> work_out_in_order(const Assigning& assigning) {
    auto word = assigning.block.words.begin();
    const auto words_up_to = [&](uint32_t column) -> core::Result<void> {
        for (; word != assigning.block.words.end() && word->span.column < column; ++word) {
            if (!word->expression) continue;
            assigning.parameters.forget_reads();
            FEELER_TRY(Value value, value_of(assigning, word->expression));
            note_unknown(assigning, *word, value);
            word->value = value.value_or(0.0);
        }
        return {};
    };
    for (const Assignment& entry : assigning.block.assignments) {
        if (auto done = words_up_to(entry.span.column); !done) return done;
        FEELER_TRY(const Value value, right_side(assigning, entry));
        auto unknown = unknown_value(assigning, entry);
        FEELER_TRY(const double number, number_of(assigning, entry));
        if (auto done = set(assigning, entry, number, value, std::move(unknown)); !done)
            return done;
    }
    return words_up_to(UINT32_MAX);
}

} // namespace

core::Result<void> evaluate_block(const Assigning& assigning) {
    if (assigning.dialect.assigns_in_order) return work_out_in_order(assigning);
    if (auto done = work_out_words(assigning); !done) return done;
    return assign(assigning);
}

bool counts_increments(char letter) {
    return std::string_view("XYZABCUVWIJKRQrc").find(letter) != std::string_view::npos;
}

void take_back_assignments(const std::vector<AssignmentUndo>& undos,
                           ProgramParameters& parameters) {
    for (auto undo = undos.rbegin(); undo != undos.rend(); ++undo) {
        if (undo->is_named)
            parameters.restore_local(undo->name, undo->value);
        else
            parameters.restore_local(undo->number, undo->value);
    }
}

core::Result<void> execute_alarm(const Block& block, const Dialect& dialect, double number,
                                 Value value, core::SourceSpan where, BlockCommands& result) {
    constexpr double alarm = 3000.0, message_stop = 3006.0;
    if (!remembers_words(dialect.system_parameters)) return {};
    const std::string text =
        block.comments.empty() ? std::string() : std::string(block.comments.back().text);
    if (number == alarm)
        return core::fail(
            program_alarm,
            fmt::format("the program raises alarm {:.12g} here{}{}; the control stops",
                        dialect.first_alarm + value.value_or(0.0), text.empty() ? "" : ": ", text),
            where);
    if (number != message_stop) return {};
    if (!text.empty()) {
        result.commands.emplace_back(Message{text});
        result.columns.push_back(where.column);
    }
    result.commands.emplace_back(ProgramStop{});
    result.columns.push_back(where.column);
    return {};
}

void note_clock(const Block& block, InterpreterState& state, BlockCommands& result) {
    const auto& steps = block.pool.instructions;
    for (size_t i = 0; !state.said_time && i + 1 < steps.size(); ++i) {
        const bool reads = steps[i].operation == Operation::number
                           && steps[i + 1].operation == Operation::numbered
                           && is_of_clock(steps[i].number);
        if (!reads) continue;
        state.said_time = true;
        result.warnings.push_back(
            {Severity::warning,
             {.line = block.line, .column = steps[i].column},
             fmt::format("#{:.0f}: clock and timers are simulated: the time is noon on 1 January "
                         "2020, and timers advance by one second per block",
                         steps[i].number)});
    }
}

void announce_offsets(const Offsets& before, const ModalState& modal, BlockCommands& result) {
    if (before == modal.offsets) return;
    if (before.tool != modal.offsets.tool) {
        result.commands.emplace_back(UseToolLengthOffset{modal.length_number, modal.offsets.tool,
                                                         modal.offsets.follows_tip});
        result.columns.push_back(1);
    }
    if (before.work != modal.offsets.work || before.local != modal.offsets.local) {
        result.commands.emplace_back(SetOffset{modal.offsets});
        result.columns.push_back(1);
    }
}

} // namespace gcode
