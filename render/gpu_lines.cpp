#include "render/gpu_lines.h"

#include <algorithm>
#include <array>
#include <bit>

#include <epoxy/gl.h>

namespace render {
namespace {

using Texel = std::array<uint32_t, 4>;

/// As the shader of lines reads it.
Texel texel_of(const PathPoint& p) {
    return {std::bit_cast<uint32_t>(p.place.x), std::bit_cast<uint32_t>(p.place.y),
            std::bit_cast<uint32_t>(p.place.z),
            p.block << 4U | static_cast<uint32_t>(p.state) << 2U | (p.rapid ? 2U : 0U)
                | (p.begins ? 1U : 0U)};
}

} // namespace

void GpuLines::fill(std::span<const PathPoint> points) {
    chunks_.clear();
    size_ = points.size();
    if (!no_attributes_) no_attributes_ = GlVertexArray::make();
    std::vector<Texel> texels;
    for (size_t first = 0; first + 1 < points.size(); first += chunk) {
        const size_t last = std::min(first + chunk + 1, points.size());
        texels.clear();
        for (size_t i = first; i < last; ++i) texels.push_back(texel_of(points[i]));
        Chunk made{GlBuffer::make(), GlTexture::make()};
        glBindBuffer(GL_TEXTURE_BUFFER, made.buffer.id());
        glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(texels.size() * sizeof(Texel)),
                     texels.data(), GL_STATIC_DRAW);
        glBindTexture(GL_TEXTURE_BUFFER, made.texture.id());
        glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32UI, made.buffer.id());
        chunks_.push_back(std::move(made));
    }
}

void GpuLines::draw(size_t first, size_t last) const {
    if (chunks_.empty()) return;
    glBindVertexArray(no_attributes_.id());
    glActiveTexture(GL_TEXTURE0);
    // Piece i goes from point i to point i + 1.
    const size_t from = first > 0 ? first - 1 : 0, to = std::min(last, size_) - 1;
    for (size_t c = 0; c < chunks_.size(); ++c) {
        const size_t begin = std::max(from, c * chunk), end = std::min(to, (c + 1) * chunk);
        if (begin >= end) continue;
        glBindTexture(GL_TEXTURE_BUFFER, chunks_[c].texture.id());
        glDrawArrays(GL_TRIANGLES, static_cast<GLint>(6 * (begin - c * chunk)),
                     static_cast<GLsizei>(6 * (end - begin)));
    }
}

} // namespace render
