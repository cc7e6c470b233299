#include <algorithm>

#include "core/dbm/covered_path.h"
#include "core/sim/leg/leg_check.h"
#include "core/sim/leg/pair_entry.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// From the frame of a fixture to that of the stock, at these axis values.
Transform stock_from_fixture(const Setup& setup, const Fixture& fixture, const AxisValues& values) {
    if (fixture.mount.link == setup.stock_mount.link)
        return setup.stock_mount.link_from_body.inverse() * fixture.mount.link_from_body;
    return target_from_mover(setup.machine, setup.stock_mount, fixture.mount, values);
}

/// The axis values at a share of a leg; at its start where the way is not known.
AxisValues values_at(const Leg& leg, double share) {
    return leg.straight && leg.places.size() == 2 ? stretch(leg, 0.0, share).places[1]
                                                  : leg.places[0];
}

} // namespace

PairClearance LegCheck::look_at_fixture(const Leg& leg, double start, const RelativeLeg& relative,
                                        const MovingBody& body, const PairClearance& known) {
    const Fixture& fixture = setup_.fixtures[*known.pair.fixture];
    const Allowance& allowance = known.allowance;
    const double limit =
        std::min(setup_.search_limit, known.upper) + (relative.turns ? relative.error : 0.0);
    const Separation seen =
        distance_over(relative, body, fixture.body, limit, statistics_.shape_tests);
    const Separation found = widened(seen, relative);
    PairClearance now{.pair = known.pair, .allowance = allowance};
    now.lower = std::min(found.lower, setup_.search_limit);
    if (found.found()) {
        const Transform stock_from =
            stock_from_fixture(setup_, fixture, values_at(leg, found.time_a));
        now.upper = found.upper;
        now.on_tool = stock_from * found.point_a;
        now.on_body = stock_from * found.point_b;
        now.time = start + leg.begin + found.time_a * (leg.end - leg.begin);
    }
    now.verdict = judge_distance(allowance, now.lower, now.upper);
    const bool may_touch = allowance.distance <= resolution && now.lower <= 0.0;
    if (seen.upper > 0.0 && !may_touch) return now;
    if (!body.profile) {
        if (may_touch || now.upper == 0.0)
            now.verdict = judge_contact(allowance, now.lower, now.upper);
        return now;
    }
    const auto look = [&](const RevolvedProfile& part) {
        return distance_over(relative, part, fixture.body, setup_.search_limit,
                             statistics_.shape_tests);
    };
    if (seen.upper == 0.0 && relative.error > 0.0) {
        const RevolvedProfile sure = surely_passing(*body.profile, relative);
        if (!sure.empty() && look(sure).upper == 0.0) now.upper = 0.0;
    }
    if (now.upper > 0.0 && !may_touch) return now;
    const Separation inner =
        look(shrunk_around(*body.profile, contact_shrink(allowance, *body.profile)));
    const bool collides = inner.upper == 0.0 && now.upper == 0.0;
    const Separation shrunk = widened(inner, relative);
    now.verdict = judge_contact(allowance, shrunk.lower, collides ? 0.0 : shrunk.upper);
    return now;
}

bool LegCheck::is_sharp(const PairClearance& now, const PairClearance& known) const {
    constexpr double sharp = 1e-3; // mm
    const double nearest = std::min({known.upper, now.upper, setup_.search_limit});
    return now.verdict == Verdict::collision
           || (now.verdict != Verdict::undecided && now.lower >= nearest - sharp);
}

void LegCheck::check_passage(const Leg& leg, double start, size_t fixture, const MovingBody& body,
                             const RelativeLeg& relative, PairClearance& known) {
    PairClearance now = look_at_fixture(leg, start, relative, body, known);
    if (!leg.arc.motion || is_sharp(now, known)) return merge(known, now);
    doubtful_.push_back({leg, start, fixture, &body, now});
    // Its lower bound waits for `settle`: another chord may turn out to be nearer.
    const double lower = now.lower;
    now.lower = infinity;
    now.verdict = Verdict::clear;
    merge(known, now);
    known.at_end = lower;
}

void LegCheck::divide(const Doubtful& doubt, PairClearance& known) {
    const Mount& mount = setup_.fixtures[doubt.fixture].mount;
    const auto look = [&](const Leg& leg) {
        const RelativeLeg relative = relative_leg(setup_.machine, mount, doubt.body->mover, leg);
        return look_at_fixture(leg, doubt.start, relative, *doubt.body, known);
    };
    constexpr double finest = 1e-5; // mm, of a chord's error
    if (is_sharp(doubt.seen, known) || doubt.leg.path_error <= finest)
        return merge(known, doubt.seen);
    if (doubt.seen.lower <= 0.0) {
        const PairClearance there = look(still_half_way(doubt.leg));
        if (there.verdict == Verdict::collision) return merge(known, there);
    }
    for (const Leg& half : halves(doubt.leg))
        divide({half, doubt.start, doubt.fixture, doubt.body, look(half)}, known);
}

void LegCheck::settle(std::vector<PairClearance>& pairs) {
    std::stable_sort(doubtful_.begin(), doubtful_.end(), [](const Doubtful& a, const Doubtful& b) {
        return a.seen.lower < b.seen.lower;
    });
    for (const Doubtful& doubt : doubtful_) {
        PairClearance& known = entry(pairs, doubt.seen.pair, setup_);
        const double at_end = known.at_end, drift = known.drift;
        divide(doubt, known);
        known.at_end = at_end;
        known.drift = drift;
    }
    doubtful_.clear();
}

void LegCheck::check_fixture(const Leg& leg, double start, size_t fixture, const MovingBody& body,
                             std::vector<PairClearance>& pairs) {
    const Pair pair = pair_of(body, fixture);
    PairClearance& known = known_pair(pairs, pair);
    if (says_nothing(known, pairs)) return;
    const RelativeLeg relative =
        relative_leg(setup_.machine, setup_.fixtures[fixture].mount, body.mover, leg);
    if (stays_away(known, leg, relative)) return;
    if (!relative.turns) return check_passage(leg, start, fixture, body, relative, known);
    // A body that turns: half of the way at a time, until it is far or seen sharply enough.
    const double apart = distance(bounds(body, relative), bounds(setup_.fixtures[fixture].body));
    if (is_far(known, apart, setup_.search_limit)) return;
    if (!is_too_vague(relative)) {
        PairClearance now = look_at_fixture(leg, start, relative, body, known);
        if (now.lower >= std::min(known.upper, setup_.search_limit)
            || relative.error <= std::max(finest_error(body), sharp_share * now.lower))
            return merge(known, now);
        if (now.lower <= 0.0) {
            const Leg still = still_half_way(leg);
            const RelativeLeg here =
                relative_leg(setup_.machine, setup_.fixtures[fixture].mount, body.mover, still);
            now = look_at_fixture(still, start, here, body, known);
            if (now.verdict == Verdict::collision) return merge(known, now);
        }
    }
    check_fixture(stretch(leg, 0.0, 0.5), start, fixture, body, pairs);
    check_fixture(stretch(leg, 0.5, 1.0), start, fixture, body, pairs);
}

std::optional<Aabb> LegCheck::box_beside_stock(size_t fixture) const {
    const Fixture& body = setup_.fixtures[fixture];
    if (body.mount.link != setup_.stock_mount.link) return std::nullopt;
    const Transform stock_from = stock_from_fixture(setup_, body, {});
    const Aabb own = bounds(body.body);
    Aabb box;
    for (int corner = 0; corner < 8; ++corner)
        box.extend(stock_from
                   * Vec3(corner & 1 ? own.max.x : own.min.x, corner & 2 ? own.max.y : own.min.y,
                          corner & 4 ? own.max.z : own.min.z));
    return box;
}

void LegCheck::note_cut(const Leg& leg, size_t fixture) {
    if (!leg.straight || leg.places.size() < 2) return;
    const auto box = box_beside_stock(fixture);
    const RelativeLeg way = against_stock(bodies_[0], leg);
    if (!box || way.turns || !overlaps(bounds(bodies_[0], way), *box)) return;
    memory_.cuts[fixture].push_back({.cutter = cutter_for(way),
                                     .from = way.places.front(),
                                     .to = way.places.back(),
                                     .orientation = way.orientation,
                                     .block = value_of(block_)});
}

bool LegCheck::is_in_own_cut(const Leg& leg, size_t fixture) const {
    const auto cuts = memory_.cuts.find(fixture);
    if (cuts == memory_.cuts.end() || !leg.straight) return false;
    const RelativeLeg way = against_stock(bodies_[0], leg);
    if (way.turns || way.places.size() > 2) return false;
    const auto box = box_beside_stock(fixture);
    const Allowance contact = allowance_of(setup_, {PartKind::flutes});
    if (memory_.off_path > contact_depth(contact))
        return false; // corners may stand that were rounded
    return box
           && runs_in_own_cut(cuts->second, *box,
                              {.flutes = tool_.parts[0].profile,
                               .from = way.places.front(),
                               .to = way.places.back(),
                               .sideways = 0.5 * contact_depth(contact) - way.error,
                               .orientation = way.orientation});
}

bool LegCheck::may_meet(const Leg& leg, const MovingBody& body, size_t fixture,
                        std::vector<PairClearance>& pairs) {
    if (!fixtures_there_[fixture] || is_exempt(setup_.machine, body, setup_.fixtures[fixture]))
        return false;
    if (body.kind != PartKind::flutes || !setup_.fixtures[fixture].expendable) return true;
    if (use_ == FluteUse::cutting)
        note_cut(leg, fixture);
    else if (!is_in_own_cut(leg, fixture))
        return true;
    let_pass(pair_of(body, fixture), pairs);
    return false;
}

void LegCheck::check_fixtures(const Leg& leg, double start, std::vector<PairClearance>& pairs) {
    const std::optional<Pair> first = memory_.deciding;
    for (const bool likely : {true, false})
        for (size_t fixture = 0; fixture < setup_.fixtures.size(); ++fixture)
            for (const MovingBody& body : bodies_)
                if ((first == pair_of(body, fixture)) == likely
                    && may_meet(leg, body, fixture, pairs))
                    check_fixture(leg, start, fixture, body, pairs);
}

} // namespace core
