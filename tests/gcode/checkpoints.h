#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/result.h"
#include "gcode/exec/interpreter.h"

namespace gcode {

/// States of a run at intervals, from which any block can be reached again. The intervals grow so
/// that the average memory per block stays below a bound, however large the states are.
class Checkpoints {
public:
    /// Average bytes per block, once a run is longer than some ten thousand blocks.
    explicit Checkpoints(size_t bytes_per_block = 16) : bytes_per_block_(bytes_per_block) {}

    /// Offers the state of a run after a number of results of Interpreter::next. To be called
    /// before each call of next, in order.
    void note(uint64_t results, const InterpreterState& state);

    /// The memory of the stored states; shared parts are counted once.
    size_t memory() const { return memory_; }
    uint64_t interval() const { return interval_; }

    /// The state after a number of results, equal to that of the original run.
    ///
    /// Errors: those of Interpreter::next; invalid_value when the run is shorter.
    /// Cost: executes the blocks since the nearest checkpoint again, at most interval().
    core::Result<InterpreterState> state_after(uint64_t results, Interpreter& interpreter) const;

private:
    void add(const InterpreterState& state);
    void thin_out();

    size_t bytes_per_block_;
    uint64_t interval_ = 256;
    size_t memory_ = 0;
    std::vector<InterpreterState> states_{}; // index i: after i intervals
};

} // namespace gcode
