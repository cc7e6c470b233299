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

/// The region of the corner between two motions, given by their legs; empty if nothing is rounded:
/// no change of direction, no length, or no deviation.
///
/// `deviation`: greatest distance from the programmed path, mm. `distance`: the rounding begins and
/// ends at most this far from the corner, mm along the path. If that is not known, it reaches at
/// most to the middle of either motion, and no farther than `rounding_reach`.
std::optional<CornerRegion> corner_region(std::span<const Leg> before, std::span<const Leg> after,
                                          double deviation, double distance = infinity);

} // namespace core
