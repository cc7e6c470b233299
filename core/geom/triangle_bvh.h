#pragma once

#include <cstdint>
#include <vector>

#include "core/geom/gjk.h"
#include "core/geom/mesh.h"
#include "core/geom/oriented_box.h"

namespace core {

/// Boxes round the triangles of a mesh, for searches that need few of them.
struct TriangleBvh {
    struct Node {
        Aabb box;
        uint32_t first =
            0; // leaf: first of `count` triangles; inner: left child, the right follows
        uint32_t count = 0; // 0 for an inner node

        bool is_leaf() const { return count > 0; }
    };
    std::vector<Node> nodes;           // root first; empty for an empty mesh
    std::vector<OrientedBox> oriented; // round each node as well, tighter
    std::vector<Triangle> triangles;
    std::vector<uint32_t> ids; // of `triangles` in the mesh
};

TriangleBvh build_bvh(const Mesh& mesh);

/// The distance from a convex shape to the surface of a mesh.
///
/// Result: `upper` is infinite when nothing is found within `goal.limit`, and `lower` at most the
///         limit. The inside of the mesh does not count: a shape wholly inside has a distance to
///         the surface.
/// Cost:   O(log n) near the surface, O(n) at worst.
Separation separation(const ConvexShape& shape, const TriangleBvh& mesh,
                      const SeparationGoal& goal = {});

/// The triangles whose boxes meet `box`, in the order of the mesh.
std::vector<uint32_t> triangles_in(const TriangleBvh& mesh, const Aabb& box);

} // namespace core
