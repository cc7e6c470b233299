#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "gcode/exec/frame.h"
#include "gcode/language/expression.h"
#include "gcode/language/parameters.h"
#include "gcode/text/shared.h"

namespace gcode {

struct Dialect;
struct InterpreterState;

/// Identifies a parameter: its number, or a hash of its name.
using ParameterKey = uint64_t;
ParameterKey key_of(double number);
ParameterKey key_of(std::string_view name);

/// A decision about the order of execution: a condition, or a count of repetitions.
struct LoopDecision {
    ProgramLine at;
    uint32_t column = 0;             // a line may hold several conditions
    size_t level = 0;                // call level
    std::array<double, 4> margins{}; // how far its comparisons are from changing
    size_t margin_count = 0;
    std::array<ParameterKey, 4> reads{}; // the parameters that it depends on
    size_t read_count = 0;
    bool reads_others = false;        // also system variables, or more parameters
    bool is_count = false;            // of repetitions
    bool holds = false;               // its result
    uint64_t time = 0, flip_time = 0; // of the last evaluation, and of the last other result
};

/// A backward jump, as often as the program takes it.
struct WatchedLoop {
    ProgramLine from, to;
    size_t level = 0;
    uint64_t time = 0;                     // of the last pass
    uint64_t unchanged = 0;                // passes in a row without a step towards the end
    uint64_t certain = 0;                  // passes of which nothing can change the decisions
    uint64_t receding = 0;                 // passes of which every decision moved away from the end
    std::vector<LoopDecision> decisions{}; // of the last pass
    // Parameters after the second pass in a row, to say what varies.
    Shared<Parameters> parameters{};
    std::shared_ptr<const Frame> frame{};
};

/// Finds endless loops.
///
/// Two methods. The hash of one state is stored at growing intervals, so that a recurring state is
/// found however long the loop is. And for each backward jump, the decisions of successive passes
/// are compared: a loop is endless if nothing that they depend on changes, and is taken as endless
/// if every decision moves away from ending it for very many passes.
///
/// Source: R. P. Brent, "An improved Monte Carlo factorization algorithm", 1980, section 7, for the
/// first.
struct LoopDetector {
    uint64_t jumps = 0, next_note = 1, noted = 0;
    uint64_t idle_jumps = 0; // backward jumps since the last motion
    uint64_t time = 0;       // of decisions, assignments and passes
    uint64_t unclear = 0;    // time of the last decision that cannot be compared
    uint64_t new_locals = 0; // time at which a call last got local parameters
    struct Written {
        ParameterKey key = 0;
        uint64_t time = 0;
    };
    std::vector<LoopDecision> decisions{};
    std::vector<Written> written{};
    std::vector<WatchedLoop> loops{};
};

/// Notes that a condition was evaluated. Without comparisons it is true unless its value is 0.
void note_condition(InterpreterState& state, uint32_t line, const ExpressionPool& pool,
                    Expression condition, const Margins& margins, Value value,
                    const Dialect& dialect);

/// The decision of a counting loop whether to run once more.
struct CountingPass {
    ProgramLine head;
    double left = 0.0; // from its variable to its last value
    bool goes_on = false;
    bool is_first = false;              // at the head
    std::array<Expression, 2> bounds{}; // the first and the last value
};
void note_counting(InterpreterState& state, const CountingPass& pass, const ExpressionPool& pool,
                   const Dialect& dialect);

/// Notes how many repetitions are left at a place.
void note_repetitions(InterpreterState& state, ProgramLine at, int64_t left);

/// Notes a jump or call whose target was computed.
void note_computed_target(InterpreterState& state);

/// Notes that a parameter was set.
void note_written(InterpreterState& state, ParameterKey key);

/// Notes that a call level with local parameters of its own begins.
void note_new_locals(InterpreterState& state);

/// Notes a motion.
void note_motion(InterpreterState& state);

/// Checks whether a backward jump belongs to a loop that never ends.
///
/// Errors: invalid_value if so, with the lines of the loop and the parameters that vary.
core::Result<void> detect_endless_loop(InterpreterState& state, ProgramLine from,
                                       const Dialect& dialect);

} // namespace gcode
