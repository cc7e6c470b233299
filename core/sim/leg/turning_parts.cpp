#include "core/sim/leg/turning_parts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/math.h"

namespace core {
namespace {

/// A vector in a half-plane through the axis: away from the axis, and along it.
struct Outward {
    double r, z;

    double length() const { return core::hypot(r, z); }
};

constexpr Outward down{0.0, -1.0}, across{1.0, 0.0}, up{0.0, 1.0};

/// The outer normal of the flank of an element.
Outward flank_normal(const ProfileElement& e) {
    const Outward along{e.r1 - e.r0, e.z1 - e.z0};
    const double length = along.length();
    return length > 0.0 ? Outward{along.z / length, -along.r / length} : across;
}

/// The greatest arm about the origin of a normal at point `p`, where normals range from one to
/// another.
double arm_at(const Outward& p, const Outward& from, const Outward& to) {
    const auto arm = [&](const Outward& n) { return std::abs(p.z * n.r - p.r * n.z); };
    // It is greatest for a normal at right angles to p.
    const bool passes_right_angle = (p.r * from.r + p.z * from.z) * (p.r * to.r + p.z * to.z) < 0.0;
    return passes_right_angle ? p.length() : std::max(arm(from), arm(to));
}

/// A body between two heights. The ends within the body are open: they are covered by the next
/// part.
struct Slice {
    RevolvedProfile profile;
    bool is_open_below = false, is_open_above = false;
};

/// The greatest arm of a normal of a convex slice about the point at height `centre` of the axis,
/// leaving out the normals of its open ends.
double greatest_arm(const Slice& slice, double centre) {
    const std::vector<ProfileElement>& elements = slice.profile.elements;
    double most = 0.0;
    for (size_t i = 0; i < elements.size(); ++i) {
        const ProfileElement& e = elements[i];
        const bool is_first = i == 0, is_last = i + 1 == elements.size();
        const Outward lower{e.r0, e.z0 - centre}, upper{e.r1, e.z1 - centre};
        if (e.margin > 0.0) {
            // Turning does not change the ball that the margin stands for. Its surface ends where
            // the flank of the next element continues it.
            for (const Outward& p : {lower, upper})
                most = std::max(most, is_last ? p.length()
                                              : arm_at(p, down, flank_normal(elements[i + 1])));
            continue;
        }
        const Outward flank = flank_normal(e);
        Outward below = down;
        if (!is_first)
            below = elements[i - 1].margin > 0.0 ? across : flank_normal(elements[i - 1]);
        else if (slice.is_open_below)
            below = flank;
        Outward above = flank; // the next element has the other normals of their common edge
        if (is_last && !slice.is_open_above) above = up;
        most = std::max({most, arm_at(lower, below, flank), arm_at(upper, flank, above)});
    }
    return most;
}

double reach_from(const RevolvedProfile& profile, double centre) {
    double most = 0.0;
    for (const ProfileElement& e : profile.elements)
        for (const auto& [r, z] : {std::pair(e.r0, e.z0), std::pair(e.r1, e.z1)})
            most = std::max(most, core::hypot(r, z - centre) + e.margin);
    return most;
}

TurningPart part_of(const Slice& slice, double overlap, const Mover& whole) {
    const Aabb box = bounds(slice.profile);
    std::vector<double> centres = {box.center().z};
    for (const ProfileElement& e : slice.profile.elements)
        if (e.margin > 0.0) centres.push_back(0.5 * (e.z0 + e.z1));
    const double centre =
        *std::min_element(centres.begin(), centres.end(), [&](double a, double b) {
            return greatest_arm(slice, a) < greatest_arm(slice, b);
        });
    TurningPart part{slice.profile, whole};
    part.mover.centre = Vec3(0.0, 0.0, centre);
    part.mover.reach = reach_from(slice.profile, centre) + slice.profile.deviation;
    part.mover.arm = greatest_arm(slice, centre) + slice.profile.deviation;
    part.mover.overlap = slice.is_open_below || slice.is_open_above ? overlap : 0.0;
    return part;
}

/// The part of a cylinder or cone between two heights.
ProfileElement between(const ProfileElement& e, double z0, double z1) {
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    ProfileElement part = e;
    if (z0 > e.z0) part.z0 = z0, part.r0 = e.r0 + slope * (z0 - e.z0);
    if (z1 < e.z1) part.z1 = z1, part.r1 = e.r0 + slope * (z1 - e.z0);
    return part;
}

/// Divides a convex profile within its long elements, into slices about `height` high. Flat cones
/// are left whole: the bound of open ends needs flanks within 45 degrees of the axis.
std::vector<Slice> slices_of(const RevolvedProfile& convex, double height, double overlap) {
    std::vector<Slice> slices;
    Slice slice;
    const auto begin = [&] {
        slice = {};
        slice.profile.form_error = convex.form_error;
        slice.profile.deviation = convex.deviation;
    };
    begin();
    for (const ProfileElement& e : convex.elements) {
        const double length = e.z1 - e.z0;
        const bool is_steep = e.margin == 0.0 && std::abs(e.r1 - e.r0) <= length;
        const int count = is_steep ? static_cast<int>(length / height) : 1;
        double from = e.z0;
        for (int i = 1; i < count; ++i) {
            const double cut = e.z0 + length * i / count;
            slice.profile.elements.push_back(between(e, from, cut + overlap));
            slice.is_open_above = true;
            slices.push_back(std::move(slice));
            begin();
            slice.is_open_below = true;
            from = cut - overlap;
        }
        slice.profile.elements.push_back(between(e, from, e.z1));
    }
    slices.push_back(std::move(slice));
    return slices;
}

/// The slices of a profile about `height` high, convex ones of a profile that is not.
std::vector<TurningPart> parts_of(const RevolvedProfile& body, const Mover& mover, double height,
                                  double overlap) {
    std::vector<RevolvedProfile> convex;
    if (is_convex(body))
        convex.push_back(body);
    else
        for (const ProfileElement& element : body.elements)
            convex.push_back({{element}, body.form_error, body.deviation});
    std::vector<TurningPart> parts;
    for (const RevolvedProfile& profile : convex)
        for (const Slice& slice : slices_of(profile, height, overlap))
            parts.push_back(part_of(slice, overlap, mover));
    return parts;
}

} // namespace

std::vector<TurningPart> flute_parts(const RevolvedProfile& flutes, const Mover& mover,
                                     double cell) {
    // Together, two parts overlap by more than the diagonal of a cell.
    const double least = std::clamp(0.8 * bounds(flutes).max.x, 0.5, 5.0);
    const double overlap = std::max(0.1 * least, 0.8 * cell);
    return parts_of(flutes, mover, std::max(least, 4.0 * overlap), overlap);
}

std::vector<TurningPart> slender_parts(const RevolvedProfile& body, const Mover& mover) {
    if (body.empty()) return {};
    constexpr double most = 8.0;
    const Aabb box = bounds(body);
    const double height = std::max(1.6 * box.max.x, box.size().z / most);
    return parts_of(body, mover, height, 0.1 * height);
}

} // namespace core
