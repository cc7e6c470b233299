#include "core/geom/feature_pick.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"

namespace core {
namespace {

constexpr double equal_distances = 1e-6; // mm

enum class PickRank : uint8_t {
    corner,
    whole_circle,
    whole_wall,
    edge,
    arc,
    part_of_wall,
    face,
    filled_circle
};

/// A candidate with its place in the order.
struct RankedPick {
    PickRank rank;
    double distance; // in steps of equal_distances
    FeaturePick pick;

    bool operator<(const RankedPick& b) const {
        if (rank != b.rank) return rank < b.rank;
        if (distance != b.distance) return distance < b.distance;
        return pick.index < b.pick.index;
    }
};

/// The face and the wall of which a click hit the surface.
struct HitSurface {
    uint32_t face = no_index;
    uint32_t wall = no_index;

    bool unknown() const { return face == no_index && wall == no_index; }
};

double height_above(const PlanarFace& face, const Vec3& p) {
    return glm::dot(face.normal, p - face.centroid);
}

/// The axis of a wall at the height of a point.
struct AxisPlace {
    Vec3 foot;
    double radius; // of the wall there
    double apart;  // of the point from the axis
};

AxisPlace on_axis(const RoundWall& wall, const Vec3& p) {
    const Vec3 way = wall.to - wall.from;
    const double part = glm::dot(p - wall.from, way) / glm::dot(way, way);
    const Vec3 foot = wall.from + part * way;
    const double within = std::clamp(part, 0.0, 1.0);
    return {foot, wall.radius_from + within * (wall.radius_to - wall.radius_from),
            glm::distance(p, foot)};
}

/// The surface nearest to a point, if the body is convex.
HitSurface nearest_surface_of(const MeshFeatures& features, const Vec3& p) {
    HitSurface nearest;
    double least = infinity;
    for (uint32_t i = 0; i < features.faces.size(); ++i) {
        const double away = std::abs(height_above(features.faces[i], p));
        if (!(away < least)) continue;
        least = away;
        nearest = {i, no_index};
    }
    for (uint32_t i = 0; i < features.walls.size(); ++i) {
        const AxisPlace at = on_axis(features.walls[i], p);
        const double away = std::abs(at.apart - at.radius);
        if (!(away < least)) continue;
        least = away;
        nearest = {no_index, i};
    }
    return nearest;
}

HitSurface surface_hit(const MeshFeatures& features, uint32_t triangle, const Vec3& p) {
    if (triangle >= features.face_of.size()) return nearest_surface_of(features, p);
    return {features.face_of[triangle], features.wall_of[triangle]};
}

/// The distance from a circle or arc. Its chords are between two radii: both are on it.
double distance_from(const FeatureCircle& circle, const Vec3& p) {
    const Vec3 apart = p - circle.center;
    const double height = glm::dot(apart, circle.axis);
    const Vec3 out = apart - height * circle.axis;
    const double radius = glm::length(out);
    const double off = std::max({circle.inscribed_radius - radius, radius - circle.radius, 0.0});
    if (!circle.arc) return core::hypot(off, height);
    const Vec3 middle = circle.middle - circle.center;
    const Vec3 across = glm::cross(circle.axis, middle);
    const double turn = core::atan2(glm::dot(out, across), glm::dot(out, middle));
    if (std::abs(turn) <= 0.5 * circle.angle) return core::hypot(off, height);
    const double to_end = std::copysign(0.5 * circle.angle, turn);
    return glm::distance(p,
                         circle.center + core::cos(to_end) * middle + core::sin(to_end) * across);
}

Vec3 nearest_on(const StraightEdge& edge, const Vec3& p) {
    const Vec3 way = edge.to - edge.from;
    const double part = glm::dot(p - edge.from, way) / glm::dot(way, way);
    return edge.from + std::clamp(part, 0.0, 1.0) * way;
}

/// Collects the candidates of one click.
class PickSearch {
public:
    PickSearch(const MeshFeatures& features, uint32_t triangle, const Vec3& hit, double reach)
        : features_(features),
          surface_(surface_hit(features, triangle, hit)),
          hit_(hit),
          reach_(reach) {}

    std::vector<FeaturePick> run() {
        add_corners();
        add_circles();
        add_edges();
        add_surface();
        std::sort(found_.begin(), found_.end());
        std::vector<FeaturePick> picks;
        for (const RankedPick& ranked : found_) picks.push_back(ranked.pick);
        return picks;
    }

private:
    /// Whether features of any face count: on a curved surface, which has no list of its borders.
    bool any_face() const { return surface_.face == no_index; }

    void add(PickRank rank, const FeaturePick& pick) {
        found_.push_back({rank, core::round(pick.distance / equal_distances), pick});
    }

    void add_corners() {
        for (uint32_t i = 0; i < features_.corners.size(); ++i) {
            const FeatureCorner& c = features_.corners[i];
            const double distance = glm::distance(c.point, hit_);
            if (!(distance <= reach_)) continue;
            if (any_face() || std::binary_search(c.faces.begin(), c.faces.end(), surface_.face))
                add(PickRank::corner, {FeatureKind::corner, i, c.point, Vec3(0.0), 0.0, distance});
        }
    }

    bool ends_surface(uint32_t i) const {
        const FeatureCircle& circle = features_.circles[i];
        if (surface_.unknown()) return true;
        if (surface_.face != no_index && circle.face == surface_.face) return true;
        if (surface_.wall == no_index) return false;
        const RoundWall& wall = features_.walls[surface_.wall];
        return circle.wall == surface_.wall || wall.rims[0] == i || wall.rims[1] == i;
    }

    void add_circles() {
        for (uint32_t i = 0; i < features_.circles.size(); ++i) {
            const FeatureCircle& c = features_.circles[i];
            if (!ends_surface(i)) continue;
            const double distance = distance_from(c, hit_);
            const FeaturePick pick{FeatureKind::circle, i, c.center, c.axis, c.radius, distance};
            if (distance <= reach_)
                add(c.arc ? PickRank::arc : PickRank::whole_circle, pick);
            else if (!c.arc && c.outer && c.face == surface_.face)
                add(PickRank::filled_circle, pick);
        }
    }

    void add_edges() {
        for (uint32_t i = 0; i < features_.edges.size(); ++i) {
            const StraightEdge& e = features_.edges[i];
            const Vec3 point = nearest_on(e, hit_);
            const double distance = glm::distance(point, hit_);
            if (!(distance <= reach_)) continue;
            if (any_face() || e.faces[0] == surface_.face || e.faces[1] == surface_.face)
                add(PickRank::edge,
                    {FeatureKind::edge, i, point, glm::normalize(e.to - e.from), 0.0, distance});
        }
    }

    void add_surface() {
        if (surface_.wall != no_index) {
            const RoundWall& wall = features_.walls[surface_.wall];
            const AxisPlace at = on_axis(wall, hit_);
            add(wall.full ? PickRank::whole_wall : PickRank::part_of_wall,
                {FeatureKind::wall, surface_.wall, at.foot, wall.axis(), at.radius, 0.0});
        }
        if (surface_.face != no_index) {
            const PlanarFace& f = features_.faces[surface_.face];
            add(PickRank::face, {FeatureKind::face, surface_.face,
                                 hit_ - height_above(f, hit_) * f.normal, f.normal, 0.0, 0.0});
        }
    }

    const MeshFeatures& features_;
    HitSurface surface_;
    Vec3 hit_;
    double reach_;
    std::vector<RankedPick> found_;
};

} // namespace

std::vector<FeaturePick> feature_candidates(const MeshFeatures& features, uint32_t triangle,
                                            const Vec3& hit, double reach) {
    if (!is_finite(hit)) return {};
    return PickSearch(features, triangle, hit, reach).run();
}

std::optional<FeaturePick> pick_feature(const MeshFeatures& features, uint32_t triangle,
                                        const Vec3& hit, double reach) {
    const std::vector<FeaturePick> found = feature_candidates(features, triangle, hit, reach);
    if (found.empty()) return std::nullopt;
    return found.front();
}

FeaturePick moved(const FeaturePick& pick, const Transform& target_from_body) {
    FeaturePick there = pick;
    there.point = target_from_body * pick.point;
    there.direction = target_from_body.rotation * pick.direction;
    return there;
}

} // namespace core
