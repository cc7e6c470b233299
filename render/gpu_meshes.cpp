#include "render/gpu_meshes.h"

#include <cstddef>

#include <epoxy/gl.h>

namespace render {
namespace {

/// Pictures after which a mesh that none of them showed is given back.
constexpr uint64_t patience = 30;

template <typename T>
void fill(GLenum target, const GlBuffer& buffer, const std::vector<T>& data) {
    glBindBuffer(target, buffer.id());
    glBufferData(target, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(),
                 GL_STATIC_DRAW);
}

void describe(unsigned index, int size, GLenum type, bool share, size_t stride, size_t offset) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, size, type, share ? GL_TRUE : GL_FALSE,
                          static_cast<GLsizei>(stride),
                          reinterpret_cast<const void*>(offset)); // NOLINT: as OpenGL wants it
}

GpuMesh uploaded(const SharedMesh& mesh) {
    GpuMesh made;
    made.of = mesh;
    made.index_count = static_cast<int>(3 * mesh->triangles.size());
    made.line_count = static_cast<int>(2 * mesh->edges.size());
    made.faces = GlVertexArray::make();
    made.vertices = GlBuffer::make();
    made.indices = GlBuffer::make();
    glBindVertexArray(made.faces.id());
    fill(GL_ARRAY_BUFFER, made.vertices, mesh->vertices);
    fill(GL_ELEMENT_ARRAY_BUFFER, made.indices, mesh->triangles);
    constexpr size_t stride = sizeof(MeshVertex);
    describe(0, 3, GL_FLOAT, false, stride, offsetof(MeshVertex, place));
    describe(1, 3, GL_BYTE, true, stride, offsetof(MeshVertex, normal));
    describe(2, 1, GL_UNSIGNED_BYTE, false, stride, offsetof(MeshVertex, tint));
    if (made.line_count > 0) {
        made.lines = GlVertexArray::make();
        made.line_ends = GlBuffer::make();
        glBindVertexArray(made.lines.id());
        fill(GL_ARRAY_BUFFER, made.line_ends, mesh->edges);
        describe(0, 3, GL_FLOAT, false, sizeof(glm::vec3), 0);
    }
    glBindVertexArray(0);
    return made;
}

} // namespace

void GpuMesh::draw_faces() const {
    glBindVertexArray(faces.id());
    glDrawElements(GL_TRIANGLES, index_count, GL_UNSIGNED_INT, nullptr);
}

void GpuMesh::draw_lines() const {
    if (line_count == 0) return;
    glBindVertexArray(lines.id());
    glDrawArrays(GL_LINES, 0, line_count);
}

const GpuMesh& GpuMeshes::of(const SharedMesh& mesh) {
    auto found = meshes_.find(mesh.get());
    if (found == meshes_.end()) found = meshes_.emplace(mesh.get(), uploaded(mesh)).first;
    found->second.used = picture_;
    return found->second;
}

void GpuMeshes::end_picture() {
    std::erase_if(meshes_,
                  [&](const auto& entry) { return entry.second.used + patience < picture_; });
    ++picture_;
}

} // namespace render
