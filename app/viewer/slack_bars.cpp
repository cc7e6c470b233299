#include "app/viewer/slack_bars.h"

#include <algorithm>
#include <array>

namespace app::viewer {
namespace {

using render::Role;

/// A slack that a line marks.
struct Mark {
    double seconds;
    const char* name;
    float least_lines; // height of the row, in lines of text, from which on it is named
};
constexpr std::array<Mark, 2> marks = {{{1e-2, "10 ms", 3.3F}, {1.0, "1 s", 1.8F}}};

void draw_mark(Frame& frame, ImDrawList& list, const Area& area, const Mark& mark) {
    const float y = area.y + area.height * static_cast<float>(1.0 - slack_height(mark.seconds));
    list.AddLine({area.x, y}, {area.x + area.width, y}, frame.look.color(Role::line));
    ImFont* const font = frame.fonts.small;
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, mark.name);
    const bool has_room = y - area.y > 0.4F * size.y && mark.least_lines * size.y < area.height;
    if (!has_room) return;
    const ImVec2 at(area.x + frame.px(6), y - 0.5F * size.y);
    list.AddRectFilled({at.x - 3, at.y}, {at.x + size.x + 3, at.y + size.y},
                       frame.look.color(Role::background, 0.75), 3.0F);
    list.AddText(font, font->FontSize, at, frame.look.color(Role::dim), mark.name);
}

void draw_bar(Frame& frame, ImDrawList& list, const Area& area, const TimelineCell& cell, float x,
              float width) {
    if (!cell.known || !cell.moves) return;
    const Look& look = frame.look;
    ImU32 color = look.mixed(Role::panel, Role::accent, 0.5);
    if (cell.near) color = look.color(Role::near);
    // What stops the machine is as high as the row: nobody looks for it.
    double height = slack_height(cell.least);
    if (cell.offending) {
        color = look.color(Role::violation);
        height = 1.0;
    }
    const float bottom = area.y + area.height;
    const float top = bottom - std::max(area.height * static_cast<float>(height), frame.px(2));
    list.AddRectFilled({x, top}, {x + width, bottom}, color);
}

} // namespace

void draw_slack(Frame& frame, const Area& area) {
    const ViewModel& model = frame.model;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(area.corner(), area.far_corner(), frame.look.color(Role::background, 0.75),
                       frame.px(4));
    const auto blocks = static_cast<float>(model.range.width());
    const auto count = static_cast<size_t>(std::max(1.0F, std::min(area.width, blocks)));
    const float width = area.width / static_cast<float>(count);
    const float gap = width > 3.0F ? std::min(0.22F * width, frame.px(1.5)) : 0.0F;
    const auto cells = columns(model.device.study->slack, model.range, count);
    for (size_t i = 0; i < count; ++i)
        draw_bar(frame, list, area, cells[i], area.x + static_cast<float>(i) * width, width - gap);
    for (const Mark& mark : marks) draw_mark(frame, list, area, mark);
}

} // namespace app::viewer
