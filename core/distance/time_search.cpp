#include "core/distance/time_search.h"

#include <algorithm>
#include <vector>

namespace core {
namespace {

/// A stretch of time that is still in question.
struct Stretch {
    double lower;
    double from, to;
};

bool comes_after(const Stretch& x, const Stretch& y) {
    return x.lower != y.lower ? x.lower > y.lower : x.from > y.from;
}

constexpr double shortest = 1e-12; // rounding leaves nothing to be found in less

} // namespace

Result<StretchBound> least_over_time(
    const std::function<Result<StretchBound>(double from, double to, double worth)>& bound,
    const TimeGoal& goal) {
    std::vector<Stretch> queue = {{0.0, 0.0, 1.0}};
    StretchBound best{goal.limit, goal.known < goal.limit ? goal.known : infinity};
    const auto worth = [&] {
        return best.upper < goal.limit ? std::max(best.upper - goal.tolerance, 0.0) : goal.limit;
    };
    while (!queue.empty()) {
        std::pop_heap(queue.begin(), queue.end(), comes_after);
        const Stretch stretch = queue.back();
        queue.pop_back();
        const bool enough = best.upper == 0.0 || (goal.any && best.upper < goal.limit);
        if (enough || stretch.lower >= worth()) {
            best.lower = std::min(best.lower, stretch.lower); // of all that are left, the least
            break;
        }
        FEELER_TRY(const StretchBound found, bound(stretch.from, stretch.to, worth()));
        if (found.upper < std::min(best.upper, goal.limit)) best.upper = found.upper;
        const double lower = std::max(found.lower, stretch.lower);
        if (lower >= worth() || found.gain <= 0.25 * goal.tolerance
            || stretch.to - stretch.from < shortest) {
            best.lower = std::min(best.lower, lower);
            continue;
        }
        const double middle = 0.5 * (stretch.from + stretch.to);
        for (const Stretch& half :
             {Stretch{lower, stretch.from, middle}, Stretch{lower, middle, stretch.to}}) {
            queue.push_back(half);
            std::push_heap(queue.begin(), queue.end(), comes_after);
        }
    }
    best.lower = std::min(best.lower, best.upper);
    return best;
}

} // namespace core
