#include "core/geom/mesh_facets.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/math.h"
#include "core/base/union_find.h"
#include "core/base/units.h"

namespace core {
namespace {

constexpr double relative_noise = 5e-7;    // of the largest coordinate
constexpr double single_rounding = 1.2e-7; // of a coordinate in single precision
constexpr size_t most_vertices_sampled = 1000;
constexpr double least_angle = 1e-3;       // normals that differ by less may be of one plane
constexpr double largest_area_ratio = 4.0; // of neighbours in a curved surface
constexpr double largest_bend_ratio = 1.8; // of radii of curvature at two sides of a facet
constexpr uint32_t least_curved_facets = 4;
constexpr uint32_t least_equal_facets = 3; // if they are of equal area and at least
constexpr double least_equal_angle = 0.34; // radians, 20 degrees, apart: a fillet of three chords
constexpr double largest_lump_bend = 2.0;  // of radii of curvature at its border
constexpr double largest_lump = 8.0;       // area of a part of a curved surface, of its neighbours

double largest_coordinate(const Mesh& mesh) {
    double most = 0.0;
    for (const Vec3& v : mesh.vertices)
        for (int k = 0; k < 3; ++k)
            if (std::isfinite(v[k])) most = std::max(most, std::abs(v[k]));
    return most;
}

/// The place value of the sixth digit of a number, 0 for 0.
double sixth_digit(double value) {
    return value == 0.0 ? 0.0 : core::pow(10.0, std::floor(core::log10(std::abs(value))) - 5.0);
}

/// Whether the coordinates have at most six digits, as those of text files of some programs. A
/// sample is enough.
bool has_six_digits(const Mesh& mesh) {
    const size_t step = std::max<size_t>(1, mesh.vertices.size() / most_vertices_sampled);
    for (size_t i = 0; i < mesh.vertices.size(); i += step)
        for (int k = 0; k < 3; ++k) {
            const double x = mesh.vertices[i][k], digit = sixth_digit(x);
            if (digit > 0.0
                && std::abs(x - digit * core::round(x / digit)) > single_rounding * std::abs(x))
                return false;
        }
    return true;
}

double noise_of(const Mesh& mesh) {
    const double reach = largest_coordinate(mesh), usual = relative_noise * reach;
    return has_six_digits(mesh) ? std::max(usual, sixth_digit(reach)) : usual;
}

/// Half the cross product of two sides, and the least height.
struct TriangleSize {
    Vec3 area_vector = Vec3(0.0);
    double area = 0.0;
    double height = 0.0;
};

TriangleSize measured(const Triangle& t) {
    TriangleSize size;
    size.area_vector = 0.5 * glm::cross(t.b - t.a, t.c - t.a);
    size.area = glm::length(size.area_vector);
    const double longest =
        std::sqrt(std::max({glm::dot(t.b - t.a, t.b - t.a), glm::dot(t.c - t.b, t.c - t.b),
                            glm::dot(t.a - t.c, t.a - t.c)}));
    size.height = longest > 0.0 ? 2.0 * size.area / longest : 0.0;
    return size;
}

/// Grows coplanar sets from the fattest triangles, whose normals are the most certain.
class FacetGrowth {
public:
    FacetGrowth(const Mesh& mesh, const MeshSides& sides) : mesh_(mesh), sides_(sides) {
        result_.noise = noise_of(mesh);
        result_.of_triangle.assign(mesh.triangles.size(), no_index);
        sizes_.resize(mesh.triangles.size());
        for (size_t i = 0; i < sizes_.size(); ++i)
            if (sides.usable[i]) sizes_[i] = measured(mesh.triangle(i));
    }

    MeshFacets run() {
        for (const uint32_t seed : seeds())
            if (result_.of_triangle[seed] == no_index) grow(seed);
        list_triangles();
        return std::move(result_);
    }

private:
    /// All triangles that have a plane, the fattest first.
    std::vector<uint32_t> seeds() const {
        struct Seed {
            double height;
            uint32_t triangle;
        };
        std::vector<Seed> order;
        order.reserve(sizes_.size());
        for (uint32_t i = 0; i < sizes_.size(); ++i)
            if (sizes_[i].height > 2.0 * result_.noise && std::isfinite(sizes_[i].area))
                order.push_back({sizes_[i].height, i});
        std::sort(order.begin(), order.end(), [](const Seed& a, const Seed& b) {
            return a.height != b.height ? a.height > b.height : a.triangle < b.triangle;
        });
        std::vector<uint32_t> triangles;
        triangles.reserve(order.size());
        for (const Seed& seed : order) triangles.push_back(seed.triangle);
        return triangles;
    }

    void grow(uint32_t seed) {
        facet_ = {};
        area_vector_ = moment_ = Vec3(0.0);
        origin_ = mesh_.vertices[mesh_.triangles[seed][0]];
        queue_.clear();
        add(seed);
        for (size_t head = 0; head < queue_.size(); ++head)
            for (uint32_t side = 3 * queue_[head]; side < 3 * queue_[head] + 3; ++side) {
                if (sides_.mates[side] == no_index) continue;
                const uint32_t next = MeshSides::triangle_of(sides_.mates[side]);
                if (result_.of_triangle[next] == no_index && fits(next)) add(next);
            }
        result_.facets.push_back(facet_);
    }

    void add(uint32_t triangle) {
        const Triangle t = mesh_.triangle(triangle);
        const TriangleSize& size = sizes_[triangle];
        result_.of_triangle[triangle] = static_cast<uint32_t>(result_.facets.size());
        queue_.push_back(triangle);
        area_vector_ += size.area_vector;
        moment_ += size.area * ((t.a - origin_) + (t.b - origin_) + (t.c - origin_)) / 3.0;
        facet_.area += size.area;
        facet_.normal = glm::normalize(area_vector_);
        facet_.centroid = origin_ + moment_ / facet_.area;
    }

    bool fits(uint32_t triangle) const {
        const Triangle t = mesh_.triangle(triangle);
        for (const Vec3& p : {t.a, t.b, t.c})
            if (!(std::abs(glm::dot(facet_.normal, p - facet_.centroid)) <= 4.0 * result_.noise))
                return false;
        const TriangleSize& size = sizes_[triangle];
        if (!(size.height > 2.0 * result_.noise)) return true; // its normal says nothing
        const Vec3 normal = size.area_vector / size.area;
        const double allowed = std::clamp(3.0 * result_.noise / size.height, least_angle, 0.5);
        return glm::dot(normal, facet_.normal) > 0.0
               && glm::length(glm::cross(normal, facet_.normal)) <= allowed;
    }

    void list_triangles() {
        result_.starts.assign(result_.facets.size() + 1, 0);
        for (const uint32_t facet : result_.of_triangle)
            if (facet != no_index) ++result_.starts[facet + 1];
        for (size_t i = 1; i < result_.starts.size(); ++i)
            result_.starts[i] += result_.starts[i - 1];
        result_.listed.resize(result_.starts.back());
        std::vector<uint32_t> at(result_.starts.begin(), result_.starts.end() - 1);
        for (uint32_t i = 0; i < result_.of_triangle.size(); ++i)
            if (result_.of_triangle[i] != no_index)
                result_.listed[at[result_.of_triangle[i]]++] = i;
    }

    const Mesh& mesh_;
    const MeshSides& sides_;
    MeshFacets result_;
    std::vector<TriangleSize> sizes_;
    MeshFacet facet_;
    Vec3 area_vector_ = Vec3(0.0), moment_ = Vec3(0.0), origin_ = Vec3(0.0);
    std::vector<uint32_t> queue_;
};

/// Where two facets meet at a small angle.
struct Bend {
    uint32_t a, b;
    double angle;  // radians
    double radius; // of curvature, from the middles of the facets and the angle
};

/// The bend between the facets on both sides of a side, if they meet at a small angle. Facet `a` is
/// that of the side.
std::optional<Bend> bend_at(const Mesh& mesh, const MeshSides& sides, const MeshFacets& facets,
                            uint32_t side) {
    const uint32_t mate = sides.mates[side];
    if (mate == no_index) return std::nullopt;
    const uint32_t i = facets.of_triangle[side / 3], k = facets.of_triangle[mate / 3];
    if (i == k || i == no_index || k == no_index) return std::nullopt;
    const MeshFacet& a = facets.facets[i];
    const MeshFacet& b = facets.facets[k];
    static const double smooth = core::cos(radians_of(smooth_angle_deg));
    if (glm::dot(a.normal, b.normal) < smooth) return std::nullopt;
    const Vec3 along = mesh.vertices[end_of(mesh, side)] - mesh.vertices[start_of(mesh, side)];
    const double across = glm::length(glm::cross(b.centroid - a.centroid, along))
                          / std::max(glm::length(along), 1e-300);
    const double angle = glm::length(glm::cross(a.normal, b.normal));
    return Bend{i, k, angle, across / std::max(angle, 1e-12)};
}

/// All bends between facets of similar area.
std::vector<Bend> bends_of(const Mesh& mesh, const MeshSides& sides, const MeshFacets& facets) {
    std::vector<Bend> bends;
    for (uint32_t side = 0; side < sides.mates.size(); ++side) {
        if (sides.mates[side] < side) continue;
        const auto bend = bend_at(mesh, sides, facets, side);
        if (!bend) continue;
        const double a = facets.facets[bend->a].area, b = facets.facets[bend->b].area;
        if (std::max(a, b) <= largest_area_ratio * std::min(a, b)) bends.push_back(*bend);
    }
    return bends;
}

/// For each facet the least radius of its bends.
std::vector<double> tightest_of(const std::vector<Bend>& bends, size_t count) {
    std::vector<double> tightest(count, infinity);
    for (const Bend& bend : bends)
        for (const uint32_t facet : {bend.a, bend.b})
            tightest[facet] = std::min(tightest[facet], bend.radius);
    return tightest;
}

/// Joins facets along bends that are about as tight as the tightest of both.
UnionFind joined(const std::vector<Bend>& bends, const std::vector<double>& tightest) {
    UnionFind patches(tightest.size());
    for (const Bend& bend : bends)
        if (bend.radius <= largest_bend_ratio * std::min(tightest[bend.a], tightest[bend.b]))
            patches.join(bend.a, bend.b);
    return patches;
}

void mark_curved(MeshFacets& facets, const std::vector<Bend>& bends, UnionFind patches) {
    struct Patch {
        uint32_t facets = 0;
        double least = infinity, most = 0.0; // area
        double least_angle = infinity;
    };
    std::vector<Patch> of(facets.facets.size());
    for (uint32_t i = 0; i < of.size(); ++i) {
        const uint32_t root = patches.root(i);
        const double area = facets.facets[i].area;
        facets.facets[i].patch = root;
        ++of[root].facets;
        of[root].least = std::min(of[root].least, area);
        of[root].most = std::max(of[root].most, area);
    }
    for (const Bend& bend : bends) {
        const uint32_t root = facets.facets[bend.a].patch;
        if (facets.facets[bend.b].patch == root)
            of[root].least_angle = std::min(of[root].least_angle, bend.angle);
    }
    for (MeshFacet& facet : facets.facets) {
        const Patch& patch = of[facet.patch];
        const bool equal =
            patch.most <= 1.2 * patch.least && patch.least_angle >= least_equal_angle;
        facet.curved = patch.facets >= (equal ? least_equal_facets : least_curved_facets);
    }
}

/// Marks facets within curved surfaces that bend as these do, but are larger: where triangles are
/// small for the precision of the mesh, several can be of one plane.
void mark_lumps(const Mesh& mesh, const MeshSides& sides, const std::vector<double>& tightest,
                MeshFacets& facets) {
    std::vector<double> largest(facets.facets.size(), 0.0); // of the curved neighbours
    for (uint32_t side = 0; side < sides.mates.size(); ++side) {
        const uint32_t i = facets.of_triangle[side / 3], mate = sides.mates[side];
        if (i == no_index || facets.facets[i].curved) continue;
        const uint32_t k = mate == no_index ? i : facets.of_triangle[mate / 3];
        if (mate != no_index && (k == i || k == no_index)) continue;
        const auto bend = bend_at(mesh, sides, facets, side);
        if (!bend || (facets.facets[k].curved && bend->radius > largest_lump_bend * tightest[k]))
            largest[i] = -infinity;
        else if (facets.facets[k].curved && largest[i] >= 0.0)
            largest[i] = std::max(largest[i], facets.facets[k].area);
    }
    for (size_t i = 0; i < largest.size(); ++i)
        if (facets.facets[i].area <= largest_lump * largest[i]) facets.facets[i].curved = true;
}

} // namespace

MeshFacets facets_of(const Mesh& mesh, const MeshSides& sides) {
    MeshFacets facets = FacetGrowth(mesh, sides).run();
    const std::vector<Bend> bends = bends_of(mesh, sides, facets);
    const std::vector<double> tightest = tightest_of(bends, facets.facets.size());
    mark_curved(facets, bends, joined(bends, tightest));
    mark_lumps(mesh, sides, tightest, facets);
    return facets;
}

} // namespace core
