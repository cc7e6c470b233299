#include "gcode/exec/loop_detector.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/text/digest.h"

namespace gcode {
namespace {

using core::ErrorCode;

// More than these, and passes are not compared.
constexpr size_t most_decisions = 64, most_written = 64, most_loops = 16;

// Passes in a row.
constexpr uint64_t certain_passes = 4;         // with decisions that nothing changes
constexpr uint64_t receding_passes = 10'000;   // with every decision moving away from the end
constexpr uint64_t unchanged_passes = 500'000; // with no decision moving towards the end
constexpr uint64_t idle_jumps = 1'000'000;     // without a motion

constexpr double first_system_parameter = 1000.0;
constexpr ParameterKey last_local = 33, named_keys = ParameterKey{1} << 63;

/// A parameter that only assignments change: not a system variable, and none that the control sets,
/// as Klartext's Q100 to Q199.
bool is_plain_number(double number, const Dialect& dialect) {
    if (dialect.language == Language::klartext && number >= 100.0 && number < 200.0) return false;
    return number >= 0.0 && number < first_system_parameter && number == std::floor(number);
}

void add_read(LoopDecision& decision, ParameterKey key) {
    if (decision.read_count == decision.reads.size())
        decision.reads_others = true;
    else
        decision.reads[decision.read_count++] = key;
}

void add_reads(LoopDecision& decision, const ExpressionPool& pool, Expression condition,
               const Dialect& dialect) {
    for (uint32_t i = 0; i < condition.count; ++i) {
        const Instruction& step = pool.instructions[condition.first + i];
        if (step.operation == Operation::named) {
            const std::string& name = pool.names[step.name];
            // Names that begin with _ or $ may be system variables.
            if (name.starts_with('_') || name.starts_with('$'))
                decision.reads_others = true;
            else
                add_read(decision, key_of(name));
        } else if (step.operation == Operation::numbered) {
            const Instruction* number = i > 0 ? &(&step)[-1] : nullptr;
            if (number && number->operation == Operation::number
                && is_plain_number(number->number, dialect))
                add_read(decision, key_of(number->number));
            else
                decision.reads_others = true;
        } else if (step.operation == Operation::exists) {
            decision.reads_others = true;
        }
    }
}

/// The entry of a decision in the list of those made lately; null if the list is full.
LoopDecision* entry_of(LoopDetector& loops, const LoopDecision& decision) {
    const auto same = [&](const LoopDecision& made) {
        return made.at == decision.at && made.column == decision.column
               && made.level == decision.level;
    };
    auto& made = loops.decisions;
    if (const auto found = std::find_if(made.begin(), made.end(), same); found != made.end())
        return &*found;
    if (made.size() == most_decisions) return nullptr;
    made.push_back({.at = decision.at, .column = decision.column, .level = decision.level});
    return &made.back();
}

void note(InterpreterState& state, const LoopDecision& decision) {
    LoopDetector& loops = state.loops.write();
    ++loops.time;
    LoopDecision* entry = entry_of(loops, decision);
    if (!entry) {
        loops.unclear = loops.time;
        return;
    }
    const bool flips = entry->time > 0 && entry->holds != decision.holds;
    const uint64_t flip_time = flips ? loops.time : entry->flip_time;
    *entry = decision;
    entry->time = loops.time;
    entry->flip_time = flip_time;
}

WatchedLoop& loop_of(LoopDetector& loops, ProgramLine from, ProgramLine to, size_t level) {
    const auto same = [&](const WatchedLoop& loop) {
        return loop.from == from && loop.to == to && loop.level == level;
    };
    auto& known = loops.loops;
    auto found = std::find_if(known.begin(), known.end(), same);
    if (found != known.end()) return *found;
    if (known.size() == most_loops) {
        const auto older = [](const WatchedLoop& a, const WatchedLoop& b) {
            return a.time < b.time;
        };
        known.erase(std::min_element(known.begin(), known.end(), older));
    }
    known.push_back({.from = from, .to = to, .level = level});
    return known.back();
}

bool was_written_since(const LoopDetector& loops, ParameterKey key, uint64_t time) {
    const bool may_be_local = key <= last_local || key >= named_keys;
    if (may_be_local && loops.new_locals > time) return true;
    return std::any_of(loops.written.begin(), loops.written.end(),
                       [&](const auto& entry) { return entry.key == key && entry.time > time; });
}

/// Whether nothing that a decision depends on was set since a time.
bool is_fixed(const LoopDetector& loops, const LoopDecision& decision, uint64_t time) {
    if (decision.reads_others) return false;
    for (size_t i = 0; i < decision.read_count; ++i)
        if (was_written_since(loops, decision.reads[i], time)) return false;
    return true;
}

/// How the decisions of a pass differ from those of the pass before.
struct PassChange {
    bool fixed = true, receding = true, unchanged = true;
};

PassChange change_of(const LoopDetector& loops, const WatchedLoop& loop,
                     const std::vector<LoopDecision>& now) {
    if (loops.unclear > loop.time || now.size() != loop.decisions.size())
        return {false, false, false};
    PassChange change;
    for (size_t i = 0; i < now.size(); ++i) {
        const LoopDecision &a = loop.decisions[i], &b = now[i];
        if (a.at != b.at || a.column != b.column || a.level != b.level
            || a.margin_count != b.margin_count)
            return {false, false, false};
        const bool fixed = is_fixed(loops, b, loop.time);
        bool grows = b.margin_count > 0, stays = true;
        for (size_t j = 0; j < b.margin_count; ++j) {
            grows = grows && b.margins[j] > a.margins[j];
            stays = stays && b.margins[j] >= a.margins[j];
        }
        // The decision of a loop inside this one, which had both results in this pass.
        const bool is_inner = stays && (b.is_count || b.flip_time > loop.time);
        change.fixed = change.fixed && (fixed || (b.is_count && stays));
        change.receding = change.receding && (fixed || grows || is_inner);
        change.unchanged = change.unchanged && stays;
    }
    return change;
}

std::vector<LoopDecision> decisions_since(const LoopDetector& loops, uint64_t time) {
    std::vector<LoopDecision> made;
    for (const LoopDecision& decision : loops.decisions)
        if (decision.time > time) made.push_back(decision);
    return made;
}

std::string variation(std::string_view name, const Value& before, const Value& now) {
    const auto text = [](const Value& value) {
        return value ? fmt::format("{:.6g}", *value) : std::string("no value");
    };
    return fmt::format("{} goes from {} to {}", name, text(before), text(now));
}

/// Which parameters differ from those that a loop had in an early pass.
std::vector<std::string> variations(const InterpreterState& state, const WatchedLoop& loop,
                                    const Dialect& dialect) {
    constexpr size_t most = 3;
    std::vector<std::string> found;
    const auto compare = [&](const std::string& name, const Value& before, const Value& now) {
        if (before != now && found.size() < most) found.push_back(variation(name, before, now));
    };
    const auto shown = [&](const std::string& name) {
        return dialect.names_are_declared ? name : fmt::format("#<{}>", name);
    };
    const auto numbered = [&](size_t number) {
        const bool is_zero = dialect.has_parameter_zero && number == highest_parameter;
        return fmt::format("{}{}", dialect.parameter_letter, is_zero ? 0 : number);
    };
    const Frame& frame = state.frames.back();
    if (!loop.frame) return found;
    for (size_t i = 1; i < frame.locals.size(); ++i)
        compare(numbered(i), loop.frame->locals[i], frame.locals[i]);
    for (const auto& [name, value] : frame.named) {
        const auto before = loop.frame->named.find(name);
        compare(shown(name), before == loop.frame->named.end() ? Value{} : Value{before->second},
                value);
    }
    for (size_t i = 1; i < state.parameters->numbered_count(); ++i)
        compare(numbered(i), loop.parameters->numbered(static_cast<int>(i)),
                state.parameters->numbered(static_cast<int>(i)));
    for (const auto& [name, value] : state.parameters->named()) {
        const auto before = loop.parameters->named().find(name);
        compare(shown(name),
                before == loop.parameters->named().end() ? Value{} : Value{before->second}, value);
    }
    return found;
}

core::Error endless(const InterpreterState& state, const WatchedLoop& loop, const Dialect& dialect,
                    std::string_view why) {
    std::string where = fmt::format("line {}", loop.from.line);
    if (loop.to.source == loop.from.source && loop.to.line < loop.from.line)
        where = fmt::format("lines {} to {}", loop.to.line, loop.from.line);
    const std::vector<std::string> changes = variations(state, loop, dialect);
    return {ErrorCode::invalid_value,
            {.line = loop.from.line, .column = 1},
            fmt::format("the program never ends: the loop of {} {}{}", where, why,
                        changes.empty() ? std::string()
                                        : fmt::format("; {}", fmt::join(changes, ", ")))};
}

/// Compares this pass of a loop with the one before.
core::Result<void> compare_passes(InterpreterState& state, ProgramLine from,
                                  const Dialect& dialect) {
    LoopDetector& loops = state.loops.write();
    WatchedLoop& loop = loop_of(loops, from, state.next, state.frames.size());
    std::vector<LoopDecision> now = decisions_since(loops, loop.time);
    const bool is_first = loop.time == 0;
    const PassChange change =
        is_first ? PassChange{false, false, false} : change_of(loops, loop, now);
    loop.time = ++loops.time;
    loop.decisions = std::move(now);
    loop.certain = change.fixed ? loop.certain + 1 : 0;
    loop.receding = change.receding ? loop.receding + 1 : 0;
    loop.unchanged = change.unchanged ? loop.unchanged + 1 : 0;
    if (loop.unchanged == 2) {
        loop.parameters = state.parameters;
        loop.frame = std::make_shared<const Frame>(state.frames.back());
    }
    if (loop.certain >= certain_passes)
        return tl::unexpected(endless(state, loop, dialect,
                                      loop.decisions.empty()
                                          ? "has no condition that ends it"
                                          : "does not change what its conditions depend on"));
    if (loop.receding >= receding_passes)
        return tl::unexpected(endless(
            state, loop, dialect,
            fmt::format("has made {} passes, and each was further from its end", receding_passes)));
    if (loop.unchanged >= unchanged_passes)
        return tl::unexpected(endless(
            state, loop, dialect,
            fmt::format("has made {} passes, and none was nearer to its end", unchanged_passes)));
    return {};
}

/// Checks whether the program has come back to an earlier state, or makes no motion for very long.
core::Result<void> compare_states(InterpreterState& state, ProgramLine from) {
    constexpr uint64_t interval = 16; // jumps between two checks
    LoopDetector& loops = state.loops.write();
    ++loops.jumps;
    if (++loops.idle_jumps >= idle_jumps)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("the program has jumped back {} times without a motion, here to line {}: "
                        "it is stopped as if it never ends",
                        loops.idle_jumps, state.next.line),
            {.line = from.line, .column = 1});
    if (loops.jumps % interval != 0) return {};
    const uint64_t now = digest_of(state);
    if (now == loops.noted && loops.next_note > 1)
        return core::fail(
            ErrorCode::invalid_value,
            "the program never ends: it returns here in exactly the same state again and again",
            {.line = from.line, .column = 1});
    if (loops.jumps / interval < loops.next_note) return {};
    loops.noted = now;
    loops.next_note *= 2;
    return {};
}

} // namespace

ParameterKey key_of(double number) { return static_cast<ParameterKey>(number); }

ParameterKey key_of(std::string_view name) {
    Digest digest;
    digest.add(name);
    return digest.value() | named_keys;
}

void note_condition(InterpreterState& state, uint32_t line, const ExpressionPool& pool,
                    Expression condition, const Margins& margins, Value value,
                    const Dialect& dialect) {
    LoopDecision decision{.at = {state.next.source, line},
                          .column = condition ? pool.instructions[condition.first].column : 0,
                          .level = state.frames.size()};
    if (!margins.has_all()) return note_computed_target(state);
    decision.margins = margins.values;
    decision.margin_count = margins.count;
    if (margins.count == 0) { // a plain value: true unless it is 0
        decision.margins[0] = std::abs(value.value_or(0.0));
        decision.margin_count = 1;
    }
    decision.holds = value.value_or(0.0) != 0.0;
    add_reads(decision, pool, condition, dialect);
    note(state, decision);
}

void note_counting(InterpreterState& state, const CountingPass& pass, const ExpressionPool& pool,
                   const Dialect& dialect) {
    LoopDecision decision{.at = pass.head, .level = state.frames.size()};
    decision.margins[0] = std::abs(pass.left);
    decision.margin_count = 1;
    decision.holds = pass.goes_on;
    // After the first pass the variable decides, which the loop itself changes.
    decision.reads_others = !pass.is_first;
    for (const Expression bound : pass.bounds)
        if (bound) add_reads(decision, pool, bound, dialect);
    note(state, decision);
}

void note_repetitions(InterpreterState& state, ProgramLine at, int64_t left) {
    LoopDecision decision{.at = at, .level = state.frames.size()};
    decision.margins[0] = static_cast<double>(left);
    decision.margin_count = 1;
    decision.reads_others = decision.is_count = true;
    note(state, decision);
}

void note_computed_target(InterpreterState& state) {
    LoopDetector& loops = state.loops.write();
    loops.unclear = ++loops.time;
}

void note_written(InterpreterState& state, ParameterKey key) {
    LoopDetector& loops = state.loops.write();
    ++loops.time;
    for (LoopDetector::Written& entry : loops.written) {
        if (entry.key != key) continue;
        entry.time = loops.time;
        return;
    }
    if (loops.written.size() == most_written)
        loops.unclear = loops.time;
    else
        loops.written.push_back({key, loops.time});
}

void note_new_locals(InterpreterState& state) {
    LoopDetector& loops = state.loops.write();
    loops.new_locals = ++loops.time;
}

void note_motion(InterpreterState& state) {
    if (state.loops->idle_jumps > 0) state.loops.write().idle_jumps = 0;
}

core::Result<void> detect_endless_loop(InterpreterState& state, ProgramLine from,
                                       const Dialect& dialect) {
    const bool back = state.next.source != from.source || state.next.line <= from.line;
    if (!back) return {};
    if (auto checked = compare_states(state, from); !checked) return checked;
    return compare_passes(state, from, dialect);
}

} // namespace gcode
