#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.h"
#include "render/camera.h"
#include "render/palette.h"

namespace app::viewer {

/// Which mouse buttons turn and move the view. In all presets left turns and right moves.
enum class MousePreset : uint8_t {
    middle_orbits,      // Shift+middle pans
    middle_pans,        // Shift+middle orbits
    middle_orbits_ctrl, // Ctrl+middle pans
};
constexpr const char* mouse_preset_names[] = {"Middle turns, Shift+middle moves",
                                              "Middle moves, Shift+middle turns",
                                              "Middle turns, Ctrl+middle moves"};

/// The visible parts of the scene.
struct VisibleParts {
    bool stock = true, fixtures = true, tool = true, machine = true, path = true, witness = true;
    bool holder_xray = true;
    bool ground = true, zeros = true; // zeros: the arrows at those of program and machine

    bool operator==(const VisibleParts&) const = default;
};

/// The settings that the window saves.
struct Settings {
    render::ColorScheme theme = render::ColorScheme::dark;
    bool inch = false;
    bool has_own_unit = false; // chosen by the user; otherwise that of the opened program
    double scale = 1.0;        // multiplied with the scale of the screen
    MousePreset mouse = MousePreset::middle_orbits;
    render::Projection projection = render::Projection::perspective;
    bool system_dialog = true; // for files, if the system has one
    VisibleParts shown;
    int width = 1440, height = 900; // of the window, screen coordinates
    int x = -1, y = -1;             // of its corner; -1: left to the system
    bool maximised = false;
    double list_width = 372.0, inspector_width = 272.0, timeline_height = 152.0; // at scale 1
    double device_width = 300.0;

    bool operator==(const Settings&) const = default;
};

constexpr double least_scale = 0.6, largest_scale = 3.0;

/// Parses settings; missing or invalid ones get their defaults.
Settings settings_in(const std::string& text);

std::string text_of(const Settings& settings);

/// Reads the settings; the defaults if there is no file.
Settings read_settings(const std::filesystem::path& file);

/// Writes the settings and creates their folder. Ignores errors. Does nothing without a path.
void write_settings(const Settings& settings, const std::filesystem::path& file);

} // namespace app::viewer
