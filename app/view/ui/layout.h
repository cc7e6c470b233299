#pragma once

#include <memory>

#include "app/view/ui/panels.h"
#include "app/view/ui/popups.h"
#include "app/view/ui/scene_panel.h"

namespace app::viewer {

/// All panels and where they stand. Needs a current OpenGL context and an ImGui context, and no
/// window: pictures are made by the same functions.
class Layout {
public:
    explicit Layout(render::Renderer renderer) : scene_(std::move(renderer)) {}

    /// Draws everything between ImGui's NewFrame and Render.
    void draw(ViewModel& model, const Fonts& fonts, double now);

    ScenePanel& scene() { return scene_; }

private:
    /// Where everything stands; what is not shown has no width.
    struct Parts {
        Area toolbar, list, view, device, inspector, timeline;
    };

    static Parts parts_of(const Frame& frame, const Area& area);
    void draw_body(Frame& frame, const Area& area);
    void draw_splitters(Frame& frame, const Parts& parts);

    ToolbarPanel toolbar_;
    ProgramPanel program_;
    FindingsPanel findings_;
    ScenePanel scene_;
    InspectorPanel inspector_;
    DevicePanel device_;
    TimelinePanel timeline_;
    PopupPanel popups_;
    WelcomePanel welcome_;
    ErrorPanel error_;
};

} // namespace app::viewer
