#pragma once

#include "render/gl_objects.h"
#include "render/ground.h"
#include "render/view_frame.h"

namespace render {

/// Draws the ground: the shadow of the work, and the grid.
class GroundPass {
public:
    static core::Result<GroundPass> make();

    /// Call after the opaque bodies, which hide the ground.
    void draw(const ViewFrame& frame);

private:
    void bring(const Scene& scene);
    void draw_shadow(const ViewFrame& frame) const;
    void draw_grid(const ViewFrame& frame);

    ShaderProgram shadows_, grids_;
    GlVertexArray no_attributes_, lines_;
    GlBuffer line_ends_;
    GlTexture shadow_;
    ShadowKey shown_;
    ShadowMask mask_; // without its values
    bool has_shadow_ = false;
};

} // namespace render
