#pragma once

#include "render/body_pass.h"

namespace render {

/// Works out how dark it is in corners and hollows, from the depths of what is opaque.
class HollowPass {
public:
    static core::Result<HollowPass> make();

    /// A texture over the whole picture, 1 where nothing darkens; 0 if the card has no room for it.
    /// At half the picture's size.
    unsigned draw(const ViewFrame& frame, BodyPass& bodies);

private:
    bool resize(const Viewport& size);

    ShaderProgram hollows_, smooth_;
    Viewport size_{0, 0};
    GlTexture depths_, rough_, result_;
    GlFramebuffer to_depths_, to_rough_, to_result_;
    GlVertexArray no_attributes_;
};

} // namespace render
