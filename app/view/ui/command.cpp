#include "app/view/ui/command.h"

namespace app::viewer {
namespace {

using C = Command;
using G = CommandGroup;

constexpr int shift = mod::shift, control = mod::control, alt = mod::alt;

constexpr KeyBinding bindings[] = {
    {C::step, G::walk, key::right, 0, "Right", "Next block"},
    {C::step, G::walk, key::down, 0, "Down", ""},
    {C::step_back, G::walk, key::left, 0, "Left", "Previous block"},
    {C::step_back, G::walk, key::up, 0, "Up", ""},
    {C::step_ten, G::walk, key::right, shift, "Shift+Right", "Ten blocks forward"},
    {C::step_ten, G::walk, key::down, shift, "Shift+Down", ""},
    {C::step_back_ten, G::walk, key::left, shift, "Shift+Left", "Ten blocks back"},
    {C::step_back_ten, G::walk, key::up, shift, "Shift+Up", ""},
    {C::next_tool, G::walk, key::right, control, "Ctrl+Right", "Next tool change"},
    {C::previous_tool, G::walk, key::left, control, "Ctrl+Left", "Previous tool change"},
    {C::page_forward, G::walk, key::page_down, 0, "PageDown", "Page forward"},
    {C::page_back, G::walk, key::page_up, 0, "PageUp", "Page back"},
    {C::first_block, G::walk, key::home, 0, "Home", "First block"},
    {C::last_block, G::walk, key::end, 0, "End", "Last block"},
    {C::step_over, G::walk, key::function(10), 0, "F10", "Step over a subprogram"},
    {C::step_over_back, G::walk, key::function(10), shift, "Shift+F10", "Step over backwards"},
    {C::step, G::walk, key::function(11), 0, "F11", ""},
    {C::step_out, G::walk, key::function(11), shift, "Shift+F11", "Step out of a subprogram"},
    {C::play, G::walk, key::space, 0, "Space", "Play or pause"},
    {C::faster, G::walk, key::right_bracket, 0, "]", "Faster"},
    {C::slower, G::walk, key::left_bracket, 0, "[", "Slower"},
    {C::go_to_line, G::walk, key::of('G'), 0, "G", "Go to a line or N number"},

    {C::next_offending, G::stops, key::of('N'), 0, "N", "Next problem"},
    {C::next_offending, G::stops, key::function(3), 0, "F3", ""},
    {C::previous_offending, G::stops, key::of('N'), shift, "Shift+N", "Previous problem"},
    {C::previous_offending, G::stops, key::function(3), shift, "Shift+F3", ""},
    {C::toggle_breakpoint, G::stops, key::function(9), 0, "F9", "Breakpoint on this line"},
    {C::break_if, G::stops, key::function(9), shift, "Shift+F9", "Breakpoint on a condition"},
    {C::go_on, G::stops, key::function(5), 0, "F5", "Continue to a breakpoint"},
    {C::reverse_resume, G::stops, key::function(5), shift, "Shift+F5", "Continue backwards"},
    {C::toggle_bookmark, G::stops, key::of('B'), 0, "B", "Bookmark"},
    {C::next_bookmark, G::stops, key::of('B'), shift, "Shift+B", "Next bookmark"},
    {C::show_findings, G::stops, key::of('V'), 0, "V", "Show grouped findings or program lines"},
    {C::next_stretch, G::stops, key::down, control, "Ctrl+Down", "Next finding"},
    {C::previous_stretch, G::stops, key::up, control, "Ctrl+Up", "Previous finding"},
    {C::write_note, G::stops, key::of('R'), 0, "R", "Write a comment on a finding"},
    {C::next_stop, G::stops, key::of('L'), 0, "L", "Next late or refused block"},
    {C::previous_stop, G::stops, key::of('L'), shift, "Shift+L", "Previous late or refused block"},
    {C::filter, G::stops, key::of('F'), control, "Ctrl+F", "Filter the list"},
    {C::filter, G::stops, key::slash, 0, "/", ""},
    {C::what_if, G::stops, key::of('W'), 0, "W",
     "What if: change lengths, offsets, minimum clearance"},

    {C::frame_witness, G::camera, key::of('F'), 0, "F", "Show the closest pair"},
    {C::frame_all, G::camera, key::of('A'), 0, "A", "Show everything"},
    {C::view_iso, G::camera, key::of('0'), 0, "0", "Isometric view"},
    {C::view_top, G::camera, key::of('1'), 0, "1", "Top view"},
    {C::view_front, G::camera, key::of('2'), 0, "2", "Front view"},
    {C::view_right, G::camera, key::of('3'), 0, "3", "Right view"},
    {C::view_back, G::camera, key::of('4'), 0, "4", "Back view"},
    {C::view_left, G::camera, key::of('5'), 0, "5", "Left view"},
    {C::view_bottom, G::camera, key::of('6'), 0, "6", "Bottom view"},
    {C::projection, G::camera, key::of('P'), 0, "P", "Perspective on or off"},
    {C::orbit_left, G::camera, key::left, alt, "Alt+Left", "Turn the view left"},
    {C::orbit_right, G::camera, key::right, alt, "Alt+Right", "Turn the view right"},
    {C::orbit_up, G::camera, key::up, alt, "Alt+Up", "Turn the view up"},
    {C::orbit_down, G::camera, key::down, alt, "Alt+Down", "Turn the view down"},
    {C::zoom_in, G::camera, key::equal, 0, "+", "Zoom in"},
    {C::zoom_in, G::camera, key::equal, shift, "+", ""},
    {C::zoom_in, G::camera, key::keypad_add, 0, "+", ""},
    {C::zoom_out, G::camera, key::minus, 0, "-", "Zoom out"},
    {C::zoom_out, G::camera, key::keypad_subtract, 0, "-", ""},

    {C::show_stock, G::show, key::of('S'), shift, "Shift+S", "Stock"},
    {C::show_fixtures, G::show, key::of('C'), shift, "Shift+C", "Fixtures and clamps"},
    {C::show_tool, G::show, key::of('H'), shift, "Shift+H", "Tool and holder"},
    {C::show_machine, G::show, key::of('M'), shift, "Shift+M", "Machine"},
    {C::show_path, G::show, key::of('P'), shift, "Shift+P", "Path"},
    {C::show_device, G::show, key::of('D'), 0, "D", "Coprocessor: run it and show its panel"},
    {C::section, G::show, key::of('X'), 0, "X", "Section through the closest pair"},
    {C::flip_section, G::show, key::of('X'), shift, "Shift+X", "Section: cut away the other side"},
    {C::section_back, G::show, key::comma, 0, ",", "Section: move back (also Ctrl+wheel)"},
    {C::section_forward, G::show, key::period, 0, ".", "Section: move on"},
    {C::measure, G::show, key::of('M'), 0, "M", "Measure between two points"},

    {C::edit_setup, G::window, key::of('E'), 0, "E",
     "Set-up: machine, work offsets, stock, fixtures, tools"},
    {C::save_setup, G::window, key::of('S'), control, "Ctrl+S", "Save the set-up"},
    {C::save_setup_as, G::window, key::of('S'), control | shift, "Ctrl+Shift+S",
     "Save the set-up under another name"},
    {C::print_sheet, G::window, key::of('P'), control, "Ctrl+P",
     "Set-up sheet: a page to print for the machine"},
    {C::undo, G::window, key::of('Z'), control, "Ctrl+Z", "Undo an edit of the set-up"},
    {C::redo, G::window, key::of('Y'), control, "Ctrl+Y", "Redo it"},
    {C::redo, G::window, key::of('Z'), control | shift, "Ctrl+Shift+Z", ""},
    {C::copy_item, G::window, key::of('D'), control, "Ctrl+D", "Copy the selected fixture"},
    {C::tolerances, G::window, key::of('U'), 0, "U", "How wrong the set-up may be: tolerances"},
    {C::theme, G::window, key::of('T'), 0, "T", "Dark or light theme"},
    {C::units, G::window, key::of('I'), 0, "I", "mm or inch"},
    {C::larger, G::window, key::equal, control, "Ctrl++", "Larger text and controls"},
    {C::larger, G::window, key::equal, control | shift, "Ctrl++", ""},
    {C::smaller, G::window, key::minus, control, "Ctrl+-", "Smaller text and controls"},
    {C::picture, G::window, key::function(12), 0, "F12", "Save a picture"},
    {C::open, G::window, key::of('O'), control, "Ctrl+O", "Open a program or set-up"},
    {C::open_last, G::window, key::of('O'), control | shift, "Ctrl+Shift+O",
     "Open the program used before this one"},
    {C::next_program, G::window, key::tab, control, "Ctrl+Tab", "Next open program"},
    {C::next_program, G::window, key::page_down, control, "Ctrl+PageDown", ""},
    {C::previous_program, G::window, key::tab, control | shift, "Ctrl+Shift+Tab",
     "Previous open program"},
    {C::previous_program, G::window, key::page_up, control, "Ctrl+PageUp", ""},
    {C::close_program, G::window, key::of('W'), control, "Ctrl+W", "Close the program"},
    {C::reload, G::window, key::of('R'), control, "Ctrl+R", "Reload the files"},
    {C::shortcuts, G::window, key::function(1), 0, "F1", "List of keys (also ?)"},
    {C::shortcuts, G::window, key::slash, shift, "?", ""},
    {C::close_popup, G::window, key::escape, 0, "Esc", "Close the dialog or section; stop"},
    {C::quit, G::window, key::of('Q'), control, "Ctrl+Q", "Close the window"},
};

} // namespace

const char* title_of(CommandGroup group) {
    switch (group) {
    case CommandGroup::walk:
        return "Step through the program";
    case CommandGroup::stops:
        return "Find and stop";
    case CommandGroup::camera:
        return "View";
    case CommandGroup::show:
        return "Show or hide";
    case CommandGroup::window:
        return "Window";
    }
    return "";
}

std::span<const KeyBinding> key_bindings() { return bindings; }

std::optional<Command> command_of(int code, int modifiers) {
    for (const KeyBinding& binding : bindings)
        if (binding.code == code && binding.modifiers == modifiers) return binding.command;
    return {};
}

std::string tip_of(Command command) {
    for (const KeyBinding& binding : bindings)
        if (binding.command == command)
            return std::string(binding.help) + " (" + binding.keys + ")";
    return {};
}

} // namespace app::viewer
