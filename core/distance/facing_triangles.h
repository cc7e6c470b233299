#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/geom/mesh.h"

namespace core {

/// The triangles of a mesh that face along Z (`up`) or against it, seen along Z at least `graze`
/// wide.
std::vector<Triangle> facing_triangles(const Mesh& mesh, const Transform& travel_from_mesh, bool up,
                                       double graze);

/// How far a triangle can move along Z until it meets another one.
///
/// Result:  the least gap along Z where one is above the other, at least 0. Empty if that region is
///          at most `graze` wide, or if the moving triangle is above it by more than `sunk`
///          everywhere.
std::optional<double> way_between(const Triangle& moving, const Triangle& fixed, double graze,
                                  double sunk);

/// A tree of boxes around triangles, for searches along Z.
class TriangleStack {
public:
    explicit TriangleStack(std::vector<Triangle> triangles);

    /// Calls `visit` for the triangles whose boxes overlap `box` seen along Z and that are above it
    /// by less than the result of `limit`, which may fall meanwhile, and not below it altogether
    /// by more than `sunk`.
    void for_each_above(const Aabb& box, double sunk, const std::function<double()>& limit,
                        const std::function<void(const Triangle&)>& visit) const;

private:
    struct Node {
        Aabb box;
        uint32_t first = 0; // leaf: first triangle; inner: left child, the right one follows
        uint32_t count = 0; // 0 for an inner node
    };
    void divide(uint32_t node, uint32_t first, uint32_t count);

    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

} // namespace core
