#pragma once

#include "core/dbm/dbm.h"

namespace app {

/// A ring about Z, centred on the origin, mm; the tube is thinner than the ring.
struct Torus {
    double ring = 0.0; // radius of the circle in the middle of the tube
    double tube = 0.0; // radius across
};

/// A cylinder about Z, centred on the origin, with a bore that is open at the top, mm.
struct Cup {
    double radius = 0.0, height = 0.0;
    double bore = 0.0, depth = 0.0; // radius and length of the bore
};

/// What a line along `axis` at (u, v) of the two other axes, cyclically, meets of the body.
core::IntervalList line_of(const Torus& torus, int axis, double u, double v);
core::IntervalList line_of(const Cup& cup, int axis, double u, double v);

core::Aabb bounds(const Torus& torus);
core::Aabb bounds(const Cup& cup);

} // namespace app
