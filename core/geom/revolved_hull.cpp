#include "core/geom/revolved_hull.h"

#include <algorithm>

namespace core {
namespace {

constexpr size_t most_levels = 400;

/// Heights and others between them, so that no two are far apart.
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

/// Heights that cut the mesh into slices: those of its vertices, thinned out when there are many.
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
    return std::hypot(p.x, p.y);
}

/// Widens a slice for an edge. The distance from the axis is convex along it, so what it is at the
/// ends of the slice bounds it in between; an edge that ends within is held by a cylinder.
void widen(ProfileElement& slice, const Vec3& a, const Vec3& b) {
    const Vec3& low = a.z <= b.z ? a : b;
    const Vec3& high = a.z <= b.z ? b : a;
    if (high.z < slice.z0 || low.z > slice.z1) return;
    if (low.z <= slice.z0 && high.z >= slice.z1) {
        slice.r0 = std::max(slice.r0, radius_on(low, high, slice.z0));
        slice.r1 = std::max(slice.r1, radius_on(low, high, slice.z1));
        return;
    }
    if (high.z == slice.z0 || low.z == slice.z1) return; // its own slice holds it
    const Vec3 from =
        low.z < slice.z0 ? low + (slice.z0 - low.z) / (high.z - low.z) * (high - low) : low;
    const Vec3 to =
        high.z > slice.z1 ? low + (slice.z1 - low.z) / (high.z - low.z) * (high - low) : high;
    const double r = std::max(std::hypot(from.x, from.y), std::hypot(to.x, to.y));
    slice.r0 = std::max(slice.r0, r);
    slice.r1 = std::max(slice.r1, r);
}

/// How much wider a slice is than a cone at its lower and upper end.
std::array<double, 2> lacking(const ProfileElement& cone, const ProfileElement& slice) {
    const double slope = (cone.r1 - cone.r0) / (cone.z1 - cone.z0);
    return {slice.r0 - cone.r0 - slope * (slice.z0 - cone.z0),
            slice.r1 - cone.r0 - slope * (slice.z1 - cone.z0)};
}

/// One cone for several slices, if it need not be wider than they are by more than the tolerance.
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
