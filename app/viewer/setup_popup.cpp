#include "app/viewer/setup_popup.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/setup/holder_library.h"
#include "app/viewer/widgets.h"

namespace app::viewer {
namespace {

using render::Role;

SetupSource source_of(const SheetTool& tool, const std::string& key) {
    return tool.stated.contains(key) ? SetupSource::stated : tool.source;
}

void draw_shape(core::ToolDescription& tool) {
    if (!ImGui::BeginCombo("##shape", core::name_of(tool.shape))) return;
    for (const core::ToolShape shape : stateable_shapes())
        if (ImGui::Selectable(core::name_of(shape), shape == tool.shape) && shape != tool.shape)
            tool = reshaped(tool, shape);
    ImGui::EndCombo();
}

/// What holds the tool: nothing, one of those that come with the program, or what was described.
void draw_holder(Frame& frame, const core::ToolDescription& shown, core::ToolDescription& tool) {
    std::string now = holder_name(tool);
    if (now.empty()) now = tool.holder.empty() ? "none: only the tool is checked" : "as described";
    ImGui::SetNextItemWidth(frame.px(260));
    if (!ImGui::BeginCombo("##holder", now.c_str())) return;
    if (ImGui::Selectable("none: only the tool is checked", tool.holder.empty()))
        tool.holder.clear();
    if (!shown.holder.empty() && holder_name(shown).empty() && ImGui::Selectable("as described"))
        tool.holder = shown.holder;
    for (const auto& [name, cones] : shipped_holder_library())
        if (ImGui::Selectable(name.c_str(), name == now)) {
            tool.holder = cones;
            tool.gauge_length.reset();
        }
    ImGui::EndCombo();
}

/// A size of the tool; angles are in degrees whatever the window's unit.
void draw_size(Frame& frame, const ToolField& field, core::ToolDescription& tool) {
    double value = field.of(tool).value_or(0.0);
    const bool is_angle = std::string_view(field.unit) == "deg";
    bool changed = false;
    if (is_angle) {
        ImGui::SetNextItemWidth(frame.px(92));
        changed = ImGui::InputDouble("##size", &value, 0.0, 0.0, "%.3f");
    } else {
        changed = length_field(frame, "##size", value);
    }
    if (changed) field.put(tool, value == 0.0 ? std::nullopt : std::optional(value));
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.small, frame.look.color(Role::dim),
         is_angle ? "\xC2\xB0" : length_unit(frame.model));
}

std::string label_of(const Frame& frame, const core::ToolDescription& tool) {
    return fmt::format("T{}  {} {}", core::value_of(tool.number), core::name_of(tool.shape),
                       length_text(frame.model, tool.diameter));
}

} // namespace

void SetupPopup::begin(const std::shared_ptr<const SetupSheet>& sheet) {
    shown_ = sheet;
    wanted_ = *sheet;
    refused_.clear();
    refusal_.clear();
    is_saving_ = asks_to_replace_ = false;
    tool_ = std::min(tool_, sheet->tools.empty() ? 0 : sheet->tools.size() - 1);
}

std::optional<SetupEdits> SetupPopup::checked_edits(const ViewModel& model) {
    SetupEdits edits = edits_between(*shown_, wanted_, model.edits);
    refused_ = refusals_of(edits);
    if (refused_.empty()) return edits;
    for (size_t i = 0; i < wanted_.tools.size(); ++i)
        if (refused_.front().tool == wanted_.tools[i].tool.number) tool_ = i;
    return {};
}

void SetupPopup::draw_tool(Frame& frame, size_t index) {
    const SheetTool& shown = shown_->tools[index];
    core::ToolDescription& tool = wanted_.tools[index].tool;
    const core::ToolNumber number = tool.number;
    ImGui::PushID(core::value_of(number));
    if (tool.shape == core::ToolShape::profile) {
        wrapped_text(frame.fonts.text, frame.look.color(Role::dim),
                     "Its outline is edited in the set-up file.");
        ImGui::PopID();
        return;
    }
    field_name(frame, "Kind", 130.0);
    ImGui::SetNextItemWidth(frame.px(130));
    draw_shape(tool);
    source_mark(frame, source_of(shown, "shape"));
    const bool has_cones = !tool.shank.empty();
    for (const ToolField& field : fields_of(tool.shape)) {
        const std::string key = field.key;
        if (has_cones && (key == "stick_out" || key == "shank_diameter")) continue;
        ImGui::PushID(field.key);
        field_name(frame, field.name, 130.0);
        draw_size(frame, field, tool);
        source_mark(frame, source_of(shown, key));
        field_refusal(frame, refused_, number, key);
        ImGui::PopID();
    }
    if (has_cones)
        wrapped_text(frame.fonts.small, frame.look.color(Role::dim),
                     "Its shank is described by cones, which give the stick-out.");
    field_name(frame, "Holder", 130.0);
    draw_holder(frame, shown.tool, tool);
    source_mark(frame, source_of(shown, "holder"));
    for (const char* key : {"holder", "gauge_length", "neck_length", "teeth", "thread_deg", ""})
        field_refusal(frame, refused_, number, key);
    if (!shown.why.empty())
        wrapped_text(frame.fonts.small, frame.look.color(Role::dim), "Inferred: " + shown.why);
    ImGui::PopID();
}

void SetupPopup::draw_tools(Frame& frame) {
    text(frame.fonts.strong, frame.look.color(Role::text), "Tools");
    if (wanted_.tools.empty()) {
        text(frame.fonts.text, frame.look.color(Role::dim), "The program uses none.");
        return;
    }
    const float height = std::min(frame.px(270), 0.3F * ImGui::GetIO().DisplaySize.y);
    ImGui::BeginChild("list", ImVec2(frame.px(170), height), true, ImGuiWindowFlags_NavFlattened);
    for (size_t i = 0; i < wanted_.tools.size(); ++i) {
        const bool is_wrong = std::any_of(refused_.begin(), refused_.end(), [&](const auto& one) {
            return one.tool == wanted_.tools[i].tool.number;
        });
        ImGui::PushID(static_cast<int>(i));
        std::string label = label_of(frame, wanted_.tools[i].tool);
        if (is_wrong) label = std::string(frame.fonts.icon(Icon::warning)) + " " + label;
        if (ImGui::Selectable(label.c_str(), i == tool_)) tool_ = i;
        ImGui::PopID();
    }
    ImGui::EndChild();
    ImGui::SameLine(0, frame.px(16));
    ImGui::BeginGroup(); // in the same window, so that Tab goes through its fields
    draw_tool(frame, tool_);
    ImGui::EndGroup();
}

void SetupPopup::draw_saving(Frame& frame) {
    ViewModel& model = frame.model;
    if (model.saved && model.saved->refusal) {
        asks_to_replace_ = model.saved->exists;
        refusal_ = model.saved->refusal->message;
        model.saved.reset();
    }
    field_name(frame, "Save as");
    ImGui::SetNextItemWidth(frame.px(420));
    bool save = ImGui::InputText("##path", &path_, ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemEdited()) asks_to_replace_ = false;
    ImGui::SameLine();
    save = ImGui::Button(asks_to_replace_ ? "Replace it" : "Save") || save;
    if (!refusal_.empty())
        wrapped_text(frame.fonts.small, frame.look.color(Role::violation),
                     asks_to_replace_ ? "This file is there already. Replace it, or type another "
                                        "name."
                                      : refusal_);
    if (!save) return;
    refusal_.clear();
    if (auto edits = checked_edits(model))
        model.wanted_setup = SetupRequest{*std::move(edits), path_, asks_to_replace_};
}

void SetupPopup::draw_buttons(Frame& frame) {
    ViewModel& model = frame.model;
    const bool enter =
        ImGui::GetIO().KeyCtrl && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false);
    if (ImGui::Button("Check with it") || enter) {
        if (auto edits = checked_edits(model)) {
            model.wanted_setup = SetupRequest{*std::move(edits)};
            model.popup = Popup::none;
        }
    }
    tip(frame, "Ctrl+Enter");
    ImGui::SameLine();
    if (ImGui::Button("Save as set-up \xE2\x80\xA6")) is_saving_ = !is_saving_;
    ImGui::SameLine();
    ImGui::BeginDisabled(model.edits.empty());
    if (ImGui::Button("Take all changes back")) {
        model.wanted_setup = SetupRequest{};
        model.popup = Popup::none;
    }
    ImGui::EndDisabled();
    if (!refused_.empty()) {
        ImGui::SameLine();
        text(frame.fonts.text, frame.look.color(Role::violation),
             "Nothing has changed: see the fields in question.");
    }
    if (is_saving_) draw_saving(frame);
}

void SetupPopup::draw(Frame& frame) {
    const ViewModel& model = frame.model;
    if (!model.program || !model.program->sheet) {
        text(frame.fonts.text, frame.look.color(Role::dim),
             "The set-up is being read \xE2\x80\xA6");
        return;
    }
    const auto& sheet = model.program->sheet;
    if (ImGui::IsWindowAppearing() || shown_ != sheet) {
        begin(sheet);
        path_ = model.program->proposed_path;
    }
    if (std::exchange(frame.model.wants_saving, false)) is_saving_ = true;
    text(frame.fonts.text, frame.look.color(Role::dim),
         sheet->path.empty() ? "No set-up was given: all of this was inferred from the program. "
                               "State what you know better."
                             : "From " + sheet->path);
    ImGui::Dummy(ImVec2(0, frame.px(4)));
    draw_stock_fields(frame, *shown_, wanted_, refused_);
    ImGui::Dummy(ImVec2(0, frame.px(4)));
    draw_tools(frame);
    draw_allowance_field(frame, *shown_, wanted_, refused_);
    ImGui::Dummy(ImVec2(0, frame.px(6)));
    draw_buttons(frame);
}

} // namespace app::viewer
