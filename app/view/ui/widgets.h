#pragma once

#include "app/view/ui/panel.h"

namespace app::viewer {

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
