#include <fmt/format.h>

#include "app/tolerance/tolerances.h"
#include "core/base/units.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

constexpr const char* axis_names[] = {"X", "Y", "Z"};

/// A limit, rounded down: "12.4", "0.03", "20".
std::string shown(double by, bool inch) {
    std::string text =
        inch ? core::at_least(by / core::mm_per_inch, 4) : core::at_least(by, by < 1.0 ? 3 : 2);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text;
}

} // namespace

std::string title_of(const Deviation& deviation) {
    if (deviation.is_place())
        return fmt::format("{} {}", deviation.subject(), axis_names[deviation.axis]);
    const char* what = deviation.quantity == Quantity::tool_length ? "length"
                       : deviation.quantity == Quantity::stick_out ? "stick-out"
                                                                   : "diameter";
    return fmt::format("{}, {}", deviation.subject(), what);
}

std::string range_text(const Tolerance& tolerance, bool inch) {
    if (!tolerance.not_studied.empty()) return "not studied: " + tolerance.not_studied;
    if (!tolerance.unknown.empty()) return "not known: " + tolerance.unknown;
    const ToleranceLimit &less = tolerance.less, &more = tolerance.more;
    const char* unit = inch ? "in" : "mm";
    const std::string low = shown(less.by, inch), high = shown(more.by, inch);
    if (less.is_open && more.is_open && less.by == more.by)
        return fmt::format("{} {} or more either way", low, unit);
    return fmt::format("{}{}{} to {}{}{} {}", low == "0" ? "" : "-", low,
                       less.is_open ? " or more" : "", high == "0" ? "" : "+", high,
                       more.is_open ? " or more" : "", unit);
}

std::string limit_text(const ToleranceLimit& limit) {
    if (limit.is_open || !limit.not_shown) return {};
    std::string bodies = "not shown to stay clear";
    if (limit.pair[1] == "limit")
        bodies = fmt::format("{} reaches its limit", limit.pair[0]);
    else if (!limit.pair[0].empty())
        bodies = fmt::format("{}{} near {}", limit.pair[0],
                             limit.tool ? fmt::format(" of tool {}", core::value_of(*limit.tool))
                                        : std::string(),
                             limit.pair[1]);
    if (limit.line == 0) return bodies;
    return fmt::format("line {}{}: {}", limit.line,
                       limit.file.empty() ? std::string() : " of " + limit.file, bodies);
}

} // namespace app
