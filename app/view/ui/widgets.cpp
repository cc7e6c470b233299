#include "app/view/ui/widgets.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace app::viewer {

using render::Role;

void tip(const Frame& frame, const std::string& words) {
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) || words.empty()) return;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.px(10), frame.px(7)));
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(frame.px(320));
    ImGui::TextUnformatted(words.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
    ImGui::PopStyleVar();
}

bool icon_button(Frame& frame, Icon icon, Command command, bool is_on) {
    const float side = frame.px(32);
    ImGui::PushID(static_cast<int>(command));
    if (is_on) ImGui::PushStyleColor(ImGuiCol_Button, frame.look.color(Role::accent, 0.42));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, 0));
    const bool pressed = ImGui::Button(frame.fonts.icon(icon), ImVec2(side, side));
    ImGui::PopStyleVar();
    if (is_on) ImGui::PopStyleColor();
    tip(frame, tip_of(command));
    ImGui::PopID();
    if (pressed) frame.perform(command);
    return pressed;
}

bool word_button(Frame& frame, Icon icon, const char* word, bool icon_first, const char* words) {
    const std::string sign = frame.fonts.icon(icon);
    const std::string label = icon_first ? sign + "  " + word : std::string(word) + "  " + sign;
    const bool pressed = ImGui::Button(label.c_str(), ImVec2(0, frame.px(32)));
    tip(frame, words);
    return pressed;
}

std::string shortened(ImFont* font, const std::string& words, float width) {
    const auto length = [&](const std::string& part) {
        return font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, part.c_str()).x;
    };
    if (length(words) <= width) return words;
    size_t low = 0, high = words.size();
    while (low < high) {
        const size_t middle = (low + high + 1) / 2;
        if (length(words.substr(0, middle) + "\xE2\x80\xA6") <= width)
            low = middle;
        else
            high = middle - 1;
    }
    // No letter of several bytes is torn apart.
    while (low > 0 && (static_cast<unsigned char>(words[low]) & 0xC0) == 0x80) --low;
    return words.substr(0, low) + "\xE2\x80\xA6";
}

void value_row(Frame& frame, const char* name, const std::string& value, double name_width,
               bool is_changed) {
    const float left = ImGui::GetCursorPosX();
    text(frame.fonts.text, frame.look.color(Role::dim), name);
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + frame.px(name_width));
    const float width = ImGui::GetContentRegionAvail().x;
    const ImU32 color = frame.look.color(is_changed ? Role::accent : Role::text);
    text(frame.fonts.mono, color, shortened(frame.fonts.mono, value, width));
    if (frame.fonts.mono->CalcTextSizeA(frame.fonts.mono->FontSize, 1e9F, 0.0F, value.c_str()).x
        > width)
        tip(frame, value);
}

void heading(Frame& frame, const char* words) {
    ImGui::Dummy(ImVec2(0, frame.px(1)));
    ImGui::Separator();
    ImGui::Dummy(ImVec2(0, frame.px(1)));
    text(frame.fonts.strong, frame.look.color(Role::text), words);
}

void text(ImFont* font, ImU32 color, const std::string& words) {
    ImGui::PushFont(font);
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TextUnformatted(words.c_str(), words.c_str() + words.size());
    ImGui::PopStyleColor();
    ImGui::PopFont();
}

void wrapped_text(ImFont* font, ImU32 color, const std::string& words) {
    ImGui::PushTextWrapPos(0.0F);
    text(font, color, words);
    ImGui::PopTextWrapPos();
}

std::string clock_text(double seconds) {
    const auto whole = static_cast<long long>(std::max(std::floor(seconds), 0.0));
    return fmt::format("{:02}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

} // namespace app::viewer
