#pragma once

#include <cstdint>
#include <string>

#include <imgui.h>

#include "app/view/ui/command.h"
#include "render/palette.h"

namespace app::viewer {

struct BlockRow;
struct ViewModel;

/// The colours of a theme as ImGui wants them.
struct Theme {
    render::ColorScheme theme = render::ColorScheme::dark;

    ImU32 color(render::Role role, double alpha = 1.0) const;
    ImVec4 vector(render::Role role, double alpha = 1.0) const;
    /// Of words. What is too pale for them on white is darker.
    ImU32 ink(render::Role role) const;
    /// A mixture of two roles: the first at share 0.
    ImU32 mixed(render::Role a, render::Role b, double share) const;
    /// Of a block's clearance; `otherwise` where it is clear.
    ImU32 of(const BlockRow& row, render::Role otherwise) const;
};

/// Gives ImGui's current context the colours and sizes of a theme.
void apply_style(const Theme& look, double scale);

} // namespace app::viewer

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

/// A part of the window, pixels.
struct Area {
    float x = 0, y = 0, width = 0, height = 0;

    ImVec2 corner() const { return {x, y}; }
    ImVec2 far_corner() const { return {x + width, y + height}; }
    ImVec2 size() const { return {width, height}; }
};

/// What a panel needs to draw one frame.
struct Frame {
    ViewModel& model;
    const Fonts& fonts;
    Theme look;
    double now = 0.0; // seconds

    float px(double length) const { return static_cast<float>(length * fonts.scale); }
    /// Does what a key would do.
    void perform(Command command);
};

/// A part of the window that follows the current block. Needs an ImGui context.
class Panel {
public:
    virtual ~Panel() = default;
    virtual void draw(Frame& frame, const Area& area) = 0;
};

/// A square button with an icon; what it does shows when it is pointed at. Whether it was pressed.
bool icon_button(Frame& frame, Icon icon, Command command, bool is_on = false);

/// A button with an icon and a word beside it.
bool word_button(Frame& frame, Icon icon, const char* word, bool icon_first, const char* tip);

/// A name in dim letters and its value beside it, cut off with dots where the panel ends.
void value_row(Frame& frame, const char* name, const std::string& value, double name_width = 84.0,
               bool is_changed = false);

/// A heading with a line above it.
void heading(Frame& frame, const char* text);

/// Text in a font and a colour.
void text(ImFont* font, ImU32 color, const std::string& words);
/// The same on several lines, within what is left of the panel's width.
void wrapped_text(ImFont* font, ImU32 color, const std::string& words);

/// What is said of the thing pointed at, after a moment.
void tip(const Frame& frame, const std::string& words);

/// As much of a text as fits into a width, with dots for the rest.
std::string shortened(ImFont* font, const std::string& words, float width);

/// Seconds as 00:03:12.
std::string clock_text(double seconds);

} // namespace app::viewer
