#include "render/tool_path.h"

#include <algorithm>

namespace render {
namespace {

/// The box of the pieces that end at points first .. last - 1.
core::Aabb box_of(const std::vector<PathPoint>& points, size_t first, size_t last) {
    core::Aabb box;
    for (size_t i = first; i < last; ++i) {
        if (points[i].begins || i == 0) continue;
        box.extend(core::Vec3(points[i - 1].position));
        box.extend(core::Vec3(points[i].position));
    }
    return box;
}

/// The range of the points of a block, possibly empty: first and one past the last.
std::pair<size_t, size_t> range_of_block(const std::vector<PathPoint>& points, uint32_t block) {
    const auto first = std::partition_point(points.begin(), points.end(),
                                            [&](const PathPoint& p) { return p.block < block; });
    const auto last = std::partition_point(first, points.end(),
                                           [&](const PathPoint& p) { return p.block == block; });
    return {first - points.begin(), last - points.begin()};
}

/// Length of the piece that ends at a point.
double piece_length(const std::vector<PathPoint>& points, size_t end) {
    if (end == 0 || points[end].begins) return 0.0;
    return glm::distance(core::Vec3(points[end - 1].position), core::Vec3(points[end].position));
}

} // namespace

ToolPath tool_path(std::vector<PathPoint> points) {
    ToolPath path;
    path.points = std::move(points);
    for (size_t i = 0; i < path.points.size(); i += ToolPath::stretch)
        path.boxes.push_back(
            box_of(path.points, i, std::min(i + ToolPath::stretch, path.points.size())));
    for (size_t i = 0; i < path.boxes.size(); ++i) {
        if (i % ToolPath::group == 0) path.groups.emplace_back();
        path.groups.back().extend(path.boxes[i]);
        path.bounds.extend(path.boxes[i]);
    }
    return path;
}

std::pair<size_t, size_t> points_of_block(const ToolPath& path, uint32_t block) {
    const auto [first, last] = range_of_block(path.points, block);
    return first == last ? std::pair<size_t, size_t>() : std::pair(first, last);
}

ToolPath path_near(const ToolPath& path, uint32_t block, const PathReach& reach) {
    const auto [begin, end] = range_of_block(path.points, block);
    size_t first = begin, last = end;
    for (double way = 0.0; first > 0 && begin - first < reach.most; --first) {
        if (first == path.points.size()) continue;
        if (path.points[first].block + reach.before < block && way > reach.length_before) break;
        way += piece_length(path.points, first);
    }
    for (double way = 0.0; last < path.points.size() && last - end < reach.most; ++last) {
        if (path.points[last].block > block + reach.after && way > reach.length_after) break;
        way += piece_length(path.points, last);
    }
    if (first == last) return {};
    std::vector<PathPoint> near(path.points.begin() + static_cast<std::ptrdiff_t>(first),
                                path.points.begin() + static_cast<std::ptrdiff_t>(last));
    near.front().begins = true;
    return tool_path(std::move(near));
}

core::Aabb bounds_of_block(const ToolPath& path, uint32_t block) {
    const auto [first, last] = points_of_block(path, block);
    return box_of(path.points, first, last);
}

} // namespace render
