#include "core/dbm/swept_line.h"

#include <array>
#include <cassert>

#include "core/dbm/line_algebra.h"
#include "core/dbm/tilted_line.h"

namespace core {
namespace {

/// Half the chord of a circle at a distance from its centre; at a cone's tip both are rounding.
double half_chord(double radius, double away) {
    return std::sqrt(std::max(0.0, (radius - away) * (radius + away)));
}

/// The extent of along(t) -+ half(t) over `range`, where half is the root of `under` and concave:
/// ends and stationary points. Every candidate is a point of the swept volume, so nothing is ever
/// taken too long.
template <typename Half>
std::optional<Interval> extent_with_root(const Linear& along, const Quadratic& under,
                                         const Half& half, Range range) {
    if (range.empty() && range.first != range.last) return std::nullopt;
    Extent extent;
    const auto offer = [&](double t) { extent.add(along(t) - half(t), along(t) + half(t)); };
    offer(range.first);
    offer(range.last);
    // Stationary where (a t + b)^2 = k (a t^2 + 2 b t + c), k = by^2. The discriminant of this is
    // k (k - a) (b^2 - a c); multiplied out it would be noise where k is 0, as it is for every line
    // across the motion. Its last factor is positive where the root is concave.
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

/// What every case needs: the line's place relative to the moving origin, axis by axis.
struct LineMotion {
    std::array<Linear, 3> offset; // on `axis`: minus the origin's own place; else line minus origin

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
        const double d = std::hypot(line[(axis + 1) % 3](t), line[(axis + 2) % 3](t));
        return half_chord(r, d);
    };
    return extent_with_root(along, {-outside.a, -outside.b, -outside.c}, half, range);
}

/// A truncated cone met by a line along X or Y: at each moment a chord of the circle at its height.
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

/// Lower and upper end of a truncated cone at rest above a point `r` from its axis, at most its
/// largest radius but for rounding.
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
        const Interval ends = cone_heights(e, std::hypot(line[0](t), line[1](t)));
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
    const double nearest = std::hypot(line[0](middle), line[1](middle));
    const double steepness = k * k * across.a - rise.by * rise.by;
    if (steepness > 0.0) {
        const double away = std::abs(rise.by) * nearest / std::sqrt(across.a * steepness);
        offer(middle - away);
        offer(middle + away);
    }
    return extent.interval();
}

/// A disc with a margin (the rounded corner of a bull nose).
std::optional<Interval> round_interval(const ElementSweep& sweep, int axis, double u, double v) {
    const ProfileElement& e = sweep.element;
    // Most lines near a sweep miss it: the cylinder round the piece tells them without a search.
    const double widest = std::max(e.r0, e.r1) + e.margin;
    const ProfileElement round{e.z0 - e.margin, widest, e.z0 + e.margin, widest, 0.0};
    if (!line_interval({round, sweep.from, sweep.to}, axis, u, v)) return std::nullopt;
    return tilted_line_interval(sweep, Mat3(1.0), axis, u, v);
}

} // namespace

std::optional<Interval> line_interval(const ElementSweep& sweep, int axis, double u, double v) {
    const ProfileElement& e = sweep.element;
    if (e.margin > 0.0) {
        assert(e.z0 == e.z1);
        if (e.r0 == 0.0 && e.r1 == 0.0) return ball_interval(sweep, axis, u, v);
        return round_interval(sweep, axis, u, v);
    }
    if (axis == 2) return cone_along(sweep, u, v);
    return cone_across(sweep, axis, u, v);
}

IntervalList line_intervals(const RevolvedProfile& profile, int axis, double u, double v) {
    IntervalList lines;
    for (const ProfileElement& element : profile.elements)
        if (const auto interval = line_interval({element, {}, {}}, axis, u, v))
            lines.add(*interval);
    return lines;
}

} // namespace core
