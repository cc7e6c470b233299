#pragma once

#include "app/session/recorded_run.h"

namespace app {

/// The control alone along a record: what it holds at each place, without moving anything.
///
/// Cost: some microseconds a block, far less than running it.
class ControlWalk {
public:
    /// Begins at a place. The run must outlive it, and is not changed meanwhile.
    ControlWalk(RecordedRun& run, size_t place);

    size_t place() const { return place_; }
    const gcode::InterpreterState& control() const { return control_; }

    /// Goes on by a block that the record holds.
    void advance();

private:
    RecordedRun& run_;
    size_t place_;
    gcode::Interpreter interpreter_;
    gcode::InterpreterState control_;
};

} // namespace app
