#include "core/sim/run/block_run.h"

#include <numbers>

#include <fmt/format.h>

#include "core/base/rule_table.h"

namespace core {
namespace {

/// Sets the time of the witness to the earliest of several moments at which the pair is equally
/// near. `nearest` is the distance on the programmed path.
void settle_time(BlockRun& run, PairClearance& pair, double nearest) {
    if (!pair.found() || (!pair.pair.fixture && run.result.removed > 0.0)) return;
    for (const TimedLeg& timed : run.legs) {
        const double begin = timed.start + timed.leg.begin, end = timed.start + timed.leg.end;
        if (pair.time <= begin || pair.time > end) continue;
        LegCheck check = run.leg_check(FluteUse::not_cutting);
        const double seen = end > begin ? (pair.time - begin) / (end - begin) : 0.0;
        const double fraction =
            check.earliest(timed.leg, pair.pair, nearest, run.state.stock, seen);
        pair.time = std::min(pair.time, begin + fraction * (end - begin));
        return;
    }
}

} // namespace

void BlockRun::forget_bounds() {
    state.memory.bounds.clear();
    for (TrackedPair& pair : pairs) pair.at_end = -infinity;
}

void BlockRun::execute_motion(const ToolChange& change) {
    // The earliest time can only be found with the tool that made the motion, so find it before the
    // change.
    if (const TrackedPair* worst = deciding_pair(pairs))
        settle_time(*this, pairs[static_cast<size_t>(worst - pairs.data())], worst->upper);
    legs.clear();
    if (tool()) tell(end_air(state.rules.air, tool()->description.diameter));
    state.rules.air = {};
    state.rules.has_fed = state.rules.singular_reported = false;
    forget_bounds();
    state.tool = change.tool;
    state.tool_known = true;
    state.reported_unchecked_tool = false;
    result.tool = change.tool;
    if (tool()) return check_tool_change();
    if (change.tool)
        find(rule_id("tool-not-in-table"),
             fmt::format("Tool {} is called, but the set-up does not describe it.",
                         value_of(*change.tool)),
             fmt::format("Add [[tool]] number = {} to the set-up.", value_of(*change.tool)));
}

void BlockRun::execute_motion(const PathModeChange& change) {
    if (change_mode(state.corners, change, setup.machine))
        state.assumptions.insert("the control does not round corners where neither G64 nor "
                                 "`corner_tolerance` of the machine gives a tolerance");
}

void BlockRun::execute_motion(const FixtureChange& change) {
    forget_bounds();
    state.mounted_fixtures[change.fixture] = change.is_there;
    state.memory.cuts.erase(change.fixture); // another fixture may be there now
    const Path path = path_of({.from = state.position, .to = state.position}, setup.machine, 0.0);
    if (block.judgement || !change.is_there || path.legs.empty() || !path.legs[0].start_known)
        return;
    leg_check(FluteUse::not_cutting)
        .rest(path.legs[0].positions[0], result.duration, state.stock, pairs);
}

void BlockRun::check_tool_change() {
    if (block.judgement) return;
    const Motion stay{.from = state.position, .to = state.position};
    const Path path = path_of(stay, setup.machine, 0.0);
    if (path.legs.empty() || !path.legs[0].start_known) return;
    std::vector<TrackedPair> there;
    leg_check(FluteUse::not_cutting)
        .rest(path.legs[0].positions[0], result.duration, state.stock, there);
    const TrackedPair* nearest = deciding_pair(there);
    if (!nearest || nearest->verdict == Verdict::clear) return;
    at_change = nearest->verdict;
    add(unsafe_change(setup, *nearest, *state.tool));
}

bool turns_to_cut(const SpindleChange& spindle, const ToolAssembly& tool) {
    return spindle.direction == tool.description.cuts && spindle.speed > 0.0;
}

bool cuts_along(const ToolAssembly& tool, const Motion& motion) {
    if (!only_drills(tool.description.shape) || motion.tip) return true;
    const auto way = [&](size_t i) {
        return motion.from[i] && motion.to[i] ? std::abs(*motion.to[i] - *motion.from[i]) : 0.0;
    };
    if (way(3) + way(4) + way(5) > 0.0) return true;
    // A drill may follow a hole that is slightly inclined.
    constexpr double slack = 0.1, slope = 0.05;
    return !motion.arc && std::hypot(way(0), way(1)) <= slack + slope * way(2);
}

void BlockRun::note_worst(MotionKind kind) {
    for (const PairClearance& pair : pairs) {
        if (pair.verdict == Verdict::clear) continue;
        const auto known =
            std::find_if(worst_motions.begin(), worst_motions.end(),
                         [&](const WorstMotion& one) { return one.pair == pair.pair; });
        if (known == worst_motions.end())
            worst_motions.push_back({pair.pair, pair.verdict, pair.upper, kind});
        else if (pair.verdict > known->verdict || pair.upper < known->upper)
            *known = {pair.pair, pair.verdict, pair.upper, kind};
    }
}

BlockMove BlockRun::move_of(const PairClearance& pair) const {
    BlockMove move{result.motion, turns, result.duration, only_dog_leg};
    if (move.motion != BlockMotion::cycle) return move;
    move.within = block.goes_home  ? MoveWithin::way_home
                  : block.is_cycle ? MoveWithin::cycle
                                   : MoveWithin::block;
    for (const WorstMotion& one : worst_motions)
        if (one.pair == pair.pair && one.kind == MotionKind::rapid)
            move.motion = BlockMotion::rapid;
    return move;
}

Finding BlockRun::finding_about(const PairClearance& pair) const {
    Finding finding = finding_of(setup, pair, move_of(pair), state);
    if (pair.pair != Pair{PartKind::flutes} || pair.verdict != Verdict::collision) return finding;
    if (drills_sideways) {
        finding.rule = rule_id("collision");
        finding.message = fmt::format("Tool {} is a drill and is fed sideways into the stock.",
                                      value_of(tool()->description.number));
        finding.cure = "Drill along the tool axis, or mill with a tool that cuts on its sides.";
    }
    if (!pushes_centre) return finding;
    const ToolDescription& described = tool()->description;
    finding.message = fmt::format(
        "Tool {} does not cut within {:g} mm of its axis, and its centre is pushed into the stock.",
        value_of(described.number), described.centre_radius);
    finding.cure = fmt::format(
        "Ramp or helix in at {:.1f} degrees or less, with a radius of more than {:g} mm; "
        "pre-drill; or use a centre-cutting tool.",
        std::atan(centre_recess(described) / (2.0 * described.centre_radius)) * 180.0
            / std::numbers::pi,
        described.centre_radius);
    return finding;
}

void BlockRun::conclude() {
    std::sort(pairs.begin(), pairs.end(), [](const TrackedPair& a, const TrackedPair& b) {
        return std::tuple(a.pair.fixture, a.pair.part, a.pair.carried)
               < std::tuple(b.pair.fixture, b.pair.part, b.pair.carried);
    });
    const bool rise = std::all_of(legs.begin(), legs.end(),
                                  [](const TimedLeg& timed) { return rises(timed.leg); });
    const bool follows =
        follows_cuts(state.corners, state.tool, rise, result.motion == BlockMotion::rapid);
    std::vector<double> on_the_way; // distance of each pair on the programmed path
    for (TrackedPair& pair : pairs) {
        on_the_way.push_back(pair.upper);
        widen(pair, off_path, state.corners, follows);
    }
    if (const TrackedPair* worst = deciding_pair(pairs)) {
        result.deciding = static_cast<size_t>(worst - pairs.data());
        result.verdict = worst->verdict;
    }
    for (size_t i = 0; i < pairs.size(); ++i)
        if (pairs[i].verdict != Verdict::clear || result.deciding == i)
            settle_time(*this, pairs[i], on_the_way[i]);
    result.verdict = std::max(result.verdict, at_change);
    if (setup.detail == Detail::verdict && result.deciding
        && pairs[*result.deciding].verdict == Verdict::clear) {
        // Only bounds of the other pairs are known, so the deciding pair may be unknown.
        double least = infinity;
        for (const PairClearance& pair : pairs)
            least = std::min(least, pair.lower - pair.allowance.distance);
        if (least < pairs[*result.deciding].margin()) result.deciding.reset();
    }
    if (result.motion != BlockMotion::none) {
        CheckMemory& memory = state.memory;
        memory.bounds.clear();
        for (const TrackedPair& pair : pairs)
            memory.bounds.push_back({pair.pair, pair.at_end, pair.drift});
        memory.deciding.reset();
        if (result.deciding) {
            memory.deciding = pairs[*result.deciding].pair;
            memory.margin = pairs[*result.deciding].margin();
        }
    }
    for (const PairClearance& pair : pairs)
        if (pair.verdict != Verdict::clear) add(finding_about(pair));
    if (result.checked) return;
    result.verdict = std::max(result.verdict, Verdict::undecided);
    result.deciding.reset();
}

void BlockRun::conclude(const Judgement& judgement) {
    // A rule that follows the cut may have found a pair in collision.
    for (const PairClearance& pair : judgement.pairs) merge(entry(pairs, pair.pair, setup), pair);
    const auto is_worse = [](const PairClearance& a, const PairClearance& b) {
        return a.verdict != b.verdict ? a.verdict > b.verdict : a.margin() < b.margin();
    };
    const auto worst = std::min_element(pairs.begin(), pairs.end(), is_worse);
    if (worst != pairs.end() && worst->lower < setup.search_limit)
        result.deciding = static_cast<size_t>(worst - pairs.begin());
    result.verdict = judgement.verdict;
    for (const PairClearance& pair : pairs) result.verdict = std::max(result.verdict, pair.verdict);
    tell(judgement.finding);
    if (pushes_centre) add(finding_about(entry(pairs, {PartKind::flutes}, setup)));
    result.checked = result.checked && (judgement.checked || pushes_centre);
    if (result.checked) return;
    result.verdict = std::max(result.verdict, Verdict::undecided);
    result.deciding.reset();
}

} // namespace core
