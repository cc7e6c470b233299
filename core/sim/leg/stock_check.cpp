#include <algorithm>

#include "core/sim/leg/leg_check.h"
#include "core/sim/setup.h"

namespace core {
namespace {

double length(const Leg& leg) {
    double sum = 0.0;
    for (size_t i = 0; i < axis_count; ++i) {
        const double by = leg.positions.back()[i] - leg.positions.front()[i];
        if (!is_rotary(i)) sum += by * by;
    }
    return std::sqrt(sum);
}

/// Whether the flutes have run into the stock.
bool has_crashed(const TrackedPairs& pairs) {
    return std::any_of(pairs.begin(), pairs.end(), [](const TrackedPair& pair) {
        return pair.pair == Pair{PartKind::flutes} && pair.verdict == Verdict::collision;
    });
}

/// Whether it is already known that the leg is not clear, and nothing else is needed.
bool is_enough(const Setup& setup, const TrackedPairs& pairs) {
    return setup.needs_only_verdict
           && std::any_of(pairs.begin(), pairs.end(),
                          [](const TrackedPair& pair) { return pair.verdict != Verdict::clear; });
}

/// Whether the order of events on a leg cannot change the verdict on a pair, though it is `now`
/// with the stock before the cut: a collision is known; or the pair is already undecided, and
/// without material in its way before the cut there is none later.
bool is_settled(const TrackedPair& known, Verdict now) {
    return known.verdict == Verdict::collision
           || (known.verdict == Verdict::undecided && now == Verdict::undecided);
}

} // namespace

double StockCheck::check_cutting(const Leg& leg, double start, CutModel& stock,
                                 TrackedPairs& pairs) {
    bounds_.carry_bound({PartKind::flutes}, pairs);
    std::vector<BodyCheck> checks;
    std::vector<const MovingBody*> later;
    bool settled = true;
    for (const MovingBody* body : context_.likely_first({})) {
        if (body->kind == PartKind::flutes || only_flutes_ || (only_tool_ && body->body)) continue;
        TrackedPair& known = bounds_.tracked_pair(pairs, pair_of(*body));
        if (stays_undecided(known, leg)) continue;
        if (bounds_.can_skip(known, pairs, travel_of(*body, leg))) continue;
        if (bounds_.can_probably_skip(known)) {
            later.push_back(body);
            continue;
        }
        if (stays_away(known, leg, context_.against_stock(*body, leg))) continue;
        const StockObservation before = probe_.observe_lower(*body, leg, stock, known.upper);
        const Verdict verdict = probe_.clearance(*body, leg, start, before, before).verdict;
        const bool open = verdict != Verdict::clear && !is_settled(known, verdict);
        settled = settled && !open;
        checks.push_back({*body, before, verdict == Verdict::clear, open, known.upper});
    }
    std::unique_ptr<TrialCut> trial;
    // A trial is a single cut of the whole flutes, so they must hardly turn.
    const bool needs_halves = !settled && context_.flutes_turn_too_far(leg);
    if (!settled && !needs_halves && length(leg) > context_.setup.mesh_size)
        trial = flutes_.try_along(leg, stock);
    if (needs_halves || (trial && depends_on_time(checks, leg, stock))) {
        trial.reset();
        bounds_.scale_leg(0.5);
        double removed = check_cutting(stretch(leg, 0.0, 0.5), start, stock, pairs);
        if (!is_enough(context_.setup, pairs))
            removed += check_cutting(stretch(leg, 0.5, 1.0), start, stock, pairs);
        bounds_.scale_leg(2.0);
        return removed;
    }
    // A cut between scan lines removes no volume from them, but may have removed a witness.
    const size_t sweeps = stock.log.size();
    const double removed = trial ? flutes_.keep(*trial, leg, stock) : flutes_.along(leg, stock);
    const bool cut = trial ? trial->is_near() : stock.log.size() > sweeps;
    for (const BodyCheck& check : checks) conclude(check, leg, start, stock, cut, pairs);
    for (const MovingBody* body : later) check_late(*body, leg, start, stock, pairs);
    return removed;
}

void StockCheck::conclude(const BodyCheck& check, const Leg& leg, double start,
                          const CutModel& stock, bool cut, TrackedPairs& pairs) {
    TrackedPair& known = bounds_.tracked_pair(pairs, pair_of(check.body));
    if (check.clear && !check.before.whole
        && bounds_.cannot_decide(known.allowance, check.before.plain.lower, pairs)) {
        merge(known, probe_.clearance(check.body, leg, start, check.before, {}));
        known.drift = travel_of(check.body, leg);
        return;
    }
    const bool is_known = check.before.whole && !cut;
    const StockObservation after = is_known ? check.before : observe_after(check, leg, stock);
    PairClearance now = probe_.clearance(check.body, leg, start, check.before, after);
    probe_.settle_time(now, leg, start, stock);
    merge(known, now);
    known.drift = travel_of(check.body, leg);
}

double StockCheck::travel_of(const MovingBody& body, const Leg& leg) const {
    return bounds_.travel() < infinity ? bounds_.travel()
                                       : bounds_.travel(context_.against_stock(body, leg));
}

void StockCheck::check_late(const MovingBody& body, const Leg& leg, double start,
                            const CutModel& stock, TrackedPairs& pairs) {
    TrackedPair& known = bounds_.tracked_pair(pairs, pair_of(body));
    if (bounds_.can_skip(known, pairs)) return;
    // The stock before the cut is no longer available. It was the remaining stock plus what the
    // flutes removed on the leg.
    const BodyLeg relative = context_.against_stock(body, leg);
    const RelativeLeg flutes = context_.against_stock(context_.bodies[0], leg);
    const double limit = std::min(context_.setup.search_limit, known.upper);
    StockObservation seen;
    seen.plain = widened(probe_.to_stock(body, relative, stock, {.limit = limit}), relative);
    const double taken = distance(bounds(body, relative), bounds(context_.bodies[0], flutes));
    const double carried = known.at_end - bounds_.travel();
    const double fresh = std::min(seen.plain.lower, taken - resolution);
    const double drift = fresh >= carried ? bounds_.travel() : known.drift + bounds_.travel();
    seen.plain.lower = std::max(carried, fresh);
    merge(known, probe_.clearance(body, leg, start, seen, seen));
    known.drift = drift;
}

bool StockCheck::depends_on_time(const std::vector<BodyCheck>& checks, const Leg& leg,
                                 const CutModel& cut) {
    // A body that is too near both before and after the cut is so in any order of events.
    for (const BodyCheck& check : checks) {
        if (!check.open) continue;
        const StockObservation after = observe_after(check, leg, cut);
        if (probe_.clearance(check.body, leg, 0.0, after, after).verdict == Verdict::clear)
            return true;
    }
    return false;
}

StockObservation StockCheck::observe_after(const BodyCheck& check, const Leg& leg,
                                           const CutModel& stock) {
    if (!check.clear) return probe_.observe(check.body, leg, stock, context_.setup.search_limit);
    // Clear by its lower bound: the remaining stock is only needed for the upper bound.
    StockObservation after = check.before;
    const double limit = std::min(context_.setup.search_limit, check.nearest);
    after.plain = Separation{.lower = after.plain.lower};
    if (after.plain.lower >= limit) return after;
    const BodyLeg relative = context_.against_stock(check.body, leg);
    // Nothing has come nearer. If the nearest material is still there, the bound is as before.
    const double before =
        check.before.whole ? check.before.plain.upper - relative.shape_error() : -infinity;
    const StockGoal goal{.limit = limit,
                         .bound = StockBound::upper,
                         .enough = std::max(after.plain.lower + resolution, before),
                         .known_lower = after.plain.lower};
    after.plain = widened(probe_.to_stock(check.body, relative, stock, goal), relative);
    return after;
}

bool StockCheck::check_bodies(const Leg& leg, double start, const CutModel& stock,
                              TrackedPairs& pairs) {
    bool gouged = false;
    for (const MovingBody* body : context_.likely_first({})) {
        if (only_tool_ && body->body) continue;
        if (body->kind == PartKind::flutes && context_.use == FluteUse::ignored) continue;
        TrackedPair& known = bounds_.tracked_pair(pairs, pair_of(*body));
        if (body->kind != PartKind::flutes && stays_undecided(known, leg)) continue;
        if (bounds_.can_skip(known, pairs, travel_of(*body, leg))) continue;
        if (stays_away(known, leg, context_.against_stock(*body, leg))) continue;
        const StockObservation seen = probe_.observe(*body, leg, stock, known.upper);
        PairClearance now = probe_.clearance(*body, leg, start, seen, seen);
        if (body->kind != PartKind::flutes) probe_.settle_time(now, leg, start, stock);
        gouged = gouged || (body->kind == PartKind::flutes && now.verdict == Verdict::collision);
        merge(known, now);
        known.drift = travel_of(*body, leg);
    }
    return gouged;
}

double StockCheck::check_not_cutting(const Leg& leg, double start, CutModel& stock,
                                     TrackedPairs& pairs) {
    const bool gouged = check_bodies(leg, start, stock, pairs);
    if (gouged) {
        TrackedPair& flutes = entry(pairs, {PartKind::flutes}, context_.setup);
        const double fraction = probe_.earliest(leg, flutes, 0.0, stock);
        flutes.time = std::min(flutes.time, start + leg.begin + fraction * (leg.end - leg.begin));
    }
    // Remove the material after the finding, so that one crash gives one finding.
    return gouged ? flutes_.along(leg, stock) : 0.0;
}

double StockCheck::check_whole(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs) {
    return context_.use == FluteUse::cutting ? check_cutting(leg, start, stock, pairs)
                                             : check_not_cutting(leg, start, stock, pairs);
}

bool StockCheck::is_clear_by_bound(const Leg& leg, double start, const CutModel& stock,
                                   TrackedPairs& pairs) {
    std::vector<PairClearance> seen;
    for (const MovingBody& body : context_.bodies) {
        if (body.body || (only_flutes_ && body.kind != PartKind::flutes)) continue;
        const BodyLeg relative = context_.against_stock(body, leg);
        const double apart = distance(bounds(body, relative), stock.outer_box);
        if (context_.is_too_vague(relative) && apart < context_.setup.search_limit) return false;
        if (body.kind == PartKind::flutes && context_.use == FluteUse::cutting) {
            // They need no clearance: it is enough that they cut nothing.
            const double room = context_.setup.cut_error + resolution;
            if (!context_.stays_apart(*body.profile, relative, stock, room)) return false;
            continue;
        }
        const PairClearance* known = nullptr;
        for (const TrackedPair& pair : pairs)
            if (pair.pair == pair_of(body)) known = &pair;
        const double nearest = known ? known->upper : infinity;
        StockObservation observation{.travel = relative.travel};
        const double limit =
            std::min(context_.setup.search_limit, nearest) + relative.shape_error();
        observation.plain =
            widened(probe_.to_stock(body, relative, stock, {.limit = limit}), relative);
        const double lower = observation.plain.lower;
        if (lower <= 0.0) return false;
        const PairClearance now = probe_.clearance(body, leg, start, observation, observation);
        if (now.verdict != Verdict::clear) return false;
        if (!context_.setup.needs_only_verdict
            && lower < std::min(nearest, context_.setup.search_limit)
            && !context_.is_sharp(body, relative, lower))
            return false;
        seen.push_back(now);
    }
    for (const PairClearance& now : seen) merge(entry(pairs, now.pair, context_.setup), now);
    return true;
}

void StockCheck::check_turning_body(const MovingBody& body, const Leg& leg, double start,
                                    const CutModel& stock, TrackedPairs& pairs) {
    if (is_enough(context_.setup, pairs)) return;
    TrackedPair& known = bounds_.tracked_pair(pairs, pair_of(body));
    if (stays_undecided(known, leg)) return;
    const BodyLeg relative = context_.against_stock(body, leg);
    if (bounds_.can_skip(known, pairs, bounds_.travel(relative))) return;
    if (stays_away(known, leg, relative)) return;
    const double apart = distance(bounds(body, relative), stock.outer_box);
    if (is_far(known, apart, context_.setup.search_limit)) return;
    if (!context_.is_too_vague(relative)) {
        // For a large and distant body, the box of the raw stock is usually enough.
        const double from_box =
            body.body ? probe_.distance_to_box(body, relative, stock.outer_box) : 0.0;
        if (from_box >= std::max(known.allowance.distance, resolution)) {
            known.lower = std::min({known.lower, from_box, context_.setup.search_limit});
            known.at_end = from_box;
            return;
        }
        const StockObservation seen = probe_.observe(body, leg, stock, known.upper);
        const PairClearance now = probe_.clearance(body, leg, start, seen, seen);
        const bool far = now.lower >= std::min(known.upper, context_.setup.search_limit);
        const bool is_sharp =
            context_.is_sharp(body, relative, now.lower)
            || (context_.setup.needs_only_verdict && now.verdict == Verdict::clear);
        if (!relative.turns || far || is_sharp || now.verdict == Verdict::collision)
            return merge(known, now);
    }
    check_turning_body(body, stretch(leg, 0.0, 0.5), start, stock, pairs);
    check_turning_body(body, stretch(leg, 0.5, 1.0), start, stock, pairs);
}

bool StockCheck::is_clear_before_cut(const MovingBody& body, const Leg& leg, double start,
                                     const CutModel& stock, TrackedPair& known,
                                     std::vector<ClearPiece>& pieces) {
    const BodyLeg relative = context_.against_stock(body, leg);
    if (stays_away(known, leg, relative)) return true;
    const double apart = distance(bounds(body, relative), stock.outer_box);
    if (is_far(known, apart, context_.setup.search_limit)) return true;
    if (!context_.is_too_vague(relative)) {
        const StockObservation seen = probe_.observe_lower(body, leg, stock, known.upper);
        const PairClearance now = probe_.clearance(body, leg, start, seen, {});
        const double lower = now.lower;
        if (now.verdict == Verdict::clear
            && (context_.setup.needs_only_verdict || context_.is_sharp(body, relative, lower)
                || lower >= std::min(known.upper, context_.setup.search_limit))) {
            merge(known, now);
            pieces.push_back({leg, seen});
            return true;
        }
        // A sharper bound does not help; the order of events may.
        if (seen.plain.upper < now.allowance.distance) return false;
    }
    if (!relative.turns
        || relative.reducible_shape_error() <= 2.0 * context_.finest_error(body, relative))
        return false;
    return is_clear_before_cut(body, stretch(leg, 0.0, 0.5), start, stock, known, pieces)
           && is_clear_before_cut(body, stretch(leg, 0.5, 1.0), start, stock, known, pieces);
}

double StockCheck::cut_turning(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs) {
    std::vector<const MovingBody*> clear;
    std::vector<std::vector<ClearPiece>> pieces;
    for (const MovingBody* body : context_.likely_first({})) {
        if (body->kind == PartKind::flutes || body->body) continue;
        TrackedPair& known = bounds_.tracked_pair(pairs, pair_of(*body));
        if (stays_undecided(known, leg)) continue;
        const BodyLeg relative = context_.against_stock(*body, leg);
        if (bounds_.can_skip(known, pairs, bounds_.travel(relative))) continue;
        const TrackedPair before = known;
        std::vector<ClearPiece> found;
        if (!is_clear_before_cut(*body, leg, start, stock, known, found)) {
            known = before;
            // All bodies, in the order of events.
            return check_turning(leg, start, stock, pairs);
        }
        clear.push_back(body);
        pieces.push_back(std::move(found));
    }
    only_flutes_ = true;
    const double removed = check_turning(leg, start, stock, pairs);
    only_flutes_ = false;
    for (size_t i = 0; i < clear.size(); ++i) {
        for (const ClearPiece& piece : pieces[i]) {
            TrackedPair& known = bounds_.tracked_pair(pairs, pair_of(*clear[i]));
            const BodyCheck check{*clear[i], piece.seen, true, false, known.upper};
            const double at_end = known.at_end, drift = known.drift;
            conclude(check, piece.leg, start, stock, true, pairs);
            known.at_end = at_end;
            known.drift = drift;
        }
    }
    return removed;
}

double StockCheck::check_turning(const Leg& leg, double start, CutModel& stock,
                                 TrackedPairs& pairs) {
    if (context_.use == FluteUse::not_cutting && has_crashed(pairs)) {
        // One crash is enough: later motion is not measured, and so not reported as clear.
        for (const MovingBody& body : context_.bodies) {
            if (body.body) continue;
            TrackedPair& known = entry(pairs, pair_of(body), context_.setup);
            known.lower = known.at_end = 0.0;
            known.verdict = std::max(known.verdict, Verdict::undecided);
        }
        return 0.0;
    }
    if (is_enough(context_.setup, pairs)) return 0.0;
    // Flutes that cut may not be measured at all.
    if (context_.use == FluteUse::cutting) bounds_.carry_bound({PartKind::flutes}, pairs);
    // FluteCut::along halves the leg of flutes that cut.
    const bool turns_too_far =
        (context_.use != FluteUse::cutting && context_.flutes_turn_too_far(leg))
        || (!only_flutes_ && context_.others_turn_too_far(leg));
    if (!turns_too_far) return check_whole(leg, start, stock, pairs);
    if (is_clear_by_bound(leg, start, stock, pairs)) return 0.0;
    const double removed = check_turning(stretch(leg, 0.0, 0.5), start, stock, pairs);
    return removed + check_turning(stretch(leg, 0.5, 1.0), start, stock, pairs);
}

double StockCheck::check(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs) {
    if (context_.use == FluteUse::ignored || context_.use == FluteUse::measured) {
        for (const MovingBody& body : context_.bodies)
            if (body.kind != PartKind::flutes || context_.use == FluteUse::measured)
                check_turning_body(body, leg, start, stock, pairs);
        return 0.0;
    }
    const bool turns = context_.setup.machine.has_rotary() && leg.positions.size() == 2
                       && turn_of(context_.setup.machine, leg.positions[0], leg.positions[1]) > 0.0;
    if (turns) {
        probe_.keep_squares(stock);
        // Machine bodies are large: they would divide the leg far more finely than the tool needs.
        for (const MovingBody& body : context_.bodies)
            if (body.body) check_turning_body(body, leg, start, stock, pairs);
        only_tool_ = true;
        const double removed = context_.use == FluteUse::cutting
                                   ? cut_turning(leg, start, stock, pairs)
                                   : check_turning(leg, start, stock, pairs);
        only_tool_ = false;
        return removed;
    }
    return check_whole(leg, start, stock, pairs);
}

} // namespace core
