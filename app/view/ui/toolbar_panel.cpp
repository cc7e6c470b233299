#include <algorithm>
#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "app/view/model/navigation.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"

namespace app::viewer {
namespace {

using render::Role;

std::string work_offset(const ViewModel& model) {
    if (model.program && model.program->counts_blocks) return {}; // Klartext has no G54
    if (!model.block_state) return {};
    for (const ShownValue& value : model.block_state->modal)
        if (value.name == "offset") return value.text;
    return {};
}

void draw_files(Frame& frame) {
    icon_button(frame, Icon::open, Command::open, frame.model.popup == Popup::open_file);
    ImGui::SameLine();
    ImGui::BeginDisabled(!frame.model.program);
    icon_button(frame, Icon::save, Command::save_setup);
    ImGui::EndDisabled();
    ImGui::SameLine();
}

void draw_name(Frame& frame, float width) {
    const ViewModel& model = frame.model;
    ImGui::SetCursorPosY(ImGui::GetCursorPosY() + frame.px(7));
    const std::string name =
        model.program ? std::filesystem::path(model.program->program).filename().generic_string()
                      : "feeler";
    const float start = ImGui::GetCursorPosX();
    text(frame.fonts.strong, frame.palette.color(Role::text),
         shortened(frame.fonts.strong, name, 0.62F * (width - start)));
    if (!model.program) return;
    std::string more = model.program->dialect;
    more += std::string(" \xC2\xB7 ") + length_unit(model);
    if (const std::string offset = work_offset(model); !offset.empty())
        more += " \xC2\xB7 " + offset;
    ImGui::SameLine();
    const float left = width - ImGui::GetCursorPosX();
    if (left > frame.px(30))
        text(frame.fonts.text, frame.palette.color(Role::dim),
             shortened(frame.fonts.text, more, left));
}

void draw_walk(Frame& frame) {
    icon_button(frame, Icon::first, Command::first_block);
    ImGui::SameLine();
    icon_button(frame, Icon::previous, Command::step_back);
    ImGui::SameLine();
    const bool playing = frame.model.playback.running;
    icon_button(frame, playing ? Icon::pause : Icon::play, Command::play, true);
    ImGui::SameLine();
    icon_button(frame, Icon::next, Command::step);
    ImGui::SameLine();
    icon_button(frame, Icon::last, Command::last_block);
}

void draw_stops(Frame& frame) {
    const bool none = frame.model.is_recorded && frame.model.offending.empty();
    ImGui::BeginDisabled(none);
    if (word_button(frame, Icon::warning, "Prev", true, "Previous problem (Shift+N)"))
        frame.perform(Command::previous_offending);
    ImGui::SameLine();
    if (word_button(frame, Icon::warning, "Next", false, "Next problem (N)"))
        frame.perform(Command::next_offending);
    ImGui::EndDisabled();
}

/// Draws a logarithmic slider, so that slow motion gets as much room as fast motion.
void draw_speed(Frame& frame) {
    auto speed = static_cast<float>(frame.model.playback.speed);
    ImGui::SetNextItemWidth(frame.px(116));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame.px(8), frame.px(8)));
    if (ImGui::SliderFloat("##speed", &speed, static_cast<float>(slowest),
                           static_cast<float>(fastest), speed < 9.95F ? "%.1fx" : "%.0fx",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
        frame.model.playback.speed = speed;
    ImGui::PopStyleVar();
    tip(frame, "Playback speed: 1x is the speed of the machine  ([ and ])");
}

/// A button at the right end of the toolbar.
struct RightButton {
    Icon icon;
    Command command;
    bool is_on = false;
};

/// The buttons at the right end, the least important ones first: those are left out in a narrow
/// window; their keys still work.
std::vector<RightButton> right_buttons(const ViewModel& model) {
    const bool is_dark = model.settings.theme == render::ColorScheme::dark;
    std::vector<RightButton> buttons = {
        {is_dark ? Icon::sun : Icon::moon, Command::theme},
        {Icon::picture, Command::picture},
        {Icon::measure, Command::measure, model.measuring.on},
        {Icon::what_if, Command::what_if, model.popup == Popup::what_if},
        {Icon::section, Command::section, model.section.has_value()},
        {Icon::edit, Command::edit_setup, model.shows_setup},
        {Icon::question, Command::shortcuts, model.popup == Popup::shortcuts}};
    if (has_device(model))
        buttons.insert(buttons.begin(), {Icon::device, Command::show_device, model.device.shown});
    return buttons;
}

/// Draws the buttons in the order of a work day: set-up, view, window.
void draw_right(Frame& frame, std::vector<RightButton> buttons) {
    constexpr Command order[] = {Command::show_device, Command::edit_setup, Command::what_if,
                                 Command::section,     Command::measure,    Command::picture,
                                 Command::theme,       Command::shortcuts};
    for (const Command command : order) {
        for (const RightButton& button : buttons) {
            if (button.command != command) continue;
            icon_button(frame, button.icon, command, button.is_on);
            ImGui::SameLine();
        }
    }
    ImGui::PushID("settings");
    if (ImGui::Button(frame.fonts.icon(Icon::settings), ImVec2(frame.px(32), frame.px(32))))
        frame.model.popup = Popup::settings;
    tip(frame, "Settings");
    ImGui::PopID();
}

} // namespace

void ToolbarPanel::draw(Frame& frame, const Area& area) {
    const float width =
        std::min(static_cast<float>(frame.model.settings.list_width * frame.fonts.scale),
                 0.31F * area.width);
    // Buttons without room are left out; their keys still work.
    std::vector<RightButton> buttons = right_buttons(frame.model);
    const float step = frame.px(39), files = frame.px(14) + 2 * step;
    const auto start_of = [&](size_t count) {
        return area.width - static_cast<float>(count + 1) * step - frame.px(5);
    };
    while (!buttons.empty() && start_of(buttons.size()) < std::min(files, area.width))
        buttons.erase(buttons.begin());
    const float right = start_of(buttons.size());
    ImGui::SetCursorPos(ImVec2(frame.px(14), frame.px(8)));
    draw_files(frame);
    draw_name(frame, std::min(width - frame.px(10), right));
    if (frame.model.has_rows()) {
        ImGui::SetCursorPos(ImVec2(width, frame.px(8)));
        if (width + frame.px(195) < right) draw_walk(frame);
        ImGui::SameLine(0, frame.px(16));
        if (width + frame.px(370) < right) draw_stops(frame);
        ImGui::SameLine(0, frame.px(16));
        if (width + frame.px(500) < right) draw_speed(frame);
    }
    ImGui::SetCursorPos(ImVec2(right, frame.px(8)));
    draw_right(frame, std::move(buttons));
}

} // namespace app::viewer
