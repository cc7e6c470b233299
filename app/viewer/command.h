#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace app::viewer {

/// What a key or a button does.
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
    go_on_back,
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
    reload,
    what_if,
    edit_setup,
    save_setup,
    shortcuts,
    close_popup,
    quit
};

/// Under which heading the list of keys has it.
enum class CommandGroup : uint8_t { walk, stops, look, show, window };

const char* title_of(CommandGroup group);

/// A key and what it does.
struct KeyBinding {
    Command command;
    CommandGroup group;
    int code;         // as key_codes.h has it
    int modifiers;    // all of them and no others
    const char* keys; // as a person reads it
    const char* help; // what it does; empty: another key for the command above
};

/// All of them, in the order in which they are listed.
std::span<const KeyBinding> key_bindings();

/// The command of a key; empty when it has none.
std::optional<Command> command_of(int code, int modifiers);

/// The help and the key of a command: "Next block (Right)".
std::string tip_of(Command command);

} // namespace app::viewer
