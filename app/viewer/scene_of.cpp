#include "app/viewer/scene_of.h"

#include <algorithm>

namespace app::viewer {
namespace {

/// The view of the cursor's block; an older one while the worker makes it.
const PlaceView* view_of(const ViewModel& model) {
    return model.place ? model.place.get() : nullptr;
}

std::optional<core::AxisValues> axes_now(const ViewModel& model, const PlaceView& view) {
    const double share = view.block == model.cursor.block ? model.cursor.share : 1.0;
    if (const auto pose = pose_at(view.poses, share)) return pose;
    return view.standing;
}

bool shows(const Shown& shown, render::BodyRole role) {
    switch (role) {
    case render::BodyRole::fixture:
    case render::BodyRole::clamp:
        return shown.fixtures;
    case render::BodyRole::machine:
        return shown.machine;
    case render::BodyRole::stock:
        return shown.stock;
    default:
        return shown.tool;
    }
}

void mark_pair(const BlockRow& row, std::vector<render::Body>& bodies) {
    const render::ClearanceState state = state_of(row);
    if (!row.has_pair() || state < render::ClearanceState::near) return;
    for (render::Body& body : bodies) {
        if (body.name != row.part && body.name != row.body) continue;
        body.highlighted = true;
        body.mark = state;
    }
}

/// The tool where the hovered block ends, on machines whose tool does not turn.
void add_ghost(const ViewModel& model, const PlaceView& view, const core::AxisValues& values,
               const std::vector<render::Body>& tool, render::Scene& scene) {
    if (!model.hovered || *model.hovered == model.cursor.block || !model.path || tool.empty())
        return;
    const core::Setup& setup = view.scene->setup;
    if (setup.machine.has_rotary()) return;
    const auto [first, last] =
        render::points_of_block(*model.path, static_cast<uint32_t>(*model.hovered));
    if (first == last) return;
    const auto length = setup.tools.find(*view.tool)->second.length;
    const core::Vec3 by = core::Vec3(model.path->points[last - 1].place)
                          - render::tip_in_stock(setup, length, values);
    for (render::Body body : tool) {
        body.stock_from_body = core::translation(by) * body.stock_from_body;
        scene.ghost.push_back(std::move(body));
    }
}

void add_bodies(const ViewModel& model, const PlaceView& view, render::Scene& scene) {
    const core::Setup& setup = view.scene->setup;
    const auto values = axes_now(model, view);
    const core::AxisValues standing = values.value_or(core::AxisValues{});
    scene.bodies = render::setup_bodies(setup, view.scene->meshes, standing, view.fixtures_there);
    if (!values)
        std::erase_if(scene.bodies,
                      [](const auto& body) { return body.role == render::BodyRole::machine; });
    std::vector<render::Body> tool;
    if (values && view.tool && view.scene->tools.contains(*view.tool))
        tool = render::tool_bodies(setup, setup.tools.at(*view.tool),
                                   view.scene->tools.at(*view.tool), *values);
    for (render::Body& body : tool)
        if (body.role == render::BodyRole::holder && !model.settings.shown.holder_xray)
            body.alpha = 1.0;
    if (values) add_ghost(model, view, *values, tool, scene);
    scene.bodies.insert(scene.bodies.end(), tool.begin(), tool.end());
    mark_pair(model.row(), scene.bodies);
    scene.stock = view.stock;
}

/// What is known before the first view is there: the raw stock and the fixtures.
void add_raw_bodies(const SceneSetup& known, render::Scene& scene) {
    std::optional<core::AxisValues> home = core::AxisValues{};
    scene.bodies = render::setup_bodies(known.setup, known.meshes, *home, {});
    std::erase_if(scene.bodies,
                  [](const auto& body) { return body.role == render::BodyRole::machine; });
    if (!known.meshes.raw_stock) return;
    render::Body stock;
    stock.name = "stock";
    stock.role = render::BodyRole::stock;
    stock.mesh = known.meshes.raw_stock;
    stock.alpha = 0.35;
    scene.bodies.push_back(std::move(stock));
}

} // namespace

std::optional<core::Vec3> tip_now(const ViewModel& model) {
    const PlaceView* view = view_of(model);
    if (!view || !view->tool || !view->scene->setup.tools.contains(*view->tool)) return {};
    const auto values = axes_now(model, *view);
    if (!values) return {};
    const core::Setup& setup = view->scene->setup;
    return render::tip_in_stock(setup, setup.tools.at(*view->tool).length, *values);
}

std::optional<render::Witness> witness_of(const ViewModel& model) {
    if (!model.has_rows() || !model.settings.shown.witness) return {};
    // While the worker makes another view the tool stands where the last one has it.
    if (model.place && model.place->block != model.cursor.block) return {};
    const BlockRow& row = model.row();
    if (!row.has_witness()) return {};
    return render::Witness{row.on_tool, row.on_body, state_of(row)};
}

render::Scene scene_of(const ViewModel& model) {
    render::Scene scene;
    if (const PlaceView* view = view_of(model); view && model.has_rows())
        add_bodies(model, *view, scene);
    else if (model.program && model.program->scene)
        add_raw_bodies(*model.program->scene, scene);
    for (render::Body& body : scene.bodies) body.visible = shows(model.settings.shown, body.role);
    scene.stock_visible = model.settings.shown.stock;
    scene.path = model.path;
    scene.path_visible = model.settings.shown.path;
    if (model.has_rows()) scene.current_block = static_cast<uint32_t>(model.cursor.block);
    if (model.hovered) scene.hovered_block = static_cast<uint32_t>(*model.hovered);
    scene.witness = witness_of(model);
    scene.section = model.section;
    scene.measured = model.measuring.places;
    return scene;
}

SceneKey key_of(const ViewModel& model, const render::Viewport& size) {
    SceneKey key;
    key.opening = model.opening;
    key.place = model.place ? model.place->serial : 0;
    key.path = model.path.get();
    key.cursor = model.cursor;
    key.camera = model.camera;
    key.shown = model.settings.shown;
    key.theme = model.settings.theme;
    key.hovered = model.hovered;
    if (model.section) {
        key.section = model.section->normal;
        key.section_offset = model.section->offset;
    }
    key.measured = model.measuring.places;
    key.width = size.width;
    key.height = size.height;
    key.has_program = model.program != nullptr;
    return key;
}

} // namespace app::viewer
