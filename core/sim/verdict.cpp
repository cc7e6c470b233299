#include "core/sim/verdict.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/text.h"

namespace core {
namespace {

double units_in_one(int digits) { return core::pow(10.0, digits); }

/// Difference that is ignored, in units of the last digit.
double nothing(int digits) { return std::min(5e-4, 0.5 * resolution * units_in_one(digits)); }

std::string text_of(double units, int digits) {
    return fmt::format("{:.{}f}", units / units_in_one(digits), digits);
}

/// Whether the bounds differ by at most one unit of the last digit, so that one number is enough.
bool are_one(double low, double high, int digits) {
    return units_above(high, digits) - units_below(low, digits) <= 1.0;
}

std::string both(double low, int low_digits, double high, int high_digits,
                 std::string_view between) {
    return at_least(low, low_digits) + std::string(between) + at_most(high, high_digits);
}

std::string interval_text(double lower, double upper, int upper_digits, int digits,
                          std::string_view between) {
    const double low = std::max(lower, 0.0), high = std::max(upper, low);
    if (are_one(low, high, digits)) return at_least(low, digits);
    return both(low, digits, high, upper_digits, between);
}

} // namespace

const char* name_of(BlockMotion motion) {
    switch (motion) {
    case BlockMotion::none:
        return "none";
    case BlockMotion::rapid:
        return "rapid";
    case BlockMotion::feed:
        return "feed";
    case BlockMotion::arc:
        return "arc";
    default:
        return "cycle";
    }
}

// Adding 0.0 avoids printing -0.

double units_below(double value, int digits) {
    return std::floor(value * units_in_one(digits) + nothing(digits)) + 0.0;
}

double units_above(double value, int digits) {
    return std::ceil(value * units_in_one(digits) - nothing(digits)) + 0.0;
}

std::string at_least(double lower, int digits) {
    return text_of(units_below(lower, digits), digits);
}

std::string at_most(double upper, int digits) {
    return text_of(units_above(upper, digits), digits);
}

std::string at_most_figures(double upper, int figures) {
    if (!(upper > 0.0)) return "0";
    const int before = static_cast<int>(std::floor(core::log10(upper))) + 1; // decimal point
    return without_trailing_zeros(at_most(upper, std::max(figures - before, 0)));
}

std::string clearance_at_least(double lower, int digits) {
    return at_least(std::max(lower, 0.0), digits);
}

int digits_below(double upper, double keep) {
    const double missing = keep - upper;
    return missing > resolution && missing < 0.0015 ? 6 : 3;
}

std::string bounds_text(double lower, double upper, std::string_view between, int digits) {
    return interval_text(lower, upper, digits, digits, between);
}

std::string missing_text(double least, double most, std::string_view between, int digits) {
    if (are_one(least, most, digits)) return at_most(most, digits);
    return both(least, digits, most, digits, between);
}

std::string bounds_below(double lower, double upper, double keep, std::string_view between) {
    return interval_text(lower, upper, digits_below(upper, keep), 3, between);
}

} // namespace core
