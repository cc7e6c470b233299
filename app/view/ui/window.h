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

/// Beside which coprocessor programs are run, and whether that is wanted from the beginning.
struct DeviceChoice {
    std::string file; // empty: the usual one
    bool shown = false;
};

/// What the window begins with.
struct WindowJob {
    std::shared_ptr<const CheckJob> check; // null: the welcome screen
    DeviceChoice device;
    std::filesystem::path settings_file; // read at the start, written at the end; empty: neither
    std::filesystem::path notes_file;    // what is written on findings; empty: nowhere
    std::filesystem::path pictures;      // folder that F12 saves into
    SetupWriter write;                   // for set-ups and notes
    std::filesystem::path frame_log;     // where frames are written down; empty: nowhere
};

/// Opens the window and stays until it is closed.
///
/// Errors: unsupported, in a line, when there is no display or no OpenGL 3.3.
core::Result<void> run_window(const WindowJob& job);

/// The title of the window: it tells the place, for lists of windows and for those who have it read
/// to them; with the coprocessor's panel also what the device says of the block.
std::string window_title(const ViewModel& model);

/// Errors: io.
core::Result<std::string> read_text(const std::filesystem::path& path);

/// What is to be checked once files were dropped into the window: a program, a set-up, or both.
/// Another program comes without the set-up and the breakpoints of the one before. Empty when there
/// is nothing to be opened, of which a sentence tells.
std::optional<CheckJob> with_dropped(CheckJob check, const std::vector<std::string>& paths,
                                     ViewModel& model, double now);

/// Keeps the notes of the program that is open, and takes in those that others have kept of theirs.
void keep_notes(ViewModel& model, const std::filesystem::path& path, const SetupWriter& write,
                double now);

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
    struct State;
    explicit OffscreenViewer(std::unique_ptr<State> state);
    void update();

    std::unique_ptr<State> state_;
};

} // namespace app::viewer
