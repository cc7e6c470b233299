#include "core/sim/run/block_run.h"

#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
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
        const double fraction = check.earliest(timed.leg, pair, nearest, run.state.stock, seen);
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
    state.corners.last = {};
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
             fmt::format("Add [[tool]] number = {} to the set-up. Sizes that it does not state are "
                         "assumed.",
                         value_of(*change.tool)));
}

void BlockRun::execute_motion(const PathModeChange& change) {
    change_mode(state.corners, change, setup.machine);
}

void BlockRun::execute_motion(const FixtureChange& change) {
    forget_bounds();
    state.mounted_fixtures[change.fixture] = change.is_there;
    state.memory.cuts.erase(change.fixture); // another fixture may be there now
    const Path path = path_of({.from = state.position, .to = state.position}, state.spread,
                              state.spread, setup.machine, 0.0);
    if (block.judgement || !change.is_there || spindle_is_lost() || path.legs.empty()
        || !path.legs[0].start_known)
        return;
    check_rest(path);
}

void BlockRun::check_tool_change() {
    if (block.judgement) return;
    const Motion stay{.from = state.position, .to = state.position};
    const Path path = path_of(stay, state.spread, state.spread, setup.machine, 0.0);
    if (path.legs.empty() || !path.legs[0].start_known) return;
    TrackedPairs of_last_tool = std::exchange(pairs, {});
    check_rest(path);
    TrackedPairs there = std::exchange(pairs, std::move(of_last_tool));
    // The tool rests where it has come.
    for (TrackedPair& pair : there)
        if (widen(pair, {.by_axes = off_by_axes}, state.corners)
            == ContactDoubt::unless_at_raw_stock)
            pair.verdict = std::max(pair.verdict, Verdict::undecided);
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
    return !motion.arc && core::hypot(way(0), way(1)) <= slack + slope * way(2);
}

bool leaves_its_cut_upwards(const ToolAssembly& tool) {
    constexpr double most_undercut = 0.25; // mm
    const auto shape =
        std::find_if(tool_shapes().begin(), tool_shapes().end(), [&](const ToolShapeEntry& one) {
            return one.shape == tool.description.shape;
        });
    if (shape != tool_shapes().end() && shape->only_drills) return true;
    std::vector<ProfileElement> elements;
    for (const ToolPart& part : tool.parts)
        if (is_below_holder(part.kind))
            elements.insert(elements.end(), part.profile.elements.begin(),
                            part.profile.elements.end());
    std::sort(elements.begin(), elements.end(),
              [](const auto& a, const auto& b) { return a.z1 + a.margin < b.z1 + b.margin; });
    double widest = 0.0;
    for (const ProfileElement& element : elements) {
        widest = std::max({widest, element.r0 + element.margin, element.r1 + element.margin});
        if (element.r1 + element.margin < widest - most_undercut) return false;
    }
    return true;
}

/// Notes which pairs the motion that ended just now made worse. Returns their indices in
/// `worst_motions`.
std::vector<size_t> BlockRun::note_worst(MotionKind kind) {
    std::vector<size_t> worsened;
    for (const PairClearance& pair : pairs) {
        if (pair.verdict == Verdict::clear) continue;
        const auto known =
            std::find_if(worst_motions.begin(), worst_motions.end(),
                         [&](const WorstMotion& one) { return one.pair == pair.pair; });
        const bool is_new = known == worst_motions.end();
        if (!is_new && pair.verdict <= known->verdict && pair.upper >= known->upper) continue;
        worsened.push_back(static_cast<size_t>(known - worst_motions.begin()));
        const WorstMotion worst{pair.pair, pair.verdict, pair.upper, kind};
        if (is_new)
            worst_motions.push_back(worst);
        else
            *known = worst;
    }
    return worsened;
}

namespace {

/// Whether a cycle moves sideways at rapid below the height at which it begins to feed, as those of
/// boring do to lift the cutting edge off the wall.
bool shifts_in_the_hole(std::span<const Event> events) {
    double top = -infinity; // of the feeds
    for (const Event& event : events)
        if (const auto* motion = std::get_if<Motion>(&event);
            motion && motion->kind != MotionKind::rapid)
            for (const auto& end : {motion->from[2], motion->to[2]})
                top = std::max(top, end.value_or(-infinity));
    return std::any_of(events.begin(), events.end(), [&](const Event& event) {
        const auto* motion = std::get_if<Motion>(&event);
        if (!motion || motion->kind != MotionKind::rapid) return false;
        const bool goes_across =
            motion->from[0] != motion->to[0] || motion->from[1] != motion->to[1];
        return goes_across && motion->from[2].value_or(infinity) < top - resolution;
    });
}

} // namespace

BlockMove BlockRun::move_of(const PairClearance& pair) const {
    BlockMove move{result.motion, turns, result.duration};
    move.leaves_contact = leaves_contact;
    for (const WorstMotion& one : worst_motions)
        if (one.pair == pair.pair) move.only_dog_leg = one.only_dog_leg;
    if (move.motion != BlockMotion::cycle) return move;
    move.within = block.goes_home  ? MoveWithin::way_home
                  : block.is_cycle ? MoveWithin::cycle
                                   : MoveWithin::block;
    move.shifts = move.within == MoveWithin::cycle && shifts_in_the_hole(block.events);
    for (const WorstMotion& one : worst_motions)
        if (one.pair == pair.pair && one.kind == MotionKind::rapid)
            move.motion = BlockMotion::rapid;
    return move;
}

std::vector<ShiftStart> BlockRun::shifts_to_try(const PairClearance& pair, const PairStudy& study,
                                                bool rapid_in_stock) const {
    std::vector<ShiftStart> starts;
    const Vec3 away =
        study.overlap && study.overlap->most ? study.overlap->way_out : pair.on_tool - pair.on_body;
    const double length = glm::length(away);
    const double missing =
        pair.allowance.distance + (study.overlap ? study.overlap->most.value_or(0.0) : -pair.upper);
    const auto add = [&](size_t axis, double sign, double first) {
        for (const ShiftStart& start : starts)
            if (start.axis == axis && start.sign == sign) return;
        if (setup.machine.axes[axis].present) starts.push_back({axis, sign, first});
    };
    if (rapid_in_stock) {
        add(2, 1.0, std::max(missing, resolution) + air_gap);
        return starts;
    }
    if (length > 0.0) {
        int axis = 0;
        for (int i = 1; i < 3; ++i)
            if (std::abs(away[i]) > std::abs(away[axis])) axis = i;
        add(static_cast<size_t>(axis), away[axis] > 0.0 ? 1.0 : -1.0,
            std::max(missing, resolution) * length / std::abs(away[axis]));
    }
    add(2, 1.0, missing);
    for (const size_t axis : {0, 1})
        for (const double sign : {1.0, -1.0}) add(axis, sign, missing);
    return starts;
}

bool BlockRun::overlaps_at_start(const Pair& pair, const CutModel& before) {
    if (legs[0].leg.positions.empty()) return false;
    TrackedPairs there;
    CheckMemory nothing_known;
    leg_check(FluteUse::not_cutting, nothing_known)
        .rest(legs[0].leg.positions[0], 0.0, before, there);
    return std::any_of(there.begin(), there.end(), [&](const TrackedPair& one) {
        return one.pair == pair && one.verdict == Verdict::collision;
    });
}

bool BlockRun::may_study(const PairClearance& pair) {
    constexpr size_t most_findings = 40, most_of_a_pair = 8; // of a run
    constexpr size_t most_work = 40'000'000;
    if (block.judgement || block.is_trial || !tool() || legs.empty()) return false;
    if (block.path != PathCertainty::known || is_uncertain) return false;
    if (pair.verdict != Verdict::collision && pair.verdict != Verdict::violation) return false;
    TrialMemory& memory = state.trials;
    const auto alike = std::count(memory.studied.begin(), memory.studied.end(), pair.pair);
    if (memory.studied.size() >= most_findings || static_cast<size_t>(alike) >= most_of_a_pair
        || memory.work >= most_work)
        return false;
    memory.studied.push_back(pair.pair);
    return true;
}

PairStudy BlockRun::study(const PairClearance& pair) {
    constexpr size_t most_legs = 100;
    PairStudy study;
    if (!may_study(pair)) return study;
    const auto before = stock_after(setup, state, moves_before);
    const BlockMove move = move_of(pair);
    const bool rapid = move.motion == BlockMotion::rapid;
    if (pair.verdict == Verdict::collision)
        study.overlap =
            overlap_of({setup, *tool(), block.block, legs, before.get(), rapid}, pair.pair);
    if (!before || !can_shift(block) || turns || legs.size() > most_legs) return study;
    const bool rapid_in_stock = rapid && !pair.pair.fixture;
    study.starts_inside = rapid && overlaps_at_start(pair.pair, *before);
    const bool is_cured_by_shift =
        pair.pair.fixture || pair.verdict == Verdict::violation || rapid_in_stock;
    if (!is_cured_by_shift || move.only_dog_leg || (rapid_in_stock && study.starts_inside))
        return study;
    study.cuts = !rapid_in_stock && result.removed > 0.0;
    const BlockTrial trial{setup, block, state, *before, corners_before, study.cuts};
    study.shift = find_shift(trial, pair.pair, shifts_to_try(pair, study, rapid_in_stock),
                             rapid_in_stock ? air_gap : 0.0, state.trials.work);
    study.tried = true;
    return study;
}

Finding BlockRun::finding_about(const PairClearance& pair, const PairStudy& study) const {
    Finding finding = finding_of(setup, pair, move_of(pair), state, study);
    if (pair.unless_removed && pair.verdict == Verdict::undecided) {
        finding.message += " It is certain unless an earlier motion, itself undecided, has removed "
                           "the stock there.";
        finding.cure = "Make the earlier undecided motion safe first.";
    } else if (is_uncertain && pair.verdict == Verdict::undecided) {
        finding.message += " A probing move may have ended anywhere between its start and its "
                           "contact, and the program has not positioned all axes since.";
        finding.cure = "After probing, retract in G90 to a stated position that is clear.";
    }
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
        "Ramp or helix in at {:.1f} degrees or less, with a radius larger than that of the centre; "
        "pre-drill; or use a centre-cutting tool.",
        core::atan(centre_recess(described) / (2.0 * described.centre_radius)) * 180.0
            / std::numbers::pi);
    return finding;
}

bool BlockRun::touches_no_doubtful_stock(const PairClearance& pair) {
    if (pair.pair.fixture || !tool()) return false;
    const double room =
        contact_depth(pair.allowance) - std::max(off_path, off_path_rapids) - off_by_axes;
    LegCheck check = leg_check(FluteUse::not_cutting);
    // Straight up from where it has stopped after a feed, the tool stays where it has been itself,
    // however the corners before were rounded.
    const bool is_flutes = pair.pair == Pair{PartKind::flutes};
    const bool may_stop = is_below_holder(pair.pair.part) && !setup.machine.has_rotary()
                          && !corners_before.last.mixed.rounds() && !state.corners.mixed.rounds()
                          && leaves_its_cut_upwards(*tool());
    bool has_stopped =
        may_stop && corners_before.last.kind && *corners_before.last.kind != MotionKind::rapid;
    return std::all_of(legs.begin(), legs.end(), [&](const TimedLeg& timed) {
        const bool is_cut = is_flutes && timed.use == FluteUse::cutting;
        const bool leaves = has_stopped && timed.is_rapid && rises(timed.leg);
        has_stopped = may_stop && (!timed.is_rapid || leaves);
        return is_cut || leaves
               || check.reach_into_raw_stock(pair.pair, timed.leg, state.stock) <= room;
    });
}

bool BlockRun::follows_own_cut(const PairClearance& pair, bool rises) {
    if (!tool()) return false;
    const RoundedCorners& corners = state.corners;
    const bool is_rapid = result.motion == BlockMotion::rapid;
    if (pair.pair.part == PartKind::flutes) {
        const bool may_cut = rises || std::any_of(legs.begin(), legs.end(), [](const auto& timed) {
                                 return timed.use == FluteUse::cutting;
                             });
        return may_cut && follows_cuts(corners, state.tool, rises, is_rapid);
    }
    const auto first = first_own_cut(corners, state.tool, rises, is_rapid);
    if (!first || !fits_own_cut(*tool(), pair.pair.part)) return false;
    // Without rounded corners, its cuts are where they are programmed.
    const double sideways = std::max(corners.own.by, 0.5 * contact_depth(pair.allowance));
    const OwnMoves own{*first, moves_before, sideways};
    const double apart = path_deviation(pair.pair, off_path + off_by_axes, corners);
    const LegCheck check = leg_check(FluteUse::not_cutting);
    return std::all_of(legs.begin(), legs.end(), [&](const TimedLeg& timed) {
        return check.follows_flutes(pair.pair, timed.leg, state.stock, own, apart);
    });
}

void BlockRun::conclude() {
    pairs.sort();
    const bool rise = std::all_of(legs.begin(), legs.end(),
                                  [](const TimedLeg& timed) { return rises(timed.leg); });
    const BlockDeviation of{off_path, off_path_rapids, off_by_axes};
    std::vector<double> on_the_way; // distance of each pair on the programmed path
    for (TrackedPair& pair : pairs) {
        on_the_way.push_back(pair.upper);
        const ContactDoubt doubt = widen(pair, of, state.corners);
        const bool follows =
            doubt == ContactDoubt::unless_in_own_cut && follows_own_cut(pair, rise);
        if (follows)
            state.assumptions.insert("the control rounds the same corner alike each time: a tool "
                                     "that moves where it has cut deviates as it did then");
        if (doubt != ContactDoubt::none && !follows && !touches_no_doubtful_stock(pair))
            pair.verdict = std::max(pair.verdict, Verdict::undecided);
        widen_by_stock(pair, setup.stock.deviation);
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
        if (pair.verdict != Verdict::clear) add(finding_about(pair, study(pair)));
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
