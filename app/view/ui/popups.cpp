#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/view/model/folder_listing.h"
#include "app/view/model/navigation.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/settings.h"
#include "app/view/model/tolerance_sheet.h"
#include "app/view/model/unit_words.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "core/base/units.h"

namespace app::viewer {
namespace {

using render::Role;

void draw_shortcuts(Frame& frame) {
    constexpr std::array columns = {CommandGroup::walk, CommandGroup::camera, CommandGroup::show,
                                    CommandGroup::stops, CommandGroup::window};
    if (!ImGui::BeginTable("keys", 3)) return;
    for (const CommandGroup group : columns) {
        if (group != CommandGroup::show && group != CommandGroup::window) ImGui::TableNextColumn();
        text(frame.fonts.strong, frame.palette.color(Role::accent), title_of(group));
        for (const KeyBinding& binding : key_bindings()) {
            if (binding.group != group || binding.help[0] == 0) continue;
            const float left = ImGui::GetCursorPosX();
            text(frame.fonts.text, frame.palette.color(Role::dim), binding.keys);
            ImGui::SameLine();
            ImGui::SetCursorPosX(left + frame.px(100));
            text(frame.fonts.text, frame.palette.color(Role::text), binding.help);
        }
        ImGui::Dummy(ImVec2(0, frame.px(6)));
    }
    ImGui::EndTable();
    wrapped_text(
        frame.fonts.small, frame.palette.color(Role::dim),
        "Mouse: drag to turn, right drag to move, wheel to zoom towards the cursor; click "
        "the path or a cut surface to go to its line; click next to a line number to set a "
        "breakpoint; drag the timeline to scrub, turn the wheel there to zoom.");
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                 "Filter and breakpoints take conditions: clearance < 1 and rapid; T3 or T4; near; "
                 "error; rule = near-miss; \"clamp-1\"; line > 200; ~ \"G81\". The filter searches "
                 "the lines for any other text.");
}

void draw_settings(Frame& frame) {
    Settings& settings = frame.model.settings;
    int theme = settings.theme == render::ColorScheme::light ? 1 : 0;
    ImGui::RadioButton("Dark", &theme, 0);
    ImGui::SameLine();
    ImGui::RadioButton("Light", &theme, 1);
    settings.theme = theme == 1 ? render::ColorScheme::light : render::ColorScheme::dark;
    int unit = settings.inch ? 1 : 0;
    ImGui::RadioButton("mm", &unit, 0);
    ImGui::SameLine();
    ImGui::RadioButton("inch", &unit, 1);
    settings.has_own_unit = settings.has_own_unit || settings.inch != (unit == 1);
    settings.inch = unit == 1;
    int mouse = static_cast<int>(settings.mouse);
    ImGui::SetNextItemWidth(frame.px(280));
    ImGui::Combo("Mouse", &mouse, mouse_preset_names, 3);
    settings.mouse = static_cast<MousePreset>(mouse);
    ImGui::TextUnformatted(fmt::format("Size {:.0f} %", 100.0 * settings.scale).c_str());
    ImGui::SameLine();
    if (ImGui::Button("Smaller")) frame.perform(Command::smaller);
    ImGui::SameLine();
    if (ImGui::Button("Larger")) frame.perform(Command::larger);
    bool perspective = settings.projection == render::Projection::perspective;
    if (ImGui::Checkbox("Perspective", &perspective)) frame.perform(Command::projection);
    if (ImGui::Checkbox("File dialog of the system", &settings.system_dialog))
        frame.model.browser.uses_system = settings.system_dialog;
    ImGui::Checkbox("Slow motion through a minimum", &frame.model.playback.slow_near);
}

void draw_cause(Frame& frame, const ToleranceCause& cause) {
    ImGui::TableNextColumn();
    const auto role = cause.block ? Role::accent : Role::dim;
    wrapped_text(frame.fonts.small, frame.palette.color(role), cause.words);
    if (!cause.block) return;
    tip(frame, "Click to go there");
    if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    if (!ImGui::IsItemClicked()) return;
    go_to(frame.model, *cause.block);
    frame.model.popup = Popup::none;
}

void draw_tolerances(Frame& frame) {
    const ToleranceSheet sheet = tolerance_sheet(frame.model);
    if (!sheet.status.empty()) {
        wrapped_text(frame.fonts.text,
                     frame.palette.color(sheet.has_failed ? Role::violation : Role::text),
                     sheet.status);
        if (frame.model.tolerances.is_running)
            ImGui::ProgressBar(static_cast<float>(frame.model.tolerances.fraction),
                               ImVec2(-1.0F, frame.px(4)), "");
        return;
    }
    wrapped_text(
        frame.fonts.text, frame.palette.color(Role::dim),
        "How far each value may deviate, one at a time: the check is proven to stay clear.");
    if (!ImGui::BeginTable("tolerances", 4, ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("Value", ImGuiTableColumnFlags_WidthFixed, frame.px(170));
    ImGui::TableSetupColumn("Tolerance", ImGuiTableColumnFlags_WidthFixed, frame.px(230));
    ImGui::TableSetupColumn("Limited downwards by", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("Limited upwards by", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableHeadersRow();
    int row = 0;
    for (const ToleranceLine& line : sheet.lines) {
        ImGui::PushID(row++);
        ImGui::TableNextColumn();
        text(frame.fonts.text, frame.palette.color(Role::text), line.name);
        ImGui::TableNextColumn();
        wrapped_text(frame.fonts.text, frame.palette.color(line.is_known ? Role::text : Role::dim),
                     line.range);
        for (const ToleranceCause& cause : line.causes) draw_cause(frame, cause);
        ImGui::PopID();
    }
    ImGui::EndTable();
}

const char* title_of(Popup popup) {
    switch (popup) {
    case Popup::shortcuts:
        return "Keys";
    case Popup::go_to_line:
        return "Go to line";
    case Popup::open_file:
        return "Files";
    case Popup::what_if:
        return "What if";
    case Popup::breakpoint:
        return "Breakpoints";
    case Popup::settings:
        return "Settings";
    case Popup::leaving:
        return "The set-up has unsaved edits";
    case Popup::tolerances:
        return "How wrong may the set-up be?";
    case Popup::report:
        return "Report";
    case Popup::none:
        break;
    }
    return "";
}

/// Draws the label of a row of the what-if dialog; its fields follow on the same line.
void row_name(Frame& frame, const std::string& name) {
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.text, frame.palette.color(Role::dim), name);
    ImGui::SameLine(frame.px(150));
}

/// The unit of the window, mm.
double unit_of(const Frame& frame) { return frame.model.settings.inch ? core::mm_per_inch : 1.0; }

/// An input field for a length in the unit of the window, and a button that tries it. True if Enter
/// or the button was pressed. `value`: mm.
bool length_to_try(Frame& frame, const char* id, double& value) {
    ImGui::PushID(id);
    ImGui::SetNextItemWidth(frame.px(100));
    double shown = value / unit_of(frame);
    const bool entered = ImGui::InputDouble(length_unit(frame.model), &shown, 0.0, 0.0,
                                            frame.model.settings.inch ? "%.5f" : "%.3f",
                                            ImGuiInputTextFlags_EnterReturnsTrue);
    if (entered) value = shown * unit_of(frame);
    ImGui::SameLine();
    const bool pressed = ImGui::Button("Try");
    ImGui::PopID();
    return entered || pressed;
}

} // namespace

void PopupPanel::draw_go_to_line(Frame& frame) {
    ViewModel& model = frame.model;
    if (ImGui::IsWindowAppearing()) {
        ImGui::SetKeyboardFocusHere();
        line_.clear();
    }
    ImGui::SetNextItemWidth(frame.px(260));
    const bool done = ImGui::InputTextWithHint("##line", "Line 188, or N1880", &line_,
                                               ImGuiInputTextFlags_EnterReturnsTrue);
    const auto found = find_line(model, line_);
    if (!line_.empty() && !found)
        text(frame.fonts.small, frame.palette.color(Role::violation),
             "No block of this line is executed.");
    if (!done || !found) return;
    go_to(model, *found);
    model.popup = Popup::none;
}

void PopupPanel::draw_breakpoint(Frame& frame) {
    ViewModel& model = frame.model;
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(frame.px(340));
    const bool done = ImGui::InputTextWithHint("##condition", "clearance < 1 and rapid",
                                               &condition_, ImGuiInputTextFlags_EnterReturnsTrue);
    const auto condition = Condition::read(condition_);
    if (!condition_.empty() && !condition)
        wrapped_text(frame.fonts.small, frame.palette.color(Role::violation),
                     condition.error().message);
    std::optional<size_t> gone;
    for (size_t i = 0; i < model.breakpoints.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::SmallButton(frame.fonts.icon(Icon::close))) gone = i;
        ImGui::SameLine();
        text(frame.fonts.mono, frame.palette.color(Role::text), text_of(model.breakpoints[i]));
        ImGui::PopID();
    }
    if (gone) model.breakpoints.erase(model.breakpoints.begin() + static_cast<ptrdiff_t>(*gone));
    const bool is_new = done && condition;
    if (is_new) {
        Breakpoint breakpoint;
        breakpoint.condition = *condition;
        model.breakpoints.push_back(std::move(breakpoint));
        condition_.clear();
        model.popup = Popup::none;
    }
    if (gone || is_new) model.breakpoints_changed = true;
}

void PopupPanel::draw_lengths(Frame& frame, const core::Setup& setup) {
    ViewModel& model = frame.model;
    const auto tool = model.block_state->tool;
    if (tool && setup.tools.contains(*tool)) {
        if (ImGui::IsWindowAppearing()) length_ = setup.tools.at(*tool).length;
        row_name(frame, fmt::format("Length of T{}", core::value_of(*tool)));
        if (length_to_try(frame, "tool", length_))
            model.wanted_change = ToolLengthChange{*tool, length_};
    }
    row_name(frame, "Offset table, H");
    ImGui::SetNextItemWidth(frame.px(60));
    ImGui::InputInt("##number", &table_number_, 0);
    ImGui::SameLine();
    if (length_to_try(frame, "table", table_length_))
        model.wanted_change =
            LengthOffsetOverride{core::OffsetNumber{table_number_}, table_length_};
    row_name(frame, "Work offset");
    ImGui::SetNextItemWidth(frame.px(74));
    ImGui::Combo("##offset", &offset_, "G54\0G55\0G56\0G57\0G58\0G59\0");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(frame.px(56));
    ImGui::Combo("##axis", &axis_, "X\0Y\0Z\0");
    ImGui::SameLine();
    if (length_to_try(frame, "origin", origin_))
        model.wanted_change =
            WorkOffsetChange{static_cast<size_t>(offset_), static_cast<size_t>(axis_), origin_};
}

void PopupPanel::draw_fixture(Frame& frame, const core::Setup& setup) {
    fixture_ = std::min(fixture_, setup.fixtures.size() - 1);
    row_name(frame, "Move a fixture");
    ImGui::SetNextItemWidth(frame.px(140));
    if (ImGui::BeginCombo("##fixture", setup.fixtures[fixture_].name.c_str())) {
        for (size_t i = 0; i < setup.fixtures.size(); ++i)
            if (ImGui::Selectable(setup.fixtures[i].name.c_str(), i == fixture_)) fixture_ = i;
        ImGui::EndCombo();
    }
    ImGui::SameLine();
    ImGui::SetNextItemWidth(frame.px(190));
    double shown[3] = {by_[0] / unit_of(frame), by_[1] / unit_of(frame), by_[2] / unit_of(frame)};
    const bool inch = frame.model.settings.inch;
    if (ImGui::InputScalarN(inch ? "X Y Z in" : "X Y Z mm", ImGuiDataType_Double, shown, 3, nullptr,
                            nullptr, inch ? "%.4f" : "%.2f"))
        for (size_t i = 0; i < 3; ++i) by_[i] = shown[i] * unit_of(frame);
    ImGui::SameLine();
    if (ImGui::Button("Try##fixture"))
        frame.model.wanted_change =
            MovedFixture{setup.fixtures[fixture_].name, {by_[0], by_[1], by_[2]}};
}

void PopupPanel::draw_what_if(Frame& frame) {
    ViewModel& model = frame.model;
    if (!model.block_state) return;
    const core::Setup& setup = model.block_state->scene->setup;
    wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                 fmt::format("Takes effect from block {} on; earlier blocks do not change.",
                             model.cursor.block));
    draw_lengths(frame, setup);
    row_name(frame, "Minimum clearance");
    if (length_to_try(frame, "allowance", allowance_))
        model.wanted_change = AllowanceChange{allowance_};
    if (!setup.fixtures.empty()) draw_fixture(frame, setup);
    for (const std::string& change : model.changes)
        text(frame.fonts.text, frame.palette.color(Role::accent), words_in_unit(model, change));
    if (!model.changes.empty() && ImGui::Button("Undo the last change"))
        model.wants_take_back = true;
}

void PopupPanel::draw_leaving(Frame& frame) {
    ViewModel& model = frame.model;
    Workspace& workspace = model.workspace;
    const std::string& path = workspace.document.path();
    text(frame.fonts.text, frame.palette.color(Role::text),
         path.empty() ? fmt::format("That of {} is not saved in a file yet.",
                                    readable_name(model.opened_path))
                      : "They are not in " + path + " yet.");
    ImGui::Dummy(ImVec2(0, frame.px(4)));
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    if (ImGui::Button("Save")) {
        model.wants_saving = true;
        model.shows_setup = true;
        model.popup = Popup::none;
    }
    ImGui::SameLine();
    if (ImGui::Button("Discard the edits")) {
        workspace.drops_edits = true;
        model.popup = Popup::none;
    }
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) {
        workspace.leaving = Leaving::no;
        model.popup = Popup::none;
    }
}

void PopupPanel::draw_report(Frame& frame) {
    ViewModel& model = frame.model;
    text(frame.fonts.mono, frame.palette.color(Role::text), model.report_text);
    ImGui::Dummy(ImVec2(0, frame.px(4)));
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    const bool can_take =
        model.report_setup && model.report_version == model.workspace.document.version();
    if (can_take && ImGui::Button(model.report_question.c_str())) {
        const std::string setup = *std::exchange(model.report_setup, std::nullopt);
        edit_setup(model, model.report_question, [&](const std::string&) { return setup; });
        show_setup(model, true);
        model.popup = Popup::none;
    }
    if (can_take) ImGui::SameLine();
    if (ImGui::Button("Close")) model.popup = Popup::none;
}

void PopupPanel::draw(Frame& frame, const Area& area) {
    ViewModel& model = frame.model;
    claim_page_keys(model.popup == Popup::open_file);
    if (model.popup == Popup::none) return;
    const bool is_wide = model.popup == Popup::shortcuts;
    const bool is_table = model.popup == Popup::tolerances;
    ImGui::SetNextWindowPos(ImVec2(area.x + 0.5F * area.width, area.y + 0.45F * area.height),
                            ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    // A dialog taller than the window scrolls.
    ImGui::SetNextWindowSizeConstraints(ImVec2(0.0F, 0.0F),
                                        ImVec2(area.width - 20, 0.88F * area.height));
    if (is_wide) ImGui::SetNextWindowSize(ImVec2(std::min(frame.px(1120), area.width - 20), 0));
    if (is_table) ImGui::SetNextWindowSize(ImVec2(std::min(frame.px(980), area.width - 20), 0));
    if (model.popup == Popup::open_file)
        ImGui::SetNextWindowSize(ImVec2(std::min(frame.px(940), area.width - 20),
                                        std::min(frame.px(600), 0.88F * area.height)));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1.0F);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.px(18), frame.px(16)));
    ImGui::PushStyleColor(ImGuiCol_WindowBg, frame.palette.color(Role::panel, 0.98));
    bool open = true;
    const char* const title = model.popup == Popup::open_file ? title_of(model.browser.wish)
                              : model.popup == Popup::report  ? model.report_title.c_str()
                                                              : title_of(model.popup);
    ImGui::Begin(title, &open,
                 ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize
                     | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove);
    if (shown_ != model.popup) ImGui::SetWindowFocus();
    shown_ = model.popup;
    switch (model.popup) {
    case Popup::shortcuts:
        draw_shortcuts(frame);
        break;
    case Popup::go_to_line:
        draw_go_to_line(frame);
        break;
    case Popup::open_file:
        draw_file_browser(frame);
        break;
    case Popup::what_if:
        draw_what_if(frame);
        break;
    case Popup::breakpoint:
        draw_breakpoint(frame);
        break;
    case Popup::settings:
        draw_settings(frame);
        break;
    case Popup::leaving:
        draw_leaving(frame);
        break;
    case Popup::tolerances:
        draw_tolerances(frame);
        break;
    case Popup::report:
        draw_report(frame);
        break;
    case Popup::none:
        break;
    }
    ImGui::End();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar(2);
    if (!open) {
        model.workspace.leaving = Leaving::no;
        close_browser(model);
    }
    if (model.popup == Popup::none) shown_ = Popup::none;
}

void ErrorPanel::draw(Frame& frame, const Area& area) {
    const ViewModel& model = frame.model;
    const core::Error nothing{
        core::ErrorCode::missing_value, {}, "The program has no executable block."};
    const core::Error& error = model.failure   ? *model.failure
                               : model.stopped ? *model.stopped
                                               : nothing;
    const float width = std::min(frame.px(680), area.width - frame.px(40));
    const float left = area.x + 0.5F * (area.width - width), top = area.y + 0.22F * area.height;
    ImGui::GetWindowDrawList()->AddRectFilled(area.corner(), area.far_corner(),
                                              frame.palette.color(Role::background));
    ImGui::SetCursorScreenPos({left, top});
    ImGui::PushStyleColor(ImGuiCol_ChildBg, frame.palette.color(Role::panel));
    ImGui::PushStyleVar(ImGuiStyleVar_ChildRounding, frame.px(10));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.px(26), frame.px(22)));
    ImGui::BeginChild("error", ImVec2(width, frame.px(270)), true);
    text(frame.fonts.strong, frame.palette.color(Role::violation),
         std::string(frame.fonts.icon(Icon::warning)) + "  The program could not be "
             + (model.failure ? "opened" : "run"));
    std::string location =
        error.file.empty() && model.program ? model.program->program : error.file;
    if (error.where.line > 0) location += fmt::format(":{}", error.where.line);
    if (error.where.line > 0 && error.where.column > 0)
        location += fmt::format(":{}", error.where.column);
    ImGui::Dummy(ImVec2(0, frame.px(6)));
    wrapped_text(frame.fonts.mono, frame.palette.color(Role::accent), location);
    ImGui::Dummy(ImVec2(0, frame.px(2)));
    wrapped_text(frame.fonts.text, frame.palette.color(Role::text), error.message);
    ImGui::Dummy(ImVec2(0, frame.px(10)));
    wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                 "Correct the file and save it; it is then reloaded automatically. Or drop another "
                 "program or set-up here.");
    ImGui::Dummy(ImVec2(0, frame.px(6)));
    if (ImGui::Button("Reload")) frame.perform(Command::reload);
    ImGui::SameLine();
    if (ImGui::Button("Open another file")) frame.perform(Command::open);
    if (model.tabs.size() > 1) {
        ImGui::SameLine();
        if (ImGui::Button("Close (Esc)")) frame.perform(Command::close_program);
    }
    ImGui::EndChild();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
    draw_message(frame, area);
}

} // namespace app::viewer
