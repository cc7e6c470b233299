#include <algorithm>
#include <condition_variable>
#include <mutex>

#include <epoxy/gl.h>
#include <imgui.h>

#include "app/check/check_job.h"
#include "app/view/model/device_worker.h"
#include "app/view/model/navigation.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/session_worker.h"
#include "app/view/ui/command.h"
#include "app/view/ui/imgui_backends.h"
#include "app/view/ui/panels.h"
#include "app/view/ui/window.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace app::viewer {
namespace {

using render::Role;

/// A picture as an OpenGL texture.
struct Texture {
    render::GlTexture texture = render::GlTexture::make();

    explicit Texture(const render::Image& image) {
        glBindTexture(GL_TEXTURE_2D, texture.id());
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA,
                     GL_UNSIGNED_BYTE, image.rgba.data());
    }
    ImTextureID id() const {
        return reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(texture.id()));
    }
};

} // namespace

struct OffscreenViewer::State {
    State(render::Offscreen context, render::Renderer renderer);
    ~State();
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    void wait();
    /// The picture that `draw` makes between ImGui's NewFrame and Render.
    core::Result<render::Image> drawn(const render::Viewport& size, render::ColorScheme theme,
                                      int frames, const std::function<void()>& draw);

    render::Offscreen context_;
    render::Renderer still_;
    std::unique_ptr<Layout> layout_;
    std::unique_ptr<Fonts> fonts_;
    std::mutex mutex_;
    std::condition_variable woken_;
    bool is_woken_ = false;
    std::optional<CheckJob> job_; // the open job
    std::unique_ptr<SessionWorker> worker_;
    std::unique_ptr<DeviceWorker> device_;
};

OffscreenViewer::State::State(render::Offscreen context, render::Renderer renderer)
    : context_(std::move(context)), still_(std::move(renderer)) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplOpenGL3_Init("#version 330 core");
    const auto wake = [this] {
        {
            const std::lock_guard lock(mutex_);
            is_woken_ = true;
        }
        woken_.notify_all();
    };
    worker_ = std::make_unique<SessionWorker>(wake);
    device_ = std::make_unique<DeviceWorker>(wake);
}

OffscreenViewer::State::~State() {
    device_.reset();
    worker_.reset();
    layout_.reset();
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

void OffscreenViewer::State::wait() {
    std::unique_lock lock(mutex_);
    woken_.wait(lock, [&] { return is_woken_; });
    is_woken_ = false;
}

OffscreenViewer::OffscreenViewer(std::unique_ptr<State> state) : state_(std::move(state)) {}

OffscreenViewer::~OffscreenViewer() = default;

core::Result<std::unique_ptr<OffscreenViewer>> OffscreenViewer::make(render::ColorScheme theme,
                                                                     double scale) {
    FEELER_TRY(render::Offscreen context, render::Offscreen::make());
    FEELER_TRY(render::Renderer renderer, render::Renderer::make());
    auto state = std::make_unique<State>(std::move(context), std::move(renderer));
    state->fonts_ = std::make_unique<Fonts>(load_fonts(scale));
    apply_style(Theme{theme}, scale);
    std::unique_ptr<OffscreenViewer> viewer(new OffscreenViewer(std::move(state)));
    viewer->model.settings.theme = theme;
    return viewer;
}

core::Result<render::Image> OffscreenViewer::State::drawn(const render::Viewport& size,
                                                          render::ColorScheme theme, int frames,
                                                          const std::function<void()>& draw) {
    FEELER_TRY(render::Canvas canvas, render::Canvas::make(size));
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = ImVec2(static_cast<float>(size.width), static_cast<float>(size.height));
    io.DeltaTime = 1.0F / 60.0F;
    for (int i = 0; i < frames; ++i) {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui::NewFrame();
        draw();
        ImGui::Render();
    }
    canvas.begin();
    glViewport(0, 0, size.width, size.height);
    const ImVec4 back = Theme{theme}.vector(Role::panel);
    glClearColor(back.x, back.y, back.z, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    canvas.finish();
    render::Image image = canvas.pixels();
    for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
    return image;
}

void OffscreenViewer::update() {
    take_in(model, state_->worker_->take(), 0.0);
    take_in(model, state_->device_->take());
    model.message.clear();
    send_device_orders(model, *state_->device_, state_->job_);
    send_requests(model, *state_->worker_);
}

core::Result<void> OffscreenViewer::open(const CheckJob& job) {
    state_->job_ = job;
    state_->worker_->open(job);
    while (!model.failure && !model.is_recorded) {
        state_->wait();
        update();
    }
    if (model.failure) return tl::unexpected(*model.failure);
    return {};
}

core::Result<void> OffscreenViewer::run_device(const std::string& file) {
    model.device.file = file;
    model.device.shown = true;
    update();
    while (model.device.is_running) {
        state_->wait();
        update();
    }
    if (model.device.failure) return tl::unexpected(*model.device.failure);
    return {};
}

void OffscreenViewer::settle() {
    if (!model.has_rows()) return;
    model.wanted = ShowRequest{model.cursor.block, model.cursor.fraction >= 1.0};
    const bool at_end = model.wanted->at_end;
    const uint64_t before = model.block_state ? model.block_state->serial : 0;
    if (model.block_state && model.block_state->block == model.cursor.block
        && model.block_state->at_end == at_end) {
        model.wanted.reset();
        return;
    }
    update();
    const auto is_there = [&] {
        return model.block_state && model.block_state->serial > before
               && model.block_state->block == model.cursor.block
               && model.block_state->at_end == at_end;
    };
    while (!is_there()) {
        state_->wait();
        update();
    }
}

void OffscreenViewer::set_view(ShotView view, const render::Viewport& size) {
    const auto from = [&](render::StandardView side) {
        model.camera = render::seen_from(model.camera, side);
        model.camera = render::framing(model.camera, size, render::work_bounds(scene_of(model)));
    };
    from(view == ShotView::top     ? render::StandardView::top
         : view == ShotView::front ? render::StandardView::front
                                   : render::StandardView::iso);
    if (view == ShotView::witness) model.camera = witness_camera(model, size);
    model.camera_placed = true;
}

core::Result<render::Image> OffscreenViewer::picture(const render::Viewport& size, bool with_ui) {
    if (!with_ui) {
        render::DrawOptions options;
        options.theme = model.settings.theme;
        return render::still_picture(state_->still_, scene_of(model), model.camera, options, size);
    }
    if (!state_->layout_) {
        FEELER_TRY(render::Renderer renderer, render::Renderer::make());
        state_->layout_ = std::make_unique<Layout>(std::move(renderer));
        state_->layout_->set_samples(4);
    }
    return state_->drawn(size, model.settings.theme, 4, [&] {
        model.list_follows = true;
        state_->layout_->draw(model, *state_->fonts_, 0.0);
    });
}

core::Result<render::Image> OffscreenViewer::sheet(const std::vector<Print>& prints,
                                                   size_t columns) {
    const int gap = 14, foot = 30;
    const render::Image& first = prints.front().image;
    const auto rows = static_cast<int>((prints.size() + columns - 1) / columns);
    const render::Viewport size{static_cast<int>(columns) * (first.width + gap) + gap,
                                rows * (first.height + foot + gap) + gap};
    std::vector<Texture> textures;
    for (const Print& print : prints) textures.emplace_back(print.image);
    const Theme palette{model.settings.theme};
    const Fonts& fonts = *state_->fonts_;
    return state_->drawn(size, model.settings.theme, 1, [&] {
        ImDrawList& list = *ImGui::GetBackgroundDrawList();
        for (size_t i = 0; i < prints.size(); ++i) {
            const auto x =
                static_cast<float>(gap + static_cast<int>(i % columns) * (first.width + gap));
            const auto y = static_cast<float>(
                gap + static_cast<int>(i / columns) * (first.height + foot + gap));
            const auto width = static_cast<float>(first.width);
            const auto bottom = y + static_cast<float>(first.height);
            list.AddImage(textures[i].id(), {x, y}, {x + width, bottom});
            list.AddText(fonts.small, fonts.small->FontSize, {x + 2, bottom + 6},
                         palette.color(Role::text),
                         shortened(fonts.small, prints[i].caption, width - 4).c_str());
        }
    });
}

} // namespace app::viewer
