#include "app/report/sheet/sheet_picture.h"

#include <cmath>

#include "app/setup/inference/inferred_setup.h"
#include "core/base/result.h"
#include "core/sim/setup.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/offscreen.h"
#include "render/renderer.h"
#include "render/scene.h"
#include "render/setup_scene.h"

namespace app {
namespace {

constexpr render::Viewport iso_size{900, 560}, top_size{600, 560};
constexpr int sheet_picture_quality = 85;
constexpr double drawing_scale = 1.6; // of lines and arrows, for print

render::Scene start_scene(const core::Setup& setup, const std::vector<NamedZero>& zeros) {
    core::AxisValues home{};
    const core::AxisPosition stated = setup.machine.home();
    for (size_t axis = 0; axis < home.size(); ++axis) home[axis] = stated[axis].value_or(0.0);
    const render::SetupMeshes meshes = render::setup_meshes(setup);
    render::Scene scene;
    scene.bodies = render::setup_bodies(setup, meshes, home);
    std::erase_if(scene.bodies, [](const render::Body& body) {
        return body.role == render::BodyRole::machine || render::is_of_tool(body.role);
    });
    if (!stands_for_no_stock(setup.stock))
        scene.bodies.push_back(
            {.name = "stock", .role = render::BodyRole::stock, .mesh = meshes.raw_stock});
    for (const NamedZero& zero : zeros)
        scene.triads.push_back({.name = zero.name,
                                .origin = zero.stock_from_zero.translation,
                                .axes = zero.stock_from_zero.rotation});
    return scene;
}

/// The names of the zeros, and the letters of their arrows.
std::vector<SheetPicture::Label> labels_of(const render::Scene& scene, const render::Camera& camera,
                                           const render::Viewport& size) {
    std::vector<SheetPicture::Label> labels;
    const auto add = [&](const std::string& words, const core::Vec3& at, bool is_axis) {
        const auto seen = render::project(camera, size, at);
        if (!seen) return;
        const double x = seen->position.x / size.width, y = seen->position.y / size.height;
        if (x >= 0.0 && x <= 1.0 && y >= 0.0 && y <= 1.0) labels.push_back({words, x, y, is_axis});
    };
    for (const render::Triad& triad : scene.triads) {
        const double pixel = render::pixel_size(camera, size, triad.origin);
        const double length = (render::length_in_pixels(triad) + 18.0) * drawing_scale * pixel;
        const core::Vec3 view = render::axes(camera).backward;
        for (int axis = 0; axis < 3; ++axis)
            if (std::abs(glm::dot(view, triad.axes[axis])) < 0.9)
                add(std::string(1, "XYZ"[axis]), triad.origin + length * triad.axes[axis], true);
        add(triad.name, triad.origin, false);
    }
    return labels;
}

core::Result<SheetPicture> taken(render::Renderer& renderer, const render::Scene& scene,
                                 render::StandardView view, const render::Viewport& size) {
    render::Camera camera = render::seen_from({}, view);
    if (view == render::StandardView::top) camera.projection = render::Projection::orthographic;
    core::Aabb box = render::bounds(scene);
    for (const render::Triad& triad : scene.triads) box.extend(triad.origin);
    camera = render::framing(camera, size, box, 0.03);
    const render::DrawOptions options{.theme = render::ColorScheme::light, .scale = drawing_scale};
    FEELER_TRY(const render::Image image,
               render::still_picture(renderer, scene, camera, options, size));
    return SheetPicture{render::jpeg_bytes(image, sheet_picture_quality),
                        labels_of(scene, camera, size)};
}

core::Result<SheetPictures> both_pictures(const core::Setup& setup,
                                          const std::vector<NamedZero>& zeros) {
    FEELER_TRY(render::Offscreen context, render::Offscreen::make());
    FEELER_TRY(render::Renderer renderer, render::Renderer::make());
    const render::Scene scene = start_scene(setup, zeros);
    SheetPictures pictures;
    FEELER_TRY(pictures.iso, taken(renderer, scene, render::StandardView::iso, iso_size));
    FEELER_TRY(pictures.top, taken(renderer, scene, render::StandardView::top, top_size));
    return pictures;
}

} // namespace

SheetPictures sheet_pictures(const core::Setup& setup, const std::vector<NamedZero>& zeros) {
    auto pictures = both_pictures(setup, zeros);
    if (pictures) return *std::move(pictures);
    return {.missing = pictures.error().message};
}

} // namespace app
