#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <imgui.h>

#include "app/check/setup_sheet.h"
#include "app/setup/holders/holder_preset.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_text.h"
#include "app/view/model/unit_words.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/setup_forms.h"

namespace app::viewer {
namespace {

using render::Role;

/// A size of a tool: as the text states it, or else as it was checked last.
std::optional<double> size_now(const ViewModel& model, const SheetTool& shown,
                               const core::ToolSize& size) {
    const auto of_tool = [&] { return size.of(shown.tool); };
    if (is_current(model)) return of_tool();
    const auto stated = stated_tool_size(model.workspace.document.text(), shown.tool.number, size);
    return stated ? stated : of_tool();
}

/// The holders of a kind with a taper, as a menu. Calls `choose` with the name of one.
void draw_holder_kind(const HolderTaper& taper, HolderKind kind, const std::string& now,
                      const std::function<void(std::string_view)>& choose) {
    const auto is_of_kind = [&](const HolderPreset& holder) {
        return holder.taper == &taper && holder.attachment->kind == kind;
    };
    const auto all = holder_presets();
    if (std::none_of(all.begin(), all.end(), is_of_kind)) return;
    if (!ImGui::BeginMenu(std::string(title_of(kind)).c_str())) return;
    for (const HolderPreset& holder : all) {
        const std::string name(holder.preset.name);
        if (is_of_kind(holder) && ImGui::MenuItem(name.c_str(), nullptr, name == now)) choose(name);
    }
    ImGui::EndMenu();
}

/// The presets of holders, as menus: the taper, then the kind.
void draw_holders(const std::string& now, const std::function<void(std::string_view)>& choose) {
    for (const HolderTaper& taper : holder_tapers()) {
        if (!ImGui::BeginMenu(std::string(taper.name).c_str())) continue;
        for (const HolderKind kind : holder_kinds) draw_holder_kind(taper, kind, now, choose);
        ImGui::EndMenu();
    }
}

/// The name of a holder with another length, mm.
std::string with_length(const HolderPreset& holder, double length) {
    const std::string name(holder.preset.name);
    const bool is_usual = length == holder.preset.parameter("length")->standard;
    return is_usual ? name : fmt::format("{}-{}", name, core::number_text(length, 6));
}

} // namespace

void SetupForms::draw_holder(Frame& frame, const SheetTool& shown) {
    ViewModel& model = frame.model;
    const core::ToolNumber number = shown.tool.number;
    const std::string known = holder_name(shown.tool);
    const std::string now = !known.empty()              ? known
                            : shown.tool.holder.empty() ? "not described"
                                                        : "as described";
    const auto set = [&](const std::optional<std::string>& value) {
        edit_setup(
            model, fmt::format("Change the holder of T{}", core::value_of(number)),
            [&](const std::string& t) { return with_tool_value(t, number, "holder", value); });
    };
    field_name(frame, "Holder");
    ImGui::SetNextItemWidth(frame.px(190));
    if (ImGui::BeginCombo("##holder", now.c_str(), ImGuiComboFlags_HeightLargest)) {
        if (ImGui::Selectable("not described", shown.tool.holder.empty())) set(std::nullopt);
        draw_holders(now, [&](std::string_view name) { set(toml_text(name)); });
        ImGui::EndCombo();
    }
    source_mark(frame,
                shown.tool.holder.empty() ? SetupSource::assumed : shown.source_of("holder"));
    if (!known.empty()) draw_holder_length(frame, shown, known);
}

void SetupForms::draw_holder_length(Frame& frame, const SheetTool& shown, const std::string& name) {
    ViewModel& model = frame.model;
    const auto named = holder_named(name);
    if (!named) return;
    field_name(frame, "Holder's length");
    const auto typed =
        fields_.length(frame, "##holder_length", core::total_length(shown.tool.holder));
    unit_label(frame, length_unit(model));
    tip(frame, "From the gauge line to the lower face of the holder");
    if (!typed) return;
    const auto cones = holder_cones(*named->holder, {{"length", *typed}});
    if (!cones) {
        model.workspace.refusal = cones.error().message;
        return;
    }
    const core::ToolNumber number = shown.tool.number;
    edit_setup(model, fmt::format("Change the holder of T{}", core::value_of(number)),
               [&](const std::string& t) {
                   return with_tool_value(t, number, "holder",
                                          toml_text(with_length(*named->holder, *typed)));
               });
}

/// The tools of the library, to exchange a tool for one of them.
void SetupForms::draw_library(Frame& frame, core::ToolNumber number) {
    ViewModel& model = frame.model;
    const SetupSheet& sheet = *model.program->sheet;
    if (sheet.library.empty()) return;
    field_name(frame, "Exchange for");
    ImGui::SetNextItemWidth(frame.px(190));
    if (!ImGui::BeginCombo("##library", "a tool of the library")) return;
    for (const FoundTool& found : sheet.library) {
        const core::ToolDescription& tool = found.tool;
        ImGui::PushID(core::value_of(tool.number));
        const std::string label =
            fmt::format("{}  {} {}  {}", core::value_of(tool.number), core::name_of(tool.shape),
                        length_text(model, tool.diameter), tool.name);
        if (ImGui::Selectable(label.c_str())) take_library_tool(model, number, found);
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

void SetupForms::draw_tool_sizes(Frame& frame, const SheetTool& shown) {
    ViewModel& model = frame.model;
    const core::ToolNumber number = shown.tool.number;
    const bool has_cones = !shown.tool.shank.empty();
    for (const core::ToolSize& field : fields_of(shown.tool.shape)) {
        const std::string key = field.key;
        if (has_cones && (key == "stick_out" || key == "shank_diameter")) continue;
        const bool is_angle = field.is_angle();
        const std::optional<double> value = size_now(model, shown, field);
        ImGui::PushID(field.key);
        field_name(frame, field.name);
        const auto typed = is_angle ? fields_.number(frame, "##size", value)
                                    : fields_.length(frame, "##size", value);
        unit_label(frame, is_angle ? "\xC2\xB0" : length_unit(model));
        source_mark(frame, shown.source_of(key));
        if (typed)
            edit_setup(
                model, fmt::format("Change T{}", core::value_of(number)),
                [&](const std::string& t) { return with_tool_size(t, number, field, *typed); });
        ImGui::PopID();
    }
    if (has_cones)
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     "Its shank is described by cones, which determine the stick-out.");
}

void SetupForms::draw_tool(Frame& frame, const SheetTool& shown) {
    ViewModel& model = frame.model;
    const core::ToolNumber number = shown.tool.number;
    const bool is_stated = model.workspace.stated->has_tool(number);
    ImGui::PushID(core::value_of(number));
    draw_item_head(frame, fmt::format("Tool {}", core::value_of(number)), shown.is_described,
                   is_stated);
    if (!shown.is_described) {
        wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                     "The set-up does not describe this tool, so none of its motions is checked.");
        if (ImGui::Button("Describe it")) describe_tool(model, number);
        draw_library(frame, number);
        ImGui::PopID();
        return;
    }
    if (shown.tool.shape == core::ToolShape::profile) {
        wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                     "Edit its outline in the set-up file.");
    } else {
        field_name(frame, "Kind");
        ImGui::SetNextItemWidth(frame.px(140));
        if (ImGui::BeginCombo("##shape", core::name_of(shown.tool.shape))) {
            for (const core::ToolShape shape : stateable_shapes())
                if (ImGui::Selectable(core::name_of(shape), shape == shown.tool.shape)
                    && shape != shown.tool.shape)
                    edit_setup(model, fmt::format("Change T{}", core::value_of(number)),
                               [&](const std::string& t) {
                                   return with_tool(t, reshaped(shown.tool, shape));
                               });
            ImGui::EndCombo();
        }
        source_mark(frame, shown.source_of("shape"));
        draw_tool_sizes(frame, shown);
        draw_holder(frame, shown);
        draw_library(frame, number);
    }
    if (is_stated) {
        field_name(frame, "Number");
        if (std::exchange(wants_name, false)) ImGui::SetKeyboardFocusHere();
        const auto typed = fields_.number(frame, "##number", core::value_of(number));
        if (typed && *typed >= 0.0 && *typed <= 1e6 && *typed == std::floor(*typed))
            renumber_selected(model, core::ToolNumber{static_cast<int>(*typed)});
        else if (typed)
            model.workspace.refusal = "The number of a tool is a whole number from 0 on";
    }
    if (!shown.why.empty())
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     "Assumed: " + words_in_unit(model, shown.why));
    ImGui::PopID();
}

} // namespace app::viewer
