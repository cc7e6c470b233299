#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.h"
#include "render/camera.h"
#include "render/palette.h"

namespace app::viewer {

/// Which buttons of the mouse turn and move the view. Left turns and right moves in all of them.
enum class MousePreset : uint8_t {
    middle_orbits,      // Shift+middle pans
    middle_pans,        // Shift+middle orbits
    middle_orbits_ctrl, // Ctrl+middle pans
};
constexpr const char* mouse_preset_names[] = {"Middle turns, Shift+middle moves",
                                              "Middle moves, Shift+middle turns",
                                              "Middle turns, Ctrl+middle moves"};

/// What is drawn.
struct Shown {
    bool stock = true, fixtures = true, tool = true, machine = true, path = true, witness = true;
    bool holder_xray = true;

    bool operator==(const Shown&) const = default;
};

/// What the window remembers from one time to the next.
struct Settings {
    render::ColorScheme theme = render::ColorScheme::dark;
    bool inch = false;
    double scale = 1.0; // of everything, on top of the screen's
    MousePreset mouse = MousePreset::middle_orbits;
    render::Projection projection = render::Projection::perspective;
    Shown shown;
    int width = 1440, height = 900; // of the window, in the screen's coordinates
    int x = -1, y = -1;             // of its corner; -1: where the system puts it
    bool maximised = false;
    double list_width = 372.0, inspector_width = 272.0, timeline_height = 152.0; // at scale 1
    double device_width = 300.0;

    bool operator==(const Settings&) const = default;
};

constexpr double least_scale = 0.6, largest_scale = 3.0;

/// The settings in a text; what it does not say, or says in a wrong way, stays as it is by default.
Settings settings_in(const std::string& text);

std::string text_of(const Settings& settings);

/// Those that were remembered; the usual ones where there is no file.
Settings read_settings(const std::filesystem::path& file);

/// Remembers them, with the folder they are in. Nobody is told where that fails. Without a path
/// nothing is written.
void write_settings(const Settings& settings, const std::filesystem::path& file);

} // namespace app::viewer
