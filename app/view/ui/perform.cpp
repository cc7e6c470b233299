
#include <algorithm>

#include "app/view/model/axis_display.h"
#include "app/view/model/navigation.h"
#include "app/view/model/placing.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/section.h"
#include "app/view/model/session_worker.h"
#include "app/view/model/settings.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panel.h"

namespace app::viewer {
namespace {

constexpr int page = 25;
constexpr double key_turn = 24.0; // a key turns the view as far as a drag of this many pixels
constexpr render::Viewport any_view{800, 600};

void toggle(bool& value) { value = !value; }

void set_view(ViewModel& model, render::StandardView view) {
    model.camera = render::seen_from(model.camera, view);
}

void turn(ViewModel& model, double x, double y) {
    model.camera = render::orbited(model.camera, any_view, {x * key_turn, y * key_turn});
}

void zoom(ViewModel& model, double factor) {
    model.camera = render::zoomed(model.camera, any_view, {400.0, 300.0}, factor);
}

void find_offending(ViewModel& model, bool forward, double now) {
    if (!go_to_offending(model, forward)) return say(model, no_violation(model), now);
    if (model.awaits_offending) say(model, "Waiting for the next problem to be found", now);
}

void step_findings(ViewModel& model, bool forward, double now) {
    show_findings(model, true);
    if (!step_stretch(model, forward)) say(model, "No more findings", now);
}

void begin_note(ViewModel& model, double now) {
    if (!selected_stretch(model)) return say(model, "No finding at this block", now);
    show_findings(model, true);
    model.note_wants_focus = true;
}

void toggle_section(ViewModel& model, double now) {
    if (model.section) return model.section.reset();
    if (!open_section(model)) say(model, "Nothing to cut yet", now);
}

/// Moves the section by steps, or flips it at 0 steps.
void change_section(ViewModel& model, int steps, double now) {
    if (!model.section) return say(model, "Press X for a section first", now);
    if (steps == 0) return flip_section(model);
    set_section_position(model, section_position(model) + steps * section_step(model));
}

/// Ends the picking of a plane. False: none was being picked.
bool end_picking(ViewModel& model) {
    if (!model.section || model.section->pick == SectionPick::none) return false;
    pick_section(model, model.section->pick);
    return true;
}

void toggle_measuring(ViewModel& model, double now) {
    toggle(model.measuring.on);
    model.measuring.positions.clear();
    if (model.measuring.on) say(model, "Click two points on surfaces; M ends measuring", now);
}

void toggle_bookmark(ViewModel& model) {
    if (model.bookmarks.erase(model.cursor.block) == 0) model.bookmarks.insert(model.cursor.block);
}

void set_scale(ViewModel& model, double factor) {
    model.settings.scale = std::clamp(model.settings.scale * factor, least_scale, largest_scale);
}

void open_popup(ViewModel& model, Popup popup) {
    model.popup = model.popup == popup ? Popup::none : popup;
}

void find_stop(ViewModel& model, bool forward, double now) {
    if (go_to_stop(model, forward)) return;
    say(model,
        model.device.study
            ? "No block is late or refused"
            : "No answers from the coprocessor yet; press D to run the program with it",
        now);
}

bool walk(ViewModel& model, Command command, double now) {
    switch (command) {
    case Command::step:
        step(model, 1);
        return true;
    case Command::step_back:
        step(model, -1);
        return true;
    case Command::step_ten:
        step(model, 10);
        return true;
    case Command::step_back_ten:
        step(model, -10);
        return true;
    case Command::page_forward:
        step(model, page);
        return true;
    case Command::page_back:
        step(model, -page);
        return true;
    case Command::next_tool:
        step_tool(model, true);
        return true;
    case Command::previous_tool:
        step_tool(model, false);
        return true;
    case Command::first_block:
        go_to(model, 0);
        return true;
    case Command::last_block:
        go_to(model, model.rows.size());
        return true;
    case Command::step_over:
        step_over(model, true);
        return true;
    case Command::step_over_back:
        step_over(model, false);
        return true;
    case Command::step_out:
        step_out(model);
        return true;
    case Command::next_offending:
        find_offending(model, true, now);
        return true;
    case Command::previous_offending:
        find_offending(model, false, now);
        return true;
    case Command::next_stop:
    case Command::previous_stop:
        find_stop(model, command == Command::next_stop, now);
        return true;
    case Command::next_bookmark:
        go_to_bookmark(model);
        return true;
    case Command::show_findings:
        show_findings(model, model.shows_setup ? model.shows_findings : !model.shows_findings);
        return true;
    case Command::next_stretch:
    case Command::previous_stretch:
        step_findings(model, command == Command::next_stretch, now);
        return true;
    case Command::write_note:
        begin_note(model, now);
        return true;
    case Command::toggle_bookmark:
        toggle_bookmark(model);
        return true;
    case Command::toggle_breakpoint:
        toggle_breakpoint(model, model.cursor.block);
        return true;
    case Command::go_on:
        model.walk = Walk::go_on;
        return true;
    case Command::reverse_resume:
        model.walk = Walk::reverse_resume;
        return true;
    default:
        return false;
    }
}

bool change_view(ViewModel& model, Command command, double now) {
    switch (command) {
    case Command::frame_witness:
        frame_witness(model);
        return true;
    case Command::frame_all:
        model.camera_placed = false;
        return true;
    case Command::view_iso:
        set_view(model, render::StandardView::iso);
        return true;
    case Command::view_top:
        set_view(model, render::StandardView::top);
        return true;
    case Command::view_front:
        set_view(model, render::StandardView::front);
        return true;
    case Command::view_right:
        set_view(model, render::StandardView::right);
        return true;
    case Command::view_back:
        set_view(model, render::StandardView::back);
        return true;
    case Command::view_left:
        set_view(model, render::StandardView::left);
        return true;
    case Command::view_bottom:
        set_view(model, render::StandardView::bottom);
        return true;
    case Command::orbit_left:
        turn(model, -1.0, 0.0);
        return true;
    case Command::orbit_right:
        turn(model, 1.0, 0.0);
        return true;
    case Command::orbit_up:
        turn(model, 0.0, -1.0);
        return true;
    case Command::orbit_down:
        turn(model, 0.0, 1.0);
        return true;
    case Command::zoom_in:
        zoom(model, 0.85);
        return true;
    case Command::zoom_out:
        zoom(model, 1.0 / 0.85);
        return true;
    case Command::section:
        toggle_section(model, now);
        return true;
    case Command::flip_section:
        change_section(model, 0, now);
        return true;
    case Command::section_back:
        change_section(model, -1, now);
        return true;
    case Command::section_forward:
        change_section(model, 1, now);
        return true;
    case Command::measure:
        toggle_measuring(model, now);
        return true;
    case Command::projection:
        model.settings.projection = model.settings.projection == render::Projection::perspective
                                        ? render::Projection::orthographic
                                        : render::Projection::perspective;
        return true;
    default:
        return false;
    }
}

bool show(ViewModel& model, Command command) {
    Settings& settings = model.settings;
    switch (command) {
    case Command::show_stock:
        toggle(settings.shown.stock);
        return true;
    case Command::show_fixtures:
        toggle(settings.shown.fixtures);
        return true;
    case Command::show_tool:
        toggle(settings.shown.tool);
        return true;
    case Command::show_machine:
        toggle(settings.shown.machine);
        return true;
    case Command::show_path:
        toggle(settings.shown.path);
        return true;
    case Command::show_device:
        show_device(model, !model.device.shown);
        return true;
    case Command::units:
        toggle(settings.inch);
        settings.has_own_unit = true;
        return true;
    case Command::theme:
        settings.theme = settings.theme == render::ColorScheme::dark ? render::ColorScheme::light
                                                                     : render::ColorScheme::dark;
        return true;
    case Command::larger:
        set_scale(model, 1.1);
        return true;
    case Command::smaller:
        set_scale(model, 1.0 / 1.1);
        return true;
    default:
        return false;
    }
}

/// Shows the next or previous open program, from the last on to the first.
void go_to_tab(ViewModel& model, bool forward) {
    const size_t count = model.tabs.size();
    if (count > 1) model.wanted_tab = (model.shown_tab + (forward ? 1 : count - 1)) % count;
}

} // namespace

void Frame::perform(Command command) { viewer::perform(model, command, now); }

void perform(ViewModel& model, Command command, double now) {
    if (walk(model, command, now) || change_view(model, command, now) || show(model, command))
        return;
    switch (command) {
    case Command::play:
        toggle(model.playback.running);
        stay(model);
        break;
    case Command::faster:
        model.playback.speed = next_speed(model.playback.speed, true);
        break;
    case Command::slower:
        model.playback.speed = next_speed(model.playback.speed, false);
        break;
    case Command::filter:
        if (!model.has_rows()) break;
        model.shows_findings = false;
        if (model.shows_setup) show_setup(model, false);
        model.filter_wants_focus = true;
        break;
    case Command::go_to_line:
        open_popup(model, Popup::go_to_line);
        break;
    case Command::tolerances:
        if (model.program) open_popup(model, Popup::tolerances);
        break;
    case Command::open:
        if (model.popup == Popup::open_file)
            close_browser(model);
        else
            browse(model, FileWish::open);
        break;
    case Command::open_last:
        open_last(model, now);
        break;
    case Command::break_if:
        open_popup(model, Popup::breakpoint);
        break;
    case Command::what_if:
        open_popup(model, Popup::what_if);
        break;
    case Command::edit_setup:
        show_setup(model, !model.shows_setup);
        break;
    case Command::save_setup:
        model.wants_saving = true;
        break;
    case Command::save_setup_as:
        if (!model.program) break;
        model.workspace.is_naming = true;
        browse(model, FileWish::save_setup);
        break;
    case Command::print_sheet:
        if (model.program) browse(model, FileWish::save_sheet);
        break;
    case Command::undo:
        undo(model, now);
        break;
    case Command::redo:
        redo(model, now);
        break;
    case Command::copy_item:
        copy_selected(model);
        break;
    case Command::shortcuts:
        open_popup(model, Popup::shortcuts);
        break;
    case Command::close_popup:
        if (model.popup == Popup::none && model.placing.goal != PickGoal::none) {
            begin_picking(model, PickGoal::none);
            break;
        }
        if (model.popup == Popup::none && model.workspace.has_keys) {
            show_setup(model, false);
            break;
        }
        if (model.popup == Popup::none && is_jogged(model)) {
            end_jog(model);
            break;
        }
        if (model.popup == Popup::none && !end_picking(model)) model.section.reset();
        if (model.popup == Popup::none && model.failure && model.tabs.size() > 1)
            model.unwanted_tab = model.shown_tab;
        model.workspace.leaving = Leaving::no;
        close_browser(model);
        model.playback.running = false;
        stay(model);
        break;
    case Command::picture:
        model.wants_picture = true;
        break;
    case Command::reload:
        model.wants_reload = true;
        break;
    case Command::next_program:
    case Command::previous_program:
        go_to_tab(model, command == Command::next_program);
        break;
    case Command::close_program:
        model.unwanted_tab = model.shown_tab;
        break;
    case Command::quit:
        model.wants_quit = true;
        break;
    default:
        break;
    }
}

void frame_witness(ViewModel& model) {
    if (!model.has_rows()) return;
    if (model.row().has_witness()) go_to_witness(model, model.cursor.block, model.shown_pair);
    model.camera = witness_camera(model, any_view);
}

bool send_requests(ViewModel& model, SessionWorker& worker) {
    bool any = false;
    if (std::exchange(model.breakpoints_changed, false)) {
        worker.set_breakpoints(model.breakpoints);
        any = true;
    }
    if (std::exchange(model.watches_changed, false)) {
        worker.watch(model.watches);
        model.wanted = ShowRequest{model.cursor.block, model.cursor.fraction >= 1.0};
    }
    if (const auto change = std::exchange(model.wanted_change, {})) {
        worker.change(*change, model.cursor.block);
        any = true;
    }
    if (std::exchange(model.wants_take_back, false)) {
        worker.take_back();
        any = true;
    }
    if (std::exchange(model.wants_interrupt, false)) worker.interrupt();
    if (const auto walk = std::exchange(model.walk, {})) {
        model.walking = worker.walk(*walk, model.cursor.block);
        any = true;
    }
    if (const auto wanted = std::exchange(model.wanted, {})) {
        worker.show(*wanted);
        any = true;
    }
    return any;
}

} // namespace app::viewer
