#pragma once

#include <memory>

#include "core/base/result.h"
#include "render/camera.h"
#include "render/gl_objects.h"
#include "render/image.h"
#include "render/scene.h"

namespace render {

/// The target of a drawing: a texture that a user interface can show.
///
/// All functions, the destructor included, need the context in which it was created.
class Canvas {
public:
    /// `samples`: 1 during motion; 4 for a still picture with smooth edges.
    static core::Result<Canvas> make(const Viewport& size, int samples = 1);

    const Viewport& size() const { return size_; }
    int samples() const { return samples_; }
    /// The finished picture, its first row at the bottom as usual in OpenGL.
    unsigned texture() const { return color_.id(); }
    /// The framebuffer with that texture, so that more can be drawn over the scene.
    unsigned framebuffer() const { return framebuffer_.id(); }

    /// Directs drawing to this canvas.
    void begin();
    /// Resolves the drawing into the texture.
    void finish();
    Image pixels() const;

private:
    Viewport size_;
    int samples_ = 1;
    GlTexture color_;
    GlRenderbuffer depth_, many_color_, many_depth_;
    GlFramebuffer framebuffer_, many_;
};

struct DrawOptions {
    ColorScheme theme = ColorScheme::dark;
    double scale = 1.0;       // of lines and points, for high-resolution screens
    bool hollows = false;     // ambient occlusion, for still pictures
    bool edges = true;        // lines along the edges of bodies and stock
    bool rough = false;       // fixtures and machine with few triangles, unless they are cut
    bool path_on_top = false; // hidden parts of the path are drawn faintly
};

/// Draws scenes with OpenGL 3.3 core. Uploaded data stays on the graphics card as long as scenes
/// share it.
class Renderer {
public:
    /// Needs a current context, whose functions libepoxy loads.
    ///
    /// Errors:  unsupported, if the context is older than 3.3 or its compiler rejects the shaders.
    static core::Result<Renderer> make();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;
    ~Renderer();

    /// Draws a scene into the canvas. Changes the state of OpenGL.
    void draw(const Scene& scene, const Camera& camera, const DrawOptions& options, Canvas& canvas);

private:
    struct Parts;
    explicit Renderer(std::unique_ptr<Parts> parts);

    std::unique_ptr<Parts> parts_;
};

/// A still picture with ambient occlusion, drawn at twice the size and halved for smooth edges.
core::Result<Image> still_picture(Renderer& renderer, const Scene& scene, const Camera& camera,
                                  const DrawOptions& options, const Viewport& size);

} // namespace render
