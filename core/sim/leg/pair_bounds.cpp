#include "core/sim/leg/leg_check.h"
#include "core/sim/leg/pair_entry.h"
#include "core/sim/setup.h"

namespace core {

double greatest_travel(const Machine& machine, const Leg& leg) {
    if (!leg.straight) return infinity;
    Vec3 by(0.0);
    for (size_t i = 0; i < axis_count; ++i) {
        const double travel = std::abs(leg.places.back()[i] - leg.places.front()[i]);
        if (travel == 0.0) continue;
        if (is_rotary(i)) return infinity;
        by += travel * glm::abs(machine.axes[i].direction);
    }
    return glm::length(by);
}

PairClearance& LegCheck::known_pair(std::vector<PairClearance>& pairs, const Pair& pair) const {
    for (PairClearance& known : pairs)
        if (known.pair == pair) return known;
    PairClearance& begun = entry(pairs, pair, setup_);
    for (const PairBound& bound : memory_.bounds)
        if (bound.pair == pair) {
            begun.at_end = bound.apart;
            begun.drift = bound.drift;
        }
    return begun;
}

bool LegCheck::says_nothing(PairClearance& known, const std::vector<PairClearance>& pairs) const {
    const double apart = known.at_end - travel_;
    if (!is_beside_the_point(known.allowance, apart, pairs)) return false;
    known.lower = std::min({known.lower, apart, setup_.search_limit});
    known.at_end = apart;
    known.drift += travel_;
    return true;
}

bool LegCheck::is_beside_the_point(const Allowance& allowance, double lower,
                                   const std::vector<PairClearance>& pairs) const {
    if (setup_.detail == Detail::every_pair) return false;
    const double must_keep = allowance.distance + resolution + memory_.off_path;
    if (setup_.detail == Detail::verdict) return lower > must_keep;
    double least = infinity;
    for (const PairClearance& other : pairs)
        if (other.found()) least = std::min(least, other.margin());
    return lower > must_keep && lower >= std::min(least + must_keep, setup_.search_limit);
}

bool LegCheck::says_likely_nothing(const PairClearance& known) const {
    const double apart = known.at_end - travel_;
    const double must_keep = known.allowance.distance + resolution + memory_.off_path;
    constexpr double slack = 0.1; // mm: how much more room the next block often has
    // A bound that has lost more would say too little, should the pair decide after all; of what
    // keeps away from the flutes a late look tells more.
    const double most_drift =
        known.pair.part < PartKind::holder ? 2.0 : std::max(2.0, 0.25 * apart);
    if (known.drift + travel_ > most_drift) return false;
    return setup_.detail == Detail::deciding_pair && memory_.deciding
           && !(known.pair == *memory_.deciding) && apart > must_keep
           && apart - must_keep > memory_.margin + 2.0 * travel_ + slack;
}

std::vector<const MovingBody*> LegCheck::likely_first(std::optional<size_t> fixture) const {
    std::vector<const MovingBody*> order;
    for (const MovingBody& body : bodies_) order.push_back(&body);
    std::stable_partition(order.begin(), order.end(), [&](const MovingBody* body) {
        return memory_.deciding == pair_of(*body, fixture);
    });
    return order;
}

void LegCheck::let_pass(const Pair& pair, std::vector<PairClearance>& pairs) const {
    for (PairClearance& known : pairs)
        if (known.pair == pair) known.at_end -= travel_;
}

double LegCheck::earliest(const Leg& leg, const Pair& pair, double distance, const CutModel& stock,
                          std::optional<double> seen) {
    if (!leg.straight || leg.places.size() < 2) return 0.0;
    const MovingBody& body = body_of(pair);
    const Mount& target = pair.fixture ? setup_.fixtures[*pair.fixture].mount : setup_.stock_mount;
    const auto reached = [&](double share) {
        const RelativeLeg moved =
            relative_leg(setup_.machine, target, body.mover, stretch(leg, 0.0, share));
        if (moved.error == infinity) return true;
        const double limit = distance + moved.error + resolution;
        const Separation found =
            pair.fixture ? distance_over(moved, body, setup_.fixtures[*pair.fixture].body,
                                         limit + resolution, statistics_.shape_tests)
                         : to_stock(body, moved, stock, {.limit = limit + resolution});
        return found.upper <= limit;
    };
    // Mostly it is where it was seen, and not before.
    constexpr double step = 1e-4;
    double before = 0.0, after = 1.0;
    if (seen && (*seen <= step || !reached(*seen - step))) return *seen;
    if (reached(0.0)) return 0.0;
    for (int i = 0; i < 24; ++i) {
        const double middle = 0.5 * (before + after);
        (reached(middle) ? after : before) = middle;
    }
    return after;
}

void LegCheck::settle_time(PairClearance& now, const Leg& leg, double start,
                           const CutModel& stock) {
    if (now.verdict == Verdict::clear || !now.found()) return;
    const double begin = start + leg.begin, takes = leg.end - leg.begin;
    const double seen = takes > 0.0 ? (now.time - begin) / takes : 0.0;
    now.time = begin + earliest(leg, now.pair, now.upper, stock, seen) * takes;
}

} // namespace core
