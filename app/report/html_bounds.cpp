#include "app/report/html_bounds.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/report/html_columns.h"

namespace app {
namespace {

std::string mm_text(int64_t um) { return fmt::format("{:.3f}", 1e-3 * static_cast<double>(um)); }

} // namespace

std::string mm_at_least(double lower) { return mm_text(clearance_um(lower)); }

std::string mm_at_most(double upper) { return mm_text(um_above(upper)); }

std::string bounds_text(double lower, std::optional<double> upper) {
    const int64_t least = clearance_um(lower);
    if (!upper) return mm_text(least) + " mm or more";
    const int64_t most = std::max(um_above(*upper), least);
    // One number says it where they differ by no more than what is printed.
    if (most - least <= 1) return mm_text(least) + " mm";
    return mm_text(least) + " to " + mm_text(most) + " mm";
}

} // namespace app
