#pragma once

#include <filesystem>
#include <optional>

#include "app/check/saved_setup.h"
#include "app/view/model/view_model.h"

namespace app::viewer {

/// Beside which coprocessor programs are run, and whether that is wanted from the beginning.
struct DeviceChoice {
    std::string file; // empty: the usual one
    bool shown = false;
};

/// What the window begins with.
struct WindowJob {
    std::optional<CheckJob> check; // empty: the welcome screen
    DeviceChoice device;
    std::filesystem::path settings_file; // read at the start, written at the end; empty: neither
    std::filesystem::path notes_file;    // what is written on findings; empty: nowhere
    std::filesystem::path pictures;      // folder that F12 saves into
    FileWriter write;                    // how set-ups are saved
    std::filesystem::path frame_log;     // where frames are written down; empty: nowhere
};

/// Opens the window and stays until it is closed.
///
/// Errors: unsupported, in a line, when there is no display or no OpenGL 3.3.
core::Result<void> run_window(const WindowJob& job);

/// The title of the window: it tells the place, for lists of windows and for those who have it read
/// to them; with the coprocessor's panel also what the device says of the block.
std::string window_title(const ViewModel& model);

} // namespace app::viewer
