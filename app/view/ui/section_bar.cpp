#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

#include "app/view/model/section.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "core/base/units.h"

namespace app::viewer {
namespace {

using render::Role;

/// Puts the next control after the last one, or at the start of a new row if there is no room.
class BarFlow {
public:
    BarFlow(const Frame& frame, const Area& area, double inset)
        : left_(area.x + frame.px(inset)),
          right_(area.x + area.width - frame.px(inset)),
          gap_(frame.px(5)),
          row_(frame.px(34)),
          x_(left_),
          y_(area.y + frame.px(inset)) {}

    /// Reserves room of this width. False: in a new row.
    bool place(float width) {
        const bool fits = x_ == left_ || x_ + width <= right_;
        if (!fits) {
            x_ = left_;
            y_ += row_;
        }
        at_ = {x_, y_};
        x_ += width + gap_;
        return fits;
    }
    ImVec2 at() const { return at_; }
    float room() const { return right_ - x_; }
    float whole() const { return right_ - left_; }
    float bottom() const { return y_ + row_; }

private:
    float left_, right_, gap_, row_, x_, y_;
    ImVec2 at_;
};

/// A button that is lit while it is on.
bool lit_button(Frame& frame, const char* label, const char* words, bool is_on, float width) {
    if (is_on) ImGui::PushStyleColor(ImGuiCol_Button, frame.palette.color(Role::accent, 0.42));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, 0));
    const bool pressed = ImGui::Button(label, ImVec2(width, frame.px(28)));
    ImGui::PopStyleVar();
    if (is_on) ImGui::PopStyleColor();
    tip(frame, words);
    return pressed;
}

/// The sizes of the controls, pixels at a scale of 1.
constexpr double axis_width = 28.0, word_width = 66.0, number_width = 84.0, least_slider = 90.0;

/// Draws the bar, or only measures it, so that it can lie at the lower edge of the view.
class SectionBar {
public:
    SectionBar(Frame& frame, const Area& area, bool draws)
        : frame_(frame), flow_(frame, area, 7.0), draws_(draws) {}

    /// Returns the height of the bar.
    float run(float top) {
        axes();
        picks();
        slider();
        number();
        buttons();
        return flow_.bottom() + frame_.px(2) - top;
    }

private:
    /// Reserves the room; true if the control is to be drawn there.
    bool begin(float width) {
        flow_.place(width);
        if (draws_) ImGui::SetCursorScreenPos(flow_.at());
        return draws_;
    }

    const Section& section() const { return *frame_.model.section; }

    void axes() {
        constexpr const char* names[] = {"X", "Y", "Z"};
        for (const SectionAxis axis : {SectionAxis::x, SectionAxis::y, SectionAxis::z}) {
            if (!begin(frame_.px(axis_width))) continue;
            const char* const name = names[static_cast<size_t>(axis)];
            if (lit_button(frame_, name, fmt::format("Cut across {}", name).c_str(),
                           section().axis == axis, frame_.px(axis_width)))
                set_section_axis(frame_.model, axis);
        }
    }

    void pick(SectionPick wanted, const char* label, const char* words, double width) {
        if (!begin(frame_.px(width))) return;
        const bool is_on = section().pick == wanted
                           || (wanted == SectionPick::face && section().axis == SectionAxis::any
                               && section().pick == SectionPick::none);
        if (lit_button(frame_, label, words, is_on, frame_.px(width)))
            pick_section(frame_.model, wanted);
    }

    void picks() {
        pick(SectionPick::face, "Face", "Any plane: click a face to cut parallel to it", 48.0);
        pick(SectionPick::points, "3 points", "Any plane: click three points on surfaces",
             word_width);
    }

    double unit() const { return frame_.model.settings.inch ? core::mm_per_inch : 1.0; }
    int decimals() const { return frame_.model.settings.inch ? 4 : 2; }

    void slider() {
        // The rest of the row, so that number and buttons still fit, else a row of its own.
        const float others = frame_.px(number_width + 3 * axis_width + 22.0 + 5 * 5.0);
        const float left = flow_.room() - others;
        const float width = left >= frame_.px(least_slider) ? left : flow_.whole();
        if (!begin(width)) return;
        ViewModel& model = frame_.model;
        const SectionRange range = section_range(model);
        auto position = static_cast<float>(section_position(model));
        ImGui::SetNextItemWidth(width);
        ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame_.px(6), frame_.px(6)));
        if (ImGui::SliderFloat("##position", &position, static_cast<float>(range.least),
                               static_cast<float>(range.most), "",
                               ImGuiSliderFlags_NoInput | ImGuiSliderFlags_AlwaysClamp))
            set_section_position(model, position);
        ImGui::PopStyleVar();
        tip(frame_, "Move the section (, and . or Ctrl and the wheel)");
    }

    void number() {
        if (begin(frame_.px(number_width))) {
            ViewModel& model = frame_.model;
            double shown = section_position(model) / unit();
            ImGui::SetNextItemWidth(frame_.px(number_width));
            ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame_.px(6), frame_.px(6)));
            const std::string format = fmt::format("%.{}f", decimals());
            if (ImGui::InputDouble("##typed", &shown, 0.0, 0.0, format.c_str(),
                                   ImGuiInputTextFlags_EnterReturnsTrue))
                set_section_position(model, shown * unit());
            ImGui::PopStyleVar();
            tip(frame_, position_words());
        }
        if (begin(frame_.px(22))) {
            ImGui::SetCursorScreenPos({flow_.at().x, flow_.at().y + frame_.px(6)});
            text(frame_.fonts.text, frame_.palette.color(Role::dim), length_unit(frame_.model));
        }
    }

    std::string position_words() const {
        if (section().axis == SectionAxis::any)
            return "Distance from the picked plane. Type a number and press Return";
        constexpr const char* names[] = {"X", "Y", "Z"};
        return fmt::format("{} from the program zero. Type a number and press Return",
                           names[static_cast<size_t>(section().axis)]);
    }

    void buttons() {
        const float side = frame_.px(axis_width);
        if (begin(side)
            && lit_button(frame_, frame_.fonts.icon(Icon::flip),
                          tip_of(Command::flip_section).c_str(), section().is_flipped(), side))
            frame_.perform(Command::flip_section);
        if (begin(side)
            && lit_button(frame_, frame_.fonts.icon(Icon::tool), "Cut the tool as well",
                          section().cuts_tool, side))
            frame_.model.section->cuts_tool = !section().cuts_tool;
        if (begin(side)
            && lit_button(frame_, frame_.fonts.icon(Icon::close), "End the section (X)", false,
                          side))
            frame_.perform(Command::section);
    }

    Frame& frame_;
    BarFlow flow_;
    bool draws_;
};

constexpr double widest = 720.0;

} // namespace

float draw_section_bar(Frame& frame, const Area& view) {
    if (!frame.model.section || view.width < frame.px(120) || view.height < frame.px(160))
        return 0.0F;
    const float border = frame.px(10);
    Area bar{view.x + border, view.y, view.width - 2 * border, 0.0F};
    bar.width = std::min(bar.width, frame.px(widest));
    bar.height = SectionBar(frame, bar, false).run(bar.y);
    bar.x = view.x + 0.5F * (view.width - bar.width);
    bar.y = view.y + view.height - bar.height - border;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(bar.corner(), bar.far_corner(), frame.palette.color(Role::panel, 0.92),
                       frame.px(6));
    ImGui::PushID("section");
    SectionBar(frame, bar, true).run(bar.y);
    ImGui::PopID();
    return bar.height + border;
}

} // namespace app::viewer
