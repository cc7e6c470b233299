#pragma once

#include "app/view/ui/gizmo.h"
#include "app/view/ui/panel.h"
#include "render/camera.h"

namespace render {
struct Pick;
struct Scene;
} // namespace render

namespace app::viewer {

/// What is drawn over the view while the set-up is edited: the handles of the selected body, and
/// the features that can be clicked. Takes the mouse for them.
class PlacingOverlay {
public:
    /// Draws the handles of the selected body, and moves it. Whether they take the mouse. To be
    /// called right after the item of the view.
    bool draw_handles(Frame& frame, const Area& area, const render::Viewport& size);
    /// Finds what is under the mouse while a feature is waited for.
    void find_picks(Frame& frame, const Area& area, const render::Viewport& size,
                    const render::Scene& scene);
    /// Draws what a click would mean.
    void draw_picks(Frame& frame, const Area& area, const render::Viewport& size);
    /// Takes a click if a feature is waited for.
    bool take_pick_click(Frame& frame);
    /// Selects what was clicked, if the set-up is shown.
    bool take_selection(ViewModel& model, const render::Pick& found, const render::Scene& scene);

private:
    Gizmo gizmo_;
    render::Vec2 last_ = render::Vec2(-1.0); // position of the mouse
};

} // namespace app::viewer
