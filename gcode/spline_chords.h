#pragma once

#include <vector>

#include "core/base/result.h"
#include "gcode/spline.h"

namespace gcode {

/// The ends of straight feeds along a curve, of which none is farther from it than the tolerance,
/// in mm. Where knots join the spans of the curve there is an end as well.
///
/// Result: the last one is the last control point.
/// Errors: weights cancel on the way; more than a million chords would be needed.
core::Result<std::vector<SplinePoint>> chords_within(const NurbsCurve& curve, double tolerance);

} // namespace gcode
