#include <algorithm>
#include <filesystem>

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

void draw_name(Frame& frame, float width) {
    const ViewModel& model = frame.model;
    ImGui::SetCursorPosY(ImGui::GetCursorPosY() + frame.px(7));
    text(frame.fonts.text, frame.palette.color(Role::text), frame.fonts.icon(Icon::program));
    ImGui::SameLine();
    const std::string name =
        model.program ? std::filesystem::path(model.program->program).filename().generic_string()
                      : "feeler";
    text(frame.fonts.strong, frame.palette.color(Role::text),
         shortened(frame.fonts.strong, name, 0.55F * width));
    if (!model.program) return;
    std::string more = model.program->dialect;
    more += std::string(" \xC2\xB7 ") + length_unit(model);
    if (const std::string offset = work_offset(model); !offset.empty())
        more += " \xC2\xB7 " + offset;
    ImGui::SameLine();
    const float left = width - ImGui::GetCursorPosX();
    text(frame.fonts.text, frame.palette.color(Role::dim), shortened(frame.fonts.text, more, left));
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

void draw_right(Frame& frame) {
    const ViewModel& model = frame.model;
    icon_button(frame, Icon::device, Command::show_device, model.device.shown);
    ImGui::SameLine();
    icon_button(frame, Icon::section, Command::section, model.section.has_value());
    ImGui::SameLine();
    icon_button(frame, Icon::measure, Command::measure, model.measuring.on);
    ImGui::SameLine();
    icon_button(frame, Icon::picture, Command::picture);
    ImGui::SameLine();
    const bool is_dark = model.settings.theme == render::ColorScheme::dark;
    icon_button(frame, is_dark ? Icon::sun : Icon::moon, Command::theme);
    ImGui::SameLine();
    ImGui::PushID("settings");
    if (ImGui::Button(frame.fonts.icon(Icon::settings), ImVec2(frame.px(32), frame.px(32))))
        frame.model.popup = Popup::settings;
    tip(frame, "Settings");
    ImGui::PopID();
    ImGui::SameLine();
    icon_button(frame, Icon::question, Command::shortcuts, model.popup == Popup::shortcuts);
}

} // namespace

void ToolbarPanel::draw(Frame& frame, const Area& area) {
    const float width =
        std::min(static_cast<float>(frame.model.settings.list_width * frame.fonts.scale),
                 0.31F * area.width);
    const float right = area.width - 7 * frame.px(39) - frame.px(5);
    ImGui::SetCursorPos(ImVec2(frame.px(14), frame.px(8)));
    draw_name(frame, width - frame.px(10));
    if (frame.model.has_rows()) {
        // Buttons without room are left out; their keys still work.
        ImGui::SetCursorPos(ImVec2(width, frame.px(8)));
        if (width + frame.px(195) < right) draw_walk(frame);
        ImGui::SameLine(0, frame.px(16));
        if (width + frame.px(370) < right) draw_stops(frame);
        ImGui::SameLine(0, frame.px(16));
        if (width + frame.px(500) < right) draw_speed(frame);
    }
    ImGui::SetCursorPos(ImVec2(right, frame.px(8)));
    draw_right(frame);
}

} // namespace app::viewer
