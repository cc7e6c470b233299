#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "core/base/vec.h"

namespace render {

using core::Aabb;
using core::Vec3;
using Vec2 = glm::dvec2;
using Mat4 = glm::dmat4;

/// The size of a picture, pixels. Places in it are (x, y) from its upper left corner; the middle of
/// the first pixel is (0.5, 0.5).
struct Viewport {
    int width = 1, height = 1;

    double aspect() const { return static_cast<double>(width) / height; }
};

enum class Projection : uint8_t { perspective, orthographic };

/// Keys 0 to 6, in this order.
enum class StandardView : uint8_t { iso, top, front, right, back, left, bottom };

/// Where the eye stands and looks. Frame: that of what is drawn, Z upwards.
struct Camera {
    Vec3 target = Vec3(0.0);             // what it looks at and turns about
    double distance = 400.0;             // from the eye to the target, mm
    double yaw = -0.7853981633974483;    // where the eye stands round Z, from +X towards +Y
    double pitch = 0.6154797086703873;   // how far above the XY plane it stands, -90..90 degrees
    double view_angle = 0.5235987755983; // of the picture's height
    Projection projection = Projection::perspective;

    bool operator==(const Camera&) const = default;
};

/// The directions of the picture, of length 1.
struct CameraAxes {
    Vec3 right, up, backward; // backward: from the target to the eye
};

CameraAxes axes(const Camera& camera);
Vec3 eye(const Camera& camera);

/// Frame of the view: the eye at the origin looks along -Z, Y is up in the picture.
Mat4 view_from_scene(const Camera& camera);

/// OpenGL's clip coordinates; near and far planes hold all of `content`.
Mat4 clip_from_view(const Camera& camera, const Viewport& viewport, const Aabb& content);

/// Millimetres that a pixel covers at a point.
double pixel_size(const Camera& camera, const Viewport& viewport, const Vec3& at);

/// A half line; `direction` has length 1.
struct Ray {
    Vec3 origin = Vec3(0.0);
    Vec3 direction = Vec3(0.0, 0.0, -1.0);
};

/// What is seen at a place of the picture.
Ray ray_through(const Camera& camera, const Viewport& viewport, const Vec2& place);

/// Where a point is seen, and how far from the eye along the view, mm; empty behind the eye.
struct Projected {
    Vec2 place;
    double depth = 0.0;
};
std::optional<Projected> project(const Camera& camera, const Viewport& viewport, const Vec3& point);

/// The point under a place of the picture in the plane across the view through `level`.
Vec3 point_under(const Camera& camera, const Viewport& viewport, const Vec2& place,
                 const Vec3& level);

/// Turns the eye about the target by a drag of so many pixels; the picture's height is half a turn.
Camera orbited(const Camera& camera, const Viewport& viewport, const Vec2& drag);

/// The same about another point, which stays where it is seen.
Camera orbited(const Camera& camera, const Viewport& viewport, const Vec2& drag, const Vec3& pivot);

/// Moves so that what is seen at the depth of `level` follows a drag from `from` to `to`.
Camera panned(const Camera& camera, const Viewport& viewport, const Vec2& from, const Vec2& to,
              const Vec3& level);

/// Goes nearer (factor below 1) or farther; the point under the cursor stays there. `at` is that
/// point where something was hit; without it the one at the target's depth counts.
Camera zoomed(const Camera& camera, const Viewport& viewport, const Vec2& cursor, double factor,
              std::optional<Vec3> at = {});

/// The same target and distance, seen from a standard side.
Camera seen_from(const Camera& camera, StandardView view);

/// The same directions, with the whole box in the picture, `margin` of its height free all round.
Camera framing(const Camera& camera, const Viewport& viewport, const Aabb& box,
               double margin = 0.06);

/// A view on the way from one to the other, for soft changes: `a` at 0, `b` at 1.
Camera between(const Camera& a, const Camera& b, double share);

} // namespace render
