#pragma once

#include <vector>

#include "core/motion/event.h"
#include "gcode/exec/interpreter.h"

namespace gcode {

/// Straight motions in place of an arc, each even in all axes.
struct ArcChords {
    std::vector<Position> ends;
    double error = 0.0; // largest distance of one of them from the arc, mm
};

/// About as many chords as an error of `chord_error` needs. The arc begins at `from` and turns by
/// `angle`, positive from the plane's first axis towards its second, about a centre along these
/// axes; in the same coordinates. A radius that changes does so evenly.
ArcChords chords_of_arc(const Position& from, const Position& end, const PlaneAxes& axes,
                        const double (&centre)[2], double angle, double chord_error);

/// Turns canonical commands into motions of the machine. A plain value: the position of the machine
/// and the active offsets before the next command.
struct Lowering {
    Offsets offsets;
    Position machine;                   // gauge line
    double spindle_speed = 0.0;         // rev/min
    std::optional<size_t> other_axis{}; // first axis that moved but that the machine does not have
    bool moved_tilted = false;          // moved with the tool tilted in an unknown way
    bool blends_like_linuxcnc = false;  // many commands between motions bring it to rest

    /// The events of a command in machine coordinates; empty for most modes and for messages. A
    /// program stop is a dwell of zero length: the machine comes to rest.
    /// An arc keeps its shape. An arc whose ends are not all known becomes a feed move between the
    /// known coordinates; one whose plane the offsets tilt or distort becomes chords within 0.001
    /// mm of it. If the machine is known, its rotary axes take the short way if they are built so,
    /// and tool centre point control gives paths of the tip, several where rotary axes do not turn
    /// evenly. `settles` is Motion::settles.
    std::vector<core::Event> lower(const CanonicalCommand& command, core::AxisSet settles = 0);
};

/// The state before the first command, or that of a run that starts in a given state.
Lowering initial_lowering(const InterpreterState& state);
Lowering initial_lowering(const Environment& environment);

/// The events of a whole block, in order.
std::vector<core::Event> lower(const BlockCommands& block, Lowering& lowering);

} // namespace gcode
