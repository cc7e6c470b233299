#pragma once

#include <vector>

#include "core/motion/event.h"
#include "gcode/exec/interpreter.h"

namespace gcode {

/// Turns canonical commands into motions of the machine. A plain value: where the machine is, and
/// which offsets are active, at the next command.
struct Lowering {
    Offsets offsets;
    Position machine;                   // gauge line
    double spindle_speed = 0.0;         // rev/min
    std::optional<size_t> other_axis{}; // the first axis that moved and that the machine lacks
    bool moved_tilted = false; // moved while the tool is meant to leave the direction of Z, and
                               // nobody knows how

    /// What a command does to the machine, in machine coordinates; empty for most modes and for
    /// messages. A program stop is a dwell of no length: the machine comes to rest.
    ///
    /// A motion along an arc keeps its shape; one whose ends are not all known becomes a feed
    /// between the coordinates that are, and one whose plane the offsets tilt or distort becomes
    /// chords within 0.001 mm of it. Where the machine is known, a rotary axis that takes the
    /// short way does, and a control that follows the tip gives paths of the tip.
    std::vector<core::Event> lower(const CanonicalCommand& command);
};

/// Before the first command; of a run that begins in a state.
Lowering initial_lowering(const InterpreterState& state);
Lowering initial_lowering(const Environment& environment);

/// The events of a whole block, in order.
std::vector<core::Event> lower(const BlockResult& block, Lowering& lowering);

} // namespace gcode
