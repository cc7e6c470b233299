#include "app/report/pictured_run.h"

#include <algorithm>

#include "app/report/html_cards.h"
#include "app/report/html_scene.h"
#include "app/viewer/camera_of.h"
#include "app/viewer/navigation.h"
#include "app/viewer/scene_of.h"
#include "app/viewer/worker_session.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace app {
namespace {

using viewer::ViewModel;
using viewer::WorkerSession;

constexpr size_t most_views = 12;
constexpr render::Viewport picture_size{600, 400};
constexpr int picture_quality = 82;

/// What draws without a window.
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

/// A program that has been run to its end, as the window would show it.
struct Stage {
    WorkerSession session{[] { return false; }, [] { return false; }};
    ViewModel model;

    core::Result<void> open(const CheckJob& job) {
        session.open(job, [] {});
        while (session.has_work()) session.record();
        take_in(model, session.take_news(), 0.0);
        if (model.failure) return tl::unexpected(*model.failure);
        model.settings.theme = render::Theme::light;
        return {};
    }

    /// Stands at the moment at which a block comes nearest, and looks there.
    void go_to(size_t block) {
        viewer::go_to_witness(model, block);
        session.show({block, model.cursor.share >= 1.0});
        take_in(model, session.take_news(), 0.0);
        model.camera = render::seen_from(model.camera, render::StandardView::iso);
        model.camera = render::framing(model.camera, picture_size,
                                       render::work_bounds(viewer::scene_of(model)));
        model.camera = viewer::witness_camera(model, picture_size);
    }

    /// What is seen there, with as much of the path as tells how the tool gets there.
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
    const std::vector<size_t> cards = blocks_of_cards(run);
    for (const size_t block : blocks_to_show(run, most_views)) {
        if (block >= stage.model.rows.size()) continue;
        stage.go_to(block);
        const render::Scene scene = stage.scene();
        BlockView view{.block = block, .scene = writer.add(scene, stage.model.camera)};
        if (camera && std::find(cards.begin(), cards.end(), block) != cards.end()) {
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
        // A record has the exact engine's places; they are the same.
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
