#include "core/geom/face_borders.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/math.h"
#include "core/geom/circle_fit.h"

namespace core {
namespace {

using Vec2 = glm::dvec2;

constexpr double finest_coarse_chord = 0.56; // radians; wider chords must be of equal length
constexpr double least_arc = std::numbers::pi / 2;
constexpr double bend_change = 0.15; // of the curvature within an arc

/// The angle from a to b, -pi..pi.
double angle_between(const Vec2& a, const Vec2& b) {
    return core::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b));
}

const Vec3& point_at(const Mesh& mesh, const std::vector<uint32_t>& sides, size_t i) {
    return mesh.vertices[start_of(mesh, sides[i % sides.size()])];
}

/// A place on the border that no straight piece can go past: the farthest from its first vertex.
size_t farthest_place(const Mesh& mesh, const std::vector<uint32_t>& sides) {
    size_t best = 0;
    double farthest = -1.0;
    for (size_t i = 0; i < sides.size(); ++i) {
        const Vec3 apart = point_at(mesh, sides, i) - point_at(mesh, sides, 0);
        if (glm::dot(apart, apart) <= farthest) continue;
        farthest = glm::dot(apart, apart);
        best = i;
    }
    return best;
}

bool in_line(const Vec3& from, const Vec3& p, const Vec3& to, double tolerance) {
    const Vec3 way = to - from;
    const double length = glm::length(way);
    return length > 0.0 && glm::length(glm::cross(p - from, way)) <= tolerance * length
           && glm::dot(p - from, to - p) > 0.0;
}

/// Fills in the corners of a border.
void mark_corners(const Mesh& mesh, FaceBorder& border, const std::vector<uint32_t>& others,
                  double noise) {
    const size_t count = border.sides.size(), first = farthest_place(mesh, border.sides);
    size_t anchor = first;
    border.corners.push_back(static_cast<uint32_t>(first));
    for (size_t i = first + 1; i < first + count; ++i) {
        // Of vertices at one place only the first counts.
        if (glm::distance(point_at(mesh, border.sides, anchor), point_at(mesh, border.sides, i))
            <= 2.0 * noise)
            continue;
        if (others[i % count] == others[(i - 1) % count]
            && in_line(point_at(mesh, border.sides, anchor), point_at(mesh, border.sides, i),
                       point_at(mesh, border.sides, i + 1), 3.0 * noise))
            continue;
        anchor = i;
        border.corners.push_back(static_cast<uint32_t>(i % count));
    }
}

double enclosed_area(const Mesh& mesh, const FaceBorder& border, const Vec3& normal) {
    const Vec3& origin = point_at(mesh, border.sides, 0);
    Vec3 sum(0.0);
    for (size_t i = 0; i < border.sides.size(); ++i)
        sum += glm::cross(point_at(mesh, border.sides, i) - origin,
                          point_at(mesh, border.sides, i + 1) - origin);
    return 0.5 * glm::dot(sum, normal);
}

/// Looks for circles in one border, in the plane of its face.
class RoundSearch {
public:
    RoundSearch(const Mesh& mesh, const FaceBorder& border, const std::array<Vec3, 2>& axes,
                const Vec3& normal, double noise)
        : mesh_(mesh), border_(border), axes_(axes), normal_(normal), noise_(noise) {
        origin_ = point_at(mesh, border.sides, border.corners[0]);
        for (const uint32_t corner : border.corners) {
            const Vec3 p = point_at(mesh, border.sides, corner) - origin_;
            points_.emplace_back(glm::dot(p, axes[0]), glm::dot(p, axes[1]));
        }
    }

    std::vector<RoundBorder> run() {
        if (points_.size() >= 8 && offer(0, points_.size(), true)) return std::move(found_);
        if (points_.size() >= 4) find_arcs();
        return std::move(found_);
    }

private:
    const Vec2& point(size_t i) const { return points_[i % points_.size()]; }

    Vec3 place(const Vec2& p) const { return origin_ + p.x * axes_[0] + p.y * axes_[1]; }

    /// Whether the straight pieces first .. first + count - 1 are a circle or arc; if so, keeps it.
    bool offer(size_t first, size_t count, bool whole) {
        std::vector<Vec2> on_it;
        for (size_t i = first; i < first + count + (whole ? 0 : 1); ++i) on_it.push_back(point(i));
        const auto fit = fitted_circle(on_it);
        if (!fit) return false;
        const double tolerance = circle_tolerance(fit->radius, noise_);
        if (fit->error > tolerance) return false;
        double least = infinity, most = 0.0, sum = 0.0;
        for (size_t i = first; i < first + count; ++i) {
            const double chord = angle_between(point(i) - fit->center, point(i + 1) - fit->center);
            least = std::min(least, std::abs(chord));
            most = std::max(most, std::abs(chord));
            sum += chord;
        }
        if (most > widest_chord || (most > finest_coarse_chord && most > 1.1 * least)) return false;
        const double angle = std::abs(sum), full = 2.0 * std::numbers::pi;
        const double wanted = least_arc - 2.0 * tolerance / fit->radius; // both ends may be off
        if (whole ? std::abs(angle - full) > 1e-6 : angle < wanted) return false;
        keep(*fit, first, count, whole ? full : std::min(angle, full), most, whole);
        const Vec2 start = point(first) - fit->center;
        const double half = 0.5 * sum, c = core::cos(half), s = core::sin(half);
        const Vec2 middle =
            fit->center + Vec2(c * start.x - s * start.y, s * start.x + c * start.y);
        found_.back().circle.middle = place(middle);
        return true;
    }

    void keep(const FlatCircle& fit, size_t first, size_t count, double angle, double widest,
              bool whole) {
        RoundBorder part;
        part.circle.center = place(fit.center);
        part.circle.axis = normal_;
        part.circle.radius = fit.radius;
        part.circle.inscribed_radius = fit.radius * core::cos(0.5 * widest);
        part.circle.arc = !whole;
        part.circle.angle = angle;
        const size_t sides = border_.sides.size(), pieces = points_.size();
        for (size_t i = first; i < first + count; ++i) {
            const size_t end = border_.corners[(i + 1) % pieces];
            for (size_t k = border_.corners[i % pieces]; k != end; k = (k + 1) % sides)
                part.sides.push_back(border_.sides[k]);
        }
        found_.push_back(std::move(part));
    }

    /// The curvature at a corner of chords; 0 where the border has a sharp corner.
    double bend(size_t i) const {
        const Vec2 before = point(i) - point(i + points_.size() - 1);
        const Vec2 after = point(i + 1) - point(i);
        const double turn = angle_between(before, after);
        return std::abs(turn) > widest_chord
                   ? 0.0
                   : 2.0 * turn / (glm::length(before) + glm::length(after));
    }

    /// Runs of corners with about the same curvature.
    void find_arcs() {
        const size_t count = points_.size();
        std::vector<double> bends;
        for (size_t i = 0; i < count; ++i) bends.push_back(bend(i));
        const auto goes_on = [&](size_t i) {
            const double a = bends[i % count], b = bends[(i + count - 1) % count];
            return a * b > 0.0 && std::abs(a - b) <= bend_change * std::abs(b);
        };
        size_t start = 0;
        while (start < count && goes_on(start)) ++start;
        if (start == count) return; // the same bend all round, but no circle
        for (size_t i = start; i < start + count;) {
            size_t end = i + 1;
            while (end < start + count && goes_on(end)) ++end;
            // The chords on either side of the corners i .. end - 1.
            if (end - i >= 2) offer(i + count - 1, std::min(end - i + 1, count), false);
            i = end;
        }
    }

    const Mesh& mesh_;
    const FaceBorder& border_;
    std::array<Vec3, 2> axes_;
    Vec3 normal_;
    double noise_;
    Vec3 origin_ = Vec3(0.0);
    std::vector<Vec2> points_;
    std::vector<RoundBorder> found_;
};

} // namespace

uint32_t FaceBorder::side_of_piece(const Mesh& mesh, size_t piece) const {
    const size_t end = corners[(piece + 1) % corners.size()];
    uint32_t best = sides[corners[piece]];
    double longest = -1.0;
    for (size_t k = corners[piece]; k != end; k = (k + 1) % sides.size()) {
        const double length = glm::distance(point_at(mesh, sides, k), point_at(mesh, sides, k + 1));
        if (length <= longest) continue;
        longest = length;
        best = sides[k];
    }
    return best;
}

std::vector<FaceBorder> borders_of(const Mesh& mesh, const MeshSides& sides,
                                   const MeshFacets& facets, uint32_t facet,
                                   const std::vector<uint32_t>& face_of) {
    struct Ranked {
        double area;
        FaceBorder border;
    };
    std::vector<Ranked> ranked;
    for (auto& loop : border_loops(sides, facets.triangles_of(facet), facets.of_triangle, facet)) {
        std::vector<uint32_t> others;
        for (const uint32_t side : loop) {
            const uint32_t mate = sides.mates[side];
            others.push_back(mate == no_index ? no_index : face_of[mate / 3]);
        }
        FaceBorder border{std::move(loop), {}};
        mark_corners(mesh, border, others, facets.noise);
        if (border.corners.size() < 3) continue;
        ranked.push_back(
            {enclosed_area(mesh, border, facets.facets[facet].normal), std::move(border)});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const Ranked& a, const Ranked& b) { return a.area > b.area; });
    std::vector<FaceBorder> borders;
    for (Ranked& r : ranked) borders.push_back(std::move(r.border));
    return borders;
}

std::vector<RoundBorder> round_parts(const Mesh& mesh, const FaceBorder& border,
                                     const std::array<Vec3, 2>& axes, const Vec3& normal,
                                     double noise) {
    return RoundSearch(mesh, border, axes, normal, noise).run();
}

} // namespace core
