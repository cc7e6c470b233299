#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "app/base/sha256.h"
#include "app/check/setup_sheet.h"
#include "app/setup/presets/preset.h"
#include "app/setup/setup_changes.h"
#include "app/view/model/preset_fixture.h"
#include "app/view/model/unsaved_setup.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "app/view/ui/setup_forms.h"

namespace app::viewer {
namespace {

using render::Role;
using Kind = SetupItem::Kind;

/// Draws a box with a message across the panel.
void draw_banner(Frame& frame, Role role, const std::string& words) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.ChannelsSplit(2);
    list.ChannelsSetCurrent(1);
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, room = frame.px(9);
    ImGui::SetCursorScreenPos({from.x + room, from.y + frame.px(6)});
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width - 2 * room);
    text(frame.fonts.small, frame.palette.color(Role::text), words);
    ImGui::PopTextWrapPos();
    const ImVec2 end(from.x + width, ImGui::GetItemRectMax().y + frame.px(6));
    list.ChannelsSetCurrent(0);
    list.AddRectFilled(from, end, frame.palette.color(role, 0.2), frame.px(4));
    list.AddRectFilled(from, {from.x + frame.px(3), end.y}, frame.palette.color(role));
    list.ChannelsMerge();
    ImGui::SetCursorScreenPos({from.x, end.y + frame.px(5)});
}

/// Whether the panel that is being drawn has the keyboard.
bool has_keys() { return ImGui::IsWindowFocused(ImGuiFocusedFlags_ChildWindows); }

bool has_tool(const StatedSetup& stated, const SetupItem& item) {
    return item.kind == Kind::tool && stated.has_tool(item.tool);
}

} // namespace

struct SetupPanel::State {
    void draw(Frame& frame, const Area& area);

private:
    void draw_head(Frame& frame);
    void draw_questions(Frame& frame);
    void draw_problems(Frame& frame);
    void draw_found(Frame& frame);
    void draw_tree(Frame& frame, const std::vector<SetupRow>& rows);
    void draw_row(Frame& frame, const SetupRow& row, int index);
    void take_tree_keys(Frame& frame);
    void draw_add_menu(Frame& frame);

    SetupForms forms_;
    SetupItem focused_; // of the tree, by the keyboard
    float problems_height_ = 0.0F;
};

void SetupPanel::State::draw_head(Frame& frame) {
    Workspace& workspace = frame.model.workspace;
    const SetupDocument& document = workspace.document;
    std::string name = document.path().empty()
                           ? std::string("not saved yet")
                           : std::filesystem::path(document.path()).filename().generic_string();
    if (document.is_modified()) name += " \xE2\x80\xA2"; // a bullet
    ImGui::AlignTextToFramePadding();
    const float buttons = 3 * frame.px(37);
    text(frame.fonts.text, frame.palette.color(Role::text),
         shortened(frame.fonts.text, name, ImGui::GetContentRegionAvail().x - buttons));
    tip(frame, document.path().empty() ? "The set-up has no file yet (Ctrl+S)" : document.path());
    ImGui::SameLine(ImGui::GetContentRegionMax().x - buttons);
    const auto button = [&](Icon icon, Command command, bool is_possible, const std::string& more) {
        ImGui::BeginDisabled(!is_possible);
        ImGui::PushID(static_cast<int>(command));
        if (ImGui::Button(frame.fonts.icon(icon), ImVec2(frame.px(32), frame.px(28))))
            frame.perform(command);
        ImGui::PopID();
        ImGui::EndDisabled();
        tip(frame, tip_of(command) + more);
    };
    const std::string undo = document.undo_title(), redo = document.redo_title();
    button(Icon::undo, Command::undo, !undo.empty(), undo.empty() ? "" : ": " + undo);
    ImGui::SameLine(0, frame.px(5));
    button(Icon::redo, Command::redo, !redo.empty(), redo.empty() ? "" : ": " + redo);
    ImGui::SameLine(0, frame.px(5));
    button(Icon::save, Command::save_setup, document.is_modified() || document.path().empty(), "");
}

/// Draws what is wrong below everything else, so that nothing moves under the mouse.
void SetupPanel::State::draw_problems(Frame& frame) {
    const Workspace& workspace = frame.model.workspace;
    const float top = ImGui::GetCursorPosY();
    if (workspace.error) {
        const core::Error& error = *workspace.error;
        std::string where = std::filesystem::path(error.file).filename().generic_string();
        if (error.where.line > 0) where += fmt::format(":{}", error.where.line);
        if (error.where.column > 0) where += fmt::format(":{}", error.where.column);
        draw_banner(frame, Role::violation,
                    fmt::format("{}  {}: {}\nThe last good state is shown.",
                                frame.fonts.icon(Icon::warning), where, error.message));
    }
    if (!workspace.refusal.empty()) draw_banner(frame, Role::violation, workspace.refusal);
    problems_height_ = ImGui::GetCursorPosY() - top;
}

void SetupPanel::State::draw_questions(Frame& frame) {
    ViewModel& model = frame.model;
    Workspace& workspace = model.workspace;
    if (workspace.on_disk) {
        draw_banner(frame, Role::near,
                    "The file has been changed elsewhere, and there are edits here.");
        if (ImGui::SmallButton("Load the file"))
            take_file(model, *std::exchange(workspace.on_disk, std::nullopt));
        ImGui::SameLine();
        if (workspace.on_disk && ImGui::SmallButton("Keep my edits"))
            workspace.document.keep_over(*std::exchange(workspace.on_disk, std::nullopt));
    }
    if (!workspace.found.empty()) draw_found(frame);
}

/// Offers the latest edits of an earlier session.
void SetupPanel::State::draw_found(Frame& frame) {
    Workspace& workspace = frame.model.workspace;
    const UnsavedSetup found = workspace.found.back();
    const bool has_changed =
        !found.base.empty() && found.base != sha256_of(workspace.document.saved_text());
    std::string words = "There are edits from an earlier session that were not saved.";
    if (has_changed)
        words += " The file has been changed since: restoring them replaces that change, until you "
                 "undo it.";
    else if (workspace.document.is_modified())
        words += " Restoring them replaces the edits of now, until you undo it.";
    draw_banner(frame, Role::near, words);
    const bool restores = ImGui::SmallButton("Restore them");
    ImGui::SameLine();
    const bool discards = ImGui::SmallButton("Discard them");
    if (!restores && !discards) return;
    workspace.found.pop_back();
    workspace.answered.push_back(found);
    if (discards) return;
    edit_setup(frame.model, "Restore unsaved edits",
               [&](const std::string&) { return found.text; });
    ++workspace.replacements;
}

void SetupPanel::State::draw_row(Frame& frame, const SetupRow& row, int index) {
    Workspace& workspace = frame.model.workspace;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const Theme& palette = frame.palette;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = frame.px(20);
    const float text_y = at.y + 0.5F * (height - frame.fonts.text->FontSize);
    float indent = 0.0F;
    ImGui::PushID(index);
    if (row.item.kind == Kind::none) {
        ImGui::Dummy(ImVec2(width, height));
        list.AddText(frame.fonts.small, frame.fonts.small->FontSize,
                     {at.x + frame.px(2), text_y + 2}, palette.color(Role::dim), row.title.c_str());
    } else {
        const Kind kind = row.item.kind;
        const bool is_below_heading =
            kind == Kind::offset || kind == Kind::fixture || kind == Kind::tool;
        indent = is_below_heading ? frame.px(12) : 0.0F;
        const float left = at.x + indent;
        const bool is_selected = workspace.selected == row.item;
        if (is_selected && std::exchange(workspace.wants_focus, false))
            ImGui::SetKeyboardFocusHere();
        const bool pressed = ImGui::Selectable("##row", is_selected, 0, ImVec2(width, height));
        const bool got_focus = ImGui::IsItemFocused() && focused_ != row.item;
        if (got_focus) focused_ = row.item;
        if ((pressed || got_focus) && workspace.selected != row.item) {
            workspace.selected = row.item;
            workspace.refusal.clear(); // it is about a field that is gone
        }
        if (row.is_missing || row.has_error)
            list.AddText(frame.fonts.small, frame.fonts.small->FontSize,
                         {left + frame.px(2), text_y + 1},
                         palette.color(row.has_error ? Role::violation : Role::near),
                         frame.fonts.icon(Icon::warning));
        else
            draw_mark(frame, list, {left + frame.px(8), at.y + 0.5F * height}, row.source);
        list.AddText(frame.fonts.text, frame.fonts.text->FontSize, {left + frame.px(20), text_y},
                     palette.color(Role::text), row.title.c_str());
    }
    const float title =
        frame.fonts.text->CalcTextSizeA(frame.fonts.text->FontSize, 1e9F, 0.0F, row.title.c_str())
            .x;
    const std::string detail =
        shortened(frame.fonts.small, row.detail, width - title - indent - frame.px(36));
    const float room =
        frame.fonts.small->CalcTextSizeA(frame.fonts.small->FontSize, 1e9F, 0.0F, detail.c_str()).x;
    list.AddText(frame.fonts.small, frame.fonts.small->FontSize,
                 {at.x + width - room - frame.px(6), text_y + 1},
                 palette.ink(row.is_missing ? Role::near : Role::dim), detail.c_str());
    ImGui::PopID();
}

void SetupPanel::State::take_tree_keys(Frame& frame) {
    const bool is_typing = ImGui::GetIO().WantTextInput && ImGui::IsAnyItemActive();
    if (ImGui::IsWindowFocused() && !is_typing && ImGui::IsKeyPressed(key::remove, false))
        delete_selected(frame.model);
}

void SetupPanel::State::draw_tree(Frame& frame, const std::vector<SetupRow>& rows) {
    const float room = ImGui::GetContentRegionAvail().y;
    const float wanted = frame.px(21) * static_cast<float>(rows.size()) + frame.px(12);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, frame.px(1)));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.px(6), frame.px(5)));
    ImGui::BeginChild("tree", ImVec2(0, std::min(wanted, 0.42F * room)), true,
                      ImGuiWindowFlags_AlwaysUseWindowPadding | ImGuiWindowFlags_NavFlattened);
    ImGui::PopStyleVar();
    Workspace& workspace = frame.model.workspace;
    if (workspace.wants_focus && workspace.selected.kind == Kind::none)
        workspace.selected = {Kind::stock, {}, {}};
    int index = 0;
    for (const SetupRow& row : rows) draw_row(frame, row, index++);
    take_tree_keys(frame);
    ImGui::EndChild();
    ImGui::PopStyleVar();
}

void SetupPanel::State::draw_add_menu(Frame& frame) {
    ViewModel& model = frame.model;
    const bool wants_menu = has_keys() && ImGui::IsKeyPressed(key::insert, false);
    if (ImGui::Button("Add \xE2\x80\xA6") || wants_menu) ImGui::OpenPopup("add");
    tip(frame, "Add a fixture, the part, a tool library, a work offset, or state that there are no "
               "fixtures (Insert)");
    const ImVec2 below(ImGui::GetItemRectMin().x, ImGui::GetItemRectMax().y);
    ImGui::SetNextWindowPos(below, ImGuiCond_Appearing);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.px(10), frame.px(8)));
    if (ImGui::BeginPopup("add")) {
        if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere(); // Enter chooses the first
        if (ImGui::MenuItem("Fixture: block")) add_box(model);
        if (ImGui::MenuItem("Fixture: mesh or CAD file \xE2\x80\xA6"))
            browse(model, FileWish::mesh);
        for (const PresetKind kind : preset_kinds) {
            if (!ImGui::BeginMenu(std::string(title_of(kind)).c_str())) continue;
            for (const Preset& preset : presets()) {
                if (preset.kind != kind) continue;
                ImGui::PushID(preset.name.data()); // titles are not unique
                if (ImGui::MenuItem(std::string(preset.title).c_str(),
                                    std::string(preset.name).c_str()))
                    add_preset(model, preset);
                ImGui::PopID();
            }
            ImGui::EndMenu();
        }
        if (ImGui::MenuItem("Finished part: mesh or CAD file \xE2\x80\xA6"))
            browse(model, FileWish::part);
        if (ImGui::MenuItem("Tool")) add_tool(model);
        if (ImGui::MenuItem("Tool library \xE2\x80\xA6")) browse(model, FileWish::tools);
        if (ImGui::MenuItem("Tools, stock, part: FreeCAD job \xE2\x80\xA6"))
            browse(model, FileWish::job);
        if (ImGui::MenuItem("Compare with the control \xE2\x80\xA6"))
            browse(model, FileWish::offsets);
        if (model.workspace.stated->fixtures.empty() && ImGui::MenuItem("There are no fixtures"))
            edit_setup(model, "State that there are no fixtures", [](const std::string& t) {
                return toml_with_value(t, "fixtures", "\"none\"");
            });
        for (int number = 54; number <= 59; ++number) {
            const std::string name = "G" + std::to_string(number);
            if (model.program->sheet->offset(name)) continue;
            if (!ImGui::MenuItem(("Work offset " + name).c_str())) break;
            if (edit_setup(model, "Add " + name, [&](const std::string& t) {
                    return with_offset(t, name, core::Vec3(0.0));
                }))
                model.workspace.selected = {Kind::offset, name, {}};
            break;
        }
        ImGui::EndPopup();
    }
    ImGui::PopStyleVar();
}

void SetupPanel::State::draw(Frame& frame, const Area& area) {
    ViewModel& model = frame.model;
    draw_list_tabs(frame);
    draw_counts(frame, area);
    if (has_keys() && ImGui::IsKeyPressed(key::function(2), false))
        forms_.wants_name = model.workspace.selected.kind == Kind::fixture
                            || has_tool(*model.workspace.stated, model.workspace.selected);
    ImGui::Dummy(ImVec2(0, frame.px(3)));
    draw_head(frame);
    draw_questions(frame);
    if (!model.program || !model.program->sheet) {
        text(frame.fonts.text, frame.palette.color(Role::dim),
             "The set-up is being read \xE2\x80\xA6");
        return draw_problems(frame);
    }
    const auto sheet = model.program->sheet; // an edit does not replace it while it is drawn
    draw_tree(frame, rows_of_setup(model));
    draw_add_menu(frame);
    ImGui::SameLine();
    if (ImGui::Button("Tolerances")) frame.perform(Command::tolerances);
    tip(frame, tip_of(Command::tolerances));
    ImGui::SameLine();
    if (ImGui::Button("Sheet")) frame.perform(Command::print_sheet);
    tip(frame, tip_of(Command::print_sheet));
    ImGui::Separator();
    forms_.draw(frame, problems_height_);
    draw_problems(frame);
    model.workspace.has_keys = has_keys();
    if (std::exchange(model.workspace.wants_focus, false)) ImGui::SetWindowFocus();
}

SetupPanel::SetupPanel() : state_(std::make_unique<State>()) {}

SetupPanel::~SetupPanel() = default;

void SetupPanel::draw(Frame& frame, const Area& area) { state_->draw(frame, area); }

} // namespace app::viewer
