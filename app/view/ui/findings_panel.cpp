#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/view/model/navigation.h"
#include "app/view/model/unit_words.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "core/base/rule.h"

namespace app::viewer {
namespace {

using render::Role;

Role role_of(core::Severity severity) {
    if (severity == core::Severity::error) return Role::violation;
    return severity == core::Severity::warning ? Role::near : Role::dim;
}

Icon icon_of(core::Severity severity) {
    if (severity == core::Severity::error) return Icon::warning;
    return severity == core::Severity::warning ? Icon::near : Icon::note;
}

std::string blocks_text(size_t count) {
    return count == 1 ? "1 block" : fmt::format("{} blocks", count);
}

/// "lines 188 ... 194", and the file of a subprogram.
std::string location_text(const ViewModel& model, const FindingStretch& stretch) {
    const BlockRow& first = model.rows[stretch.first];
    const BlockRow& last = model.rows[stretch.last];
    std::string text = first.line == last.line
                           ? fmt::format("line {}", first.line)
                           : fmt::format("lines {} \xE2\x80\xA6 {}", first.line, last.line);
    if (!first.file.empty()) text += " of " + first.file;
    return text;
}

/// The depth of the overlap or the clearance in the worst block; without both, the shortfall.
std::string worst_text(const ViewModel& model, const FindingStretch& stretch) {
    if (stretch.overlap) return depth_words(model, *stretch.overlap) + " deep";
    if (stretch.clearance) return length_at_least(model, *stretch.clearance);
    if (stretch.shortfall > 0.0) return "short " + length_at_most(model, stretch.shortfall);
    return {};
}

void draw_group_head(Frame& frame, const FindingGroup& group) {
    const float width = ImGui::GetContentRegionAvail().x;
    const float left = ImGui::GetCursorPosX();
    text(frame.fonts.text, frame.palette.color(role_of(group.severity)),
         frame.fonts.icon(icon_of(group.severity)));
    ImGui::SameLine(0, frame.px(7));
    text(frame.fonts.strong, frame.palette.color(Role::text), core::title_of_rule(group.rule));
    tip(frame, group.rule);
    const std::string count = group.stretches.empty() ? "program" : blocks_text(group.count);
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + width - ImGui::CalcTextSize(count.c_str()).x - frame.px(8));
    text(frame.fonts.text, frame.palette.color(Role::dim), count);
    if (!group.pair[0].empty())
        text(frame.fonts.small, frame.palette.color(Role::dim),
             "     " + group.pair[0] + " \xE2\x80\x93 " + group.pair[1]);
}

void draw_words(Frame& frame, const std::string& message, const std::string& cure) {
    wrapped_text(frame.fonts.text, frame.palette.color(Role::text),
                 words_in_unit(frame.model, message));
    if (cure.empty()) return;
    text(frame.fonts.text, frame.palette.color(Role::accent), frame.fonts.icon(Icon::bulb));
    ImGui::SameLine(0, frame.px(7));
    wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                 words_in_unit(frame.model, cure));
}

} // namespace

void draw_list_tabs(Frame& frame) {
    ViewModel& model = frame.model;
    const auto tab = [&](const char* name, bool is_on, Command command) {
        text(frame.fonts.strong, frame.palette.color(is_on ? Role::text : Role::dim), name);
        const bool is_clicked = ImGui::IsItemClicked() && !is_on;
        if (!is_on) tip(frame, tip_of(command));
        if (!is_on) return is_clicked;
        const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
        ImGui::GetWindowDrawList()->AddRectFilled({low.x, high.y + frame.px(2)},
                                                  {high.x, high.y + frame.px(4)},
                                                  frame.palette.color(Role::accent));
        return false;
    };
    const bool is_list = !model.shows_setup;
    const bool program = tab("Program", is_list && !model.shows_findings, Command::show_findings);
    ImGui::SameLine(0, frame.px(16));
    const bool findings = tab("Findings", is_list && model.shows_findings, Command::show_findings);
    ImGui::SameLine(0, frame.px(16));
    if (tab("Set-up", model.shows_setup, Command::edit_setup)) show_setup(model, true);
    if (program || findings) show_findings(model, findings);
}

void FindingsPanel::draw_note(Frame& frame, const StretchIndex& which) {
    ViewModel& model = frame.model;
    if (noted_ != which || typed_from_ != model.opening) {
        noted_ = which;
        typed_from_ = model.opening;
        typed_ = note_at(model, which);
    }
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - frame.px(10));
    if (model.note_wants_focus) ImGui::SetKeyboardFocusHere();
    ImGui::InputTextWithHint("##note", "Comment on this finding (R)", &typed_);
    if (ImGui::IsItemActive()) model.note_wants_focus = false;
    if (ImGui::IsItemDeactivatedAfterEdit()) write_note_at(model, which, typed_);
}

void FindingsPanel::draw_stretch(Frame& frame, const StretchIndex& which, bool is_selected) {
    ViewModel& model = frame.model;
    const FindingGroup& group = model.groups[which.group];
    const FindingStretch& stretch = group.stretches[which.stretch];
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const Area row{at.x, at.y, ImGui::GetContentRegionAvail().x, frame.px(22)};
    ImDrawList& list = *ImGui::GetWindowDrawList();
    if (ImGui::InvisibleButton("row", row.size())) go_to_stretch(model, which);
    if (!ImGui::IsItemVisible()) return;
    if (ImGui::IsItemHovered()) model.pointed_at = stretch.worst;
    if (is_selected || ImGui::IsItemHovered())
        list.AddRectFilled(row.corner(), row.far_corner(),
                           frame.palette.color(Role::accent, is_selected ? 0.34 : 0.12),
                           frame.px(3));
    ImFont* const font = frame.fonts.mono;
    const float top = row.y + 0.5F * (row.height - font->FontSize);
    std::string words = location_text(model, stretch);
    if (stretch.count > 1) words += " \xC2\xB7 " + blocks_text(stretch.count);
    if (!note_at(model, which).empty())
        words += std::string("  ") + frame.fonts.icon(Icon::bookmark);
    const std::string number = worst_text(model, stretch);
    const float length = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, number.c_str()).x;
    ImFont* const plain = frame.fonts.text;
    list.AddText(plain, plain->FontSize,
                 {row.x + frame.px(22), row.y + 0.5F * (row.height - plain->FontSize)},
                 frame.palette.color(Role::text),
                 shortened(plain, words, row.width - length - frame.px(44)).c_str());
    list.AddText(
        font, font->FontSize, {row.x + row.width - length - frame.px(8), top},
        frame.palette.color(group.severity == core::Severity::error ? Role::violation : Role::dim),
        number.c_str());
}

void FindingsPanel::draw_group(Frame& frame, size_t index,
                               const std::optional<StretchIndex>& selected) {
    const FindingGroup& group = frame.model.groups[index];
    ImGui::PushID(static_cast<int>(index));
    draw_group_head(frame, group);
    if (group.stretches.empty()) draw_words(frame, group.message, group.cure);
    for (size_t i = 0; i < group.stretches.size(); ++i) {
        const StretchIndex which{index, i};
        const bool is_selected = selected == which;
        ImGui::PushID(static_cast<int>(i));
        draw_stretch(frame, which, is_selected);
        if (is_selected) {
            if (scrolled_to_ != selected) ImGui::SetScrollHereY(0.4F);
            ImGui::Indent(frame.px(22));
            draw_words(frame, group.stretches[i].message, group.stretches[i].cure);
            draw_note(frame, which);
            ImGui::Unindent(frame.px(22));
        } else if (const std::string note = note_at(frame.model, which); !note.empty()) {
            ImGui::Indent(frame.px(22));
            wrapped_text(frame.fonts.small, frame.palette.color(Role::accent), note);
            ImGui::Unindent(frame.px(22));
        }
        ImGui::PopID();
    }
    ImGui::Dummy(ImVec2(0, frame.px(8)));
    ImGui::PopID();
}

void FindingsPanel::draw(Frame& frame, const Area& area) {
    ViewModel& model = frame.model;
    draw_list_tabs(frame);
    ImGui::Dummy(ImVec2(0, frame.px(6)));
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                 "Ctrl+Down, Ctrl+Up: next, previous \xC2\xB7 R: comment \xC2\xB7 V: lines");
    ImGui::BeginChild("groups", ImVec2(area.width - frame.px(18), 0), false,
                      ImGuiWindowFlags_NoNav);
    if (model.groups.empty())
        wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                     model.is_recorded ? "No findings." : "No findings so far.");
    const std::optional<StretchIndex> selected = selected_stretch(model);
    for (size_t i = 0; i < model.groups.size(); ++i) draw_group(frame, i, selected);
    scrolled_to_ = selected;
    ImGui::EndChild();
}

} // namespace app::viewer
