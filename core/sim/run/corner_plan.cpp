#include "core/sim/run/corner_plan.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "core/motion/path.h"
#include "core/sim/moving_body.h"
#include "core/sim/setup.h"

namespace core {
namespace {

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

std::optional<MovingBody> flutes_of(const Setup& setup, const ToolAssembly& tool) {
    for (const MovingBody& body : moving_bodies(setup, tool))
        if (body.kind == PartKind::flutes) return body;
    return std::nullopt;
}

/// Whether the flutes may come as far as the stock on legs.
bool flutes_reach_stock(const CornerMove& move, const std::vector<Leg>& legs) {
    const auto flutes = flutes_of(move.setup, *move.tool);
    return flutes && std::any_of(legs.begin(), legs.end(), [&](const Leg& leg) {
               const Aabb box = bounds(*flutes, leg_against(move.setup, {}, *flutes, leg));
               return distance(box, move.stock) <= 0.0;
           });
}

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

/// Lines that may be joined with those before them, which end at a corner.
CornerPlan plan_joined(const CornerMove& move, const Path& path, RoundedCorners& corners) {
    CornerPlan plan;
    if (!(corners.left_after > 0.0)) return plan;
    std::vector<Leg> legs = path.legs;
    const double length = length_of(legs), left = corners.left_after;
    if (legs.size() == 1 && left < length) legs[0] = stretch(legs[0], 0.0, left / length);
    corners.left_after -= length;
    plan.may_cut = move.may_cut;
    plan.anywhere = std::move(legs);
    plan.kind = CornerPlan::Kind::beside_rest;
    if (!corners.last.rest.empty()) return plan;
    plan.kind = CornerPlan::Kind::region;
    const CornerBlend blend{.deviation = corners.off_after};
    for (Leg& leg : plan.anywhere) leg = off_path_by(std::move(leg), blend);
    return plan;
}

/// A corner of LinuxCNC at which other axes than X, Y and Z move.
CornerPlan plan_turning(const CornerMove& move, const Path& path, const std::vector<Leg>& before,
                        const CornerBlend& blend, RoundedCorners& corners) {
    CornerPlan plan;
    if (move.motion.tip || blend.deviation == infinity) {
        plan.assumptions.insert("corners at which rotary axes turn are not rounded while the "
                                "control follows the tool tip");
        return plan;
    }
    const bool rapid = move.motion.kind == MotionKind::rapid;
    if (blend.turn == 0.0 && blend.deviation == 0.0) return plan;
    const auto is_known = [](const MachineAxis& axis) {
        return !axis.present || axis.acceleration;
    };
    const auto& axes = move.setup.machine.axes;
    if (!rapid && !std::all_of(axes.begin(), axes.end(), is_known)) {
        plan.assumptions.insert("it is assumed that LinuxCNC passes corners at which other axes "
                                "than X, Y and Z move within 0.01 degrees, because the machine "
                                "does not state all accelerations; it may leave them by more");
        return plan;
    }
    // Both feeds count as this far off anyway.
    const bool both_turn = moves_other_axes(path.legs) && moves_other_axes(corners.last.legs);
    if (!rapid && blend.turn <= (both_turn ? smooth_turn : 0.0)
        && blend.deviation <= std::min(corners.last.by, move.off_path))
        return plan;
    plan.assumptions.insert(
        rapid ? "LinuxCNC may begin a rapid before the one before it has ended, also where rotary "
                "axes turn; clearances include this"
              : "where other axes than X, Y and Z move, LinuxCNC leaves corners by what the "
                "tolerance of G64 and the ways of both motions make it; clearances include this");
    std::vector<Leg> rest = last_part(before, blend.left);
    plan.anywhere = path.legs;
    if (plan.anywhere.size() == 1 && blend.part_after < 1.0)
        plan.anywhere[0] = stretch(plan.anywhere[0], 0.0, blend.part_after);
    for (Leg& leg : rest) leg.path_error += corners.joining;
    corners.last.rest = std::move(rest);
    if (!rapid && corners.joining > 0.0 && !moves_other_axes(path.legs))
        corners.left_after = (blend.part_after - 1.0) * length_of(path.legs);
    plan.kind = CornerPlan::Kind::beside_rest;
    plan.may_cut = !rapid && move.may_cut;
    const AxisValues& corner = corners.last.rest.back().positions.back();
    for (const Leg& leg : corners.last.rest)
        if (plan.may_cut
            && flutes_reach_stock(move, RestPart{.rest = &leg}.beside(plan.anywhere, corner)))
            plan.of_cuts = std::max(
                plan.of_cuts,
                blend.deviation + off_by_turn(move.setup, move.tool, plan.anywhere, blend.turn));
    return plan;
}

} // namespace

double off_by_turn(const Setup& setup, const ToolAssembly* tool, const std::vector<Leg>& legs,
                   double turn) {
    const auto flutes = flutes_of(setup, *tool);
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

double RestPart::size() const {
    constexpr double fine_turn = 0.002, fine_way = 0.02; // radians, mm
    const std::span<const Leg> one(rest, 1);
    return (to - from) * std::max(turned_on(one) / fine_turn, length_of(one) / fine_way);
}

std::array<RestPart, 2> RestPart::halves() const {
    const double middle = 0.5 * (from + to);
    return {{{rest, from, middle}, {rest, middle, to}}};
}

std::vector<Leg> RestPart::beside(const std::vector<Leg>& legs, const AxisValues& corner) const {
    return displaced(legs, *rest, from, to, corner);
}

CornerPlan plan_corner(const CornerMove& move, RoundedCorners& corners) {
    const Motion& motion = move.motion;
    const Machine& machine = move.setup.machine;
    const CornerStart& last = corners.last;
    CornerPlan plan;
    if (!last.kind) corners.left_after = 0.0;
    if (!last.kind || is_left_out(motion)) return plan;
    // A small arc may be lines.
    const std::vector<Leg> lines = lines_of_arc(motion, move.path, corners.arcs_as_lines());
    const Path path{.legs = without_rounding(lines.empty() ? move.path.legs : lines),
                    .duration = move.path.duration};
    const bool is_arc = motion.arc && lines.empty();
    const bool rapid = motion.kind == MotionKind::rapid, was = *last.kind == MotionKind::rapid;
    const bool between_feeds = !rapid && !was;
    const bool at_arc = is_arc || last.is_arc;
    const bool at_others =
        rapid == was && (moves_other_axes(path.legs) || moves_other_axes(last.legs));
    // The whole feed counts as rounded, but for what is left of a corner before it.
    if (between_feeds && !at_arc && !at_others) return plan_joined(move, path, corners);
    corners.left_after = 0.0;
    const bool is_turn =
        at_others && between_feeds && (mostly_turns(path.legs) || mostly_turns(last.legs));
    const CornerLimit& limit = is_turn         ? last.turns
                               : between_feeds ? last.arcs
                               : rapid && was  ? last.rapids
                                               : last.mixed;
    if (at_others && between_feeds && !limit.rounds() && last.by > 0.0)
        plan.assumptions.insert("rotary axes keep to their path where the control rounds corners "
                                "between feeds");
    if (!limit.rounds()) return plan;
    const CornerKind kind = !between_feeds                        ? CornerKind::rapids
                            : corners.joining > 0.0 || last.joins ? CornerKind::joined_feeds
                                                                  : CornerKind::feeds;
    const std::vector<Leg> before = last.legs_with_joined();
    CornerBlend blend{{limit.distance, limit.distance}, limit.deviation};
    if (limit.blends()) blend = blend_at(before, path.legs, limit.blended, kind, machine);
    if (at_others && limit.blends()) return plan_turning(move, path, before, blend, corners);
    if (at_arc && between_feeds && !states_accelerations(machine)) {
        constexpr double sharp = 0.02; // radians
        if (turn_at(last.legs, path.legs).value_or(infinity) > sharp)
            plan.assumptions.insert("it is assumed that LinuxCNC leaves corners of arcs by no "
                                    "more than those of lines, because the machine does not state "
                                    "`acceleration` of its axes; it may leave them by more");
        return plan;
    }
    if (between_feeds && blend.deviation <= std::min(last.by, move.off_path)) return plan;
    auto region = corner_region(before, path.legs, blend.deviation, blend.reach);
    if (!region) return plan;
    plan.assumptions.insert(corner_assumption(limit, between_feeds, states_dynamics(machine)));
    if (between_feeds && move.cuts) corners.of_cuts = std::max(corners.of_cuts, blend.deviation);
    if (kind == CornerKind::joined_feeds && !is_arc) {
        corners.left_after = blend.reach.after - length_of(path.legs);
        corners.off_after = blend.deviation;
        corners.last.rest.clear();
    }
    if (region->hull.positions.empty()) {
        plan.assumptions.insert("corners of rapids at which rotary axes turn are not rounded");
        return plan;
    }
    plan.kind = CornerPlan::Kind::region;
    const bool bends = std::any_of(region->along.begin(), region->along.end(),
                                   [](const Leg& leg) { return leg.arc.motion != nullptr; });
    plan.deviation = bends && limit.distance < infinity ? limit.distance : blend.deviation;
    // Between straight moves the curve is within a triangle that begins and ends at the reach.
    if (between_feeds) region->hull = off_path_by(std::move(region->hull), blend);
    region->hull.begin = region->hull.end = 0.0;
    plan.anywhere = {std::move(region->hull)};
    plan.along = std::move(region->along);
    plan.may_cut = !(rapid && was) && move.may_cut;
    return plan;
}

} // namespace core
