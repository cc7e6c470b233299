#include "core/geom/profile.h"

#include <optional>

namespace core {
namespace {

/// How much wider a cone becomes across its axis when its side moves outwards by 1.
double widening(const ProfileElement& e) {
    if (e.z1 <= e.z0) return 1.0;
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    return std::sqrt(1.0 + slope * slope);
}

double radius_at(const ProfileElement& e, double z) {
    if (e.z1 <= e.z0) return std::max(e.r0, e.r1);
    return e.r0 + (e.r1 - e.r0) * (z - e.z0) / (e.z1 - e.z0);
}

/// The part of a cone between two heights, made narrower; empty if nothing is left.
std::optional<ProfileElement> inner_cone(const ProfileElement& e, double narrower, double z0,
                                         double z1) {
    if (!(z0 < z1)) return std::nullopt;
    double r0 = radius_at(e, z0) - narrower, r1 = radius_at(e, z1) - narrower;
    if (r0 <= 0.0 && r1 <= 0.0) return std::nullopt;
    // Where the side reaches the axis the cone now has its tip.
    if (r0 < 0.0) {
        z0 += (z1 - z0) * (-r0 / (r1 - r0));
        r0 = 0.0;
    }
    if (r1 < 0.0) {
        z1 -= (z1 - z0) * (-r1 / (r0 - r1));
        r1 = 0.0;
    }
    return ProfileElement{z0, r0, z1, r1, 0.0};
}

/// A ball or rounded corner with its margin reduced.
std::optional<ProfileElement> inner_round(const ProfileElement& e, double by) {
    ProfileElement inner = e;
    inner.margin = std::max(0.0, e.margin - by);
    const double beyond = std::max(0.0, by - e.margin);
    inner.r0 -= beyond;
    inner.r1 -= beyond;
    if (inner.margin == 0.0 || inner.r0 < 0.0) return std::nullopt;
    return inner;
}

/// Whether the element shows a flat face downwards: the tip, or a step to a wider piece above.
bool faces_down(const RevolvedProfile& profile, size_t i) {
    const ProfileElement& e = profile.elements[i];
    if (i == 0) return true;
    const ProfileElement& below = profile.elements[i - 1];
    return e.r0 > below.r1 + below.margin;
}

/// Whether the element shows a flat face upwards, round a narrower piece above.
bool faces_up(const RevolvedProfile& profile, size_t i) {
    if (i + 1 == profile.elements.size()) return false;
    const ProfileElement& above = profile.elements[i + 1];
    return above.margin == 0.0 && above.r0 < profile.elements[i].r1;
}

/// What joins a piece, raised by `by`, to the narrower one below: the points that deep lie within
/// the chord of the circle round the inner edge of the step.
std::optional<ProfileElement> lower_collar(const ProfileElement& e, const ProfileElement& below,
                                           double by) {
    const double rim = below.r1 + below.margin;
    const double top = std::min(e.z0 + by, e.z1);
    if (!(e.z0 < top) || e.margin > 0.0) return std::nullopt;
    return ProfileElement{e.z0, std::max(0.0, rim - by), top, std::min(rim, radius_at(e, top)),
                          0.0};
}

/// The same between a piece, lowered by `by`, and the narrower one above.
std::optional<ProfileElement> upper_collar(const ProfileElement& e, const ProfileElement& above,
                                           double by) {
    const double foot = std::max(e.z1 - by, e.z0);
    if (!(foot < e.z1) || e.margin > 0.0) return std::nullopt;
    return ProfileElement{foot, std::min(above.r0, radius_at(e, foot)), e.z1,
                          std::max(0.0, above.r0 - by), 0.0};
}

/// Whether a cone takes up where a rounding below it has its direction, and reaches over its top.
bool continues_round(const ProfileElement& round, const ProfileElement& cone) {
    constexpr double rounding = 1e-11; // mm; what is computed by sine and cosine meets no better
    const double out = cone.r0 - round.r0, up = cone.z0 - round.z0;
    const double along = std::hypot(cone.r1 - cone.r0, cone.z1 - cone.z0);
    const double turned = out * (cone.r1 - cone.r0) + up * (cone.z1 - cone.z0);
    return cone.margin == 0.0 && cone.z1 >= round.z0 + round.margin && out > 0.0
           && std::abs(std::hypot(out, up) - round.margin) <= rounding
           && std::abs(turned) <= rounding * along;
}

} // namespace

Aabb bounds(const ProfileElement& element) {
    const double r = std::max(element.r0, element.r1) + element.margin;
    return {{-r, -r, element.z0 - element.margin}, {r, r, element.z1 + element.margin}};
}

Aabb bounds(const RevolvedProfile& profile) {
    Aabb box;
    for (const ProfileElement& element : profile.elements) box.extend(bounds(element));
    return box;
}

bool is_convex(const RevolvedProfile& profile) {
    // Walking up the outline, the angle from the axis may only turn inwards.
    double last_slope = infinity, last_r = 0.0, last_z = -infinity;
    for (size_t i = 0; i < profile.elements.size(); ++i) {
        const ProfileElement& e = profile.elements[i];
        if (e.margin > 0.0) { // from the flat or the tip tangentially to upright
            if (last_z != -infinity) return false;
            last_slope = 0.0;
            last_r = e.r0 + e.margin;
            last_z = e.z1;
            continue;
        }
        const bool tangent = i > 0 && profile.elements[i - 1].margin > 0.0
                             && continues_round(profile.elements[i - 1], e);
        if (tangent) last_slope = infinity;
        if (!tangent && last_z != -infinity && (e.z0 != last_z || e.r0 != last_r)) return false;
        const double slope = e.z1 > e.z0 ? (e.r1 - e.r0) / (e.z1 - e.z0) : infinity;
        if (slope > last_slope) return false;
        last_slope = slope;
        last_r = e.r1;
        last_z = e.z1;
    }
    return !profile.empty();
}

RevolvedProfile shrunk_within(const RevolvedProfile& profile, double by) {
    RevolvedProfile inner;
    for (const ProfileElement& e : profile.elements) {
        const auto kept = e.margin > 0.0 ? inner_round(e, by)
                                         : inner_cone(e, by * widening(e), e.z0 + by, e.z1 - by);
        if (kept) inner.elements.push_back(*kept);
    }
    return inner;
}

RevolvedProfile shrunk_around(const RevolvedProfile& profile, double by) {
    // Beside a seam that turns outwards a point may be deep in the body though the flank of its
    // own piece, carried on beyond the seam, is near. What lies on its own level is always near.
    const bool convex = is_convex(profile);
    RevolvedProfile inner;
    for (size_t i = 0; i < profile.elements.size(); ++i) {
        const ProfileElement& e = profile.elements[i];
        const bool raised = faces_down(profile, i);
        const double z0 = raised ? e.z0 + by : e.z0;
        const bool lowered = faces_up(profile, i);
        const double z1 = lowered ? e.z1 - by : e.z1;
        const double narrower = convex ? by * widening(e) : by;
        const auto kept = e.margin > 0.0 ? inner_round(e, by) : inner_cone(e, narrower, z0, z1);
        if (i > 0 && raised) {
            const auto collar = lower_collar(e, profile.elements[i - 1], by);
            if (collar) inner.elements.push_back(*collar);
        }
        if (kept) inner.elements.push_back(*kept);
        if (lowered) {
            const auto collar = upper_collar(e, profile.elements[i + 1], by);
            if (collar) inner.elements.push_back(*collar);
        }
    }
    return inner;
}

RevolvedProfile grown(const RevolvedProfile& profile, double by) {
    RevolvedProfile outer = profile;
    for (ProfileElement& e : outer.elements) {
        if (e.margin > 0.0) {
            e.margin += by;
            continue;
        }
        const double wider = by * widening(e);
        const double slope = e.z1 > e.z0 ? (e.r1 - e.r0) / (e.z1 - e.z0) : 0.0;
        e.r0 += wider + std::max(0.0, -slope) * by;
        e.r1 += wider + std::max(0.0, slope) * by;
        e.z0 -= by;
        e.z1 += by;
    }
    return outer;
}

} // namespace core
