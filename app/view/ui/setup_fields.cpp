#include "app/view/ui/setup_fields.h"

#include <algorithm>
#include <utility>

#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include "app/check/setup_sheet.h"
#include "app/view/model/typed_number.h"
#include "app/view/model/view_model.h"
#include "core/base/units.h"

namespace app::viewer {
namespace {

using render::Role;

constexpr double label_width = 108.0;

Role role_of(SetupSource source) {
    if (source == SetupSource::stated) return Role::accent;
    return source == SetupSource::assumed ? Role::near : Role::dim;
}

const char* meaning_of(SetupSource source) {
    switch (source) {
    case SetupSource::stated:
        return "Stated in the set-up";
    case SetupSource::assumed:
        return "Assumed: compare it with the machine, then state it";
    case SetupSource::usual:
        return "Not stated: the default applies";
    }
    return "";
}

} // namespace

void draw_mark(const Frame& frame, ImDrawList& list, ImVec2 middle, SetupSource source) {
    const ImU32 color = frame.palette.color(role_of(source));
    if (source == SetupSource::stated)
        list.AddCircleFilled(middle, frame.px(4), color);
    else
        list.AddCircle(middle, frame.px(3.5), color, 0, frame.px(1.6));
}

void source_mark(Frame& frame, SetupSource source) {
    ImGui::SameLine(0, frame.px(7));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = ImGui::GetFrameHeight(), width = frame.px(10);
    ImGui::Dummy(ImVec2(width, height));
    tip(frame, meaning_of(source));
    draw_mark(frame, *ImGui::GetWindowDrawList(), {at.x + 0.5F * width, at.y + 0.5F * height},
              source);
}

std::string label_of(std::string_view key) {
    std::string label(key);
    std::replace(label.begin(), label.end(), '_', ' ');
    label[0] = core::upper(label[0]);
    return label;
}

void field_name(Frame& frame, const std::string& name) {
    const float left = ImGui::GetCursorPosX();
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.text, frame.palette.color(Role::dim),
         shortened(frame.fonts.text, name, frame.px(label_width - 6)));
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + frame.px(label_width));
}

void unit_label(Frame& frame, const char* unit) {
    ImGui::SameLine(0, frame.px(6));
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.small, frame.palette.color(Role::dim), unit);
}

void SetupFields::begin(Frame& frame) {
    Workspace& workspace = frame.model.workspace;
    const uint64_t before = std::exchange(replacements_, workspace.replacements);
    const bool is_replaced = before != replacements_;
    if (is_replaced) typed_.reset();
    if (std::exchange(workspace.commits_typed, false) || is_replaced) ImGui::ClearActiveID();
}

void SetupFields::end(Frame& frame) {
    ViewModel& model = frame.model;
    if (typed_ && ImGui::GetActiveID() != typed_->id) typed_.reset(); // the field is gone
    const bool was_typing = std::exchange(model.workspace.is_typing, typed_.has_value());
    if (!was_typing || typed_ || model.workspace.refusal.empty()) return;
    // What was typed is refused: the user must see that before anything is saved or closed.
    model.wants_saving = model.wants_quit = false;
    model.save_path.clear();
    model.wanted_tab.reset();
}

std::optional<std::string> SetupFields::words(Frame& frame, const char* id,
                                              const std::string& value, const char* hint,
                                              double width, bool is_number) {
    const ImGuiID key = ImGui::GetID(id);
    std::string shown = typed_ && typed_->id == key ? typed_->words : value;
    ImGui::SetNextItemWidth(frame.px(width));
    const auto flags = is_number ? ImGuiInputTextFlags_AutoSelectAll : ImGuiInputTextFlags_None;
    if (ImGui::InputTextWithHint(id, hint, &shown, flags)) typed_ = Typed{key, shown};
    if (!ImGui::IsItemDeactivatedAfterEdit()) return {};
    if (!typed_ || typed_->id != key) return {};
    const auto typed = std::exchange(typed_, std::nullopt);
    if (typed->words == value) return {};
    return typed->words;
}

std::optional<double> SetupFields::refuse(Frame& frame, const std::string& why) {
    frame.model.workspace.refusal = why;
    return {};
}

std::optional<double> SetupFields::number(Frame& frame, const char* id, std::optional<double> value,
                                          double width, const char* hint) {
    constexpr int decimals = 6;
    const auto typed =
        words(frame, id, value ? field_text(*value, decimals) : "", hint, width, true);
    if (!typed) return {};
    const auto number = typed_number(*typed);
    if (!number) return refuse(frame, number.error().message);
    return value && *number == *value ? std::nullopt : std::optional(*number);
}

std::optional<double> SetupFields::length(Frame& frame, const char* id, std::optional<double> mm,
                                          double width, const char* hint) {
    const bool inch = frame.model.settings.inch;
    const double unit = inch ? core::mm_per_inch : 1.0;
    const std::string shown = mm ? field_text(*mm / unit, inch ? 5 : 4) : "";
    const auto typed = words(frame, id, shown, hint, width, true);
    if (!typed) return {};
    const auto length = typed_length(*typed, inch);
    if (!length) return refuse(frame, length.error().message);
    return mm && *length == *mm ? std::nullopt : std::optional(*length);
}

std::optional<double> SetupFields::size(Frame& frame, const char* id, double mm) {
    const auto length = this->length(frame, id, mm);
    if (length && *length <= 0.0) return refuse(frame, "A size must be larger than 0");
    return length;
}

template <typename Field>
std::optional<core::Vec3> SetupFields::three(const char* id, const core::Vec3& values,
                                             const Frame& frame, const Field& field) {
    constexpr double widest = 66.0, gap = 5.0;
    std::optional<core::Vec3> changed;
    ImGui::PushID(id);
    constexpr const char* axes[] = {"##X", "##Y", "##Z"};
    const double room = (ImGui::GetContentRegionAvail().x / frame.fonts.scale - 2.0 * gap) / 3.0;
    const double width = std::clamp(room, 20.0, widest);
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) ImGui::SameLine(0, frame.px(gap));
        const std::optional<double> value = field(axes[axis], values[axis], width);
        if (!value) continue;
        changed = changed.value_or(values);
        (*changed)[axis] = *value;
    }
    ImGui::PopID();
    return changed;
}

std::optional<core::Vec3> SetupFields::point(Frame& frame, const char* id, const core::Vec3& mm) {
    return three(id, mm, frame, [&](const char* axis, double value, double width) {
        return length(frame, axis, value, width);
    });
}

std::optional<core::Vec3> SetupFields::sizes(Frame& frame, const char* id, const core::Vec3& mm) {
    return three(id, mm, frame,
                 [&](const char* axis, double value, double width) -> std::optional<double> {
                     const auto typed = length(frame, axis, value, width);
                     if (typed && *typed <= 0.0)
                         return refuse(frame, "A size must be larger than 0");
                     return typed;
                 });
}

std::optional<core::Vec3> SetupFields::angles(Frame& frame, const char* id,
                                              const core::Vec3& degrees) {
    return three(id, degrees, frame, [&](const char* axis, double value, double width) {
        return number(frame, axis, value, width);
    });
}

} // namespace app::viewer
