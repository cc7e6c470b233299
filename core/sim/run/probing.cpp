#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/sim/run/block_run.h"

// A probing move ends where its tip makes contact, so the machine may be anywhere between its start
// and the point at which the model has certain contact. Later moves start from this whole range,
// except along axes that they position.

namespace core {
namespace {

/// The values that an axis may have.
struct Range {
    double low, high;
};

Range around(double position, const AxisSpread& spread, size_t axis) {
    return {position - spread.below[axis], position + spread.above[axis]};
}

/// The positions of each axis on the way of a probing move to `motion.to`.
std::array<Range, axis_count> ranges_of(const Motion& motion, const AxisSpread& before) {
    const AxisSpread after = spread_after(motion, before);
    std::array<Range, axis_count> ranges;
    for (size_t i = 0; i < axis_count; ++i) {
        const Range first = around(motion.from[i].value_or(0.0), before, i);
        const Range last = around(motion.to[i].value_or(0.0), after, i);
        ranges[i] = {std::min(first.low, last.low), std::max(first.high, last.high)};
    }
    return ranges;
}

bool is_known(const Motion& motion, const Machine& machine) {
    for (size_t i = 0; i < axis_count; ++i)
        if (machine.axes[i].present && !(motion.from[i] && motion.to[i])) return false;
    return true;
}

/// Whether all positions of a probing move are on one line, in the direction of the move.
bool is_on_a_line(const Motion& motion, const AxisSpread& before) {
    if (before.none()) return true;
    size_t uncertain_axes = 0;
    for (size_t i = 0; i < axis_count; ++i) {
        const bool is_uncertain = before.below[i] != 0.0 || before.above[i] != 0.0;
        if ((motion.from[i] != motion.to[i]) != is_uncertain) return false;
        uncertain_axes += is_uncertain;
    }
    return uncertain_axes == 1;
}

/// The whole line of such a move, from the first to the last possible position.
Leg line_of(const Motion& motion, const std::array<Range, axis_count>& ranges) {
    Leg leg{.positions = std::vector<AxisValues>(2)};
    for (size_t i = 0; i < axis_count; ++i) {
        const double from = motion.from[i].value_or(0.0), to = motion.to[i].value_or(0.0);
        leg.positions[0][i] = to > from ? ranges[i].low : to < from ? ranges[i].high : from;
        leg.positions[1][i] = to > from ? ranges[i].high : to < from ? ranges[i].low : to;
    }
    return leg;
}

double length_of(const Leg& leg) {
    double squared = 0.0;
    for (size_t i = 0; i < axis_count; ++i)
        squared += core::pow(leg.positions[1][i] - leg.positions[0][i], 2);
    return std::sqrt(squared);
}

/// The greatest fraction of a leg, within 0.001 mm, up to which a property holds that once lost
/// does not come back.
template <typename Property>
double last_fraction(const Leg& leg, Property holds) {
    if (holds(leg)) return 1.0;
    double first = 0.0, last = 1.0;
    for (const double length = length_of(leg); (last - first) * length > 0.001;) {
        const double middle = 0.5 * (first + last);
        (holds(stretch(leg, 0.0, middle)) ? first : last) = middle;
    }
    return first;
}

} // namespace

Path BlockRun::take_path(const Motion& motion) {
    const double error = chord_error(setup.mesh_size);
    for (size_t i = 0; i < axis_count; ++i)
        if (!motion.from[i]) state.spread.below[i] = state.spread.above[i] = 0.0;
    const AxisSpread before = state.spread;
    if (before.none() && !motion.stops_at_contact) {
        const bool turns =
            !std::equal(motion.from.begin() + 3, motion.from.begin() + 6, motion.to.begin() + 3);
        const bool is_blended = motion.kind != MotionKind::rapid && state.corners.arcs.rounds();
        if (!turns || !is_blended || motion.tip) return path_of(motion, setup.machine, error);
        Motion blended = motion;
        blended.turn_error += smooth_turn;
        return path_of(blended, setup.machine, error);
    }
    is_uncertain = true;
    state.spread = spread_after(motion, before);
    Path path = path_of(motion, before, state.spread, setup.machine, error);
    if (!motion.stops_at_contact) return path;
    const auto ranges = ranges_of(motion, before);
    if (is_on_a_line(motion, before) && is_known(motion, setup.machine) && !path.legs.empty()) {
        path.legs = {line_of(motion, ranges)};
        path.legs[0].end = path.duration;
        if (use(motion) == FluteUse::cutting) { // as far as it goes
            path.legs[0].certain = {path.legs[0].positions[0]};
            path.legs[0].straight = false;
        }
    }
    for (size_t i = 0; i < axis_count; ++i) {
        if (!motion.from[i] || !motion.to[i]) continue;
        state.spread.below[i] = *motion.to[i] - ranges[i].low;
        state.spread.above[i] = ranges[i].high - *motion.to[i];
    }
    return path;
}

/// The flutes may be in contact only where the move begins.
void BlockRun::check_leaving(const Path& path, const AxisSpread& before, TrackedPairs& found) {
    constexpr double deflection = 1.0; // mm: of a probe in contact
    LegCheck check = leg_check(FluteUse::not_cutting);
    for (const Leg& whole : path.legs) {
        if (!whole.straight) { // undecided if they may be in contact anywhere
            check.run(whole, result.duration, state.stock, found);
            continue;
        }
        double start = deflection;
        for (size_t i = 0; i < axis_count; ++i) start += before.below[i] + before.above[i];
        const double contact = std::min(1.0, start / std::max(length_of(whole), 0.001));
        TrackedPairs first;
        check.run(stretch(whole, 0.0, contact), result.duration, state.stock, first);
        first.remove_if([](const TrackedPair& pair) { return pair.pair.part == PartKind::flutes; });
        for (const TrackedPair& pair : first) merge(entry(found, pair.pair, setup), pair);
        if (contact < 1.0)
            check.run(stretch(whole, contact, 1.0), result.duration, state.stock, found);
    }
}

void BlockRun::check_probing(const Motion& motion, const Path& path, const AxisSpread& before) {
    TrackedPairs here;
    if (motion.leaves_contact) {
        leaves_contact = true;
        check_leaving(path, before, here);
    } else if (!path.legs[0].straight) {
        LegCheck check = leg_check(FluteUse::not_cutting);
        for (const Leg& leg : path.legs) check.run(leg, result.duration, state.stock, here);
    } else {
        const Leg& whole = path.legs[0];
        CheckMemory memory;
        LegCheck check = leg_check(FluteUse::not_cutting, memory);
        const CutModel& certain = state.certain_stock ? *state.certain_stock : state.stock;
        const double apart = last_fraction(whole, [&](const Leg& leg) {
            return !check.contact_of_flutes(leg, state.stock).may_touch;
        });
        const double stop = last_fraction(
            whole, [&](const Leg& leg) { return !check.contact_of_flutes(leg, certain).collides; });
        // The flutes may be deeper than they certainly touch before the model can tell.
        const double touching =
            std::min(stop, last_fraction(whole, [&](const Leg& leg) {
                         return check.contact_of_flutes(leg, state.stock).is_clear;
                     }));
        check.pass(stretch(whole, 0.0, apart), result.duration, state.stock, here);
        Leg rest =
            stretch(whole, apart, std::min(1.0, stop + 0.001 / std::max(length_of(whole), 0.001)));
        rest.straight = false;
        rest.certain = {rest.positions[0]};
        check.run(rest, result.duration, state.stock, here);
        const Leg taken = stretch(whole, 0.0, touching);
        for (size_t i = 0; i < axis_count; ++i) {
            if (!motion.to[i] || motion.from[i] == motion.to[i]) continue;
            const auto [low, high] = std::minmax(taken.positions[0][i], taken.positions[1][i]);
            state.spread.below[i] = *motion.to[i] - low;
            state.spread.above[i] = high - *motion.to[i];
        }
    }
    // The flutes are to make contact.
    if (!motion.leaves_contact)
        here.remove_if([](const TrackedPair& pair) { return pair.pair.part == PartKind::flutes; });
    for (TrackedPair& pair : here) {
        if (state.certain_stock && !pair.pair.fixture && pair.verdict > Verdict::undecided) {
            pair.verdict = Verdict::undecided;
            pair.unless_removed = true;
        }
        merge(entry(pairs, pair.pair, setup), pair);
    }
    state.rules.has_fed = true;
    note_worst(motion.kind);
}

void BlockRun::check_rest(const Path& path) {
    const TrackedPairs before = pairs;
    note_axis_tolerances(path);
    state.memory.off_path = off_path + off_by_axes + state.corners.of_stock();
    LegCheck check = leg_check(FluteUse::not_cutting);
    Leg here = path.legs[0];
    if (here.straight) {
        here.positions.resize(1);
        check.rest(here.positions[0], result.duration, state.stock, pairs);
    } else {
        check.run(here, result.duration, state.stock, pairs);
    }
    if (state.certain_stock) doubt_clearances(check, here, before);
}

} // namespace core
