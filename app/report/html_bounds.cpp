#include "app/report/html_bounds.h"

#include "core/sim/bound_text.h"

namespace app {

std::string bounds_text(double lower, std::optional<double> upper, double keep) {
    if (!upper) return core::clearance_at_least(lower) + " mm or more";
    return core::bounds_below(lower, *upper, keep, " to ") + " mm";
}

} // namespace app
