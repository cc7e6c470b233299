#pragma once

namespace app::viewer {

/// Keys by the numbers that GLFW gives them: ImGui 1.86 has no names for most of them.
namespace key {
constexpr int space = 32, comma = 44, minus = 45, period = 46, slash = 47, equal = 61;
constexpr int left_bracket = 91, right_bracket = 93;
constexpr int escape = 256, enter = 257, tab = 258, backspace = 259;
constexpr int right = 262, left = 263, down = 264, up = 265;
constexpr int page_up = 266, page_down = 267, home = 268, end = 269;
constexpr int f1 = 290;
constexpr int keypad_0 = 320, keypad_subtract = 333, keypad_add = 334;
constexpr int left_shift = 340, left_control = 341, left_alt = 342;
constexpr int right_shift = 344, right_control = 345, right_alt = 346;

/// Of a capital letter or a digit.
constexpr int of(char c) { return c; }
/// F1 .. F12
constexpr int function(int number) { return f1 + number - 1; }
} // namespace key

/// Modifiers, as GLFW's bits.
namespace mod {
constexpr int none = 0, shift = 1, control = 2, alt = 4;
} // namespace mod

} // namespace app::viewer
