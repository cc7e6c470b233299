#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "core/base/math.h"

namespace gcode {

/// A point or a displacement in the working plane, mm along its first and second axis.
struct FlatPoint {
    double u = 0.0, v = 0.0;

    bool operator==(const FlatPoint&) const = default;
};

constexpr FlatPoint operator+(FlatPoint a, FlatPoint b) { return {a.u + b.u, a.v + b.v}; }
constexpr FlatPoint operator-(FlatPoint a, FlatPoint b) { return {a.u - b.u, a.v - b.v}; }
constexpr FlatPoint operator*(double factor, FlatPoint a) { return {factor * a.u, factor * a.v}; }
constexpr double dot(FlatPoint a, FlatPoint b) { return a.u * b.u + a.v * b.v; }
constexpr double cross(FlatPoint a, FlatPoint b) { return a.u * b.v - a.v * b.u; }
inline double length(FlatPoint a) { return core::hypot(a.u, a.v); }
inline FlatPoint direction(FlatPoint a) { return (1.0 / length(a)) * a; }

/// The displacement turned 90 degrees counterclockwise.
constexpr FlatPoint left_of(FlatPoint a) { return {-a.v, a.u}; }

/// An arc without its start and end.
struct FlatArc {
    FlatPoint centre;
    int turns = 0; // as in LinuxCNC: +1 up to one turn counterclockwise, -2 up to two clockwise

    bool operator==(const FlatArc&) const = default;
};

/// The direction of an arc at one of its points.
inline FlatPoint tangent(const FlatArc& arc, FlatPoint at) {
    const FlatPoint to_left = left_of(direction(at - arc.centre));
    return arc.turns > 0 ? to_left : -1.0 * to_left;
}

/// The angle of an arc between two of its points, radians, never negative.
double turned_angle(const FlatArc& arc, FlatPoint start, FlatPoint end);

/// The two intersections of two paths. They are equal where the paths are tangent.
struct Crossings {
    FlatPoint first, second;
};

/// The intersections of an infinite line and a circle; `first` comes first along the line.
/// Result: empty if there are none.
std::optional<Crossings> cross_line_and_circle(FlatPoint through, FlatPoint way, FlatPoint centre,
                                               double radius);

/// The intersections of two circles; `first` is to the left of the line from `centre` to
/// `other_centre`.
/// Result: empty if there are none, and for concentric circles.
std::optional<Crossings> cross_circles(FlatPoint centre, double radius, FlatPoint other_centre,
                                       double other_radius);

/// One of the two motions of a corner: straight, or an arc of up to one turn.
struct CornerSide {
    FlatPoint start, end;
    std::optional<FlatArc> arc{};

    bool operator==(const CornerSide&) const = default;
};

enum class CornerKind : uint8_t { rounding, chamfer };

enum class CornerFit : uint8_t {
    fits,
    no_length,   // one of the motions has no length
    straight_on, // there is no corner
    none,        // no corner of that size touches both motions
    too_large,   // the cut is longer than one of the motions
};

/// The rounding or chamfer that replaces a corner.
struct CornerCut {
    CornerFit fit = CornerFit::none;
    FlatPoint from, to;           // where it leaves the first motion and reaches the second
    std::optional<FlatArc> arc{}; // of a rounding
    FlatPoint heading;            // at its end, unit length
    bool takes_first = false;     // the first motion vanishes completely
    bool takes_second = false;
};

/// The rounding tangent to both motions, or the chamfer between the points on them at the
/// straight-line distance `size` from the corner.
CornerCut cut_corner(const CornerSide& first, const CornerSide& second, CornerKind kind,
                     double size);

/// Unit direction of a motion at one of its points.
FlatPoint heading_at(const CornerSide& side, FlatPoint at);

/// Whether a motion has a length; always true for an arc.
bool has_length(const CornerSide& side);

/// The change of direction at a corner, from 0 (straight on) to pi (reversal).
double bend_between(const CornerSide& first, const CornerSide& second);

/// Whether an arc is a full circle follows from the distance of its ends: LinuxCNC 2.9 takes 1e-8
/// of its unit (CART_FUZZ), other controls compare them. Between these two distances that is not
/// certain, as lengths are converted and rounded; mm.
inline constexpr double same_end = 0.5e-8, other_end = 5e-7;

/// The angle of an arc, radians; positive if counter-clockwise as seen against the normal of the
/// plane.
inline double arc_angle(const double (&start)[2], const double (&end)[2], const double (&centre)[2],
                        int turns) {
    constexpr double full_turn = 2.0 * std::numbers::pi;
    const double start_angle = core::atan2(start[1] - centre[1], start[0] - centre[0]);
    const double end_angle = core::atan2(end[1] - centre[1], end[0] - centre[0]);
    const double sign = turns < 0 ? -1.0 : 1.0;
    double angle = sign * (end_angle - start_angle);
    if (angle < 0.0) angle += full_turn;
    if (core::hypot(end[0] - start[0], end[1] - start[1]) < same_end) angle = full_turn;
    return sign * (angle + full_turn * (std::abs(turns) - 1));
}

} // namespace gcode
