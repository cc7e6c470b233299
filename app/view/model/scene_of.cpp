#include "app/view/model/scene_of.h"

#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "app/check/setup_sheet.h"
#include "app/view/model/axis_display.h"
#include "app/view/model/placing.h"
#include "app/view/model/program_zero.h"
#include "app/view/model/view_model.h"
#include "core/base/text.h"
#include "render/picking.h"

namespace app::viewer {

std::shared_ptr<const SceneSetup> make_scene_setup(const core::Setup& setup,
                                                   render::SurfaceMaker* surfaces) {
    auto scene = std::make_shared<SceneSetup>();
    scene->setup = setup;
    scene->meshes = surfaces ? surfaces->meshes_of(setup) : render::setup_meshes(setup);
    for (const auto& [number, tool] : setup.tools)
        scene->tools.emplace(number, render::tool_meshes(tool));
    return scene;
}

namespace {

constexpr const char* stock_name = "stock"; // in pairs

/// The view of the current block, or an older one while the worker still makes it.
const BlockState* view_of(const ViewModel& model) {
    return model.block_state ? model.block_state.get() : nullptr;
}

bool shows(const VisibleParts& shown, render::BodyRole role) {
    switch (role) {
    case render::BodyRole::fixture:
    case render::BodyRole::vise:
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

/// The state that colours a pair of the block.
render::ClearanceState state_of_pair(const BlockRow& row, const PairWitness& pair) {
    return pair.verdict == core::Verdict::clear ? state_of(row) : render::ClearanceState::violation;
}

void mark_pair(const ViewModel& model, render::Scene& scene) {
    if (!model.has_rows() || is_jogged(model)) return;
    const auto pair = witness_in(model.row(), model.shown_pair);
    if (!pair) return;
    const render::ClearanceState state = state_of_pair(model.row(), *pair);
    if (state < render::ClearanceState::near) return;
    for (render::Body& body : scene.bodies) {
        if (body.name == pair->names[0]) body.side = render::PairSide::tool;
        if (body.name == pair->names[1]) body.side = render::PairSide::body;
        if (body.side != render::PairSide::none) body.mark = state;
    }
    if (pair->names[1] == stock_name) scene.stock_side = render::PairSide::body;
}

/// Adds the tool at the end of the hovered block. Only on machines without rotary axes.
void add_ghost(const ViewModel& model, const BlockState& view, const core::AxisValues& values,
               const std::vector<render::Body>& tool, render::Scene& scene) {
    if (!model.hovered || *model.hovered == model.cursor.block || !model.path || tool.empty())
        return;
    const core::Setup& setup = view.scene->setup;
    if (setup.machine.has_rotary()) return;
    const auto [first, last] =
        render::points_of_block(*model.path, static_cast<uint32_t>(*model.hovered));
    if (first == last) return;
    const auto length = setup.tools.find(*view.tool)->second.length;
    const core::Vec3 by = core::Vec3(model.path->points[last - 1].position)
                          - render::tip_in_stock(setup, length, values);
    for (render::Body body : tool) {
        body.stock_from_body = core::translation(by) * body.stock_from_body;
        scene.ghost.push_back(std::move(body));
    }
}

void add_bodies(const ViewModel& model, const BlockState& view, render::Scene& scene) {
    const core::Setup& setup = view.scene->setup;
    const auto values = shown_axes(model);
    const core::AxisValues standing = values.value_or(core::AxisValues{});
    scene.bodies = render::setup_bodies(setup, view.scene->meshes, standing, view.mounted_fixtures);
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
    scene.stock = view.stock;
    mark_pair(model, scene);
}

/// Adds what is known before the first view arrives: the raw stock and the fixtures.
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

/// Moves the bodies that are being dragged.
void add_drag(const ViewModel& model, render::Scene& scene) {
    const Placing& placing = model.placing;
    if (!placing.drag || !model.program || !model.program->scene) return;
    if (placing.body == stock_name) {
        render::Body stock;
        stock.name = stock_name;
        stock.role = render::BodyRole::stock;
        stock.mesh = model.program->scene->meshes.raw_stock;
        stock.alpha = 0.5;
        stock.stock_from_body = *placing.drag;
        if (stock.mesh) scene.bodies.push_back(std::move(stock));
        return;
    }
    const std::vector<std::string> names = moved_with(model, placing.body);
    for (render::Body& body : scene.bodies)
        if (std::find(names.begin(), names.end(), body.name) != names.end())
            body.stock_from_body = *placing.drag * body.stock_from_body;
}

} // namespace

std::optional<core::Vec3> tip_now(const ViewModel& model) {
    const BlockState* view = view_of(model);
    if (!view || !view->tool || !view->scene->setup.tools.contains(*view->tool)) return {};
    const auto values = shown_axes(model);
    if (!values) return {};
    const core::Setup& setup = view->scene->setup;
    return render::tip_in_stock(setup, setup.tools.at(*view->tool).length, *values);
}

std::optional<render::Triad> program_triad(const ViewModel& model) {
    const BlockState* view = view_of(model);
    if (!view || !view->zero || !view->scene) return {};
    render::Triad triad =
        triad_of(*view->zero, view->scene->setup, shown_axes(model).value_or(core::AxisValues{}));
    if (!core::is_finite(triad.origin)) return {};
    if (model.program && model.program->counts_blocks) triad.name = "datum"; // Klartext: no G54
    return triad;
}

std::optional<render::Witness> witness_of(const ViewModel& model) {
    if (!model.has_rows() || !model.settings.shown.witness || is_jogged(model)) return {};
    // Until the worker has made the new view, the tool is drawn at its position in the old one.
    if (model.block_state && model.block_state->block != model.cursor.block) return {};
    const auto pair = witness_in(model.row(), model.shown_pair);
    if (!pair) return {};
    render::Witness witness{pair->on_tool, pair->on_body, state_of_pair(model.row(), *pair)};
    witness.is_contact = is_contact(model.row()) && pair->verdict == core::Verdict::clear;
    return witness;
}

namespace {

/// The points that are joined by lines: measured ones, else those of a section so far.
std::vector<core::Vec3> marked_points(const ViewModel& model) {
    return model.section && model.section->pick == SectionPick::points ? model.section->picked
                                                                       : model.measuring.positions;
}

/// The arrows at the work offset that is selected in the set-up.
std::optional<render::Triad> selected_triad(const ViewModel& model) {
    const SetupItem& selected = model.workspace.selected;
    const SetupSheet* const sheet = sheet_of(model);
    if (!model.shows_setup || selected.kind != SetupItem::Kind::offset || !sheet) return {};
    const auto frame = sheet->frames.find(selected.name);
    if (frame == sheet->frames.end() || !core::is_finite(frame->second.translation)) return {};
    return render::Triad{
        .name = selected.name, .origin = frame->second.translation, .axes = frame->second.rotation};
}

/// The arrows of the tool, at its tip, on a machine that can turn it relative to the work.
std::optional<render::Triad> tool_triad(const ViewModel& model) {
    const BlockState& view = *model.block_state;
    const core::Setup& setup = view.scene->setup;
    const auto values = shown_axes(model);
    const auto tool = view.tool ? setup.tools.find(*view.tool) : setup.tools.end();
    if (!values || tool == setup.tools.end() || !setup.machine.has_rotary()) return {};
    const core::Transform pose = render::stock_from_tip(setup, tool->second.length, *values);
    if (!core::is_finite(pose.translation)) return {};
    return render::Triad{"tool", pose.translation, pose.rotation, true};
}

void add_triads(const ViewModel& model, render::Scene& scene) {
    const auto program = program_triad(model), selected = selected_triad(model);
    if (program) scene.triads.push_back(*program);
    if (selected && !(program && program->name == selected->name))
        scene.triads.push_back(*selected);
    const BlockState* view = view_of(model);
    if (!view || !view->scene) return;
    if (const auto tool = tool_triad(model)) scene.triads.push_back(*tool);
    if (!model.program || model.program->is_inferred) return;
    const auto values = shown_axes(model).value_or(core::AxisValues{});
    scene.triads.push_back(machine_triad(view->scene->setup, values));
}

/// The body on which the work stands: of the machine's tables, the one with the highest top.
const render::Body* table_in(const render::Scene& scene) {
    const render::Body* table = nullptr;
    const auto top_of = [](const render::Body& body) {
        return glm::dot(body.stock_from_body.rotation[2], render::bounds(body).max);
    };
    for (const render::Body& body : scene.bodies) {
        if (body.role != render::BodyRole::machine || !body.mesh) continue;
        if (core::lower_case(body.name).find("table") == std::string::npos) continue;
        if (!table || top_of(body) > top_of(*table)) table = &body;
    }
    return table;
}

/// The ground: the top of the table, else the lowest point of what stands on it. Its grid counts
/// from the zero of the program.
std::optional<render::Ground> ground_of(const ViewModel& model, const render::Scene& scene) {
    render::Ground ground;
    ground.inch = model.settings.inch;
    core::Transform& pose = ground.scene_from_ground;
    const core::Aabb work = render::work_bounds(scene);
    if (const render::Body* table = table_in(scene)) {
        pose = table->stock_from_body;
        pose.translation = pose * core::Vec3(0.0, 0.0, table->mesh->bounds.max.z);
    } else {
        if (work.empty()) return {};
        pose.translation = {0.0, 0.0, work.min.z};
    }
    const core::Vec3 zero =
        pose.inverse() * (scene.triads.empty() ? core::Vec3(0.0) : scene.triads[0].origin);
    pose.translation = pose * core::Vec3(zero.x, zero.y, 0.0);
    if (!core::is_finite(pose.translation)) return {};
    return ground;
}

/// Opacity of a part of the machine that hides the work.
constexpr double seen_through = 0.14;

/// Whether a body is between the eye and at least half of these points.
bool hides(const render::Body& body, const core::Vec3& eye, std::span<const core::Vec3> points) {
    const core::Transform back = body.stock_from_body.inverse();
    size_t hidden = 0;
    for (const core::Vec3& point : points) {
        const double far = glm::distance(point, eye);
        if (!(far > 0.0)) continue;
        const core::Vec3 direction = (point - eye) / far;
        const auto hit = render::pick_mesh(*body.mesh, {back * eye, back.rotation * direction});
        hidden += hit && hit->distance < far - 0.5 ? 1 : 0;
    }
    return 2 * hidden >= points.size();
}

/// The middle of a box and the middles of its faces.
std::array<core::Vec3, 7> middles_of(const core::Aabb& box) {
    std::array<core::Vec3, 7> points;
    points.fill(box.center());
    for (size_t axis = 0; axis < 3; ++axis)
        for (const bool low : {true, false})
            points[1 + 2 * axis + (low ? 1 : 0)][static_cast<int>(axis)] =
                (low ? box.min : box.max)[static_cast<int>(axis)];
    return points;
}

/// Makes the parts of the machine that hide the work transparent: on a machine with rotary axes,
/// the table comes between the eye and the stock, which stays in place.
void reveal_work(const ViewModel& model, render::Scene& scene) {
    core::Aabb stock;
    for (const auto& brick : scene.stock) stock.extend(brick->mesh.bounds);
    if (stock.empty()) return;
    const auto points = middles_of(stock);
    const core::Vec3 eye = render::eye(model.camera);
    for (render::Body& body : scene.bodies)
        if (body.role == render::BodyRole::machine && body.side == render::PairSide::none
            && body.visible && body.mesh && hides(body, eye, points))
            body.alpha = seen_through;
}

/// The first surface of a body on a ray.
std::optional<core::Vec3> surface_on(const render::Scene& scene, const std::string& name,
                                     const render::Ray& ray) {
    if (name == stock_name) {
        const auto hit = render::pick_stock(scene, ray);
        return hit ? std::optional(hit->at.point) : std::nullopt;
    }
    std::optional<render::SurfaceHit> nearest;
    for (const render::Body& body : scene.bodies) {
        if (body.name != name || !body.mesh) continue;
        const core::Transform back = body.stock_from_body.inverse();
        auto hit =
            render::pick_mesh(*body.mesh, {back * ray.origin, back.rotation * ray.direction});
        if (!hit || (nearest && nearest->distance <= hit->distance)) continue;
        hit->point = body.stock_from_body * hit->point;
        nearest = hit;
    }
    return nearest ? std::optional(nearest->point) : std::nullopt;
}

/// Makes a measured overlap a line from the surface of the body that is hit, as far into it as the
/// tool goes. Without a surface there, the line goes the way out from the point of contact.
void measure_overlap(const ViewModel& model, render::Scene& scene) {
    if (!scene.witness || !model.row().overlap || !model.row().overlap->most) return;
    const auto pair = witness_in(model.row(), model.shown_pair);
    if (!pair || pair->names != BodyNames{model.row().part, model.row().body}) return;
    const core::Overlap& overlap = *model.row().overlap;
    const core::Vec3 way = *overlap.most * overlap.way_out;
    const core::Vec3 beyond = pair->on_tool + 1.01 * way + 0.01 * overlap.way_out;
    const auto surface = surface_on(scene, pair->names[1], {beyond, -overlap.way_out});
    const bool is_near = surface && glm::distance(*surface, beyond) <= 1.02 * *overlap.most + 0.02;
    scene.witness->a = is_near ? *surface - way : pair->on_tool;
    scene.witness->b = is_near ? *surface : pair->on_tool + way;
    scene.witness->is_depth = true;
}

} // namespace

render::Scene scene_of(const ViewModel& model) {
    render::Scene scene;
    if (const BlockState* view = view_of(model); view && model.has_rows())
        add_bodies(model, *view, scene);
    else if (model.program && model.program->scene)
        add_raw_bodies(*model.program->scene, scene);
    add_drag(model, scene);
    for (render::Body& body : scene.bodies) body.visible = shows(model.settings.shown, body.role);
    scene.stock_visible = model.settings.shown.stock;
    scene.path = model.path;
    scene.path_visible = model.settings.shown.path;
    if (model.has_rows()) scene.current_block = static_cast<uint32_t>(model.cursor.block);
    if (model.hovered) scene.hovered_block = static_cast<uint32_t>(*model.hovered);
    scene.witness = witness_of(model);
    if (model.section) {
        scene.section = model.section->plane;
        scene.section_cuts_tool = model.section->cuts_tool;
    }
    scene.measured = marked_points(model);
    add_triads(model, scene);
    if (model.settings.shown.ground) scene.ground = ground_of(model, scene);
    if (!model.settings.shown.zeros) scene.triads.clear();
    reveal_work(model, scene);
    measure_overlap(model, scene);
    return scene;
}

SceneKey key_of(const ViewModel& model, const render::Viewport& size) {
    SceneKey key;
    key.opening = model.opening;
    key.block_state = model.block_state ? model.block_state->serial : 0;
    key.setup = model.program ? model.program->scene.get() : nullptr;
    key.path = model.path.get();
    key.block = model.cursor.block;
    key.pair = model.shown_pair;
    key.fraction = model.cursor.fraction;
    key.camera = model.camera;
    key.shown = model.settings.shown;
    key.theme = model.settings.theme;
    key.hovered = model.hovered;
    if (model.section) {
        key.section = model.section->plane.normal;
        key.section_offset = model.section->plane.offset;
        key.section_cuts_tool = model.section->cuts_tool;
    }
    key.drag = model.placing.drag;
    if (is_jogged(model)) key.jog = model.jog->values;
    key.measured = marked_points(model);
    key.inch = model.settings.inch;
    if (const auto selected = selected_triad(model)) key.work_offset = selected->name;
    if (model.has_rows()) key.overlap = model.row().overlap;
    key.width = size.width;
    key.height = size.height;
    key.has_program = model.program != nullptr;
    return key;
}

namespace {

/// Smallest margin of the view around the pair, mm.
constexpr double least_room = 22.0;

/// Whether something opaque is between the eye and a point.
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

/// Views in increasing order of their turn from the camera.
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
    const auto pair = witness_in(model.row(), model.shown_pair);
    if (!pair) {
        if (model.path)
            box = render::bounds_of_block(*model.path, static_cast<uint32_t>(model.cursor.block));
        return box.empty() ? model.camera : render::framing(model.camera, size, box.grown(8.0));
    }
    box.extend(pair->on_tool);
    box.extend(pair->on_body);
    // In a collision the witness may be anywhere along the motion, so the tip is framed as well.
    if (const auto tip = tip_now(model); tip && pair->verdict == core::Verdict::collision)
        box.extend(*tip);
    const double apart = glm::length(pair->on_tool - pair->on_body);
    box = box.grown(std::max(least_room, 1.2 * apart));
    const core::Vec3 middle = 0.5 * (pair->on_tool + pair->on_body);
    const render::Scene scene = scene_of(model);
    for (const render::Camera& side : sides(model.camera)) {
        const render::Camera camera = render::framing(side, size, box);
        if (!is_hidden(scene, camera, middle)) return camera;
    }
    return render::framing(model.camera, size, box);
}

namespace {

constexpr size_t most_tools = 3;

std::string stock_line(const ViewModel& model, const SetupSheet& sheet) {
    const core::Vec3 size = core::bounds(sheet.stock).size();
    return fmt::format("Stock {} x {} x {} {}", length_text(model, size.x),
                       length_text(model, size.y), length_text(model, size.z), length_unit(model));
}

std::string tool_line(const ViewModel& model, const SheetTool& tool) {
    return fmt::format("T{} {}, D{} {}", core::value_of(tool.tool.number),
                       core::name_of(tool.tool.shape), length_text(model, tool.tool.diameter),
                       length_unit(model));
}

} // namespace

std::vector<std::string> inferred_summary(const ViewModel& model) {
    if (!model.program || !model.program->is_inferred || !model.program->sheet) return {};
    if (model.shows_setup) return {}; // its panel says all of this
    const SetupSheet& sheet = *model.program->sheet;
    std::vector<std::string> lines = {"Inferred set-up: press E to edit", stock_line(model, sheet)};
    for (size_t i = 0; i < std::min(sheet.tools.size(), most_tools); ++i)
        lines.push_back(tool_line(model, sheet.tools[i]));
    if (sheet.tools.size() > most_tools)
        lines.push_back(fmt::format("and {} more tools", sheet.tools.size() - most_tools));
    lines.push_back("No fixtures are known");
    return lines;
}

} // namespace app::viewer
