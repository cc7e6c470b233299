#include "app/viewer/desk.h"

#include <algorithm>
#include <utility>

namespace app::viewer {
namespace {

using render::Role;

/// A panel in a part of the window, with room round what it holds.
void place(Frame& frame, Panel& panel, const char* name, const Area& area, ImVec2 padding,
           bool scrolls = false) {
    ImGui::SetCursorScreenPos(area.corner());
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
    ImGui::BeginChild(
        name, area.size(), false,
        ImGuiWindowFlags_AlwaysUseWindowPadding | ImGuiWindowFlags_NoNav
            | (scrolls ? 0 : ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse));
    ImGui::PopStyleVar();
    panel.draw(frame, area);
    ImGui::EndChild();
}

/// A line between two panels that can be dragged; returns how far.
float splitter(Frame& frame, const char* name, const Area& area, bool upright) {
    ImGui::SetCursorScreenPos(area.corner());
    ImGui::InvisibleButton(name, area.size());
    if (ImGui::IsItemHovered() || ImGui::IsItemActive()) {
        ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
        ImGui::GetWindowDrawList()->AddRectFilled(area.corner(), area.far_corner(),
                                                  frame.look.color(Role::accent, 0.6));
    }
    if (!ImGui::IsItemActive()) return 0.0F;
    return upright ? ImGui::GetIO().MouseDelta.x : ImGui::GetIO().MouseDelta.y;
}

} // namespace

void Desk::draw_body(Frame& frame, const Area& area) {
    ViewModel& model = frame.model;
    Settings& settings = model.settings;
    const auto scale = static_cast<float>(frame.fonts.scale);
    const float top = frame.px(48), grip = frame.px(5);
    // In a small window the view keeps the larger part.
    const auto width_of = [&](double wanted, double share) {
        return std::min(static_cast<float>(wanted) * scale, static_cast<float>(share) * area.width);
    };
    const float right = width_of(settings.inspector_width, 0.25);
    const float left = width_of(settings.list_width, 0.31);
    const float bottom =
        std::min(static_cast<float>(settings.timeline_height) * scale, 0.4F * area.height);
    const float middle = std::max(area.height - top - bottom, 16.0F);
    const Area view{area.x + left, area.y + top, std::max(area.width - left - right, 16.0F),
                    middle};
    place(frame, toolbar_, "toolbar", {area.x, area.y, area.width, top}, ImVec2(0, 0));
    Panel& list = model.shows_findings ? static_cast<Panel&>(findings_) : program_;
    place(frame, list, model.shows_findings ? "findings" : "program",
          {area.x, area.y + top, left, middle}, ImVec2(frame.px(12), frame.px(10)));
    place(frame, scene_, "view", view, ImVec2(0, 0));
    place(frame, inspector_, "inspector", {view.x + view.width, area.y + top, right, middle},
          ImVec2(frame.px(12), frame.px(10)), true);
    place(frame, timeline_, "timeline", {area.x, area.y + top + middle, area.width, bottom},
          ImVec2(frame.px(12), frame.px(7)));
    settings.list_width = std::clamp(
        settings.list_width
            + splitter(frame, "left", {view.x - grip, view.y, grip, middle}, true) / scale,
        200.0, 900.0);
    settings.inspector_width = std::clamp(
        settings.inspector_width
            - splitter(frame, "right", {view.x + view.width, view.y, grip, middle}, true) / scale,
        200.0, 700.0);
    settings.timeline_height = std::clamp(
        settings.timeline_height
            - splitter(frame, "bottom",
                       {area.x, area.y + top + middle - 0.5F * grip, area.width, grip}, false)
                  / scale,
        90.0, 500.0);
}

void Desk::draw(ViewModel& model, const Fonts& fonts, double now) {
    Frame frame{model, fonts, Look{model.settings.theme}, now};
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const Area area{0, 0, size.x, size.y};
    ImGui::SetNextWindowPos(ImVec2(0, 0));
    ImGui::SetNextWindowSize(size);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
    ImGui::Begin("desk", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav
                     | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar(2);
    const Area below{0, frame.px(48), size.x, size.y - frame.px(48)};
    const bool runs_nothing = model.is_recorded && !model.has_rows();
    if (model.failure || runs_nothing) {
        place(frame, toolbar_, "toolbar", {0, 0, size.x, frame.px(48)}, ImVec2(0, 0));
        place(frame, error_, "failure", below, ImVec2(0, 0));
    } else if (!model.program && !model.is_busy) {
        place(frame, toolbar_, "toolbar", {0, 0, size.x, frame.px(48)}, ImVec2(0, 0));
        place(frame, welcome_, "welcome", below, ImVec2(0, 0));
    } else {
        draw_body(frame, area);
    }
    ImGui::End();
    popups_.draw(frame, area);
    model.hovered = std::exchange(model.pointed_at, std::nullopt);
}

} // namespace app::viewer
