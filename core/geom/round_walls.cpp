#include "core/geom/round_walls.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/geom/round_form.h"

namespace core {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;
constexpr double least_wall_angle = 1.57; // radians, 90 degrees, of walls without a circle
constexpr double similar_area = 4.0;      // ratio of facets of a surface that goes on

class WallSearch {
public:
    WallSearch(const Mesh& mesh, const MeshSides& sides, const MeshFacets& facets,
               const std::vector<uint32_t>& face_of, std::vector<RoundBorder> circles)
        : mesh_(mesh), sides_(sides), facets_(facets), face_of_(face_of) {
        result_.circles = std::move(circles);
        result_.wall_of.assign(mesh.triangles.size(), no_index);
        circle_at_.assign(mesh.vertices.size(), no_index);
        for (uint32_t c = 0; c < result_.circles.size(); ++c) note_vertices(c);
    }

    RoundFeatures run() {
        follow_circles();
        std::vector<bool> tried(facets_.facets.size(), false);
        for (uint32_t facet = 0; facet < tried.size(); ++facet) {
            if (tried[facet] || !is_free(facet)) continue;
            tried[facet] = true;
            if (!from_strips(facet))
                for (const uint32_t t : claimed_)
                    if (facets_.of_triangle[t] != no_index) tried[facets_.of_triangle[t]] = true;
            follow_circles();
        }
        // Cones that go on smoothly count if they go on in a wall.
        for (const uint32_t c : std::exchange(doubtful_, {})) from_circle(c);
        follow_circles();
        for (RoundBorder& circle : result_.circles) circle.circle.kind = kind_of(circle);
        find_open_ends();
        return std::move(result_);
    }

private:
    /// Circles grow while they are followed: a wall adds the circle at its other end.
    void follow_circles() {
        for (; followed_ < result_.circles.size(); ++followed_) from_circle(followed_);
    }

    void note_vertices(uint32_t c) {
        if (result_.circles[c].circle.arc) return;
        for (const uint32_t side : result_.circles[c].sides) circle_at_[start_of(mesh_, side)] = c;
    }

    const MeshFacet* facet_of(uint32_t triangle) const {
        const uint32_t facet = facets_.of_triangle[triangle];
        return facet == no_index ? nullptr : &facets_.facets[facet];
    }

    /// Whether a facet is curved and in no wall yet.
    bool is_free(uint32_t facet) const {
        return facets_.facets[facet].curved
               && result_.wall_of[facets_.triangles_of(facet)[0]] == no_index;
    }

    void from_circle(uint32_t c) {
        if (ends_known_wall(c)) return;
        const RoundBorder& rim = result_.circles[c];
        std::vector<uint32_t> seeds;
        for (const uint32_t side : rim.sides) {
            const uint32_t mate = sides_.mates[side];
            if (mate == no_index || result_.wall_of[mate / 3] != no_index) continue;
            const MeshFacet* facet = facet_of(mate / 3);
            if (facet && std::abs(glm::dot(facet->normal, rim.circle.axis)) < 0.999)
                seeds.push_back(mate);
        }
        if (seeds.size() < 3 || 2 * seeds.size() < rim.sides.size()) return;
        const auto form = form_beyond(mesh_, facets_, rim.circle, seeds);
        if (!form) return;
        for (uint32_t& seed : seeds) seed /= 3;
        grow(*form, seeds, 1.0);
        if (form->slope != 0.0 && smooth_part(form->axis, claimed_, result_.wall_of) > 0.25) {
            doubtful_.push_back(c);
            return release();
        }
        if (!keep(*form)) return release();
        ends_known_wall(c);
    }

    /// Joins an arc to the wall beyond it, if there is one.
    bool ends_known_wall(uint32_t c) {
        const RoundBorder& rim = result_.circles[c];
        std::vector<uint32_t> beyond;
        for (const uint32_t side : rim.sides)
            if (sides_.mates[side] != no_index)
                beyond.push_back(result_.wall_of[sides_.mates[side] / 3]);
        if (beyond.empty()) return false;
        std::nth_element(beyond.begin(), beyond.begin() + beyond.size() / 2, beyond.end());
        const uint32_t number = beyond[beyond.size() / 2];
        if (number == no_index) return false;
        if (rim.circle.arc) {
            RoundWall& wall = result_.walls[number];
            const bool at_from = glm::distance(rim.circle.center, wall.from)
                                 < glm::distance(rim.circle.center, wall.to);
            wall.rims[at_from ? 0 : 1] = c;
            result_.circles[c].circle.wall = number;
        }
        return true;
    }

    bool from_strips(uint32_t facet) {
        claimed_.clear();
        const uint32_t side = longest_free_side(facet);
        if (side == no_index) return false;
        // Most facets of free forms are refused here.
        if (smooth_part(glm::normalize(way_along(mesh_, side)), facets_.triangles_of(facet),
                        facets_.of_triangle)
            > 0.75)
            return false;
        auto form = form_of_strips(mesh_, sides_, facets_, side);
        if (!form) return false;
        const uint32_t seed = side / 3;
        grow(*form, {&seed, 1}, 4.0);
        form =
            facets_claimed() >= 3 ? refined(mesh_, facets_.noise, *form, claimed_) : std::nullopt;
        release();
        if (!form) return false;
        claimed_.clear();
        grow(*form, {&seed, 1}, 1.0);
        if (facets_claimed() >= 3 && smooth_part(form->axis, claimed_, result_.wall_of) <= 0.75
            && angle_round(*form) >= least_wall_angle && keep(*form))
            return true;
        release();
        return false;
    }

    /// The longest side between a facet and another one that is curved with it.
    uint32_t longest_free_side(uint32_t facet) const {
        uint32_t best = no_index;
        double longest = 0.0;
        for (const uint32_t t : facets_.triangles_of(facet))
            for (uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
                const uint32_t mate = sides_.mates[side];
                if (mate == no_index) continue;
                const uint32_t other = facets_.of_triangle[mate / 3];
                if (other == facet || other == no_index || !is_free(other)
                    || facets_.facets[other].patch != facets_.facets[facet].patch)
                    continue;
                const double length = glm::length(way_along(mesh_, side));
                if (length <= longest) continue;
                longest = length;
                best = side;
            }
        return best;
    }

    size_t facets_claimed() const {
        std::vector<uint32_t> facets;
        for (const uint32_t t : claimed_) facets.push_back(facets_.of_triangle[t]);
        std::sort(facets.begin(), facets.end());
        return static_cast<size_t>(std::unique(facets.begin(), facets.end()) - facets.begin());
    }

    bool fits(const RoundForm& form, uint32_t triangle, double widening) const {
        if (!sides_.usable[triangle] || result_.wall_of[triangle] != no_index) return false;
        const double tolerance = widening * circle_tolerance(form.radius, facets_.noise);
        double least = infinity, most = -infinity;
        for (const uint32_t v : mesh_.triangles[triangle]) {
            const double excess = form.excess(mesh_.vertices[v]);
            least = std::min(least, excess);
            most = std::max(most, excess);
        }
        if (!(most <= tolerance) || !(least >= -tolerance - form.sagitta * form.radius))
            return false;
        const MeshFacet* facet = facet_of(triangle);
        if (!facet) return true; // a sliver
        const double lean = glm::dot(facet->normal, form.axis);
        if (std::abs(lean) > 0.999 && face_of_[triangle] != no_index) return false;
        // Vertices between the ends of a chord are below the circle, but in the plane of the chord;
        // and a rough form must not spread over a ball at its end.
        const bool loose = least >= -tolerance && widening == 1.0;
        return std::abs(lean - form.lean) <= (loose ? 0.2 : 2e-3);
    }

    /// Claims all connected triangles that fit; `widening` multiplies the tolerance.
    void grow(const RoundForm& form, std::span<const uint32_t> seeds, double widening) {
        const auto wall = static_cast<uint32_t>(result_.walls.size());
        claimed_.clear();
        const auto claim = [&](uint32_t t) {
            if (!fits(form, t, widening)) return;
            result_.wall_of[t] = wall;
            claimed_.push_back(t);
        };
        for (const uint32_t seed : seeds) claim(seed);
        for (size_t head = 0; head < claimed_.size(); ++head)
            for (uint32_t side = 3 * claimed_[head]; side < 3 * claimed_[head] + 3; ++side)
                if (sides_.mates[side] != no_index) claim(sides_.mates[side] / 3);
    }

    void release() {
        for (const uint32_t t : claimed_) result_.wall_of[t] = no_index;
    }

    /// The part of the ends of a set of triangles at which the surface goes on smoothly with
    /// similar facets, 0..1: a ring of a ball or of a fillet is no wall. `labels` tells what is in
    /// the set.
    double smooth_part(const Vec3& axis, std::span<const uint32_t> triangles,
                       const std::vector<uint32_t>& labels) const {
        double all = 0.0, part = 0.0;
        for (const uint32_t t : triangles)
            for (uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
                const uint32_t mate = sides_.mates[side];
                if (mate != no_index && labels[mate / 3] == labels[t]) continue;
                const Vec3 way = way_along(mesh_, side);
                const double across = glm::length(glm::cross(way, axis));
                if (across <= along_axis * glm::length(way)) continue;
                all += across;
                if (mate != no_index && goes_on(t, mate / 3)) part += across;
            }
        return all > 0.0 ? part / all : 0.0;
    }

    bool goes_on(uint32_t t, uint32_t u) const {
        const MeshFacet* a = facet_of(t);
        const MeshFacet* b = facet_of(u);
        return result_.wall_of[u] == no_index && a && b && a->curved && b->curved
               && glm::dot(a->normal, b->normal) > smooth_ && a->area <= similar_area * b->area
               && b->area <= similar_area * a->area;
    }

    /// How far the claimed triangles reach round the axis.
    double angle_round(const RoundForm& form) const {
        const Vec3 u = perpendicular(form.axis), v = glm::cross(form.axis, u);
        std::vector<double> angles;
        double widest = 0.0;
        for (const uint32_t t : claimed_) {
            std::array<double, 3> of_corner{};
            size_t count = 0;
            for (const uint32_t i : mesh_.triangles[t]) {
                const auto at = form.place(mesh_.vertices[i]);
                if (at.radius <= 1e-3 * form.radius) continue; // the tip of a cone
                of_corner[count++] = core::atan2(glm::dot(at.out, v), glm::dot(at.out, u));
            }
            for (size_t i = 0; i < count; ++i) {
                angles.push_back(of_corner[i]);
                const double apart = std::abs(of_corner[i] - of_corner[(i + 1) % count]);
                widest = std::max(widest, std::min(apart, full_turn - apart));
            }
        }
        if (angles.empty()) return 0.0;
        std::sort(angles.begin(), angles.end());
        double gap = full_turn + angles.front() - angles.back();
        for (size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
        return gap <= 1.01 * widest + 1e-9 ? full_turn : full_turn - gap;
    }

    /// Makes a wall of the claimed triangles; false if it has no length.
    bool keep(const RoundForm& form) {
        double low = infinity, high = -infinity, outwards = 0.0;
        for (const uint32_t t : claimed_) {
            for (const uint32_t i : mesh_.triangles[t]) {
                const double height = form.place(mesh_.vertices[i]).height;
                low = std::min(low, height);
                high = std::max(high, height);
            }
            outwards += outwards_part(form.origin, form.axis, t);
        }
        if (!(high - low > circle_tolerance(form.radius, facets_.noise))) return false;
        RoundWall wall;
        wall.from = form.origin + low * form.axis;
        wall.to = form.origin + high * form.axis;
        wall.radius_from = std::max(form.radius_at(low), 0.0);
        wall.radius_to = std::max(form.radius_at(high), 0.0);
        wall.angle = angle_round(form);
        wall.full = wall.angle == full_turn;
        wall.kind = outwards > 0.0 ? RoundKind::boss : RoundKind::bore;
        const auto number = static_cast<uint32_t>(result_.walls.size());
        result_.walls.push_back(wall);
        if (wall.full) join_rims(form, number, low, high);
        return true;
    }

    /// The area of a triangle, positive where it faces away from the axis.
    double outwards_part(const Vec3& origin, const Vec3& axis, uint32_t t) const {
        const Triangle triangle = mesh_.triangle(t);
        const Vec3 area = glm::cross(triangle.b - triangle.a, triangle.c - triangle.a);
        const Vec3 middle = (triangle.a + triangle.b + triangle.c) / 3.0 - origin;
        const Vec3 out = middle - glm::dot(middle, axis) * axis;
        const double length = glm::length(out);
        return length > 0.0 ? glm::dot(area, out) / length : 0.0;
    }

    void join_rims(const RoundForm& form, uint32_t number, double low, double high) {
        std::vector<uint32_t> triangles = claimed_;
        std::sort(triangles.begin(), triangles.end());
        const double tolerance = circle_tolerance(form.radius, facets_.noise);
        for (const auto& loop : border_loops(sides_, triangles, result_.wall_of, number)) {
            const double height = form.place(mesh_.vertices[start_of(mesh_, loop[0])]).height;
            const bool at_low = std::abs(height - low) <= tolerance;
            if (!at_low && std::abs(height - high) > tolerance) continue;
            if (const auto rim = circle_along(form, loop, height, at_low)) {
                RoundWall& wall = result_.walls[number];
                wall.rims[at_low ? 0 : 1] = *rim;
                uint32_t& of_rim = result_.circles[*rim].circle.wall;
                if (of_rim == no_index
                    || (wall.is_cylinder() && !result_.walls[of_rim].is_cylinder()))
                    of_rim = number;
            }
        }
    }

    /// The circle, new or known, that a border of a wall is.
    std::optional<uint32_t> circle_along(const RoundForm& form, const std::vector<uint32_t>& loop,
                                         double height, bool at_low) {
        const double radius = form.radius_at(height);
        const double tolerance = circle_tolerance(form.radius, facets_.noise);
        double angle = 0.0, widest = 0.0;
        for (const uint32_t side : loop) {
            const auto a = form.place(mesh_.vertices[start_of(mesh_, side)]);
            const auto b = form.place(mesh_.vertices[end_of(mesh_, side)]);
            if (std::abs(a.height - height) > tolerance
                || a.radius < (1.0 - form.sagitta) * radius - tolerance)
                return std::nullopt;
            const double turn =
                core::atan2(glm::dot(form.axis, glm::cross(a.out, b.out)), glm::dot(a.out, b.out));
            angle += turn;
            widest = std::max(widest, std::abs(turn));
        }
        if (std::abs(std::abs(angle) - full_turn) > 1e-6 || widest > widest_chord)
            return std::nullopt;
        const Vec3 center = form.origin + height * form.axis;
        const uint32_t known = circle_at_[start_of(mesh_, loop[0])];
        if (known != no_index) {
            const FeatureCircle& circle = result_.circles[known].circle;
            if (glm::distance(circle.center, center) <= 2.0 * tolerance
                && std::abs(circle.radius - radius) <= 2.0 * tolerance)
                return known;
        }
        RoundBorder rim;
        rim.circle.center = center;
        rim.circle.axis = at_low ? Vec3(0.0) - form.axis : form.axis;
        rim.circle.radius = radius;
        rim.circle.inscribed_radius = radius * core::cos(0.5 * widest);
        rim.circle.angle = full_turn;
        rim.circle.middle = mesh_.vertices[start_of(mesh_, loop[0])];
        rim.sides = loop;
        result_.circles.push_back(std::move(rim));
        const auto number = static_cast<uint32_t>(result_.circles.size() - 1);
        note_vertices(number);
        return number;
    }

    RoundKind kind_of(const RoundBorder& rim) const {
        if (rim.circle.wall != no_index) return result_.walls[rim.circle.wall].kind;
        double outwards = 0.0;
        for (const uint32_t side : rim.sides)
            if (sides_.mates[side] != no_index)
                outwards +=
                    outwards_part(rim.circle.center, rim.circle.axis, sides_.mates[side] / 3);
        return outwards > 0.0   ? RoundKind::boss
               : outwards < 0.0 ? RoundKind::bore
                                : RoundKind::unknown;
    }

    /// Whether a wall ends in a tip there.
    static bool has_tip(const RoundWall& wall, size_t end) {
        const double least = 1e-3 * std::max(wall.radius_from, wall.radius_to);
        return (end == 0 ? wall.radius_from : wall.radius_to) <= least;
    }

    /// A bore is closed by a face that fills its rim, by its own tip, or by that of the next wall.
    void find_open_ends() {
        std::vector<bool> closed(result_.circles.size());
        for (size_t c = 0; c < closed.size(); ++c) closed[c] = result_.circles[c].circle.outer;
        for (const RoundWall& wall : result_.walls)
            for (const size_t end : {0, 1})
                if (wall.rims[end] != no_index && has_tip(wall, 1 - end))
                    closed[wall.rims[end]] = true;
        for (RoundWall& wall : result_.walls)
            for (const size_t end : {0, 1}) {
                const uint32_t rim = wall.rims[end];
                wall.open[end] = wall.kind == RoundKind::bore && !has_tip(wall, end)
                                 && (rim == no_index || !closed[rim]);
            }
    }

    const Mesh& mesh_;
    const MeshSides& sides_;
    const MeshFacets& facets_;
    const std::vector<uint32_t>& face_of_;
    RoundFeatures result_;
    std::vector<uint32_t> circle_at_; // a whole circle through each vertex
    std::vector<uint32_t> claimed_;   // the triangles of the wall that grows
    std::vector<uint32_t> doubtful_;  // circles that may be at a cone
    uint32_t followed_ = 0;
    double smooth_ = core::cos(radians_of(smooth_angle_deg));
};

} // namespace

RoundFeatures round_features(const Mesh& mesh, const MeshSides& sides, const MeshFacets& facets,
                             const std::vector<uint32_t>& face_of,
                             std::vector<RoundBorder> circles) {
    return WallSearch(mesh, sides, facets, face_of, std::move(circles)).run();
}

} // namespace core
