#pragma once

#include <memory>

#include "core/base/result.h"
#include "render/camera.h"
#include "render/canvas.h"
#include "render/scene.h"

namespace render {

struct DrawOptions {
    Theme theme = Theme::dark;
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
