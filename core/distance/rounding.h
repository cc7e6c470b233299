#pragma once

#include <span>

#include "core/base/result.h"
#include "core/base/vec.h"

namespace core {

/// How far the material found on a scan line may extend beyond the body, mm; `reach` is the
/// distance of the farthest point of the body from the origin.
constexpr double scan_rounding(double reach) { return 1e-9 + 1e-11 * reach; }

/// Larger coordinates are rejected, mm.
constexpr double farthest_coordinate = 1e12;

/// The number of points, if they are valid as a body.
///
/// Errors:  no point; a coordinate that is not finite or beyond 1e12 mm; more than 2^31 points.
Result<size_t> checked_points(std::span<const Vec3> points);

} // namespace core
