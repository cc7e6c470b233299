#include <algorithm>
#include <utility>

#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "render/renderer.h"

namespace app::viewer {
namespace {

using render::Role;

/// Draws a panel in an area of the window, with padding inside.
void place(Frame& frame, Panel& panel, const char* name, const Area& area, ImVec2 padding,
           bool scrolls = false, bool takes_keys = false) {
    ImGui::SetCursorScreenPos(area.corner());
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
    ImGui::BeginChild(
        name, area.size(), false,
        ImGuiWindowFlags_AlwaysUseWindowPadding | (takes_keys ? 0 : ImGuiWindowFlags_NoNav)
            | (scrolls ? 0 : ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse));
    ImGui::PopStyleVar();
    panel.draw(frame, area);
    ImGui::EndChild();
}

/// A line between two panels that can be dragged; returns by how many pixels. It is a separate
/// child window on top of the panels, which would otherwise take the mouse.
float splitter(Frame& frame, const char* name, const Area& area, bool upright) {
    ImGui::SetCursorScreenPos(area.corner());
    ImGui::BeginChild(name, area.size(), false,
                      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground
                          | ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoNav);
    ImGui::InvisibleButton("line", area.size());
    const bool is_dragged = ImGui::IsItemActive();
    if (ImGui::IsItemHovered() || is_dragged) {
        ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
        ImGui::GetWindowDrawList()->AddRectFilled(area.corner(), area.far_corner(),
                                                  frame.palette.color(Role::accent, 0.6));
    }
    ImGui::EndChild();
    if (!is_dragged) return 0.0F;
    return upright ? ImGui::GetIO().MouseDelta.x : ImGui::GetIO().MouseDelta.y;
}

/// The width of a column, pixels: limited in a small window, so that the 3D view stays larger.
float width_of(const Frame& frame, const Area& area, double wanted, double fraction) {
    return std::min(frame.px(wanted), static_cast<float>(fraction) * area.width);
}

/// Adds a splitter's drag to a setting, within limits.
void drag(double& setting, float by, const Frame& frame, double least, double most) {
    setting = std::clamp(setting + by / frame.fonts.scale, least, most);
}

constexpr double least_view = 560.0; // width that both right columns must leave to the 3D view

} // namespace

Layout::Layout(render::Renderer renderer) : scene_(std::move(renderer)) {}

Layout::~Layout() = default;

void Layout::set_samples(int samples) { scene_.set_samples(samples); }

Layout::Parts Layout::parts_of(const Frame& frame, const Area& area) {
    const Settings& settings = frame.model.settings;
    const float top = area.y + frame.px(48);
    const float bottom = std::min(frame.px(settings.timeline_height), 0.4F * area.height);
    const float height = std::max(area.height - frame.px(48) - bottom, 16.0F);
    const float left = width_of(frame, area, settings.list_width, 0.31);
    float inspector = width_of(frame, area, settings.inspector_width, 0.25);
    float device = 0.0F;
    if (frame.model.device.shown) {
        device = width_of(frame, area, settings.device_width, 0.3);
        // Without room for both, the coprocessor panel replaces the inspector.
        if (area.width - left - inspector - device < frame.px(least_view)) inspector = 0.0F;
    }
    Parts parts;
    parts.toolbar = {area.x, area.y, area.width, frame.px(48)};
    parts.list = {area.x, top, left, height};
    parts.view = {area.x + left, top, std::max(area.width - left - device - inspector, 16.0F),
                  height};
    parts.device = {parts.view.x + parts.view.width, top, device, height};
    parts.inspector = {parts.device.x + device, top, inspector, height};
    parts.timeline = {area.x, top + height, area.width, bottom};
    return parts;
}

void Layout::draw_splitters(Frame& frame, const Parts& parts) {
    Settings& settings = frame.model.settings;
    const float grip = frame.px(5);
    const auto upright = [&](const char* name, float x) {
        return splitter(frame, name, {x, parts.view.y, grip, parts.view.height}, true);
    };
    drag(settings.list_width, upright("left", parts.view.x - grip), frame, 200.0, 900.0);
    if (parts.device.width > 0.0F)
        drag(settings.device_width, -upright("device edge", parts.device.x), frame, 220.0, 700.0);
    if (parts.inspector.width > 0.0F)
        drag(settings.inspector_width, -upright("right", parts.inspector.x), frame, 200.0, 700.0);
    const Area& foot = parts.timeline;
    drag(settings.timeline_height,
         -splitter(frame, "bottom", {foot.x, foot.y - 0.5F * grip, foot.width, grip}, false), frame,
         90.0, 500.0);
}

void Layout::draw_body(Frame& frame, const Area& area) {
    const Parts parts = parts_of(frame, area);
    const ImVec2 room(frame.px(12), frame.px(10));
    place(frame, toolbar_, "toolbar", parts.toolbar, ImVec2(0, 0));
    const bool findings = frame.model.shows_findings;
    if (frame.model.shows_setup)
        place(frame, setup_, "setup", parts.list, room, false, true);
    else
        place(frame, findings ? static_cast<Panel&>(findings_) : program_,
              findings ? "findings" : "program", parts.list, room);
    place(frame, scene_, "view", parts.view, ImVec2(0, 0));
    if (parts.device.width > 0.0F) place(frame, device_, "device", parts.device, room, true);
    if (parts.inspector.width > 0.0F)
        place(frame, inspector_, "inspector", parts.inspector, room, true);
    place(frame, timeline_, "timeline", parts.timeline, ImVec2(frame.px(12), frame.px(7)));
    draw_splitters(frame, parts);
}

void Layout::draw(ViewModel& model, const Fonts& fonts, double now) {
    Frame frame{model, fonts, Theme{model.settings.theme}, now};
    model.workspace.has_keys = false; // unless its panel is drawn, with the focus
    if (!model.shows_setup) model.workspace.is_typing = model.workspace.commits_typed = false;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float top = std::min(TabStrip::height_of(frame), size.y);
    const Area area{0, top, size.x, size.y - top};
    ImGui::SetNextWindowPos(ImVec2(0, 0));
    ImGui::SetNextWindowSize(size);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
    ImGui::Begin("desk", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav
                     | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar(2);
    const Area bar{0, top, size.x, frame.px(48)};
    const Area below{0, top + bar.height, size.x, area.height - bar.height};
    if (top > 0.0F) place(frame, tabs_, "tabs", {0, 0, size.x, top}, ImVec2(0, 0));
    const bool runs_nothing = model.is_recorded && !model.has_rows();
    if (model.failure || runs_nothing) {
        place(frame, toolbar_, "toolbar", bar, ImVec2(0, 0));
        place(frame, error_, "failure", below, ImVec2(0, 0));
    } else if (!model.program && !model.is_busy) {
        place(frame, toolbar_, "toolbar", bar, ImVec2(0, 0));
        place(frame, welcome_, "welcome", below, ImVec2(0, 0), false, true);
    } else {
        draw_body(frame, area);
    }
    ImGui::End();
    popups_.draw(frame, area);
    model.hovered = std::exchange(model.pointed_at, std::nullopt);
}

} // namespace app::viewer
