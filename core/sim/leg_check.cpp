#include "core/sim/leg_check.h"

#include <cassert>

#include "core/dbm/covered_path.h"

namespace core {
namespace {

PairClearance& entry(std::vector<PairClearance>& pairs, const Pair& pair,
                     const Allowance& allowance) {
    for (PairClearance& known : pairs)
        if (known.pair == pair) return known;
    pairs.push_back({.pair = pair, .allowance = allowance});
    return pairs.back();
}

/// The stretch of a straight leg between two shares of it.
Leg stretch(const Leg& leg, double first, double last) {
    const auto place = [&](double share) {
        return leg.places[0] + share * (leg.places[1] - leg.places[0]);
    };
    const auto time = [&](double share) { return leg.begin + share * (leg.end - leg.begin); };
    return {{place(first), place(last)}, time(first), time(last), leg.path_error};
}

/// How far a point of the tool moves at most along a leg.
double reach(const Leg& leg) {
    return glm::distance(leg.places.front(), leg.places.back()) + leg.path_error;
}

/// Whether a leg cannot bring a pair nearer than it has been in this block: no point of the tool
/// moves farther than the leg is long. Keeps the bound at the leg's end up to date if so.
bool stays_away(PairClearance& known, const Leg& leg) {
    if (!leg.straight || known.at_end - reach(leg) < known.upper) return false;
    known.at_end -= reach(leg);
    return true;
}

double length(const Leg& leg) { return glm::distance(leg.places.front(), leg.places.back()); }

/// What narrows the search against the stock: the interval should not span the allowance.
double deciding_distance(const Allowance& allowance) {
    return allowance.distance > resolution ? allowance.distance - resolution : 0.0;
}

Separation widened(Separation found, double by) {
    found.lower = std::max(0.0, found.lower - by);
    if (found.upper > 0.0) found.upper += by;
    return found;
}

} // namespace

LegCheck::Shapes LegCheck::shapes(const RevolvedProfile& profile, const Leg& leg) const {
    std::vector<Vec3> places;
    for (const Vec3& place : leg.places)
        places.push_back(place - setup_.stock_origin - Vec3(0.0, 0.0, tool_.length));
    Shapes result;
    for (const ProfileElement& element : profile.elements)
        result.push_back(swept(convex(element), places));
    return result;
}

Separation LegCheck::to_fixture(const Shapes& shapes, const Fixture& fixture, double limit) {
    Separation best;
    double lower = infinity;
    for (const ConvexShape& shape : shapes) {
        ++statistics_.shape_tests;
        const double worth = std::min(limit, best.upper);
        const Separation found = separation(shape, fixture.body, {.limit = worth});
        lower = std::min(lower, found.lower);
        if (found.upper < best.upper) best = found;
    }
    best.lower = std::min(lower, best.upper);
    return best;
}

Separation LegCheck::to_stock(PartKind part, const Shapes& shapes, const CutModel& stock,
                              double threshold, double limit) {
    std::optional<LineId>& hint = hints_[static_cast<size_t>(part)];
    const StockSeparation found =
        separation(shapes, stock,
                   {.limit = limit, .threshold = std::min(threshold, limit), .first_line = hint});
    if (found.line) hint = found.line;
    statistics_.box_tests += found.box_tests;
    statistics_.shape_tests += found.shape_tests;
    statistics_.refined += found.refined;
    return found.separation;
}

void LegCheck::check_fixture(const Leg& leg, double start, size_t fixture, const ToolPart& part,
                             std::vector<PairClearance>& pairs) {
    const Fixture& body = setup_.fixtures[fixture];
    const Allowance allowance = fixture_allowance(setup_, part.kind, body);
    PairClearance& known = entry(pairs, {part.kind, fixture}, allowance);
    if (stays_away(known, leg)) return;
    const double limit = std::min(setup_.search_limit, known.upper);
    const Separation found =
        widened(to_fixture(shapes(part.profile, leg), body, limit), leg.path_error);
    PairClearance now{.pair = known.pair, .allowance = allowance};
    now.lower = std::min(found.lower, setup_.search_limit);
    if (found.found()) {
        now.upper = found.upper;
        now.on_tool = found.point_a;
        now.on_body = found.point_b;
        now.time = start + leg.begin + found.time_a * (leg.end - leg.begin);
    }
    now.verdict = judge_distance(allowance, now.lower, now.upper);
    if (now.upper == 0.0 || (allowance.distance <= resolution && now.lower <= 0.0)) {
        const RevolvedProfile inner =
            shrunk_around(part.profile, contact_shrink(allowance, part.profile));
        const Separation shrunk =
            widened(to_fixture(shapes(inner, leg), body, setup_.search_limit), leg.path_error);
        now.verdict = judge_contact(allowance, shrunk.lower, shrunk.upper);
    }
    merge(known, now);
}

void LegCheck::check_fixtures(const Leg& leg, double start, std::vector<PairClearance>& pairs) {
    for (size_t fixture = 0; fixture < setup_.fixtures.size(); ++fixture)
        for (const ToolPart& part : tool_.parts) {
            const bool chips = part.kind == PartKind::flutes && use_ == FluteUse::cutting;
            if (chips && setup_.fixtures[fixture].expendable) continue;
            check_fixture(leg, start, fixture, part, pairs);
        }
}

LegCheck::Observation LegCheck::observe(const ToolPart& part, const Leg& leg, const CutModel& stock,
                                        double nearest) {
    const Allowance allowance = stock_allowance(setup_, part.kind);
    const double limit = std::min(setup_.search_limit, nearest);
    Observation seen;
    seen.plain =
        to_stock(part.kind, shapes(part.profile, leg), stock, deciding_distance(allowance), limit);
    const bool may_touch = allowance.distance <= resolution && seen.plain.lower <= leg.path_error;
    if (may_touch && retraces(part, leg, stock, allowance)) {
        seen.shrunk.lower = infinity; // no stock where the shrunk part goes
    } else if (may_touch || seen.plain.upper == 0.0) {
        const RevolvedProfile inner =
            shrunk_around(part.profile, contact_shrink(allowance, part.profile));
        const double just_apart = resolution + leg.path_error;
        seen.shrunk = to_stock(part.kind, shapes(inner, leg), stock, just_apart, 2.0 * just_apart);
    }
    seen.plain = widened(seen.plain, leg.path_error);
    seen.shrunk = widened(seen.shrunk, leg.path_error);
    return seen;
}

bool LegCheck::retraces(const ToolPart& part, const Leg& leg, const CutModel& stock,
                        const Allowance& allowance) const {
    const RevolvedProfile& flutes = tool_.parts[0].profile;
    const double widest = bounds(flutes).max.x;
    if (!leg.straight || part.kind == PartKind::holder || bounds(part.profile).max.x > widest)
        return false;
    // Half of the contact depth is for the way, the rest for the errors of both paths.
    const double path_errors = leg.path_error + chord_error(setup_.mesh_size);
    const Vec3 tip = setup_.stock_origin + Vec3(0.0, 0.0, tool_.length);
    return runs_in_own_cut(stock, {.flutes = flutes,
                                   .from = leg.places.front() - tip,
                                   .to = leg.places.back() - tip,
                                   .sideways = 0.5 * contact_depth(allowance) - path_errors});
}

PairClearance LegCheck::clearance(const ToolPart& part, const Leg& leg, double start,
                                  const Observation& before, const Observation& after) const {
    PairClearance now{.pair = {part.kind, std::nullopt},
                      .allowance = stock_allowance(setup_, part.kind)};
    now.lower = before.plain.lower;
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
    std::vector<PartCheck> checks;
    bool settled = true;
    for (const ToolPart& part : tool_.parts) {
        const Allowance allowance = stock_allowance(setup_, part.kind);
        if (part.kind == PartKind::flutes) continue;
        PairClearance& known = entry(pairs, {part.kind, std::nullopt}, allowance);
        if (stays_away(known, leg)) continue;
        const Observation before = observe(part, leg, stock, known.upper);
        const bool clear = clearance(part, leg, start, before, before).verdict == Verdict::clear;
        settled = settled && clear;
        checks.push_back({part, before, clear});
    }
    if (!settled && length(leg) > setup_.mesh_size && depends_on_time(checks, leg, stock))
        return check_cutting(stretch(leg, 0.0, 0.5), start, stock, pairs)
               + check_cutting(stretch(leg, 0.5, 1.0), start, stock, pairs);

    const double removed = cut_along(leg, stock);
    for (const PartCheck& check : checks) {
        const Observation after = removed > 0.0 ? look_again(check, leg, stock) : check.before;
        PairClearance now = clearance(check.part, leg, start, check.before, after);
        if (now.verdict == Verdict::collision)
            now.time =
                start + leg.begin + earliest(leg, now.pair, 0.0, stock) * (leg.end - leg.begin);
        merge(entry(pairs, now.pair, now.allowance), now);
    }
    return removed;
}

bool LegCheck::depends_on_time(const std::vector<PartCheck>& checks, const Leg& leg,
                               const CutModel& stock) {
    // What is too near both before and after the cut is so in any order.
    CutModel cut_already = stock;
    cut_along(leg, cut_already);
    for (const PartCheck& check : checks) {
        if (check.clear) continue;
        const Observation after = look_again(check, leg, cut_already);
        if (clearance(check.part, leg, 0.0, after, after).verdict == Verdict::clear) return true;
    }
    return false;
}

LegCheck::Observation LegCheck::look_again(const PartCheck& check, const Leg& leg,
                                           const CutModel& stock) {
    if (!check.before.plain.found()) return check.before;
    if (!check.clear) return observe(check.part, leg, stock, setup_.search_limit);
    // Clear by its lower bound: what is left of the stock only gives the upper one.
    Observation after = check.before;
    after.plain = widened(
        to_stock(check.part.kind, shapes(check.part.profile, leg), stock, 0.0, setup_.search_limit),
        leg.path_error);
    return after;
}

bool LegCheck::check_parts(const Leg& leg, double start, const CutModel& stock,
                           std::vector<PairClearance>& pairs) {
    bool gouged = false;
    for (const ToolPart& part : tool_.parts) {
        const Allowance allowance = stock_allowance(setup_, part.kind);
        PairClearance& known = entry(pairs, {part.kind, std::nullopt}, allowance);
        if (stays_away(known, leg)) continue;
        const Observation seen = observe(part, leg, stock, known.upper);
        const PairClearance now = clearance(part, leg, start, seen, seen);
        gouged = gouged || (part.kind == PartKind::flutes && now.verdict == Verdict::collision);
        merge(known, now);
    }
    return gouged;
}

double LegCheck::check_not_cutting(const Leg& leg, double start, CutModel& stock,
                                   std::vector<PairClearance>& pairs) {
    const bool gouged = check_parts(leg, start, stock, pairs);
    if (gouged) {
        PairClearance& flutes = entry(pairs, {PartKind::flutes, std::nullopt}, {});
        const double share = earliest(leg, flutes.pair, 0.0, stock);
        flutes.time = std::min(flutes.time, start + leg.begin + share * (leg.end - leg.begin));
    }
    // After the finding the material is gone, so that one crash is one finding.
    return gouged ? cut_along(leg, stock) : 0.0;
}

double LegCheck::cut_along(const Leg& leg, CutModel& stock) {
    assert(leg.straight);
    const Vec3 tip(0.0, 0.0, tool_.length);
    const auto cutter =
        std::make_shared<const Cutter>(make_cutter(tool_.parts[0].profile, leg.path_error));
    ++statistics_.sweeps;
    return cut(stock, {cutter, leg.places[0] - setup_.stock_origin - tip,
                       leg.places[1] - setup_.stock_origin - tip});
}

double LegCheck::run(const Leg& leg, double start, CutModel& stock,
                     std::vector<PairClearance>& pairs) {
    if (!leg.straight) {
        check_hull(leg, start, stock, pairs);
        return 0.0;
    }
    check_fixtures(leg, start, pairs);
    return use_ == FluteUse::cutting ? check_cutting(leg, start, stock, pairs)
                                     : check_not_cutting(leg, start, stock, pairs);
}

void LegCheck::check_hull(const Leg& leg, double start, const CutModel& stock,
                          std::vector<PairClearance>& pairs) {
    // What the hull keeps away from is safe; what it meets need not happen, unless a place that is
    // certainly taken meets it too.
    std::vector<PairClearance> anywhere;
    check_fixtures(leg, start, anywhere);
    check_parts(leg, start, stock, anywhere);
    std::vector<PairClearance> certain;
    for (const Vec3& place : leg.certain) rest(place, stock, certain);
    for (PairClearance& pair : anywhere) {
        const bool safe = pair.verdict == Verdict::clear;
        PairClearance now{.pair = pair.pair, .allowance = pair.allowance, .lower = pair.lower};
        for (const PairClearance& there : certain)
            if (there.pair == pair.pair) merge(now, there);
        now.lower = pair.lower;
        now.time = start + leg.end;
        if (!safe) now.verdict = std::max(now.verdict, Verdict::undecided);
        merge(entry(pairs, pair.pair, pair.allowance), now);
    }
}

void LegCheck::rest(const Vec3& place, const CutModel& stock, std::vector<PairClearance>& pairs) {
    const Leg leg{.places = {place}};
    check_fixtures(leg, 0.0, pairs);
    check_parts(leg, 0.0, stock, pairs);
}

double LegCheck::earliest(const Leg& leg, const Pair& pair, double distance,
                          const CutModel& stock) {
    if (!leg.straight) return 0.0;
    const ToolPart* part = nullptr;
    for (const ToolPart& candidate : tool_.parts)
        if (candidate.kind == pair.part) part = &candidate;
    const auto reached = [&](double share) {
        const Shapes moved = shapes(part->profile, stretch(leg, 0.0, share));
        const double limit = distance + leg.path_error + resolution;
        const Separation found =
            pair.fixture ? to_fixture(moved, setup_.fixtures[*pair.fixture], limit + 1.0)
                         : to_stock(part->kind, moved, stock, 0.0, limit + 1.0);
        return found.upper <= limit;
    };
    if (reached(0.0)) return 0.0;
    double before = 0.0, after = 1.0;
    for (int i = 0; i < 24; ++i) {
        const double middle = 0.5 * (before + after);
        (reached(middle) ? after : before) = middle;
    }
    return after;
}

} // namespace core
