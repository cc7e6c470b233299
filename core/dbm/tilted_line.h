#pragma once

#include "core/base/transform.h"
#include "core/dbm/swept_line.h"

namespace core {

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
