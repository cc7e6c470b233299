#include "core/sim/leg/pair_bounds.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/motion/path.h"
#include "core/sim/setup.h"

namespace core {

namespace {

constexpr size_t few = 12; // pairs, among which a search from the first on is faster

size_t hash_of(const Pair& pair) {
    const size_t body = pair.fixture ? *pair.fixture + 1 : 0;
    const size_t key = (body * 64 + pair.carried) * 16 + static_cast<size_t>(pair.part);
    return (key * size_t{0x9E3779B97F4A7C15}) >> 32U;
}

} // namespace

TrackedPairs::TrackedPairs(std::initializer_list<TrackedPair> pairs) {
    for (const TrackedPair& pair : pairs) add(pair);
}

const TrackedPair* TrackedPairs::find(const Pair& pair) const {
    if (slots_.empty()) {
        for (const TrackedPair& known : pairs_)
            if (known.pair == pair) return &known;
        return nullptr;
    }
    const size_t mask = slots_.size() - 1;
    for (size_t slot = hash_of(pair) & mask; slots_[slot] != 0; slot = (slot + 1) & mask)
        if (const TrackedPair& known = pairs_[slots_[slot] - 1]; known.pair == pair) return &known;
    return nullptr;
}

TrackedPair* TrackedPairs::find(const Pair& pair) {
    return const_cast<TrackedPair*>(std::as_const(*this).find(pair));
}

TrackedPair& TrackedPairs::add(const TrackedPair& pair) {
    pairs_.push_back(pair);
    if (2 * pairs_.size() > slots_.size())
        make_slots();
    else
        take_slot(pairs_.size() - 1);
    return pairs_.back();
}

void TrackedPairs::sort() {
    std::sort(pairs_.begin(), pairs_.end(),
              [](const TrackedPair& a, const TrackedPair& b) { return is_before(a.pair, b.pair); });
    make_slots();
}

void TrackedPairs::make_slots() {
    slots_.clear();
    if (pairs_.size() <= few) return;
    slots_.assign(std::bit_ceil(4 * pairs_.size()), 0);
    for (size_t i = 0; i < pairs_.size(); ++i) take_slot(i);
}

void TrackedPairs::take_slot(size_t index) {
    const size_t mask = slots_.size() - 1;
    size_t slot = hash_of(pairs_[index].pair) & mask;
    while (slots_[slot] != 0) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<uint32_t>(index + 1);
}

void merge(TrackedPair& known, const PairClearance& later) {
    merge(static_cast<PairClearance&>(known), later);
    known.at_end = later.lower;
    known.drift = 0.0;
}

TrackedPair& entry(TrackedPairs& pairs, const Pair& pair, const Setup& setup) {
    if (TrackedPair* known = pairs.find(pair)) return *known;
    TrackedPair begun;
    begun.pair = pair;
    begun.allowance = allowance_of(setup, pair);
    return pairs.add(begun);
}

bool stays_undecided(TrackedPair& known, const Leg& leg) {
    if (leg.turn_error <= 0.0 || known.lower > 0.0 || known.verdict == Verdict::clear) return false;
    known.at_end = -infinity;
    return true;
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

namespace {

Separation widened(Separation found, double error) {
    found.lower = std::max(0.0, found.lower - error);
    found.upper += error;
    return found;
}

} // namespace

Separation widened(Separation found, const RelativeLeg& leg) { return widened(found, leg.error); }

Separation widened(Separation found, const BodyLeg& leg) {
    return widened(found, leg.shape_error());
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

TrackedPair& PairBounds::tracked_pair(TrackedPairs& pairs, const Pair& pair) const {
    if (TrackedPair* known = pairs.find(pair)) return *known;
    TrackedPair& begun = entry(pairs, pair, setup_);
    if (const PairBound* bound = find_bound(pair)) {
        begun.at_end = bound->apart;
        begun.drift = bound->drift;
    }
    return begun;
}

const PairBound* PairBounds::find_bound(const Pair& pair) const {
    const std::vector<PairBound>& bounds = memory_.bounds;
    const size_t next = last_bound_ + 1; // most pairs are asked for in order
    if (next < bounds.size() && bounds[next].pair == pair) return &bounds[last_bound_ = next];
    const auto found = std::lower_bound(
        bounds.begin(), bounds.end(), pair,
        [](const PairBound& one, const Pair& other) { return is_before(one.pair, other); });
    if (found == bounds.end() || !(found->pair == pair)) return nullptr;
    last_bound_ = static_cast<size_t>(found - bounds.begin());
    return &*found;
}

double PairBounds::least_margin(const TrackedPairs& pairs) const {
    double least = infinity;
    if (setup_.detail != Detail::deciding_pair) return least;
    for (const TrackedPair& other : pairs)
        if (other.found()) least = std::min(least, other.margin());
    return least;
}

bool PairBounds::can_skip(TrackedPair& known, double least, double travel) const {
    const double apart = known.at_end - travel;
    if (!cannot_decide(known.allowance, apart, least)) return false;
    known.lower = std::min({known.lower, apart, setup_.search_limit});
    known.at_end = apart;
    known.drift += travel;
    return true;
}

bool PairBounds::cannot_decide(const Allowance& allowance, double lower, double least) const {
    if (setup_.detail == Detail::every_pair) return false;
    const double required = allowance.distance + resolution + memory_.off_path;
    if (setup_.detail == Detail::verdict) return lower > required;
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

void PairBounds::carry_bound(const Pair& pair, TrackedPairs& pairs) const {
    if (TrackedPair* known = pairs.find(pair)) known->at_end -= travel_;
}

} // namespace core
