#include "core/distance/rounding.h"

#include <cmath>
#include <string>

namespace core {
namespace {

constexpr size_t most_points = size_t{1} << 31U; // nodes are counted in 32 bits

} // namespace

Result<size_t> checked_points(std::span<const Vec3> points) {
    if (points.empty())
        return fail(ErrorCode::missing_value, "a body without boundary points has no distance");
    if (points.size() > most_points)
        return fail(ErrorCode::invalid_value, "a body of more than 2^31 points is too large");
    for (size_t i = 0; i < points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(points[i][axis]) <= farthest_coordinate))
                return fail(ErrorCode::invalid_value,
                            "point " + std::to_string(i)
                                + " has a coordinate that is not finite or beyond 1e12 mm");
    return points.size();
}

} // namespace core
