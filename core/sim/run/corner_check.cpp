#include <utility>

#include <fmt/format.h>

#include "core/motion/corner.h"
#include "core/sim/run/block_run.h"

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

std::string corner_assumption(const CornerLimit& limit, bool between_feeds, bool knows_dynamics) {
    if (between_feeds)
        return "LinuxCNC may leave corners of arcs by more than the tolerance of G64, depending on "
               "feeds (up to 120 %) and accelerations; clearances include this";
    if (!limit.keeps_speed())
        return fmt::format("corners between rapids may be rounded by up to {:.4g} mm; clearances "
                           "include this",
                           limit.deviation);
    return fmt::format("corners between rapids are rounded as far as {} (G64 without P); "
                       "clearances include this",
                       knows_dynamics ? "the speeds and accelerations of the machine make it"
                                      : "to the middle of the first and the end of the second, "
                                        "because speeds and accelerations of "
                                        "the axes are not stated");
}

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

namespace {

std::optional<MovingBody> flutes_of(const Setup& setup, const ToolAssembly& tool) {
    for (const MovingBody& body : moving_bodies(setup, tool))
        if (body.kind == PartKind::flutes) return body;
    return std::nullopt;
}

} // namespace

bool BlockRun::flutes_reach_stock(const std::vector<Leg>& legs) const {
    const auto flutes = flutes_of(setup, *tool());
    return flutes && std::any_of(legs.begin(), legs.end(), [&](const Leg& leg) {
               const Aabb box = bounds(*flutes, leg_against(setup, {}, *flutes, leg));
               return distance(box, state.stock.outer_box) <= 0.0;
           });
}

double BlockRun::off_by_turn(const std::vector<Leg>& legs, double turn) const {
    const auto flutes = flutes_of(setup, *tool());
    double off = 0.0;
    for (const Leg& leg : legs) {
        if (!flutes || !leg.straight || leg.positions.size() != 2) continue;
        constexpr double most_turn = 0.2; // radians, of a piece
        const int pieces = 1 + static_cast<int>(turned_on({&leg, 1}) / most_turn);
        for (int i = 0; i < pieces; ++i) {
            Leg piece = stretch(leg, static_cast<double>(i) / pieces, (i + 1.0) / pieces);
            const double error = leg_against(setup, {}, *flutes, piece).error;
            piece.turn_error += turn;
            off = std::max(off, leg_against(setup, {}, *flutes, piece).error - error);
        }
    }
    return off;
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
    if (cuts) corners.by_axes_of_cuts = std::max(corners.by_axes_of_cuts, off_by_axes);
    if (by == 0.0) return;
    off_path = std::max(off_path, by);
    if (cuts) {
        corners.note_cut(state.tool, motion.arc.has_value());
        if (corners.arcs.rounds() && !motion.tip && moves_other_axes(path.legs))
            corners.of_cuts = std::max(corners.of_cuts, by + off_by_turn(path.legs, smooth_turn));
    }
    const double own = motion.arc ? corners.by_arc : corners.by;
    if (own > 0.0)
        state.assumptions.insert(fmt::format(
            "{} may deviate by up to {:.4g} mm from the programmed path while the control rounds "
            "corners; clearances include this",
            motion.arc && corners.by_arc != corners.by ? "arcs" : "feeds", own));
}

namespace {

/// A leg beside a corner, whose bodies are off as the control leaves it.
Leg off_path_by(Leg leg, const CornerBlend& blend) {
    leg.path_error += blend.deviation;
    leg.lasting_error += blend.deviation;
    leg.turn_error += blend.turn;
    return leg;
}

/// Whether a motion hardly moves X, Y and Z while other axes move.
bool mostly_turns(const std::vector<Leg>& legs) {
    constexpr double most = 0.5; // radians for a millimetre
    return turned_on(legs) > most * length_of(legs);
}

} // namespace

void BlockRun::check_corner(const Motion& motion, const Path& programmed) {
    const CornerStart& last = state.corners.last;
    if (!last.kind) state.corners.left_after = 0.0;
    if (!last.kind || is_left_out(motion)) return;
    // A small arc may be lines.
    const std::vector<Leg> lines = lines_of_arc(motion, programmed, state.corners.arcs_as_lines());
    const Path path{.legs = without_rounding(lines.empty() ? programmed.legs : lines),
                    .duration = programmed.duration};
    const bool is_arc = motion.arc && lines.empty();
    const bool rapid = motion.kind == MotionKind::rapid, was = *last.kind == MotionKind::rapid;
    const bool between_feeds = !rapid && !was;
    const bool at_arc = is_arc || last.is_arc;
    const bool at_others =
        rapid == was && (moves_other_axes(path.legs) || moves_other_axes(last.legs));
    // The whole feed counts as rounded, but for what is left of a corner before it.
    if (between_feeds && !at_arc && !at_others) return check_joined_after_corner(motion, path);
    state.corners.left_after = 0.0;
    const bool is_turn =
        at_others && between_feeds && (mostly_turns(path.legs) || mostly_turns(last.legs));
    const CornerLimit& limit = is_turn         ? last.turns
                               : between_feeds ? last.arcs
                               : rapid && was  ? last.rapids
                                               : last.mixed;
    if (at_others && between_feeds && !limit.rounds() && last.by > 0.0)
        state.assumptions.insert("rotary axes keep to their path where the control rounds corners "
                                 "between feeds");
    if (!limit.rounds()) return;
    const CornerKind kind = !between_feeds                              ? CornerKind::rapids
                            : state.corners.joining > 0.0 || last.joins ? CornerKind::joined_feeds
                                                                        : CornerKind::feeds;
    const std::vector<Leg> before = last.legs_with_joined();
    CornerBlend blend{{limit.distance, limit.distance}, limit.deviation};
    if (limit.blends()) blend = blend_at(before, path.legs, limit.blended, kind, setup.machine);
    if (at_others && limit.blends()) return check_turning_corner(motion, path, before, blend);
    if (at_arc && between_feeds && !states_accelerations(setup.machine)) {
        constexpr double sharp = 0.02; // radians
        if (turn_at(last.legs, path.legs).value_or(infinity) > sharp)
            state.assumptions.insert("it is assumed that LinuxCNC leaves corners of arcs by no "
                                     "more than those of lines, because the machine does not state "
                                     "`acceleration` of its axes; it may leave them by more");
        return;
    }
    if (between_feeds && blend.deviation <= std::min(last.by, off_path)) return;
    auto region = corner_region(before, path.legs, blend.deviation, blend.reach);
    if (!region) return;
    state.assumptions.insert(
        corner_assumption(limit, between_feeds, states_dynamics(setup.machine)));
    if (between_feeds && use(motion) == FluteUse::cutting)
        state.corners.of_cuts = std::max(state.corners.of_cuts, blend.deviation);
    if (kind == CornerKind::joined_feeds && !is_arc) {
        state.corners.left_after = blend.reach.after - length_of(path.legs);
        state.corners.off_after = blend.deviation;
        state.corners.last.rest.clear();
    }
    if (region->hull.positions.empty()) {
        state.assumptions.insert("corners of rapids at which rotary axes turn are not rounded");
        return;
    }
    const bool bends = std::any_of(region->along.begin(), region->along.end(),
                                   [](const Leg& leg) { return leg.arc.motion != nullptr; });
    const double deviation = bends && limit.distance < infinity ? limit.distance : blend.deviation;
    // Between straight moves the curve is within a triangle that begins and ends at the reach.
    if (between_feeds) region->hull = off_path_by(std::move(region->hull), blend);
    region->hull.begin = region->hull.end = 0.0;
    check_region({region->hull}, region->along, deviation,
                 !(rapid && was) && flutes_may_cut(motion));
}

void BlockRun::check_joined_after_corner(const Motion& motion, const Path& path) {
    RoundedCorners& corners = state.corners;
    if (!(corners.left_after > 0.0)) return;
    std::vector<Leg> legs = path.legs;
    const double length = length_of(legs), left = corners.left_after;
    if (legs.size() == 1 && left < length) legs[0] = stretch(legs[0], 0.0, left / length);
    corners.left_after -= length;
    if (!corners.last.rest.empty()) return check_beside_rest(legs, flutes_may_cut(motion));
    const CornerBlend blend{.deviation = corners.off_after};
    for (Leg& leg : legs) leg = off_path_by(std::move(leg), blend);
    check_region(legs, {}, 0.0, flutes_may_cut(motion));
}

void BlockRun::check_turning_corner(const Motion& motion, const Path& path,
                                    const std::vector<Leg>& before, const CornerBlend& blend) {
    if (motion.tip || blend.deviation == infinity) {
        state.assumptions.insert("corners at which rotary axes turn are not rounded while the "
                                 "control follows the tool tip");
        return;
    }
    const bool rapid = motion.kind == MotionKind::rapid;
    if (blend.turn == 0.0 && blend.deviation == 0.0) return;
    const auto is_known = [](const MachineAxis& axis) {
        return !axis.present || axis.acceleration;
    };
    const auto& axes = setup.machine.axes;
    if (!rapid && !std::all_of(axes.begin(), axes.end(), is_known)) {
        state.assumptions.insert("it is assumed that LinuxCNC passes corners at which other axes "
                                 "than X, Y and Z move within 0.01 degrees, because the machine "
                                 "does not state all accelerations; it may leave them by more");
        return;
    }
    RoundedCorners& corners = state.corners;
    // Both feeds count as this far off anyway.
    const bool both_turn = moves_other_axes(path.legs) && moves_other_axes(corners.last.legs);
    if (!rapid && blend.turn <= (both_turn ? smooth_turn : 0.0)
        && blend.deviation <= std::min(corners.last.by, off_path))
        return;
    state.assumptions.insert(
        rapid ? "LinuxCNC may begin a rapid before the one before it has ended, also where rotary "
                "axes turn; clearances include this"
              : "where other axes than X, Y and Z move, LinuxCNC leaves corners by what the "
                "tolerance of G64 and the ways of both motions make it; clearances include this");
    std::vector<Leg> rest = last_part(before, blend.left), meanwhile = path.legs;
    if (meanwhile.size() == 1 && blend.part_after < 1.0)
        meanwhile[0] = stretch(meanwhile[0], 0.0, blend.part_after);
    for (Leg& leg : rest) leg.path_error += corners.joining;
    corners.last.rest = std::move(rest);
    if (!rapid && corners.joining > 0.0 && !moves_other_axes(path.legs))
        corners.left_after = (blend.part_after - 1.0) * length_of(path.legs);
    const bool may_cut = !rapid && flutes_may_cut(motion);
    check_beside_rest(meanwhile, may_cut);
    const AxisValues& corner = corners.last.rest.back().positions.back();
    for (const Leg& leg : corners.last.rest)
        if (may_cut && flutes_reach_stock(displaced(meanwhile, leg, 0.0, 1.0, corner)))
            corners.of_cuts =
                std::max(corners.of_cuts, blend.deviation + off_by_turn(meanwhile, blend.turn));
}

void BlockRun::check_beside_rest(const std::vector<Leg>& legs, bool may_cut) {
    struct Part {
        const Leg* rest;
        double from, to;
    };
    constexpr size_t most_parts = 200, most_parts_for_precision = 40;
    constexpr double fine_turn = 0.002, fine_way = 0.02; // radians, mm
    constexpr double precise = 5.0;                      // times fine
    const std::vector<Leg>& rest = state.corners.last.rest;
    const AxisValues corner = rest.back().positions.back();
    const auto size_of = [&](const Part& part) { // times fine
        const std::span<const Leg> one(part.rest, 1);
        return (part.to - part.from)
               * std::max(turned_on(one) / fine_turn, length_of(one) / fine_way);
    };
    std::vector<Part> parts;
    for (const Leg& leg : rest) parts.push_back({&leg, 0.0, 1.0});
    // Where the rest ends, the bodies are as programmed: nearer than there they are only reported
    // if fine parts show it.
    if (std::any_of(parts.begin(), parts.end(),
                    [&](const Part& part) { return size_of(part) > precise; }))
        check_region(displaced(legs, rest.back(), 1.0, 1.0, corner), {}, 0.0, may_cut);
    for (size_t i = 0; i < parts.size(); ++i) {
        const Part part = parts[i];
        const double size = size_of(part);
        const bool may_split = parts.size() < most_parts && size > 1.0;
        const RegionUse use = !may_split ? RegionUse::always
                              : parts.size() < most_parts_for_precision && size > precise
                                  ? RegionUse::if_precise
                                  : RegionUse::if_clear;
        const bool is_used = check_region(displaced(legs, *part.rest, part.from, part.to, corner),
                                          {}, 0.0, may_cut, use);
        if (is_used) continue;
        const double middle = 0.5 * (part.from + part.to);
        parts.push_back({part.rest, part.from, middle});
        parts.push_back({part.rest, middle, part.to});
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
