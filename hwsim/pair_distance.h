#pragma once

#include <cmath>

#include "hwsim/memory_line.h"

namespace hwsim {

/// The least integer whose square is at least `square`, for squares below 2^50. In the circuit: 25
/// stages, one subtraction each.
inline int64_t root_up(int64_t square) {
    // The root of a double is right to the last bit, so one step either way makes it exact.
    auto root = static_cast<int64_t>(std::sqrt(static_cast<double>(square)));
    while (root * root < square) ++root;
    while (root > 0 && (root - 1) * (root - 1) >= square) --root;
    return root;
}

/// The squared distance of two records whose axis and post are so far apart along X, Y and Z, the
/// cylinder having this radius. Exact without a radius; else the root is rounded up, so that the
/// distance is less than one step too large. It grows with each gap and shrinks with the radius.
inline uint64_t squared_distance(const std::array<int64_t, 3>& gap, int64_t radius) {
    int64_t level = gap[0] * gap[0] + gap[1] * gap[1];
    if (radius > 0) {
        const int64_t apart = std::max(root_up(level) - radius, int64_t{0});
        level = apart * apart;
    }
    return static_cast<uint64_t>(level + gap[2] * gap[2]);
}

/// The squared distance between a record of the tool's side, moved by `offset`, and one of the
/// work's side: between an upright cylinder and an upright square post.
inline uint64_t squared_distance(const Record& tool, const FixedVec& offset, const Record& work) {
    const auto beside = [&](size_t axis) {
        const int64_t apart = int64_t{tool.base[axis]} + offset[axis] - work.base[axis];
        return std::max(std::abs(apart) - work.half, int64_t{0});
    };
    const int64_t foot = int64_t{tool.base[2]} + offset[2];
    const int64_t below = work.base[2] - (foot + tool.run);
    const int64_t above = foot - (int64_t{work.base[2]} + work.run);
    return squared_distance({beside(0), beside(1), std::max({below, above, int64_t{0}})},
                            tool.half);
}

} // namespace hwsim
