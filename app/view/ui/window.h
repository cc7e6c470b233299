#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/view/model/job_file.h"
#include "app/view/model/view_model.h"
#include "render/image.h"

namespace app {
struct CheckJob;
} // namespace app

namespace app::viewer {

/// The coprocessor, and whether to run programs with it from the beginning.
struct DeviceChoice {
    std::string file; // path of the device file; empty: the default device
    bool shown = false;
};

/// Makes the set-up sheet of a program, an HTML page. `goes_on` is polled: false ends it with an
/// error.
using SheetMaker = std::function<core::Result<std::string>(const CheckJob& check,
                                                           const std::function<bool()>& goes_on)>;

/// The options of the window.
struct WindowJob {
    std::vector<std::shared_ptr<const CheckJob>> checks; // empty: show the welcome screen
    DeviceChoice device;
    std::filesystem::path settings_file; // read when opened, written when closed; empty: none
    std::filesystem::path notes_file;    // notes on findings; empty: not stored
    std::filesystem::path recent_file;   // programs opened last; empty: not stored
    std::filesystem::path pictures;      // folder for pictures saved with F12
    std::filesystem::path unsaved;       // folder for unsaved set-ups; empty: they are not kept
    FileWriter write;                    // for set-ups, sheets and notes
    SheetMaker make_sheet;
    JobFileReader read_job_file;
    std::filesystem::path frame_log; // log of frames; empty: none
};

/// Opens the window and returns when it is closed.
///
/// Errors: unsupported, as a single line, without a display or OpenGL 3.3.
core::Result<void> run_window(const WindowJob& job);

/// Whether a file is about the set-up when it is dropped: a mesh, a tool library, a machine, a job
/// of a CAM system, offsets from the control.
bool is_part_of_setup(const std::string& path);

/// Whether all paths are those of files; otherwise says which one is not. A folder is shown in the
/// file browser.
bool can_open(const std::vector<std::string>& paths, ViewModel& model, double now);

/// What is to be opened after files were dropped on the window, with the options of `check`, the
/// shown program. Each program gets the dropped set-up of the same name, or the only one, or the
/// one next to it; without a program, the set-up is for the shown one. Meshes, tools and machines
/// are added to its set-up. If there is nothing to open, a message says why.
std::vector<CheckJob> dropped_programs(CheckJob check, const std::vector<std::string>& paths,
                                       ViewModel& model, double now);

/// Saves the notes of the open program, merged with those saved by other windows.
void keep_notes(ViewModel& model, const std::filesystem::path& path, const FileWriter& write,
                double now);

/// The camera of a picture.
enum class ShotView : uint8_t { iso, top, front, witness };

/// Takes pictures of a program without a window or screen, with the same drawing as the window.
class OffscreenViewer {
public:
    /// Errors: unsupported without OpenGL 3.3.
    static core::Result<std::unique_ptr<OffscreenViewer>> make(render::ColorScheme theme,
                                                               double scale);
    ~OffscreenViewer();

    /// Opens a program and checks all of it.
    ///
    /// Errors: as DebugSession::open.
    core::Result<void> open(const CheckJob& job);

    /// Runs the whole open program with a coprocessor, and shows its panel.
    ///
    /// Errors: those of read_device_file and run_with_coprocessor.
    core::Result<void> run_device(const std::string& file);

    ViewModel model;

    /// Waits until the view of the current block is loaded.
    void settle();
    /// Sets the camera. The view of the current block must be loaded: call settle() first.
    void set_view(ShotView view, const render::Viewport& size);
    /// A picture of the whole window, or of the 3D view alone.
    core::Result<render::Image> picture(const render::Viewport& size, bool with_ui);

    /// A picture and its caption.
    struct Print {
        render::Image image;
        std::string caption;
    };
    /// Arranges pictures of equal size in rows, each with its caption below.
    core::Result<render::Image> sheet(const std::vector<Print>& prints, size_t columns);

private:
    struct State;
    explicit OffscreenViewer(std::unique_ptr<State> state);
    void update();

    std::unique_ptr<State> state_;
};

} // namespace app::viewer
