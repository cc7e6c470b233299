#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "core/base/math.h"
#include "core/base/vec.h"
#include "core/dbm/cutter.h"
#include "core/dbm/interval.h"

namespace core {

/// A range of a parameter: of a motion or of a line.
struct Range {
    double first, last;

    bool empty() const { return !(first < last); }
    double clamp(double t) const { return std::clamp(t, first, last); }
};

/// A linear function of time: at + t * by.
struct Linear {
    double at, by;

    double operator()(double t) const { return at + t * by; }
};

/// Where `f` is not negative, within `range`.
inline Range where_not_negative(const Linear& f, Range range) {
    if (f.by == 0.0) return f.at >= 0.0 ? range : Range{1.0, 0.0};
    const double root = -f.at / f.by;
    if (f.by > 0.0) return {std::max(range.first, root), range.last};
    return {range.first, std::min(range.last, root)};
}

/// a t^2 + 2 b t + c.
struct Quadratic {
    double a, b, c;

    double operator()(double t) const { return (a * t + 2.0 * b) * t + c; }
};

/// The zeros of q, lower one first, from its discriminant >= 0. Nothing cancels, so that a very
/// small `a` does no harm; a missing zero (a = 0) is infinite.
inline Range zeros(const Quadratic& q, double discriminant) {
    const double far = -q.b - std::copysign(std::sqrt(discriminant), q.b);
    if (far == 0.0) return {0.0, 0.0};
    const double one = far / q.a, other = q.c / far;
    return {std::min(one, other), std::max(one, other)};
}

/// Where q <= 0, for a >= 0, within `range`.
inline Range where_not_positive(const Quadratic& q, Range range) {
    if (q.a == 0.0) return where_not_negative({-q.c, -2.0 * q.b}, range);
    const double discriminant = q.b * q.b - q.a * q.c;
    if (discriminant < 0.0) return {1.0, 0.0};
    const Range below = zeros(q, discriminant);
    return {std::max(range.first, below.first), std::min(range.last, below.last)};
}

/// The least and the greatest value over the candidates.
struct Extent {
    double least = infinity, greatest = -infinity;

    void add(double low, double high) {
        least = std::min(least, low);
        greatest = std::max(greatest, high);
    }
    std::optional<Interval> interval() const {
        if (!(least < greatest)) return std::nullopt;
        return Interval{least, greatest};
    }
};

inline Quadratic squared(const Linear& f) { return {f.by * f.by, f.at * f.by, f.at * f.at}; }

inline Quadratic operator+(const Quadratic& p, const Quadratic& q) {
    return {p.a + q.a, p.b + q.b, p.c + q.c};
}

inline Quadratic operator-(const Quadratic& p, const Quadratic& q) {
    return {p.a - q.a, p.b - q.b, p.c - q.c};
}

namespace {

/// The length of a vector in the plane. Unlike std::hypot it may overflow, and it is five times
/// faster.
double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

/// Half the chord of a circle at a distance from its centre; at a cone's tip, both may be rounding
/// errors.
double half_chord(double radius, double away) {
    return std::sqrt(std::max(0.0, (radius - away) * (radius + away)));
}

/// The extent of along(t) -+ half(t) over `range`, where half is the root of `under` and concave:
/// ends and stationary points. Every candidate is a point of the swept volume, so no segment is
/// too long.
template <typename Half>
std::optional<Interval> extent_with_root(const Linear& along, const Quadratic& under,
                                         const Half& half, Range range) {
    if (range.empty() && range.first != range.last) return std::nullopt;
    Extent extent;
    const auto offer = [&](double t) {
        const double middle = along(t), reach = half(t);
        extent.add(middle - reach, middle + reach);
    };
    offer(range.first);
    offer(range.last);
    // Stationary where (a t + b)^2 = k (a t^2 + 2 b t + c), k = by^2. The discriminant of this is k
    // (k - a) (b^2 - a c); multiplied out, it would be only rounding error if k is 0, which holds
    // for every line across the motion. Its last factor is positive where the root is concave.
    const double k = along.by * along.by;
    const Quadratic stationary{under.a * (under.a - k), under.b * (under.a - k),
                               under.b * under.b - k * under.c};
    const double bend = std::max(0.0, under.b * under.b - under.a * under.c);
    if (k >= under.a) {
        const Range at = zeros(stationary, k * (k - under.a) * bend);
        offer(range.clamp(at.first));
        offer(range.clamp(at.last));
    }
    return extent.interval();
}

/// Common to all cases: the position of the line relative to the moving origin, axis by axis.
struct LineMotion {
    std::array<Linear, 3> offset; // on `axis`: minus the origin's position; else line minus origin

    LineMotion(const ElementSweep& sweep, int axis, double u, double v) {
        const std::array<double, 3> line = {0.0, u, v};
        for (int k = 0; k < 3; ++k) {
            const int world = (axis + k) % 3;
            offset[static_cast<size_t>(world)] = {line[static_cast<size_t>(k)] - sweep.from[world],
                                                  -(sweep.to[world] - sweep.from[world])};
        }
    }
    const Linear& operator[](int axis) const { return offset[static_cast<size_t>(axis)]; }
};

constexpr Range whole_motion{0.0, 1.0};

/// A ball: the line's distance from the moving centre is the root of a quadratic.
std::optional<Interval> ball_interval(const ElementSweep& sweep, int axis, double u, double v) {
    ElementSweep centred = sweep;
    centred.from.z += sweep.element.z0;
    centred.to.z += sweep.element.z0;
    const LineMotion line(centred, axis, u, v);
    const double r = sweep.element.margin;
    const Quadratic across = squared(line[(axis + 1) % 3]) + squared(line[(axis + 2) % 3]);
    const Quadratic outside = {across.a, across.b, across.c - r * r};
    const Range range = where_not_positive(outside, whole_motion);
    if (range.first > range.last) return std::nullopt;
    const Linear along{-line[axis].at, -line[axis].by};
    const auto half = [&](double t) {
        return half_chord(r, length_of(line[(axis + 1) % 3](t), line[(axis + 2) % 3](t)));
    };
    return extent_with_root(along, {-outside.a, -outside.b, -outside.c}, half, range);
}

/// A truncated cone crossed by a line along X or Y: at each time a chord of the circle at its
/// height.
std::optional<Interval> cone_across(const ElementSweep& sweep, int axis, double u, double v) {
    const ProfileElement& e = sweep.element;
    const LineMotion line(sweep, axis, u, v);
    const Linear& height = line[2];
    Range range = where_not_negative({height.at - e.z0, height.by}, whole_motion);
    range = where_not_negative({e.z1 - height.at, -height.by}, range);
    if (range.first > range.last || !(e.z0 < e.z1)) return std::nullopt;
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    const Linear radius{e.r0 + slope * (height.at - e.z0), slope * height.by};
    const Linear& side = line[1 - axis];
    range = where_not_negative({radius.at - side.at, radius.by - side.by}, range);
    range = where_not_negative({radius.at + side.at, radius.by + side.by}, range);
    if (range.first > range.last) return std::nullopt;
    const Linear along{-line[axis].at, -line[axis].by};
    const auto half = [&](double t) { return half_chord(radius(t), side(t)); };
    return extent_with_root(along, squared(radius) - squared(side), half, range);
}

/// Lower and upper end of a truncated cone at rest at a distance `r` from its axis, which may
/// exceed its largest radius only by rounding.
Interval cone_heights(const ProfileElement& e, double r) {
    Interval ends{e.z0, e.z1};
    if (e.r0 == e.r1) return ends;
    const double slant = std::clamp(e.z0 + (r - e.r0) * (e.z1 - e.z0) / (e.r1 - e.r0), e.z0, e.z1);
    if (r > e.r0) ends.lower = slant;
    if (r > e.r1) ends.upper = slant;
    return ends;
}

/// A truncated cone met by a line along Z. The lower end is convex in time, the upper concave, with
/// kinks where the line passes a rim.
std::optional<Interval> cone_along(const ElementSweep& sweep, double x, double y) {
    const ProfileElement& e = sweep.element;
    const LineMotion line(sweep, 2, x, y);
    const Quadratic across = squared(line[0]) + squared(line[1]);
    const auto inside = [&](double r) {
        return where_not_positive({across.a, across.b, across.c - r * r}, whole_motion);
    };
    const Range range = inside(std::max(e.r0, e.r1));
    if (range.first > range.last) return std::nullopt;

    Extent extent;
    const Linear rise{-line[2].at, -line[2].by};
    const auto offer = [&](double at) {
        const double t = range.clamp(at);
        const Interval ends = e.r0 == e.r1 ? Interval{e.z0, e.z1}
                                           : cone_heights(e, length_of(line[0](t), line[1](t)));
        extent.add(rise(t) + ends.lower, rise(t) + ends.upper);
    };
    offer(range.first);
    offer(range.last);
    if (e.r0 == e.r1 || across.a == 0.0) return extent.interval();
    const Range kinks = inside(std::min(e.r0, e.r1));
    if (kinks.first <= kinks.last) {
        offer(kinks.first);
        offer(kinks.last);
    }
    // On the slant: d/dt (rise + k sqrt(across)) = 0.
    const double k = (e.z1 - e.z0) / (e.r1 - e.r0);
    const double middle = -across.b / across.a;
    const double nearest = length_of(line[0](middle), line[1](middle));
    const double steepness = k * k * across.a - rise.by * rise.by;
    if (steepness > 0.0) {
        const double away = std::abs(rise.by) * nearest / std::sqrt(across.a * steepness);
        offer(middle - away);
        offer(middle + away);
    }
    return extent.interval();
}

/// How far beyond the disc the lowest point of a rounded corner is on a line along Z, if the tool
/// rises by `slope` per travel: where the normal of the corner, in the direction of travel, is
/// perpendicular to the motion. `nearest` is the distance of the line from the path, seen from
/// above.
double lowest_beyond(double radius, double margin, double nearest, double slope) {
    double low = std::max(0.0, nearest - radius), high = margin;
    double beyond = std::max(low, margin * slope / std::sqrt(1.0 + slope * slope));
    constexpr int rounds = 40;
    for (int i = 0; i < rounds; ++i) {
        const double away = radius + beyond;
        const double part = nearest / away;
        const double along = std::sqrt(std::max(0.0, (1.0 - part) * (1.0 + part)));
        const double half = half_chord(margin, beyond);
        const double excess = beyond * along - slope * half;
        (excess > 0.0 ? high : low) = beyond;
        const double bend = along + beyond * part * part / (away * along) + slope * beyond / half;
        double next = beyond - excess / bend;
        // Where a root vanishes, the step is far too short.
        const bool is_stuck = std::min(along, half / margin) < 1e-5;
        if (is_stuck || !(next > low && next < high)) next = 0.5 * (low + high);
        if (std::abs(next - beyond) <= 1e-9 * margin) return next;
        beyond = next;
    }
    return beyond;
}

/// A disc with a margin (the rounded corner of a bull nose) met by a line along Z. The lower end is
/// convex in time, the upper concave.
std::optional<Interval> round_along(const ElementSweep& sweep, double x, double y) {
    const ProfileElement& e = sweep.element;
    const LineMotion line(sweep, 2, x, y);
    const Quadratic across = squared(line[0]) + squared(line[1]);
    const double radius = std::max(e.r0, e.r1), widest = radius + e.margin;
    const Range range =
        where_not_positive({across.a, across.b, across.c - widest * widest}, whole_motion);
    if (range.first > range.last) return std::nullopt;

    Extent extent;
    const Linear rise{-line[2].at, -line[2].by};
    const auto offer = [&](double at) {
        const double t = range.clamp(at);
        const double beyond = std::max(0.0, length_of(line[0](t), line[1](t)) - radius);
        const double half = half_chord(e.margin, beyond);
        extent.add(rise(t) + e.z0 - half, rise(t) + e.z0 + half);
    };
    if (across.a == 0.0) {
        offer(range.first);
        offer(range.last);
        return extent.interval();
    }
    const double middle = -across.b / across.a;
    if (rise.by == 0.0) {
        offer(middle);
        return extent.interval();
    }
    const double travel = std::sqrt(across.a);
    const double nearest = std::min(length_of(line[0](middle), line[1](middle)), widest);
    const double away =
        radius + lowest_beyond(radius, e.margin, nearest, std::abs(rise.by) / travel);
    const double half_way = half_chord(away, nearest) / travel;
    offer(middle - half_way);
    offer(middle + half_way);
    return extent.interval();
}

/// A disc with a margin crossed by a line along X or Y.
std::optional<Interval> round_across(const ElementSweep& sweep, int axis, double u, double v) {
    const ProfileElement& e = sweep.element;
    // Most lines near a sweep miss it: the cylinder around the piece rules them out without a
    // search.
    const double widest = std::max(e.r0, e.r1) + e.margin;
    const ProfileElement round{e.z0 - e.margin, widest, e.z0 + e.margin, widest, 0.0};
    if (!cone_across({round, sweep.from, sweep.to}, axis, u, v)) return std::nullopt;
    return tilted_line_interval(sweep, Mat3(1.0), axis, u, v);
}

} // namespace

std::optional<Interval> line_interval(const ElementSweep& sweep, int axis, double u, double v) {
    const ProfileElement& e = sweep.element;
    if (e.margin > 0.0) {
        assert(e.z0 == e.z1);
        if (e.r0 == 0.0 && e.r1 == 0.0) return ball_interval(sweep, axis, u, v);
        return axis == 2 ? round_along(sweep, u, v) : round_across(sweep, axis, u, v);
    }
    if (axis == 2) return cone_along(sweep, u, v);
    return cone_across(sweep, axis, u, v);
}

namespace {

constexpr Range everywhere{-infinity, infinity};
constexpr Range nowhere{1.0, -1.0};

/// Points outside by at most this count as inside, mm. Otherwise, where two borders meet, rounding
/// could exclude the corner from both.
constexpr double slack = 1e-10;

bool holds_any(const Range& range) { return range.first <= range.last; }

/// The plane of (s, t): s along the line, t along the motion, both in mm. In the tool's frame the
/// point is p + s d - t m; the sweep contains it where that point is in the piece.
struct LineAndMotion {
    Vec3 p, d, m;  // d and m of length 1
    double length; // of the motion

    Vec3 at(double t) const { return p - t * m; }
};

/// s is counted from the position of the piece's origin at the start.
LineAndMotion line_and_motion(const ElementSweep& sweep, const Mat3& stock_from_tool, int axis,
                              double u, double v) {
    Vec3 p(0.0), d(0.0);
    p[(axis + 1) % 3] = u - sweep.from[(axis + 1) % 3];
    p[(axis + 2) % 3] = v - sweep.from[(axis + 2) % 3];
    d[axis] = 1.0;
    const Vec3 by = sweep.to - sweep.from;
    const double length = glm::length(by);
    const Vec3 m = length > 0.0 ? by / length : Vec3(0.0);
    const Mat3 tool_from_stock = glm::transpose(stock_from_tool);
    return {tool_from_stock * p, tool_from_stock * d, tool_from_stock * m, length};
}

/// A cone z0 <= z <= z1, x^2 + y^2 <= r(z)^2, with parameters that are common to all lines.
struct Cone {
    double z0, z1, r0, slope;

    explicit Cone(const ProfileElement& e)
        : z0(e.z0), z1(e.z1), r0(e.r0), slope((e.r1 - e.r0) / (e.z1 - e.z0)) {}

    /// A point or a direction as (x, y, radius); for a direction, z0 has no effect.
    Vec3 position(const Vec3& q) const { return {q.x, q.y, r0 + slope * (q.z - z0)}; }
    Vec3 direction(const Vec3& d) const { return {d.x, d.y, slope * d.z}; }
};

/// The form that is negative inside the cone: x x' + y y' - r r'.
double form(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y - a.z * b.z; }

/// Where a line through `at` crosses the flank, extended over both nappes; empty if it does not.
/// `at` is the point of the line nearest to the cone's origin.
Range flank_crossings(const Vec3& at, const Vec3& by) {
    const double a = form(by, by), b = form(at, by);
    if (std::abs(a) > 0.01 * glm::dot(by, by)) {
        // Counted from the middle of the two, so that there is no cancellation even at the cone's
        // tip.
        const double middle = -b / a;
        const Vec3 f = at + middle * by;
        const double away = length_of(f.x, f.y);
        const double square = -(away - f.z) * (away + f.z) / a;
        if (a > 0.0 && square < 0.0) return nowhere;
        const double half = std::sqrt(std::max(0.0, square));
        return {middle - half, middle + half};
    }
    const double away = length_of(at.x, at.y);
    const Quadratic outside{a, b, (away - at.z) * (away + at.z)};
    if (a == 0.0 && b == 0.0) return outside.c <= 0.0 ? everywhere : nowhere;
    const double bend = b * b - a * outside.c;
    if (a > 0.0 && bend < 0.0) return nowhere;
    if (a == 0.0) return where_not_positive(outside, everywhere);
    return zeros(outside, std::max(0.0, bend));
}

/// The range of s in the cone at one time of the motion.
Range chord_at(const LineAndMotion& line, const Cone& cone, double t) {
    const Vec3 position = line.at(t);
    // Counted from the foot of the perpendicular, so that distances along the line do not spoil the
    // square's accuracy.
    const double shift = -glm::dot(position, line.d);
    const Vec3 q = position + shift * line.d;
    Range range = where_not_negative({q.z - cone.z0 + slack, line.d.z}, everywhere);
    range = where_not_negative({cone.z1 - q.z + slack, -line.d.z}, range);
    const Vec3 at = cone.position(q), by = cone.direction(line.d);
    const Range flanks = flank_crossings(at, by);
    if (form(by, by) >= 0.0)
        range = {std::max(range.first, flanks.first), std::min(range.last, flanks.last)};
    else if (by.z > 0.0) // steeper than the flank: only one nappe belongs to the piece
        range.first = std::max(range.first, flanks.last);
    else
        range.last = std::min(range.last, flanks.first);
    return holds_any(range) ? Range{range.first + shift, range.last + shift} : nowhere;
}

/// The range of s in which the line passes through one of the piece's end faces, at any time.
Range through_face(const LineAndMotion& line, double z, double radius) {
    const double steep = length_of(line.d.z, line.m.z);
    const double rise = z - line.p.z;
    const double reach = 2.0 * (glm::length(line.p) + line.length + radius + std::abs(z));
    if (steep == 0.0 || std::abs(rise) > reach * steep) return nowhere;
    // The points of the plane at this height form a line: (s, t) = start + k * (m.z, d.z) / steep.
    const double s0 = rise / steep * (line.d.z / steep), t0 = -rise / steep * (line.m.z / steep);
    const double s_by = line.m.z / steep, t_by = line.d.z / steep;
    const Vec3 q = line.p + s0 * line.d - t0 * line.m, e = s_by * line.d - t_by * line.m;

    Range range = where_not_negative({t0 + slack, t_by}, everywhere);
    range = where_not_negative({line.length - t0 + slack, -t_by}, range);
    const double a = e.x * e.x + e.y * e.y;
    const double wide = radius + slack;
    if (a == 0.0) {
        if (length_of(q.x, q.y) > wide) return nowhere;
    } else {
        const double foot = -(q.x * e.x + q.y * e.y) / a;
        const double away = length_of(q.x + foot * e.x, q.y + foot * e.y);
        if (away > wide) return nowhere;
        const double half = std::sqrt(std::max(0.0, (radius - away) * (radius + away)) / a);
        range = {std::max(range.first, foot - half), std::min(range.last, foot + half)};
    }
    const double one = s0 + range.first * s_by, other = s0 + range.last * s_by;
    if (!holds_any(range) || !std::isfinite(one) || !std::isfinite(other)) return nowhere;
    return {std::min(one, other), std::max(one, other)};
}

/// Whether the point at (s, t) is in the cone, or outside it by no more than a tolerance.
bool holds(const LineAndMotion& line, const Cone& cone, double s, double t) {
    constexpr double most = 5e-10;
    const Vec3 q = line.at(t) + s * line.d;
    if (!(q.z >= cone.z0 - most && q.z <= cone.z1 + most)) return false;
    return length_of(q.x, q.y) - cone.position(q).z <= most * length_of(1.0, cone.slope);
}

/// Adds the points at which the line meets the envelope of the moving flank: the least and greatest
/// s on it, for an infinite flank and motion.
///
/// Source: with D, M and P for line, motion and start, (x, y, r) each, the plane of (s, t) has the
///         unit normal N along D x M and the distance h = N P from the cone's apex. The planes
///         through the motion that touch the cone have normals n = N y + (N x M) with F(n, n) = 0,
///         whose discriminant is F(M, M). Everything scales with h, so there is no cancellation
///         however near the line is to the apex.
void offer_touches(const LineAndMotion& line, const Cone& cone, Extent& extent) {
    const Vec3 p = cone.position(line.p), d = cone.direction(line.d), m = cone.direction(line.m);
    const double c = form(m, m);
    const Vec3 w = glm::cross(d, m);
    const double across = glm::length(w);
    if (!(c > 0.0) || across == 0.0) return; // along the motion the cone has no silhouette
    const Vec3 n = w / across, k = glm::cross(n, m);
    const double h = glm::dot(n, p);
    const double s_foot = -glm::dot(glm::cross(p, m), n) / across;
    const double t_foot = glm::dot(glm::cross(d, p), n) / across;
    const Range normals = zeros({form(n, n), form(n, k), form(k, k)}, c);
    for (const double y : {normals.first, normals.last}) {
        const double s = y * h / across;
        const double t = (h * form(n, m) + s * form(d, m)) / c + t_foot;
        if (!std::isfinite(s) || !(t > -slack && t < line.length + slack)) continue;
        if (holds(line, cone, s + s_foot, t)) extent.add(s + s_foot, s + s_foot);
    }
}

/// The set of (s, t) is convex: a quadric's section, cut off at the end faces and at the ends of
/// the motion. So its extremes in s are on one of those four borders or at a turning point of the
/// section.
std::optional<Interval> tilted_cone(const LineAndMotion& line, const ProfileElement& e) {
    if (!(e.z0 < e.z1)) return std::nullopt;
    const Cone cone(e);
    Extent extent;
    const auto offer = [&](const Range& s) {
        if (holds_any(s)) extent.add(s.first, s.last);
    };
    offer(chord_at(line, cone, 0.0));
    offer(chord_at(line, cone, line.length));
    offer(through_face(line, e.z0, e.r0));
    offer(through_face(line, e.z1, e.r1));
    offer_touches(line, cone, extent);
    return extent.interval();
}

/// A disc with a margin. Distances to it are convex in (s, t).
struct RoundedDisc {
    double height, radius, margin;

    struct Distance {
        double value, by_s, by_t; // and its slopes
        double bend_t;            // second derivative of half the square
        double half_slope_t;      // first derivative of half the square
    };
    Distance operator()(const LineAndMotion& line, double s, double t) const {
        const Vec3 q = line.at(t) + s * line.d;
        const double r = length_of(q.x, q.y), z = q.z - height;
        const double beyond = std::max(0.0, r - radius);
        const double value = length_of(beyond, z);
        const Vec3 out = beyond > 0.0 ? Vec3(q.x / r, q.y / r, 0.0) : Vec3(0.0);
        const double outwards = -glm::dot(out, line.m);
        const double slope = beyond * outwards - z * line.m.z;
        double bend = line.m.z * line.m.z;
        if (beyond > 0.0) {
            const double flat = line.m.x * line.m.x + line.m.y * line.m.y;
            bend += outwards * outwards + beyond / r * (flat - outwards * outwards);
        }
        const double safe = std::max(value, 1e-300);
        return {value, (beyond * glm::dot(out, line.d) + z * line.d.z) / safe, slope / safe, bend,
                slope};
    }
};

/// The time at which the point at s is nearest to the disc: where the slope of half the square
/// changes sign, by Newton's method within a bracket.
double nearest_moment(const LineAndMotion& line, const RoundedDisc& disc, double s, double guess) {
    double low = 0.0, high = line.length, t = guess;
    for (int i = 0; i < 60; ++i) {
        const auto here = disc(line, s, t);
        if (here.half_slope_t == 0.0) return t;
        (here.half_slope_t > 0.0 ? high : low) = t;
        double next = t - here.half_slope_t / here.bend_t;
        if (!(next > low && next < high)) {
            // A step beyond the end of the motion: take the end itself if the slope there agrees.
            const double end = here.half_slope_t > 0.0 ? 0.0 : line.length;
            if (t == end) return t;
            const bool untried = here.half_slope_t > 0.0 ? low == 0.0 : high == line.length;
            next = untried && i % 2 == 0 ? end : 0.5 * (low + high);
        }
        if (std::abs(next - t) <= 1e-15 * (line.length + 1.0)) return next;
        t = next;
    }
    return t;
}

/// The end of the swept rounded disc on the line, looking from outside: `sign` +1 for the upper
/// one. Newton's method on a convex function approaches the border from outside and never passes
/// it, so if the distance grows inwards, the line misses the body.
std::optional<double> end_from_outside(const LineAndMotion& line, const RoundedDisc& disc,
                                       double sign) {
    constexpr double enough = 1e-11;
    constexpr int rounds = 200;
    double t = 0.5 * line.length;
    const double reach = disc.radius + disc.margin + std::abs(disc.height);
    const double ends = sign
                        * std::max(sign * -glm::dot(line.at(0.0), line.d),
                                   sign * -glm::dot(line.at(line.length), line.d));
    double s = ends + sign * 2.0 * reach;
    for (int i = 0; i < rounds; ++i) {
        t = nearest_moment(line, disc, s, t);
        const auto here = disc(line, s, t);
        const double above = here.value - disc.margin;
        if (above <= enough) return s;
        if (!(sign * here.by_s > 0.0)) return std::nullopt;
        const double next = s - above / here.by_s;
        if (next == s) return s;
        s = next;
    }
    return std::nullopt;
}

std::optional<Interval> tilted_round(const LineAndMotion& line, const ProfileElement& e) {
    const RoundedDisc disc{e.z0, std::max(e.r0, e.r1), e.margin};
    const auto upper = end_from_outside(line, disc, 1.0);
    if (!upper) return std::nullopt;
    const auto lower = end_from_outside(line, disc, -1.0);
    if (!lower || !(*lower < *upper)) return std::nullopt;
    return Interval{*lower, *upper};
}

/// A ball is the same in every orientation, so the upright case applies.
std::optional<Interval> tilted_ball(const ElementSweep& sweep, const Mat3& stock_from_tool,
                                    int axis, double u, double v) {
    const Vec3 to_centre = sweep.element.z0 * stock_from_tool[2];
    const ProfileElement ball{0.0, 0.0, 0.0, 0.0, sweep.element.margin};
    return line_interval({ball, sweep.from + to_centre, sweep.to + to_centre}, axis, u, v);
}

} // namespace

std::optional<Interval> tilted_line_interval(const ElementSweep& sweep, const Mat3& stock_from_tool,
                                             int axis, double u, double v) {
    const ProfileElement& e = sweep.element;
    assert(e.margin == 0.0 || e.z0 == e.z1);
    if (e.margin > 0.0 && e.r0 == 0.0 && e.r1 == 0.0)
        return tilted_ball(sweep, stock_from_tool, axis, u, v);
    const LineAndMotion line = line_and_motion(sweep, stock_from_tool, axis, u, v);
    const auto found = e.margin > 0.0 ? tilted_round(line, e) : tilted_cone(line, e);
    if (!found) return std::nullopt;
    const Interval interval{found->lower + sweep.from[axis], found->upper + sweep.from[axis]};
    return interval.lower < interval.upper ? std::optional(interval) : std::nullopt;
}

} // namespace core
