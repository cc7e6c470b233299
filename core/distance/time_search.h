#pragma once

#include <functional>

#include "core/base/result.h"
#include "core/base/vec.h"

namespace core {

/// What is known of a distance during a stretch of time.
struct StretchBound {
    double lower = 0.0;      // at no time of the stretch is it less
    double upper = infinity; // at some time it is this
    double gain = infinity;  // by how much `lower` may still grow in halves of the stretch
};

/// What a search through time should find out.
struct TimeGoal {
    double limit = infinity; // mm: distances from here on do not count
    bool any = false;        // any distance below the limit will do
    double tolerance = 1e-3; // mm
    double known = infinity; // mm: found at some time already
};

/// The least distance over the time 0..1, from bounds over parts of it.
///
/// The stretch with the least bound is asked about next, and halved when it stays in question. A
/// bound must become tight as its stretch becomes short. `bound(from, to, worth)` need not tell
/// lengths of `worth` and more apart.
///
/// Result: `lower` holds for all times and is at most the limit; `upper` is the least of what was
///         found below the limit, else infinite. Unless any will do, they are no more than the
///         tolerance apart, or a quarter of it and what `bound` itself leaves open.
/// Errors: those of `bound`.
Result<StretchBound> least_over_time(
    const std::function<Result<StretchBound>(double from, double to, double worth)>& bound,
    const TimeGoal& goal);

} // namespace core
