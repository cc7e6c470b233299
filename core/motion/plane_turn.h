#pragma once

#include <optional>
#include <vector>

#include "core/motion/event.h"

namespace core {

struct Machine;

/// Positions through which the rotary axes go while the direction of the tool, as seen from the
/// work, turns evenly in the plane of its first and its last direction.
struct PlaneTurn {
    std::vector<AxisValues> positions; // at even fractions of the way, without the start; linear
                                       // axes are those of the start
    // The first position is reached before the tip moves, or the last after it: at a pole, a rotary
    // axis turns about the tool.
    bool begins_in_place = false, ends_in_place = false;
    double error = 0.0; // between the positions, the rotary axes are in all at most this far from
                        // moving evenly, radians
    double sine = 1.0;  // a lower bound of the sine of the angle between the tool and the nearest
                        // direction that it keeps while a rotary axis turns (the pole); 1 if only
                        // one axis moves at a time
};

/// The error with which motions are divided, radians.
constexpr double turn_error = 1e-5;

/// Turns the rotary axes from one position to another.
///
/// Result:  as few positions as keep `error` within `max_error`, or, from 1,024 on, within 1e-3.
///          Without an error, only the end if the machine has one rotary axis, if it only turns
///          about the tool, or if a single axis turns the tool in a plane. Empty if there are three
///          rotary axes, if the way passes too near to a pole, or if it does not lead to `to`.
/// Cost:    some us for each position.
/// Proof:   core/sim/README.md, "Turning in a plane".
std::optional<PlaneTurn> turn_in_plane(const Machine& machine, const AxisValues& from,
                                       const AxisValues& to, double max_error);

} // namespace core
