#include "app/report/html/pictured_run.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/report/html/html_report.h"
#include "app/report/html/html_text.h"
#include "app/view/model/navigation.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/session_worker.h"
#include "app/view/model/view_model.h"
#include "core/base/math.h"
#include "render/camera.h"
#include "render/coarse_mesh.h"
#include "render/offscreen.h"
#include "render/renderer.h"
#include "render/scene.h"

namespace app {

namespace {

constexpr size_t stock_triangles = 6000, body_triangles = 4000;

const char* name_of(render::BodyRole role) {
    constexpr const char* names[] = {"fixture", "vise",   "clamp", "machine", "flutes",
                                     "shank",   "holder", "nose",  "stock",   "part"};
    return names[static_cast<size_t>(role)];
}

const char* name_of(render::ClearanceState state) {
    constexpr const char* names[] = {"", "clear", "near", "violation"};
    return names[static_cast<size_t>(state)];
}

/// Whole um, without trailing zeros.
std::string number(double mm) {
    const double rounded = core::round(1e3 * mm) / 1e3;
    return fmt::format("{}", rounded == 0.0 ? 0.0 : rounded);
}

std::string numbers(const core::Vec3& p) {
    return number(p.x) + "," + number(p.y) + "," + number(p.z);
}

/// The three rows of the matrix.
std::string numbers(const core::Transform& transform) {
    std::string text;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            text += fmt::format("{:.9g},", transform.rotation[column][row] + 0.0);
        text += number(transform.translation[row]) + (row < 2 ? "," : "");
    }
    return text;
}

template <typename Number>
void append(std::string& bytes, Number value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value); // little-endian, as in browsers
    bytes.append(raw, sizeof value);
}

/// A piece of the path drawn in one style.
struct Stretch {
    bool rapid = false, current = false;
    std::vector<std::string> positions;
};

std::string json_of(const Stretch& stretch) {
    return fmt::format(R"({{"rapid":{},"current":{},"places":[{}]}})", stretch.rapid,
                       stretch.current, fmt::join(stretch.positions, ","));
}

/// The path of the tool tip, with the pieces of the given block separate.
std::string path_json(const render::ToolPath& path, uint32_t block) {
    std::vector<std::string> pieces;
    Stretch stretch;
    for (const render::PathPoint& point : path.points) {
        const bool is_current = point.block == block;
        const bool changes = stretch.rapid != point.rapid || stretch.current != is_current;
        if (point.begins || changes) {
            if (stretch.positions.size() > 1) pieces.push_back(json_of(stretch));
            std::vector<std::string> positions;
            if (!point.begins && !stretch.positions.empty()) positions = {stretch.positions.back()};
            stretch = {point.rapid, is_current, std::move(positions)};
        }
        stretch.positions.push_back(numbers(core::Vec3(point.position)));
    }
    if (stretch.positions.size() > 1) pieces.push_back(json_of(stretch));
    return fmt::format("[{}]", fmt::join(pieces, ","));
}

} // namespace

std::string mesh_json(const render::TriangleMesh& mesh) {
    core::Aabb box;
    for (const render::MeshVertex& vertex : mesh.vertices) box.extend(core::Vec3(vertex.position));
    const core::Vec3 step = glm::max((box.max - box.min) / 65535.0, core::Vec3(1e-9));
    std::string bytes;
    for (const render::MeshVertex& vertex : mesh.vertices)
        for (int k = 0; k < 3; ++k)
            append(bytes, static_cast<uint16_t>(core::round_to_integer(
                              (double(vertex.position[k]) - box.min[k]) / step[k])));
    for (const render::MeshVertex& vertex : mesh.vertices) {
        for (const int8_t part : vertex.normal) append(bytes, part);
        append(bytes, vertex.tint);
    }
    const bool wide = mesh.vertices.size() > 65536;
    while (wide && bytes.size() % 4 != 0) bytes += '\0';
    for (const render::TriangleMesh::Corners& triangle : mesh.triangles)
        for (const uint32_t corner : triangle)
            wide ? append(bytes, corner) : append(bytes, static_cast<uint16_t>(corner));
    return fmt::format(R"({{"count":{},"triangles":{},"wide":{},"origin":[{:.9g},{:.9g},{:.9g}],)"
                       R"("step":[{:.9g},{:.9g},{:.9g}],"data":"{}"}})",
                       mesh.vertices.size(), mesh.triangles.size(), wide, box.min.x, box.min.y,
                       box.min.z, step.x, step.y, step.z, base64(bytes));
}

struct SceneWriter::State {
    /// The index of a mesh; empty if the mesh has no triangles left.
    std::optional<size_t> mesh_of(const render::SharedMesh& mesh);
    std::optional<size_t> stock_of(const render::StockBricks& bricks);
    std::optional<size_t> put(const render::TriangleMesh& mesh);
    std::string bodies_json(const render::Scene& scene);

    std::vector<std::string> meshes;
    std::vector<render::SharedMesh> kept; // keeps their addresses from being reused
    std::map<const render::TriangleMesh*, std::optional<size_t>> known;
    std::vector<std::pair<render::StockBricks, std::optional<size_t>>> stocks;
};

std::optional<size_t> SceneWriter::State::put(const render::TriangleMesh& mesh) {
    if (mesh.triangles.empty()) return {};
    std::string json = mesh_json(mesh);
    const auto same = std::find(meshes.begin(), meshes.end(), json);
    if (same != meshes.end()) return static_cast<size_t>(same - meshes.begin());
    meshes.push_back(std::move(json));
    return meshes.size() - 1;
}

std::optional<size_t> SceneWriter::State::mesh_of(const render::SharedMesh& mesh) {
    const auto [at, is_new] = known.try_emplace(mesh.get());
    if (is_new) {
        kept.push_back(mesh);
        const render::TriangleMesh* const parts[] = {mesh.get()};
        const bool is_small = mesh->triangles.size() <= body_triangles;
        at->second = put(is_small ? *mesh : render::coarse(parts, body_triangles));
    }
    return at->second;
}

std::optional<size_t> SceneWriter::State::stock_of(const render::StockBricks& bricks) {
    for (const auto& [earlier, mesh] : stocks)
        if (earlier == bricks) return mesh;
    std::vector<const render::TriangleMesh*> parts;
    for (const auto& brick : bricks) parts.push_back(&brick->mesh);
    const std::optional<size_t> mesh = put(render::coarse(parts, stock_triangles));
    stocks.emplace_back(bricks, mesh);
    return mesh;
}

namespace {

/// The side of a body of the pair, as a member of an object.
const char* pair_json(render::PairSide side) {
    constexpr const char* members[] = {"", R"(,"pair":"tool")", R"(,"pair":"body")"};
    return members[static_cast<size_t>(side)];
}

std::string body_json(const render::Body& body, size_t mesh) {
    std::string json =
        fmt::format(R"({{"name":{},"role":"{}","mesh":{},"at":[{}])", script_string(body.name),
                    name_of(body.role), mesh, numbers(body.stock_from_body));
    json += pair_json(body.side);
    if (body.side != render::PairSide::none)
        json += fmt::format(R"(,"state":"{}")", name_of(body.mark));
    return json + "}";
}

} // namespace

std::string SceneWriter::State::bodies_json(const render::Scene& scene) {
    std::vector<std::string> bodies;
    if (const auto stock = stock_of(scene.stock))
        bodies.push_back(fmt::format(R"({{"name":"stock","role":"stock","mesh":{}{}}})", *stock,
                                     pair_json(scene.stock_side)));
    for (const render::Body& body : scene.bodies) {
        const bool is_far =
            body.role == render::BodyRole::machine && body.side == render::PairSide::none;
        if (!body.visible || !body.mesh || is_far) continue;
        if (const auto mesh = mesh_of(body.mesh)) bodies.push_back(body_json(body, *mesh));
    }
    return fmt::format("[{}]", fmt::join(bodies, ","));
}

SceneWriter::SceneWriter() : state_(std::make_unique<State>()) {}
SceneWriter::~SceneWriter() = default;

std::string SceneWriter::add(const render::Scene& scene, const render::Camera& camera) {
    std::string json = R"({"bodies":)" + state_->bodies_json(scene);
    json +=
        R"(,"path":)"
        + (scene.path && scene.current_block ? path_json(*scene.path, *scene.current_block) : "[]");
    if (scene.witness)
        json += fmt::format(R"(,"witness":[{},{}],"state":"{}")", numbers(scene.witness->a),
                            numbers(scene.witness->b), name_of(scene.witness->state));
    return json
           + fmt::format(R"(,"camera":[{},{}]}})", numbers(render::eye(camera)),
                         numbers(camera.target));
}

std::string SceneWriter::meshes() const {
    return fmt::format("[{}]", fmt::join(state_->meshes, ",\n"));
}

namespace {

using viewer::ViewModel;
using viewer::WorkerSession;

constexpr size_t most_views = 12;
constexpr render::Viewport picture_size{600, 400};
constexpr int picture_quality = 82;

/// Renders without a window.
struct Camera {
    render::Offscreen context;
    render::Renderer renderer;

    static core::Result<Camera> make() {
        FEELER_TRY(render::Offscreen context, render::Offscreen::make());
        FEELER_TRY(render::Renderer renderer, render::Renderer::make());
        return Camera{std::move(context), std::move(renderer)};
    }

    core::Result<std::string> picture(const ViewModel& model, const render::Scene& scene) {
        const render::DrawOptions options{.theme = model.settings.theme};
        FEELER_TRY(const render::Image image,
                   render::still_picture(renderer, scene, model.camera, options, picture_size));
        return render::jpeg_bytes(image, picture_quality);
    }
};

/// A program that has run to its end, in the state that the window would show.
struct Stage {
    WorkerSession session{[] { return false; }};
    ViewModel model;

    core::Result<void> open(const CheckJob& job) {
        session.open(
            job, [] {}, [] { return false; });
        while (session.has_work()) session.record();
        take_in(model, session.take_update(), 0.0);
        if (model.failure) return tl::unexpected(*model.failure);
        model.settings.theme = render::ColorScheme::light;
        return {};
    }

    /// Moves to the given moment of a block, and aims the camera at the witness.
    void go_to(const ShownMoment& moment) {
        viewer::go_to_witness(model, moment.block, moment.pair);
        session.show({moment.block, model.cursor.fraction >= 1.0});
        take_in(model, session.take_update(), 0.0);
        model.camera = render::seen_from(model.camera, render::StandardView::iso);
        model.camera = render::framing(model.camera, picture_size,
                                       render::work_bounds(viewer::scene_of(model)));
        model.camera = viewer::witness_camera(model, picture_size);
    }

    /// The scene at that time, with only the nearby part of the path.
    render::Scene scene() const {
        render::Scene scene = viewer::scene_of(model);
        if (scene.path && scene.current_block)
            scene.path = std::make_shared<render::ToolPath>(
                render::path_near(*scene.path, *scene.current_block, {}));
        return scene;
    }
};

void add_views(Stage& stage, const CheckRun& run, ReportViews& views) {
    auto camera = Camera::make();
    if (!camera) views.no_pictures = camera.error().message;
    SceneWriter writer;
    const std::vector<ShownMoment> cards = moments_of_cards(run);
    for (const ShownMoment& moment : moments_to_show(run, most_views)) {
        if (moment.block >= stage.model.rows.size()) continue;
        stage.go_to(moment);
        const render::Scene scene = stage.scene();
        BlockView view{.moment = moment, .scene = writer.add(scene, stage.model.camera)};
        if (camera && std::find(cards.begin(), cards.end(), moment) != cards.end()) {
            auto picture = camera->picture(stage.model, scene);
            if (picture)
                view.picture = *std::move(picture);
            else
                views.no_pictures = picture.error().message;
        }
        views.views.push_back(std::move(view));
    }
    views.meshes = writer.meshes();
}

} // namespace

core::Result<CheckRun> run_pictured_check(const CheckJob& job, ReportViews& views) {
    std::optional<CheckRun> judged;
    CheckJob recorded = job;
    if (job.engine == Engine::coprocessor) {
        // A recorded run measures with the exact engine; its poses are valid for every engine.
        FEELER_TRY(judged, run_check(job));
        if (judged->stopped) return *std::move(judged);
        recorded.engine = Engine::exact;
        recorded.detail = core::Detail::deciding_pair;
    }
    Stage stage;
    if (const auto opened = stage.open(recorded); !opened) return tl::unexpected(opened.error());
    const CheckRun& run = judged ? *judged : *stage.session.checked();
    add_views(stage, run, views);
    return run;
}

} // namespace app
