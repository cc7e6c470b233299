#pragma once

#include <limits>
#include <vector>

#include "gcode/language/expression.h"

namespace gcode {

/// The values that a variable can still have after some comparisons with known values, if only the
/// machine knows the variable.
class PossibleValues {
public:
    /// Any number; where unset variables are vacant, it may also be vacant.
    explicit PossibleValues(bool may_be_vacant) : may_be_vacant_(may_be_vacant) {}

    /// Those for which a comparison has this outcome. `equality`: as in Arithmetic.
    PossibleValues where(const ValueComparison& comparison, double equality, bool outcome) const;

    bool is_empty() const { return ranges_.empty() && !may_be_vacant_; }

    bool operator==(const PossibleValues&) const = default;

private:
    struct Range {
        double low = -std::numeric_limits<double>::infinity();
        double high = std::numeric_limits<double>::infinity();
        bool has_low = false, has_high = false; // whether the ends belong to it

        bool operator==(const Range&) const = default;
    };

    static Range common(const Range& a, const Range& b);
    PossibleValues within(const std::vector<Range>& allowed, bool vacant) const;

    std::vector<Range> ranges_{Range{}}; // in ascending order, apart from each other
    bool may_be_vacant_;
};

} // namespace gcode
