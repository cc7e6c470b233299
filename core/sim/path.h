#pragma once

#include <optional>
#include <vector>

#include "core/sim/machine.h"

namespace core {

/// A piece of a motion that is checked as a whole.
///
/// `straight`: the gauge line moves from the first of two places to the second. Else it takes some
/// way through the hull of the places, and only `certain` ones are known to be on it.
struct Leg {
    std::vector<Vec3> places; // machine frame
    double begin = 0.0;       // seconds after the motion's start
    double end = 0.0;
    double path_error = 0.0; // the true path stays this near to the leg, mm
    bool straight = true;
    bool start_known = true; // false: the machine may come from anywhere within its limits
    std::vector<Vec3> certain = {};
};

/// A motion as legs, in order. Empty when an axis may stand anywhere.
struct Path {
    std::vector<Leg> legs;
    double duration = 0.0;      // seconds
    bool assumed_speed = false; // a rapid on an axis whose speed is not stated
};

/// What rapids run at on axes whose speed is not stated, mm/min.
constexpr double assumed_rapid = 10'000.0;

/// Chords of an arc stay within this of it, mm.
double chord_error(double mesh_size);

/// The legs of a motion.
///
/// Shape: a straight move is one leg; an arc or helix is chords that stay within `max_error` of it;
///        a dog-leg rapid is a leg for each change of direction, or one box of the axes that move
///        when speeds are unknown; a motion from an unknown place is the hull of the limits.
Path path_of(const Motion& motion, const Machine& machine, double max_error);

/// The least and greatest value of each axis over a motion whose ends are known.
Aabb axis_range(const Motion& motion);

} // namespace core
