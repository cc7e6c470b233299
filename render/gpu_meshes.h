#pragma once

#include <unordered_map>

#include "render/gl_objects.h"
#include "render/triangle_mesh.h"

namespace render {

/// A mesh on the graphics card.
struct GpuMesh {
    GlVertexArray faces, lines;
    GlBuffer vertices, indices, line_ends;
    int index_count = 0, line_count = 0;
    SharedMesh of; // keeps its address
    uint64_t used = 0;

    void draw_faces() const;
    void draw_lines() const;
};

/// Meshes that were drawn of late.
class GpuMeshes {
public:
    /// The mesh on the card, brought there if need be.
    const GpuMesh& of(const SharedMesh& mesh);
    /// To be called after each picture: gives back what has not been drawn for a while.
    void end_picture();

private:
    std::unordered_map<const TriangleMesh*, GpuMesh> meshes_;
    uint64_t picture_ = 0;
};

} // namespace render
