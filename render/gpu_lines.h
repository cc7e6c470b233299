#pragma once

#include <span>
#include <vector>

#include "render/gl_objects.h"
#include "render/tool_path.h"

namespace render {

/// Pieces of a path on the graphics card, in textures of as many points as every card takes.
class GpuLines {
public:
    static constexpr size_t chunk = 65535; // pieces to a texture

    void fill(std::span<const PathPoint> points);
    /// Draws the pieces that end at points first .. last - 1 with the program in use.
    void draw(size_t first, size_t last) const;
    size_t size() const { return size_; }

private:
    struct Chunk {
        GlBuffer buffer;
        GlTexture texture;
    };
    std::vector<Chunk> chunks_;
    size_t size_ = 0;
    GlVertexArray no_attributes_;
};

} // namespace render
