#pragma once

#include <cstdint>
#include <string>

#include <imgui.h>

#include "app/view/ui/command.h"
#include "render/palette.h"

namespace app::viewer {

struct BlockRow;
struct ViewModel;

/// The colours of a theme in the formats of ImGui.
struct Theme {
    render::ColorScheme theme = render::ColorScheme::dark;

    ImU32 color(render::Role role, double alpha = 1.0) const;
    ImVec4 vector(render::Role role, double alpha = 1.0) const;
    /// A role's colour for text: darker if it would be too pale on white.
    ImU32 ink(render::Role role) const;
    /// A mixture of two roles; at share 0 it is the first.
    ImU32 mixed(render::Role a, render::Role b, double fraction) const;
    /// The colour of a block's clearance; `otherwise` if it is clear.
    ImU32 of(const BlockRow& row, render::Role otherwise) const;
};

/// Sets the colours and sizes of a theme in ImGui's current context.
void apply_style(const Theme& palette, double scale);

} // namespace app::viewer

struct ImFont;

namespace app::viewer {

/// The icons on buttons and in lists.
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
    redo,
    chevron,
    note,
    bulb,
    changed,
    device,
    save,
    edit,
    what_if,
    flip,
    tool
};

/// The fonts of the window at one scale. Without a font file, ImGui's own font is used, and plain
/// text for icons.
struct Fonts {
    ImFont* text = nullptr;  // 15 px
    ImFont* small = nullptr; // 12.5 px
    ImFont* strong = nullptr;
    ImFont* big = nullptr;  // 38 px, for the large number
    ImFont* mono = nullptr; // 14.5 px
    bool has_icons = false;
    double scale = 1.0;

    const char* icon(Icon icon) const;
};

/// Loads all fonts into ImGui's current context, lightly hinted by FreeType. Create the font
/// texture again afterwards.
Fonts load_fonts(double scale);

/// A rectangle of the window, pixels.
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
    Theme palette;
    double now = 0.0; // seconds

    float px(double length) const { return static_cast<float>(length * fonts.scale); }
    /// Performs a command, as its key would.
    void perform(Command command);
};

/// A panel that shows the current block. Needs an ImGui context.
class Panel {
public:
    virtual ~Panel() = default;
    virtual void draw(Frame& frame, const Area& area) = 0;
};

/// A square button with an icon and a tooltip. True when pressed.
bool icon_button(Frame& frame, Icon icon, Command command, bool is_on = false);

/// A button with an icon and a word next to it. True when pressed.
bool word_button(Frame& frame, Icon icon, const char* word, bool icon_first, const char* tip);

/// A dim name with its value, truncated with an ellipsis at the edge of the panel.
void value_row(Frame& frame, const char* name, const std::string& value, double name_width = 84.0,
               bool is_changed = false);

/// A heading with a line above it.
void heading(Frame& frame, const char* text);

/// Draws text in a font and a colour.
void text(ImFont* font, ImU32 color, const std::string& words);
/// As text(), wrapped at the edge of the panel.
void wrapped_text(ImFont* font, ImU32 color, const std::string& words);

/// Draws words in a box with round corners, in front of a picture.
void draw_pill(const Frame& frame, ImDrawList& list, ImVec2 corner, const std::string& words);

/// A tooltip for the last item.
void tip(const Frame& frame, const std::string& words);

/// A text truncated with an ellipsis to fit a width.
std::string shortened(ImFont* font, const std::string& words, float width);

/// Seconds as hours, minutes and seconds: 00:03:12.
std::string clock_text(double seconds);

} // namespace app::viewer
