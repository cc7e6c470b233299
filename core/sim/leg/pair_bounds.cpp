#include "core/sim/leg/pair_bounds.h"

#include <algorithm>

#include "core/motion/path.h"
#include "core/sim/setup.h"

namespace core {

void merge(TrackedPair& known, const PairClearance& later) {
    merge(static_cast<PairClearance&>(known), later);
    known.at_end = later.lower;
    known.drift = 0.0;
}

TrackedPair& entry(std::vector<TrackedPair>& pairs, const Pair& pair, const Setup& setup) {
    for (TrackedPair& known : pairs)
        if (known.pair == pair) return known;
    TrackedPair begun;
    begun.pair = pair;
    begun.allowance = allowance_of(setup, pair);
    pairs.push_back(begun);
    return pairs.back();
}

bool stays_away(TrackedPair& known, const Leg& leg, const RelativeLeg& relative) {
    if (!leg.straight || known.at_end - relative.travel < known.upper) return false;
    known.at_end -= relative.travel;
    return true;
}

bool is_far(TrackedPair& known, double apart, double search_limit) {
    if (apart < std::min(known.upper, search_limit)) return false;
    known.lower = std::min(known.lower, search_limit);
    known.at_end = apart;
    return true;
}

Separation widened(Separation found, const RelativeLeg& leg) {
    found.lower = std::max(0.0, found.lower - leg.error);
    found.upper += leg.error;
    return found;
}

RevolvedProfile certain_sweep(const RevolvedProfile& part, const RelativeLeg& leg) {
    return leg.turns ? RevolvedProfile{} : shrunk_within(part, leg.error_without_deviation());
}

double greatest_travel(const Machine& machine, const Leg& leg) {
    if (!leg.straight) return infinity;
    Vec3 by(0.0);
    for (size_t i = 0; i < axis_count; ++i) {
        const double travel = std::abs(leg.positions.back()[i] - leg.positions.front()[i]);
        if (travel == 0.0) continue;
        if (is_rotary(i)) return infinity;
        by += travel * glm::abs(machine.axes[i].direction);
    }
    return glm::length(by);
}

void PairBounds::end_leg(const std::function<double(const Pair&)>& travel_of) {
    for (PairBound& bound : memory_.bounds) {
        const bool is_known = travel_ < infinity || !travel_of;
        const double travel = is_known ? travel_ : travel_of(bound.pair);
        bound.apart -= travel;
        bound.drift += travel_ < infinity ? 0.0 : travel;
    }
    goes_on_ = false;
}

TrackedPair& PairBounds::tracked_pair(std::vector<TrackedPair>& pairs, const Pair& pair) const {
    for (TrackedPair& known : pairs)
        if (known.pair == pair) return known;
    TrackedPair& begun = entry(pairs, pair, setup_);
    for (const PairBound& bound : memory_.bounds)
        if (bound.pair == pair) {
            begun.at_end = bound.apart;
            begun.drift = bound.drift;
        }
    return begun;
}

bool PairBounds::can_skip(TrackedPair& known, const std::vector<TrackedPair>& pairs,
                          double travel) const {
    const double apart = known.at_end - travel;
    if (!cannot_decide(known.allowance, apart, pairs)) return false;
    known.lower = std::min({known.lower, apart, setup_.search_limit});
    known.at_end = apart;
    known.drift += travel;
    return true;
}

bool PairBounds::cannot_decide(const Allowance& allowance, double lower,
                               const std::vector<TrackedPair>& pairs) const {
    if (setup_.detail == Detail::every_pair) return false;
    const double required = allowance.distance + resolution + memory_.off_path;
    if (setup_.detail == Detail::verdict) return lower > required;
    double least = infinity;
    for (const TrackedPair& other : pairs)
        if (other.found()) least = std::min(least, other.margin());
    return lower > required && lower >= std::min(least + required, setup_.search_limit);
}

bool PairBounds::can_probably_skip(const TrackedPair& known) const {
    const double apart = known.at_end - travel_;
    const double required = known.allowance.distance + resolution + memory_.off_path;
    constexpr double slack = 0.1; // mm: the next block often has that much more room
    // If the pair decides after all, a bound with much drift is a poor one. For bodies away from
    // the flutes, check_late gives a better one.
    const double most_drift = is_below_holder(known.pair.part) ? 2.0 : std::max(2.0, 0.25 * apart);
    if (known.drift + travel_ > most_drift) return false;
    return setup_.detail == Detail::deciding_pair && memory_.deciding
           && !(known.pair == *memory_.deciding) && apart > required
           && apart - required > memory_.margin + 2.0 * travel_ + slack;
}

void PairBounds::carry_bound(const Pair& pair, std::vector<TrackedPair>& pairs) const {
    for (TrackedPair& known : pairs)
        if (known.pair == pair) known.at_end -= travel_;
}

} // namespace core
