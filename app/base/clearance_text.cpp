#include "app/base/clearance_text.h"

#include "core/sim/verdict.h"

namespace app {

ShownClearance shown_clearance(const core::PairClearance& pair) {
    const auto upper = pair.found() ? std::optional(pair.upper) : std::nullopt;
    return {.lower = pair.lower, .upper = upper, .allowance = pair.allowance.distance};
}

std::string clearance_text(const ShownClearance& clearance, ClearanceStyle style) {
    if (!clearance.is_known) return unknown_clearance;
    const std::string lower = core::clearance_at_least(clearance.lower);
    const bool is_sentence = style == ClearanceStyle::sentence;
    if (!clearance.upper && is_sentence) return "at least " + lower + " mm";
    if (!clearance.upper || style == ClearanceStyle::lower_bound)
        return lower_bound_text(lower, clearance.upper.has_value());
    const std::string bounds = core::bounds_below(clearance.lower, *clearance.upper,
                                                  clearance.allowance, is_sentence ? " to " : "-");
    return is_sentence ? bounds + " mm" : bounds;
}

std::string lower_bound_text(const std::string& number, bool has_upper) {
    return has_upper ? number : ">= " + number;
}

} // namespace app
