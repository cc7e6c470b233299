#pragma once

#include <optional>

#include "core/base/transform.h"
#include "core/dbm/interval.h"
#include "core/geom/profile.h"

namespace core {

/// A convex piece of a profile, upright, moved straight from one place to another.
struct ElementSweep {
    ProfileElement element;
    Vec3 from = Vec3(0.0), to = Vec3(0.0); // places of the profile's origin
};

/// The stretch of a line along an axis that lies in the swept volume of a convex piece.
///
/// Shape:  the line runs along `axis`; `u` and `v` are its coordinates on the next two axes in
///         cyclic order (X: y, z; Y: z, x; Z: x, y).
/// Result: empty when the line misses the volume or only touches it. The ends lie in the volume up
///         to rounding (1e-9 mm within 2 m): the stretch is never longer than the true one.
/// Cost:   closed form for cylinders, cones and balls; some 100 evaluations for a rounded corner.
std::optional<Interval> line_interval(const ElementSweep& sweep, int axis, double u, double v);

/// The same for a whole profile at rest: the union over its pieces.
IntervalList line_intervals(const RevolvedProfile& profile, int axis, double u, double v);

/// The stretch of a line along an axis that lies in the swept volume of a convex piece whose own
/// axis may point anywhere; the sweep's places are those of the profile's origin.
///
/// Shape:  as line_interval has it.
/// Result: as line_interval has it, but the ends lie in the volume up to 1e-8 mm.
/// Cost:   closed form for cylinders, cones and balls; some 100 evaluations for a rounded corner.
std::optional<Interval> tilted_line_interval(const ElementSweep& sweep, const Mat3& stock_from_tool,
                                             int axis, double u, double v);

/// Whether the tool's axis points straight up, so that line_interval serves as well.
inline bool is_upright(const Mat3& stock_from_tool) {
    return stock_from_tool[2] == Vec3(0.0, 0.0, 1.0);
}

} // namespace core
