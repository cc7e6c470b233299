#pragma once

#include <memory>

#include "core/base/result.h"
#include "render/camera.h"
#include "render/gl_objects.h"
#include "render/image.h"
#include "render/scene.h"

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

struct DrawOptions {
    ColorScheme theme = ColorScheme::dark;
    double scale = 1.0;       // of lines and points, for screens with many pixels
    bool hollows = false;     // darker corners; for pictures that stand still
    bool edges = true;        // lines along the edges of bodies and stock
    bool path_on_top = false; // the path also where something hides it, faintly
};

/// Draws scenes with OpenGL 3.3 core. What was drawn stays on the graphics card as long as scenes
/// go on sharing it.
class Renderer {
public:
    /// Needs a current context, whose libraries libepoxy loads.
    ///
    /// Errors: unsupported, if the context is older than 3.3 or its compiler refuses the shaders.
    static core::Result<Renderer> make();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;
    ~Renderer();

    /// The picture of a scene, in the canvas when this returns. Changes OpenGL's state.
    void draw(const Scene& scene, const Camera& camera, const DrawOptions& options, Canvas& canvas);

private:
    struct Parts;
    explicit Renderer(std::unique_ptr<Parts> parts);

    std::unique_ptr<Parts> parts_;
};

/// A still picture: drawn at twice the size and halved, so that edges and lines are smooth, with
/// darker corners.
core::Result<Image> still_picture(Renderer& renderer, const Scene& scene, const Camera& camera,
                                  const DrawOptions& options, const Viewport& size);

} // namespace render
