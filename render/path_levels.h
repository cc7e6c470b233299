#pragma once

#include <vector>

#include "render/camera.h"
#include "render/tool_path.h"

namespace render {

/// The path with fewer points: none that was left out is farther than `tolerance` from the piece
/// that passes it by. Pieces become one only if they are of one state and both rapids or not; it
/// belongs to the last of their blocks.
std::vector<PathPoint> simplified(const std::vector<PathPoint>& points, double tolerance);

/// Points first .. last - 1 of a path, whose pieces are drawn.
struct PathRange {
    size_t first = 0, last = 0;

    bool operator==(const PathRange&) const = default;
};

/// The stretches of a path that may be seen in a picture, in order, those side by side as one.
std::vector<PathRange> visible_ranges(const ToolPath& path, const Mat4& clip_from_scene);

/// Millimetres that a pixel covers where the path is nearest to the eye.
double nearest_pixel(const ToolPath& path, const Camera& camera, const Viewport& viewport);

} // namespace render
