#include "gcode/contour/radius_compensation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"

namespace gcode {
namespace {

/// Bends up to this angle, radians, count as straight on (LinuxCNC: TOLERANCE_CONCAVE_CORNER).
constexpr double slight_bend = 0.05;

/// A move that inside corners shorten to less than this, mm, has no direction.
constexpr double degenerate = 1e-6;

tl::unexpected<core::Error> refusal(const core::SourceSpan& where, std::string message) {
    return core::fail(core::ErrorCode::invalid_value, std::move(message), where);
}

/// The displacement from a point of the contour to the tool centre, normal to the heading.
FlatPoint offset_from(const RadiusCompensation& compensation, FlatPoint heading) {
    const FlatPoint left = compensation.radius * left_of(heading);
    return compensation.side == ContourSide::left ? left : -1.0 * left;
}

/// Whether the tool is on the same side of the contour as the centre of the arc.
bool is_inside(ContourSide side, const FlatArc& arc) {
    return (side == ContourSide::left) == (arc.turns > 0);
}

double compensated_radius(const RadiusCompensation& compensation, const FlatArc& arc,
                          FlatPoint on_contour) {
    const double radius = length(on_contour - arc.centre);
    return is_inside(compensation.side, arc) ? radius - compensation.radius
                                             : radius + compensation.radius;
}

/// The programmed end of the last move, with the directions of the contour before and after it.
struct Corner {
    FlatPoint at;
    FlatPoint arriving, leaving;           // directions of the contour
    FlatPoint tool_arriving, tool_leaving; // positions of the tool centre for each
};

Corner corner_before(const RadiusCompensation& compensation, const ContourMove& move) {
    const FlatPoint at = compensation.programmed;
    const FlatPoint to_tool = direction(compensation.tool - at);
    const FlatPoint turned = left_of(to_tool);
    const FlatPoint arriving = compensation.side == ContourSide::left ? -1.0 * turned : turned;
    const FlatPoint leaving = move.arc ? tangent(*move.arc, at) : direction(move.end - at);
    return {at, arriving, leaving, compensation.tool, at + offset_from(compensation, leaving)};
}

enum class Bend { inside, straight_on, outside };

Bend bend_of(const RadiusCompensation& compensation, const Corner& corner,
             const ContourMove& move) {
    const double to_left =
        core::atan2(cross(corner.arriving, corner.leaving), dot(corner.arriving, corner.leaving));
    const double to_tool = compensation.side == ContourSide::left ? to_left : -to_left;
    if (std::abs(to_tool) > std::numbers::pi - slight_bend) {
        // The contour reverses. Between an arc that the tool passes on the outside and whatever is
        // tangent to it there is a gap, which is an inside corner. LinuxCNC tests the leaving arc,
        // and the arriving arc only if a line follows.
        const std::optional<FlatArc>& arc = move.arc ? move.arc : compensation.waiting.front().arc;
        const bool between = arc && !is_inside(compensation.side, *arc);
        return between ? Bend::inside : Bend::outside;
    }
    if (std::abs(to_tool) <= slight_bend) return Bend::straight_on;
    return to_tool > 0.0 ? Bend::inside : Bend::outside;
}

/// The tool centre when it touches both sides of an inside corner.
std::optional<FlatPoint> touching_both(const RadiusCompensation& compensation, const Corner& corner,
                                       const ContourMove& move) {
    const std::optional<FlatArc>& before = compensation.waiting.front().arc;
    const double radius_before = before ? length(corner.tool_arriving - before->centre) : 0.0;
    const double radius = move.arc ? compensated_radius(compensation, *move.arc, move.end) : 0.0;
    if (before && move.arc) {
        const auto crossings =
            cross_circles(before->centre, radius_before, move.arc->centre, radius);
        if (!crossings) return {};
        const bool reversing = dot(corner.arriving, corner.leaving) < -core::cos(slight_bend);
        const double side =
            reversing ? dot(crossings->second - crossings->first, corner.arriving)
                      : cross(move.arc->centre - before->centre, corner.at - before->centre);
        return side > 0.0 ? crossings->first : crossings->second;
    }
    if (move.arc) {
        const auto crossings =
            cross_line_and_circle(corner.tool_arriving, corner.arriving, move.arc->centre, radius);
        if (!crossings) return {};
        return is_inside(compensation.side, *move.arc) ? crossings->second : crossings->first;
    }
    if (before) {
        const auto crossings = cross_line_and_circle(corner.tool_leaving, corner.leaving,
                                                     before->centre, radius_before);
        if (!crossings) return {};
        return is_inside(compensation.side, *before) ? crossings->first : crossings->second;
    }
    const FlatPoint arriving = corner.tool_arriving - corner.at;
    const FlatPoint both = arriving + (corner.tool_leaving - corner.at);
    return corner.at + (dot(arriving, arriving) / dot(arriving, both)) * both;
}

/// Whether the waiting move would have to run backwards to end at a point.
bool turns_round(const RadiusCompensation& compensation, FlatPoint end) {
    const std::optional<FlatArc>& arc = compensation.waiting.front().arc;
    const FlatPoint way = end - compensation.reached;
    if (length(way) < degenerate) return false;
    if (!arc) return dot(compensation.waiting_way, way) < 0.0;
    return turned_angle(*arc, compensation.reached, end)
           > compensation.waiting_angle + 2.0 * slight_bend;
}

/// Ends the waiting moves at a point and returns them.
CompensatedMoves end_waiting(RadiusCompensation& compensation, FlatPoint end) {
    if (compensation.waiting.empty()) return {};
    const bool turned = turns_round(compensation, end);
    CompensatedMoves moves = std::move(compensation.waiting);
    compensation.waiting.clear();
    moves.front().turned_round = turned;
    for (CompensatedMove& move : moves) move.end = end;
    compensation.reached = end;
    return moves;
}

/// The check of LinuxCNC at inside corners and at G40: the waiting move must keep its direction.
/// The entry is exempt.
core::Result<void> check_direction(const RadiusCompensation& compensation, FlatPoint end) {
    if (compensation.waiting.empty() || compensation.entering || !turns_round(compensation, end))
        return {};
    return refusal(
        compensation.waiting_where,
        fmt::format(
            "the tool, radius {:g} mm, does not fit along this move: the inside corners at its "
            "ends take up more than its whole length; use a smaller tool or a longer move{}",
            compensation.radius,
            compensation.extends_corners ? "; the control stops with an alarm (PS0041 on Fanuc)"
                                         : ""));
}

/// Makes a move the waiting one. Its end is preliminary until the next move is known.
void wait_with(RadiusCompensation& compensation, const ContourMove& move, FlatPoint tool_end,
               const std::optional<FlatArc>& arc) {
    compensation.waiting.push_back(
        {.id = move.id, .rapid = move.rapid, .end = tool_end, .arc = arc});
    compensation.waiting_way = move.end - compensation.programmed;
    compensation.waiting_angle =
        arc ? turned_angle(*move.arc, compensation.programmed, move.end) : 0.0;
    compensation.waiting_where = move.where;
    compensation.programmed = move.end;
    compensation.tool = tool_end;
}

/// The circle through the start of the tool that has the tangent of the programmed arc at the end.
std::optional<FlatArc> entry_arc(FlatPoint start, FlatPoint end, const FlatArc& programmed) {
    const FlatPoint to_centre = direction(programmed.centre - end);
    const FlatPoint chord = start - end;
    const double reach = dot(chord, to_centre);
    if (std::abs(reach) < 1e-6 * length(chord)) return {};
    return FlatArc{end + (0.5 * dot(chord, chord) / reach) * to_centre, programmed.turns};
}

core::Result<void> check_fit(const RadiusCompensation& compensation, const ContourMove& move) {
    if (!move.arc || !is_inside(compensation.side, *move.arc)) return {};
    const double radius = length(move.end - move.arc->centre);
    if (radius > compensation.radius) return {};
    return refusal(move.where, fmt::format("the tool, radius {:g} mm, does not fit inside this arc "
                                           "of radius {:g} mm; use a smaller tool or a larger arc",
                                           compensation.radius, radius));
}

void add_straight(CompensatedMoves& moves, const ContourMove& move, FlatPoint end) {
    moves.push_back(
        {.id = move.id, .rapid = move.rapid, .rounds_corner = true, .end = end, .arc = {}});
}

/// Fanuc, type C: after G41 or G42 alone, the tool shifts to the offset start point of the first
/// move, at right angles to it.
core::Result<CompensatedMoves> enter_upright(RadiusCompensation& compensation,
                                             const ContourMove& move) {
    if (auto fits = check_fit(compensation, move); !fits) return tl::unexpected(fits.error());
    const FlatPoint at = compensation.programmed;
    const FlatPoint leaving = move.arc ? tangent(*move.arc, at) : direction(move.end - at);
    const FlatPoint heading = move.arc ? tangent(*move.arc, move.end) : leaving;
    CompensatedMoves moves;
    compensation.reached = at + offset_from(compensation, leaving);
    add_straight(moves, move, compensation.reached);
    wait_with(compensation, move, move.end + offset_from(compensation, heading), move.arc);
    compensation.entered = true;
    return moves;
}

/// On Fanuc the entry ends at the offset start point of the next move.
core::Result<CompensatedMoves> enter_straight(RadiusCompensation& compensation,
                                              const ContourMove& move) {
    if (compensation.enters_upright) return enter_upright(compensation, move);
    if (move.arc)
        return refusal(move.where,
                       "the first move with cutter radius compensation must be a straight line; "
                       "the control stops with an alarm (PS0034 on Fanuc)");
    const FlatPoint heading = direction(move.end - compensation.programmed);
    wait_with(compensation, move, move.end + offset_from(compensation, heading), {});
    compensation.entered = compensation.entering = true;
    return CompensatedMoves{};
}

core::Result<CompensatedMoves> enter(RadiusCompensation& compensation, const ContourMove& move) {
    if (compensation.extends_corners) return enter_straight(compensation, move);
    const double way = length(move.end - compensation.programmed);
    if (way <= compensation.radius)
        return refusal(
            move.where,
            fmt::format(
                "the first move with cutter radius compensation must be longer in the plane than "
                "the tool radius of {:g} mm, but is {:g} mm long; start farther from the contour",
                compensation.radius, way));
    if (auto fits = check_fit(compensation, move); !fits) return tl::unexpected(fits.error());
    const FlatPoint heading =
        move.arc ? tangent(*move.arc, move.end) : direction(move.end - compensation.programmed);
    const FlatPoint end = move.end + offset_from(compensation, heading);
    std::optional<FlatArc> arc;
    if (move.arc) {
        arc = entry_arc(compensation.programmed, end, *move.arc);
        if (!arc)
            return refusal(move.where, "no arc from here leads onto this arc with cutter radius "
                                       "compensation; enter with a straight move");
    }
    wait_with(compensation, move, end, arc);
    if (arc) {
        // A circle that curves the other way passes the end against the programmed direction.
        const bool against = dot(arc->centre - end, move.arc->centre - end) < 0.0;
        compensation.waiting_angle = against ? -1.0 : turned_angle(*arc, compensation.reached, end);
    }
    compensation.entered = true;
    compensation.entering = true;
    return CompensatedMoves{};
}

/// Outside corner on Fanuc: straight on along both tangents to their intersection or, where the
/// contour turns back by more than a right angle, by the tool radius and then straight across.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, 6.6.3, "Tool movement around the outside of a
///         corner", linear connection (parameter 19607#2 = 0).
core::Result<CompensatedMoves> pass_straight(RadiusCompensation& compensation, const Corner& corner,
                                             const ContourMove& move) {
    const double cosine = dot(corner.arriving, corner.leaving);
    const bool sharp = cosine < 0.0;
    const double beyond = sharp ? compensation.radius
                                : compensation.radius * std::sqrt((1.0 - cosine) / (1.0 + cosine));
    const FlatPoint out = corner.tool_arriving + beyond * corner.arriving;
    const FlatPoint back = corner.tool_leaving - beyond * corner.leaving;
    const bool after_arc = compensation.waiting.front().arc.has_value();
    const FlatPoint end = after_arc ? corner.tool_arriving : out;
    if (auto checked = check_direction(compensation, end); !checked)
        return tl::unexpected(checked.error());
    CompensatedMoves moves = end_waiting(compensation, end);
    if (after_arc) add_straight(moves, move, out);
    if (sharp) add_straight(moves, move, back);
    if (move.arc) add_straight(moves, move, corner.tool_leaving);
    compensation.reached = move.arc ? corner.tool_leaving : sharp ? back : out;
    return moves;
}

/// Outside corner on LinuxCNC: an arc; a straight line if a rapid follows.
CompensatedMoves pass_round(RadiusCompensation& compensation, const Corner& corner,
                            const ContourMove& move) {
    CompensatedMoves moves = end_waiting(compensation, corner.tool_arriving);
    add_straight(moves, move, corner.tool_leaving);
    const int turns = compensation.side == ContourSide::left ? -1 : 1;
    if (!move.rapid) moves.back().arc = FlatArc{corner.at, turns};
    compensation.reached = corner.tool_leaving;
    return moves;
}

/// Outside corner on Siemens with G450, and beyond the limit of G451: an arc about the corner.
core::Result<CompensatedMoves> pass_in_arc(RadiusCompensation& compensation, const Corner& corner,
                                           const ContourMove& move) {
    if (auto checked = check_direction(compensation, corner.tool_arriving); !checked)
        return tl::unexpected(checked.error());
    CompensatedMoves moves = pass_round(compensation, corner, move);
    moves.back().is_in_doubt = move.rapid; // an arc, or straight across
    return moves;
}

/// Outside corner on Siemens with G451: the intersection of the offset paths. Where one of them is
/// an arc, the control may continue it instead of its tangent.
core::Result<CompensatedMoves> pass_at_intersection(RadiusCompensation& compensation,
                                                    const Corner& corner, const ContourMove& move) {
    const double cosine = dot(corner.arriving, corner.leaving);
    if (core::acos(std::clamp(cosine, -1.0, 1.0)) > compensation.outside.limit)
        return pass_in_arc(compensation, corner, move);
    const double beyond = compensation.radius * std::sqrt((1.0 - cosine) / (1.0 + cosine));
    const FlatPoint out = corner.tool_arriving + beyond * corner.arriving;
    const bool after_arc = compensation.waiting.front().arc.has_value();
    const FlatPoint end = after_arc ? corner.tool_arriving : out;
    if (auto checked = check_direction(compensation, end); !checked)
        return tl::unexpected(checked.error());
    CompensatedMoves moves = end_waiting(compensation, end);
    if (after_arc) add_straight(moves, move, out);
    if (move.arc) add_straight(moves, move, corner.tool_leaving);
    moves.back().is_in_doubt = after_arc || move.arc;
    compensation.reached = move.arc ? corner.tool_leaving : out;
    return moves;
}

core::Result<CompensatedMoves> pass_outside(RadiusCompensation& compensation, const Corner& corner,
                                            const ContourMove& move) {
    switch (compensation.outside.kind) {
    case OutsideCorner::rounded:
        return pass_in_arc(compensation, corner, move);
    case OutsideCorner::met:
        return pass_at_intersection(compensation, corner, move);
    default:
        return pass_straight(compensation, corner, move);
    }
}

/// Ends the waiting moves where the contour continues straight or bends towards the tool.
core::Result<CompensatedMoves> stay_inside(RadiusCompensation& compensation, const Corner& corner,
                                           Bend bend, const ContourMove& move) {
    FlatPoint met = corner.tool_arriving;
    if (bend == Bend::inside) {
        const auto both = touching_both(compensation, corner, move);
        if (!both)
            return refusal(
                move.where,
                fmt::format("the tool, radius {:g} mm, does not fit into the inside corner at the "
                            "start of this move; use a smaller tool or round the corner",
                            compensation.radius));
        met = *both;
    }
    if (bend == Bend::inside || compensation.extends_corners)
        if (auto checked = check_direction(compensation, met); !checked)
            return tl::unexpected(checked.error());
    return end_waiting(compensation, met);
}

/// Ends the waiting moves so that the tool is at the start of the next move.
core::Result<CompensatedMoves> join(RadiusCompensation& compensation, const Corner& corner,
                                    const ContourMove& move) {
    const Bend bend = bend_of(compensation, corner, move);
    if (compensation.extends_corners && compensation.entering) {
        const bool passes = compensation.extends_ends && bend == Bend::outside;
        FEELER_TRY(CompensatedMoves moves,
                   passes ? pass_straight(compensation, corner, move)
                          : CompensatedMoves(end_waiting(compensation, corner.tool_leaving)));
        moves.front().turned_round = false; // an entry may have any direction
        return moves;
    }
    if (bend != Bend::outside) return stay_inside(compensation, corner, bend, move);
    if (compensation.extends_corners) return pass_outside(compensation, corner, move);
    if (!move.arc)
        if (auto checked = check_direction(compensation, corner.tool_arriving); !checked)
            return tl::unexpected(checked.error());
    return pass_round(compensation, corner, move);
}

core::Result<CompensatedMoves> go_on(RadiusCompensation& compensation, const ContourMove& move) {
    if (auto fits = check_fit(compensation, move); !fits) return tl::unexpected(fits.error());
    const Corner corner = corner_before(compensation, move);
    FEELER_TRY(const CompensatedMoves moves, join(compensation, corner, move));
    const FlatPoint heading = move.arc ? tangent(*move.arc, move.end) : corner.leaving;
    wait_with(compensation, move, move.end + offset_from(compensation, heading), move.arc);
    compensation.entering = false;
    return moves;
}

} // namespace

RadiusCompensation begin_compensation(ContourSide side, double radius, FlatPoint at) {
    if (radius < 0.0) side = side == ContourSide::left ? ContourSide::right : ContourSide::left;
    return {.side = side, .radius = std::abs(radius), .programmed = at, .tool = at, .reached = at};
}

core::Result<CompensatedMoves> add_move(RadiusCompensation& compensation, const ContourMove& move) {
    RadiusCompensation next = compensation;
    core::Result<CompensatedMoves> moves;
    const bool goes_nowhere = !move.arc && move.end == compensation.programmed;
    if (!compensation.entered && goes_nowhere && compensation.extends_corners) {
        moves = CompensatedMoves{
            {.id = move.id, .rapid = move.rapid, .end = compensation.tool, .arc = {}}};
    } else if (!compensation.entered) {
        moves = enter(next, move);
    } else if (goes_nowhere) {
        next.waiting.push_back({.id = move.id, .rapid = move.rapid, .end = next.tool, .arc = {}});
    } else {
        moves = go_on(next, move);
    }
    if (moves) compensation = std::move(next);
    return moves;
}

core::Result<CompensatedMoves> end_compensation(RadiusCompensation& compensation,
                                                const ContourMove* exit) {
    const bool leaves = exit && !compensation.waiting.empty() && !compensation.entering
                        && !exit->arc && !(exit->end == compensation.programmed);
    if (compensation.extends_ends && leaves) {
        const Corner corner = corner_before(compensation, *exit);
        if (bend_of(compensation, corner, *exit) == Bend::outside)
            return pass_straight(compensation, corner, *exit);
    }
    if (auto checked = check_direction(compensation, compensation.tool); !checked)
        return tl::unexpected(checked.error());
    return end_waiting(compensation, compensation.tool);
}

} // namespace gcode
