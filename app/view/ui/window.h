#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/view/model/view_model.h"
#include "render/image.h"

namespace app {
struct CheckJob;
} // namespace app

namespace app::viewer {

/// The coprocessor, and whether to run programs with it from the start.
struct DeviceChoice {
    std::string file; // empty: the default one
    bool shown = false;
};

/// The options of the window.
struct WindowJob {
    std::shared_ptr<const CheckJob> check; // null: the welcome screen
    DeviceChoice device;
    std::filesystem::path settings_file; // read at the start, written at the end; empty: none
    std::filesystem::path notes_file;    // notes on findings; empty: not stored
    std::filesystem::path pictures;      // folder for pictures by F12
    SetupWriter write;                   // for set-ups and notes
    std::filesystem::path frame_log;     // log of frames; empty: none
};

/// Opens the window and returns when it is closed.
///
/// Errors: unsupported, in a line, when there is no display or no OpenGL 3.3.
core::Result<void> run_window(const WindowJob& job);

/// The title of the window: it names the position, for lists of windows and screen readers; with
/// the coprocessor's panel also the answer of the device.
std::string window_title(const ViewModel& model);

/// Errors: io.
core::Result<std::string> read_text(const std::filesystem::path& path);

/// The job after files were dropped on the window: a program, a set-up, or both. Another program
/// drops the set-up and the breakpoints of the old one. Empty if there is nothing to open, with a
/// message.
std::optional<CheckJob> with_dropped(CheckJob check, const std::vector<std::string>& paths,
                                     ViewModel& model, double now);

/// Stores the notes of the open program, and merges those stored by other windows.
void keep_notes(ViewModel& model, const std::filesystem::path& path, const SetupWriter& write,
                double now);

/// The view of a picture.
enum class ShotView : uint8_t { iso, top, front, witness };

/// Takes pictures of a program without a window or screen, with the same drawing as the window.
class OffscreenViewer {
public:
    /// Errors: unsupported, when there is no OpenGL 3.3.
    static core::Result<std::unique_ptr<OffscreenViewer>> make(render::ColorScheme theme,
                                                               double scale);
    ~OffscreenViewer();

    /// Opens a program and checks all of it.
    ///
    /// Errors: as DebugSession::open.
    core::Result<void> open(const CheckJob& job);

    /// Runs all of the open program with a coprocessor, and shows its panel.
    ///
    /// Errors: those of read_device_file and run_beside_coprocessor.
    core::Result<void> run_device(const std::string& file);

    ViewModel model;

    /// Waits for the view of the cursor's block.
    void settle();
    /// Sets the camera. The view of the current block must be loaded: call settle() first.
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
    struct State;
    explicit OffscreenViewer(std::unique_ptr<State> state);
    void update();

    std::unique_ptr<State> state_;
};

} // namespace app::viewer
