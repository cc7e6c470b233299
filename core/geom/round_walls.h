#pragma once

#include <cstdint>
#include <vector>

#include "core/geom/face_borders.h"

namespace core {

/// The round walls of a mesh and all circles: those of planar faces, which are given, and those at
/// which walls end. Joins circles and walls, and says on which side the material is.
struct RoundFeatures {
    std::vector<RoundBorder> circles;
    std::vector<RoundWall> walls;
    std::vector<uint32_t> wall_of; // of each triangle
};
RoundFeatures round_features(const Mesh& mesh, const MeshSides& sides, const MeshFacets& facets,
                             const std::vector<uint32_t>& face_of,
                             std::vector<RoundBorder> circles);

} // namespace core
