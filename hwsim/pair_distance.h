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

/// How far a number lies outside an interval.
constexpr int64_t outside(int64_t value, int64_t min, int64_t max) {
    return value < min ? min - value : (value > max ? value - max : 0);
}

/// The squared distance between a record of the tool's side, moved by `offset`, and one of the
/// work's side: between an upright cylinder and an upright square post.
///
/// Exact if the cylinder has no radius; else its root is rounded up, so that the distance is less
/// than one step too large.
inline uint64_t squared_distance(const Record& tool, const FixedVec& offset, const Record& work) {
    const int64_t dx = outside(int64_t{tool.base[0]} + offset[0], int64_t{work.base[0]} - work.half,
                               int64_t{work.base[0]} + work.half);
    const int64_t dy = outside(int64_t{tool.base[1]} + offset[1], int64_t{work.base[1]} - work.half,
                               int64_t{work.base[1]} + work.half);
    const int64_t foot = int64_t{tool.base[2]} + offset[2];
    const int64_t below = int64_t{work.base[2]} - (foot + tool.run);
    const int64_t above = foot - (int64_t{work.base[2]} + work.run);
    const int64_t dz = std::max({below, above, int64_t{0}});
    int64_t level = dx * dx + dy * dy;
    if (tool.half > 0) {
        const int64_t apart = std::max(root_up(level) - tool.half, int64_t{0});
        level = apart * apart;
    }
    return static_cast<uint64_t>(level + dz * dz);
}

} // namespace hwsim
