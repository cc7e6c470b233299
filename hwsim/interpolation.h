#pragma once

#include "hwsim/segment.h"

namespace hwsim {

/// Where the tool stands at sample `k`, 0 .. 2^log2_steps: the true place rounded to the nearest
/// step, ties upwards. One product of 13 by 25 bits for each axis.
///
/// Along each axis it never turns back, so the box round any two samples holds those between.
constexpr FixedVec offset_at(const Segment& segment, uint32_t k) {
    FixedVec at{};
    const int64_t half = (int64_t{1} << segment.log2_steps) >> 1;
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t way = int64_t{segment.end[axis]} - segment.start[axis];
        const int64_t part = (static_cast<int64_t>(k) * way + half) >> segment.log2_steps;
        at[axis] = static_cast<int32_t>(segment.start[axis] + part);
    }
    return at;
}

} // namespace hwsim
