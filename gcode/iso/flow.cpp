#include "gcode/exec/flow.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/exec/loop_detector.h"
#include "gcode/exec/modes.h"
#include "gcode/exec/readings.h"
#include "gcode/iso/flow_parser.h"
#include "gcode/iso/iso.h"
#include "gcode/language/dialect.h"
#include "gcode/language/flow_index.h"
#include "gcode/language/language.h"
#include "gcode/language/lexer.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

using core::ErrorCode;
using enum FlowKind;

/// Executes one flow statement, using the program around it.
class Flowing {
public:
    explicit Flowing(const FlowStep& step)
        : step_(step),
          parameters_(step.state, step.environment),
          source_(step.state.next.source),
          line_(step.block.line),
          index_(step.library.index(source_)),
          scope_(index_.scope_of(line_)) {}

    core::Result<void> run();

private:
    tl::unexpected<core::Error> refuse(std::string message) const {
        return core::fail(ErrorCode::syntax, std::move(message), step_.block.flow.span);
    }
    tl::unexpected<core::Error> refuse_in_repeat(std::string_view word) const {
        return refuse(fmt::format(
            "the control does not accept '{}' in a 'repeat' loop: use a 'while' or 'do' loop",
            word));
    }
    void set_line(uint32_t line) { step_.state.next = {source_, line}; }
    void go_after(uint32_t line) { set_line(line + 1); }
    Frame& frame() { return step_.state.frames.back(); }
    const std::string& name() const { return name_; }

    core::Result<void> find_name();
    core::Result<const FlowMark*> partner(std::initializer_list<FlowKind> kinds, bool ahead,
                                          std::string_view wanted) const;
    core::Result<bool> holds(const Block& block) const {
        return condition_holds(step_.state, block, parameters_, step_.dialect);
    }

    core::Result<void> check_skipped(uint32_t up_to) const;
    core::Result<Block> read_line(uint32_t line) const;
    void warn_of_second_use() const;
    core::Result<void> end_if_statement();
    core::Result<void> skip_sub();
    bool meet_sub(uint32_t line);
    core::Result<void> call_sub();
    core::Result<void> return_statement();
    core::Result<void> take_branch();
    core::Result<void> while_statement();
    core::Result<void> repeat_statement();
    core::Result<void> end_repeat_statement();
    /// The end of the loop that contains `word`, break or continue.
    core::Result<const FlowMark*> end_of_loop(std::string_view word);
    core::Result<void> leave_loop();
    core::Result<void> continue_loop_early();
    core::Result<void> jump();
    core::Result<void> go_after_partner(std::initializer_list<FlowKind> kinds, bool ahead,
                                        std::string_view wanted);

    const FlowStep& step_;
    ProgramParameters parameters_;
    const uint32_t source_, line_;
    const FlowIndex& index_;
    const uint32_t scope_;
    std::string name_;
};

core::Result<void> Flowing::find_name() {
    const Flow& flow = step_.block.flow;
    if (flow.has_label) name_ = step_.block.pool.names[flow.label_name];
    if (!flow.label) return {};
    parameters_.forget_reads();
    FEELER_TRY(const Value value, evaluate(step_.block.pool, flow.label, line_, parameters_,
                                           step_.dialect.arithmetic));
    report_unknown(parameters_, step_.result, step_.block.flow.span, "the target");
    name_ = label_of(core::round(value.value_or(0.0)));
    note_computed_target(step_.state);
    return {};
}

/// The nearest statement with the same name that forms a pair with this one.
core::Result<const FlowMark*> Flowing::partner(std::initializer_list<FlowKind> kinds, bool ahead,
                                               std::string_view wanted) const {
    const FlowMark* found = ahead ? index_.next(line_, scope_, name_, kinds)
                                  : index_.previous(line_, scope_, name_, kinds);
    if (ahead)
        if (auto read = check_skipped(found ? found->line : UINT32_MAX); !read)
            return tl::unexpected(std::move(read).error());
    if (found) return found;
    return refuse(fmt::format("'{}' of {} is missing {} this line", wanted, name_,
                              ahead ? "after" : "before"));
}

core::Result<void> Flowing::go_after_partner(std::initializer_list<FlowKind> kinds, bool ahead,
                                             std::string_view wanted) {
    FEELER_TRY(const FlowMark* const mark, partner(kinds, ahead, wanted));
    go_after(mark->line);
    return {};
}

/// Remembers a subprogram of the main program; whether it is new.
bool Flowing::meet_sub(uint32_t line) {
    std::vector<uint32_t>& known = step_.state.frames.front().known_subs;
    if (std::find(known.begin(), known.end(), line) != known.end()) return false;
    known.push_back(line);
    return true;
}

/// A subprogram is executed when it is called; when the program first reaches its definition, it is
/// skipped. A definition that was called or passed before stops the control.
///
/// Source: rs274 2.9, probed.
core::Result<void> Flowing::skip_sub() {
    const FlowMark* first = index_.first(sub, name_);
    if (!first) return refuse("a line with 'sub' must begin with its O word");
    if (first->line != line_)
        return refuse(
            fmt::format("subprogram {} is defined twice, first in line {}: the control stops here",
                        name_, first->line));
    const FlowMark* end = index_.next(line_, 0, name_, {end_sub});
    if (!end)
        if (auto read = check_skipped(UINT32_MAX); !read) return read;
    for (const FlowMark& mark : index_.marks) {
        const bool inside = mark.line > line_ && (!end || mark.line < end->line);
        if (inside && (mark.kind == sub || mark.kind == program_number))
            return core::fail(ErrorCode::syntax,
                              fmt::format("a subprogram starts here inside {}, which starts in "
                                          "line {}: end that one with endsub first",
                                          name_, line_),
                              {.line = mark.line, .column = 1});
    }
    if (!end) return refuse(fmt::format("subprogram {} has no endsub", name_));
    if (auto read = check_skipped(end->line); !read) return read;
    if (source_ == 0 && step_.state.frames.size() == 1 && !meet_sub(line_))
        return refuse(
            fmt::format("the program runs into subprogram {}, which it has already called "
                        "or passed: the control stops here; end the program with M2 "
                        "before it",
                        name_));
    go_after(end->line);
    return {};
}

/// O words in skipped lines are parsed too; the first that is malformed is an error.
core::Result<void> Flowing::check_skipped(uint32_t up_to) const {
    for (const FlowMark& mark : index_.marks) {
        if (mark.line <= line_ || mark.kind != none) continue;
        if (mark.line >= up_to) return {};
        if (auto read = read_line(mark.line); !read) return tl::unexpected(std::move(read).error());
    }
    return {};
}

core::Result<Block> Flowing::read_line(uint32_t line) const {
    Block block;
    const std::string_view text = step_.library.program(source_).line(line);
    if (auto parsed = parse_line(text, line, step_.dialect, block); !parsed)
        return tl::unexpected(std::move(parsed).error());
    return block;
}

/// Warns if the label is already used: a label may only be used once in a program or subprogram.
void Flowing::warn_of_second_use() const {
    const FlowMark* other =
        index_.previous(line_, scope_, name_, {if_branch, while_loop, do_loop, repeat});
    if (!other || other->closes_do_loop) return;
    step_.result.warnings.push_back(
        {Severity::warning, step_.block.flow.span,
         fmt::format("label {} is already used in line {}: the control stops here if that line has "
                     "been run; use another label",
                     name_, other->line)});
}

core::Result<void> Flowing::call_sub() {
    uint32_t source = source_;
    const FlowMark* mark = index_.first(sub, name_);
    if (!mark && source_ != 0) {
        source = 0;
        mark = step_.library.index(0).first(sub, name_);
    }
    if (!mark) {
        FEELER_TRY(const auto file, step_.library.find({name_ + ".ngc", name_ + ".NGC"}));
        if (file) {
            source = *file;
            mark = step_.library.index(source).first(sub, name_);
        }
    }
    if (!mark)
        return refuse(fmt::format("there is no subprogram {} in this program, and no file {}.ngc "
                                  "with it in the search path",
                                  name_, name_));
    if (source == 0) meet_sub(mark->line);
    Frame next{.called_from = {source_, line_}, .begin = {source, mark->line + 1}, .name = name_};
    for (size_t i = 1; i <= static_cast<size_t>(step_.dialect.local_count); ++i)
        next.locals[i] = 0.0;
    for (size_t i = 0; i < step_.block.flow.arguments.size(); ++i) {
        parameters_.forget_reads();
        FEELER_TRY(next.locals[i + 1], evaluate(step_.block.pool, step_.block.flow.arguments[i],
                                                line_, parameters_, step_.dialect.arithmetic));
        if (auto unknown =
                parameters_.unknown_value(step_.block.pool, step_.block.flow.arguments[i], line_)) {
            next.unpredictable_locals |= uint64_t{1} << (i + 1);
            parameters_.keep_argument(next.unknown, i + 1, *std::move(unknown));
        }
    }
    return enter(step_.state, step_.environment, std::move(next), step_.block.flow.span);
}

/// `return` and `endsub`, with or without a value.
core::Result<void> Flowing::return_statement() {
    const bool inside = step_.state.frames.size() > 1;
    if (!inside) return refuse("return outside a subprogram");
    Value value;
    std::optional<UnknownValue> unknown;
    parameters_.forget_reads();
    if (step_.block.flow.has_condition) {
        FEELER_TRY(value, evaluate(step_.block.pool, step_.block.flow.condition, line_, parameters_,
                                   step_.dialect.arithmetic));
        unknown = parameters_.unknown_value(step_.block.pool, step_.block.flow.condition, line_);
    }
    Parameters& parameters = step_.state.parameters.write();
    parameters.set_named("_value", value.value_or(0.0));
    parameters.set_named("_value_returned", value ? 1.0 : 0.0);
    parameters_.mark_named("_value", std::move(unknown));
    const ModalState before = step_.state.modal;
    if (frame().restores && *frame().saved)
        for (const std::string& loss : losses_of_restoring(before, **frame().saved))
            step_.result.warnings.push_back(
                {Severity::warning, step_.block.flow.span, "M73: " + loss});
    leave(step_.state);
    announce_modes(step_.result, step_.block.flow.span.column, before, step_.state.modal);
    return {};
}

/// Goes from `if` to the first branch whose condition is true.
core::Result<void> Flowing::take_branch() {
    FEELER_TRY(bool taken, holds(step_.block));
    if (taken) return {};
    uint32_t line = line_;
    while (true) {
        const FlowMark* mark = index_.next(line, scope_, name_, {else_if, otherwise, end_if});
        if (auto read = check_skipped(mark ? mark->line : UINT32_MAX); !read) return read;
        if (!mark) return refuse(fmt::format("'endif' of {} is missing after this line", name_));
        line = mark->line;
        if (mark->kind == else_if) {
            FEELER_TRY(const Block block, read_line(line));
            FEELER_TRY(taken, holds(block));
            if (!taken) continue;
        }
        go_after(line);
        return {};
    }
}

/// `endif`; also `elseif` and `else` at the end of a branch that was executed.
core::Result<void> Flowing::end_if_statement() {
    if (!index_.previous(line_, scope_, name_, {if_branch}))
        return refuse(fmt::format("'if' of {} is missing before this line", name_));
    if (step_.block.flow.kind == end_if) return {};
    // The control evaluates the condition even when it is not needed.
    if (step_.block.flow.kind == else_if) {
        const auto unused = evaluate(step_.block.pool, step_.block.flow.condition, line_,
                                     parameters_, step_.dialect.arithmetic);
        if (!unused) return tl::unexpected(unused.error());
    }
    return go_after_partner({end_if}, true, "endif");
}

/// The head of a while loop, or the end of a do loop.
core::Result<void> Flowing::while_statement() {
    FEELER_TRY(const bool goes_on, holds(step_.block));
    const FlowMark* self = index_.at(line_);
    if (self && self->closes_do_loop)
        return goes_on ? go_after_partner({do_loop}, false, "do") : core::Result<void>{};
    return goes_on ? core::Result<void>{} : go_after_partner({end_while}, true, "endwhile");
}

core::Result<void> Flowing::repeat_statement() {
    parameters_.forget_reads();
    FEELER_TRY(const Value count, evaluate(step_.block.pool, step_.block.flow.condition, line_,
                                           parameters_, step_.dialect.arithmetic));
    report_unknown(parameters_, step_.result, step_.block.flow.span, "the number of repetitions");
    const auto rounds = static_cast<int64_t>(std::clamp(count.value_or(0.0), 0.0, 1e15));
    if (rounds < 1) return go_after_partner({end_repeat}, true, "endrepeat");
    frame().repeats[line_] = rounds;
    return {};
}

core::Result<void> Flowing::end_repeat_statement() {
    FEELER_TRY(const FlowMark* const head, partner({repeat}, false, "repeat"));
    const auto left = frame().repeats.find(head->line);
    if (left == frame().repeats.end()) return {};
    --left->second;
    note_repetitions(step_.state, {source_, line_}, left->second);
    if (left->second > 0)
        go_after(head->line);
    else
        frame().repeats.erase(left);
    return {};
}

core::Result<const FlowMark*> Flowing::end_of_loop(std::string_view word) {
    FEELER_TRY(const FlowMark* const end,
               partner({end_while, end_repeat, while_loop}, true, "endwhile"));
    if (end->kind == end_repeat) return refuse_in_repeat(word);
    return end;
}

core::Result<void> Flowing::leave_loop() {
    FEELER_TRY(const FlowMark* const end, end_of_loop("break"));
    go_after(end->line);
    return {};
}

core::Result<void> Flowing::continue_loop_early() {
    FEELER_TRY(const FlowMark* const end, end_of_loop("continue"));
    set_line(end->line);
    return {};
}

/// GOTO: searches the block number from here to the end, then from the start.
core::Result<void> Flowing::jump() {
    if (step_.block.flow.kind == if_go_to) {
        FEELER_TRY(const bool taken, holds(step_.block));
        if (!taken) return {};
    }
    const auto line = line_of_block(step_.library, source_, std::stod(name_), line_);
    const bool is_computed = step_.block.flow.kind == go_to && step_.block.flow.label;
    if (!line)
        return refuse(fmt::format("there is no block N{} to go to{}", name_,
                                  is_computed ? cause_of_number(parameters_) : ""));
    const auto other = line_of_block(step_.library, source_, std::stod(name_), *line);
    if (other && *other != *line)
        step_.result.warnings.push_back(
            {Severity::warning, step_.block.flow.span,
             fmt::format("N{} is in lines {} and {}: the control jumps to the first one after this "
                         "block, or else to the first in the program",
                         name_, std::min(*line, *other), std::max(*line, *other))});
    set_line(*line);
    return {};
}

core::Result<void> Flowing::run() {
    if (auto named = find_name(); !named) return named;
    switch (step_.block.flow.kind) {
    case sub:
        return skip_sub();
    case call:
        return Flowing::call_sub();
    case return_value:
    case end_sub:
        return return_statement();
    case if_branch:
        warn_of_second_use();
        return take_branch();
    case else_if:
    case otherwise:
    case end_if:
        return end_if_statement();
    case while_loop:
        return while_statement();
    case end_while: {
        FEELER_TRY(const FlowMark* const head, partner({while_loop}, false, "while"));
        set_line(head->line);
        return {};
    }
    case repeat:
        return repeat_statement();
    case end_repeat:
        return end_repeat_statement();
    case break_loop:
        return leave_loop();
    case continue_loop:
        return continue_loop_early();
    case go_to:
    case if_go_to:
        return jump();
    case while_do: {
        if (!step_.block.flow.has_condition) return {};
        FEELER_TRY(const bool goes_on, holds(step_.block));
        return goes_on ? core::Result<void>{} : go_after_partner({end_do}, true, "END");
    }
    case end_do: {
        FEELER_TRY(const FlowMark* const head, partner({while_do}, false, "DO"));
        set_line(head->line);
        return {};
    }
    default:
        return {}; // statements that only mark a position
    }
}

} // namespace

core::Result<void> run_iso_flow(const FlowStep& step) {
    switch (step.block.flow.kind) {
    case do_loop:
    case program_number:
        return {}; // only marks a position; not worth an index of all lines
    default:
        return Flowing(step).run();
    }
}

namespace {

bool is_program_number(char c) { return upper(c) == 'O' || c == ':'; }

/// Reads only the head of an O word in a line with an error after it.
bool parse_head(Lexer lexer, const Dialect& dialect, Block& block) {
    if (!dialect.has_o_words || upper(lexer.peek()) != 'O') return false;
    block = {};
    return parse_flow_head(lexer, dialect, block).value_or(false) && block.flow.has_label;
}

bool may_begin_flow(char c) {
    return std::string_view("OIWDEG:").find(upper(c)) != std::string_view::npos && c != '\0';
}

} // namespace

namespace {

/// Finds the end of the text: the second tape mark, if the first is the first line.
class TapeMarks {
public:
    /// Whether the text ends at this line.
    bool end_at(std::string_view line) {
        Lexer lexer{.line = line};
        const char first = lexer.peek();
        if (first == '\0') return false;
        const bool is_mark = first == '%';
        const bool ends = is_mark && begun_ && opened_;
        opened_ = opened_ || (is_mark && !begun_);
        begun_ = true;
        return ends;
    }

private:
    bool begun_ = false, opened_ = false;
};

} // namespace

FlowIndex iso_index(const Program& program, const Dialect& dialect) {
    FlowIndex index;
    Block block;
    uint32_t scope = 0;
    std::vector<std::string> open_loops;
    TapeMarks tape_marks;
    for (size_t number = 1; program.has_line(number).value_or(false); ++number) {
        const auto line = static_cast<uint32_t>(number);
        Lexer lexer{.line = program.line(number), .line_number = line};
        if (dialect.has_o_words && tape_marks.end_at(lexer.line)) break;
        if (const auto block_number = take_block_number(lexer))
            index.numbers.push_back({*block_number, line});
        if (!may_begin_flow(lexer.peek())) continue;
        if (is_program_number(lexer.peek()) && !dialect.has_o_words) {
            ++lexer.at;
            if (const auto name = lexer.number()) {
                // Loops and branches do not extend into the next program of the file.
                scope = line;
                index.marks.push_back(
                    {FlowKind::program_number, label_of(name->value), line, scope});
            }
            continue;
        }
        if (!parse_line(program.line(number), line, dialect, block)
            && !parse_head(lexer, dialect, block)) {
            // An error only if the line is skipped.
            if (dialect.has_o_words && upper(lexer.peek()) == 'O')
                index.marks.push_back({FlowKind::none, {}, line, scope});
            continue;
        }
        if (block.flow.kind == FlowKind::none) continue;
        FlowMark mark{.kind = block.flow.kind, .line = line, .scope = scope};
        if (block.flow.has_label) mark.name = block.pool.names[block.flow.label_name];
        const auto open = std::find(open_loops.begin(), open_loops.end(), mark.name);
        if (mark.kind == FlowKind::do_loop) {
            open_loops.push_back(mark.name);
        } else if (mark.kind == FlowKind::while_loop && open != open_loops.end()) {
            mark.closes_do_loop = true;
            open_loops.erase(open);
        } else if (mark.kind == FlowKind::sub) {
            scope = line;
            mark.scope = 0;
        } else if (mark.kind == FlowKind::end_sub) {
            scope = 0;
            mark.scope = 0;
            open_loops.clear();
        }
        index.marks.push_back(std::move(mark));
    }
    return index;
}

} // namespace gcode
