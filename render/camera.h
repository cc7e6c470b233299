#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "core/base/vec.h"

namespace render {

using core::Aabb;
using core::Vec3;
using Vec2 = glm::dvec2;
using Mat4 = glm::dmat4;

/// The size of a picture, pixels. Positions in it are (x, y) from its upper left corner; the centre
/// of the first pixel is (0.5, 0.5).
struct Viewport {
    int width = 1, height = 1;

    double aspect() const { return static_cast<double>(width) / height; }
};

enum class Projection : uint8_t { perspective, orthographic };

/// Keys 0 to 6, in this order.
enum class StandardView : uint8_t { iso, top, front, right, back, left, bottom };

/// Position and direction of the view. Frame: the scene's, Z up.
struct Camera {
    Vec3 target = Vec3(0.0);             // centre of the view and of rotation
    double distance = 400.0;             // from the eye to the target, mm
    double yaw = -0.7853981633974483;    // of the eye around Z, from +X towards +Y
    double pitch = 0.6154797086703873;   // of the eye above the XY plane, -90..90 degrees
    double view_angle = 0.5235987755983; // over the height of the picture
    Projection projection = Projection::perspective;

    bool operator==(const Camera&) const = default;
};

/// The directions of the picture, unit length.
struct CameraAxes {
    Vec3 right, up, backward; // backward: from the target to the eye
};

CameraAxes axes(const Camera& camera);
Vec3 eye(const Camera& camera);

/// Frame of the view: the eye is at the origin and looks along -Z; Y is up in the picture.
Mat4 view_from_scene(const Camera& camera);

/// OpenGL clip coordinates; the near and far planes enclose `content`.
Mat4 clip_from_view(const Camera& camera, const Viewport& viewport, const Aabb& content);

/// The size of a pixel at a point, mm.
double pixel_size(const Camera& camera, const Viewport& viewport, const Vec3& at);

/// A half line; `direction` has unit length.
struct Ray {
    Vec3 origin = Vec3(0.0);
    Vec3 direction = Vec3(0.0, 0.0, -1.0);
};

/// The ray through a position in the picture.
Ray ray_through(const Camera& camera, const Viewport& viewport, const Vec2& position);

/// The position of a point in the picture and its depth along the view, mm; empty if it is behind
/// the eye.
struct Projected {
    Vec2 position;
    double depth = 0.0;
};
std::optional<Projected> project(const Camera& camera, const Viewport& viewport, const Vec3& point);

/// The point under a position in the picture, in the plane across the view through `level`.
Vec3 point_under(const Camera& camera, const Viewport& viewport, const Vec2& position,
                 const Vec3& level);

/// Rotates the eye about the target by a drag in pixels; the height of the picture is half a turn.
Camera orbited(const Camera& camera, const Viewport& viewport, const Vec2& drag);

/// Moves so that a point at the depth of `level` follows a drag from `from` to `to`.
Camera panned(const Camera& camera, const Viewport& viewport, const Vec2& from, const Vec2& to,
              const Vec3& level);

/// Moves closer (factor below 1) or farther; the point under the cursor stays in place. `at` is
/// that point if a surface was hit; otherwise the depth of the target is used.
Camera zoomed(const Camera& camera, const Viewport& viewport, const Vec2& cursor, double factor,
              std::optional<Vec3> at = {});

/// The same target and distance from a standard direction.
Camera seen_from(const Camera& camera, StandardView view);

/// The same direction, with the whole box in the picture and a border of `margin` of its height.
Camera framing(const Camera& camera, const Viewport& viewport, const Aabb& box,
               double margin = 0.06);

/// Whether a part of the box may be in the picture. False only if none of it is.
bool may_be_seen(const Aabb& box, const Mat4& clip_from_box);

/// Whether at least a part of the box is in the picture, and not too small to be noticed.
bool is_in_sight(const Camera& camera, const Viewport& viewport, const Aabb& box);

} // namespace render
