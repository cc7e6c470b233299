#include "core/sim/leg/leg_check.h"

#include <cassert>

#include "core/dbm/covered_path.h"
#include "core/sim/leg/pair_entry.h"
#include "core/sim/setup.h"

namespace core {
namespace {

double length(const Leg& leg) {
    double sum = 0.0;
    for (size_t i = 0; i < axis_count; ++i) {
        const double by = leg.places.back()[i] - leg.places.front()[i];
        if (!is_rotary(i)) sum += by * by;
    }
    return std::sqrt(sum);
}

/// What narrows the search against the stock: the interval should not span the allowance.
double deciding_distance(const Allowance& allowance) {
    return allowance.distance > resolution ? allowance.distance - resolution : 0.0;
}

/// The least of a row of errors, a quarter apart, that is no less than this: cutters are made for
/// these.
double rounded_up(double error) {
    double step = 1e-5;
    while (step < error) step *= 1.25;
    return step;
}

} // namespace

Pair LegCheck::pair_of(const MovingBody& body, std::optional<size_t> fixture) {
    return {body.kind, fixture, body.carried};
}

const MovingBody& LegCheck::body_of(const Pair& pair) const {
    for (const MovingBody& body : bodies_)
        if (body.kind == pair.part && body.carried == pair.carried) return body;
    assert(false);
    return bodies_.front();
}

RelativeLeg LegCheck::against_stock(const MovingBody& body, const Leg& leg) const {
    return relative_leg(setup_.machine, setup_.stock_mount, body.mover, leg);
}

double LegCheck::finest_error(const MovingBody& body) const {
    const double cut = std::clamp(setup_.mesh_size / 50.0, 0.002, 0.01);
    if (body.kind == PartKind::flutes) return cut;
    return body.kind == PartKind::shank ? 2.0 * cut : 10.0 * cut;
}

Separation LegCheck::to_stock(const MovingBody& body, const RelativeLeg& leg, const CutModel& stock,
                              StockGoal goal, double shrink) {
    // Most bodies of a machine are far away, and made of many triangles.
    if (body.body && distance(bounds(body, leg), stock.outer_box) >= goal.limit)
        return {.lower = goal.limit};
    const std::vector<ConvexShape> shapes =
        !body.profile  ? shapes_of(*body.body, leg)
        : shrink > 0.0 ? shapes_of(shrunk_around(*body.profile, shrink), leg)
                       : shapes_of(*body.profile, leg);
    std::optional<LineId>& hint = memory_.hints[static_cast<size_t>(body.kind)];
    goal.first_line = hint;
    goal.threshold = std::min(goal.threshold, goal.limit);
    const StockSeparation found = separation(shapes, stock, goal);
    if (found.line) hint = found.line;
    statistics_.box_tests += found.box_tests;
    statistics_.shape_tests += found.shape_tests;
    statistics_.refined += found.refined;
    return found.separation;
}

LegCheck::Observation LegCheck::observe(const MovingBody& body, const Leg& leg,
                                        const CutModel& stock, double nearest) {
    const Allowance allowance = allowance_of(setup_, pair_of(body));
    const RelativeLeg relative = against_stock(body, leg);
    const double error = relative.error;
    const double limit = std::min(setup_.search_limit, nearest) + (relative.turns ? error : 0.0);
    Observation seen{.travel = relative.travel};
    const double threshold =
        deciding_distance(allowance) + off_path(allowance) + (relative.turns ? error : 0.0);
    seen.plain = to_stock(body, relative, stock, {.limit = limit, .threshold = threshold});
    const bool may_touch = allowance.distance <= resolution && seen.plain.lower <= error;
    if (may_touch && retraces(body, relative, stock, allowance)) {
        seen.shrunk.lower = infinity; // no stock where the shrunk part goes
    } else if (body.profile && (may_touch || seen.plain.upper == 0.0)) {
        const double just_apart = resolution + error;
        seen.shrunk =
            to_stock(body, relative, stock, {.limit = 2.0 * just_apart, .threshold = just_apart},
                     contact_shrink(allowance, *body.profile));
        // What meets a part of the body meets the body, though its own search ended before.
        if (seen.shrunk.upper == 0.0) seen.plain = seen.shrunk;
    } else if (seen.plain.upper == 0.0) {
        seen.shrunk = seen.plain;
    }
    if (error > 0.0) make_sure(seen, body, leg, relative, stock, nearest);
    return seen;
}

LegCheck::Observation LegCheck::observe_lower(const MovingBody& body, const Leg& leg,
                                              const CutModel& stock, double nearest) {
    const RelativeLeg relative = against_stock(body, leg);
    if (relative.turns) return observe(body, leg, stock, nearest);
    const Allowance allowance = allowance_of(setup_, pair_of(body));
    const double limit = std::min(setup_.search_limit, nearest);
    const double threshold = deciding_distance(allowance) + off_path(allowance);
    Observation seen{.travel = relative.travel, .whole = false};
    const StockGoal goal{.limit = limit, .bound = StockBound::lower, .threshold = threshold};
    seen.plain = widened(to_stock(body, relative, stock, goal), relative);
    if (seen.plain.lower <= allowance.distance + resolution + off_path(allowance))
        return observe(body, leg, stock, nearest);
    return seen;
}

bool LegCheck::retraces(const MovingBody& body, const RelativeLeg& leg, const CutModel& stock,
                        const Allowance& allowance) const {
    // Where a shank has been it need not have been free: it cuts nothing.
    if (tool_.parts.empty() || body.kind != PartKind::flutes) return false;
    if (leg.turns || leg.places.size() > 2) return false;
    return runs_in_own_cut(stock, {.flutes = tool_.parts[0].profile,
                                   .from = leg.places.front(),
                                   .to = leg.places.back(),
                                   .sideways = 0.5 * contact_depth(allowance) - leg.error,
                                   .orientation = leg.orientation});
}

PairClearance LegCheck::clearance(const MovingBody& body, const Leg& leg, double start,
                                  const Observation& before, const Observation& after) const {
    PairClearance now{.pair = pair_of(body)};
    now.allowance = allowance_of(setup_, now.pair);
    now.lower = std::min(before.plain.lower, setup_.search_limit);
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

double LegCheck::check_cutting(const Leg& leg, double start, CutModel& stock,
                               std::vector<PairClearance>& pairs) {
    let_pass({PartKind::flutes}, pairs);
    std::vector<BodyCheck> checks;
    std::vector<const MovingBody*> later;
    bool settled = true;
    for (const MovingBody* body : likely_first({})) {
        if (body->kind == PartKind::flutes || (only_tool_ && body->body)) continue;
        PairClearance& known = known_pair(pairs, pair_of(*body));
        if (says_nothing(known, pairs)) continue;
        if (says_likely_nothing(known)) {
            later.push_back(body);
            continue;
        }
        if (stays_away(known, leg, against_stock(*body, leg))) continue;
        const Observation before = observe_lower(*body, leg, stock, known.upper);
        const bool clear = clearance(*body, leg, start, before, before).verdict == Verdict::clear;
        settled = settled && clear;
        checks.push_back({*body, before, clear, known.upper});
    }
    if (!settled && length(leg) > setup_.mesh_size && depends_on_time(checks, leg, stock)) {
        travel_ *= 0.5;
        double removed = check_cutting(stretch(leg, 0.0, 0.5), start, stock, pairs);
        removed += check_cutting(stretch(leg, 0.5, 1.0), start, stock, pairs);
        travel_ *= 2.0;
        return removed;
    }
    // What is cut between the lines has no volume to them, yet a witness may have stood there.
    const size_t sweeps = stock.log.size();
    const double removed = cut_along(leg, stock);
    const bool cut = stock.log.size() > sweeps;
    for (const BodyCheck& check : checks) conclude(check, leg, start, stock, cut, pairs);
    for (const MovingBody* body : later) look_late(*body, leg, start, stock, pairs);
    return removed;
}

void LegCheck::conclude(const BodyCheck& check, const Leg& leg, double start, const CutModel& stock,
                        bool cut, std::vector<PairClearance>& pairs) {
    PairClearance& known = known_pair(pairs, pair_of(check.body));
    if (check.clear && !check.before.whole
        && is_beside_the_point(known.allowance, check.before.plain.lower, pairs)) {
        merge(known, clearance(check.body, leg, start, check.before, {}));
        known.drift = travel_;
        return;
    }
    const bool is_told = check.before.whole && !cut;
    const Observation after = is_told ? check.before : look_again(check, leg, stock);
    PairClearance now = clearance(check.body, leg, start, check.before, after);
    settle_time(now, leg, start, stock);
    merge(known, now);
    known.drift = travel_;
}

void LegCheck::look_late(const MovingBody& body, const Leg& leg, double start,
                         const CutModel& stock, std::vector<PairClearance>& pairs) {
    PairClearance& known = known_pair(pairs, pair_of(body));
    if (says_nothing(known, pairs)) return;
    // The stock of before is gone. It was what is left and what the flutes took on their way.
    const RelativeLeg relative = against_stock(body, leg);
    const RelativeLeg flutes = against_stock(bodies_[0], leg);
    const double limit = std::min(setup_.search_limit, known.upper);
    Observation seen;
    seen.plain = widened(to_stock(body, relative, stock, {.limit = limit}), relative);
    const double taken = distance(bounds(body, relative), bounds(bodies_[0], flutes));
    const double carried = known.at_end - travel_;
    const double fresh = std::min(seen.plain.lower, taken - resolution);
    const double drift = fresh >= carried ? travel_ : known.drift + travel_;
    seen.plain.lower = std::max(carried, fresh);
    merge(known, clearance(body, leg, start, seen, seen));
    known.drift = drift;
}

bool LegCheck::depends_on_time(const std::vector<BodyCheck>& checks, const Leg& leg,
                               const CutModel& stock) {
    // What is too near both before and after the cut is so in any order.
    CutModel cut_already = stock;
    cut_along(leg, cut_already);
    for (const BodyCheck& check : checks) {
        if (check.clear) continue;
        const Observation after = look_again(check, leg, cut_already);
        if (clearance(check.body, leg, 0.0, after, after).verdict == Verdict::clear) return true;
    }
    return false;
}

LegCheck::Observation LegCheck::look_again(const BodyCheck& check, const Leg& leg,
                                           const CutModel& stock) {
    if (!check.clear) return observe(check.body, leg, stock, setup_.search_limit);
    // Clear by its lower bound: what is left of the stock only gives the upper one.
    Observation after = check.before;
    const double limit = std::min(setup_.search_limit, check.nearest);
    after.plain = Separation{.lower = after.plain.lower};
    if (after.plain.lower >= limit) return after;
    const RelativeLeg relative = against_stock(check.body, leg);
    const StockGoal goal{
        .limit = limit, .bound = StockBound::upper, .enough = after.plain.lower + resolution};
    after.plain = widened(to_stock(check.body, relative, stock, goal), relative);
    return after;
}

bool LegCheck::check_bodies(const Leg& leg, double start, const CutModel& stock,
                            std::vector<PairClearance>& pairs) {
    bool gouged = false;
    for (const MovingBody* body : likely_first({})) {
        if (only_tool_ && body->body) continue;
        PairClearance& known = known_pair(pairs, pair_of(*body));
        if (says_nothing(known, pairs)) continue;
        if (stays_away(known, leg, against_stock(*body, leg))) continue;
        const Observation seen = observe(*body, leg, stock, known.upper);
        PairClearance now = clearance(*body, leg, start, seen, seen);
        if (body->kind != PartKind::flutes) settle_time(now, leg, start, stock);
        gouged = gouged || (body->kind == PartKind::flutes && now.verdict == Verdict::collision);
        merge(known, now);
        known.drift = travel_;
    }
    return gouged;
}

double LegCheck::check_not_cutting(const Leg& leg, double start, CutModel& stock,
                                   std::vector<PairClearance>& pairs) {
    const bool gouged = check_bodies(leg, start, stock, pairs);
    if (gouged) {
        PairClearance& flutes = entry(pairs, {PartKind::flutes}, setup_);
        const double share = earliest(leg, flutes.pair, 0.0, stock);
        flutes.time = std::min(flutes.time, start + leg.begin + share * (leg.end - leg.begin));
    }
    // After the finding the material is gone, so that one crash is one finding.
    return gouged ? cut_along(leg, stock) : 0.0;
}

double LegCheck::check_whole(const Leg& leg, double start, CutModel& stock,
                             std::vector<PairClearance>& pairs) {
    return use_ == FluteUse::cutting ? check_cutting(leg, start, stock, pairs)
                                     : check_not_cutting(leg, start, stock, pairs);
}

std::shared_ptr<const Cutter> LegCheck::cutter_for(const RelativeLeg& leg) {
    const double error = leg.turns ? rounded_up(leg.error) : leg.error;
    auto& cutter = memory_.cutters[{tool_.description.number, error}];
    if (!cutter)
        cutter = std::make_shared<const Cutter>(make_cutter(tool_.parts[0].profile, error));
    return cutter;
}

double LegCheck::cut_along(const Leg& leg, CutModel& stock) {
    assert(leg.straight);
    if (tool_.parts.empty()) return 0.0;
    const RelativeLeg way = against_stock(bodies_[0], leg);
    ++statistics_.sweeps;
    return cut(stock, {.cutter = cutter_for(way),
                       .from = way.places.front(),
                       .to = way.places.back(),
                       .orientation = way.orientation,
                       .block = value_of(block_)});
}

double LegCheck::run(const Leg& leg, double start, CutModel& stock,
                     std::vector<PairClearance>& pairs) {
    travel_ = greatest_travel(setup_.machine, leg);
    const size_t tests_before = statistics_.box_tests;
    double removed = 0.0;
    if (!leg.straight) {
        check_hull(leg, start, stock, pairs);
    } else if (memory_.deciding && !memory_.deciding->fixture) {
        removed = check_stock(leg, start, stock, pairs);
        check_fixtures(leg, start, pairs);
    } else {
        check_fixtures(leg, start, pairs);
        removed = check_stock(leg, start, stock, pairs);
    }
    note_search(stock, statistics_.box_tests - tests_before);
    for (PairBound& bound : memory_.bounds) bound.apart -= travel_;
    return removed;
}

void LegCheck::check_hull(const Leg& leg, double start, const CutModel& stock,
                          std::vector<PairClearance>& pairs) {
    // What the hull keeps away from is safe; what it meets need not happen, unless a place that is
    // certainly taken meets it too.
    std::vector<PairClearance> anywhere;
    check_fixtures(leg, start, anywhere);
    check_bodies(leg, start, stock, anywhere);
    std::vector<PairClearance> certain;
    for (const AxisValues& place : leg.certain) rest(place, 0.0, stock, certain);
    for (PairClearance& pair : anywhere) {
        const bool safe = pair.verdict == Verdict::clear;
        PairClearance now{.pair = pair.pair, .allowance = pair.allowance, .lower = pair.lower};
        for (const PairClearance& there : certain)
            if (there.pair == pair.pair) merge(now, there);
        now.lower = pair.lower;
        now.time = start + leg.end;
        if (!safe) now.verdict = std::max(now.verdict, Verdict::undecided);
        merge(entry(pairs, pair.pair, setup_), now);
    }
}

double LegCheck::room_of_flutes(const Leg& leg, const CutModel& stock, double limit) {
    if (tool_.parts.empty() || !leg.straight) return 0.0;
    const RelativeLeg way = against_stock(bodies_[0], leg);
    if (way.error >= limit) return 0.0;
    const StockGoal goal{.limit = limit + way.error, .bound = StockBound::lower};
    return std::max(0.0, to_stock(bodies_[0], way, stock, goal).lower - way.error);
}

void LegCheck::rest(const AxisValues& place, double time, const CutModel& stock,
                    std::vector<PairClearance>& pairs) {
    const Leg leg{.places = {place}};
    for (PairClearance& pair : pairs) pair.at_end = -infinity; // nobody says how it came here
    check_fixtures(leg, time, pairs);
    check_bodies(leg, time, stock, pairs);
}

} // namespace core
