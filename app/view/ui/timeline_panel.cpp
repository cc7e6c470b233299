#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "app/view/model/device_sheet.h"
#include "app/view/model/device_worker.h"
#include "app/view/model/navigation.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panel.h"
#include "app/view/ui/panels.h"
#include "core/base/math.h"
#include "core/base/text.h"
#include "core/base/units.h"

namespace app::viewer {

/// Draws the row of slacks on the timeline, with the worst block of each pixel. The device must
/// have answered.
void draw_slack(Frame& frame, const Area& area);

namespace {

using render::Role;

/// A slack marked by a line.
struct Mark {
    double seconds;
    const char* name;
    float least_lines; // the name is shown if the row is at least this high, in lines of text
};
constexpr std::array<Mark, 2> marks = {{{1e-2, "10 ms", 3.3F}, {1.0, "1 s", 1.8F}}};

void draw_mark(Frame& frame, ImDrawList& list, const Area& area, const Mark& mark) {
    const float y = area.y + area.height * static_cast<float>(1.0 - slack_height(mark.seconds));
    list.AddLine({area.x, y}, {area.x + area.width, y}, frame.palette.color(Role::line));
    ImFont* const font = frame.fonts.small;
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, mark.name);
    const bool has_room = y - area.y > 0.4F * size.y && mark.least_lines * size.y < area.height;
    if (!has_room) return;
    const ImVec2 at(area.x + frame.px(6), y - 0.5F * size.y);
    list.AddRectFilled({at.x - 3, at.y}, {at.x + size.x + 3, at.y + size.y},
                       frame.palette.color(Role::background, 0.75), 3.0F);
    list.AddText(font, font->FontSize, at, frame.palette.color(Role::dim), mark.name);
}

void draw_bar(Frame& frame, ImDrawList& list, const Area& area, const TimelineCell& cell, float x,
              float width) {
    if (!cell.known || !cell.moves) return;
    const Theme& palette = frame.palette;
    ImU32 color = palette.mixed(Role::panel, Role::accent, 0.5);
    if (cell.near) color = palette.color(Role::near);
    // A block that stops the machine gets a full-height bar, so that it cannot be missed.
    double height = slack_height(cell.least);
    if (cell.offending) {
        color = palette.color(Role::violation);
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
    list.AddRectFilled(area.corner(), area.far_corner(),
                       frame.palette.color(Role::background, 0.75), frame.px(4));
    const auto blocks = static_cast<float>(model.range.width());
    const auto count = static_cast<size_t>(std::max(1.0F, std::min(area.width, blocks)));
    const float width = area.width / static_cast<float>(count);
    const float gap = width > 3.0F ? std::min(0.22F * width, frame.px(1.5)) : 0.0F;
    const auto cells = columns(model.device.study->slack, model.range, count);
    for (size_t i = 0; i < count; ++i)
        draw_bar(frame, list, area, cells[i], area.x + static_cast<float>(i) * width, width - gap);
    for (const Mark& mark : marks) draw_mark(frame, list, area, mark);
}

namespace {

/// The allowance at the dashed line: that of the current block, else that of the set-up, else 2 mm.
///
/// Each pair has its own allowance. A bar shows its margin above this line, so that all bars can be
/// compared with the same line.
double shown_allowance(const ViewModel& model) {
    if (model.row().allowance && *model.row().allowance > 0.0) return *model.row().allowance;
    if (model.program && model.program->scene && model.program->scene->setup.allowance)
        return *model.program->scene->setup.allowance;
    return 2.0;
}

struct Bars {
    Area area;
    double allowance = 2.0; // at the dashed line, mm
    double top = 11.0;      // clearance at the upper edge, mm

    float height_of(double clearance) const {
        clearance = std::max(clearance, 0.0);
        return static_cast<float>(std::min(clearance / top, 1.0)) * area.height;
    }
};

void draw_bar(Frame& frame, ImDrawList& list, const Bars& bars, const TimelineCell& cell, float x,
              float width) {
    const Theme& palette = frame.palette;
    const float bottom = bars.area.y + bars.area.height;
    ImU32 color = palette.mixed(Role::panel, Role::clear, 0.55);
    if (cell.near) color = palette.color(Role::near);
    if (cell.offending) color = palette.color(Role::violation);
    if (!cell.known) {
        if (cell.moves)
            list.AddRectFilled({x, bottom - frame.px(2)}, {x + width, bottom},
                               palette.color(Role::line));
        return;
    }
    if (!cell.moves && !cell.offending) return;
    const float height =
        std::max(bars.height_of(cell.least + bars.allowance), frame.px(cell.offending ? 6 : 2));
    list.AddRectFilled({x, bottom - height}, {x + width, bottom}, color);
}

/// Draws the tick above the bar of a violation.
void draw_tick(Frame& frame, ImDrawList& list, const Bars& bars, float x) {
    const float half = frame.px(5), top = bars.area.y;
    list.AddTriangleFilled({x - half, top}, {x + half, top}, {x, top + frame.px(8)},
                           frame.palette.color(Role::violation));
}

void draw_bars(Frame& frame, ImDrawList& list, const Bars& bars) {
    const ViewModel& model = frame.model;
    const auto blocks = static_cast<float>(model.range.width());
    const auto count = static_cast<size_t>(std::max(1.0F, std::min(bars.area.width, blocks)));
    const float width = bars.area.width / static_cast<float>(count);
    const auto cells = columns(model.least, model.range, count);
    const float gap = width > 3.0F ? std::min(0.22F * width, frame.px(1.5)) : 0.0F;
    const auto left_of = [&](size_t i) { return bars.area.x + static_cast<float>(i) * width; };
    for (size_t i = 0; i < count; ++i)
        draw_bar(frame, list, bars, cells[i], left_of(i), width - gap);
    float last_tick = -1e9F;
    for (size_t i = 0; i < count; ++i) {
        const float middle = left_of(i) + 0.5F * (width - gap);
        if (!cells[i].offending || middle - last_tick < frame.px(3)) continue;
        draw_tick(frame, list, bars, middle);
        last_tick = middle;
    }
}

void draw_allowance(Frame& frame, ImDrawList& list, const Bars& bars, double allowance) {
    const float y = bars.area.y + bars.area.height - bars.height_of(allowance);
    const ImU32 color = frame.palette.color(Role::violation, 0.85);
    for (float x = bars.area.x; x < bars.area.x + bars.area.width; x += frame.px(8))
        list.AddLine({x, y}, {std::min(x + frame.px(4.5), bars.area.x + bars.area.width), y}, color,
                     1.2F);
    const std::string words = "minimum clearance " + length_at_most(frame.model, allowance);
    ImFont* const font = frame.fonts.small;
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, words.c_str());
    const ImVec2 at(bars.area.x + frame.px(6), y - size.y - frame.px(1));
    list.AddRectFilled({at.x - 3, at.y}, {at.x + size.x + 3, at.y + size.y},
                       frame.palette.color(Role::background, 0.75), 3.0F);
    list.AddText(font, font->FontSize, at, color, words.c_str());
}

std::string name_of_tool(const ViewModel& model, const ToolBand& band) {
    if (!band.tool) return "no tool";
    std::string name = fmt::format("T{}", core::value_of(*band.tool));
    if (!model.program || !model.program->scene) return name;
    const auto& tools = model.program->scene->setup.tools;
    const auto found = tools.find(*band.tool);
    if (found == tools.end()) return name;
    const core::ToolDescription& tool = found->second.description;
    const bool inch = model.settings.inch;
    const double diameter = inch ? tool.diameter / core::mm_per_inch : tool.diameter;
    return fmt::format("{} D{} {}", name, core::number_text(diameter, inch ? 4 : 3),
                       tool.name.empty() ? core::name_of(tool.shape) : tool.name);
}

void draw_bands(Frame& frame, ImDrawList& list, const Area& area) {
    const ViewModel& model = frame.model;
    for (const ToolBand& band : model.bands) {
        const auto fraction = [&](size_t block) {
            return static_cast<float>((static_cast<double>(block) - model.range.first)
                                      / model.range.width());
        };
        const float left = area.x + area.width * std::clamp(fraction(band.first), 0.0F, 1.0F);
        const float right = area.x + area.width * std::clamp(fraction(band.last), 0.0F, 1.0F);
        if (right - left < 2.0F) continue;
        list.AddRectFilled({left + 1, area.y}, {right - 1, area.y + area.height},
                           frame.palette.color(Role::raised), frame.px(3));
        ImFont* const font = frame.fonts.small;
        const std::string words =
            shortened(font, name_of_tool(model, band), right - left - frame.px(12));
        if (words.size() <= 3) continue;
        list.AddText(font, font->FontSize, {left + frame.px(7), area.y + frame.px(2)},
                     frame.palette.color(Role::dim), words.c_str());
    }
}

void draw_cursor(Frame& frame, ImDrawList& list, const Bars& bars, float bottom) {
    const ViewModel& model = frame.model;
    const auto at = static_cast<float>(column_of(model.range, model.cursor.block));
    if (at < 0.0F || at > 1.0F) return;
    const auto x = static_cast<float>(core::round(bars.area.x + at * bars.area.width));
    const ImU32 color = frame.palette.color(Role::text);
    list.AddLine({x, bars.area.y - frame.px(5)}, {x, bottom}, color, frame.px(1.6));
    list.AddCircleFilled({x, bars.area.y - frame.px(6)}, frame.px(5), color);
}

void show_hovered(Frame& frame, size_t block) {
    const BlockRow& row = frame.model.rows[block];
    ImGui::BeginTooltip();
    text(frame.fonts.strong, frame.palette.color(Role::text), fmt::format("Block {}", block));
    text(frame.fonts.mono, frame.palette.color(Role::dim), row.text);
    if (row.lower && row.is_known)
        text(frame.fonts.text, frame.palette.of(row, Role::text),
             fmt::format("{} {} {}", clearance_at_least(frame.model, row), length_unit(frame.model),
                         row.part.empty() ? "" : row.part + " \xE2\x80\x93 " + row.body));
    if (const std::string slack = slack_words(frame.model, block); !slack.empty()) {
        const bool stops = stops_machine(answer_of(frame.model.device.study.get(), block));
        text(frame.fonts.text, frame.palette.color(stops ? Role::violation : Role::text), slack);
    }
    ImGui::EndTooltip();
}

/// Handles the mouse: click and drag scrub, the wheel zooms, Shift+wheel or middle drag moves the
/// range.
void take_mouse(Frame& frame, const Area& area, bool& scrubbing) {
    ViewModel& model = frame.model;
    const ImGuiIO& io = ImGui::GetIO();
    const bool is_hovered = ImGui::IsItemHovered();
    const double at = std::clamp((io.MousePos.x - area.x) / area.width, 0.0F, 1.0F);
    const size_t blocks = model.rows.size();
    if (ImGui::IsItemActivated()) scrubbing = true;
    // The last motion and the release of the button can arrive in the same frame.
    if (!ImGui::IsItemActive() && !ImGui::IsItemDeactivated()) scrubbing = false;
    if (scrubbing && ImGui::IsMousePosValid()) {
        const size_t block = block_at(model.range, blocks, at);
        model.playback.running = false;
        if (block != model.cursor.block) go_to(model, block);
    }
    if (!is_hovered) return;
    if (io.MouseWheel != 0.0F) {
        model.range = io.KeyShift ? moved(model.range, blocks, -0.1 * io.MouseWheel)
                                  : zoomed(model.range, blocks, at, core::pow(0.8, io.MouseWheel));
        model.follows_timeline = model.range == whole(blocks);
    }
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Middle))
        model.range = moved(model.range, blocks, -io.MouseDelta.x / area.width);
    if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Right)) model.range = whole(blocks);
    const size_t block = block_at(model.range, blocks, at);
    model.pointed_at = block;
    if (!scrubbing) show_hovered(frame, block);
}

/// Draws the headings of the rows, and the progress of the check.
void draw_title(Frame& frame) {
    const ViewModel& model = frame.model;
    std::string title = fmt::format("MIN CLEARANCE PER BLOCK ({})", length_unit(model));
    if (model.device.study) title += "  \xC2\xB7  BELOW: SLACK OF THE COPROCESSOR";
    text(frame.fonts.small, frame.palette.color(Role::dim), title);
    if (!model.is_recorded && model.has_rows()) {
        ImGui::SameLine(0, frame.px(14));
        text(frame.fonts.small, frame.palette.color(Role::accent),
             fmt::format("checking \xE2\x80\xA6 {:.0f} %", 100.0 * model.fraction));
    }
}

} // namespace

void TimelinePanel::draw(Frame& frame, const Area& area) {
    ViewModel& model = frame.model;
    draw_title(frame);
    if (!model.has_rows()) return;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float side = frame.px(12), bands = frame.px(20), gap = frame.px(5);
    const Area room{area.x + side, area.y + frame.px(30), area.width - 2 * side,
                    area.height - frame.px(30) - bands - frame.px(8)};
    Bars bars;
    bars.area = room;
    if (model.device.study) bars.area.height = 0.6F * room.height;
    const double allowance = shown_allowance(model);
    bars.allowance = allowance;
    if (allowance > 0.0) bars.top = 5.5 * allowance;
    list.AddRectFilled(bars.area.corner(), bars.area.far_corner(),
                       frame.palette.color(Role::background, 0.75), frame.px(4));
    ImGui::SetCursorScreenPos(room.corner());
    ImGui::InvisibleButton("bars", ImVec2(room.width, room.height + bands));
    take_mouse(frame, room, scrubbing_);
    draw_bars(frame, list, bars);
    draw_allowance(frame, list, bars, allowance);
    if (model.device.study)
        draw_slack(frame, {room.x, room.y + bars.area.height + gap, room.width,
                           room.height - bars.area.height - gap});
    const Area band_area{room.x, room.y + room.height + frame.px(4), room.width,
                         bands - frame.px(2)};
    draw_bands(frame, list, band_area);
    draw_cursor(frame, list, bars, band_area.y + band_area.height);
}

} // namespace app::viewer
