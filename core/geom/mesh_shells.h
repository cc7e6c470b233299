#pragma once

#include <cstdint>
#include <vector>

#include "core/geom/mesh.h"

namespace core {

/// One side of a triangle, at the edge between the corners `low` < `high`.
struct EdgeUse {
    uint32_t low, high;
    uint32_t triangle;
    bool upwards; // the triangle passes it from `low` to `high`
};

/// Every side of every triangle, sorted so that those of one edge follow each other.
std::vector<EdgeUse> edge_uses(const Mesh& mesh);

/// The end of the run of uses of the edge that begins at `first`.
size_t end_of_edge(const std::vector<EdgeUse>& uses, size_t first);

/// Which shell each triangle belongs to, counted from 0 in the order of their first triangles.
struct Shells {
    std::vector<uint32_t> of_triangle;
    uint32_t count = 0;
};

/// Divides a closed mesh into shells, each of them closed. Shells that share an edge only stay
/// apart.
Shells shells_of(const Mesh& mesh);

/// Turns triangles so that neighbours across an edge of two agree; the first triangle of each
/// connected piece stays. Returns how many were turned.
size_t turn_to_agree(Mesh& mesh);

/// Turns the shells that face inwards though nothing is around them, each with all that it holds.
/// Returns how many were turned.
size_t turn_outwards(Mesh& mesh);

} // namespace core
