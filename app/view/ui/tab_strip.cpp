#include <algorithm>
#include <string>

#include <imgui.h>

#include "app/view/model/folder_listing.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"

namespace app::viewer {
namespace {

using render::Role;

/// A tab: the state of the check, the name, and a cross that closes it.
class TabDrawing {
public:
    TabDrawing(Frame& frame, const Area& area, size_t index)
        : frame_(frame), area_(area), index_(index), title_(frame.model.tabs[index]) {}

    void draw() {
        ImGui::PushID(static_cast<int>(index_));
        take_mouse();
        draw_back();
        draw_words();
        ImGui::PopID();
    }

private:
    bool is_shown() const { return frame_.model.shown_tab == index_; }
    bool has_cross() const { return (is_hovered_ || is_shown()) && area_.width > frame_.px(70); }
    float cross_left() const { return area_.x + area_.width - frame_.px(24); }

    void take_mouse() {
        ImGui::SetCursorScreenPos(area_.corner());
        ImGui::InvisibleButton("tab", area_.size(),
                               ImGuiButtonFlags_MouseButtonLeft
                                   | ImGuiButtonFlags_MouseButtonMiddle);
        is_hovered_ = ImGui::IsItemHovered();
        is_on_cross_ = has_cross() && is_hovered_ && ImGui::GetIO().MousePos.x >= cross_left();
        if (ImGui::IsItemClicked(ImGuiMouseButton_Middle)
            || (is_on_cross_ && ImGui::IsItemClicked(ImGuiMouseButton_Left)))
            frame_.model.unwanted_tab = index_;
        else if (ImGui::IsItemClicked(ImGuiMouseButton_Left))
            frame_.model.wanted_tab = index_;
        tip(frame_, is_on_cross_ ? "Close the program (Ctrl+W)" : readable_name(title_.path));
    }

    void draw_back() {
        ImDrawList& list = *ImGui::GetWindowDrawList();
        const ImVec2 corner(area_.x + frame_.px(1), area_.y + frame_.px(3));
        const ImVec2 far(area_.x + area_.width - frame_.px(1), area_.y + area_.height);
        if (is_shown() || is_hovered_)
            list.AddRectFilled(corner, far,
                               frame_.palette.color(is_shown() ? Role::panel : Role::raised),
                               frame_.px(6), ImDrawFlags_RoundCornersTop);
        if (is_shown())
            list.AddRectFilled({corner.x + frame_.px(6), corner.y},
                               {far.x - frame_.px(6), corner.y + frame_.px(2)},
                               frame_.palette.color(Role::accent));
    }

    void draw_words() {
        ImDrawList& list = *ImGui::GetWindowDrawList();
        ImFont* const font = frame_.fonts.text;
        const float middle = area_.y + 0.5F * area_.height + frame_.px(1);
        const float left = area_.x + frame_.px(24);
        const ImVec2 dot(area_.x + frame_.px(14), middle);
        draw_state(list, dot);
        const float end = has_cross() ? cross_left() : area_.x + area_.width - frame_.px(8);
        const std::string name = (title_.is_modified ? "* " : "") + title_.name;
        list.AddText(font, font->FontSize, {left, middle - 0.5F * font->FontSize},
                     frame_.palette.color(is_shown() ? Role::text : Role::dim),
                     shortened(font, name, std::max(end - left, 1.0F)).c_str());
        if (!has_cross()) return;
        list.AddText(font, font->FontSize,
                     {cross_left() + frame_.px(3), middle - 0.5F * font->FontSize},
                     frame_.palette.color(is_on_cross_ ? Role::text : Role::dim),
                     frame_.fonts.icon(Icon::close));
    }

    /// A problem is a square and not a dot, so that it can be told without colours.
    void draw_state(ImDrawList& list, ImVec2 at) {
        using render::ClearanceState;
        const float size = frame_.px(4);
        if (title_.state == ClearanceState::violation)
            list.AddRectFilled({at.x - size, at.y - size}, {at.x + size, at.y + size},
                               frame_.palette.color(Role::violation));
        else if (title_.state == ClearanceState::clear)
            list.AddCircleFilled(at, size, frame_.palette.color(Role::clear));
        else
            list.AddCircle(at, size, frame_.palette.color(Role::dim));
    }

    Frame& frame_;
    Area area_;
    size_t index_;
    const TabTitle& title_;
    bool is_hovered_ = false, is_on_cross_ = false;
};

} // namespace

float TabStrip::height_of(const Frame& frame) {
    return frame.model.tabs.size() > 1 ? frame.px(30) : 0.0F;
}

void TabStrip::draw(Frame& frame, const Area& area) {
    ImGui::GetWindowDrawList()->AddRectFilled(area.corner(), area.far_corner(),
                                              frame.palette.color(Role::background));
    const size_t count = frame.model.tabs.size();
    const float width = std::min(frame.px(210), area.width / static_cast<float>(count));
    for (size_t i = 0; i < count; ++i)
        TabDrawing(frame, {area.x + static_cast<float>(i) * width, area.y, width, area.height}, i)
            .draw();
}

} // namespace app::viewer
