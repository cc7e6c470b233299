#include <algorithm>
#include <filesystem>
#include <functional>

#include <fmt/format.h>
#include <imgui.h>

#include "app/check/setup_sheet.h"
#include "app/setup/machines/machine_preset.h"
#include "app/setup/setup_changes.h"
#include "app/view/model/file_watch.h"
#include "app/view/model/unit_words.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/setup_forms.h"

namespace app::viewer {
namespace {

using render::Role;

/// The presets of machines, as menus by kind. Calls `choose` with the name of one.
void draw_machines(const std::string& now, const std::function<void(std::string_view)>& choose) {
    for (const MachineKind kind : machine_kinds) {
        if (!ImGui::BeginMenu(std::string(title_of(kind)).c_str())) continue;
        for (const MachinePreset& machine : machine_presets())
            if (machine.kind == kind
                && ImGui::MenuItem(std::string(machine.title).c_str(),
                                   std::string(machine.name).c_str(), machine.name == now))
                choose(machine.name);
        ImGui::EndMenu();
    }
}

/// "in/min" for a speed of a linear axis, in the unit of the window.
std::string unit_text(const ViewModel& model, MachineUnit unit) {
    const std::string name(name_of(unit));
    return name.starts_with("mm") ? length_unit(model) + name.substr(2) : name;
}

} // namespace

void SetupForms::draw_machine_sizes(Frame& frame, const MachinePreset& machine, bool first) {
    ViewModel& model = frame.model;
    const auto kept = model.workspace.stated; // edits replace it
    const PresetValues& values = kept->machine_values;
    for (const MachineSize& size : machine.sizes) {
        const auto stated = values.find(size.key);
        const bool is_stated = stated != values.end();
        const bool is_limit = size.key.ends_with("_min") || size.key.ends_with("_max");
        if ((is_limit || is_stated) != first) continue;
        const std::optional<double> value =
            is_stated ? std::optional(stated->second) : size.standard;
        const std::string id = "##" + std::string(size.key);
        field_name(frame, label_of(size.key));
        const auto typed =
            is_angle(size.unit)
                ? fields_.number(frame, id.c_str(), value)
                : fields_.length(frame, id.c_str(), value, SetupFields::field_width, "not known");
        tip(frame, std::string(size.meaning));
        if (typed)
            edit_setup(model, "Change the machine", [&](const std::string& t) {
                return with_machine_value(t, size.key, *typed);
            });
        unit_label(frame, unit_text(model, size.unit).c_str());
        source_mark(frame, is_stated ? SetupSource::stated : SetupSource::assumed);
    }
}

void SetupForms::draw_machine_preset(Frame& frame) {
    ViewModel& model = frame.model;
    const std::string now = model.workspace.stated->machine_preset;
    field_name(frame, "Preset");
    ImGui::SetNextItemWidth(frame.px(208));
    if (ImGui::BeginCombo("##machine_preset", now.empty() ? "none" : now.c_str(),
                          ImGuiComboFlags_HeightLargest)) {
        draw_machines(now, [&](std::string_view name) {
            edit_setup(model, "Change the machine",
                       [&](const std::string& t) { return with_machine_preset(t, name); });
        });
        ImGui::EndCombo();
    }
    const MachinePreset* const machine = find_machine_preset(now);
    if (!machine) return;
    draw_machine_sizes(frame, *machine, true);
    if (!ImGui::TreeNodeEx("More sizes", ImGuiTreeNodeFlags_NoTreePushOnOpen)) return;
    draw_machine_sizes(frame, *machine, false);
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                 fmt::format("{} Machine zero: {}", machine->source, machine->zero));
}

void SetupForms::draw_machine(Frame& frame) {
    ViewModel& model = frame.model;
    const auto kept = model.workspace.stated; // edits replace it
    draw_item_head(frame, "Machine", false, false);
    draw_machine_preset(frame);
    if (!kept->machine_preset.empty()) {
        if (ImGui::Button("Without the preset")) use_machine(model, {});
        return;
    }
    field_name(frame, "File");
    const auto file =
        fields_.words(frame, "##file", kept->machine_file, "MACHINE.toml, .machine or .mch", 200);
    if (ImGui::Button("Browse \xE2\x80\xA6")) browse(model, FileWish::machine);
    if (file) is_ini_file(*file) ? use_ini(model, *file) : use_machine(model, *file);
    field_name(frame, "LinuxCNC");
    const auto ini = fields_.words(frame, "##ini", kept->ini, "its .ini file", 200);
    if (ini) use_ini(model, *ini);
    const char* const what =
        model.program->sheet->has_machine ? "Its axes, limits and bodies are in that file."
        : kept->ini.empty()
            ? "Without a machine, axis limits are not checked, and X, Y and Z move the tool."
            : "Limits, speeds and home positions are in the ini file; X, Y and Z move the tool.";
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim), what);
}

} // namespace app::viewer
