#include "app/view/model/placing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "app/check/setup_sheet.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/view_model.h"
#include "core/base/math.h"
#include "core/distance/body_features.h"
#include "core/distance/first_contact.h"
#include "render/setup_scene.h"

namespace app::viewer {

/// The features of the bodies of a scene, each found once, the first time that it is asked for.
/// Those of large meshes are found by another thread.
class BodyFeatures {
public:
    /// Null while they are being found.
    const core::MeshFeatures* of(const std::shared_ptr<const SceneSetup>& scene,
                                 const std::string& name, const core::ExactBody& body);

private:
    struct Found {
        std::shared_ptr<const core::Mesh> mesh; // null: another shape
        std::shared_future<core::MeshFeatures> features;
    };

    std::weak_ptr<const SceneSetup> scene_;
    std::map<std::string, Found> found_;
    std::vector<std::shared_future<core::MeshFeatures>> leaving_; // dropping one would wait for it
};

namespace {

using Kind = SetupItem::Kind;

constexpr size_t small_mesh = 30000; // triangles, whose features are found within a frame

size_t triangles_of(const core::ExactBody& body) {
    const auto* mesh = std::get_if<core::SolidMesh>(&body);
    return mesh ? mesh->mesh->triangles.size() : 0;
}

} // namespace

const core::MeshFeatures* BodyFeatures::of(const std::shared_ptr<const SceneSetup>& scene,
                                           const std::string& name, const core::ExactBody& body) {
    const auto is_ready = [](const std::shared_future<core::MeshFeatures>& features) {
        return features.wait_for(std::chrono::seconds(0)) != std::future_status::timeout;
    };
    std::erase_if(leaving_, is_ready);
    if (scene_.lock() != scene) {
        scene_ = scene;
        std::erase_if(found_, [&](const auto& entry) {
            if (!entry.second.mesh) leaving_.push_back(entry.second.features);
            return !entry.second.mesh;
        });
    }
    const auto* solid = std::get_if<core::SolidMesh>(&body);
    Found& found = found_[name];
    if (found.features.valid() && found.mesh && (!solid || solid->mesh != found.mesh))
        leaving_.push_back(std::exchange(found, {}).features);
    if (!found.features.valid()) {
        found.mesh = solid ? solid->mesh : nullptr;
        const auto how =
            triangles_of(body) > small_mesh ? std::launch::async : std::launch::deferred;
        found.features =
            std::async(how, [scene, kept = body] { return core::features_of(kept); }).share();
    }
    return is_ready(found.features) ? &found.features.get() : nullptr;
}

namespace {

/// A body in the scene that can be pointed at.
struct SceneBody {
    std::string name;
    core::ExactBody body; // cheap to copy
    core::Transform pose; // of the body in the scene
};

std::shared_ptr<const SceneSetup> scene_setup(const ViewModel& model) {
    if (model.block_state) return model.block_state->scene;
    return model.program ? model.program->scene : nullptr;
}

/// A stock as a body without tolerance; empty if it is too large to be one: none is known.
std::optional<core::ExactBody> body_of(const core::Solid& stock) {
    if (const auto* box = std::get_if<core::SolidBox>(&stock.shape)) return core::convex(box->box);
    if (const auto* mesh = std::get_if<core::SolidMesh>(&stock.shape)) return *mesh;
    const auto& round = std::get<core::SolidCylinder>(stock.shape);
    const core::ConvexShape upright =
        core::convex(core::ProfileElement{0.0, round.radius, round.height, round.radius, 0.0});
    constexpr double quarter = 90.0;
    const core::Vec3 turns[] = {{0, quarter, 0}, {-quarter, 0, 0}, {0, 0, 0}};
    return core::posed(upright, {core::rotation_xyz_deg(turns[round.axis]), round.base});
}

/// Whether a fixture of a set-up is where it is listed, at the cursor.
bool is_mounted(const ViewModel& model, const core::Setup& setup, size_t fixture) {
    const auto& state = model.block_state;
    const bool is_known = state && state->mounted_fixtures.size() == setup.fixtures.size();
    return is_known ? state->mounted_fixtures[fixture] : setup.fixtures[fixture].is_there;
}

std::vector<SceneBody> bodies_of(const ViewModel& model) {
    std::vector<SceneBody> bodies;
    const auto scene = scene_setup(model);
    if (!scene) return bodies;
    const core::Setup& setup = scene->setup;
    const auto standing = model.block_state ? model.block_state->standing : std::nullopt;
    const core::AxisValues values = standing.value_or(core::AxisValues{});
    if (const auto stock = body_of(setup.stock)) bodies.push_back({stock_name, *stock, {}});
    for (size_t i = 0; i < setup.fixtures.size(); ++i) {
        const core::Fixture& fixture = setup.fixtures[i];
        if (is_mounted(model, setup, i))
            bodies.push_back({fixture.name, fixture.body,
                              render::stock_from_mount(setup, fixture.mount, values)});
    }
    return bodies;
}

std::optional<SceneBody> body_named(const ViewModel& model, const std::string& name) {
    for (SceneBody& body : bodies_of(model))
        if (body.name == name) return std::move(body);
    return std::nullopt;
}

const core::MeshFeatures* features_of_body(const ViewModel& model, const SceneBody& body) {
    const auto& picks = model.placing.picks;
    return picks ? picks->features->of(scene_setup(model), body.name, body.body) : nullptr;
}

core::Transform pose_of(const StatedBody& body) {
    return {core::rotation_xyz_deg(body.rotate_deg), body.at};
}

bool is_turned(const core::Transform& by) { return core::tidied(by.rotation) != core::Mat3(1.0); }

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool refuse(ViewModel& model, const std::string& why) {
    model.workspace.refusal = why;
    return false;
}

/// What is measured in the scene is only right for the set-up that it shows.
bool refuse_outdated(ViewModel& model) {
    return refuse(model, model.workspace.error
                             ? "The view shows the last good state: correct the set-up first"
                             : "The view does not show the last edit yet: try again");
}

core::Solid shifted(core::Solid stock, const core::Vec3& by) {
    if (auto* box = std::get_if<core::SolidBox>(&stock.shape))
        box->box = {box->box.min + by, box->box.max + by};
    if (auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) round->base += by;
    return stock;
}

/// Moves the stock as the text states it, or else as it is assumed: a box without a position by its
/// corners, anything else by its position.
core::Result<std::string> with_moved_stock(const std::string& text, const StatedSetup& stated,
                                           const SetupSheet& sheet, const core::Transform& by) {
    const bool is_stated = stated.stock && stated.stock->has_shape();
    const bool is_plain_box = is_stated && stated.stock->box
                              && pose_of(*stated.stock) == core::Transform() && !is_turned(by);
    if (is_plain_box) {
        const core::Aabb& box = *stated.stock->box;
        FEELER_TRY(
            const std::string moved,
            with_box(text, stock_name, {box.min + by.translation, box.max + by.translation}));
        return with_known(moved, stock_name);
    }
    const bool is_round = is_stated
                              ? stated.stock->cylinder.has_value()
                              : std::holds_alternative<core::SolidCylinder>(sheet.stock.shape);
    if (is_round && is_turned(by))
        return core::fail(core::ErrorCode::unsupported,
                          "a stock that is a cylinder is not turned: choose its axis");
    core::Result<std::string> placed = text;
    core::Transform pose = by;
    if (is_stated)
        pose = by * pose_of(*stated.stock);
    else if (std::holds_alternative<core::SolidMesh>(sheet.stock.shape))
        return core::fail(core::ErrorCode::unsupported, "this stock can only be moved in its file");
    else if (!is_turned(by))
        return with_stock(text, shifted(sheet.stock, by.translation), sheet.frame);
    if (!is_stated) placed = with_stock(text, sheet.stock, sheet.frame);
    if (placed)
        placed =
            with_pose(*placed, stock_name, pose.translation, core::angles_xyz_deg(pose.rotation));
    return placed ? with_known(*placed, stock_name) : placed;
}

core::Result<std::string> with_moved_fixture(const std::string& text, const StatedBody& body,
                                             const SetupSheet& sheet, const core::Transform& by) {
    const auto path = path_of_fixture(text, body.name);
    const auto frame = sheet.frames.find(body.frame);
    if (!path || frame == sheet.frames.end())
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("the frame \"{}\" is not known", body.frame));
    const core::Transform& stock_from_frame = frame->second;
    const core::Transform pose = stock_from_frame.inverse() * by * stock_from_frame * pose_of(body);
    return with_pose(text, *path, pose.translation, core::angles_xyz_deg(pose.rotation));
}

/// The direction of a unit vector along an axis: "+Z"; empty if it is oblique.
std::string axis_name(const core::Vec3& direction) {
    constexpr double along = 1.0 - 1e-9;
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(direction[axis]) >= along)
            return std::string(direction[axis] > 0.0 ? "+" : "\xE2\x88\x92") + "XYZ"[axis];
    return {};
}

std::optional<core::FacePlane> plane_of_pick(const core::FeaturePick& feature) {
    if (feature.kind != core::FeatureKind::face) return std::nullopt;
    return core::FacePlane{feature.point, feature.direction};
}

bool wants_faces(PickGoal goal) { return goal != PickGoal::none && goal != PickGoal::zero; }

/// The face of a feature with the middle of the face as its point, so that faces can be centred.
std::optional<core::FacePlane> middle_plane(const ViewModel& model, const ScenePick& pick) {
    const auto body = body_named(model, pick.body);
    const core::MeshFeatures* features = body ? features_of_body(model, *body) : nullptr;
    if (!features || pick.feature.kind != core::FeatureKind::face
        || pick.feature.index >= features->faces.size())
        return plane_of_pick(pick.feature);
    return core::moved(core::plane_of(features->faces[pick.feature.index]), body->pose);
}

void take_second_face(ViewModel& model, const core::FacePlane& plane) {
    Placing& placing = model.placing;
    const core::FacePlane first = *placing.picks->first;
    const bool is_between = placing.goal == PickGoal::between_second;
    begin_picking(model, PickGoal::none);
    if (is_between)
        centre_between(model, placing.body, first, plane);
    else
        put_face_to_face(model, placing.body, first, plane);
}

std::vector<core::Vec3> circle_points(const core::Vec3& center, const core::Vec3& axis,
                                      double radius) {
    constexpr int count = 48;
    const core::Vec3 side = std::abs(axis.x) < 0.8 ? core::Vec3(1, 0, 0) : core::Vec3(0, 1, 0);
    const core::Vec3 u = glm::normalize(glm::cross(axis, side)), v = glm::cross(axis, u);
    std::vector<core::Vec3> points;
    for (int i = 0; i <= count; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / count;
        points.push_back(center + radius * (core::cos(angle) * u + core::sin(angle) * v));
    }
    return points;
}

} // namespace

const ScenePick* meant_pick(const ViewModel& model) {
    const Placing& placing = model.placing;
    if (!placing.picks || placing.picks->hovered.empty()) return nullptr;
    return &placing.picks->hovered[placing.turn % placing.picks->hovered.size()];
}

bool can_move(const ViewModel& model, const std::string& body) {
    if (!model.workspace.stated || !sheet_of(model)) return false;
    if (body == stock_name) return true;
    // A [[fixture.move]] may have taken it elsewhere, where the set-up's numbers are others.
    if (const auto scene = scene_setup(model))
        for (size_t i = 0; i < scene->setup.fixtures.size(); ++i)
            if (scene->setup.fixtures[i].name == body && scene->setup.fixtures[i].is_there
                && !is_mounted(model, scene->setup, i))
                return false;
    return model.workspace.stated->fixture(body) != nullptr;
}

std::vector<std::string> bodies_to_meet(const ViewModel& model) {
    std::vector<std::string> names;
    for (const SceneBody& body : bodies_of(model)) names.push_back(body.name);
    return names;
}

core::Aabb bounds_of_body(const ViewModel& model, const std::string& name) {
    const auto body = body_named(model, name);
    core::Aabb box;
    if (!body) return box;
    if (body->pose == core::Transform()) return core::bounds(body->body); // each frame: no search
    for (int axis = 0; axis < 3; ++axis) {
        core::Vec3 along(0.0);
        along[axis] = 1.0;
        const core::BodyExtent extent = core::extent_along(body->body, body->pose, along);
        box.min[axis] = extent.from;
        box.max[axis] = extent.to;
    }
    return box;
}

std::vector<std::string> moved_with(const ViewModel& model, const std::string& body) {
    std::vector<std::string> names{body};
    if (!model.workspace.stated) return names;
    // A frame is a fixture that comes before.
    for (const StatedBody& fixture : model.workspace.stated->fixtures)
        if (contains(names, fixture.frame)) names.push_back(fixture.name);
    return names;
}

bool move_body(ViewModel& model, const std::string& body, const core::Transform& by,
               const std::string& title) {
    const SetupSheet* sheet = sheet_of(model);
    if (!sheet || !can_move(model, body)) return refuse(model, body + " cannot be moved here");
    if (!is_current(model)) return refuse_outdated(model);
    const auto stated = model.workspace.stated;
    return edit_setup(model, title, [&](const std::string& text) {
        return body == stock_name ? with_moved_stock(text, *stated, *sheet, by)
                                  : with_moved_fixture(text, *stated->fixture(body), *sheet, by);
    });
}

bool change_frame(ViewModel& model, const std::string& name, const std::string& frame) {
    const SetupSheet* sheet = sheet_of(model);
    const auto stated = model.workspace.stated;
    if (!sheet || !stated) return false;
    const StatedBody* body = stated->fixture(name);
    if (name == stock_name && stated->stock) body = &*stated->stock;
    if (name == part_name && stated->part) body = &*stated->part;
    if (!body) return false;
    const BodyPath path =
        path_of_fixture(model.workspace.document.text(), name).value_or(BodyPath{name});
    if (model.workspace.error) // perhaps because of this frame; where the body is, is not known
        return edit_setup(model, "Change the frame of " + name, [&](const std::string& text) {
            return toml_with_value(text, path / "frame", toml_text(frame));
        });
    if (!is_current(model)) return refuse_outdated(model);
    const auto from = sheet->frames.find(body->frame), to = sheet->frames.find(frame);
    if (from == sheet->frames.end() || to == sheet->frames.end())
        return refuse(model, "The place of " + (to == sheet->frames.end() ? frame : body->frame)
                                 + " is not known");
    const core::Transform pose = to->second.inverse() * from->second * pose_of(*body);
    return edit_setup(model, "Change the frame of " + name,
                      [&](const std::string& text) -> core::Result<std::string> {
                          FEELER_TRY(const std::string placed,
                                     with_pose(text, path, pose.translation,
                                               core::angles_xyz_deg(pose.rotation)));
                          return toml_with_value(placed, path / "frame", toml_text(frame));
                      });
}

bool slide_to_contact(ViewModel& model, const std::string& name, const core::Vec3& direction) {
    const std::vector<SceneBody> all = bodies_of(model);
    const std::vector<std::string> group = moved_with(model, name);
    std::vector<core::PlacedBody> supports;
    for (const SceneBody& body : all)
        if (!contains(group, body.name)) supports.push_back({&body.body, body.pose});
    std::optional<double> travel;
    for (const SceneBody& body : all) {
        if (!contains(group, body.name)) continue;
        const core::ContactGoal goal{.limit = travel.value_or(core::infinity)};
        const auto contact =
            core::first_contact(body.body, body.pose, direction, supports, {}, goal);
        if (contact) travel = std::min(contact->travel, travel.value_or(core::infinity));
    }
    if (!travel)
        return refuse(model, fmt::format("Nothing is in the way of {} in this direction", name));
    return move_body(model, name, core::translation(*travel * direction),
                     "Slide " + name + " to contact");
}

bool put_face_to_face(ViewModel& model, const std::string& body, const core::FacePlane& own,
                      const core::FacePlane& other) {
    // In the scene the pose of the body is the identity.
    const core::Transform by = core::face_to_face(
        own, other, {}, {.flush = model.placing.flush, .centred = model.placing.centred});
    return move_body(model, body, by, "Place " + body);
}

bool centre_between(ViewModel& model, const std::string& name, const core::FacePlane& a,
                    const core::FacePlane& b) {
    const auto body = body_named(model, name);
    if (!body) return refuse(model, name + " is not in the view");
    constexpr double parallel = 1e-6;
    if (glm::length(glm::cross(a.normal, b.normal)) > parallel)
        return refuse(model, "The two faces are not parallel");
    const core::BodyExtent extent = core::extent_along(body->body, body->pose, a.normal);
    return move_body(model, name, core::translation(core::centred_between(extent, a.normal, a, b)),
                     "Centre " + name);
}

ZeroAxes zero_axes(const core::FeaturePick& feature) {
    ZeroAxes zero;
    if (feature.kind == core::FeatureKind::corner) return {{true, true, true}};
    constexpr double along = 1.0 - 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(feature.direction[axis]) < along) continue;
        for (int other = 0; other < 3; ++other)
            zero.axes[other] = (other == axis) == (feature.kind == core::FeatureKind::face);
    }
    return zero;
}

bool set_zero(ViewModel& model, const std::string& offset, const core::FeaturePick& feature) {
    const SetupSheet* sheet = sheet_of(model);
    if (!sheet || !model.workspace.stated) return false;
    if (!is_current(model)) return refuse_outdated(model);
    const auto frame = sheet->frames.find(offset);
    if (frame == sheet->frames.end())
        return refuse(model, fmt::format("the place of {} is not known", offset));
    core::Transform scene_from_offset = frame->second;
    core::FeaturePick seen = core::moved(feature, scene_from_offset.inverse());
    const ZeroAxes axes = zero_axes(seen);
    if (!axes.any())
        return refuse(model,
                      "It is oblique to the axes: click a corner, or a feature along X, Y or "
                      "Z");
    core::Vec3 by(0.0);
    for (int axis = 0; axis < 3; ++axis)
        if (axes.axes[axis]) by[axis] = seen.point[axis];
    const auto stated = model.workspace.stated;
    const SetupSheet values = *sheet;
    return edit_setup(model, "Set the zero of " + offset, [&](const std::string& before) {
        core::Result<std::string> text = before;
        if (values.frame == offset)
            text = with_moved_stock(*text, *stated, values, core::translation(-by));
        for (const StatedBody& body : stated->fixtures) {
            if (!text || body.frame != offset) continue;
            const auto path = path_of_fixture(*text, body.name);
            text = with_pose(*text, *path, body.at - by, body.rotate_deg);
        }
        const SheetOffset* known = values.offset(offset);
        if (text && known && (stated->has_offset(offset) || values.frame != offset))
            text = with_offset(*text, offset, known->origin + by);
        return text;
    });
}

void begin_picking(ViewModel& model, PickGoal goal) {
    Placing& placing = model.placing;
    placing.goal = goal;
    placing.turn = 0;
    if (!placing.picks)
        placing.picks = std::make_shared<PickState>(PickState{std::make_shared<BodyFeatures>()});
    placing.picks->hovered.clear();
    if (goal == PickGoal::none || goal == PickGoal::own_face || goal == PickGoal::between_first)
        placing.picks->first.reset();
    if (goal != PickGoal::none) model.measuring.on = false;
}

std::vector<ScenePick> picks_at(const ViewModel& model, const std::string& name,
                                const core::Vec3& point, double reach) {
    const Placing& placing = model.placing;
    const bool is_own = contains(moved_with(model, placing.body), name);
    if (wants_faces(placing.goal) && is_own != (placing.goal == PickGoal::own_face)) return {};
    const auto body = body_named(model, name);
    const core::MeshFeatures* features = body ? features_of_body(model, *body) : nullptr;
    if (!features) return {};
    const core::Transform body_from_scene = body->pose.inverse();
    std::vector<ScenePick> picks;
    for (const core::FeaturePick& pick :
         core::feature_candidates(*features, core::no_index, body_from_scene * point, reach)) {
        if (wants_faces(placing.goal) && pick.kind != core::FeatureKind::face) continue;
        picks.push_back({name, core::moved(pick, body->pose)});
    }
    return picks;
}

void take_pick(ViewModel& model, const ScenePick& pick, double now) {
    Placing& placing = model.placing;
    switch (placing.goal) {
    case PickGoal::none:
        return;
    case PickGoal::zero: {
        const std::string offset = placing.offset;
        begin_picking(model, PickGoal::none);
        if (set_zero(model, offset, pick.feature))
            say(model,
                fmt::format("The zero of {} is at: {}", offset, words_of(model, pick.feature)),
                now);
        return;
    }
    case PickGoal::own_face:
    case PickGoal::between_first:
        if (const auto plane = middle_plane(model, pick)) {
            const bool is_own = placing.goal == PickGoal::own_face;
            begin_picking(model, is_own ? PickGoal::other_face : PickGoal::between_second);
            model.placing.picks->first = plane;
        }
        return;
    case PickGoal::other_face:
    case PickGoal::between_second:
        if (const auto plane = middle_plane(model, pick)) take_second_face(model, *plane);
        return;
    }
}

std::string pick_hint(const ViewModel& model) {
    const Placing& placing = model.placing;
    switch (placing.goal) {
    case PickGoal::none:
        return {};
    case PickGoal::own_face:
        return fmt::format("Click a face of {}, or of what stands on it", placing.body);
    case PickGoal::other_face:
        return "Click the face to put it to";
    case PickGoal::between_first:
        return "Click the first of two parallel faces";
    case PickGoal::between_second:
        return "Click the second face";
    case PickGoal::zero:
        return fmt::format("Click a corner, edge, face, bore or boss for the zero of {}",
                           placing.offset);
    }
    return {};
}

std::string words_of(const ViewModel& model, const core::FeaturePick& feature) {
    const std::string along = axis_name(feature.direction);
    switch (feature.kind) {
    case core::FeatureKind::corner:
        return "corner";
    case core::FeatureKind::edge:
        return along.empty() ? "edge" : "edge along " + along.substr(along.size() - 1);
    case core::FeatureKind::face:
        return along.empty() ? "oblique face" : "face " + along;
    case core::FeatureKind::circle:
    case core::FeatureKind::wall:
        return fmt::format("axis of D{}", length_text(model, 2.0 * feature.radius));
    }
    return {};
}

std::vector<SceneFace> faces_of(const ViewModel& model, const std::string& name) {
    constexpr size_t most = 40;
    const auto body = body_named(model, name);
    const core::MeshFeatures* features = body ? features_of_body(model, *body) : nullptr;
    if (!features) return {};
    std::vector<const core::PlanarFace*> faces;
    for (const core::PlanarFace& face : features->faces) faces.push_back(&face);
    // Opposite faces of a block are equal but for rounding: they keep their order.
    const auto rounded = [](const core::PlanarFace* face) { return core::round(1e3 * face->area); };
    std::stable_sort(faces.begin(), faces.end(),
                     [&](const auto* a, const auto* b) { return rounded(a) > rounded(b); });
    if (faces.size() > most) faces.resize(most);
    std::vector<SceneFace> named;
    for (const core::PlanarFace* face : faces) {
        const core::FacePlane plane = core::moved(core::plane_of(*face), body->pose);
        const std::string along = axis_name(plane.normal);
        named.push_back({fmt::format("{}  {} x {} at {}", along.empty() ? "oblique" : along,
                                     length_text(model, 2.0 * face->half[0]),
                                     length_text(model, 2.0 * face->half[1]),
                                     length_text(model, glm::dot(plane.normal, plane.point))),
                         plane});
    }
    return named;
}

std::vector<std::vector<core::Vec3>> outline_of(const ViewModel& model, const ScenePick& pick) {
    const auto body = body_named(model, pick.body);
    const core::MeshFeatures* features = body ? features_of_body(model, *body) : nullptr;
    if (!features) return {};
    std::vector<std::vector<core::Vec3>> lines;
    const uint32_t index = pick.feature.index;
    switch (pick.feature.kind) {
    case core::FeatureKind::corner:
        break;
    case core::FeatureKind::face:
        lines = features->faces[index].loops;
        for (std::vector<core::Vec3>& loop : lines)
            if (!loop.empty()) loop.push_back(loop.front());
        break;
    case core::FeatureKind::edge:
        lines = {{features->edges[index].from, features->edges[index].to}};
        break;
    case core::FeatureKind::circle: {
        const core::FeatureCircle& circle = features->circles[index];
        lines = {circle_points(circle.center, circle.axis, circle.radius)};
        break;
    }
    case core::FeatureKind::wall: {
        const core::RoundWall& wall = features->walls[index];
        lines = {circle_points(wall.from, wall.axis(), wall.radius_from),
                 circle_points(wall.to, wall.axis(), wall.radius_to)};
        break;
    }
    }
    for (std::vector<core::Vec3>& line : lines)
        for (core::Vec3& point : line) point = body->pose * point;
    return lines;
}

} // namespace app::viewer
