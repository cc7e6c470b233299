#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include "app/base/clearance_text.h"
#include "app/base/findings.h"
#include "app/view/model/navigation.h"
#include "app/view/model/row_filter.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "core/base/text.h"

namespace app::viewer {
namespace {

using render::Role;

/// Draws the words of a line in their colours: N numbers and comments dim, G, M and T words
/// accented.
void draw_code(Frame& frame, ImDrawList& list, ImVec2 at, const BlockRow& row, float end) {
    const Theme& palette = frame.palette;
    ImFont* const font = frame.fonts.mono;
    const float letter = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, "0").x;
    const std::string& text = row.text;
    size_t i = 0;
    while (i < text.size() && at.x < end) {
        const auto is_letter = [&](size_t k) {
            return std::isalpha(static_cast<unsigned char>(text[k]));
        };
        size_t stop = i + 1;
        Role role = Role::text;
        if (text[i] == '(' || text[i] == ';') {
            stop = text[i] == ';' ? text.size() : text.find(')', i);
            stop = stop == std::string::npos ? text.size() : std::min(stop + 1, text.size());
            role = Role::dim;
        } else if (is_letter(i) && i + 1 < text.size()
                   && (is_letter(i + 1) || text[i + 1] == '_')) {
            // A name such as TOOL or FMAX: its letters are not addresses.
            const auto is_of_name = [&](size_t k) { return is_letter(k) || text[k] == '_'; };
            while (stop < text.size() && is_of_name(stop)) ++stop;
        } else if (is_letter(i)) {
            while (stop < text.size() && !std::isspace(static_cast<unsigned char>(text[stop]))
                   && !is_letter(stop) && text[stop] != '(')
                ++stop;
            const char c = core::upper(text[i]);
            if (c == 'N' || c == 'O') role = Role::dim;
            if (c == 'G' || c == 'M' || c == 'T') role = Role::accent;
            const std::string_view word(&text[i], stop - i);
            if (word == "G0" || word == "G00" || word == "g0") role = Role::near;
        }
        list.AddText(font, font->FontSize, at, palette.ink(role), &text[i], &text[0] + stop);
        at.x += letter * static_cast<float>(stop - i);
        i = stop;
    }
}

std::string clearance_text(const ViewModel& model, const BlockRow& row) {
    if (row.is_known && !row.is_judged && moves(row)) return unknown_clearance;
    if (!row.is_known || !row.lower) return {};
    return clearance_words(model, row);
}

void draw_background(Frame& frame, ImDrawList& list, const Area& row, const BlockRow& block,
                     bool is_current, bool is_odd) {
    const Theme& palette = frame.palette;
    const ImVec2 a = row.corner(), b = row.far_corner();
    const float round = frame.px(3);
    if (is_current)
        list.AddRectFilled(a, b, palette.color(Role::accent, 0.34), round);
    else if (is_offending(block))
        list.AddRectFilled(a, b, palette.color(Role::violation, 0.17), round);
    else if (is_near(block))
        list.AddRectFilled(a, b, palette.color(Role::near, 0.12), round);
    else if (is_odd)
        list.AddRectFilled(a, b, palette.color(Role::raised, 0.35), round);
}

/// Draws the bar on the left, whose colour and width show the state, the breakpoint and the
/// bookmark.
void draw_gutter(Frame& frame, ImDrawList& list, const Area& row, const BlockRow& block,
                 size_t index) {
    const Theme& palette = frame.palette;
    const float middle = row.y + 0.5F * row.height;
    if (is_offending(block) || is_near(block)) {
        const float width = frame.px(is_offending(block) ? 4 : 2);
        list.AddRectFilled({row.x, row.y + 1}, {row.x + width, row.y + row.height - 1},
                           palette.of(block, Role::clear));
    }
    if (has_breakpoint(frame.model, block)) {
        list.AddCircleFilled({row.x + frame.px(12), middle}, frame.px(5),
                             palette.color(Role::violation));
        list.AddCircle({row.x + frame.px(12), middle}, frame.px(5), palette.color(Role::panel), 0,
                       1.5F);
    }
    if (frame.model.bookmarks.contains(index))
        list.AddText(frame.fonts.small, frame.fonts.small->FontSize,
                     {row.x + frame.px(6), row.y + frame.px(3)}, palette.color(Role::accent),
                     frame.fonts.icon(Icon::bookmark));
}

/// Draws line number, code and clearance.
void draw_words(Frame& frame, ImDrawList& list, const Area& area, const BlockRow& row) {
    ImFont* const font = frame.fonts.mono;
    const float top = area.y + 0.5F * (area.height - font->FontSize);
    const auto put_right = [&](const std::string& words, float right, ImU32 color) {
        const float length = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, words.c_str()).x;
        list.AddText(font, font->FontSize, {right - length, top}, color, words.c_str());
        return right - length;
    };
    const float line_end = area.x + frame.px(62);
    put_right(std::to_string(row.line), line_end, frame.palette.color(Role::dim));
    const float code =
        line_end + frame.px(14) + frame.px(12) * static_cast<float>(std::min(row.depth, 6U));
    const float end = area.x + area.width - frame.px(70);
    list.PushClipRect({code, area.y}, {end, area.y + area.height}, true);
    draw_code(frame, list, {code, top}, row, end);
    list.PopClipRect();
    const float left =
        put_right(clearance_text(frame.model, row), area.x + area.width - frame.px(8),
                  frame.palette.of(row, Role::dim));
    if (!is_offending(row)) return;
    list.AddText(frame.fonts.small, frame.fonts.small->FontSize,
                 {left - frame.px(17), area.y + frame.px(3)}, frame.palette.color(Role::violation),
                 frame.fonts.icon(Icon::warning));
}

} // namespace

void draw_counts(Frame& frame, const Area& area) {
    const ViewModel& model = frame.model;
    const size_t problems = std::max(count_of(model.findings, core::Severity::error),
                                     model.offending.empty() ? size_t(0) : size_t(1));
    const size_t warnings = count_of(model.findings, core::Severity::warning);
    const std::string bad = fmt::format("{} {}", frame.fonts.icon(Icon::warning), problems);
    const std::string doubtful = fmt::format("{} {}", frame.fonts.icon(Icon::near), warnings);
    const std::string blocks = counted(model.rows.size(), "block");
    const float gap = frame.px(12);
    // If there is little room, problems come first.
    const float room = area.width - frame.px(26) - (ImGui::GetItemRectMax().x - area.x);
    float width = ImGui::CalcTextSize(bad.c_str()).x;
    const auto fits = [&](const std::string& words) {
        const float wider = width + gap + ImGui::CalcTextSize(words.c_str()).x;
        if (wider > room) return false;
        width = wider;
        return true;
    };
    const bool warnings_fit = fits(doubtful), blocks_fit = warnings_fit && fits(blocks);
    ImGui::SameLine(area.width - width - frame.px(14));
    text(frame.fonts.text, frame.palette.color(problems == 0 ? Role::dim : Role::violation), bad);
    tip(frame, fmt::format("Errors, as in the report; {} not proven clear or with an error",
                           counted(model.offending.size(), "block")));
    if (!warnings_fit) return;
    ImGui::SameLine(0, gap);
    text(frame.fonts.text, frame.palette.color(warnings == 0 ? Role::dim : Role::near), doubtful);
    tip(frame, "Warnings, as in the report");
    if (!blocks_fit) return;
    ImGui::SameLine(0, gap);
    text(frame.fonts.text, frame.palette.color(Role::dim), blocks);
}

void ProgramPanel::draw_head(Frame& frame, const Area& area) {
    ViewModel& model = frame.model;
    draw_list_tabs(frame);
    draw_counts(frame, area);

    ImGui::SetNextItemWidth(area.width - frame.px(24));
    if (model.filter_wants_focus) ImGui::SetKeyboardFocusHere();
    const std::string hint = std::string(frame.fonts.icon(Icon::search))
                             + "  Filter: text, T3, clearance < 1 \xE2\x80\xA6";
    if (ImGui::InputTextWithHint("##filter", hint.c_str(), &model.filter_text)) apply_filter(model);
    if (ImGui::IsItemActive()) model.filter_wants_focus = false;
    draw_filter_note(frame);
}

/// Shows the error of the filter, or that it is used as a text search.
void ProgramPanel::draw_filter_note(Frame& frame) {
    const RowFilter& filter = frame.model.filter;
    if (!filter.refusal().empty())
        wrapped_text(frame.fonts.small, frame.palette.color(Role::violation), filter.refusal());
    if (!filter.wanted_text().empty())
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     fmt::format("Blocks that contain \"{}\": {}", filter.wanted_text(),
                                 frame.model.filtered.size()));
}

void ProgramPanel::draw_row(Frame& frame, size_t block, float width) {
    ViewModel& model = frame.model;
    const BlockRow& row = model.rows[block];
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const Area area{at.x, at.y, width, frame.px(20)};
    ImGui::PushID(static_cast<int>(block));
    const bool pressed = ImGui::InvisibleButton("row", area.size());
    const bool is_hovered = ImGui::IsItemHovered();
    ImGui::PopID();
    if (is_hovered) model.pointed_at = block;
    if (pressed) {
        const bool in_gutter = ImGui::GetIO().MouseClickedPos[0].x < area.x + frame.px(22);
        in_gutter ? toggle_breakpoint(model, block) : go_to(model, block);
        model.list_follows = false;
    }
    draw_background(frame, list, area, row, block == model.cursor.block, block % 2 == 1);
    if (is_hovered)
        list.AddRectFilled(area.corner(), area.far_corner(), frame.palette.color(Role::text, 0.05));
    draw_gutter(frame, list, area, row, block);
    draw_words(frame, list, area, row);
}

void ProgramPanel::follow_cursor(Frame& frame) {
    ViewModel& model = frame.model;
    if (room_ <= 0.0F || !std::exchange(model.list_follows, false)) return;
    const std::vector<size_t>& shown = model.filtered;
    const size_t block = model.cursor.block;
    const auto rank = model.filter.empty()
                          ? static_cast<ptrdiff_t>(block)
                          : std::lower_bound(shown.begin(), shown.end(), block) - shown.begin();
    const float height = frame.px(20), top = static_cast<float>(rank) * height;
    // Scrolling set from inside the child window would take effect one frame late.
    if (top < scroll_ + 3 * height || top > scroll_ + room_ - 4 * height)
        ImGui::SetNextWindowScroll({-1.0F, std::max(0.0F, top - 0.5F * room_ + height)});
}

void ProgramPanel::draw_rows(Frame& frame) {
    ViewModel& model = frame.model;
    const float width = ImGui::GetContentRegionAvail().x;
    const float height = frame.px(20);
    const bool filtering = !model.filter.empty();
    const size_t count = filtering ? model.filtered.size() : model.rows.size();
    scroll_ = ImGui::GetScrollY();
    room_ = ImGui::GetWindowHeight();
    if (count == 0) {
        wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                     filtering ? "No block matches the filter." : "Reading \xE2\x80\xA6");
        return;
    }
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, 0));
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(count), height);
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const auto rank = static_cast<size_t>(i);
            draw_row(frame, filtering ? model.filtered[rank] : rank, width);
        }
    ImGui::PopStyleVar();
}

void ProgramPanel::draw(Frame& frame, const Area& area) {
    draw_head(frame, area);
    follow_cursor(frame);
    ImGui::BeginChild("rows", ImVec2(area.width - frame.px(18), 0), false, ImGuiWindowFlags_NoNav);
    draw_rows(frame);
    ImGui::EndChild();
}

} // namespace app::viewer
