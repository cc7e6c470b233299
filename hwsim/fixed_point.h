#pragma once

#include <array>
#include <cstdint>

#include "core/base/result.h"

namespace hwsim {

/// Lengths in the device count steps of 2^-12 mm; coordinates are signed numbers of 24 bits.
constexpr int fraction_bits = 12;
constexpr double lsb = 1.0 / (1 << fraction_bits); // mm
constexpr int32_t least_coordinate = -(1 << 23);
constexpr int32_t greatest_coordinate = (1 << 23) - 1;

/// A point or a vector of the device.
using FixedVec = std::array<int32_t, 3>;

constexpr bool is_coordinate(int64_t value) {
    return value >= least_coordinate && value <= greatest_coordinate;
}

/// Where a length between two steps goes. `nearest`: ties away from zero.
enum class Rounding : uint8_t { nearest, down, up };

/// The only way of a length into the device.
///
/// Result: off by at most half a step (nearest), or by less than a step to the side asked for;
///         a length that is a whole number of steps stays exactly that.
/// Errors: not a number, or beyond 24 bits once rounded.
core::Result<int32_t> fixed(double length, Rounding rounding);

/// The way back, exact.
constexpr double length_of(int32_t steps) { return steps * lsb; }

/// What the numbers of the device may hide, in steps (README.md, "Error bound").
constexpr uint32_t rounding_reserve = 3;

/// A distance to be kept, as the device compares it: T of d2 < (T + rounding_reserve)^2.
/// `sample_step` is how far the tool goes from one sample of a segment to the next.
///
/// Errors: a negative length or none, or one beyond 24 bits.
core::Result<uint32_t> threshold(double distance, double sample_step);

/// The squared distance below which a segment is refused.
constexpr uint64_t squared_limit(uint32_t threshold) {
    const uint64_t limit = uint64_t{threshold} + rounding_reserve;
    return limit * limit;
}

/// More than any squared distance: coordinates differ by less than 2^24, so squares of differences
/// are below 2^48 and the sum of three below 2^50.
constexpr uint64_t beyond_all_squares = uint64_t{1} << 50;

} // namespace hwsim
