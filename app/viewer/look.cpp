#include "app/viewer/look.h"

namespace app::viewer {
namespace {

using render::Role;

ImU32 packed(const render::Color& color) { return IM_COL32(color.r, color.g, color.b, color.a); }

void set_colors(const Look& look, ImVec4* colors) {
    const ImVec4 clear(0, 0, 0, 0);
    colors[ImGuiCol_Text] = look.vector(Role::text);
    colors[ImGuiCol_TextDisabled] = look.vector(Role::dim);
    colors[ImGuiCol_TextSelectedBg] = look.vector(Role::accent, 0.35);
    colors[ImGuiCol_WindowBg] = look.vector(Role::panel);
    colors[ImGuiCol_ChildBg] = clear;
    colors[ImGuiCol_PopupBg] = look.vector(Role::panel, 0.98);
    colors[ImGuiCol_Border] = look.vector(Role::line);
    colors[ImGuiCol_FrameBg] = look.vector(Role::raised);
    colors[ImGuiCol_FrameBgHovered] = look.vector(Role::line);
    colors[ImGuiCol_FrameBgActive] = look.vector(Role::line);
    colors[ImGuiCol_ScrollbarBg] = clear;
    colors[ImGuiCol_ScrollbarGrab] = look.vector(Role::line);
    colors[ImGuiCol_ScrollbarGrabHovered] = look.vector(Role::dim, 0.7);
    colors[ImGuiCol_ScrollbarGrabActive] = look.vector(Role::dim);
    colors[ImGuiCol_CheckMark] = look.vector(Role::accent);
    colors[ImGuiCol_SliderGrab] = look.vector(Role::accent);
    colors[ImGuiCol_SliderGrabActive] = look.vector(Role::accent);
    colors[ImGuiCol_Button] = look.vector(Role::raised);
    colors[ImGuiCol_ButtonHovered] = look.vector(Role::line);
    colors[ImGuiCol_ButtonActive] = look.vector(Role::accent, 0.45);
    colors[ImGuiCol_Header] = look.vector(Role::raised);
    colors[ImGuiCol_HeaderHovered] = look.vector(Role::line);
    colors[ImGuiCol_HeaderActive] = look.vector(Role::line);
    colors[ImGuiCol_Separator] = look.vector(Role::line);
    colors[ImGuiCol_SeparatorHovered] = look.vector(Role::accent, 0.6);
    colors[ImGuiCol_SeparatorActive] = look.vector(Role::accent);
    colors[ImGuiCol_TitleBg] = colors[ImGuiCol_TitleBgActive] = look.vector(Role::raised);
    colors[ImGuiCol_NavHighlight] = look.vector(Role::accent);
    colors[ImGuiCol_ModalWindowDimBg] = ImVec4(0, 0, 0, 0.45F);
    colors[ImGuiCol_PlotHistogram] = look.vector(Role::accent);
}

} // namespace

ImU32 Look::color(Role role, double alpha) const {
    render::Color found = render::color(theme, role);
    return packed(render::with_alpha(found, alpha * found.a / 255.0));
}

ImVec4 Look::vector(Role role, double alpha) const {
    return ImGui::ColorConvertU32ToFloat4(color(role, alpha));
}

ImU32 Look::ink(Role role) const {
    const bool is_pale = role == Role::near && theme == render::Theme::light;
    return is_pale ? mixed(role, Role::text, 0.55) : color(role);
}

ImU32 Look::mixed(Role a, Role b, double share) const {
    return packed(render::mixed(render::color(theme, a), render::color(theme, b), share));
}

ImU32 Look::of(const BlockRow& row, Role otherwise) const {
    if (is_offending(row)) return color(Role::violation);
    if (is_near(row)) return color(Role::near);
    return color(otherwise);
}

void apply_style(const Look& look, double scale) {
    ImGuiStyle style;
    style.WindowRounding = 6.0F;
    style.ChildRounding = 0.0F;
    style.FrameRounding = 5.0F;
    style.PopupRounding = 6.0F;
    style.GrabRounding = 4.0F;
    style.ScrollbarRounding = 4.0F;
    style.ScrollbarSize = 9.0F;
    style.WindowBorderSize = 0.0F;
    style.PopupBorderSize = 1.0F;
    style.WindowPadding = ImVec2(12, 12);
    style.FramePadding = ImVec2(9, 6);
    style.ItemSpacing = ImVec2(7, 7);
    style.ItemInnerSpacing = ImVec2(6, 4);
    style.DisabledAlpha = 0.4F;
    set_colors(look, style.Colors);
    style.ScaleAllSizes(static_cast<float>(scale));
    ImGui::GetStyle() = style;
}

} // namespace app::viewer
