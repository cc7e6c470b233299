#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/view/ui/panel.h"
#include "render/camera.h"

namespace app::viewer {

/// Arrows, squares and rings in the view, with which the selected body is moved along X, Y and Z,
/// in their planes, and turned about them.
class Gizmo {
public:
    /// What has become of a drag.
    struct Drag {
        bool takes_mouse = false;          // the mouse is over it, or drags it
        std::optional<core::Transform> by; // of a drag in progress, frame of the scene
        bool is_done = false;              // the button was released: `by` is to be applied
        std::string words;                 // how far, for the user
    };

    /// Draws it at a point of the scene and takes the mouse. Lengths snap to 1 mm or 0.05 inch,
    /// with Ctrl to a tenth of that, with Shift not at all; angles to 15 degrees, with Ctrl to 1
    /// degree. Esc drops a drag.
    Drag draw(Frame& frame, const Area& area, const render::Viewport& size,
              const core::Vec3& center, bool can_turn);

private:
    enum class Handle : uint8_t { none, axis, plane, ring };
    /// A handle: its kind, and the axis along, across or about which it moves.
    struct Grip {
        Handle kind = Handle::none;
        int axis = 0;

        bool operator==(const Grip&) const = default;
    };
    struct Place; // of the gizmo in the picture

    std::optional<core::Vec3> grasped_at(const Place& place, const Grip& grip) const;
    Grip under_mouse(const Place& place, bool can_turn) const;
    void draw_handles(const Place& place, const Grip& bright, bool can_turn) const;
    core::Transform moved(const Frame& frame, std::string& words) const;

    Grip grip_;                 // that is dragged
    core::Vec3 center_, begin_; // of the gizmo and of the grasp, when the drag began
    core::Vec3 now_;
};

} // namespace app::viewer
