#include "core/sim/leg_check.h"

namespace core {

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
