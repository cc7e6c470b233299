#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace core {

/// A solid from a file, and what had to be put right for it to be one.
struct MeshFile {
    Mesh mesh;
    std::vector<std::string> repairs; // one sentence each, without the file's name
};

/// Reads a closed body from an STL (binary or text), OBJ, PLY or OFF file, by its extension.
///
/// Units:  mm, as the file has them; in single precision, as OpenMesh reads them.
/// Result: closed, facing outwards, corners shared (see checked_solid).
/// Errors: name the file and what is wrong with it, with the line, triangle or place where there is
///         one. A mesh is never silently a part of what the file holds.
Result<MeshFile> read_mesh(const std::filesystem::path& path);

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

/// Makes a solid of triangles, or says why they are none.
///
/// Result: corners that coincide are shared; triangles that name a corner twice are gone; every
/// edge
///         is passed as often one way as the other; outer shells face outwards, and a shell
///         inside another that faces inwards stays a cavity. Each change but the sharing of
///         corners adds a sentence to `repairs`. Shells may overlap.
/// Errors: no triangles, a coordinate that is not finite or beyond 1e6 mm, open edges (how many,
/// and
///         where one is), a surface with one side only, no volume.
Result<Mesh> checked_solid(Mesh mesh, std::vector<std::string>& repairs);

} // namespace core
