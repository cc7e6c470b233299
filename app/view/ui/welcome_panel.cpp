#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>

#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"

namespace app::viewer {
namespace {

using render::Role;

void draw_intro(Frame& frame) {
    text(frame.fonts.big, frame.palette.color(Role::text), "feeler");
    wrapped_text(
        frame.fonts.text, frame.palette.color(Role::dim),
        "Drop NC programs here, with a set-up (.toml) if you have one. Otherwise stock and "
        "tools are inferred, and all assumptions are listed.");
    ImGui::Dummy(ImVec2(0, frame.px(4)));
    if (word_button(frame, Icon::open, "Open a program (Ctrl+O)", true,
                    "Choose a program or a set-up"))
        frame.perform(Command::open);
    ImGui::SameLine();
    if (word_button(frame, Icon::question, "Keys (F1)", true, "All keys"))
        frame.perform(Command::shortcuts);
    ImGui::Dummy(ImVec2(0, frame.px(6)));
}

void draw_recent_list(Frame& frame, float width) {
    ImGui::BeginGroup();
    text(frame.fonts.strong, frame.palette.color(Role::text), "Recent");
    ImGui::Dummy(ImVec2(0, frame.px(2)));
    const std::vector<RecentProgram>& recent = frame.model.recent;
    if (recent.empty())
        text(frame.fonts.text, frame.palette.color(Role::dim), "No program has been opened yet.");
    for (const RecentProgram& each : recent) draw_recent(frame, each, width);
    ImGui::EndGroup();
}

void draw_sample(Frame& frame, const Sample& sample, float width) {
    ImGui::PushID(sample.program.c_str());
    const float left = ImGui::GetCursorPosX();
    if (ImGui::Selectable("##sample", false, 0, ImVec2(width, 0)))
        frame.model.wanted_paths = {sample.program, sample.setup};
    tip(frame, sample.program + "\n" + sample.setup);
    ImGui::SameLine(0, 0);
    ImGui::SetCursorPosX(left);
    text(frame.fonts.text, frame.palette.color(Role::text), sample.title);
    ImGui::SameLine();
    const float used = ImGui::GetCursorPosX() - left;
    text(frame.fonts.small, frame.palette.color(Role::dim),
         shortened(frame.fonts.small, sample.about, width - used));
    ImGui::PopID();
}

void draw_samples(Frame& frame, const std::vector<Sample>& samples, float width) {
    if (samples.empty()) return;
    ImGui::BeginGroup();
    text(frame.fonts.strong, frame.palette.color(Role::text), "Samples");
    ImGui::Dummy(ImVec2(0, frame.px(2)));
    for (const Sample& sample : samples) draw_sample(frame, sample, width);
    ImGui::EndGroup();
}

} // namespace

void WelcomePanel::draw(Frame& frame, const Area& area) {
    const Theme& palette = frame.palette;
    if (!samples_) samples_ = samples_in(frame.model.samples);
    ImGui::GetWindowDrawList()->AddRectFilledMultiColor(
        area.corner(), area.far_corner(), palette.color(Role::view_top),
        palette.color(Role::view_top), palette.color(Role::view_bottom),
        palette.color(Role::view_bottom));
    const float width = std::min(frame.px(860), area.width - frame.px(32));
    const size_t rows = std::max<size_t>({6, samples_->size(), frame.model.recent.size()});
    const float wanted = frame.px(200.0 + 23.0 * static_cast<double>(rows));
    const float height = std::min(wanted, area.height - frame.px(24));
    ImGui::SetCursorScreenPos(
        {area.x + 0.5F * (area.width - width), area.y + 0.4F * (area.height - height)});
    ImGui::PushStyleColor(ImGuiCol_ChildBg, palette.color(Role::panel, 0.9));
    ImGui::PushStyleVar(ImGuiStyleVar_ChildRounding, frame.px(12));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.px(26), frame.px(18)));
    ImGui::BeginChild("start", ImVec2(width, height), true);
    draw_intro(frame);
    const float gap = frame.px(28), room = ImGui::GetContentRegionAvail().x;
    const bool is_wide = room > frame.px(560);
    const float recent = is_wide ? 0.42F * room - gap : room;
    const float left = ImGui::GetCursorPosX();
    draw_recent_list(frame, recent);
    if (is_wide)
        ImGui::SameLine(left + recent + gap);
    else
        ImGui::Dummy(ImVec2(0, frame.px(8)));
    draw_samples(frame, *samples_, is_wide ? room - recent - gap : room);
    ImGui::EndChild();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
    draw_message(frame, area);
}

} // namespace app::viewer
