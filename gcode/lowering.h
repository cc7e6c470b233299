#pragma once

#include <vector>

#include "core/sim/event.h"
#include "gcode/interpreter.h"

namespace gcode {

/// Turns canonical commands into motions of the machine. A plain value: where the machine is, and
/// which offsets are active, at the next command.
struct Lowering {
    Offsets offsets;
    core::AxisPosition machine; // gauge line

    /// What a command does to the machine, in machine coordinates; empty for modes and messages.
    ///
    /// A motion along an arc keeps its shape; one whose ends are not all known becomes a feed
    /// between the coordinates that are.
    std::vector<core::Event> lower(const CanonicalCommand& command);
};

/// Before the first command.
Lowering initial_lowering(const Environment& environment);

/// The events of a whole block, in order.
std::vector<core::Event> lower(const BlockResult& block, Lowering& lowering);

} // namespace gcode
