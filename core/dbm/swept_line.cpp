#include "core/dbm/swept_line.h"

#include <array>
#include <cassert>

namespace core {
namespace {

/// A stretch of the motion's parameter, 0..1 at most.
struct Range {
    double first, last;

    bool empty() const { return !(first < last); }
    double clamp(double t) const { return std::clamp(t, first, last); }
};

/// A quantity that changes evenly over the motion: at + t * by.
struct Linear {
    double at, by;

    double operator()(double t) const { return at + t * by; }
};

/// Where `f` is not negative, within `range`.
Range where_not_negative(const Linear& f, Range range) {
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

/// Where q <= 0, for a >= 0, within `range`.
Range where_not_positive(const Quadratic& q, Range range) {
    if (q.a == 0.0) return where_not_negative({-q.c, -2.0 * q.b}, range);
    const double discriminant = q.b * q.b - q.a * q.c;
    if (discriminant < 0.0) return {1.0, 0.0};
    const double root = std::sqrt(discriminant);
    return {std::max(range.first, (-q.b - root) / q.a), std::min(range.last, (-q.b + root) / q.a)};
}

/// Least and greatest of two functions over the candidates that were tried.
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

/// The extent of along(t) -+ sqrt(under(t)) over `range`, for a concave root: ends and stationary
/// points. Every candidate is a point of the swept volume, so nothing is ever taken too long.
std::optional<Interval> extent_with_root(const Linear& along, const Quadratic& under, Range range) {
    if (range.empty() && range.first != range.last) return std::nullopt;
    Extent extent;
    const auto offer = [&](double t) {
        const double half = std::sqrt(std::max(0.0, under(t)));
        extent.add(along(t) - half, along(t) + half);
    };
    offer(range.first);
    offer(range.last);
    // Stationary where (a t + b)^2 = by^2 (a t^2 + 2 b t + c).
    const double k = along.by * along.by;
    const double a = under.a * (under.a - k);
    const double b = under.b * (under.a - k);
    const double c = under.b * under.b - k * under.c;
    const double discriminant = b * b - a * c;
    if (a != 0.0 && discriminant >= 0.0) {
        const double root = std::sqrt(discriminant);
        offer(range.clamp((-b - root) / a));
        offer(range.clamp((-b + root) / a));
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

Quadratic squared(const Linear& f) { return {f.by * f.by, f.at * f.by, f.at * f.at}; }

Quadratic operator+(const Quadratic& p, const Quadratic& q) {
    return {p.a + q.a, p.b + q.b, p.c + q.c};
}

Quadratic operator-(const Quadratic& p, const Quadratic& q) {
    return {p.a - q.a, p.b - q.b, p.c - q.c};
}

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
    return extent_with_root(along, {-outside.a, -outside.b, -outside.c}, range);
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
    return extent_with_root(along, squared(radius) - squared(side), range);
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
        const Interval ends = cone_heights(e, std::sqrt(std::max(0.0, across(t))));
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
    const double least = std::max(0.0, across(middle));
    const double steepness = k * k * across.a - rise.by * rise.by;
    if (steepness > 0.0) {
        const double away = std::abs(rise.by) * std::sqrt(least / (across.a * steepness));
        offer(middle - away);
        offer(middle + away);
    }
    return extent.interval();
}

/// The greatest value of a concave function over a range, by golden section.
template <typename Function>
double argmax(const Function& f, Range range) {
    constexpr double golden = 0.6180339887498949;
    double low = range.first, high = range.last;
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double fa = f(a), fb = f(b);
    for (int i = 0; i < 60; ++i) {
        if (fa < fb) {
            low = a;
            a = b;
            fa = fb;
            fb = f(b = low + golden * (high - low));
        } else {
            high = b;
            b = a;
            fb = fa;
            fa = f(a = high - golden * (high - low));
        }
    }
    return 0.5 * (low + high);
}

/// The end of {f >= 0} between `inside`, where f >= 0, and `towards`.
template <typename Function>
double border(const Function& f, double inside, double towards) {
    if (f(towards) >= 0.0) return towards;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (inside + towards);
        (f(middle) >= 0.0 ? inside : towards) = middle;
    }
    return inside;
}

/// A disc with a margin (the rounded corner of a bull nose), by search on concave functions.
std::optional<Interval> round_interval(const ElementSweep& sweep, int axis, double u, double v) {
    const ProfileElement& e = sweep.element;
    const LineMotion line(sweep, axis, u, v);
    const double disc = std::max(e.r0, e.r1);
    const auto reach = [&](double height) { // radius at a height above the disc
        return disc + std::sqrt(std::max(0.0, e.margin * e.margin - height * height));
    };
    const auto height = [&](double t) { return line[2](t) - e.z0; };
    const auto depth = [&](double t) { // how far the line lies within the body across itself
        if (axis == 2) return disc + e.margin - std::hypot(line[0](t), line[1](t));
        const double level = e.margin - std::abs(height(t));
        if (level < 0.0) return level;
        return std::min(level, reach(height(t)) - std::abs(line[1 - axis](t)));
    };
    const double deepest = argmax(depth, whole_motion);
    if (depth(deepest) < 0.0) return std::nullopt;
    const Range range{border(depth, deepest, 0.0), border(depth, deepest, 1.0)};
    const auto half = [&](double t) {
        if (axis != 2) {
            const double side = line[1 - axis](t);
            const double r = reach(height(t));
            return std::sqrt(std::max(0.0, r * r - side * side));
        }
        const double beyond = std::max(0.0, std::hypot(line[0](t), line[1](t)) - disc);
        return std::sqrt(std::max(0.0, e.margin * e.margin - beyond * beyond));
    };
    const double middle = axis == 2 ? e.z0 : 0.0;
    const auto high = [&](double t) { return middle - line[axis](t) + half(t); };
    const auto low = [&](double t) { return middle - line[axis](t) - half(t); };
    Extent extent;
    for (const double t : {range.first, range.last, argmax(high, range),
                           argmax([&](double at) { return -low(at); }, range)})
        extent.add(low(t), high(t));
    return extent.interval();
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
