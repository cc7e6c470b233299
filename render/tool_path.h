#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/vec.h"
#include "render/palette.h"

namespace render {

/// A corner of the tip's path, with the attributes of the piece that ends here. 20 bytes.
struct PathPoint {
    glm::vec3 position = glm::vec3(0.0F); // frame of the stock
    uint32_t block = 0;
    ClearanceState state = ClearanceState::none;
    bool rapid = false;
    bool begins = false; // no piece ends here: a new path begins
    uint8_t spare = 0;

    bool operator==(const PathPoint&) const = default;
};

/// The path of a whole program, with boxes around ranges of it for fast picking.
struct ToolPath {
    static constexpr size_t stretch = 64; // pieces per box
    static constexpr size_t group = 32;   // boxes per box of the second level

    std::vector<PathPoint> points;
    std::vector<core::Aabb> boxes;  // box i: the pieces that end at points stretch * i ...
    std::vector<core::Aabb> groups; // of `group` boxes each
    core::Aabb bounds;
};

using SharedPath = std::shared_ptr<const ToolPath>;

/// Builds the boxes.
ToolPath tool_path(std::vector<PathPoint> points);

/// The points of a block: first and one past the last; both 0 if it has none. Block numbers must
/// not decrease along the path.
std::pair<size_t, size_t> points_of_block(const ToolPath& path, uint32_t block);

/// How much of a path is shown near a block: at least this many blocks before and after it, and
/// more until this length is shown.
struct PathReach {
    uint32_t before = 30, after = 8;                   // blocks
    double length_before = 150.0, length_after = 40.0; // mm
    size_t most = 1000;                                // points on either side
};

/// The part of a path near a block, even if the block does not move.
ToolPath path_near(const ToolPath& path, uint32_t block, const PathReach& reach);

/// The box of the pieces of a block; empty if it has none.
core::Aabb bounds_of_block(const ToolPath& path, uint32_t block);

} // namespace render
