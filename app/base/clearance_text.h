#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/sim/clearance.h"

namespace app {

/// What reports show of a clearance, mm.
struct ShownClearance {
    bool is_known = true;
    double lower = 0.0;
    std::optional<double> upper = {}; // empty: nothing was found closer than `lower`
    double allowance = 0.0;           // an upper bound below it is never rounded up to it
};

/// The bounds of a pair's clearance.
ShownClearance shown_clearance(const core::PairClearance& pair);

/// How the text of a clearance looks.
enum class ClearanceStyle : uint8_t {
    sentence,   // "1.900 to 1.999 mm", "1.999 mm", "at least 1.900 mm"
    column,     // "1.900-1.999", "1.999", ">= 1.900"
    lower_bound // "1.900", or ">= 1.900" without an upper bound
};

/// The text of a clearance, "unknown" if it is not known. Lower bounds are rounded down, upper
/// bounds up; bounds that differ by at most 1 um are one number, the lower bound.
std::string clearance_text(const ShownClearance& clearance, ClearanceStyle style);

/// The lower bound alone, from its number as text: "1.900", or ">= 1.900" without an upper bound.
std::string lower_bound_text(const std::string& number, bool has_upper);

/// What is shown if nothing is known about a clearance.
constexpr const char* unknown_clearance = "unknown";

} // namespace app
