#include "gcode/siemens/siemens_flow.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gcode/exec/flow.h"
#include "gcode/exec/loop_detector.h"
#include "gcode/exec/readings.h"
#include "gcode/language/flow_index.h"
#include "gcode/language/language.h"
#include "gcode/language/lexer.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

using core::ErrorCode;
using enum FlowKind;

/// Executes a flow statement, using the program around it.
class SiemensFlowing {
public:
    explicit SiemensFlowing(const FlowStep& step)
        : step_(step),
          line_(step.block.line),
          source_(step.state.next.source),
          index_(step.library.index(source_)) {}

    core::Result<void> run();

private:
    core::Result<void> go_after(uint32_t line) {
        step_.state.next.line = line + 1;
        return {};
    }
    core::Result<bool> holds(const SiemensArgument& condition) const {
        if (!condition.expression) {
            FEELER_TRY(const double value, value_of_argument(step_, condition, true));
            return value != 0.0;
        }
        const ProgramParameters parameters(step_.state, step_.environment);
        Margins margins;
        FEELER_TRY(const Value value, evaluate(step_.block.pool, condition.expression, line_,
                                               parameters, step_.dialect.arithmetic, &margins));
        note_condition(step_.state, line_, step_.block.pool, condition.expression, margins, value,
                       step_.dialect);
        return outcome_of(parameters, step_.block, condition.expression, step_.dialect.arithmetic,
                          value.value_or(0.0) != 0.0);
    }
    const FlowMark* structure() const;
    core::Result<uint32_t> partner(std::string_view wanted) const;
    core::Result<void> jump();
    void leave_repeated_lines(uint32_t target);
    std::optional<uint32_t> line_of(const SiemensJump& jump) const;
    std::optional<uint32_t> first_in(const std::string& name, uint32_t from, uint32_t end) const;
    std::optional<uint32_t> last_in(const std::string& name, uint32_t from, uint32_t end) const;
    core::Result<void> begin_loop(std::string_view end);
    core::Result<void> count_on();
    core::Result<void> repeat_part();

    const FlowStep& step_;
    const uint32_t line_, source_;
    const FlowIndex& index_;
};

/// The mark of this line that is not a label.
const FlowMark* SiemensFlowing::structure() const {
    const FlowMark* mark = index_.at(line_);
    while (mark && mark->kind == label) {
        ++mark;
        if (mark == index_.marks.data() + index_.marks.size() || mark->line != line_)
            return nullptr;
    }
    return mark;
}

core::Result<uint32_t> SiemensFlowing::partner(std::string_view wanted) const {
    const FlowMark* mark = structure();
    if (mark && mark->partner) return mark->partner;
    return refuse_step(step_, fmt::format("{} is missing", wanted));
}

std::optional<double> number_of(const std::string& name) {
    const bool is_number =
        name.size() > 1 && name.size() < 12 && name[0] == 'N'
        && std::all_of(name.begin() + 1, name.end(), [](char c) { return c >= '0' && c <= '9'; });
    return is_number ? std::optional(std::stod(name.substr(1))) : std::nullopt;
}

std::optional<uint32_t> SiemensFlowing::first_in(const std::string& name, uint32_t from,
                                                 uint32_t end) const {
    if (const auto number = number_of(name)) return index_.line_of_number(*number, from, end);
    for (const FlowMark& mark : index_.marks)
        if (mark.kind == label && mark.line >= from && mark.line < end && mark.name == name)
            return mark.line;
    return std::nullopt;
}

std::optional<uint32_t> SiemensFlowing::last_in(const std::string& name, uint32_t from,
                                                uint32_t end) const {
    std::optional<uint32_t> found = first_in(name, from, end);
    while (found) {
        const auto later = first_in(name, *found + 1, end);
        if (!later) break;
        found = later;
    }
    return found;
}

/// GOTOF searches towards the end of the program, GOTOB towards its start, GOTO and GOTOC first
/// forwards, then backwards.
std::optional<uint32_t> SiemensFlowing::line_of(const SiemensJump& jump) const {
    const ProgramLines lines = lines_around(index_, line_);
    if (jump.direction == JumpDirection::to_start) return lines.begin;
    std::optional<uint32_t> found;
    if (jump.direction != JumpDirection::backward)
        found = first_in(jump.target, line_ + 1, lines.end);
    if (!found && jump.direction != JumpDirection::forward)
        found = last_in(jump.target, lines.begin, line_ + 1);
    return found;
}

/// A jump out of lines that are being repeated ends their repetition.
void SiemensFlowing::leave_repeated_lines(uint32_t target) {
    Frame& frame = step_.state.frames.back();
    while (!frame.repeated.empty()) {
        const RepeatedLines& lines = frame.repeated.back();
        if (target >= lines.first && target <= lines.last) return;
        frame.repeats.erase(lines.statement);
        frame.repeated.pop_back();
    }
}

core::Result<void> SiemensFlowing::jump() {
    for (const SiemensJump& jump : siemens_of(step_.block).jumps) {
        bool goes = true;
        if (jump.condition.kind != SiemensArgument::Kind::nothing) {
            FEELER_TRY(goes, holds(jump.condition));
        }
        if (!goes) continue;
        if (const auto line = line_of(jump)) {
            step_.state.next.line = *line;
            leave_repeated_lines(*line);
            return {};
        }
        if (jump.direction == JumpDirection::no_alarm) return {};
        const std::string_view where = jump.direction == JumpDirection::forward ? "after this block"
                                       : jump.direction == JumpDirection::backward
                                           ? "before this block"
                                           : "in this program";
        const SiemensJump either{.target = jump.target};
        return core::fail(
            ErrorCode::syntax,
            fmt::format(
                "there is no {} {} to jump to{}", jump.target, where,
                line_of(either)
                    ? "; it is in the other direction: use GOTO, or the other of GOTOF and GOTOB"
                    : ""),
            jump.span);
    }
    return {};
}

core::Result<void> SiemensFlowing::begin_loop(std::string_view end) {
    FEELER_TRY(const bool goes_on, holds(siemens_of(step_.block).arguments[0]));
    if (goes_on) return {};
    FEELER_TRY(const uint32_t line, partner(end));
    return go_after(line);
}

/// FOR, whose variable has been set to its first value, or ENDFOR, which increments it.
core::Result<void> SiemensFlowing::count_on() {
    ProgramParameters parameters(step_.state, step_.environment);
    const bool begins = step_.block.flow.kind == for_loop;
    FEELER_TRY(const uint32_t other, partner(begins ? "ENDFOR" : "FOR"));
    Block head;
    if (!begins) {
        const std::string_view text = step_.library.program(source_).line(other);
        if (auto parsed = parse_line(text, other, step_.dialect, head); !parsed) return parsed;
    }
    const Block& block = begins ? step_.block : head;
    const Assignment& entry = block.assignments[0];
    const FlowStep at_head{step_.library, step_.environment, step_.dialect,
                           block,         step_.state,       step_.result};
    const SiemensArgument& limit = siemens_of(block).arguments[0];
    FEELER_TRY(const double last, value_of_argument(at_head, limit));
    if (begins && limit.expression) {
        parameters.forget_reads();
        if (auto read = evaluate(block.pool, limit.expression, block.line, parameters,
                                 step_.dialect.arithmetic);
            !read)
            return tl::unexpected(std::move(read).error());
        report_unknown(parameters, step_.result, block.flow.span, "the number of passes");
    }
    double number = 0.0;
    Value value;
    if (entry.is_named) {
        FEELER_TRY(value, parameters.named(block.pool.names[entry.name], entry.span));
    } else {
        FEELER_TRY(const Value index, evaluate(block.pool, entry.number, block.line, parameters,
                                               step_.dialect.arithmetic));
        number = index.value_or(0.0);
        FEELER_TRY(value, parameters.numbered(number, entry.span));
    }
    double now = value.value_or(0.0);
    if (!begins) {
        now += 1.0;
        auto set = entry.is_named
                       ? parameters.set_named(block.pool.names[entry.name], now, entry.span)
                       : parameters.set_numbered(number, now, entry.span);
        if (!set) return set;
        note_written(step_.state,
                     entry.is_named ? key_of(block.pool.names[entry.name]) : key_of(number));
    }
    note_counting(step_.state,
                  {.head = {source_, block.line},
                   .left = last - now,
                   .goes_on = now <= last,
                   .is_first = begins,
                   .bounds = {entry.value, siemens_of(block).arguments[0].expression}},
                  block.pool, step_.dialect);
    if (now <= last) return begins ? core::Result<void>{} : go_after(other);
    return begins ? go_after(other) : core::Result<void>{};
}

/// `REPEAT BEGIN P=5`: repeats the lines from the label to ENDLABEL, or to this block, five more
/// times. Only blocks before this one are searched, as on the control.
core::Result<void> SiemensFlowing::repeat_part() {
    const auto& jumps = siemens_of(step_.block).jumps;
    Frame& frame = step_.state.frames.back();
    auto& repeats = frame.repeats;
    const ProgramLines lines = lines_around(index_, line_);
    double count = 1.0;
    if (siemens_of(step_.block).repeats.kind != SiemensArgument::Kind::nothing) {
        FEELER_TRY(count, value_of_argument(step_, siemens_of(step_.block).repeats));
    }
    const auto begin = last_in(jumps[0].target, lines.begin, line_);
    if (!begin)
        return refuse_step(step_,
                           fmt::format("REPEAT: there is no {} before this block to repeat from",
                                       jumps[0].target));
    if (jumps.size() > 1)
        return core::fail(ErrorCode::unsupported,
                          "REPEAT with two labels is not supported yet: put it after the last "
                          "block to be repeated, with the first label only",
                          step_.block.flow.span);
    const auto rounds = static_cast<int64_t>(std::clamp(count, 0.0, 1e15));
    const auto [entry, begins] = repeats.try_emplace(line_, rounds);
    if (const Expression times = siemens_of(step_.block).repeats.expression; begins && times)
        note_condition(step_.state, line_, step_.block.pool, times, {}, count, step_.dialect);
    int64_t& left = entry->second;
    const bool repeats_lines = !frame.repeated.empty() && frame.repeated.back().statement == line_;
    if (left > 0) {
        --left;
        note_repetitions(step_.state, {source_, line_}, left);
        step_.state.next.line = *begin;
        const auto end = first_in("ENDLABEL", *begin, line_);
        if (end && !repeats_lines)
            frame.repeated.push_back({.first = *begin, .last = *end, .statement = line_});
    } else {
        repeats.erase(line_);
        if (repeats_lines) frame.repeated.pop_back();
    }
    return {};
}

core::Result<void> SiemensFlowing::run() {
    switch (step_.block.flow.kind) {
    case jumps:
        return jump();
    case if_branch:
        return begin_loop("ENDIF");
    case otherwise: {
        FEELER_TRY(const uint32_t line, partner("ENDIF"));
        return go_after(line);
    }
    case while_loop:
        return begin_loop("ENDWHILE");
    case end_while:
    case end_endless: {
        FEELER_TRY(const uint32_t line,
                   partner(step_.block.flow.kind == end_while ? "WHILE" : "LOOP"));
        step_.state.next.line = line;
        return {};
    }
    case for_loop:
    case end_for:
        return count_on();
    case until: {
        FEELER_TRY(const uint32_t line, partner("REPEAT"));
        FEELER_TRY(const bool is_done, holds(siemens_of(step_.block).arguments[0]));
        return is_done ? core::Result<void>{} : go_after(line);
    }
    case FlowKind::repeat_part:
        return SiemensFlowing::repeat_part();
    case end_if:
        if (auto found = partner("IF"); !found) return tl::unexpected(std::move(found).error());
        return {};
    default:
        return {}; // LOOP and REPEAT only mark a position
    }
}

core::Result<void> return_from(const FlowStep& step) {
    if (step.state.frames.size() > 1)
        return_to_caller(step.state, step.result, step.block.flow.span.column);
    else
        end_main_program(step.state, step.result, step.block.flow.span.column, "RET");
    return {};
}

} // namespace

// Source: SINUMERIK 840D sl, Programming Manual Fundamentals, M functions: M2, M17 and M30.
void end_main_program(InterpreterState& state, BlockCommands& result, uint32_t column,
                      std::string_view word) {
    state.ending = ProgramStatus::program_end;
    result.commands.emplace_back(ProgramEnd{});
    result.columns.push_back(column);
    result.warnings.push_back({Severity::note,
                               {.line = result.line, .column = column},
                               fmt::format("{} in a main program ends it, as M30 does", word)});
}

ProgramLines lines_around(const FlowIndex& index, uint32_t line) {
    ProgramLines lines;
    for (const FlowMark& mark : index.marks) {
        if (mark.kind != program_number) continue;
        if (mark.line <= line) lines.begin = mark.line + 1;
        if (mark.line > line && lines.end == UINT32_MAX) lines.end = mark.line;
    }
    return lines;
}

core::Result<double> value_of_argument(const FlowStep& step, const SiemensArgument& argument,
                                       bool is_condition) {
    if (argument.kind == SiemensArgument::Kind::text)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("\"{}\": a number is needed here, not a string", argument.text),
            argument.span);
    if (!argument.expression) return argument.plain;
    const ProgramParameters parameters(step.state, step.environment);
    FEELER_TRY(const Value value, evaluate(step.block.pool, argument.expression, step.block.line,
                                           parameters, step.dialect.arithmetic));
    if (!is_condition) report_unknown(parameters, step.result, argument.span, "this value");
    return value.value_or(0.0);
}

core::Result<void> run_siemens_flow(const FlowStep& step) {
    switch (step.block.flow.kind) {
    case endless_loop:
    case repeat:
        return {}; // they only mark a position; an index of all lines is not needed
    case declaration:
        return declare_variables(step);
    case procedure:
        return {}; // the call has set its parameters
    case call_program:
        return call_siemens_program(step);
    case FlowKind::return_statement:
        return return_from(step);
    default:
        return SiemensFlowing(step).run();
    }
}

namespace {

/// Reduces NAME, NAME.SPF and `/_N_SPF_DIR/_N_NAME_SPF` to NAME, in upper case.
std::string plain_name(const std::string& written) {
    std::string name = written.substr(written.find_last_of("/\\:") + 1);
    std::transform(name.begin(), name.end(), name.begin(), upper);
    if (name.starts_with("_N_")) name.erase(0, 3);
    for (const std::string_view ending : {"_SPF", "_MPF", ".SPF", ".MPF"})
        if (name.ends_with(ending)) {
            name.resize(name.size() - ending.size());
            break;
        }
    return name;
}

std::optional<ProgramLine> start_in(ProgramLibrary& library, uint32_t source,
                                    const std::string& name) {
    const FlowMark* mark = library.index(source).first(FlowKind::program_number, name);
    return mark ? std::optional(ProgramLine{source, mark->line + 1}) : std::nullopt;
}

/// The start of a program: after its header in this file or the main one, else in a file of the
/// search path.
core::Result<ProgramLine> start_of_program(const FlowStep& step, const std::string& name) {
    if (const auto own = start_in(step.library, step.state.next.source, name)) return *own;
    if (const auto main = start_in(step.library, 0, name)) return *main;
    std::vector<std::string> names;
    for (const std::string_view ending : {".SPF", ".MPF"}) names.push_back(name + ending.data());
    for (const std::string_view ending : {"_SPF", "_MPF"})
        names.push_back("_N_" + name + ending.data());
    FEELER_TRY(const auto source, step.library.find_in_any_case(names));
    if (source) return ProgramLine{*source, 1};
    const auto& path = step.library.search_path();
    return core::fail(
        ErrorCode::syntax,
        fmt::format(
            "'{}' is not a word of this control, and there is no program {}.SPF or {}.MPF in {}",
            siemens_of(step.block).name, name, name,
            path.empty() ? "a search path (none is set)"
                         : fmt::format("{}", fmt::join(path, ", "))),
        siemens_of(step.block).name_span);
}

/// The PROC of a program: its first block that is not empty.
core::Result<Block> head_of(const FlowStep& step, ProgramLine begin) {
    const Program& program = step.library.program(begin.source);
    Block block;
    for (size_t line = begin.line; program.has_line(line).value_or(false); ++line) {
        auto parsed =
            parse_line(program.line(line), static_cast<uint32_t>(line), step.dialect, block);
        if (!parsed) {
            core::Error error = std::move(parsed).error();
            error.file = program.file;
            return tl::unexpected(std::move(error));
        }
        if (!block.is_empty()) return block;
    }
    return Block{};
}

/// What an argument of a call stands for; empty if its value is known.
core::Result<std::optional<UnknownValue>> unknown_argument(const FlowStep& step,
                                                           const SiemensArgument& argument) {
    if (!argument.expression) return std::nullopt;
    const ProgramParameters parameters(step.state, step.environment);
    if (auto read = evaluate(step.block.pool, argument.expression, step.block.line, parameters,
                             step.dialect.arithmetic);
        !read)
        return tl::unexpected(std::move(read).error());
    return parameters.unknown_value(step.block.pool, argument.expression, step.block.line);
}

core::Result<void> set_parameters(const FlowStep& step, const Block& head, Frame& frame) {
    const auto& arguments = siemens_of(step.block).arguments;
    const auto& parameters = siemens_of(head).declarations;
    const bool is_procedure = head.flow.kind == FlowKind::procedure;
    if (arguments.size() > (is_procedure ? parameters.size() : 0))
        return core::fail(ErrorCode::syntax,
                          fmt::format("{} takes {} parameters, but {} are given", frame.name,
                                      is_procedure ? parameters.size() : 0, arguments.size()),
                          siemens_of(step.block).name_span);
    if (!is_procedure) return {};
    const FlowStep at_head{step.library, step.environment, step.dialect,
                           head,         step.state,       step.result};
    for (size_t i = 0; i < parameters.size(); ++i) {
        const SiemensDeclaration& parameter = parameters[i];
        if (parameter.by_reference)
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{} has the parameter VAR {}, which returns a value: "
                                          "this is not supported yet; use an R parameter",
                                          frame.name, parameter.name),
                              siemens_of(step.block).name_span);
        const bool given =
            i < arguments.size() && arguments[i].kind != SiemensArgument::Kind::nothing;
        double value = 0.0;
        if (given) {
            FEELER_TRY(value, value_of_argument(step, arguments[i]));
            FEELER_TRY(auto unknown, unknown_argument(step, arguments[i]));
            if (unknown) {
                const ProgramParameters own(step.state, step.environment);
                own.keep_argument(frame.unknown, parameter.name, *std::move(unknown));
                frame.unpredictable_names.insert(parameter.name);
            }
        } else if (parameter.initial.kind != SiemensArgument::Kind::nothing) {
            FEELER_TRY(value, value_of_argument(at_head, parameter.initial));
        }
        frame.named[parameter.name] = converted_to(parameter.type, value);
        if (parameter.type != VariableType::real) frame.types[parameter.name] = parameter.type;
    }
    return {};
}

core::Result<int64_t> rounds_of(const FlowStep& step) {
    const SiemensArgument& repeats = siemens_of(step.block).repeats;
    if (repeats.kind == SiemensArgument::Kind::nothing) return 1;
    FEELER_TRY(const double rounds, value_of_argument(step, repeats));
    if (repeats.expression)
        note_condition(step.state, step.block.line, step.block.pool, repeats.expression, {}, rounds,
                       step.dialect);
    if (rounds >= 0.0 && rounds <= 9999.0 && rounds == std::floor(rounds))
        return static_cast<int64_t>(rounds);
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("P{:.12g}: the number of calls must be from 0 to 9999", rounds),
                      repeats.span);
}

} // namespace

core::Result<Frame> called_frame(const FlowStep& step) {
    const std::string name = plain_name(siemens_of(step.block).name);
    FEELER_TRY(const ProgramLine begin, start_of_program(step, name));
    Frame frame{
        .called_from = {step.state.next.source, step.block.line}, .begin = begin, .name = name};
    FEELER_TRY(const Block head, head_of(step, begin));
    if (auto set = set_parameters(step, head, frame); !set)
        return tl::unexpected(std::move(set).error());
    if (siemens_of(head).saves_modes) save_siemens_modes(step.state, frame);
    FEELER_TRY(const int64_t rounds, rounds_of(step));
    frame.rounds_left = rounds - 1;
    return frame;
}

core::Result<void> call_siemens_program(const FlowStep& step) {
    FEELER_TRY(Frame frame, called_frame(step));
    if (frame.rounds_left < 0) return {};
    return enter(step.state, step.environment, std::move(frame), siemens_of(step.block).name_span);
}

core::Result<void> declare_variables(const FlowStep& step) {
    std::vector<double> values;
    for (const SiemensDeclaration& entry : siemens_of(step.block).declarations) {
        double value = 0.0;
        if (entry.initial.kind != SiemensArgument::Kind::nothing) {
            FEELER_TRY(value, value_of_argument(step, entry.initial));
        }
        values.push_back(converted_to(entry.type, value));
    }
    Frame& frame = step.state.frames.back();
    for (size_t i = 0; i < values.size(); ++i) {
        const SiemensDeclaration& entry = siemens_of(step.block).declarations[i];
        if (frame.named.size() >= most_named_parameters)
            return core::fail(ErrorCode::invalid_value, "too many variables", entry.span);
        frame.named[entry.name] = values[i];
        note_written(step.state, key_of(entry.name));
        if (entry.type != VariableType::real) frame.types[entry.name] = entry.type;
    }
    return {};
}

} // namespace gcode
