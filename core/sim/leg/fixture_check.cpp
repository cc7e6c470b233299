#include <algorithm>

#include "core/sim/leg/leg_check.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// Whether shorter legs may decide a pair that is undecided only because of how it turns.
bool is_open_for_turning(const PairClearance& now, const PairClearance& known,
                         const RelativeLeg& relative, const Leg& leg) {
    constexpr double sharp = 5e-4; // mm: bounds that decide meet within twice that
    // The error of the path is the same for all parts of it.
    const double lasting = relative.lasting_error + leg.path_error - leg.lasting_error;
    return now.verdict == Verdict::undecided && known.verdict < Verdict::violation
           && relative.error - lasting > std::max(sharp, 0.1 * lasting);
}

/// Axis values at a fraction of a leg; at its start if the path is unknown.
AxisValues values_at(const Leg& leg, double fraction) {
    return leg.straight && leg.positions.size() == 2 ? stretch(leg, 0.0, fraction).positions[1]
                                                     : leg.positions[0];
}

} // namespace

PairClearance FixtureCheck::measure(const Leg& leg, double start, const RelativeLeg& relative,
                                    const MovingBody& body, const PairClearance& known) {
    const Fixture& fixture = context_.setup.fixtures[*known.pair.fixture];
    const Allowance& allowance = known.allowance;
    const double limit = std::min(context_.setup.search_limit, known.upper)
                         + (relative.turns || relative.deviation > 0.0 ? relative.error : 0.0);
    const Separation seen =
        distance_over(relative, body, fixture.body, limit, context_.statistics.shape_tests);
    const Separation found = widened(seen, relative);
    PairClearance now{.pair = known.pair, .allowance = allowance};
    now.lower = std::min(found.lower, context_.setup.search_limit);
    if (found.found()) {
        const Transform stock_from =
            stock_from_fixture(context_.setup, *known.pair.fixture, values_at(leg, found.time_a));
        now.upper = found.upper;
        now.on_tool = stock_from * found.point_a;
        now.on_body = stock_from * found.point_b;
        now.time = start + leg.begin + found.time_a * (leg.end - leg.begin);
    }
    now.verdict = judge_distance(allowance, now.lower, now.upper);
    const bool may_touch = allowance.distance <= resolution && now.lower <= 0.0;
    if (seen.upper > 0.0 && !may_touch) return now;
    if (!body.profile) {
        if (seen.upper == 0.0 && relative.error_without_deviation() <= 0.0) now.upper = 0.0;
        if (may_touch || now.upper == 0.0)
            now.verdict = judge_contact(allowance, now.lower, now.upper);
        return now;
    }
    const auto clearance_of = [&](const RevolvedProfile& part) {
        return distance_over(relative, part, fixture.body, context_.setup.search_limit,
                             context_.statistics.shape_tests);
    };
    if (seen.upper == 0.0 && relative.error > 0.0) {
        const RevolvedProfile sure = certain_sweep(*body.profile, relative);
        if (!sure.empty() && clearance_of(sure).upper == 0.0) now.upper = 0.0;
    }
    if (now.upper > 0.0 && !may_touch) return now;
    const Separation inner =
        clearance_of(shrunk_around(*body.profile, contact_shrink(allowance, *body.profile)));
    const bool collides = inner.upper == 0.0 && now.upper == 0.0;
    const Separation shrunk = widened(inner, relative);
    now.verdict = judge_contact(allowance, shrunk.lower, collides ? 0.0 : shrunk.upper);
    return now;
}

bool FixtureCheck::is_settled(const PairClearance& now, const PairClearance& known) const {
    constexpr double sharp = 1e-3; // mm
    const double nearest = std::min({known.upper, now.upper, context_.setup.search_limit});
    // Shorter chords do not change the deviations of the shapes.
    const double shapes = context_.setup.fixtures[*now.pair.fixture].deviation
                          + context_.body_of(now.pair).mover.deviation;
    const bool may_collide = shapes > 0.0 && now.lower <= 0.0;
    return now.verdict == Verdict::collision
           || (now.verdict != Verdict::undecided && !may_collide
               && now.lower >= nearest - sharp - 2.0 * shapes);
}

void FixtureCheck::check_passage(const Leg& leg, double start, size_t fixture,
                                 const MovingBody& body, const RelativeLeg& relative,
                                 TrackedPair& known) {
    PairClearance now = measure(leg, start, relative, body, known);
    if (!leg.arc.motion || is_settled(now, known)) return merge(known, now);
    doubts_.push_back({leg, start, fixture, &body, now});
    // `resolve_doubts` adds its lower bound: another chord may turn out to be nearer.
    const double lower = now.lower;
    now.lower = infinity;
    now.verdict = Verdict::clear;
    merge(known, now);
    known.at_end = lower;
}

void FixtureCheck::resolve(const Doubt& doubt, PairClearance& known) {
    const auto clearance_of = [&](const Leg& leg) {
        const RelativeLeg relative = context_.against_fixture(*doubt.body, doubt.fixture, leg);
        return measure(leg, doubt.start, relative, *doubt.body, known);
    };
    constexpr double finest = 1e-5; // mm, of a chord's error
    if (is_settled(doubt.seen, known) || doubt.leg.path_error - doubt.leg.lasting_error <= finest)
        return merge(known, doubt.seen);
    if (doubt.seen.lower <= 0.0) {
        const PairClearance there = clearance_of(still_half_way(doubt.leg));
        if (there.verdict == Verdict::collision) return merge(known, there);
    }
    for (const Leg& half : halves(doubt.leg))
        resolve({half, doubt.start, doubt.fixture, doubt.body, clearance_of(half)}, known);
}

void FixtureCheck::resolve_doubts(TrackedPairs& pairs) {
    std::stable_sort(doubts_.begin(), doubts_.end(),
                     [](const Doubt& a, const Doubt& b) { return a.seen.lower < b.seen.lower; });
    for (const Doubt& doubt : doubts_) {
        resolve(doubt, entry(pairs, doubt.seen.pair, context_.setup));
    }
    doubts_.clear();
}

void FixtureCheck::check_pair(const Leg& leg, double start, size_t fixture, const MovingBody& body,
                              TrackedPairs& pairs) {
    const Pair pair = pair_of(body, fixture);
    TrackedPair& known = bounds_.tracked_pair(pairs, pair);
    if (bounds_.can_skip(known, least_, bounds_.travel())) return;
    if (bounds_.travel() == infinity) {
        const double own = context_.travel_against_fixture(body, fixture, leg);
        if (bounds_.can_skip(known, least_, bounds_.travel(leg, own))) return;
    }
    measure_pair(leg, start, fixture, body, known);
    if (known.found()) least_ = std::min(least_, known.margin());
}

void FixtureCheck::measure_pair(const Leg& leg, double start, size_t fixture,
                                const MovingBody& body, TrackedPair& known) {
    if (stays_undecided(known, leg)) return;
    const RelativeLeg relative = context_.against_fixture(body, fixture, leg);
    if (bounds_.can_skip(known, least_, bounds_.travel(relative))) return;
    if (stays_away(known, leg, relative)) return;
    if (!relative.turns) return check_passage(leg, start, fixture, body, relative, known);
    // A body that turns: halve the leg until the body is far away or its error is small enough.
    const double apart =
        distance(bounds(body, relative), bounds(context_.setup.fixtures[fixture].body));
    if (is_far(known, apart, context_.setup.search_limit)) return;
    if (context_.setup.needs_only_verdict && known.verdict != Verdict::clear) return;
    if (!context_.is_too_vague(relative)) {
        PairClearance now = measure(leg, start, relative, body, known);
        const bool is_open = is_open_for_turning(now, known, relative, leg);
        if (!is_open
            && (now.lower >= std::min(known.upper, context_.setup.search_limit)
                || context_.is_sharp(body, relative, now.lower)
                || (context_.setup.needs_only_verdict && now.verdict == Verdict::clear)))
            return merge(known, now);
        if (is_open) {
            const Leg still = still_half_way(leg);
            const RelativeLeg here = context_.against_fixture(body, fixture, still);
            const PairClearance there = measure(still, start, here, body, known);
            // The halves have the lower bound.
            if (there.verdict >= Verdict::violation) merge(known, there);
        }
        if (now.lower <= 0.0) {
            const Leg still = still_half_way(leg);
            const RelativeLeg here = context_.against_fixture(body, fixture, still);
            now = measure(still, start, here, body, known);
            if (now.verdict == Verdict::collision) return merge(known, now);
        }
    }
    for (const Leg& half : {stretch(leg, 0.0, 0.5), stretch(leg, 0.5, 1.0)}) {
        if (known.found()) least_ = std::min(least_, known.margin());
        if (!bounds_.can_skip(known, least_, bounds_.travel()))
            measure_pair(half, start, fixture, body, known);
    }
}

bool FixtureCheck::needs_clearance(const Leg& leg, const MovingBody& body, size_t fixture,
                                   TrackedPairs& pairs) {
    if (!context_.mounted_fixtures[fixture]
        || is_exempt(context_.setup.machine, body, context_.setup.fixtures[fixture]))
        return false;
    if (body.kind != PartKind::flutes || !context_.setup.fixtures[fixture].expendable) return true;
    if (context_.use == FluteUse::cutting)
        flutes_.note_cut(leg, fixture);
    else if (!flutes_.is_in_own_cut(leg, fixture))
        return true;
    bounds_.carry_bound(pair_of(body, fixture), pairs);
    return false;
}

void FixtureCheck::check(const Leg& leg, double start, TrackedPairs& pairs) {
    const std::optional<Pair> first = context_.memory.deciding; // the likely one of this leg, too
    least_ = bounds_.least_margin(pairs);
    const auto check_one = [&](size_t fixture, const MovingBody& body) {
        if (needs_clearance(leg, body, fixture, pairs))
            check_pair(leg, start, fixture, body, pairs);
    };
    if (first && first->fixture)
        for (const MovingBody& body : context_.bodies)
            if (*first == pair_of(body, *first->fixture)) check_one(*first->fixture, body);
    for (size_t fixture = 0; fixture < context_.setup.fixtures.size(); ++fixture)
        for (const MovingBody& body : context_.bodies)
            if (first != pair_of(body, fixture)) check_one(fixture, body);
}

} // namespace core
