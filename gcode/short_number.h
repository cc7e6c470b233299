#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gcode/lexer.h"

namespace gcode {

inline constexpr std::array powers_of_ten = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                             1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

/// Reads a number of at most 15 digits without blanks inside, as nearly all are; false when another
/// kind stands there, and nothing has changed then.
///
/// The digits make a whole number below 2^53, and the power of ten is below 10^16: both are exact,
/// so their quotient is rounded once, as the general way rounds it.
inline bool read_short_number(std::string_view line, size_t& at, Number& number) {
    const char* next = line.data() + at;
    const char* const end = line.data() + line.size();
    const bool negative = next < end && *next == '-';
    next += next < end && (*next == '-' || *next == '+');
    uint64_t digits = 0;
    const char* const first = next;
    for (; next < end && is_digit(*next); ++next)
        digits = digits * 10 + static_cast<uint64_t>(*next - '0');
    auto count = next - first;
    size_t behind_point = 0;
    const bool point = next < end && *next == '.';
    if (point) {
        const char* const fraction = ++next;
        for (; next < end && is_digit(*next); ++next)
            digits = digits * 10 + static_cast<uint64_t>(*next - '0');
        behind_point = static_cast<size_t>(next - fraction);
        count += next - fraction;
    }
    if (count == 0 || count > 15) return false;
    const char* behind = next;
    while (behind < end && is_blank(*behind)) ++behind;
    // Blanks may stand inside of a number.
    if (behind < end && (*behind == '.' || (behind > next && is_digit(*behind)))) return false;
    const double size = static_cast<double>(digits) / powers_of_ten[behind_point];
    number = {negative ? -size : size, point};
    at = static_cast<size_t>(next - line.data());
    return true;
}

} // namespace gcode
