#include "hwsim/fixed_point.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"

namespace hwsim {
namespace {

double rounded(double steps, Rounding rounding) {
    switch (rounding) {
    case Rounding::down:
        return std::floor(steps);
    case Rounding::up:
        return std::ceil(steps);
    case Rounding::nearest:
        break;
    }
    return core::round(steps);
}

} // namespace

core::Result<int32_t> fixed(double length, Rounding rounding) {
    // A product with a power of two is exact, so the only rounding is the requested one.
    const double steps = rounded(length * (1 << fraction_bits), rounding);
    if (!(steps >= least_coordinate && steps <= greatest_coordinate))
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("a length of {} mm does not fit into the coprocessor's 24 "
                                      "bits, which span {} to {} mm",
                                      length, length_of(least_coordinate),
                                      length_of(greatest_coordinate)));
    return static_cast<int32_t>(steps);
}

core::Result<uint32_t> threshold(double distance, double sample_step) {
    if (!(distance >= 0.0) || !(sample_step >= 0.0))
        return core::fail(core::ErrorCode::invalid_value,
                          "a minimum distance and a step along a segment must be 0 or more");
    FEELER_TRY(const int32_t steps, fixed(core::hypot(distance, 0.5 * sample_step), Rounding::up));
    return static_cast<uint32_t>(steps);
}

} // namespace hwsim
