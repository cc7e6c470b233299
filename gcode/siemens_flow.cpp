#include "gcode/siemens_flow.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gcode/parser.h"

namespace gcode {
namespace {

using core::ErrorCode;
using enum FlowKind;

tl::unexpected<core::Error> refuse_step(const FlowStep& step, std::string message) {
    return core::fail(ErrorCode::syntax, std::move(message), step.block.flow.span);
}

/// A flow statement, with what it needs of the program around it.
class SiemensFlowing {
public:
    explicit SiemensFlowing(const FlowStep& step)
        : step_(step),
          line_(step.block.line),
          source_(step.state.next.source),
          index_(step.library.index(source_)) {}

    core::Result<void> run();

private:
    core::Result<void> go_behind(uint32_t line) {
        step_.state.next.line = line + 1;
        return {};
    }
    core::Result<bool> holds(const SiemensArgument& condition) const {
        FEELER_TRY(const double value, value_of_argument(step_, condition));
        return value != 0.0;
    }
    const FlowMark* structure() const;
    core::Result<uint32_t> partner(std::string_view wanted) const;
    core::Result<void> jump();
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

/// The mark of this line that is no label.
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

/// GOTOF looks towards the end of the program, GOTOB towards its beginning, GOTO and GOTOC first
/// there, then here.
std::optional<uint32_t> SiemensFlowing::line_of(const SiemensJump& jump) const {
    const ProgramLines lines = lines_around(index_, line_);
    if (jump.way == JumpWay::to_start) return lines.begin;
    std::optional<uint32_t> found;
    if (jump.way != JumpWay::backward) found = first_in(jump.target, line_ + 1, lines.end);
    if (!found && jump.way != JumpWay::forward)
        found = last_in(jump.target, lines.begin, line_ + 1);
    return found;
}

core::Result<void> SiemensFlowing::jump() {
    for (const SiemensJump& jump : step_.block.siemens.jumps) {
        bool goes = true;
        if (jump.condition.kind != SiemensArgument::Kind::nothing) {
            FEELER_TRY(goes, holds(jump.condition));
        }
        if (!goes) continue;
        if (const auto line = line_of(jump)) {
            step_.state.next.line = *line;
            return {};
        }
        if (jump.way == JumpWay::quietly) return {};
        const std::string_view where = jump.way == JumpWay::forward    ? "behind this block"
                                       : jump.way == JumpWay::backward ? "before this block"
                                                                       : "in this program";
        const SiemensJump either{.target = jump.target};
        return core::fail(ErrorCode::syntax,
                          fmt::format("there is no {} {} to go to{}", jump.target, where,
                                      line_of(either) ? "; it stands on the other side, for which "
                                                        "GOTO or the other of GOTOF and GOTOB is"
                                                      : ""),
                          jump.span);
    }
    return {};
}

core::Result<void> SiemensFlowing::begin_loop(std::string_view end) {
    FEELER_TRY(const bool goes_on, holds(step_.block.siemens.arguments[0]));
    if (goes_on) return {};
    FEELER_TRY(const uint32_t line, partner(end));
    return go_behind(line);
}

/// FOR, whose variable has its first value, or ENDFOR, which counts on.
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
    FEELER_TRY(const double last, value_of_argument(at_head, block.siemens.arguments[0]));
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
    }
    if (now <= last) return begins ? core::Result<void>{} : go_behind(other);
    return begins ? go_behind(other) : core::Result<void>{};
}

/// `REPEAT BEGIN END P=5`: the lines from one label to the other, or to this block, five times
/// more. Only blocks before this one are looked at, as on the control.
core::Result<void> SiemensFlowing::repeat_part() {
    const auto& jumps = step_.block.siemens.jumps;
    auto& repeats = step_.state.frames.back().repeats;
    const ProgramLines lines = lines_around(index_, line_);
    double count = 1.0;
    if (step_.block.siemens.repeats.kind != SiemensArgument::Kind::nothing) {
        FEELER_TRY(count, value_of_argument(step_, step_.block.siemens.repeats));
    }
    const auto begin = last_in(jumps[0].target, lines.begin, line_);
    if (!begin)
        return refuse_step(step_,
                           fmt::format("REPEAT: there is no {} before this block to repeat from",
                                       jumps[0].target));
    if (jumps.size() > 1)
        return core::fail(ErrorCode::unsupported,
                          "REPEAT with two labels is not supported yet: put it behind the last "
                          "block that is to be repeated, with the first label alone",
                          step_.block.flow.span);
    const auto rounds = static_cast<int64_t>(std::clamp(count, 0.0, 1e15));
    int64_t& left = repeats.try_emplace(line_, rounds).first->second;
    if (left > 0) {
        --left;
        step_.state.next.line = *begin;
    } else {
        repeats.erase(line_);
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
        return go_behind(line);
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
        FEELER_TRY(const bool is_done, holds(step_.block.siemens.arguments[0]));
        return is_done ? core::Result<void>{} : go_behind(line);
    }
    case FlowKind::repeat_part:
        return SiemensFlowing::repeat_part();
    case end_if:
        if (auto found = partner("IF"); !found) return tl::unexpected(std::move(found).error());
        return {};
    default:
        return {}; // LOOP and REPEAT, which only mark a place
    }
}

core::Result<void> return_from(const FlowStep& step) {
    if (step.state.frames.size() > 1)
        leave(step.state);
    else
        step.state.ending = Ending::main_return;
    return {};
}

} // namespace

ProgramLines lines_around(const FlowIndex& index, uint32_t line) {
    ProgramLines lines;
    for (const FlowMark& mark : index.marks) {
        if (mark.kind != program_number) continue;
        if (mark.line <= line) lines.begin = mark.line + 1;
        if (mark.line > line && lines.end == UINT32_MAX) lines.end = mark.line;
    }
    return lines;
}

double held_as(SiemensType type, double value) {
    if (type == SiemensType::whole) return std::round(value);
    if (type == SiemensType::truth) return value != 0.0 ? 1.0 : 0.0;
    return value;
}

core::Result<double> value_of_argument(const FlowStep& step, const SiemensArgument& argument) {
    if (argument.kind == SiemensArgument::Kind::text)
        return core::fail(ErrorCode::syntax,
                          fmt::format("\"{}\": a number belongs here, not a text", argument.text),
                          argument.span);
    if (!argument.expression) return argument.plain;
    const ProgramParameters parameters(step.state, step.environment);
    FEELER_TRY(const Value value, evaluate(step.block.pool, argument.expression, step.block.line,
                                           parameters, step.dialect.arithmetic));
    return value.value_or(0.0);
}

core::Result<void> run_siemens_flow(const FlowStep& step) {
    switch (step.block.flow.kind) {
    case endless_loop:
    case repeat:
        return {}; // says where something is; not worth an index of all lines
    case declaration:
        return declare_variables(step);
    case procedure:
        return {}; // its parameters were set by the call
    case call_program:
        return call_siemens_program(step);
    case FlowKind::give_back:
        return return_from(step);
    default:
        return SiemensFlowing(step).run();
    }
}

} // namespace gcode
