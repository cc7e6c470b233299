#pragma once

#include "core/base/result.h"
#include "render/camera.h"
#include "render/gl_objects.h"
#include "render/image.h"

namespace render {

/// What a scene is drawn into: a texture that a user interface can show.
///
/// All of it needs the context that it was made in to be current, its end too.
class Canvas {
public:
    /// `samples`: 1 while things move; 4 for a still picture with smooth edges.
    static core::Result<Canvas> make(const Viewport& size, int samples = 1);

    const Viewport& size() const { return size_; }
    int samples() const { return samples_; }
    /// The finished picture, its first row at the bottom, as OpenGL has it.
    unsigned texture() const { return color_.id(); }
    /// The framebuffer with that texture, so that more can be drawn over the scene.
    unsigned framebuffer() const { return framebuffer_.id(); }

    /// Draws go here from now on.
    void begin();
    /// Brings what was drawn into the texture.
    void finish();
    Image pixels() const;

private:
    Viewport size_;
    int samples_ = 1;
    GlTexture color_;
    GlRenderbuffer depth_, many_color_, many_depth_;
    GlFramebuffer framebuffer_, many_;
};

} // namespace render
