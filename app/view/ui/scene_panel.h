#pragma once

#include <optional>

#include "app/view/model/scene_of.h"
#include "app/view/ui/panel.h"
#include "render/renderer.h"

namespace app::viewer {

/// The machine, the work and the path, with the witness line and its number. The picture is kept
/// in a texture and drawn anew only when something has changed.
class ScenePanel : public Panel {
public:
    explicit ScenePanel(render::Renderer renderer) : renderer_(std::move(renderer)) {}

    void draw(Frame& frame, const Area& area) override;
    /// 4: smooth edges, for pictures; 1: fast.
    void set_samples(int samples) { samples_ = samples; }

private:
    void place_camera(ViewModel& model, const render::Viewport& size);
    void render_scene(Frame& frame, const render::Viewport& size);
    void take_mouse(Frame& frame, const Area& area, const render::Viewport& size);
    void take_drag(ViewModel& model, const render::Viewport& size);
    void take_click(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_labels(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_witness(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_measure(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_axes(Frame& frame, const Area& area);

    render::Renderer renderer_;
    std::optional<render::Canvas> canvas_;
    SceneKey drawn_;
    render::Scene scene_;
    int samples_ = 1;
    uint64_t framed_ = 0;                          // the opening that the camera was placed for
    render::Vec2 last_hover_ = render::Vec2(-1.0); // of the mouse
    std::optional<size_t> hovered_;                // the block of the path there
};

} // namespace app::viewer
