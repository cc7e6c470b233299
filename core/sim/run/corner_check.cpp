#include <utility>

#include <fmt/format.h>

#include "core/motion/corner.h"
#include "core/sim/run/block_run.h"
#include "core/sim/run/corner_plan.h"

namespace core {
namespace {

/// The check of the region of a corner: its hull, and the programmed path within it.
struct CornerCheck {
    TrackedPairs anywhere, along;
    double deviation; // of the bodies from the programmed path
    double of_cuts;   // deviation of the cuts in the stock

    const TrackedPair* on_the_path(const Pair& pair) const {
        const auto found = std::find_if(along.begin(), along.end(),
                                        [&](const TrackedPair& one) { return one.pair == pair; });
        return found == along.end() ? nullptr : &*found;
    }

    /// The clearance of a pair on the rounded path, of which only bounds are known. Empty if the
    /// pair needs no clearance. `knows_path`: `along` is the programmed path.
    std::optional<PairClearance> clearance(const PairClearance& in_hull, bool knows_path) const {
        PairClearance now{.pair = in_hull.pair, .allowance = in_hull.allowance};
        now.lower = in_hull.lower;
        if (in_hull.verdict == Verdict::clear) return now;
        if (!knows_path) {
            now.verdict = judge_distance(now.allowance, now.lower, infinity);
            return now;
        }
        const TrackedPair* on_path = on_the_path(in_hull.pair);
        if (!on_path) return std::nullopt;
        now.lower = std::max(now.lower, on_path->lower - deviation);
        now.verdict = judge_distance(now.allowance, now.lower, infinity);
        const double off = deviation + (now.pair.fixture ? 0.0 : of_cuts);
        if (now.allowance.distance <= resolution && off <= contact_depth(now.allowance))
            now.verdict = on_path->verdict;
        return now;
    }
};

} // namespace

void BlockRun::note_axis_tolerances(const Path& path) {
    const double off = axis_tolerance_error(setup, tool(), path);
    off_by_axes = std::max(off_by_axes, off);
    if (off == 0.0) return;
    state.assumptions.insert("the axes of rotation are where the set-up states them to within its "
                             "tolerances; clearances include these");
}

bool BlockRun::flutes_may_cut(const Motion& motion) const {
    if (motion.kind != MotionKind::rapid) return use(motion) == FluteUse::cutting;
    return tool() && turns_to_cut(state.spindle, *tool());
}

void BlockRun::round_corners(const Motion& motion, const Path& path) {
    RoundedCorners& corners = state.corners;
    const bool rapid = motion.kind == MotionKind::rapid;
    const std::optional<MotionKind>& last = corners.last.kind;
    const bool is_corner = last && (*last == MotionKind::rapid) == rapid;
    if (is_corner && (rapid ? corners.unknown_rapids : corners.unknown))
        state.assumptions.insert("the control does not round corners where neither the program nor "
                                 "`corner_tolerance` of the machine gives a tolerance");
    if (rapid) {
        off_path_rapids =
            std::max({off_path_rapids, deviation_of(corners.rapids, path.legs),
                      corners.mixed.deviation, deviation_of(corners.last.rapids, path.legs)});
        return;
    }
    const double by = corners.of_feed(motion.arc.has_value());
    if (!tool()) return;
    const bool cuts = use(motion) == FluteUse::cutting;
    if (cuts) {
        corners.by_axes_of_cuts = std::max(corners.by_axes_of_cuts, off_by_axes);
        corners.note_cut(state.tool, motion.arc.has_value(), state.stock.log.size());
    }
    if (by == 0.0) return;
    off_path = std::max(off_path, by);
    if (cuts && corners.arcs.rounds() && !motion.tip && moves_other_axes(path.legs))
        corners.of_cuts =
            std::max(corners.of_cuts, by + off_by_turn(setup, tool(), path.legs, smooth_turn));
    const double own = motion.arc ? corners.by_arc : corners.by;
    if (own > 0.0)
        state.assumptions.insert(fmt::format(
            "{} may deviate by up to {:.4g} mm from the programmed path while the control rounds "
            "corners; clearances include this",
            motion.arc && corners.by_arc != corners.by ? "arcs" : "feeds", own));
}

void BlockRun::check_corner(const Motion& motion, const Path& path) {
    RoundedCorners& corners = state.corners;
    const CornerStart& last = corners.last;
    const bool rounds = last.by > 0.0 || last.rapids.rounds() || last.mixed.rounds()
                        || last.arcs.rounds() || last.turns.rounds();
    if (!rounds && corners.left_after == 0.0) return;
    const CornerPlan plan = plan_corner({.setup = setup,
                                         .tool = tool(),
                                         .motion = motion,
                                         .path = path,
                                         .cuts = use(motion) == FluteUse::cutting,
                                         .may_cut = flutes_may_cut(motion),
                                         .off_path = off_path,
                                         .stock = state.stock.outer_box},
                                        corners);
    state.assumptions.insert(plan.assumptions.begin(), plan.assumptions.end());
    // What is judged by others includes the corner.
    if (!block.judgement && plan.kind == CornerPlan::Kind::region)
        check_region(plan.anywhere, plan.along, plan.deviation, plan.may_cut);
    if (!block.judgement && plan.kind == CornerPlan::Kind::beside_rest)
        check_beside_rest(plan.anywhere, plan.may_cut);
    corners.note_corner_of_cuts(plan.of_cuts);
}

void BlockRun::check_beside_rest(const std::vector<Leg>& legs, bool may_cut) {
    constexpr size_t most_parts = 200, most_parts_for_precision = 40;
    constexpr double precise = 5.0; // size of a part
    const std::vector<Leg>& rest = state.corners.last.rest;
    const AxisValues corner = rest.back().positions.back();
    std::vector<RestPart> parts;
    for (const Leg& leg : rest) parts.push_back({.rest = &leg});
    // Where the rest ends, the bodies are as programmed: nearer than there they are only reported
    // if fine parts show it.
    if (std::any_of(parts.begin(), parts.end(),
                    [](const RestPart& part) { return part.size() > precise; }))
        check_region(RestPart{&rest.back(), 1.0, 1.0}.beside(legs, corner), {}, 0.0, may_cut);
    for (size_t i = 0; i < parts.size(); ++i) {
        const RestPart part = parts[i];
        const double size = part.size();
        const bool may_split = parts.size() < most_parts && size > 1.0;
        const RegionUse use = !may_split ? RegionUse::always
                              : parts.size() < most_parts_for_precision && size > precise
                                  ? RegionUse::if_precise
                                  : RegionUse::if_clear;
        if (check_region(part.beside(legs, corner), {}, 0.0, may_cut, use)) continue;
        for (const RestPart& half : part.halves()) parts.push_back(half);
    }
}

bool BlockRun::check_region(const std::vector<Leg>& anywhere, const std::vector<Leg>& along,
                            double deviation, bool may_cut, RegionUse when) {
    note_axis_tolerances({.legs = anywhere});
    CheckMemory memory; // the bounds of the run only hold along its own path
    memory.hints = state.memory.hints;
    memory.off_path = deviation + off_by_axes + state.corners.of_stock();
    std::swap(memory.cuts, state.memory.cuts);
    std::swap(memory.passages, state.memory.passages);
    CornerCheck corner{.deviation = deviation + off_by_axes, .of_cuts = state.corners.of_stock()};
    // At the corner of a cut, the flutes may already, or still, cut.
    const FluteUse use = may_cut ? FluteUse::ignored : FluteUse::measured;
    for (const Leg& leg : anywhere)
        leg_check(use, memory).run(leg, result.duration, state.stock, corner.anywhere);
    const bool is_clear =
        std::all_of(corner.anywhere.begin(), corner.anywhere.end(),
                    [&](const TrackedPair& pair) { return pair.verdict == Verdict::clear; });
    for (const Leg& leg : along)
        if (!is_clear) leg_check(use, memory).run(leg, result.duration, state.stock, corner.along);
    std::swap(memory.cuts, state.memory.cuts);
    std::swap(memory.passages, state.memory.passages);
    if (when != RegionUse::always && !is_clear) return false;
    if (when == RegionUse::if_precise
        && !std::all_of(corner.anywhere.begin(), corner.anywhere.end(),
                        [&](const TrackedPair& pair) {
                            constexpr double slack = 0.05; // mm
                            const TrackedPair* known = pairs.find(pair.pair);
                            return known && pair.lower >= known->lower - slack;
                        }))
        return false;
    for (const TrackedPair& pair : corner.anywhere) {
        auto now = corner.clearance(pair, !along.empty());
        if (!now) continue;
        now->time = result.duration;
        merge(static_cast<PairClearance&>(
                  PairBounds(setup, state.memory).tracked_pair(pairs, now->pair)),
              *now);
    }
    return true;
}

} // namespace core
