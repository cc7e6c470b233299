#include "render/tinted_mesh.h"

namespace render {
namespace {

/// Gives the corners of a mesh tints, and those that need two a twin.
class TintPainter {
public:
    explicit TintPainter(TriangleMesh& mesh)
        : mesh_(mesh), twins_(mesh.vertices.size(), 0), is_painted_(mesh.vertices.size(), false) {}

    /// The corner that has this tint.
    uint32_t painted(uint32_t corner, uint8_t tint) {
        if (!is_painted_[corner]) mesh_.vertices[corner].tint = tint;
        is_painted_[corner] = true;
        if (mesh_.vertices[corner].tint == tint) return corner;
        if (twins_[corner] == 0) {
            twins_[corner] = static_cast<uint32_t>(mesh_.vertices.size());
            MeshVertex twin = mesh_.vertices[corner];
            twin.tint = tint;
            mesh_.vertices.push_back(twin);
        }
        return twins_[corner];
    }

private:
    TriangleMesh& mesh_;
    std::vector<uint32_t> twins_; // 0: none
    std::vector<bool> is_painted_;
};

} // namespace

TriangleMesh shaded(const TintedMesh& tinted) {
    TriangleMesh mesh = shaded(tinted.mesh);
    TintPainter painter(mesh);
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint32_t& corner : mesh.triangles[t])
            corner = painter.painted(corner, tinted.tints[t]);
    return mesh;
}

} // namespace render
