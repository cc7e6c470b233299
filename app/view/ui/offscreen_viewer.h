#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>

#include "app/view/model/session_worker.h"
#include "app/view/model/view_model.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace app::viewer {

class Layout;
struct Fonts;

/// From which side a picture is taken.
enum class ShotView : uint8_t { iso, top, front, witness };

/// Takes pictures of a program without a window or a screen, by the functions that the window
/// draws with.
class OffscreenViewer {
public:
    /// Errors: unsupported, when there is no OpenGL 3.3.
    static core::Result<std::unique_ptr<OffscreenViewer>> make(render::ColorScheme theme,
                                                               double scale);
    ~OffscreenViewer();

    /// Opens a program and checks it to its end.
    ///
    /// Errors: as DebugSession::open.
    core::Result<void> open(const CheckJob& job);

    /// Runs the program that is open beside a coprocessor, to its end, and shows its panel.
    ///
    /// Errors: those of read_device_file and run_beside_coprocessor.
    core::Result<void> run_device(const std::string& file);

    ViewModel model;

    /// Waits for the view of the cursor's block.
    void settle();
    /// Turns the camera; the cursor's view must be there.
    void look(ShotView view, const render::Viewport& size);
    /// The whole window, or the 3D view alone.
    core::Result<render::Image> picture(const render::Viewport& size, bool with_ui);

    /// A picture with its line of text.
    struct Print {
        render::Image image;
        std::string caption;
    };
    /// Pictures of one size in rows, each with its caption below.
    core::Result<render::Image> sheet(const std::vector<Print>& prints, size_t columns);

private:
    OffscreenViewer(render::Offscreen context, render::Renderer renderer, render::ColorScheme theme,
                    double scale);
    void wait();
    void update();
    /// What is drawn between ImGui's NewFrame and Render, as a picture.
    core::Result<render::Image> drawn(const render::Viewport& size, int frames,
                                      const std::function<void()>& draw);

    render::Offscreen context_;
    render::Renderer still_;
    std::unique_ptr<Layout> layout_;
    std::unique_ptr<Fonts> fonts_;
    std::mutex mutex_;
    std::condition_variable woken_;
    bool is_woken_ = false;
    std::optional<CheckJob> job_; // that is open
    std::unique_ptr<SessionWorker> worker_;
    std::unique_ptr<DeviceWorker> device_;
};

} // namespace app::viewer
