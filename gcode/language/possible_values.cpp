#include "gcode/language/expression.h"

namespace gcode {

PossibleValues::Range PossibleValues::common(const Range& a, const Range& b) {
    Range range;
    const bool low_is_a = a.low > b.low || (a.low == b.low && !a.has_low);
    range.low = low_is_a ? a.low : b.low;
    range.has_low = low_is_a ? a.has_low : b.has_low;
    const bool high_is_a = a.high < b.high || (a.high == b.high && !a.has_high);
    range.high = high_is_a ? a.high : b.high;
    range.has_high = high_is_a ? a.has_high : b.has_high;
    return range;
}

PossibleValues PossibleValues::within(const std::vector<Range>& allowed, bool vacant) const {
    PossibleValues left(may_be_vacant_ && vacant);
    left.ranges_.clear();
    for (const Range& own : ranges_)
        for (const Range& other : allowed) {
            const Range range = common(own, other);
            if (range.low < range.high
                || (range.low == range.high && range.has_low && range.has_high))
                left.ranges_.push_back(range);
        }
    return left;
}

PossibleValues PossibleValues::where(const ValueComparison& comparison, double equality,
                                     bool outcome) const {
    using enum Operation;
    const Operation operation = comparison.operation;
    const bool is_opposite =
        operation == not_equal || operation == greater || operation == greater_or_equal;
    const bool holds = outcome != is_opposite; // of "equal", "less or equal" and "less"
    const double with = comparison.with.value_or(0.0);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (operation == equal || operation == not_equal) {
        // A vacant variable equals only another vacant one.
        if (!comparison.with) return holds ? within({}, true) : within({Range{}}, false);
        const double low = with - equality, high = with + equality;
        if (holds) return within({{low, high, true, true}}, false);
        return within({{-infinity, low, false, false}, {high, infinity, false, false}}, true);
    }
    const bool is_less = operation == less || operation == greater_or_equal;
    const bool zero_is_below = is_less ? 0.0 < with : 0.0 <= with; // vacant counts as 0
    if (holds) return within({{-infinity, with, false, !is_less}}, zero_is_below);
    return within({{with, infinity, is_less, false}}, !zero_is_below);
}

} // namespace gcode
