#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/result.h"
#include "gcode/exec/interpreter.h"

namespace gcode {

/// States of a run at intervals, from which any block of it can be reached again. The intervals
/// grow so that the memory per block stays below a bound however much the states hold.
class Checkpoints {
public:
    /// The bytes that a block may cost on average, once a run is longer than a few ten thousand.
    explicit Checkpoints(size_t bytes_per_block = 16) : bytes_per_block_(bytes_per_block) {}

    /// Takes note of the state in which a run is after so many results of Interpreter::next; to be
    /// called before each of them, in order.
    void note(uint64_t results, const InterpreterState& state);

    /// How much memory the states need, those parts that they share counted once.
    size_t memory() const { return memory_; }
    uint64_t interval() const { return interval_; }

    /// The state after so many results, which is as the run was there.
    ///
    /// Errors: those of Interpreter::next; invalid_value when the run is not that long.
    /// Cost: the blocks since the nearest checkpoint are carried out again, at most interval().
    core::Result<InterpreterState> state_after(uint64_t results, Interpreter& interpreter) const;

private:
    void add(const InterpreterState& state);
    void thin_out();

    size_t bytes_per_block_;
    uint64_t interval_ = 256;
    size_t memory_ = 0;
    std::vector<InterpreterState> states_{}; // the one at index i after i intervals
};

} // namespace gcode
