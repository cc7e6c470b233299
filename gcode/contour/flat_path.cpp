#include "gcode/contour/flat_path.h"

#include <cmath>
#include <numbers>

#include "core/base/math.h"

namespace gcode {

double turned_angle(const FlatArc& arc, FlatPoint start, FlatPoint end) {
    return std::abs(
        arc_angle({start.u, start.v}, {end.u, end.v}, {arc.centre.u, arc.centre.v}, arc.turns));
}

std::optional<Crossings> cross_line_and_circle(FlatPoint through, FlatPoint way, FlatPoint centre,
                                               double radius) {
    const FlatPoint along = direction(way);
    const double foot = dot(centre - through, along);
    const double distance = cross(along, centre - through);
    if (std::abs(distance) > radius) return {};
    const double half = std::sqrt((radius - distance) * (radius + distance));
    return Crossings{through + (foot - half) * along, through + (foot + half) * along};
}

std::optional<Crossings> cross_circles(FlatPoint centre, double radius, FlatPoint other_centre,
                                       double other_radius) {
    const FlatPoint way = other_centre - centre;
    const double apart = length(way);
    if (apart == 0.0 || apart > radius + other_radius || apart < std::abs(radius - other_radius))
        return {};
    const FlatPoint along = direction(way);
    const double foot = 0.5 * (apart + (radius - other_radius) * (radius + other_radius) / apart);
    const double half = std::sqrt(std::max(0.0, (radius - foot) * (radius + foot)));
    const FlatPoint middle = centre + foot * along;
    return Crossings{middle + half * left_of(along), middle - half * left_of(along)};
}

namespace {

constexpr double fuzz = 1e-9;

/// The point on a motion's line or circle nearest to another point.
FlatPoint nearest_on(const CornerSide& side, FlatPoint to) {
    if (!side.arc) {
        const FlatPoint along = heading_at(side, side.start);
        return side.start + dot(to - side.start, along) * along;
    }
    const FlatPoint& centre = side.arc->centre;
    return centre + length(side.start - centre) * direction(to - centre);
}

/// The parameter of a point along the motion: 0 at its start, 1 at its end.
double fraction_of(const CornerSide& side, FlatPoint at) {
    if (!side.arc) {
        const FlatPoint way = side.end - side.start;
        return dot(at - side.start, way) / dot(way, way);
    }
    const int turn = side.arc->turns > 0 ? 1 : -1;
    const auto angle_to = [&](FlatPoint to) {
        const FlatPoint a = side.start - side.arc->centre, b = to - side.arc->centre;
        const double angle = turn * core::atan2(cross(a, b), dot(a, b));
        return angle < -fuzz ? angle + 2.0 * std::numbers::pi : angle;
    };
    const double whole = angle_to(side.end);
    return angle_to(at) / (whole < fuzz ? 2.0 * std::numbers::pi : whole);
}

/// A line or circle parallel to a motion, offset to the left; to the right if the distance is
/// negative.
struct OffsetSide {
    bool is_line;
    FlatPoint point; // of the line, or the centre
    FlatPoint along; // of the line
    double radius;
};

OffsetSide offset_side(const CornerSide& side, double distance) {
    if (!side.arc) {
        const FlatPoint along = heading_at(side, side.start);
        return {true, side.start + distance * left_of(along), along, 0.0};
    }
    const double turn = side.arc->turns > 0 ? 1.0 : -1.0;
    const double radius = length(side.start - side.arc->centre);
    return {false, side.arc->centre, {}, radius - turn * distance};
}

FlatPoint nearer(const Crossings& crossings, FlatPoint to) {
    const bool first = length(crossings.first - to) <= length(crossings.second - to);
    return first ? crossings.first : crossings.second;
}

/// The intersection of two offset curves that is nearest to the corner.
std::optional<FlatPoint> meeting_point(const OffsetSide& a, const OffsetSide& b, FlatPoint corner) {
    if (a.is_line && b.is_line) {
        const double sine = cross(a.along, b.along);
        if (std::abs(sine) < fuzz) return std::nullopt;
        return a.point + (cross(b.point - a.point, b.along) / sine) * a.along;
    }
    if (b.is_line) return meeting_point(b, a, corner);
    if (a.radius < 0.0 || b.radius < 0.0) return std::nullopt;
    const auto crossings = a.is_line ? cross_line_and_circle(a.point, a.along, b.point, b.radius)
                                     : cross_circles(a.point, a.radius, b.point, b.radius);
    if (!crossings) return std::nullopt;
    return nearer(*crossings, corner);
}

bool round_off(const CornerSide& first, const CornerSide& second, double radius, CornerCut& cut) {
    const double sine = cross(heading_at(first, first.end), heading_at(second, second.start));
    if (std::abs(sine) < fuzz) return false;
    const int turn = sine > 0.0 ? 1 : -1;
    const auto centre = meeting_point(offset_side(first, turn * radius),
                                      offset_side(second, turn * radius), first.end);
    if (!centre) return false;
    cut.from = nearest_on(first, *centre);
    cut.to = nearest_on(second, *centre);
    cut.arc = FlatArc{*centre, turn};
    return true;
}

/// The point on a motion at a distance from the corner, before or after it.
std::optional<FlatPoint> point_away(const CornerSide& side, FlatPoint corner, double distance,
                                    bool before) {
    const FlatPoint along = (before ? -1.0 : 1.0) * heading_at(side, corner);
    if (!side.arc) return corner + distance * along;
    const auto crossings =
        cross_circles(corner, distance, side.arc->centre, length(corner - side.arc->centre));
    if (!crossings) return std::nullopt;
    return dot(crossings->first - corner, along) > 0.0 ? crossings->first : crossings->second;
}

bool chamfer_off(const CornerSide& first, const CornerSide& second, double size, CornerCut& cut) {
    const auto from = point_away(first, first.end, size, true);
    const auto to = point_away(second, second.start, size, false);
    if (!from || !to) return false;
    cut.from = *from;
    cut.to = *to;
    return true;
}

} // namespace

FlatPoint heading_at(const CornerSide& side, FlatPoint at) {
    return side.arc ? tangent(*side.arc, at) : direction(side.end - side.start);
}

bool has_length(const CornerSide& side) { return side.arc || length(side.end - side.start) > fuzz; }

double bend_between(const CornerSide& first, const CornerSide& second) {
    const FlatPoint in = heading_at(first, first.end), out = heading_at(second, second.start);
    return std::abs(core::atan2(cross(in, out), dot(in, out)));
}

CornerCut cut_corner(const CornerSide& first, const CornerSide& second, CornerKind kind,
                     double size) {
    CornerCut cut;
    if (!has_length(first) || !has_length(second)) {
        cut.fit = CornerFit::no_length;
        return cut;
    }
    const bool found = kind == CornerKind::rounding ? round_off(first, second, size, cut)
                                                    : chamfer_off(first, second, size, cut);
    if (!found) {
        const bool straight = bend_between(first, second) < fuzz;
        cut.fit =
            straight && kind == CornerKind::rounding ? CornerFit::straight_on : CornerFit::none;
        return cut;
    }
    const double left = fraction_of(first, cut.from), reached = fraction_of(second, cut.to);
    const auto is_inside = [](double fraction) {
        return fraction > -fuzz && fraction < 1.0 + fuzz;
    };
    cut.fit = is_inside(left) && is_inside(reached) ? CornerFit::fits : CornerFit::too_large;
    cut.heading = heading_at(second, cut.to);
    cut.takes_first = left < fuzz;
    cut.takes_second = reached > 1.0 - fuzz;
    return cut;
}

} // namespace gcode
