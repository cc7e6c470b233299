#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/motion/path.h"

namespace core {

/// The part of the path at a corner within which a control may leave it.
struct CornerRegion {
    std::vector<Leg> along; // the programmed path there, before and after the corner
    Leg hull;               // contains the rounded path; empty if rotary axes turn there
};

/// The greatest distance from the corner, along the path, at which a corner with this deviation is
/// rounded; `turn` is the change of direction, radians, above 0.
///
/// Source: docs/decisions/distance.md, "Rounded corners".
double rounding_reach(double deviation, double turn);

/// Length of a path in the linear axes, mm; for boxes of possible positions, at least that.
double length_of(std::span<const Leg> legs);

/// Whether the speeds and accelerations of all linear axes are known.
bool states_dynamics(const Machine& machine);

/// How far from a corner the control leaves the motion before it and the one after it, mm.
struct CornerReach {
    double before = infinity, after = infinity;
};

/// The reach of a corner between two rapids, given by their legs, at which the control does not
/// brake more than accelerations demand. Where the machine states them, and speeds, a motion cannot
/// be left farther from the corner than its speed and they make it; never beyond its middle.
///
/// Source: docs/decisions/distance.md, "Rapids that keep their speed".
CornerReach reach_at_speed(std::span<const Leg> before, std::span<const Leg> after,
                           const Machine& machine);

/// The region of the corner between two motions, given by their legs; empty if nothing is rounded:
/// no change of direction, no length, or no deviation.
///
/// `deviation`: greatest distance from the programmed path, mm. `reach`: where the rounding begins
/// and ends at most. If that is not known, it reaches at most to the middle of either motion, and
/// no farther than `rounding_reach`.
std::optional<CornerRegion> corner_region(std::span<const Leg> before, std::span<const Leg> after,
                                          double deviation, const CornerReach& reach = {});

} // namespace core
