#include "core/sim/leg/pair_entry.h"

#include "core/motion/path.h"
#include "core/sim/setup.h"

namespace core {

PairClearance& entry(std::vector<PairClearance>& pairs, const Pair& pair, const Setup& setup) {
    for (PairClearance& known : pairs)
        if (known.pair == pair) return known;
    pairs.push_back({.pair = pair, .allowance = allowance_of(setup, pair)});
    return pairs.back();
}

bool stays_away(PairClearance& known, const Leg& leg, const RelativeLeg& relative) {
    if (!leg.straight || known.at_end - relative.travel < known.upper) return false;
    known.at_end -= relative.travel;
    return true;
}

bool is_far(PairClearance& known, double apart, double search_limit) {
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

RevolvedProfile surely_passing(const RevolvedProfile& part, const RelativeLeg& leg) {
    return leg.turns ? RevolvedProfile{} : shrunk_within(part, leg.error);
}

} // namespace core
