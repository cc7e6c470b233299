#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace gcode {

/// A point or a way in the working plane, mm along its first and second axis.
struct FlatPoint {
    double u = 0.0, v = 0.0;

    bool operator==(const FlatPoint&) const = default;
};

constexpr FlatPoint operator+(FlatPoint a, FlatPoint b) { return {a.u + b.u, a.v + b.v}; }
constexpr FlatPoint operator-(FlatPoint a, FlatPoint b) { return {a.u - b.u, a.v - b.v}; }
constexpr FlatPoint operator*(double factor, FlatPoint a) { return {factor * a.u, factor * a.v}; }
constexpr double dot(FlatPoint a, FlatPoint b) { return a.u * b.u + a.v * b.v; }
constexpr double cross(FlatPoint a, FlatPoint b) { return a.u * b.v - a.v * b.u; }
inline double length(FlatPoint a) { return std::hypot(a.u, a.v); }
inline FlatPoint direction(FlatPoint a) { return (1.0 / length(a)) * a; }

/// The way turned a quarter to the left (counter-clockwise).
constexpr FlatPoint left_of(FlatPoint a) { return {-a.v, a.u}; }

/// What makes a path an arc rather than a straight line.
struct FlatArc {
    FlatPoint centre;
    int turns = 0; // as LinuxCNC: +1 up to one turn counter-clockwise, -2 up to two clockwise

    bool operator==(const FlatArc&) const = default;
};

/// The direction in which an arc passes a point that lies on it.
inline FlatPoint tangent(const FlatArc& arc, FlatPoint at) {
    const FlatPoint to_left = left_of(direction(at - arc.centre));
    return arc.turns > 0 ? to_left : -1.0 * to_left;
}

/// The angle an arc turns through between two points, radians, never negative.
double turned_angle(const FlatArc& arc, FlatPoint start, FlatPoint end);

/// Two points in which paths cross. They are one point, twice, where the paths touch.
struct Crossings {
    FlatPoint first, second;
};

/// Where a straight line without ends meets a circle; `first` comes first along the way.
/// Result: empty where they do not meet.
std::optional<Crossings> cross_line_and_circle(FlatPoint through, FlatPoint way, FlatPoint centre,
                                               double radius);

/// Where two circles meet; `first` lies to the left of the way from centre to centre.
/// Result: empty where they do not meet, and for circles of one centre.
std::optional<Crossings> cross_circles(FlatPoint centre, double radius, FlatPoint other_centre,
                                       double other_radius);

/// A motion that meets another in a corner: straight, or along an arc of up to one turn.
struct CornerSide {
    FlatPoint start, end;
    std::optional<FlatArc> arc{};

    bool operator==(const CornerSide&) const = default;
};

enum class CornerKind : uint8_t { rounding, chamfer };

enum class CornerFit : uint8_t {
    fits,
    no_length,   // one of the motions goes nowhere
    straight_on, // there is no corner to round
    none,        // nothing of that size touches both motions
    too_large,   // it takes more than one of the motions has
};

/// What stands in the place of a corner.
struct CornerCut {
    CornerFit fit = CornerFit::none;
    FlatPoint from, to;           // where it leaves the first motion and reaches the second
    std::optional<FlatArc> arc{}; // of a rounding
    FlatPoint heading;            // at its end, of length 1
    bool takes_first = false;     // nothing is left of the first motion
    bool takes_second = false;
};

/// The rounding that touches both motions, or the chamfer between two points of them that are
/// `size` away from the corner as the crow flies.
CornerCut cut_corner(const CornerSide& first, const CornerSide& second, CornerKind kind,
                     double size);

/// The direction of a motion at one of its points, of length 1.
FlatPoint heading_at(const CornerSide& side, FlatPoint at);

/// Whether a motion goes anywhere: a straight one to another place, an arc always.
bool has_length(const CornerSide& side);

/// How far a corner bends, from 0 (straight on) to pi (back again).
double bend_between(const CornerSide& first, const CornerSide& second);

} // namespace gcode
