#pragma once

#include <span>

#include "core/base/result.h"
#include "core/base/vec.h"

namespace core {

/// How far the matter that a scan found on a line may stand out of the body, mm; `reach` is that of
/// the body.
constexpr double scan_rounding(double reach) { return 1e-9 + 1e-11 * reach; }

/// Lengths beyond this are refused, mm.
constexpr double farthest_coordinate = 1e12;

/// The number of points, if a body can be made of them.
///
/// Errors: no point; a coordinate that is not finite or beyond 1e12 mm; more than 2^31 points.
Result<size_t> checked_points(std::span<const Vec3> points);

} // namespace core
