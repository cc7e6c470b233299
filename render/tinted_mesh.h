#pragma once

#include "render/triangle_mesh.h"

namespace render {

/// Triangles in one list of corners, each with the tint of its colour.
struct TintedMesh {
    core::Mesh mesh;
    std::vector<uint8_t> tints; // of triangles
};

/// The mesh as it is drawn: with normals, and twin corners between tints.
TriangleMesh shaded(const TintedMesh& tinted);

} // namespace render
