#pragma once

#include <vector>

#include "core/geom/profile.h"

namespace render {

/// A point of the outline of a body of revolution: how far from its axis at a height.
struct OutlinePoint {
    double r = 0.0, z = 0.0;

    bool operator==(const OutlinePoint&) const = default;
};

/// The outline of the union of a profile's pieces, from the tip up: begins and ends on the axis.
/// Roundings are chords within `sag` of them. Empty for an empty profile.
std::vector<OutlinePoint> outline_of(const core::RevolvedProfile& profile, double sag);

} // namespace render
