#include "render/tool_path.h"

#include <algorithm>

namespace render {
namespace {

/// The box of the pieces that end at points first .. last - 1.
core::Aabb box_of(const std::vector<PathPoint>& points, size_t first, size_t last) {
    core::Aabb box;
    for (size_t i = first; i < last; ++i) {
        if (points[i].begins || i == 0) continue;
        box.extend(core::Vec3(points[i - 1].place));
        box.extend(core::Vec3(points[i].place));
    }
    return box;
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
    const auto begin = path.points.begin();
    const auto first = std::partition_point(begin, path.points.end(),
                                            [&](const PathPoint& p) { return p.block < block; });
    const auto last = std::partition_point(first, path.points.end(),
                                           [&](const PathPoint& p) { return p.block == block; });
    if (first == last) return {0, 0};
    return {static_cast<size_t>(first - begin), static_cast<size_t>(last - begin)};
}

core::Aabb bounds_of_block(const ToolPath& path, uint32_t block) {
    const auto [first, last] = points_of_block(path, block);
    return box_of(path.points, first, last);
}

} // namespace render
