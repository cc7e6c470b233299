#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/base/text.h"
#include "core/sim/run/block_run.h"
#include "core/sim/verdict.h"

namespace core {
namespace {

BlockMotion label(const Motion& motion) {
    switch (motion.kind) {
    case MotionKind::rapid:
        return BlockMotion::rapid;
    case MotionKind::feed:
        return BlockMotion::feed;
    default:
        return BlockMotion::arc;
    }
}

/// The finding about an axis beyond its limit. `is_certain`: it is known where the motion begins.
Finding over_travel(const OverTravel& far, bool is_certain) {
    Finding finding;
    finding.rule = rule_id("over-travel");
    finding.message = fmt::format("{} {} to {} in machine coordinates, {} beyond its limit.",
                                  axis_letters[far.axis], is_certain ? "goes" : "may go",
                                  target_text(far), beyond_text(far));
    finding.cure = far.axis == 2 ? "Move the work, or use another tool length or work offset."
                   : is_rotary(far.axis)
                       ? "Turn the work, or reach the same position from the other side."
                       : "Move the work, or use another work offset.";
    finding.over_travel = far;
    return finding;
}

} // namespace

void BlockRun::check_limits(const Motion& motion, const AxisSpread& before) {
    for (size_t i = 0; i < axis_count; ++i)
        if (setup.machine.axes[i].present && (!motion.from[i] || !motion.to[i])) return;
    AxisRange range = axis_range(motion, setup.machine, chord_error(setup.mesh_size));
    const AxisSpread after = spread_after(motion, before);
    for (size_t i = 0; i < axis_count; ++i) {
        if (before.below[i] == 0.0 && before.above[i] == 0.0) continue;
        // An arc has no extremes along such an axis.
        const double from = motion.from[i].value_or(0.0), to = motion.to[i].value_or(0.0);
        range.min[i] = std::min(from - before.below[i], to - after.below[i]);
        range.max[i] = std::max(from + before.above[i], to + after.above[i]);
    }
    for (size_t i = 0; i < axis_count; ++i) {
        const MachineAxis& axis = setup.machine.axes[i];
        if (!axis.present || (i == 2 && (spindle_is_lost() || has_guessed_height()))) continue;
        const double below = axis.min.value_or(-infinity) - range.min[i];
        const double above = range.max[i] - axis.max.value_or(infinity);
        if (below > resolution) tell(over_travel({i, false, range.min[i], below}, before.none()));
        if (above > resolution) tell(over_travel({i, true, range.max[i], above}, before.none()));
    }
}

void BlockRun::check_from_unknown(const Motion& motion, const Path& path) {
    // The start position is unknown: report, once, a motion that is not clear from every possible
    // start.
    if (!block.judgement && !path.legs.empty()) {
        TrackedPairs here;
        for (const Leg& leg : path.legs)
            leg_check(use(motion)).run(leg, result.duration, state.stock, here);
        const TrackedPair* worst = deciding_pair(here);
        if (!worst || worst->verdict == Verdict::clear) {
            // In a block with several motions, such as G28, the pair may have an entry already.
            for (const TrackedPair& pair : here) {
                TrackedPair& known = entry(pairs, pair.pair, setup);
                merge(known, pair);
                known.at_end = pair.at_end;
                known.drift = pair.drift;
            }
            return;
        }
    }
    result.checked = false;
    if (std::exchange(state.reported_unknown_start, true)) return;
    if (motion.tip && path.legs.empty())
        return find(rule_id("undecided"),
                    "The control follows the tip while rotary axes turn, one of which carries a "
                    "linear axis: such motions cannot be checked.",
                    "Program the machine's axes, without tip control.");
    if (state.time > 0.0)
        return find(rule_id("first-move"),
                    "The position of the machine is not known any more, so this motion cannot be "
                    "checked.",
                    "Position all axes in machine coordinates, or state in the set-up what the "
                    "program takes from the control.");
    find(rule_id("first-move"),
         "The start position of the machine is unknown, so this motion cannot be checked.",
         "State the axis positions at the first block: `start` under [program] in the set-up, or "
         "the machine's home position.");
}

namespace {

/// Removes everything from a stock.
void remove_all(CutModel& stock) {
    const Vec3 size = stock.outer_box.size();
    const double radius = core::hypot(size.x, size.y);
    const RevolvedProfile all{{{0.0, radius, size.z + 2.0, radius, 0.0}}};
    const Vec3 at = stock.outer_box.min + Vec3(0.5 * size.x, 0.5 * size.y, -1.0);
    cut(stock,
        {.cutter = std::make_shared<const Cutter>(make_cutter(all, 0.0)), .from = at, .to = at});
}

} // namespace

void BlockRun::move_unmeasured(const Motion& motion, const Path& path) {
    if (block.path == PathCertainty::pose_unknown) check_limits(motion, state.spread);
    if (!tool()) move_without_tool(motion, path);
    if (tool() && use(motion) == FluteUse::cutting) {
        // It may have cut anything.
        if (!state.certain_stock) state.certain_stock = state.stock;
        remove_all(*state.certain_stock);
    }
    forget_bounds();
    state.position = motion.to;
    state.centre = {};
    state.rules.air = {};
    state.rules.has_fed = state.rules.has_fed || motion.kind != MotionKind::rapid;
    result.checked = false;
    result.duration += path.duration;
}

bool BlockRun::is_clear_from_anywhere(const Motion& motion) {
    const Path path = path_of(motion, setup.machine, chord_error(setup.mesh_size));
    if (block.judgement || path.legs.empty()) return false;
    CutModel stock = state.stock;
    const CheckMemory memory = state.memory;
    const BlockDeviation of{.by_axes = axis_tolerance_error(setup, tool(), path)};
    state.memory.off_path = off_path + of.by_axes + state.corners.of_stock();
    TrackedPairs here;
    for (const Leg& leg : path.legs) leg_check(use(motion)).run(leg, result.duration, stock, here);
    for (TrackedPair& pair : here)
        if (widen(pair, of, state.corners) != ContactDoubt::none)
            pair.verdict = std::max(pair.verdict, Verdict::undecided);
    state.memory = memory;
    const TrackedPair* worst = deciding_pair(here);
    return !worst || worst->verdict == Verdict::clear;
}

void BlockRun::doubt_assumed_start(const Motion& motion) {
    Motion from_anywhere = motion;
    bool is_doubtful = false;
    for (size_t i = 0; i < state.is_assumed.size(); ++i) {
        if (!state.is_assumed[i]) continue;
        is_doubtful = true;
        from_anywhere.from[i].reset();
        state.is_assumed[i] = motion.from[i] == motion.to[i];
        if (state.is_assumed[i]) from_anywhere.to[i].reset(); // it stays where it is
    }
    const bool is_tool_there = tool() || (!setup.machine.bodies.empty() && !spindle_is_lost());
    if (!is_doubtful || !is_tool_there || state.reported_unknown_start) return;
    if (is_clear_from_anywhere(from_anywhere)) return;
    state.reported_unknown_start = true;
    const auto text = [&](size_t axis) {
        return fmt::format(" {}{}", axis_letters[axis],
                           number_text(motion.from[axis].value_or(0.0), 3));
    };
    find(rule_id("first-move"),
         fmt::format("Nothing states where the machine starts. This motion was checked only from "
                     "the assumed position{}{}{} (machine coordinates).",
                     text(0), text(1), text(2)),
         "State the axis positions at the first block: `start` under [program] in the set-up, or "
         "the machine's home position.");
}

void BlockRun::execute_motion(const Motion& motion) {
    result.motion = result.motion == BlockMotion::none ? label(motion) : BlockMotion::cycle;
    drills_sideways = drills_sideways
                      || (tool() && motion.kind != MotionKind::rapid
                          && turns_to_cut(state.spindle, *tool()) && !cuts_along(*tool(), motion));
    const AxisSpread before = state.spread;
    const bool is_certain = before.none() && !motion.stops_at_contact;
    const Path path = take_path(motion);
    if (path.assumed_speed)
        state.assumptions.insert("rapids run at 10,000 mm/min on axes whose "
                                 "speed is not stated");
    if (block.path >= PathCertainty::pose_unknown) return move_unmeasured(motion, path);
    for (size_t i = 3; i < 6; ++i) turns = turns || motion.from[i] != motion.to[i];
    check_limits(motion, before);
    // The shape of a boring bar changes with the state of its spindle.
    const bool is_bar = tool() && tool()->oriented;
    if (motion.from != state.position || !is_certain || is_bar) forget_bounds();
    if (motion.from != state.position) state.corners.last = {};
    note_axis_tolerances(path);
    round_corners(motion, path);
    state.memory.off_path = off_path + off_by_axes + state.corners.of_stock();
    doubt_assumed_start(motion);
    state.position = motion.to;
    const size_t moves_logged = state.stock.log.size();
    if (!tool()) move_without_tool(motion, path);
    const bool is_lost = spindle_is_lost();
    if (is_lost) forget_bounds();
    if (!tool() && (setup.machine.bodies.empty() || is_lost)) {
        // No body moves of which it is known where it is.
    } else if (path.legs.empty() || !path.legs[0].start_known) {
        check_from_unknown(motion, path);
    } else if (block.judgement) {
        check_corner(motion, path);
        follow_path(motion, path);
    } else if (motion.stops_at_contact && use(motion) != FluteUse::cutting) {
        check_probing(motion, path, before);
    } else {
        check_corner(motion, path);
        check_path(motion, path, !is_certain);
    }
    state.corners.has_cut = state.corners.has_cut || state.stock.log.size() > moves_logged;
    if (!is_certain) forget_bounds();
    note_corner(state.corners, motion, path);
    if (motion.stops_at_contact || is_lost) state.corners.last = {};
    if (state.length_offset.is_assumed || motion.from[2] != motion.to[2])
        state.height_is_assumed = state.length_offset.is_assumed;
    result.duration += path.duration;
}

void BlockRun::track_centre(const Motion& motion, const Leg& leg) {
    if (!tool() || tool()->description.cuts_at_centre) return;
    if (use(motion) != FluteUse::cutting || !leg.straight) {
        state.centre = {};
        return;
    }
    const Mount tip{setup.machine.spindle, translation({0.0, 0.0, -tool()->length})};
    const RelativeLeg way = relative_leg(setup.machine, setup.stock_mount, {.mount = tip}, leg);
    CentreTracker certain_centre = state.centre;
    const bool is_exact =
        setup.stock.play.none() && setup.cut_error == 0.0 && !tool()->certain_flutes.has_value();
    const auto contact = follow(state.centre, tool()->description, way, state.stock, is_exact);
    if (!contact) return;
    TrackedPair& flutes = entry(pairs, {PartKind::flutes}, setup);
    if (flutes.verdict == Verdict::collision) return;
    if (state.certain_stock
        && !follow(certain_centre, tool()->description, way, *state.certain_stock)) {
        flutes.lower = 0.0;
        flutes.verdict = std::max(flutes.verdict, Verdict::undecided);
        flutes.unless_removed = true;
        return;
    }
    pushes_centre = true;
    flutes.lower = flutes.upper = 0.0;
    flutes.verdict = Verdict::collision;
    flutes.on_tool = flutes.on_body = contact->position;
    flutes.time = result.duration + leg.begin + contact->fraction * (leg.end - leg.begin);
}

void BlockRun::check_path(const Motion& motion, const Path& path, bool is_spread) {
    const bool rapid = motion.kind == MotionKind::rapid;
    const bool dog_leg = rapid && !is_spread && (path.legs.size() > 1 || !path.legs[0].straight);
    const bool links = rapid && tool() && state.rules.has_fed && goes_across(path.legs[0]);
    std::optional<CutModel> before;
    if (dog_leg || links) before = state.stock;
    LegCheck check = leg_check(use(motion));
    double removed = 0.0;
    const auto is_clear = [](const TrackedPair& pair) { return pair.verdict == Verdict::clear; };
    for (const Leg& leg : path.legs) {
        if (setup.needs_only_verdict && !std::all_of(pairs.begin(), pairs.end(), is_clear)) break;
        track_centre(motion, leg);
        removed += check_leg(check, leg, use(motion) == FluteUse::cutting);
        legs.push_back({leg, result.duration, use(motion), rapid});
        if (use(motion) == FluteUse::cutting && leg.straight && !state.rules.length_in_doubt)
            note_reach(state.rules.reaches,
                       {setup, *tool(), block.block, leg, state.mounted_fixtures,
                        state.certain_stock ? *state.certain_stock : state.stock},
                       pairs);
    }
    check.finish(pairs);
    note_doubt(check, motion, path);
    const std::vector<size_t> worsened = note_worst(motion.kind);
    result.removed += removed;
    if (before) check_rapid(motion, path, *before, worsened);
    if (!rapid) check_feed(motion, path, removed);
}

double BlockRun::check_leg(LegCheck& check, const Leg& leg, bool cuts) {
    if (!state.certain_stock) return check.run(leg, result.duration, state.stock, pairs);
    const TrackedPairs before = pairs;
    const size_t cuts_before = state.stock.log.size();
    const double removed = check.run(leg, result.duration, state.stock, pairs);
    // What flutes removed in a crash was there; what they cut may have been gone when another body
    // came.
    if (cuts) repeat_cuts(cuts_before);
    doubt_clearances(check, leg, before);
    if (!cuts) repeat_cuts(cuts_before);
    return removed;
}

void BlockRun::doubt_clearances(LegCheck& check, const Leg& leg, const TrackedPairs& before) {
    for (TrackedPair& pair : pairs) {
        if (pair.pair.fixture || pair.verdict < Verdict::violation) continue;
        PairClearance known{.pair = pair.pair, .allowance = pair.allowance};
        if (const TrackedPair* one = before.find(pair.pair)) known = *one;
        if (pair.verdict <= known.verdict) continue;
        PairClearance sure =
            check.certain_clearance(pair.pair, leg, result.duration, *state.certain_stock);
        if (sure.verdict >= pair.verdict) continue;
        sure.verdict = std::max(sure.verdict, Verdict::undecided);
        merge(known, sure);
        known.lower = pair.lower;
        static_cast<PairClearance&>(pair) = known;
        pair.unless_removed = true;
    }
}

void BlockRun::repeat_cuts(size_t first) {
    if (!state.certain_stock) return;
    for (size_t i = first; i < state.stock.log.size(); ++i)
        cut(*state.certain_stock, state.stock.log[i].sweep);
}

void BlockRun::note_doubt(LegCheck& check, const Motion& motion, const Path& path) {
    const auto is_straight = [](const Leg& leg) { return leg.straight; };
    if (use(motion) == FluteUse::cutting
        && std::all_of(path.legs.begin(), path.legs.end(), is_straight))
        return;
    const auto flutes = std::find_if(pairs.begin(), pairs.end(), [](const TrackedPair& pair) {
        return pair.pair == Pair{PartKind::flutes};
    });
    if (flutes == pairs.end() || flutes->verdict != Verdict::undecided) return;
    if (!state.certain_stock) state.certain_stock = state.stock;
    for (const Leg& leg : path.legs) check.may_cut(leg, *state.certain_stock);
}

void BlockRun::follow_path(const Motion& motion, const Path& path) {
    const bool cuts = use(motion) == FluteUse::cutting;
    LegCheck check = leg_check(use(motion));
    const size_t cuts_before = state.stock.log.size();
    for (const Leg& leg : path.legs) {
        track_centre(motion, leg);
        // If rotary axes move, the position at which the tool meets the stock is unknown.
        if (cuts || (block.judgement->runs_into_stock && !turns))
            result.removed += check.only_cut(leg, state.stock);
    }
    repeat_cuts(cuts_before);
    state.rules.has_fed = state.rules.has_fed || motion.kind != MotionKind::rapid;
}

void BlockRun::check_rapid(const Motion& motion, const Path& path, const CutModel& before,
                           std::span<const size_t> worsened) {
    const bool straight = path.legs.size() == 1 && path.legs[0].straight;
    if (straight && tool())
        return tell(low_retract(
            {setup, *tool(), block.block, path.legs[0], state.mounted_fixtures, before}, pairs));
    if (worsened.empty()) return;
    Motion unbent = motion;
    unbent.style = RapidStyle::straight;
    CutModel stock = before;
    CheckMemory memory; // the bounds of the run only hold along its own path
    TrackedPairs along_the_line;
    for (const Leg& leg : path_of(unbent, setup.machine, chord_error(setup.mesh_size)).legs)
        leg_check(FluteUse::not_cutting, memory).run(leg, 0.0, stock, along_the_line);
    for (const size_t i : worsened) {
        const auto is_same = [&](const TrackedPair& pair) {
            return pair.pair == worst_motions[i].pair && pair.verdict != Verdict::clear;
        };
        worst_motions[i].only_dog_leg =
            std::none_of(along_the_line.begin(), along_the_line.end(), is_same);
    }
}

void BlockRun::check_feed(const Motion& motion, const Path& path, double removed) {
    state.rules.has_fed = true;
    if (!tool() || use(motion) != FluteUse::cutting) return;
    LegCheck check = leg_check(FluteUse::cutting);
    bool in_air = removed <= 0.0;
    for (const Leg& leg : path.legs)
        in_air = in_air && check.flutes_have_room(leg, state.stock, air_gap);
    if (in_air)
        add_air(state.rules.air, block.block, path.duration * motion.feed / 60.0);
    else
        tell(end_air(state.rules.air, tool()->description.diameter));
    if (in_air) return;
    auto found = singular_orientation(setup.machine, motion, tool()->length);
    const bool swings = found && !motion.tip && removed <= 0.0;
    if (!found || swings || std::exchange(state.rules.singular_reported, true)) return;
    tell(std::move(found));
}

void BlockRun::doubt_empty_spindle(const Path& path) {
    const bool is_known =
        !path.legs.empty() && path.legs[0].start_known && state.is_assumed == std::array<bool, 3>{};
    if (!is_known || block.judgement || state.reported_unchecked_tool) return;
    for (const auto& [number, held] : setup.tools) {
        if (held.reach_is_assumed) continue;
        CheckMemory memory; // the bounds of the run hold for its own bodies
        CutModel stock = state.stock;
        TrackedPairs here;
        state.tool = number;
        for (const Leg& leg : path.legs)
            leg_check(FluteUse::not_cutting, memory).run(leg, result.duration, stock, here);
        state.tool.reset();
        const TrackedPair* worst = deciding_pair(here);
        if (!worst || worst->verdict == Verdict::clear) continue;
        state.reported_unchecked_tool = true;
        result.checked = false;
        return find(rule_id("open-premise"),
                    fmt::format("The set-up does not state which tool is in the spindle at the "
                                "start. With tool {}, the {} may come too close to {} here.",
                                value_of(number), part_name(setup, worst->pair),
                                worst->pair.fixture ? body_name(setup, worst->pair) : "the stock"),
                    "State `tool_at_start` under [program] in the set-up (0: none).");
    }
}

void BlockRun::move_without_tool(const Motion& motion, const Path& path) {
    if (!state.tool && (state.tool_known || motion.kind == MotionKind::rapid)) {
        if (!state.tool_known) {
            state.assumptions.insert("the spindle is empty until the first tool change");
            doubt_empty_spindle(path);
        }
        return;
    }
    result.checked = false;
    if (std::exchange(state.reported_unchecked_tool, true)) return;
    if (state.tool)
        find(
            rule_id("undecided"),
            fmt::format("Tool {} moves, but it is not described: none of its motions can be "
                        "checked.",
                        value_of(*state.tool)),
            fmt::format("Describe it in the set-up: [[tool]] number = {}.", value_of(*state.tool)));
    else
        find(rule_id("undecided"),
             "The program feeds before it calls a tool, so the tool is unknown.",
             "Call the tool (T and M6), or describe a single tool in the set-up.");
}

} // namespace core
