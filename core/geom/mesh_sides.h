#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geom/mesh.h"
#include "core/geom/mesh_features.h"

namespace core {

/// Which triangles of a mesh are neighbours. Side k of triangle t, numbered 3 t + k, runs from
/// corner k to the next one.
struct MeshSides {
    std::vector<uint32_t>
        mates;                // the side that runs the other way along the same edge, or no_index
    std::vector<bool> usable; // triangles with three different corners that exist and are finite

    static uint32_t triangle_of(uint32_t side) { return side / 3; }
    static uint32_t next(uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
};

/// Result:  only an edge that exactly two usable triangles share, one in each direction, has mates.
/// Cost:    O(n), some 0.1 s for a million triangles.
MeshSides sides_of(const Mesh& mesh);

/// The vertex at which a side starts.
inline uint32_t start_of(const Mesh& mesh, uint32_t side) {
    return mesh.triangles[side / 3][side % 3];
}

/// The vertex at which a side ends.
inline uint32_t end_of(const Mesh& mesh, uint32_t side) {
    return start_of(mesh, MeshSides::next(side));
}

/// The sides around a set of triangles, in order: the set is on the left of each loop.
///
/// `labels` has an entry for each triangle of the mesh; the set is made of all triangles with
/// `label`, and `triangles` lists them.
std::vector<std::vector<uint32_t>> border_loops(const MeshSides& sides,
                                                std::span<const uint32_t> triangles,
                                                const std::vector<uint32_t>& labels,
                                                uint32_t label);

} // namespace core
