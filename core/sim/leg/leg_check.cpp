#include "core/sim/leg/leg_check.h"

#include <algorithm>

#include "core/motion/path.h"
#include "core/sim/setup.h"

namespace core {

LegCheck::LegCheck(const Setup& setup, const ToolAssembly& tool, FluteUse use, BlockIndex block,
                   const std::vector<bool>& mounted_fixtures, CheckMemory& memory,
                   Statistics& statistics, CutReplay* replay, unsigned threads)
    : context_{setup,
               tool,
               use,
               block,
               mounted_fixtures,
               memory,
               statistics,
               moving_bodies(setup, tool),
               replay,
               threads},
      bounds_(setup, memory),
      flutes_(context_),
      probe_(context_, bounds_),
      fixtures_(context_, bounds_, flutes_),
      stock_(context_, bounds_, probe_, flutes_) {}

double LegCheck::run(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs) {
    bounds_.begin_leg(greatest_travel(context_.setup.machine, leg), leg.straight);
    const size_t tests_before = context_.statistics.box_tests;
    double removed = 0.0;
    if (!leg.straight) {
        check_hull(leg, start, stock, pairs);
    } else if (context_.memory.deciding && !context_.memory.deciding->fixture) {
        removed = stock_.check(leg, start, stock, pairs);
        fixtures_.check(leg, start, pairs);
    } else {
        fixtures_.check(leg, start, pairs);
        removed = stock_.check(leg, start, stock, pairs);
    }
    note_search(stock, context_.statistics.box_tests - tests_before);
    bounds_.end_leg([&](const Pair& pair) { return travel_of(pair, leg); });
    return removed;
}

double LegCheck::travel_of(const Pair& pair, const Leg& leg) const {
    if (!leg.straight) return infinity;
    for (const MovingBody& body : context_.bodies)
        if (body.kind == pair.part && body.carried == pair.carried)
            return pair.fixture ? context_.travel_against_fixture(body, *pair.fixture, leg)
                                : context_.against_stock(body, leg).travel;
    return infinity;
}

void LegCheck::check_hull(const Leg& leg, double start, const CutModel& stock,
                          TrackedPairs& pairs) {
    // Anything that the hull does not meet is safe. Anything that it meets need not happen, unless
    // a position that is certainly taken meets it too.
    TrackedPairs anywhere;
    fixtures_.check(leg, start, anywhere);
    stock_.check_bodies(leg, start, stock, anywhere);
    TrackedPairs certain;
    for (const AxisValues& position : leg.certain) rest(position, 0.0, stock, certain);
    for (const TrackedPair& pair : anywhere) {
        const bool safe = pair.verdict == Verdict::clear;
        PairClearance now{.pair = pair.pair, .allowance = pair.allowance, .lower = pair.lower};
        if (const TrackedPair* there = certain.find(pair.pair)) merge(now, *there);
        now.lower = pair.lower;
        now.time = start + leg.end;
        if (!safe) now.verdict = std::max(now.verdict, Verdict::undecided);
        merge(entry(pairs, pair.pair, context_.setup), now);
    }
}

void LegCheck::pass(const Leg& leg, double start, const CutModel& stock, TrackedPairs& pairs) {
    fixtures_.check(leg, start, pairs);
    stock_.check_bodies(leg, start, stock, pairs);
}

FluteContact LegCheck::contact_of_flutes(const Leg& leg, const CutModel& stock) {
    TrackedPairs pairs;
    pass(leg, 0.0, stock, pairs);
    FluteContact contact;
    for (const TrackedPair& pair : pairs) {
        if (pair.pair.part != PartKind::flutes) continue;
        contact.may_touch = contact.may_touch || pair.lower <= 0.0;
        contact.collides = contact.collides || pair.verdict == Verdict::collision;
        // A fixture that is probed is nearer than its allowance.
        contact.is_clear = contact.is_clear
                           && (pair.verdict == Verdict::clear
                               || (pair.pair.fixture && pair.verdict == Verdict::violation));
    }
    return contact;
}

bool LegCheck::keeps_clear(PartKind kind, const Leg& leg, const CutModel& stock) {
    return std::all_of(context_.bodies.begin(), context_.bodies.end(), [&](const MovingBody& body) {
        return body.kind != kind || probe_.is_clear(body, leg, stock);
    });
}

double LegCheck::reach_into_raw_stock(const Pair& pair, const Leg& leg,
                                      const CutModel& stock) const {
    const MovingBody& body = context_.body_of(pair);
    const RelativeLeg way = context_.against_stock(body, leg);
    const Aabb own = bounds(body, way), &raw = stock.outer_box;
    double least = infinity;
    for (int axis = 0; axis < 3; ++axis)
        least = std::min({least, own.max[axis] - raw.min[axis], raw.max[axis] - own.min[axis]});
    return least + way.error;
}

bool LegCheck::follows_flutes(const Pair& pair, const Leg& leg, const CutModel& stock,
                              const OwnMoves& own, double apart, int depth) const {
    constexpr int deepest = 6;
    const MovingBody& body = context_.body_of(pair);
    if (core::follows_flutes(context_.setup, context_.tool, body, leg, stock, own)) return true;
    if (!body.profile || !leg.straight) return false;
    if (context_.stays_apart(*body.profile, context_.against_stock(body, leg), stock, apart))
        return true;
    if (depth == deepest) return false;
    const std::array<Leg, 2> parts = halves(leg);
    return follows_flutes(pair, parts[0], stock, own, apart, depth + 1)
           && follows_flutes(pair, parts[1], stock, own, apart, depth + 1);
}

void LegCheck::rest(const AxisValues& position, double time, const CutModel& stock,
                    TrackedPairs& pairs) {
    const Leg leg{.positions = {position}};
    // The body may have come from anywhere.
    for (TrackedPair& pair : pairs) pair.at_end = -infinity;
    fixtures_.check(leg, time, pairs);
    stock_.check_bodies(leg, time, stock, pairs);
}

} // namespace core
