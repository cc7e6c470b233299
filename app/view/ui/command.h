#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace app::viewer {

class SessionWorker;
struct ViewModel;

/// The action of a key or button.
enum class Command : uint8_t {
    step,
    step_back,
    step_ten,
    step_back_ten,
    next_tool,
    previous_tool,
    first_block,
    last_block,
    page_forward,
    page_back,
    step_over,
    step_over_back,
    step_out,
    play,
    faster,
    slower,
    go_on,
    reverse_resume,
    toggle_breakpoint,
    break_if,
    next_offending,
    previous_offending,
    go_to_line,
    toggle_bookmark,
    next_bookmark,
    show_findings,
    next_stretch,
    previous_stretch,
    write_note,
    filter,
    frame_witness,
    frame_all,
    view_iso,
    view_top,
    view_front,
    view_right,
    view_back,
    view_left,
    view_bottom,
    projection,
    orbit_left,
    orbit_right,
    orbit_up,
    orbit_down,
    zoom_in,
    zoom_out,
    section,
    flip_section,
    section_back,
    section_forward,
    measure,
    show_stock,
    show_fixtures,
    show_tool,
    show_machine,
    show_path,
    show_device,
    next_stop,
    previous_stop,
    theme,
    units,
    larger,
    smaller,
    picture,
    open,
    open_last,
    reload,
    what_if,
    edit_setup,
    save_setup,
    save_setup_as,
    print_sheet,
    undo,
    redo,
    copy_item,
    tolerances,
    shortcuts,
    next_program,
    previous_program,
    close_program,
    close_popup,
    quit
};

/// The heading in the list of keys.
enum class CommandGroup : uint8_t { walk, stops, camera, show, window };

const char* title_of(CommandGroup group);

/// A key and what it does.
struct KeyBinding {
    Command command;
    CommandGroup group;
    int code;         // GLFW key code, see namespace key
    int modifiers;    // exactly these must be down
    const char* keys; // for the list of keys
    const char* help; // empty: a second key for a command listed above
};

/// All key bindings, in the order of the list of keys.
std::span<const KeyBinding> key_bindings();

/// The command of a key; empty: none.
std::optional<Command> command_of(int code, int modifiers);

/// The help text and the key of a command: "Next block (Right)".
std::string tip_of(Command command);

/// Key codes of GLFW; ImGui 1.86 has no names for most of them.
namespace key {
constexpr int space = 32, comma = 44, minus = 45, period = 46, slash = 47, equal = 61;
constexpr int left_bracket = 91, right_bracket = 93;
constexpr int escape = 256, enter = 257, tab = 258, backspace = 259;
constexpr int insert = 260, remove = 261, right = 262, left = 263, down = 264, up = 265;
constexpr int page_up = 266, page_down = 267, home = 268, end = 269;
constexpr int f1 = 290;
constexpr int keypad_0 = 320, keypad_subtract = 333, keypad_add = 334;
constexpr int left_shift = 340, left_control = 341, left_alt = 342;
constexpr int right_shift = 344, right_control = 345, right_alt = 346;

/// The code of a capital letter or a digit.
constexpr int of(char c) { return c; }
/// The code of F1 .. F12.
constexpr int function(int number) { return f1 + number - 1; }
} // namespace key

/// Modifiers, with the bits of GLFW.
namespace mod {
constexpr int none = 0, shift = 1, control = 2, alt = 4;
} // namespace mod

/// Performs a command on the model. Stores requests that need the worker or the window in it.
void perform(ViewModel& model, Command command, double now);

/// Goes to the closest pair of the current block and centres the view on it.
void frame_witness(ViewModel& model);

/// Passes the requests in the model to the worker. True if there were any.
bool send_requests(ViewModel& model, SessionWorker& worker);

} // namespace app::viewer
