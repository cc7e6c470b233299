#include "core/sim/leg/leg_check.h"
#include "core/sim/leg/pair_entry.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// Whether the flutes have run into the stock.
bool has_crashed(const std::vector<PairClearance>& pairs) {
    return std::any_of(pairs.begin(), pairs.end(), [](const PairClearance& pair) {
        return pair.pair == Pair{PartKind::flutes} && pair.verdict == Verdict::collision;
    });
}

} // namespace

bool LegCheck::turns_too_far(const Leg& leg) const {
    if (!setup_.machine.has_rotary() || leg.places.size() != 2) return false;
    for (const MovingBody& body : bodies_) {
        if (body.body) continue;
        const RelativeLeg relative = against_stock(body, leg);
        if (relative.turns && relative.error > finest_error(body)) return true;
    }
    return false;
}

double LegCheck::only_cut(const Leg& leg, CutModel& stock) {
    if (!leg.straight || tool_.parts.empty()) return 0.0;
    const RelativeLeg flutes = against_stock(bodies_[0], leg);
    const bool far = distance(bounds(bodies_[0], flutes), stock.outer_box) > flutes.error;
    if (flutes.turns && far) return 0.0;
    if (!turns_too_far(leg)) return cut_along(leg, stock);
    const double removed = only_cut(stretch(leg, 0.0, 0.5), stock);
    return removed + only_cut(stretch(leg, 0.5, 1.0), stock);
}

bool LegCheck::is_seen_from_afar(const Leg& leg, double start, const CutModel& stock,
                                 std::vector<PairClearance>& pairs) {
    std::vector<PairClearance> seen;
    for (const MovingBody& body : bodies_) {
        if (body.body) continue;
        const RelativeLeg relative = against_stock(body, leg);
        const double apart = distance(bounds(body, relative), stock.outer_box);
        if (is_too_vague(relative) && apart < setup_.search_limit) return false;
        const bool chips = body.kind == PartKind::flutes && use_ == FluteUse::cutting;
        const PairClearance* known = nullptr;
        for (const PairClearance& pair : pairs)
            if (pair.pair == pair_of(body)) known = &pair;
        const double nearest = known && !chips ? known->upper : infinity;
        Observation look{.travel = relative.travel};
        const double limit = std::min(setup_.search_limit, nearest) + relative.error;
        look.plain = widened(to_stock(body, relative, stock, {.limit = limit}), relative);
        const double lower = look.plain.lower;
        if (lower <= 0.0) return false;
        if (chips) continue;
        const PairClearance now = clearance(body, leg, start, look, look);
        if (now.verdict != Verdict::clear) return false;
        if (lower < std::min(nearest, setup_.search_limit)
            && relative.error > std::max(finest_error(body), sharp_share * lower))
            return false;
        seen.push_back(now);
    }
    for (const PairClearance& now : seen) merge(entry(pairs, now.pair, setup_), now);
    return true;
}

bool LegCheck::is_too_vague(const RelativeLeg& relative) const {
    return relative.turns && relative.error > sharp_share * setup_.search_limit;
}

double LegCheck::distance_to_box(const MovingBody& body, const RelativeLeg& leg, const Aabb& box) {
    const ConvexShape shape = convex(box);
    double lower = setup_.search_limit + leg.error;
    for (const ConvexShape& part : shapes_of(*body.body, leg)) {
        ++statistics_.shape_tests;
        lower = std::min(lower, separation(part, shape, {.limit = lower}).lower);
    }
    return lower - leg.error;
}

void LegCheck::check_turning_body(const MovingBody& body, const Leg& leg, double start,
                                  const CutModel& stock, std::vector<PairClearance>& pairs) {
    PairClearance& known = entry(pairs, pair_of(body), setup_);
    const RelativeLeg relative = against_stock(body, leg);
    if (stays_away(known, leg, relative)) return;
    const double apart = distance(bounds(body, relative), stock.outer_box);
    if (is_far(known, apart, setup_.search_limit)) return;
    if (!is_too_vague(relative)) {
        // Mostly the raw stock's box tells enough of a body that is large and far.
        const double from_box = distance_to_box(body, relative, stock.outer_box);
        if (from_box >= std::max(known.allowance.distance, resolution)) {
            known.lower = std::min({known.lower, from_box, setup_.search_limit});
            known.at_end = from_box;
            return;
        }
        const Observation seen = observe(body, leg, stock, known.upper);
        const PairClearance now = clearance(body, leg, start, seen, seen);
        const bool far = now.lower >= std::min(known.upper, setup_.search_limit);
        const bool is_sharp =
            relative.error <= std::max(finest_error(body), sharp_share * now.lower);
        if (!relative.turns || far || is_sharp || now.verdict == Verdict::collision)
            return merge(known, now);
    }
    check_turning_body(body, stretch(leg, 0.0, 0.5), start, stock, pairs);
    check_turning_body(body, stretch(leg, 0.5, 1.0), start, stock, pairs);
}

double LegCheck::check_turning(const Leg& leg, double start, CutModel& stock,
                               std::vector<PairClearance>& pairs) {
    if (use_ == FluteUse::not_cutting && has_crashed(pairs)) {
        // One crash is enough: what comes after it is not looked at, and so not called clear.
        for (const MovingBody& body : bodies_) {
            if (body.body) continue;
            PairClearance& known = entry(pairs, pair_of(body), setup_);
            known.lower = known.at_end = 0.0;
            known.verdict = std::max(known.verdict, Verdict::undecided);
        }
        return 0.0;
    }
    if (!turns_too_far(leg)) return check_whole(leg, start, stock, pairs);
    if (is_seen_from_afar(leg, start, stock, pairs)) return 0.0;
    const double removed = check_turning(stretch(leg, 0.0, 0.5), start, stock, pairs);
    return removed + check_turning(stretch(leg, 0.5, 1.0), start, stock, pairs);
}

double LegCheck::check_stock(const Leg& leg, double start, CutModel& stock,
                             std::vector<PairClearance>& pairs) {
    const bool turns = setup_.machine.has_rotary() && leg.places.size() == 2
                       && turn_of(setup_.machine, leg.places[0], leg.places[1]) > 0.0;
    if (turns) {
        // Their reach is long: they would divide the leg far beyond what the tool needs.
        for (const MovingBody& body : bodies_)
            if (body.body) check_turning_body(body, leg, start, stock, pairs);
        only_tool_ = true;
        const double removed = check_turning(leg, start, stock, pairs);
        only_tool_ = false;
        return removed;
    }
    return check_whole(leg, start, stock, pairs);
}

void LegCheck::look_half_way(Observation& seen, const MovingBody& body, const Leg& leg,
                             const CutModel& stock, double nearest) {
    // Where the body really is at one moment is a sure witness.
    const Observation here = observe(body, still_half_way(leg), stock, nearest);
    seen.shrunk.upper = here.shrunk.upper;
    if (here.plain.upper >= seen.plain.upper) return;
    const double lower = seen.plain.lower;
    seen.plain = here.plain;
    seen.plain.lower = std::min(lower, here.plain.upper);
    seen.plain.time_a = 0.5;
}

void LegCheck::make_sure(Observation& seen, const MovingBody& body, const Leg& leg,
                         const RelativeLeg& relative, const CutModel& stock, double nearest) {
    const bool near = seen.plain.lower <= relative.error, overlaps = seen.plain.upper == 0.0;
    const bool overlaps_shrunk = seen.shrunk.upper == 0.0;
    seen.plain = widened(seen.plain, relative);
    seen.shrunk = widened(seen.shrunk, relative);
    const bool has_way = leg.places.size() > 1;
    if ((relative.turns || !body.profile) && near && has_way)
        look_half_way(seen, body, leg, stock, nearest);
    if (!overlaps || !body.profile) return;
    const RevolvedProfile sure = surely_passing(*body.profile, relative);
    if (sure.empty()) return;
    MovingBody inner = body;
    inner.profile = &sure;
    Separation found =
        to_stock(inner, relative, stock, {.limit = resolution, .bound = StockBound::upper});
    if (found.upper > 0.0) return;
    found.lower = 0.0;
    seen.plain = found;
    if (overlaps_shrunk) seen.shrunk.upper = 0.0;
}

} // namespace core
