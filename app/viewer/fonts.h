#pragma once

#include <cstdint>

struct ImFont;

namespace app::viewer {

/// The pictures on buttons and in lists.
enum class Icon : uint8_t {
    program,
    first,
    previous,
    play,
    pause,
    next,
    last,
    warning,
    near,
    section,
    question,
    picture,
    settings,
    moon,
    sun,
    search,
    breakpoint,
    bookmark,
    measure,
    check,
    close,
    open,
    locate,
    undo,
    chevron,
    note,
    bulb,
    changed,
    device
};

/// The fonts of the window at one scale. Where a file is missing ImGui's own font stands in, and
/// words or signs of plain text for icons.
struct Fonts {
    ImFont* text = nullptr;  // 15 px
    ImFont* small = nullptr; // 12.5 px
    ImFont* strong = nullptr;
    ImFont* big = nullptr;  // 38 px, for the number
    ImFont* mono = nullptr; // 14.5 px
    bool has_icons = false;
    double scale = 1.0;

    const char* icon(Icon icon) const;
};

/// Loads all fonts anew into ImGui's current context, FreeType hinting them lightly. Their texture
/// must be made again after that.
Fonts load_fonts(double scale);

} // namespace app::viewer
