#include "render/camera.h"

#include <array>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_access.hpp>

#include "core/base/math.h"

namespace render {
namespace {

constexpr double pi = std::numbers::pi;

/// Limits of the zoom: a thousandth of a millimetre and a kilometre.
constexpr double least_distance = 0.05, most_distance = 1e6;

double half_angle_tangent(const Camera& camera) { return core::tan(0.5 * camera.view_angle); }

/// Half the height of the picture at the target, mm.
double half_height(const Camera& camera) { return camera.distance * half_angle_tangent(camera); }

/// The position in the picture in units of half its height from its centre, Y up.
Vec2 from_middle(const Viewport& viewport, const Vec2& position) {
    const double unit = 0.5 * viewport.height;
    return {(position.x - 0.5 * viewport.width) / unit,
            (0.5 * viewport.height - position.y) / unit};
}

double depth_of(const Camera& camera, const Vec3& point) {
    return glm::dot(eye(camera) - point, axes(camera).backward);
}

double wrapped(double angle) { return std::remainder(angle, 2.0 * pi); }

} // namespace

CameraAxes axes(const Camera& camera) {
    const double cy = core::cos(camera.yaw), sy = core::sin(camera.yaw);
    const double cp = core::cos(camera.pitch), sp = core::sin(camera.pitch);
    return {{-sy, cy, 0.0}, {-sp * cy, -sp * sy, cp}, {cp * cy, cp * sy, sp}};
}

Vec3 eye(const Camera& camera) { return camera.target + camera.distance * axes(camera).backward; }

Mat4 view_from_scene(const Camera& camera) {
    const CameraAxes a = axes(camera);
    const Vec3 from = eye(camera);
    Mat4 m(1.0);
    m = glm::row(m, 0, glm::dvec4(a.right, -glm::dot(a.right, from)));
    m = glm::row(m, 1, glm::dvec4(a.up, -glm::dot(a.up, from)));
    return glm::row(m, 2, glm::dvec4(a.backward, -glm::dot(a.backward, from)));
}

Mat4 clip_from_view(const Camera& camera, const Viewport& viewport, const Aabb& content) {
    const bool perspective = camera.projection == Projection::perspective;
    double near = 0.01 * camera.distance, far = 2.0 * camera.distance;
    if (!content.empty()) {
        const double reach = 0.5 * glm::length(content.size()) * 1.01 + 0.1;
        const double middle = depth_of(camera, content.center());
        near = middle - reach;
        far = std::max(middle + reach, near + 1.0);
    }
    if (perspective) {
        far = std::max(far, 0.02 * camera.distance);
        near = std::max({near, far * 1e-4, 0.005 * camera.distance});
    }
    Mat4 m(0.0);
    const double scale = perspective ? half_angle_tangent(camera) : half_height(camera);
    m[0][0] = 1.0 / (scale * viewport.aspect());
    m[1][1] = 1.0 / scale;
    if (perspective) {
        m[2][2] = -(far + near) / (far - near);
        m[3][2] = -2.0 * far * near / (far - near);
        m[2][3] = -1.0;
    } else {
        m[2][2] = -2.0 / (far - near);
        m[3][2] = -(far + near) / (far - near);
        m[3][3] = 1.0;
    }
    return m;
}

double pixel_size(const Camera& camera, const Viewport& viewport, const Vec3& at) {
    const double depth =
        camera.projection == Projection::perspective ? depth_of(camera, at) : camera.distance;
    return 2.0 * depth * half_angle_tangent(camera) / viewport.height;
}

Ray ray_through(const Camera& camera, const Viewport& viewport, const Vec2& position) {
    const CameraAxes a = axes(camera);
    const Vec2 at = from_middle(viewport, position);
    const Vec3 across = at.x * a.right + at.y * a.up;
    if (camera.projection == Projection::perspective)
        return {eye(camera), glm::normalize(half_angle_tangent(camera) * across - a.backward)};
    // Start far behind the eye: without perspective nothing is too close.
    const Vec3 from = eye(camera) + half_height(camera) * across;
    return {from + most_distance * 0.1 * a.backward, -a.backward};
}

std::optional<Projected> project(const Camera& camera, const Viewport& viewport,
                                 const Vec3& point) {
    const CameraAxes a = axes(camera);
    const Vec3 off = point - camera.target;
    const double depth = camera.distance - glm::dot(off, a.backward);
    const bool perspective = camera.projection == Projection::perspective;
    if (perspective && depth <= 1e-6 * camera.distance) return std::nullopt;
    const double half = half_angle_tangent(camera) * (perspective ? depth : camera.distance);
    const double unit = 0.5 * viewport.height / half;
    return Projected{{0.5 * viewport.width + unit * glm::dot(off, a.right),
                      0.5 * viewport.height - unit * glm::dot(off, a.up)},
                     depth};
}

Vec3 point_under(const Camera& camera, const Viewport& viewport, const Vec2& position,
                 const Vec3& level) {
    const Ray ray = ray_through(camera, viewport, position);
    const Vec3 across = axes(camera).backward;
    return ray.origin
           + glm::dot(level - ray.origin, across) / glm::dot(ray.direction, across) * ray.direction;
}

Camera orbited(const Camera& camera, const Viewport& viewport, const Vec2& drag) {
    Camera turned = camera;
    const double angle = pi / viewport.height;
    turned.yaw = wrapped(camera.yaw - drag.x * angle);
    turned.pitch = std::clamp(camera.pitch + drag.y * angle, -0.5 * pi, 0.5 * pi);
    return turned;
}

Camera panned(const Camera& camera, const Viewport& viewport, const Vec2& from, const Vec2& to,
              const Vec3& level) {
    Camera moved = camera;
    moved.target +=
        point_under(camera, viewport, from, level) - point_under(camera, viewport, to, level);
    return moved;
}

Camera zoomed(const Camera& camera, const Viewport& viewport, const Vec2& cursor, double factor,
              std::optional<Vec3> at) {
    const double distance = std::clamp(camera.distance * factor, least_distance, most_distance);
    const double fraction = distance / camera.distance;
    const Vec3 fixed = at.value_or(point_under(camera, viewport, cursor, camera.target));
    Camera moved = camera;
    moved.distance = distance;
    // The whole view shrinks towards the fixed point, so this keeps its place in the picture.
    moved.target = fixed + fraction * (camera.target - fixed);
    return moved;
}

Camera seen_from(const Camera& camera, StandardView view) {
    struct Angles {
        double yaw, pitch;
    };
    static const std::array<Angles, 7> angles = {{{-0.25 * pi, core::atan(std::sqrt(0.5))},
                                                  {-0.5 * pi, 0.5 * pi},
                                                  {-0.5 * pi, 0.0},
                                                  {0.0, 0.0},
                                                  {0.5 * pi, 0.0},
                                                  {pi, 0.0},
                                                  {-0.5 * pi, -0.5 * pi}}};
    Camera turned = camera;
    turned.yaw = angles[static_cast<size_t>(view)].yaw;
    turned.pitch = angles[static_cast<size_t>(view)].pitch;
    return turned;
}

Camera framing(const Camera& camera, const Viewport& viewport, const Aabb& box, double margin) {
    if (box.empty()) return camera;
    Camera framed = camera;
    framed.target = box.center();
    const CameraAxes a = axes(camera);
    const double tangent = half_angle_tangent(camera);
    const double room = 1.0 - 2.0 * margin;
    double distance = least_distance;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p((corner & 1) != 0 ? box.max.x : box.min.x,
                     (corner & 2) != 0 ? box.max.y : box.min.y,
                     (corner & 4) != 0 ? box.max.z : box.min.z);
        const Vec3 off = p - framed.target;
        const double nearer =
            camera.projection == Projection::perspective ? glm::dot(off, a.backward) : 0.0;
        const double wide = std::abs(glm::dot(off, a.right)) / (viewport.aspect() * room);
        const double high = std::abs(glm::dot(off, a.up)) / room;
        distance = std::max(distance, nearer + std::max(wide, high) / tangent);
    }
    framed.distance = std::clamp(std::max(distance, 1.0), least_distance, most_distance);
    return framed;
}

bool may_be_seen(const core::Aabb& box, const Mat4& clip_from_box) {
    if (box.empty()) return false;
    std::array<int, 6> beyond{};
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec4 p = clip_from_box
                             * glm::dvec4((corner & 1) != 0 ? box.max.x : box.min.x,
                                          (corner & 2) != 0 ? box.max.y : box.min.y,
                                          (corner & 4) != 0 ? box.max.z : box.min.z, 1.0);
        for (size_t i = 0; i < 3; ++i) {
            const double along = p[static_cast<int>(i)];
            beyond[2 * i] += along < -1.02 * p.w ? 1 : 0;
            beyond[2 * i + 1] += along > 1.02 * p.w ? 1 : 0;
        }
    }
    return std::none_of(beyond.begin(), beyond.end(), [](int count) { return count == 8; });
}

bool is_in_sight(const Camera& camera, const Viewport& viewport, const Aabb& box) {
    constexpr double least_size = 0.02; // of the height of the picture
    if (box.empty()) return false;
    Vec2 low(core::infinity), high(-core::infinity);
    int behind = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const auto seen = project(camera, viewport,
                                  {(corner & 1) != 0 ? box.max.x : box.min.x,
                                   (corner & 2) != 0 ? box.max.y : box.min.y,
                                   (corner & 4) != 0 ? box.max.z : box.min.z});
        if (!seen) {
            ++behind;
            continue;
        }
        low = glm::min(low, seen->position);
        high = glm::max(high, seen->position);
    }
    if (behind > 0) return behind < 8; // around the eye
    return high.x > 0.0 && high.y > 0.0 && low.x < viewport.width && low.y < viewport.height
           && std::max(high.x - low.x, high.y - low.y) >= least_size * viewport.height;
}

} // namespace render
