#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/geom/gjk.h"
#include "core/geom/mesh.h"

namespace core {

/// A box with any orientation.
struct OrientedBox {
    Vec3 center = Vec3(0.0);
    Mat3 axes = Mat3(1.0); // one per column, at right angles
    Vec3 half = Vec3(0.0); // half sizes along them

    /// Half the extent along a direction of length 1.
    double half_along(const Vec3& direction) const {
        return glm::dot(glm::abs(direction * axes), half);
    }
};

/// Deviation of the columns from an orthonormal basis: the sum of the entries of |M'M - 1|.
double lean(const Mat3& m);

/// Upper bound of lean() of the axes of fitted boxes.
constexpr double box_lean = 2e-15;

/// A box around the triangles, rounding included: along their principal axes, along the longest
/// side of one of them, or along the axes of the frame, whichever has the least surface.
OrientedBox fitted_box(std::span<const Triangle> triangles);

inline OrientedBox moved(const OrientedBox& box, const Transform& target_from_box) {
    return {target_from_box * box.center, target_from_box.rotation * box.axes, box.half};
}

/// A lower bound of the distance of two boxes while the second moves straight by `sweep`: exact
/// where their faces are parallel. Rounding is not subtracted.
double distance_bound(const OrientedBox& a, const OrientedBox& b, const Vec3& sweep);

/// A bounding volume hierarchy of the triangles of a mesh.
struct TriangleBvh {
    struct Node {
        Aabb box;
        uint32_t first =
            0; // leaf: first of `count` triangles; inner: left child, the right follows
        uint32_t count = 0; // 0 for an inner node

        bool is_leaf() const { return count > 0; }
    };
    std::vector<Node> nodes;           // root first; empty for an empty mesh
    std::vector<OrientedBox> oriented; // for each node, tighter than its box
    std::vector<Triangle> triangles;
    std::vector<uint32_t> ids; // of `triangles` in the mesh
};

TriangleBvh build_bvh(const Mesh& mesh);

/// The distance from a convex shape to the surface of a mesh.
///
/// Result:  `upper` is infinite if nothing is within `goal.limit`; `lower` is at most the limit.
///          The inside of the mesh does not count: a shape wholly inside has a distance to the
///          surface.
/// Cost:    O(log n) near the surface, O(n) at worst.
Separation separation(const ConvexShape& shape, const TriangleBvh& mesh,
                      const SeparationGoal& goal = {});

/// The least distance between the surfaces of two meshes while B moves straight from its pose by
/// `sweep_of_b`.
///
/// Frame:   A's.
/// Result:  both bounds hold, rounding included; they differ by at most goal.tolerance plus twice
///          the rounding (some 1e-10 mm within 1 m). Surfaces closer than 1e-10 mm touch: 0.
///          `upper` is infinite if nothing is within `goal.limit`; `lower` is at most the limit.
///          The inside of the meshes does not count.
/// Cost:    some thousand pairs of boxes and some ten pairs of triangles; ends at once where the
///          surfaces meet. A sweep costs more, as its triangles are compared by GJK.
Separation separation(const TriangleBvh& a, const TriangleBvh& b, const Transform& a_from_b,
                      const Vec3& sweep_of_b, const SeparationGoal& goal = {});

/// The triangles whose boxes overlap `box`, in mesh order.
std::vector<uint32_t> triangles_in(const TriangleBvh& mesh, const Aabb& box);

} // namespace core
