#include "app/view/model/device_sheet.h"
#include "app/view/model/device_worker.h"
#include "app/view/model/navigation.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"

namespace app::viewer {
namespace {

using render::Role;

ImU32 color_of(const Frame& frame, Tone tone) {
    switch (tone) {
    case Tone::bad:
        return frame.palette.color(Role::violation);
    case Tone::near:
        return frame.palette.ink(Role::near);
    case Tone::dim:
        return frame.palette.color(Role::dim);
    case Tone::plain:
        break;
    }
    return frame.palette.color(Role::text);
}

/// Draws the panel's title, and the button that hides the panel.
void draw_head(Frame& frame) {
    const float right = ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x;
    const float top = ImGui::GetCursorPosY();
    text(frame.fonts.small, frame.palette.color(Role::dim), "COPROCESSOR: SLACK");
    ImGui::SameLine(right - frame.px(22));
    ImGui::SetCursorPosY(top - frame.px(3));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, 0));
    ImGui::PushStyleColor(ImGuiCol_Button, 0);
    if (ImGui::Button(frame.fonts.icon(Icon::close), ImVec2(frame.px(22), frame.px(20))))
        frame.perform(Command::show_device);
    ImGui::PopStyleColor();
    ImGui::PopStyleVar();
    tip(frame, tip_of(Command::show_device));
}

/// Draws the progress or the error of the run.
void draw_status(Frame& frame) {
    const std::string status = device_status(frame.model);
    if (status.empty()) return;
    const DeviceModel& device = frame.model.device;
    if (device.failure)
        text(frame.fonts.strong, frame.palette.color(Role::violation),
             std::string(frame.fonts.icon(Icon::warning)) + "  The coprocessor cannot be run");
    wrapped_text(frame.fonts.text, frame.palette.color(device.failure ? Role::text : Role::dim),
                 status);
    if (device.is_running)
        ImGui::ProgressBar(static_cast<float>(device.fraction), ImVec2(-1.0F, frame.px(4)), "");
}

void draw_line(Frame& frame, const DeviceLine& line, double name_width) {
    ImGui::BeginGroup();
    const float left = ImGui::GetCursorPosX();
    text(frame.fonts.text, frame.palette.color(Role::dim), line.name);
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + frame.px(name_width));
    const std::string shown =
        shortened(frame.fonts.mono, line.value, ImGui::GetContentRegionAvail().x);
    ImU32 color = color_of(frame, line.tone);
    if (line.block && line.tone != Tone::bad) color = frame.palette.color(Role::accent);
    text(frame.fonts.mono, color, shown);
    ImGui::EndGroup();
    if (!line.block) {
        if (shown != line.value) tip(frame, line.value);
        return;
    }
    tip(frame, line.value + ": click to go there");
    if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    if (ImGui::IsItemClicked()) go_to(frame.model, *line.block);
}

void draw_part(Frame& frame, const DevicePart& part) {
    if (part.lines.empty()) return;
    heading(frame, part.title.c_str());
    const ImVec2 spacing = ImGui::GetStyle().ItemSpacing;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(spacing.x, frame.px(3)));
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, ImVec2(0, frame.px(1.5)));
    if (ImGui::BeginTable(part.title.c_str(), part.is_short ? 2 : 1)) {
        for (const DeviceLine& line : part.lines) {
            ImGui::TableNextColumn();
            draw_line(frame, line, part.is_short ? 66.0 : 104.0);
        }
        ImGui::EndTable();
    }
    ImGui::PopStyleVar(2);
}

void draw_answer(Frame& frame, const DeviceSheet& sheet) {
    text(frame.fonts.big, color_of(frame, sheet.tone), sheet.number);
    wrapped_text(frame.fonts.text, frame.palette.color(Role::text), sheet.answer);
    if (!sheet.exact.empty())
        wrapped_text(frame.fonts.small, color_of(frame, sheet.exact_tone), sheet.exact);
}

/// Draws the buttons for the next late or refused block, and for switching off.
void draw_buttons(Frame& frame) {
    const float room = ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x;
    ImGui::BeginDisabled(frame.model.device.study->stops.empty());
    if (ImGui::Button("Next late or refused", ImVec2(0.62F * room, 0)))
        frame.perform(Command::next_stop);
    ImGui::EndDisabled();
    tip(frame, tip_of(Command::next_stop));
    ImGui::SameLine();
    if (ImGui::Button("Switch off", ImVec2(0.38F * room, 0))) switch_off_device(frame.model);
    tip(frame, "End the run and remove slack from the timeline");
}

} // namespace

void DevicePanel::draw(Frame& frame, const Area&) {
    draw_head(frame);
    const ViewModel& model = frame.model;
    if (!model.device.study || !model.has_rows()) return draw_status(frame);
    const DeviceSheet sheet = device_sheet(model);
    draw_answer(frame, sheet);
    draw_buttons(frame);
    draw_status(frame);
    for (const DevicePart& part : sheet.parts) draw_part(frame, part);
}

} // namespace app::viewer
