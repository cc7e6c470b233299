#include "core/geom/profile.h"

#include <algorithm>
#include <optional>

#include "core/base/math.h"
#include "core/geom/mesh.h"

namespace core {
namespace {

/// Increase of a cone's radius when its side moves outwards by 1.
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
    // If the side now reaches the axis, the cone has its tip there.
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

/// Whether the element has a flat downward face: at the tip, or at a step from a narrower piece
/// below.
bool faces_down(const RevolvedProfile& profile, size_t i) {
    const ProfileElement& e = profile.elements[i];
    if (i == 0) return true;
    const ProfileElement& below = profile.elements[i - 1];
    return e.r0 > below.r1 + below.margin;
}

/// Whether the element has a flat upward face around a narrower piece above.
bool faces_up(const RevolvedProfile& profile, size_t i) {
    if (i + 1 == profile.elements.size()) return false;
    const ProfileElement& above = profile.elements[i + 1];
    return above.margin == 0.0 && above.r0 < profile.elements[i].r1;
}

/// The collar that joins a piece, raised by `by`, to the narrower one below. Points deeper than
/// `by` are within the chord of the circle around the inner edge of the step.
std::optional<ProfileElement> lower_collar(const ProfileElement& e, const ProfileElement& below,
                                           double by) {
    const double rim = below.r1 + below.margin;
    const double top = std::min(e.z0 + by, e.z1);
    if (!(e.z0 < top) || e.margin > 0.0) return std::nullopt;
    return ProfileElement{e.z0, std::max(0.0, rim - by), top, std::min(rim, radius_at(e, top)),
                          0.0};
}

/// The collar between a piece, lowered by `by`, and the narrower one above.
std::optional<ProfileElement> upper_collar(const ProfileElement& e, const ProfileElement& above,
                                           double by) {
    const double foot = std::max(e.z1 - by, e.z0);
    if (!(foot < e.z1) || e.margin > 0.0) return std::nullopt;
    return ProfileElement{foot, std::min(above.r0, radius_at(e, foot)), e.z1,
                          std::max(0.0, above.r0 - by), 0.0};
}

/// Whether a cone continues a rounding below it tangentially and extends above its top.
bool continues_round(const ProfileElement& round, const ProfileElement& cone) {
    constexpr double rounding = 1e-11; // mm; points computed by sine and cosine match no better
    const double out = cone.r0 - round.r0, up = cone.z0 - round.z0;
    const double along = core::hypot(cone.r1 - cone.r0, cone.z1 - cone.z0);
    const double turned = out * (cone.r1 - cone.r0) + up * (cone.z1 - cone.z0);
    return cone.margin == 0.0 && cone.z1 >= round.z0 + round.margin && out > 0.0
           && std::abs(core::hypot(out, up) - round.margin) <= rounding
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
    // Going up the outline, the direction may only turn inwards.
    double last_slope = infinity, last_r = 0.0, last_z = -infinity;
    for (size_t i = 0; i < profile.elements.size(); ++i) {
        const ProfileElement& e = profile.elements[i];
        if (e.margin > 0.0) { // from a flat or a tip, tangentially to vertical
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
    // Near a seam that turns outwards, a point may be deep in the body although the flank of its
    // own piece, extended beyond the seam, is near. Surface at the point's own height is always
    // near.
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

namespace {

constexpr size_t most_levels = 400;

/// The heights, with others added between them so that no two neighbours are far apart.
std::vector<double> filled(const std::vector<double>& levels) {
    const double widest = (levels.back() - levels.front()) / most_levels;
    std::vector<double> all;
    for (size_t i = 0; i + 1 < levels.size(); ++i) {
        const double gap = levels[i + 1] - levels[i];
        const auto steps = static_cast<size_t>(std::ceil(gap / widest));
        for (size_t k = 0; k < std::max<size_t>(steps, 1); ++k)
            all.push_back(levels[i] + gap * static_cast<double>(k) / static_cast<double>(steps));
    }
    all.push_back(levels.back());
    return all;
}

/// Heights that cut the mesh into slices: those of its vertices, thinned out if there are many.
std::vector<double> levels_of(const Mesh& mesh) {
    std::vector<double> all;
    for (const Vec3& v : mesh.vertices) all.push_back(v.z);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    if (all.size() <= most_levels) return filled(all);
    std::vector<double> some;
    for (size_t i = 0; i < most_levels; ++i)
        some.push_back(all[i * (all.size() - 1) / (most_levels - 1)]);
    return some;
}

double radius_on(const Vec3& a, const Vec3& b, double z) {
    const Vec3 p = a + (z - a.z) / (b.z - a.z) * (b - a);
    return core::hypot(p.x, p.y);
}

/// Widens a slice for an edge. The distance from the axis is convex along the edge, so its values
/// at the ends of the slice bound it in between; an edge that ends within the slice is contained in
/// a cylinder.
void widen(ProfileElement& slice, const Vec3& a, const Vec3& b) {
    const Vec3& low = a.z <= b.z ? a : b;
    const Vec3& high = a.z <= b.z ? b : a;
    if (high.z < slice.z0 || low.z > slice.z1) return;
    if (low.z <= slice.z0 && high.z >= slice.z1) {
        slice.r0 = std::max(slice.r0, radius_on(low, high, slice.z0));
        slice.r1 = std::max(slice.r1, radius_on(low, high, slice.z1));
        return;
    }
    if (high.z == slice.z0 || low.z == slice.z1) return; // its own slice contains it
    const Vec3 from =
        low.z < slice.z0 ? low + (slice.z0 - low.z) / (high.z - low.z) * (high - low) : low;
    const Vec3 to =
        high.z > slice.z1 ? low + (slice.z1 - low.z) / (high.z - low.z) * (high - low) : high;
    const double r = std::max(core::hypot(from.x, from.y), core::hypot(to.x, to.y));
    slice.r0 = std::max(slice.r0, r);
    slice.r1 = std::max(slice.r1, r);
}

/// Amounts by which a slice is wider than a cone at the slice's lower and upper end.
std::array<double, 2> lacking(const ProfileElement& cone, const ProfileElement& slice) {
    const double slope = (cone.r1 - cone.r0) / (cone.z1 - cone.z0);
    return {slice.r0 - cone.r0 - slope * (slice.z0 - cone.z0),
            slice.r1 - cone.r0 - slope * (slice.z1 - cone.z0)};
}

/// Replaces several slices by one cone if that is wider than they are by at most the tolerance.
bool join(const std::vector<ProfileElement>& slices, size_t first, size_t last, double tolerance,
          ProfileElement& cone) {
    ProfileElement joined{slices[first].z0, slices[first].r0, slices[last].z1, slices[last].r1,
                          0.0};
    double most = 0.0, least = 0.0;
    for (size_t i = first; i <= last; ++i) {
        const auto [lower, upper] = lacking(joined, slices[i]);
        most = std::max({most, lower, upper});
        least = std::min({least, lower, upper});
    }
    if (most - least > tolerance) return false;
    joined.r0 += most;
    joined.r1 += most;
    cone = joined;
    return true;
}

} // namespace

RevolvedProfile revolved_hull(const Mesh& mesh, double tolerance) {
    const std::vector<double> levels = levels_of(mesh);
    std::vector<ProfileElement> slices;
    for (size_t i = 0; i + 1 < levels.size(); ++i) {
        ProfileElement slice{levels[i], 0.0, levels[i + 1], 0.0, 0.0};
        for (const auto& t : mesh.triangles)
            for (size_t k = 0; k < 3; ++k)
                widen(slice, mesh.vertices[t[k]], mesh.vertices[t[(k + 1) % 3]]);
        slices.push_back(slice);
    }
    RevolvedProfile hull;
    for (size_t first = 0; first < slices.size();) {
        ProfileElement cone = slices[first];
        size_t last = first;
        while (last + 1 < slices.size() && join(slices, first, last + 1, tolerance, cone)) ++last;
        hull.elements.push_back(cone);
        first = last + 1;
    }
    return hull;
}

} // namespace core
