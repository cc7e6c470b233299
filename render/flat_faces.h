#pragma once

#include <span>

#include "render/triangle_mesh.h"

namespace render {

/// A quad of a surface on a lattice, round one of its edges: triangles 2 i and 2 i + 1 are quad i.
struct LatticeQuad {
    uint8_t axis = 0;              // of the edge
    std::array<uint8_t, 3> node{}; // where the edge begins, below lattice_side
    bool flat = false;             // its corners stand in the middle of cells, on one plane
};

constexpr size_t lattice_side = 34;

/// The same surface with fewer triangles, for drawing alone: quads that lie side by side on one
/// plane across an axis, in one colour, become rectangles. These stand out over their neighbours by
/// a tenth of a cell, so that no gap shows where corners do not meet.
///
/// Cost: linear in the quads.
TriangleMesh with_large_faces(const TriangleMesh& mesh, std::span<const LatticeQuad> quads);

} // namespace render
