#pragma once

#include <vector>

#include "core/base/vec.h"

namespace core {

/// A convex piece of a body of revolution about Z: the truncated cone from (r0, z0) up to (r1, z1),
/// grown by `margin` all round. A ball is a point with a margin, a rounded corner a disc with one.
struct ProfileElement {
    double z0 = 0.0, r0 = 0.0; // lower rim, mm; r >= 0, z0 <= z1
    double z1 = 0.0, r1 = 0.0; // upper rim
    double margin = 0.0;
};

/// A body of revolution about Z, as the union of convex pieces.
struct RevolvedProfile {
    std::vector<ProfileElement> elements;

    bool empty() const { return elements.empty(); }
};

Aabb bounds(const ProfileElement& element);
Aabb bounds(const RevolvedProfile& profile);

} // namespace core
