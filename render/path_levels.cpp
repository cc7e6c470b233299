#include "render/path_levels.h"

#include <algorithm>

namespace render {
namespace {

/// Points that one piece may stand for: bounds the search, which looks at all of them again.
constexpr size_t most = 48;

bool go_together(const PathPoint& a, const PathPoint& b) {
    return !b.begins && a.state == b.state && a.rapid == b.rapid;
}

double distance_to(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 by = b - a;
    const float size = glm::dot(by, by);
    const float share = size > 0.0F ? std::clamp(glm::dot(p - a, by) / size, 0.0F, 1.0F) : 0.0F;
    return glm::distance(p, a + share * by);
}

/// Whether the piece from one point to another passes all between them by.
bool stands_for(const std::vector<PathPoint>& points, size_t from, size_t to, double tolerance) {
    for (size_t i = from + 1; i < to; ++i)
        if (distance_to(points[i].place, points[from].place, points[to].place) > tolerance)
            return false;
    return true;
}

bool may_be_seen(const core::Aabb& box, const Mat4& clip) {
    if (box.empty()) return false;
    std::array<int, 6> beyond{};
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec4 p = clip
                             * glm::dvec4((corner & 1) != 0 ? box.max.x : box.min.x,
                                          (corner & 2) != 0 ? box.max.y : box.min.y,
                                          (corner & 4) != 0 ? box.max.z : box.min.z, 1.0);
        for (size_t i = 0; i < 3; ++i) {
            const double along = p[static_cast<int>(i)];
            beyond[2 * i] += along < -1.02 * p.w ? 1 : 0;
            beyond[2 * i + 1] += along > 1.02 * p.w ? 1 : 0;
        }
    }
    return std::none_of(beyond.begin(), beyond.end(), [](int count) { return count == 8; });
}

} // namespace

std::vector<PathPoint> simplified(const std::vector<PathPoint>& points, double tolerance) {
    std::vector<PathPoint> kept;
    if (points.empty()) return kept;
    kept.push_back(points[0]);
    for (size_t at = 0; at + 1 < points.size();) {
        size_t to = at + 1;
        while (to + 1 < points.size() && to - at < most && !points[at + 1].begins
               && go_together(points[to], points[to + 1])
               && stands_for(points, at, to + 1, tolerance))
            ++to;
        kept.push_back(points[to]);
        at = to;
    }
    return kept;
}

std::vector<PathRange> visible_ranges(const ToolPath& path, const Mat4& clip_from_scene) {
    std::vector<PathRange> ranges;
    for (size_t g = 0; g < path.groups.size(); ++g) {
        if (!may_be_seen(path.groups[g], clip_from_scene)) continue;
        const size_t end = std::min((g + 1) * ToolPath::group, path.boxes.size());
        for (size_t b = g * ToolPath::group; b < end; ++b) {
            if (!may_be_seen(path.boxes[b], clip_from_scene)) continue;
            const size_t first = b * ToolPath::stretch;
            const size_t last = std::min(first + ToolPath::stretch, path.points.size());
            if (!ranges.empty() && ranges.back().last == first)
                ranges.back().last = last;
            else
                ranges.push_back({first, last});
        }
    }
    return ranges;
}

double nearest_pixel(const ToolPath& path, const Camera& camera, const Viewport& viewport) {
    if (camera.projection == Projection::orthographic || path.bounds.empty())
        return pixel_size(camera, viewport, camera.target);
    const Vec3 nearest = glm::clamp(eye(camera), path.bounds.min, path.bounds.max);
    const double away = glm::distance(nearest, eye(camera));
    return pixel_size(camera, viewport, eye(camera) - away * axes(camera).backward);
}

} // namespace render
