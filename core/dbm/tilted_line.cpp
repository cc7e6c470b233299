#include "core/dbm/tilted_line.h"

#include <cassert>

#include "core/dbm/line_algebra.h"

namespace core {
namespace {

constexpr Range everywhere{-infinity, infinity};
constexpr Range nowhere{1.0, -1.0};

/// What lies outside by no more than this counts as in, mm: where two borders meet, rounding must
/// not have each leave the corner to the other.
constexpr double slack = 1e-10;

bool holds_any(const Range& range) { return range.first <= range.last; }

/// The plane of (s, t): s along the line, t along the motion, both in mm. In the tool's frame the
/// point is p + s d - t m; the sweep holds it where that lies in the piece.
struct LineAndMotion {
    Vec3 p, d, m;  // d and m of length 1
    double length; // of the motion

    Vec3 at(double t) const { return p - t * m; }
};

/// Where along the line s counts from: the place of the piece's origin at the start.
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

/// A cone z0 <= z <= z1, x^2 + y^2 <= r(z)^2, in numbers that serve for all lines.
struct Cone {
    double z0, z1, r0, slope;

    explicit Cone(const ProfileElement& e)
        : z0(e.z0), z1(e.z1), r0(e.r0), slope((e.r1 - e.r0) / (e.z1 - e.z0)) {}

    /// x, y and the radius at z; directions (of which z0 says nothing) the same with `far`.
    Vec3 place(const Vec3& q) const { return {q.x, q.y, r0 + slope * (q.z - z0)}; }
    Vec3 direction(const Vec3& d) const { return {d.x, d.y, slope * d.z}; }
};

/// The form that is negative inside the cone: x x' + y y' - r r'.
double form(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y - a.z * b.z; }

/// Where a line through `at` crosses the flank, carried on over both nappes; nowhere if it passes
/// by. `at` is the point of the line nearest to the cone's origin.
Range flank_crossings(const Vec3& at, const Vec3& by) {
    const double a = form(by, by), b = form(at, by);
    if (std::abs(a) > 0.01 * glm::dot(by, by)) {
        // Counted from half way between the two, so that nothing cancels even at the cone's tip.
        const double middle = -b / a;
        const Vec3 f = at + middle * by;
        const double away = std::hypot(f.x, f.y);
        const double square = -(away - f.z) * (away + f.z) / a;
        if (a > 0.0 && square < 0.0) return nowhere;
        const double half = std::sqrt(std::max(0.0, square));
        return {middle - half, middle + half};
    }
    const double away = std::hypot(at.x, at.y);
    const Quadratic outside{a, b, (away - at.z) * (away + at.z)};
    if (a == 0.0 && b == 0.0) return outside.c <= 0.0 ? everywhere : nowhere;
    const double bend = b * b - a * outside.c;
    if (a > 0.0 && bend < 0.0) return nowhere;
    if (a == 0.0) return where_not_positive(outside, everywhere);
    return zeros(outside, std::max(0.0, bend));
}

/// The stretch of s in the cone at one moment of the motion.
Range chord_at(const LineAndMotion& line, const Cone& cone, double t) {
    const Vec3 place = line.at(t);
    // Counted from the foot of the perpendicular, lest distances along the line spoil the square.
    const double shift = -glm::dot(place, line.d);
    const Vec3 q = place + shift * line.d;
    Range range = where_not_negative({q.z - cone.z0 + slack, line.d.z}, everywhere);
    range = where_not_negative({cone.z1 - q.z + slack, -line.d.z}, range);
    const Vec3 at = cone.place(q), by = cone.direction(line.d);
    const Range flanks = flank_crossings(at, by);
    if (form(by, by) >= 0.0)
        range = {std::max(range.first, flanks.first), std::min(range.last, flanks.last)};
    else if (by.z > 0.0) // steeper than the flank: in on one nappe, and the piece has no other
        range.first = std::max(range.first, flanks.last);
    else
        range.last = std::min(range.last, flanks.first);
    return holds_any(range) ? Range{range.first + shift, range.last + shift} : nowhere;
}

/// The stretch of s at which the line runs through one of the piece's end faces, at any time.
Range through_face(const LineAndMotion& line, double z, double radius) {
    const double steep = std::hypot(line.d.z, line.m.z);
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
        if (std::hypot(q.x, q.y) > wide) return nowhere;
    } else {
        const double foot = -(q.x * e.x + q.y * e.y) / a;
        const double away = std::hypot(q.x + foot * e.x, q.y + foot * e.y);
        if (away > wide) return nowhere;
        const double half = std::sqrt(std::max(0.0, (radius - away) * (radius + away)) / a);
        range = {std::max(range.first, foot - half), std::min(range.last, foot + half)};
    }
    const double one = s0 + range.first * s_by, other = s0 + range.last * s_by;
    if (!holds_any(range) || !std::isfinite(one) || !std::isfinite(other)) return nowhere;
    return {std::min(one, other), std::max(one, other)};
}

/// Whether the point at (s, t) lies in the cone, or outside it by no more than may count as in.
bool holds(const LineAndMotion& line, const Cone& cone, double s, double t) {
    constexpr double most = 5e-10;
    const Vec3 q = line.at(t) + s * line.d;
    if (!(q.z >= cone.z0 - most && q.z <= cone.z1 + most)) return false;
    return std::hypot(q.x, q.y) - cone.place(q).z <= most * std::hypot(1.0, cone.slope);
}

/// Offers where the line touches the flank that the motion envelops: where s is least and greatest
/// on it, were the flank and the motion endless.
///
/// Source: with D, M and P for line, motion and start, (x, y, r) each, the plane of (s, t) has the
///         unit normal N along D x M and stands off the cone's apex by h = N P. The planes through
///         the motion that touch the cone have normals n = N y + (N x M) with F(n, n) = 0, of which
///         the discriminant is F(M, M). Everything scales with h, so that nothing cancels however
///         near the line comes to the apex.
void offer_touches(const LineAndMotion& line, const Cone& cone, Extent& extent) {
    const Vec3 p = cone.place(line.p), d = cone.direction(line.d), m = cone.direction(line.m);
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
/// the motion. So its extremes in s lie on one of those four borders or where the section turns
/// round.
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
        double half_slope_t;      // first one
    };
    Distance operator()(const LineAndMotion& line, double s, double t) const {
        const Vec3 q = line.at(t) + s * line.d;
        const double r = std::hypot(q.x, q.y), z = q.z - height;
        const double beyond = std::max(0.0, r - radius);
        const double value = std::hypot(beyond, z);
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

/// The moment at which the point at s is nearest to the disc: where the slope of half the square
/// changes sign, by Newton's steps that never leave the bracket.
double nearest_moment(const LineAndMotion& line, const RoundedDisc& disc, double s, double guess) {
    double low = 0.0, high = line.length, t = guess;
    for (int i = 0; i < 60; ++i) {
        const auto here = disc(line, s, t);
        if (here.half_slope_t == 0.0) return t;
        (here.half_slope_t > 0.0 ? high : low) = t;
        double next = t - here.half_slope_t / here.bend_t;
        if (!(next > low && next < high)) {
            // A step beyond the end of the motion: the end itself, if the slope agrees there.
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
/// one. Newton's steps on a convex function come from outside and never pass the border, so whoever
/// sees the distance grow inwards has missed the body.
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

/// Balls look the same from everywhere.
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
