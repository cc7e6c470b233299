#pragma once

#include "app/viewer/command.h"
#include "app/viewer/fonts.h"
#include "app/viewer/look.h"
#include "app/viewer/view_model.h"

namespace app::viewer {

/// A part of the window, pixels.
struct Area {
    float x = 0, y = 0, width = 0, height = 0;

    ImVec2 corner() const { return {x, y}; }
    ImVec2 far_corner() const { return {x + width, y + height}; }
    ImVec2 size() const { return {width, height}; }
};

/// What a panel needs to draw one frame.
struct Frame {
    ViewModel& model;
    const Fonts& fonts;
    Look look;
    double now = 0.0; // seconds

    float px(double length) const { return static_cast<float>(length * fonts.scale); }
    /// Does what a key would do.
    void perform(Command command);
};

/// A part of the window that follows the current block. Needs an ImGui context.
class Panel {
public:
    virtual ~Panel() = default;
    virtual void draw(Frame& frame, const Area& area) = 0;
};

} // namespace app::viewer
