#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace core {

/// A solid from a file and the repairs that it needed.
struct MeshFile {
    Mesh mesh;
    std::vector<std::string> repairs; // one sentence each, without the file name
};

/// Reads a closed body from an STL (binary or text), OBJ, PLY or OFF file, chosen by extension.
///
/// Units:   mm, as in the file; single precision, as OpenMesh reads it.
/// Result:  closed, facing outwards, with shared vertices (see checked_solid).
/// Errors:  name the file and the problem, with the line, triangle or position if there is one. A
///          file is never read in part.
Result<MeshFile> read_mesh(const std::filesystem::path& path);

/// The two steps of it: the bytes of the file, and the body from them.
Result<std::string> read_mesh_bytes(const std::filesystem::path& path);
Result<MeshFile> read_mesh(const std::filesystem::path& path, std::string bytes);

/// One side of a triangle, on the edge between the vertices `low` < `high`.
struct EdgeUse {
    uint32_t low, high;
    uint32_t triangle;
    bool upwards; // the triangle runs along it from `low` to `high`
};

/// All sides of all triangles, sorted so that those of one edge are adjacent.
std::vector<EdgeUse> edge_uses(const Mesh& mesh);

/// The end of the run of uses of one edge that starts at `first`.
size_t end_of_edge(const std::vector<EdgeUse>& uses, size_t first);

/// The shell of each triangle; shells are numbered from 0 in the order of their first triangles.
struct Shells {
    std::vector<uint32_t> of_triangle;
    uint32_t count = 0;
};

/// Divides a closed mesh into closed shells. Shells that share only an edge are separate.
Shells shells_of(const Mesh& mesh);

/// Flips triangles so that neighbours across an edge of two agree; the first triangle of each
/// connected piece stays. Returns the number of flipped triangles.
size_t turn_to_agree(Mesh& mesh);

/// Flips inward-facing shells that no other shell encloses, each with everything inside it. Returns
/// the number of flipped shells.
size_t turn_outwards(Mesh& mesh);

/// Makes a solid of triangles, or says why they do not form one.
///
/// Result:  coinciding vertices are shared; triangles that use a vertex twice are removed; every
///          edge is used equally often in both directions; outer shells face outwards, and an
///          inward-facing shell inside another stays a cavity. Each change except sharing vertices
///          adds a sentence to `repairs`. Shells may overlap.
/// Errors:  no triangles; a coordinate that is not finite or beyond 1e6 mm; open edges (how many,
///          and where one is); a one-sided surface; no volume.
Result<Mesh> checked_solid(Mesh mesh, std::vector<std::string>& repairs);

} // namespace core
