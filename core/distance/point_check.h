#pragma once

#include <span>

#include "core/base/result.h"
#include "core/base/vec.h"

namespace core {

/// The number of points, if a body can be made of them.
///
/// Errors: no point; a coordinate that is not finite or beyond 1e12 mm; more than 2^31 points.
Result<size_t> checked_points(std::span<const Vec3> points);

} // namespace core
