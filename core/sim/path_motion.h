#pragma once

#include <optional>

#include "core/sim/machine.h"
#include "core/sim/timing.h"

namespace core {

/// What the machine states of its axes; a speed that it does not state is no limit.
MachineLimits limits_of(const Machine& machine);

/// A motion along its path, for the planner.
///
/// Units:  the speed of a feed is along X, Y and Z if one of these moves, else along U, V and W,
///         else along the rotary axes, degrees.
///         Where the control follows the tip, along the tip's way.
/// Result: empty when nothing moves, when nobody knows how far it goes, for a feed of 0, and for a
///         dog-leg rapid, whose axes do not move along one path.
std::optional<PathMotion> path_motion(const Motion& motion, const Machine& machine);

/// Whether the axes move on their own, each from rest to rest.
bool is_dogleg(const Motion& motion, const Machine& machine);

/// How long the slowest axis of a dog-leg rapid needs, seconds: with its acceleration, and at full
/// speed all the way.
struct DoglegTime {
    double duration = 0.0;
    double at_full_speed = 0.0;
};

DoglegTime dogleg_time(const Motion& motion, const Machine& machine);

} // namespace core
