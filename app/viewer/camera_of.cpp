#include "app/viewer/camera_of.h"

#include <algorithm>

#include "app/viewer/scene_of.h"
#include "render/picking.h"

namespace app::viewer {
namespace {

/// How much is seen round the pair at least, mm.
constexpr double least_room = 22.0;

/// Whether something that is not seen through stands between the eye and a point.
bool is_hidden(const render::Scene& scene, const render::Camera& camera, const core::Vec3& point) {
    const core::Vec3 eye = render::eye(camera);
    const double far = glm::length(point - eye);
    const render::Ray ray{eye, (point - eye) / far};
    const double reach = far - 0.5;
    if (const auto hit = render::pick_stock(scene, ray); hit && hit->at.distance < reach)
        return true;
    const auto body = render::pick_body(scene, ray, false);
    return body && body->at.distance < reach;
}

/// The camera's direction first, then those that turn it more and more.
std::vector<render::Camera> sides(const render::Camera& camera) {
    std::vector<render::Camera> all;
    for (const double pitch : {std::clamp(camera.pitch, 0.15, 0.9), 0.25, 0.6, 1.1})
        for (const int step : {0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6}) {
            render::Camera side = camera;
            side.yaw += step * 0.5235987755982988;
            side.pitch = pitch;
            all.push_back(side);
        }
    std::stable_sort(all.begin(), all.end(), [&](const auto& a, const auto& b) {
        const auto turn = [&](const render::Camera& c) {
            return std::abs(c.yaw - camera.yaw) + std::abs(c.pitch - camera.pitch);
        };
        return turn(a) < turn(b);
    });
    return all;
}

} // namespace

render::Camera witness_camera(const ViewModel& model, const render::Viewport& size) {
    core::Aabb box;
    if (!model.has_rows()) return model.camera;
    const BlockRow& row = model.row();
    if (!row.has_witness()) {
        if (model.path)
            box = render::bounds_of_block(*model.path, static_cast<uint32_t>(model.cursor.block));
        return box.empty() ? model.camera : render::framing(model.camera, size, box.grown(8.0));
    }
    box.extend(row.on_tool);
    box.extend(row.on_body);
    // Where a part passes through a body the pair may lie anywhere along the way: the tip is shown
    // as well.
    if (const auto tip = tip_now(model); tip && row.verdict == core::Verdict::collision)
        box.extend(*tip);
    const double apart = glm::length(row.on_tool - row.on_body);
    box = box.grown(std::max(least_room, 1.2 * apart));
    const core::Vec3 middle = 0.5 * (row.on_tool + row.on_body);
    const render::Scene scene = scene_of(model);
    for (const render::Camera& side : sides(model.camera)) {
        const render::Camera camera = render::framing(side, size, box);
        if (!is_hidden(scene, camera, middle)) return camera;
    }
    return render::framing(model.camera, size, box);
}

} // namespace app::viewer
