#include "core/sim/leg/stock_probe.h"

#include <algorithm>
#include <cmath>

#include "core/dbm/covered_path.h"
#include "core/distance/shape_outline.h"
#include "core/motion/path.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// The value that the bounds of a search must not enclose: just below the allowance.
double deciding_distance(const Allowance& allowance) {
    return allowance.distance > resolution ? allowance.distance - resolution : 0.0;
}

} // namespace

double StockProbe::exact_within(const Allowance& allowance) const {
    return 2.0 * (deciding_distance(allowance) + bounds_.off_path(allowance));
}

void StockProbe::keep_squares(const CutModel& stock) {
    if (!kept_ || &kept_->model() != &stock) kept_.emplace(stock);
}

Separation StockProbe::to_stock(const MovingBody& body, const BodyLeg& leg, const CutModel& stock,
                                StockGoal goal, double shrink) {
    if (shrink > 0.0 && !leg.can_shrink(*body.profile, shrink)) {
        // As a whole, with a larger error.
        const double more = leg.error - leg.shape_error();
        goal.limit += more;
        goal.threshold += more;
        BodyLeg whole = leg;
        whole.parts.clear();
        Separation found = to_stock(body, whole, stock, goal, shrink);
        found.lower = std::max(0.0, found.lower - more);
        found.upper += more;
        return found;
    }
    // Most machine bodies are far away and have many triangles.
    if (body.body && distance(bounds(body, leg), stock.outer_box) >= goal.limit)
        return {.lower = goal.limit};
    const std::vector<ConvexShape> shapes = shapes_of(body, leg, shrink);
    std::optional<LineId>& hint = context_.memory.hints[static_cast<size_t>(body.kind)];
    goal.first_line = hint;
    std::optional<Vec3>& place = context_.memory.near_places[static_cast<size_t>(body.kind)];
    if (place) goal.first_place = leg.positions.back() + *place;
    const Allowance allowance = allowance_of(context_.setup, pair_of(body));
    goal.exact_within = exact_within(allowance);
    goal.threshold = std::min(goal.threshold, goal.limit);
    size_t& futile_left = futile_left_[static_cast<size_t>(body.kind)];
    goal.futile_limit = std::min({goal.futile_limit, futile_left, size_t{500}});
    if (kept_ && &kept_->model() == &stock) goal.kept = &*kept_;
    const StockSeparation found = separation(shapes, stock, goal);
    futile_left -= std::min(futile_left, found.futile);
    if (found.line) hint = found.line;
    if (found.separation.upper < goal.threshold)
        place = found.separation.point_b - leg.positions.back();
    else if (found.refined > 0)
        place.reset();
    context_.statistics.box_tests += found.box_tests;
    context_.statistics.shape_tests += found.shape_tests;
    context_.statistics.refined += found.refined;
    return found.separation;
}

StockObservation StockProbe::observe(const MovingBody& body, const Leg& leg, const CutModel& stock,
                                     double nearest) {
    const Allowance allowance = allowance_of(context_.setup, pair_of(body));
    const BodyLeg relative = context_.against_stock(body, leg);
    const double error = relative.shape_error();
    const double limit =
        std::min(context_.setup.search_limit, nearest) + (relative.turns ? error : 0.0);
    StockObservation seen{.travel = relative.travel};
    const double threshold =
        deciding_distance(allowance) + bounds_.off_path(allowance) + (relative.turns ? error : 0.0);
    // The shrunk body tells contact from overlap.
    constexpr double contact = 1e-7;
    const StockGoal goal{
        .limit = limit, .enough = body.profile ? contact : 0.0, .threshold = threshold};
    seen.plain = to_stock(body, relative, stock, goal);
    const bool may_touch = allowance.distance <= resolution && seen.plain.lower <= error;
    const bool touches = seen.plain.upper <= contact;
    if (may_touch && retraces(body, relative, stock, allowance)) {
        seen.shrunk.lower = infinity; // no stock where the shrunk part goes
    } else if (body.profile && touches && !may_touch
               && retraces(body, relative, stock, allowance)) {
        seen.plain.upper = std::max(seen.plain.upper, 1e-9); // contact, which the allowance forbids
    } else if (body.profile && (may_touch || touches)) {
        const double just_apart = resolution + error;
        seen.shrunk =
            to_stock(body, relative, stock, {.limit = 2.0 * just_apart, .threshold = just_apart},
                     contact_shrink(allowance, *body.profile));
        // If the shrunk body overlaps, so does the body, even if the body's own search ended
        // earlier.
        if (seen.shrunk.upper == 0.0) seen.plain = seen.shrunk;
    } else if (seen.plain.upper == 0.0) {
        seen.shrunk = seen.plain;
    }
    if (error > 0.0) add_error(seen, body, leg, relative, stock, nearest);
    return seen;
}

StockObservation StockProbe::observe_lower(const MovingBody& body, const Leg& leg,
                                           const CutModel& stock, double nearest) {
    const BodyLeg& relative = context_.against_stock(body, leg);
    if (relative.turns) return observe(body, leg, stock, nearest);
    const Allowance allowance = allowance_of(context_.setup, pair_of(body));
    const double limit = std::min(context_.setup.search_limit, nearest);
    const double threshold = deciding_distance(allowance) + bounds_.off_path(allowance);
    StockObservation seen{.travel = relative.travel, .whole = false};
    const StockGoal goal{.limit = limit, .bound = StockBound::lower, .threshold = threshold};
    seen.plain = widened(to_stock(body, relative, stock, goal), relative);
    if (seen.plain.lower <= allowance.distance + resolution + bounds_.off_path(allowance))
        return observe(body, leg, stock, nearest);
    return seen;
}

bool StockProbe::retraces(const MovingBody& body, const RelativeLeg& leg, const CutModel& stock,
                          const Allowance& allowance) const {
    if (context_.tool.parts.empty() || leg.turns || leg.positions.size() > 2) return false;
    // A shank does not cut, so it may have been inside the stock on the same path.
    if (body.kind != PartKind::flutes)
        return body.profile && fits_own_cut(context_.tool, body.kind)
               && stays_in_own_cut(
                   stock, {.part = *body.profile,
                           .flutes = context_.tool.parts[0].profile,
                           .from = leg.positions.front(),
                           .to = leg.positions.back(),
                           .sideways = contact_shrink(allowance, *body.profile) - leg.error,
                           .orientation = leg.orientation});
    PathQuery path{.flutes = context_.tool.parts[0].profile,
                   .from = leg.positions.front(),
                   .to = leg.positions.back(),
                   .sideways = 0.5 * contact_depth(allowance) - leg.error,
                   .orientation = leg.orientation};
    if (runs_in_own_cut(stock, path)) return true;
    // Contact was allowed on a passage, so only the same way counts.
    const SweepLog& passages = context_.memory.passages;
    path.sideways = resolution - leg.error;
    return passages.size() > 0 && runs_in_own_cut(passages, stock.outer_box, path);
}

PairClearance StockProbe::certain_clearance(const MovingBody& body, const Leg& leg, double start,
                                            const CutModel& certain) {
    PairClearance worst{.pair = pair_of(body)};
    worst.allowance = allowance_of(context_.setup, worst.pair);
    const auto add = [&](const Leg& part) {
        const StockObservation seen = observe(body, part, certain, context_.setup.search_limit);
        merge(worst, clearance(body, part, start, seen, seen));
    };
    if (!leg.straight) {
        for (const AxisValues& position : leg.certain) add(Leg{.positions = {position}});
    } else if (!context_.against_stock(body, leg).turns) {
        add(leg);
    } else {
        constexpr int places = 16; // the body is certainly at each of them
        for (int i = 0; i <= places; ++i) {
            const double fraction = double(i) / places;
            Leg still = stretch(leg, fraction, fraction);
            still.positions.resize(1);
            add(still);
        }
    }
    return worst;
}

void StockProbe::observe_on_way(StockObservation& seen, const MovingBody& body, const Leg& leg,
                                const BodyLeg& relative, const CutModel& stock, double nearest) {
    // The body is certainly at this position at one moment.
    const Leg still = still_half_way(leg);
    StockObservation here;
    double time = 0.5;
    const bool is_clear_of_contact = body.profile && seen.shrunk.lower > 0.0;
    if (is_clear_of_contact && allowance_of(context_.setup, pair_of(body)).distance <= resolution) {
        // Lower bounds are known, and the shrunk body overlaps nothing.
        const BodyLeg& at_rest = context_.against_stock(body, still);
        const double limit = std::min(context_.setup.search_limit, nearest);
        here.plain = widened(
            to_stock(body, at_rest, stock, {.limit = limit, .bound = StockBound::upper}), at_rest);
    } else {
        here = observe(body, still, stock, nearest);
        // Legs of bodies in parts are longer: an overlap may be elsewhere.
        constexpr double most = 8.0;
        const double places =
            relative.parts.empty()
                ? 0.0
                : std::min(most, std::ceil(relative.error / relative.shape_error()));
        for (double i = 0.5; i < places && here.shrunk.upper > 0.0; ++i) {
            Leg other = stretch(leg, i / places, i / places);
            other.positions.resize(1);
            const StockObservation there = observe(body, other, stock, nearest);
            if (there.shrunk.upper > 0.0) continue;
            here = there;
            time = i / places;
        }
    }
    seen.shrunk.upper = here.shrunk.upper;
    if (here.plain.upper >= seen.plain.upper) return;
    const double lower = seen.plain.lower;
    seen.plain = here.plain;
    seen.plain.lower = std::min(lower, here.plain.upper);
    seen.plain.time_a = time;
}

void StockProbe::add_error(StockObservation& seen, const MovingBody& body, const Leg& leg,
                           const BodyLeg& relative, const CutModel& stock, double nearest) {
    const bool near = seen.plain.lower <= relative.shape_error(),
               overlaps = seen.plain.upper == 0.0;
    const bool overlaps_shrunk = seen.shrunk.upper == 0.0;
    seen.plain = widened(seen.plain, relative);
    seen.shrunk = widened(seen.shrunk, relative);
    const bool has_way = leg.positions.size() > 1;
    if ((relative.turns || !body.profile) && near && has_way)
        observe_on_way(seen, body, leg, relative, stock, nearest);
    if (!overlaps) return;
    if (relative.error_without_deviation() <= 0.0) {
        seen.plain.upper = 0.0;
        if (overlaps_shrunk) seen.shrunk.upper = 0.0;
        return;
    }
    if (!body.profile) return;
    const RevolvedProfile sure = certain_sweep(*body.profile, relative);
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

PairClearance StockProbe::clearance(const MovingBody& body, const Leg& leg, double start,
                                    const StockObservation& before,
                                    const StockObservation& after) const {
    PairClearance now{.pair = pair_of(body)};
    now.allowance = allowance_of(context_.setup, now.pair);
    now.lower = std::min(before.plain.lower, context_.setup.search_limit);
    if (after.plain.found()) {
        now.upper = after.plain.upper;
        now.on_tool = after.plain.point_a;
        now.on_body = after.plain.point_b;
        now.time = start + leg.begin + after.plain.time_a * (leg.end - leg.begin);
    }
    now.verdict = judge_distance(now.allowance, now.lower, now.upper);
    const bool may_touch = now.allowance.distance <= resolution && now.lower <= 0.0;
    if (may_touch || now.upper == 0.0)
        now.verdict = judge_contact(now.allowance, before.shrunk.lower, after.shrunk.upper);
    return now;
}

bool StockProbe::is_clear(const MovingBody& body, const Leg& leg, const CutModel& stock) {
    const BodyLeg& relative = context_.against_stock(body, leg);
    if (relative.turns) return false;
    const Allowance allowance = allowance_of(context_.setup, pair_of(body));
    // Where a square of the finest side is too near, the answer is known.
    StockGoal goal{.bound = StockBound::lower, .futile_limit = 0};
    goal.threshold = deciding_distance(allowance);
    goal.limit = allowance.distance + relative.error + 2.0 * resolution;
    const double lower = widened(to_stock(body, relative, stock, goal), relative).lower;
    if (allowance.distance > resolution) return lower >= allowance.distance - resolution;
    if (lower > 0.0 || !body.profile) return lower > 0.0;
    goal.threshold = resolution + relative.error;
    goal.limit = 2.0 * goal.threshold;
    const double shrink = contact_shrink(allowance, *body.profile);
    return widened(to_stock(body, relative, stock, goal, shrink), relative).lower > 0.0;
}

double StockProbe::distance_to_box(const MovingBody& body, const RelativeLeg& leg,
                                   const Aabb& box) {
    const ConvexShape shape = convex(box);
    double lower = context_.setup.search_limit + leg.error;
    for (const ConvexShape& part : shapes_of(*body.body, leg)) {
        ++context_.statistics.shape_tests;
        lower = std::min(lower, separation(part, shape, {.limit = lower}).lower);
    }
    return lower - leg.error;
}

double StockProbe::earliest(const Leg& leg, const PairClearance& near, double distance,
                            const CutModel& stock, std::optional<double> seen) {
    if (!leg.straight || leg.positions.size() < 2) return 0.0;
    const Pair& pair = near.pair;
    const MovingBody& body = context_.body_of(pair);
    // As for the distance itself, if that is to a line along Z.
    const std::optional<LineId>& line = context_.memory.hints[static_cast<size_t>(body.kind)];
    const bool along_z_only =
        line && line->axis == 2
        && are_close(near.lower, distance, exact_within(near.allowance), stock.lines.grid.spacing);
    double after = 1.0; // the earliest known moment at which the pair is that near
    const auto until = [&](double fraction) {
        return leg_against(context_.setup, pair.fixture, body, stretch(leg, 0.0, fraction));
    };
    const auto reached = [&](double fraction) {
        const RelativeLeg moved = until(fraction);
        const double limit = distance + moved.error + resolution;
        Separation found{.upper = 0.0};
        if (moved.error < infinity)
            found = pair.fixture
                        ? distance_over(moved, body, context_.setup.fixtures[*pair.fixture].body,
                                        limit + resolution, context_.statistics.shape_tests)
                        : to_stock(body, {moved}, stock,
                                   {.limit = limit + resolution,
                                    .bound = StockBound::upper,
                                    .enough = limit,
                                    .along_z_only = along_z_only});
        if (found.upper > limit) return false;
        // The error is smaller on a shorter way, and the limit with it.
        after = std::min(after, moved.error > 0.0 ? fraction : fraction * found.time_a);
        return true;
    };
    // Usually it is at the witness and not before, or as soon as the witness is near enough.
    constexpr double step = 1e-4;
    if (seen && (*seen <= step || !reached(*seen - step))) return *seen;
    if (seen && !pair.fixture && body.profile) {
        const Aabb witness{near.on_body, near.on_body};
        const auto is_near_witness = [&](double fraction) {
            const RelativeLeg moved = until(fraction);
            const double limit = distance + moved.error + resolution;
            const std::vector<ConvexShape> shapes = shapes_of(*body.profile, moved);
            return std::any_of(shapes.begin(), shapes.end(), [&](const ConvexShape& shape) {
                const ShapeOutline around = outline(shape);
                if (distance_bound(around, witness, limit + resolution) > limit) return false;
                const ConvexShape point = convex_segment(near.on_body, near.on_body);
                const SeparationGoal goal{.limit = limit + resolution};
                return around.exact || separation(shape, point, goal).upper <= limit;
            });
        };
        double before = 0.0, alone = *seen;
        while (alone - before > step) {
            const double middle = 0.5 * (before + alone);
            (is_near_witness(middle) ? alone : before) = middle;
        }
        if (alone > step && after >= alone - step && !reached(alone - step)) return alone;
    }
    if (reached(0.0)) return 0.0;
    for (double before = 0.0; after - before > step;) {
        const double middle = 0.5 * (before + after);
        if (!reached(middle)) before = middle;
    }
    return after;
}

void StockProbe::settle_time(PairClearance& now, const Leg& leg, double start,
                             const CutModel& stock) {
    if (now.verdict == Verdict::clear || !now.found() || context_.setup.needs_only_verdict) return;
    const double begin = start + leg.begin, takes = leg.end - leg.begin;
    const double seen = takes > 0.0 ? (now.time - begin) / takes : 0.0;
    now.time = begin + earliest(leg, now, now.upper, stock, seen) * takes;
}

} // namespace core
