#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/base/text.h"
#include "app/view/model/file_browser.h"
#include "app/view/model/folder_listing.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"

namespace app::viewer {
namespace {

using render::Role;

constexpr int page_rows = 12;

Icon icon_of(FileKind kind) {
    switch (kind) {
    case FileKind::folder:
        return Icon::open;
    case FileKind::program:
        return Icon::program;
    case FileKind::setup:
        return Icon::edit;
    case FileKind::machine:
        return Icon::settings;
    case FileKind::mesh:
        return Icon::section;
    case FileKind::tools:
        return Icon::tool;
    case FileKind::page:
    case FileKind::other:
        return Icon::note;
    }
    return Icon::note;
}

const char* verb_of(FileWish wish) { return saves(wish) ? "Save" : "Open"; }

/// The keys that move in the list while the field has the keyboard.
void take_list_keys(FileBrowser& browser, bool was_empty) {
    const auto pressed = [](int code) { return ImGui::IsKeyPressed(code); };
    const ImGuiIO& io = ImGui::GetIO();
    if (pressed(key::up) && io.KeyAlt) return go_up(browser);
    if (pressed(key::up)) move_selection(browser, -1);
    if (pressed(key::down)) move_selection(browser, 1);
    if (pressed(key::page_up)) move_selection(browser, -page_rows);
    if (pressed(key::page_down)) move_selection(browser, page_rows);
    if (pressed(key::backspace) && was_empty) go_up(browser);
    if (pressed(key::of('H')) && io.KeyCtrl) {
        browser.shows_hidden = !browser.shows_hidden;
        update_rows(browser);
    }
}

/// Replaces the text of the field that has the keyboard, of which ImGui keeps a copy. The field
/// also calls it so that the arrow keys do not leave it.
int replace_text(ImGuiInputTextCallbackData* data) {
    const auto& replaced = static_cast<FileBrowser*>(data->UserData)->replaced;
    if (data->EventFlag != ImGuiInputTextFlags_CallbackAlways || !replaced) return 0;
    data->DeleteChars(0, data->BufTextLen);
    data->InsertChars(0, replaced->c_str());
    return 0;
}

void draw_field(Frame& frame) {
    FileBrowser& browser = frame.model.browser;
    const bool was_empty = browser.typed.empty(),
               saves_setup = browser.wish == FileWish::save_setup;
    if (std::exchange(browser.wants_focus, false)) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    const bool entered = ImGui::InputTextWithHint(
        "##typed",
        saves_setup           ? "FILE.toml"
        : saves(browser.wish) ? "FILE.html"
                              : "Type a part of the name, or a path",
        &browser.typed,
        ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackHistory
            | ImGuiInputTextFlags_CallbackAlways,
        replace_text, &browser);
    if (browser.replaced) browser.typed = *std::exchange(browser.replaced, std::nullopt);
    if (ImGui::IsItemEdited()) {
        browser.selected = 0;
        browser.wants_scroll = true;
        browser.error.clear();
        frame.model.workspace.refusal.clear();
        update_rows(browser);
    }
    if (ImGui::IsItemActive()) take_list_keys(browser, was_empty);
    if (!entered) return;
    browser.wants_focus = true;
    enter_typed(frame.model);
}

void draw_folder_line(Frame& frame) {
    FileBrowser& browser = frame.model.browser;
    if (ImGui::Button("\xE2\x86\x91")) go_up(browser); // an arrow up
    tip(frame, "The folder above (Backspace in the empty field, Alt+Up)");
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    const float filter = frame.px(190), hidden = frame.px(90);
    const float room = ImGui::GetContentRegionAvail().x - filter - hidden - frame.px(20);
    text(frame.fonts.text, frame.palette.color(Role::text),
         shortened(frame.fonts.text, readable_name(browser.folder), room));
    tip(frame, readable_name(browser.folder));
    ImGui::SameLine(ImGui::GetContentRegionMax().x - filter - hidden - frame.px(7));
    if (ImGui::Checkbox("Hidden", &browser.shows_hidden)) update_rows(browser);
    tip(frame, "List hidden files too (Ctrl+H)");
    ImGui::SameLine(ImGui::GetContentRegionMax().x - filter);
    ImGui::SetNextItemWidth(filter);
    if (!ImGui::BeginCombo("##filter", name_of(browser.filter))) return;
    for (const FileFilter each : file_filters) {
        if (!ImGui::Selectable(name_of(each), each == browser.filter)) continue;
        browser.filter = each;
        browser.wants_focus = true;
        update_rows(browser);
    }
    ImGui::EndCombo();
}

void draw_places(Frame& frame, float width, float height) {
    FileBrowser& browser = frame.model.browser;
    ImGui::BeginChild("places", ImVec2(width, height));
    for (const FilePlace& place : browser.places) {
        ImGui::PushID(place.path.c_str());
        if (ImGui::Selectable(place.name.c_str(), place.path == browser.folder)) {
            look_at(browser, place.path);
            browser.wants_focus = true;
        }
        tip(frame, readable_name(place.path));
        ImGui::PopID();
    }
    const std::vector<RecentProgram>& recent = frame.model.recent;
    if (browser.wish == FileWish::open && !recent.empty()) {
        heading(frame, "Recent");
        for (const RecentProgram& each : recent)
            draw_recent(frame, each, ImGui::GetContentRegionAvail().x);
    }
    ImGui::EndChild();
}

void draw_entry(Frame& frame, size_t row) {
    FileBrowser& browser = frame.model.browser;
    const FolderEntry& entry = browser.listing->entries[browser.rows[row]];
    const bool is_folder = entry.kind == FileKind::folder;
    const ImU32 color = frame.palette.color(entry.is_broken ? Role::dim : Role::text);
    ImGui::PushID(static_cast<int>(row));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const float left = ImGui::GetCursorPosX();
    if (ImGui::Selectable("##row", row == browser.selected,
                          ImGuiSelectableFlags_SpanAllColumns
                              | ImGuiSelectableFlags_AllowDoubleClick)) {
        browser.selected = row;
        browser.wants_focus = true;
        if (saves(browser.wish) && !is_folder) set_typed(browser, entry.name);
        if (ImGui::IsMouseDoubleClicked(0)) open_row(frame.model, row);
    }
    if (entry.is_broken) tip(frame, "Leads nowhere, or cannot be read");
    ImGui::SameLine(0, 0);
    ImGui::SetCursorPosX(left + frame.px(4));
    text(frame.fonts.text, frame.palette.color(is_folder ? Role::accent : Role::dim),
         frame.fonts.icon(icon_of(entry.kind)));
    ImGui::SameLine(0, 0);
    ImGui::SetCursorPosX(left + frame.px(30));
    text(frame.fonts.text, color,
         shortened(frame.fonts.text, entry.shown, ImGui::GetContentRegionAvail().x));
    ImGui::TableNextColumn();
    if (!is_folder && !entry.is_broken)
        text(frame.fonts.text, frame.palette.color(Role::dim), size_words(entry.size));
    ImGui::TableNextColumn();
    text(frame.fonts.text, frame.palette.color(Role::dim), date_words(entry.modified));
    ImGui::PopID();
}

/// Takes over the order that the headings of the table show.
void take_order(FileBrowser& browser) {
    ImGuiTableSortSpecs* const specs = ImGui::TableGetSortSpecs();
    if (!specs || !specs->SpecsDirty) return;
    constexpr FileOrder orders[] = {FileOrder::name, FileOrder::largest, FileOrder::newest};
    browser.order = specs->SpecsCount > 0 ? orders[specs->Specs[0].ColumnIndex] : FileOrder::name;
    specs->SpecsDirty = false;
    update_rows(browser);
}

void draw_table(Frame& frame, float height) {
    FileBrowser& browser = frame.model.browser;
    const auto flags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_Sortable
                       | ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_NoSavedSettings;
    ImGui::PushStyleColor(ImGuiCol_TableHeaderBg, frame.palette.color(Role::raised));
    ImGui::PushStyleColor(ImGuiCol_TableBorderLight, frame.palette.color(Role::line, 0.5));
    const bool is_shown = ImGui::BeginTable("files", 3, flags, ImVec2(0, height));
    if (!is_shown) return ImGui::PopStyleColor(2);
    const auto once = ImGuiTableColumnFlags_NoSortDescending;
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch
                                        | ImGuiTableColumnFlags_DefaultSort | once);
    ImGui::TableSetupColumn("Size", ImGuiTableColumnFlags_WidthFixed | once, frame.px(74));
    ImGui::TableSetupColumn("Changed", ImGuiTableColumnFlags_WidthFixed | once, frame.px(130));
    ImGui::TableHeadersRow();
    take_order(browser);
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(browser.rows.size()));
    if (browser.wants_scroll && !browser.rows.empty())
        clipper.ForceDisplayRangeByIndices(static_cast<int>(browser.selected),
                                           static_cast<int>(browser.selected) + 1);
    while (clipper.Step()) {
        for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
            // A double click may have opened another folder.
            if (static_cast<size_t>(row) >= browser.rows.size()) break;
            draw_entry(frame, static_cast<size_t>(row));
            if (static_cast<size_t>(row) == browser.selected
                && std::exchange(browser.wants_scroll, false))
                ImGui::SetScrollHereY(0.5F);
        }
    }
    ImGui::EndTable();
    ImGui::PopStyleColor(2);
}

/// What is to be said about the list or the last choice.
std::pair<std::string, Role> status_of(const ViewModel& model) {
    const FileBrowser& browser = model.browser;
    const std::string& refusal = model.workspace.refusal;
    if (saves(browser.wish) && !refusal.empty()) return {refusal, Role::violation};
    if (!browser.error.empty()) return {browser.error, Role::violation};
    if (!browser.listing) return {"Reading the folder", Role::dim};
    if (!browser.listing->error.empty()) return {browser.listing->error, Role::violation};
    std::string words = counted(browser.rows.size(), "entry");
    if (browser.rows.size() != 1) words = fmt::format("{} entries", browser.rows.size());
    if (!browser.listing->is_whole) words += ", still reading";
    if (browser.listing->is_cut)
        words += fmt::format("; only the first {} of this folder are listed", most_entries);
    return {words, Role::dim};
}

void draw_end(Frame& frame) {
    ViewModel& model = frame.model;
    FileBrowser& browser = model.browser;
    const auto [words, role] = status_of(model);
    const std::string& refusal = model.workspace.refusal;
    const bool exists =
        saves(browser.wish)
        && (refusal.ends_with("already exists") || refusal.ends_with("since it was read"));
    const char* const verb = exists ? "Replace it" : verb_of(browser.wish);
    const ImGuiStyle& style = ImGui::GetStyle();
    const float buttons = ImGui::CalcTextSize(verb).x + ImGui::CalcTextSize("Cancel").x
                          + 4 * style.FramePadding.x + style.ItemSpacing.x;
    const float start = ImGui::GetCursorPosX();
    ImGui::PushTextWrapPos(start + ImGui::GetContentRegionAvail().x - buttons - frame.px(12));
    text(frame.fonts.small, frame.palette.color(role), words);
    ImGui::PopTextWrapPos();
    ImGui::SameLine(ImGui::GetContentRegionMax().x - buttons);
    if (ImGui::Button(verb)) {
        model.workspace.may_replace = exists;
        enter_typed(model);
    }
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) close_browser(model);
}

} // namespace

void claim_page_keys(bool claimed) {
    ImGuiIO& io = ImGui::GetIO();
    io.KeyMap[ImGuiKey_PageUp] = claimed ? -1 : key::page_up;
    io.KeyMap[ImGuiKey_PageDown] = claimed ? -1 : key::page_down;
}

void draw_file_browser(Frame& frame) {
    draw_field(frame);
    draw_folder_line(frame);
    const float height = ImGui::GetContentRegionAvail().y - frame.px(40);
    const float room = ImGui::GetContentRegionAvail().x;
    if (room > frame.px(620)) {
        draw_places(frame, frame.px(190), height);
        ImGui::SameLine();
    }
    draw_table(frame, height);
    draw_end(frame);
}

void draw_recent(Frame& frame, const RecentProgram& recent, float width) {
    ViewModel& model = frame.model;
    const bool is_missing = model.browser.missing.contains(recent.program);
    const std::filesystem::path path(recent.program);
    const float button = is_missing ? frame.px(28) : 0.0F;
    ImGui::PushID(recent.program.c_str());
    ImGui::PushStyleColor(ImGuiCol_Text, frame.palette.color(is_missing ? Role::dim : Role::text));
    const std::string name =
        shortened(frame.fonts.text, path.filename().generic_string(), width - button);
    if (ImGui::Selectable((name + "##recent").c_str(), false, 0, ImVec2(width - button, 0)))
        open_recent(model, recent);
    ImGui::PopStyleColor();
    tip(frame, recent.program + (is_missing ? "\nis not there any more" : "")
                   + (recent.setup.empty() ? "" : "\n" + recent.setup));
    if (is_missing) {
        ImGui::SameLine(0, frame.px(2));
        if (ImGui::SmallButton(frame.fonts.icon(Icon::close)))
            model.unwanted_recent = recent.program;
        tip(frame, "Take it off the list");
    }
    ImGui::PopID();
}

void draw_message(const Frame& frame, const Area& area) {
    if (frame.now >= frame.model.message_until || frame.model.message.empty()) return;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ImFont* const font = frame.fonts.text;
    const float x = frame.px(12), y = frame.px(7), room = area.width - frame.px(60);
    const char* const words = frame.model.message.c_str();
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e9F, room, words);
    const ImVec2 corner(area.x + frame.px(18), area.y + area.height - size.y - frame.px(32));
    list.AddRectFilled(corner, {corner.x + size.x + 2 * x, corner.y + size.y + 2 * y},
                       frame.palette.color(Role::raised), frame.px(5));
    list.AddText(font, font->FontSize, {corner.x + x, corner.y + y},
                 frame.palette.color(Role::text), words, nullptr, room);
}

} // namespace app::viewer
