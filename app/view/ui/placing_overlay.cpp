#include "app/view/ui/placing_overlay.h"

#include "app/setup/stated_setup.h"
#include "app/view/model/placing.h"
#include "app/view/model/view_model.h"
#include "render/picking.h"

namespace app::viewer {

namespace {

using render::Role;

} // namespace

bool PlacingOverlay::take_pick_click(Frame& frame) {
    ViewModel& model = frame.model;
    if (model.placing.goal == PickGoal::none) return false;
    if (const ScenePick* meant = meant_pick(model)) take_pick(model, ScenePick(*meant), frame.now);
    last_ = render::Vec2(-1.0);
    return true;
}

bool PlacingOverlay::take_selection(ViewModel& model, const render::Pick& found,
                                    const render::Scene& scene) {
    if (!model.shows_setup || !(found.body || found.stock)) return false;
    const auto surface = found.surface();
    const bool is_body = found.body && surface && found.body->at.distance <= surface->distance;
    if (!is_body) {
        model.workspace.selected = {SetupItem::Kind::stock, {}, {}};
        return true;
    }
    const std::string& name = scene.bodies[found.body->body].name;
    if (model.workspace.stated && model.workspace.stated->fixture(name))
        model.workspace.selected = {SetupItem::Kind::fixture, name, {}};
    else if (scene.bodies[found.body->body].role == render::BodyRole::machine)
        model.workspace.selected = {SetupItem::Kind::machine, {}, {}};
    return true;
}

bool PlacingOverlay::draw_handles(Frame& frame, const Area& area, const render::Viewport& size) {
    ViewModel& model = frame.model;
    Placing& placing = model.placing;
    const SetupItem& selected = model.workspace.selected;
    const bool is_stock = selected.kind == SetupItem::Kind::stock;
    const bool is_shown = model.shows_setup && model.popup == Popup::none
                          && placing.goal == PickGoal::none
                          && (is_stock || selected.kind == SetupItem::Kind::fixture);
    const std::string name = is_stock ? stock_name : selected.name;
    if (!is_shown || !can_move(model, name)) {
        placing.drag.reset();
        return false;
    }
    const core::Aabb box = bounds_of_body(model, name);
    if (box.empty()) return false;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.PushClipRect(area.corner(), area.far_corner(), true);
    const Gizmo::Drag drag = gizmo_.draw(frame, area, size, box.center(), !is_stock);
    placing.drag = drag.by;
    placing.body = name;
    if (drag.by) {
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        draw_pill(frame, list, {mouse.x + frame.px(16), mouse.y + frame.px(12)}, drag.words);
    }
    list.PopClipRect();
    if (drag.is_done && drag.by) {
        const core::Transform by = *drag.by;
        placing.drag.reset();
        if (by != core::Transform()) move_body(model, name, by, "Move " + name);
    }
    return drag.takes_mouse;
}

void PlacingOverlay::find_picks(Frame& frame, const Area& area, const render::Viewport& size,
                                const render::Scene& scene) {
    ViewModel& model = frame.model;
    Placing& placing = model.placing;
    if (placing.goal == PickGoal::none || !ImGui::IsItemHovered()) return;
    if (ImGui::IsKeyPressed(key::tab, false)) ++placing.turn;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const render::Vec2 at(mouse.x - area.x, mouse.y - area.y);
    std::vector<ScenePick>& hovered = placing.picks->hovered;
    if (at == last_ && !hovered.empty()) return;
    last_ = at;
    placing.turn = 0;
    hovered.clear();
    const render::Pick found = render::pick(scene, model.camera, size, at, frame.px(6));
    const auto surface = found.surface();
    if (!surface) return;
    const bool is_body = found.body && found.body->at.distance <= surface->distance;
    const std::string name = is_body ? scene.bodies[found.body->body].name : stock_name;
    constexpr double reach = 10.0; // pixels
    hovered = picks_at(model, name, surface->point,
                       frame.px(reach) * render::pixel_size(model.camera, size, surface->point));
}

void PlacingOverlay::draw_picks(Frame& frame, const Area& area, const render::Viewport& size) {
    ViewModel& model = frame.model;
    const std::string hint = pick_hint(model);
    if (hint.empty()) return;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    draw_pill(frame, list, {area.x + frame.px(14), area.y + frame.px(50)},
              hint + "  (Tab: next feature, Esc: cancel)");
    const ScenePick* meant = meant_pick(model);
    if (!meant) return;
    const ImU32 color = frame.palette.color(Role::accent);
    const auto on_screen = [&](const core::Vec3& point) -> std::optional<ImVec2> {
        const auto seen = render::project(model.camera, size, point);
        if (!seen) return std::nullopt;
        return ImVec2(area.x + static_cast<float>(seen->position.x),
                      area.y + static_cast<float>(seen->position.y));
    };
    for (const std::vector<core::Vec3>& line : outline_of(model, *meant)) {
        std::vector<ImVec2> points;
        for (const core::Vec3& point : line)
            if (const auto at = on_screen(point)) points.push_back(*at);
        list.AddPolyline(points.data(), static_cast<int>(points.size()), color, 0, frame.px(3));
    }
    if (const auto at = on_screen(meant->feature.point);
        at && meant->feature.kind != core::FeatureKind::face)
        list.AddCircleFilled(*at, frame.px(5), color);
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    draw_pill(frame, list, {mouse.x + frame.px(16), mouse.y + frame.px(12)},
              meant->body + ": " + words_of(model, meant->feature));
}

} // namespace app::viewer
