#pragma once

#include <array>
#include <cstdint>

#include "core/base/result.h"

namespace hwsim {

/// Lengths in the device are multiples of 2^-12 mm; coordinates are signed numbers of 24 bits.
constexpr int fraction_bits = 12;
constexpr double lsb = 1.0 / (1 << fraction_bits); // mm
constexpr int32_t least_coordinate = -(1 << 23);
constexpr int32_t greatest_coordinate = (1 << 23) - 1;

/// A point or a vector of the device.
using FixedVec = std::array<int32_t, 3>;

constexpr bool is_coordinate(int64_t value) {
    return value >= least_coordinate && value <= greatest_coordinate;
}

/// Rounding of a length between two steps. `nearest`: ties away from zero.
enum class Rounding : uint8_t { nearest, down, up };

/// Converts a length to steps of the device. There is no other conversion.
///
/// Result:  off by at most half a step (nearest), or by less than a step in the given direction;
///          exact for a whole number of steps.
/// Errors:  not a number, or beyond 24 bits after rounding.
core::Result<int32_t> fixed(double length, Rounding rounding);

/// Converts steps to mm, exactly.
constexpr double length_of(int32_t steps) { return steps * lsb; }

/// Error bound of the device's numbers, in steps (README.md, "Error bound").
constexpr uint32_t rounding_reserve = 3;

/// A minimum distance as the device compares it: T in d2 < (T + rounding_reserve)^2. `sample_step`
/// is the travel of the tool between two samples of a segment.
///
/// Errors:  a negative length, not a number, or beyond 24 bits.
core::Result<uint32_t> threshold(double distance, double sample_step);

/// A segment is refused below this squared distance.
constexpr uint64_t squared_limit(uint32_t threshold) {
    const uint64_t limit = uint64_t{threshold} + rounding_reserve;
    return limit * limit;
}

/// Larger than any squared distance: coordinates differ by less than 2^24, so squares of
/// differences are below 2^48 and the sum of three is below 2^50.
constexpr uint64_t beyond_all_squares = uint64_t{1} << 50;

} // namespace hwsim
