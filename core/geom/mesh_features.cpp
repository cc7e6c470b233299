#include "core/geom/mesh_features.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/geom/face_borders.h"
#include "core/geom/round_walls.h"

namespace core {
namespace {

constexpr double least_edge_angle = 0.0087; // radians, 0.5 degrees, between the faces of an edge
constexpr double least_independence = 0.02; // the volume of three unit normals at a corner
constexpr size_t most_faces_compared = 16;  // at one corner
constexpr double curve_length_ratio = 3.0;  // of neighbouring chords of any smooth curve

/// The direction without components that are smaller than `precision`: exactly along an axis of the
/// frame, or in one of its planes, if it is that within the precision.
Vec3 snapped(Vec3 direction, double precision) {
    int left = 0;
    for (int k = 0; k < 3; ++k)
        if (std::abs(direction[k]) <= precision)
            direction[k] = 0.0;
        else
            ++left;
    if (left == 1) return glm::sign(direction);
    return glm::normalize(direction);
}

/// Collects the features of one mesh.
class FeatureSearch {
public:
    explicit FeatureSearch(const Mesh& mesh)
        : mesh_(mesh),
          sides_(sides_of(mesh)),
          facets_(facets_of(mesh, sides_)),
          is_chord_(sides_.mates.size(), false) {}

    MeshFeatures run() {
        number_faces();
        for (uint32_t face = 0; face < result_.faces.size(); ++face) describe(face);
        for (uint32_t face = 0; face < result_.faces.size(); ++face) find_edges(face);
        RoundFeatures round =
            round_features(mesh_, sides_, facets_, result_.face_of, std::move(round_borders_));
        result_.walls = std::move(round.walls);
        result_.wall_of = std::move(round.wall_of);
        for (const RoundBorder& border : round.circles) result_.circles.push_back(border.circle);
        find_corners(round.circles);
        return std::move(result_);
    }

private:
    /// Numbers the faces in the order of their first triangles.
    void number_faces() {
        std::vector<uint32_t> face_of_facet(facets_.facets.size(), no_index);
        result_.face_of.assign(mesh_.triangles.size(), no_index);
        for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            const uint32_t facet = facets_.of_triangle[t];
            if (facet == no_index || facets_.facets[facet].curved) continue;
            if (face_of_facet[facet] == no_index) {
                face_of_facet[facet] = static_cast<uint32_t>(result_.faces.size());
                result_.faces.emplace_back();
                facet_of_face_.push_back(facet);
            }
            result_.face_of[t] = face_of_facet[facet];
        }
    }

    void describe(uint32_t number) {
        PlanarFace& face = result_.faces[number];
        const MeshFacet& facet = facets_.facets[facet_of_face_[number]];
        const double precision =
            std::clamp(4.0 * facets_.noise / std::sqrt(facet.area), 1e-12, 1e-5);
        face.normal = snapped(facet.normal, precision);
        face.centroid = facet.centroid;
        face.area = facet.area;
        borders_.push_back(
            borders_of(mesh_, sides_, facets_, facet_of_face_[number], result_.face_of));
        face.axes = axes_of(face.normal, borders_.back(), precision);
        for (const FaceBorder& border : borders_.back()) {
            face.loops.emplace_back();
            for (const uint32_t corner : border.corners)
                face.loops.back().push_back(mesh_.vertices[start_of(mesh_, border.sides[corner])]);
        }
        set_box(number);
        find_circles(number);
    }

    /// Along the longest straight piece of the border and across it.
    std::array<Vec3, 2> axes_of(const Vec3& normal, const std::vector<FaceBorder>& borders,
                                double precision) const {
        Vec3 longest(0.0);
        for (const FaceBorder& border : borders)
            for (size_t i = 0; i < border.corners.size(); ++i) {
                const Vec3 way = end_of_piece(border, i) - start_of_piece(border, i);
                // Of equal lengths the first counts.
                if (glm::length(way) > glm::length(longest) * (1.0 + 1e-6)) longest = way;
            }
        if (longest == Vec3(0.0))
            longest = std::abs(normal.x) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        const Vec3 u =
            snapped(glm::normalize(longest - glm::dot(longest, normal) * normal), precision);
        return {u, glm::cross(normal, u)};
    }

    Vec3 start_of_piece(const FaceBorder& border, size_t i) const {
        return mesh_.vertices[start_of(mesh_, border.sides[border.corners[i]])];
    }
    Vec3 end_of_piece(const FaceBorder& border, size_t i) const {
        return start_of_piece(border, (i + 1) % border.corners.size());
    }

    void set_box(uint32_t number) {
        PlanarFace& face = result_.faces[number];
        std::array<double, 2> least = {infinity, infinity}, most = {-infinity, -infinity};
        for (const auto& loop : face.loops)
            for (const Vec3& p : loop)
                for (size_t k = 0; k < 2; ++k) {
                    const double x = glm::dot(p - face.centroid, face.axes[k]);
                    least[k] = std::min(least[k], x);
                    most[k] = std::max(most[k], x);
                }
        face.center = face.centroid;
        if (face.loops.empty()) return;
        for (size_t k = 0; k < 2; ++k) {
            face.half[k] = 0.5 * (most[k] - least[k]);
            face.center += 0.5 * (most[k] + least[k]) * face.axes[k];
        }
    }

    void find_circles(uint32_t number) {
        PlanarFace& face = result_.faces[number];
        for (size_t i = 0; i < borders_[number].size(); ++i)
            for (RoundBorder& part :
                 round_parts(mesh_, borders_[number][i], face.axes, face.normal, facets_.noise)) {
                part.circle.face = number;
                part.circle.outer = i == 0;
                if (i == 0 && !part.circle.arc) face.center = part.circle.center;
                for (const uint32_t side : part.sides) {
                    is_chord_[side] = true;
                    if (sides_.mates[side] != no_index) is_chord_[sides_.mates[side]] = true;
                }
                round_borders_.push_back(std::move(part));
            }
    }

    void find_edges(uint32_t number) {
        for (const FaceBorder& border : borders_[number]) {
            std::vector<StraightEdge> edges;
            for (size_t i = 0; i < border.corners.size(); ++i) {
                const uint32_t side = border.side_of_piece(mesh_, i), mate = sides_.mates[side];
                if (is_chord_[side]) continue;
                const uint32_t other = mate == no_index ? no_index : result_.face_of[mate / 3];
                if (other == no_index ? !is_edge_of_curved(border, i)
                                      : other <= number || !is_sharp(number, other))
                    continue;
                const StraightEdge edge{
                    start_of_piece(border, i), end_of_piece(border, i), {number, other}};
                if (edges.empty() || !joined_to(edges.back(), edge)) edges.push_back(edge);
            }
            if (edges.size() > 1 && joined_to(edges.back(), edges.front()))
                edges.erase(edges.begin());
            for (const StraightEdge& edge : edges)
                if (glm::distance(edge.from, edge.to) > 8.0 * facets_.noise)
                    result_.edges.push_back(edge);
        }
    }

    /// Extends an edge by the next one if it is in its line. Slivers can divide an edge, and even
    /// fold it: then the next piece runs back.
    bool joined_to(StraightEdge& edge, const StraightEdge& next) const {
        const double tolerance = 8.0 * facets_.noise;
        const Vec3 a = edge.to - edge.from, b = next.to - next.from;
        const bool a_longer = glm::length(a) >= glm::length(b);
        const Vec3 &line = a_longer ? a : b, &other = a_longer ? b : a;
        if (edge.faces != next.faces || glm::distance(edge.to, next.from) > tolerance
            || glm::length(glm::cross(line, other)) > tolerance * glm::length(line))
            return false;
        edge.to = next.to;
        return true;
    }

    bool is_sharp(uint32_t a, uint32_t b) const {
        return glm::distance(result_.faces[a].normal, result_.faces[b].normal) > least_edge_angle;
    }

    /// Whether a piece of a border beyond which the surface is curved, or ends, is a straight edge:
    /// it is sharp, and no chord of a curve.
    bool is_edge_of_curved(const FaceBorder& border, size_t i) const {
        const uint32_t side = border.side_of_piece(mesh_, i), mate = sides_.mates[side];
        if (mate != no_index) {
            const uint32_t own = facets_.of_triangle[side / 3];
            const uint32_t other = facets_.of_triangle[mate / 3];
            const double smooth = core::cos(radians_of(smooth_angle_deg));
            if (other == no_index
                || glm::dot(facets_.facets[own].normal, facets_.facets[other].normal) > smooth)
                return false;
        }
        const size_t count = border.corners.size();
        return !continues(border, i, (i + 1) % count)
               && !continues(border, i, (i + count - 1) % count);
    }

    /// Whether two pieces of a border can be chords of one smooth curve.
    bool continues(const FaceBorder& border, size_t i, size_t k) const {
        const Vec3 a = end_of_piece(border, i) - start_of_piece(border, i);
        const Vec3 b = end_of_piece(border, k) - start_of_piece(border, k);
        const double lengths = glm::length(a) * glm::length(b);
        return glm::dot(a, b) > core::cos(widest_chord) * lengths
               && glm::length(a) < curve_length_ratio * glm::length(b);
    }

    void find_corners(const std::vector<RoundBorder>& circles) {
        struct Touch {
            uint32_t vertex, face;
            auto operator<=>(const Touch&) const = default;
        };
        std::vector<bool> on_circle(mesh_.vertices.size(), false);
        for (const RoundBorder& border : circles)
            for (const uint32_t side : border.sides)
                if (!border.circle.arc) on_circle[start_of(mesh_, side)] = true;
        std::vector<Touch> touches;
        for (uint32_t face = 0; face < borders_.size(); ++face)
            for (const FaceBorder& border : borders_[face])
                for (const uint32_t side : border.sides)
                    if (!on_circle[start_of(mesh_, side)])
                        touches.push_back({start_of(mesh_, side), face});
        std::sort(touches.begin(), touches.end());
        touches.erase(std::unique(touches.begin(), touches.end()), touches.end());
        for (size_t i = 0, end = 0; i < touches.size(); i = end) {
            FeatureCorner corner;
            for (; end < touches.size() && touches[end].vertex == touches[i].vertex; ++end)
                corner.faces.push_back(touches[end].face);
            corner.point = corner.sharp = mesh_.vertices[touches[i].vertex];
            if (corner.faces.size() >= 3 && sharpen(corner)) result_.corners.push_back(corner);
        }
    }

    /// Finds where the three planes that are the most independent meet; false if there are none.
    bool sharpen(FeatureCorner& corner) const {
        const size_t count = std::min(corner.faces.size(), most_faces_compared);
        double best = least_independence;
        bool found = false;
        for (size_t i = 0; i < count; ++i)
            for (size_t j = i + 1; j < count; ++j)
                for (size_t k = j + 1; k < count; ++k) {
                    const PlanarFace& a = result_.faces[corner.faces[i]];
                    const PlanarFace& b = result_.faces[corner.faces[j]];
                    const PlanarFace& c = result_.faces[corner.faces[k]];
                    const Vec3 across = glm::cross(b.normal, c.normal);
                    const double volume = glm::dot(a.normal, across);
                    if (std::abs(volume) <= best * (1.0 + 1e-9)) continue;
                    best = std::abs(volume);
                    found = true;
                    const auto height = [&](const PlanarFace& face) {
                        return glm::dot(face.normal, face.centroid - corner.point);
                    };
                    corner.sharp =
                        corner.point
                        + (height(a) * across + height(b) * glm::cross(c.normal, a.normal)
                           + height(c) * glm::cross(a.normal, b.normal))
                              / volume;
                }
        return found;
    }

    const Mesh& mesh_;
    MeshSides sides_;
    MeshFacets facets_;
    std::vector<bool> is_chord_; // for each side: whether it is one of a circle
    MeshFeatures result_;
    std::vector<uint32_t> facet_of_face_;
    std::vector<std::vector<FaceBorder>> borders_; // of each face
    std::vector<RoundBorder> round_borders_;
};

} // namespace

MeshFeatures features_of(const Mesh& mesh) { return FeatureSearch(mesh).run(); }

} // namespace core
