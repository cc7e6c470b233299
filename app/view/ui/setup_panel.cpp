#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/check/setup_sheet.h"
#include "app/setup/holder_library.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "app/view/model/placing.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "core/base/units.h"
#include "core/dbm/solid.h"

namespace app::viewer {
namespace {

using render::Role;
using Kind = SetupItem::Kind;

constexpr double label_width = 108.0, field_width = 74.0;

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

/// Draws a dot for what is stated, and a ring for what is not.
void draw_mark(const Frame& frame, ImDrawList& list, ImVec2 middle, SetupSource source) {
    const ImU32 color = frame.palette.color(role_of(source));
    if (source == SetupSource::stated)
        list.AddCircleFilled(middle, frame.px(4), color);
    else
        list.AddCircle(middle, frame.px(3.5), color, 0, frame.px(1.6));
}

/// The mark of a value, as an item on the same line.
void source_mark(Frame& frame, SetupSource source) {
    ImGui::SameLine(0, frame.px(7));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = ImGui::GetFrameHeight(), width = frame.px(10);
    ImGui::Dummy(ImVec2(width, height));
    tip(frame, meaning_of(source));
    draw_mark(frame, *ImGui::GetWindowDrawList(), {at.x + 0.5F * width, at.y + 0.5F * height},
              source);
}

/// Draws the label of a row; its field follows on the same line.
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

/// A box with another size. What the zero is at stays: a side, or the middle; else the lower side.
core::Aabb resized(const core::Aabb& box, const core::Vec3& size) {
    constexpr double same = 1e-9; // mm
    core::Aabb other;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = box.min[axis], high = box.max[axis];
        const bool is_middle = std::abs(low + high) < same;
        const double from = std::abs(high) < same ? -size[axis]
                            : is_middle           ? -0.5 * size[axis]
                                                  : low;
        other.min[axis] = from;
        other.max[axis] = from + size[axis];
    }
    return other;
}

/// A box or cylinder (kind 0 or 1) of the same size as a stock.
core::Solid reshaped_stock(const core::Solid& stock, int kind) {
    const core::Aabb box = core::bounds(stock);
    const core::Vec3 size = box.size(), middle = box.center();
    if (kind == 0) return {core::SolidBox{box}, stock.tolerance};
    return {core::SolidCylinder{
                {middle.x, middle.y, box.min.z}, 0.5 * std::max(size.x, size.y), size.z, 2},
            stock.tolerance};
}

} // namespace

struct SetupPanel::State {
    void draw(Frame& frame);

private:
    void draw_head(Frame& frame);
    void draw_banners(Frame& frame);
    void draw_tree(Frame& frame, const std::vector<SetupRow>& rows);
    void draw_row(Frame& frame, const SetupRow& row, int index);
    void take_tree_keys(Frame& frame);
    void draw_add_menu(Frame& frame);
    void draw_item(Frame& frame);
    void draw_item_head(Frame& frame, const std::string& title, bool can_copy, bool can_delete);
    void draw_machine(Frame& frame);
    void draw_offset(Frame& frame, const SheetOffset& offset);
    void draw_stock(Frame& frame);
    void draw_fixture(Frame& frame, const StatedBody& body);
    void draw_part(Frame& frame, const StatedBody& body);
    void draw_shape(Frame& frame, const StatedBody& body, const BodyPath& path, bool has_cylinder);
    void draw_pose(Frame& frame, const StatedBody& body, const BodyPath& path);
    void draw_placing(Frame& frame, const std::string& body);
    void draw_face_lists(Frame& frame, const std::string& body);
    void draw_zero(Frame& frame, const std::string& offset);
    void draw_tool(Frame& frame, const SheetTool& shown);
    void draw_tool_sizes(Frame& frame, const SheetTool& shown);
    void draw_holder(Frame& frame, const SheetTool& shown);
    void draw_library(Frame& frame, core::ToolNumber number);
    void draw_allowance(Frame& frame);

    /// A field for a number. Its new value when the field is left after a change.
    std::optional<double> number(Frame& frame, const char* id, double value, const char* format,
                                 double width = field_width);
    /// As number(), for a length in the unit of the window.
    std::optional<double> length(Frame& frame, const char* id, double mm,
                                 double width = field_width);
    std::optional<core::Vec3> vector(Frame& frame, const char* id, const core::Vec3& mm,
                                     bool is_angle = false);
    std::optional<std::string> words(Frame& frame, const char* id, const std::string& value,
                                     const char* hint, double width);

    /// What is typed into a field and has not taken effect yet.
    struct Typed {
        ImGuiID id = 0;
        double number = 0.0;
        std::string words;
    };
    std::optional<Typed> typed_;
    SetupItem focused_;       // of the tree, by the keyboard
    bool wants_name_ = false; // the name of the fixture gets the keyboard
    // of the lists of faces
    std::string listed_body_, other_body_;
    size_t own_face_ = 0, other_face_ = 0;
    int zero_[3] = {0, 0, 2}; // corner of the stock: least, middle, greatest
};

std::optional<double> SetupPanel::State::number(Frame& frame, const char* id, double value,
                                                const char* format, double width) {
    const ImGuiID key = ImGui::GetID(id);
    double shown = typed_ && typed_->id == key ? typed_->number : value;
    ImGui::SetNextItemWidth(frame.px(width));
    if (ImGui::InputDouble(id, &shown, 0.0, 0.0, format)) typed_ = Typed{key, shown, {}};
    if (!ImGui::IsItemDeactivatedAfterEdit()) return {};
    const auto typed = std::exchange(typed_, std::nullopt);
    if (!typed || typed->id != key || typed->number == value) return {};
    return typed->number;
}

std::optional<double> SetupPanel::State::length(Frame& frame, const char* id, double mm,
                                                double width) {
    const bool inch = frame.model.settings.inch;
    const auto typed =
        number(frame, id, inch ? mm / core::mm_per_inch : mm, inch ? "%.5g" : "%.6g", width);
    if (!typed) return {};
    return inch ? *typed * core::mm_per_inch : *typed;
}

std::optional<core::Vec3> SetupPanel::State::vector(Frame& frame, const char* id,
                                                    const core::Vec3& mm, bool is_angle) {
    std::optional<core::Vec3> changed;
    ImGui::PushID(id);
    constexpr const char* axes[] = {"##X", "##Y", "##Z"};
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) ImGui::SameLine(0, frame.px(5));
        const auto value = is_angle ? number(frame, axes[axis], mm[axis], "%.6g", 66.0)
                                    : length(frame, axes[axis], mm[axis], 66.0);
        if (!value) continue;
        changed = changed.value_or(mm);
        (*changed)[axis] = *value;
    }
    ImGui::PopID();
    return changed;
}

std::optional<std::string> SetupPanel::State::words(Frame& frame, const char* id,
                                                    const std::string& value, const char* hint,
                                                    double width) {
    const ImGuiID key = ImGui::GetID(id);
    std::string shown = typed_ && typed_->id == key ? typed_->words : value;
    ImGui::SetNextItemWidth(frame.px(width));
    if (ImGui::InputTextWithHint(id, hint, &shown)) typed_ = Typed{key, 0.0, shown};
    if (!ImGui::IsItemDeactivatedAfterEdit()) return {};
    const auto typed = std::exchange(typed_, std::nullopt);
    if (!typed || typed->id != key || typed->words == value) return {};
    return typed->words;
}

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

void SetupPanel::State::draw_banners(Frame& frame) {
    ViewModel& model = frame.model;
    Workspace& workspace = model.workspace;
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
    if (workspace.on_disk) {
        draw_banner(frame, Role::near,
                    "The file has been changed by another program, and there are edits here.");
        if (ImGui::SmallButton("Load the file"))
            take_file(model, *std::exchange(workspace.on_disk, std::nullopt));
        ImGui::SameLine();
        if (workspace.on_disk && ImGui::SmallButton("Keep my edits"))
            workspace.document.keep_over(*std::exchange(workspace.on_disk, std::nullopt));
    }
    if (workspace.found) {
        draw_banner(frame, Role::near,
                    "There are edits from an earlier session that were not "
                    "saved.");
        if (ImGui::SmallButton("Restore them")) {
            const std::string found = *std::exchange(workspace.found, std::nullopt);
            edit_setup(model, "Restore unsaved edits", [&](const std::string&) { return found; });
        }
        ImGui::SameLine();
        if (workspace.found && ImGui::SmallButton("Discard them")) {
            workspace.found.reset();
            workspace.forgets_found = true;
        }
    }
}

void SetupPanel::State::draw_row(Frame& frame, const SetupRow& row, int index) {
    Workspace& workspace = frame.model.workspace;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const Theme& palette = frame.palette;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = frame.px(20);
    const float text_y = at.y + 0.5F * (height - frame.fonts.text->FontSize);
    ImGui::PushID(index);
    if (row.item.kind == Kind::none) {
        ImGui::Dummy(ImVec2(width, height));
        list.AddText(frame.fonts.small, frame.fonts.small->FontSize,
                     {at.x + frame.px(2), text_y + 2}, palette.color(Role::dim), row.title.c_str());
    } else {
        const bool is_selected = workspace.selected == row.item;
        if (is_selected && std::exchange(workspace.wants_focus, false))
            ImGui::SetKeyboardFocusHere();
        const bool pressed = ImGui::Selectable("##row", is_selected, 0, ImVec2(width, height));
        const bool got_focus = ImGui::IsItemFocused() && focused_ != row.item;
        if (got_focus) focused_ = row.item;
        if (pressed || got_focus) workspace.selected = row.item;
        if (row.is_missing || row.has_error)
            list.AddText(frame.fonts.small, frame.fonts.small->FontSize,
                         {at.x + frame.px(2), text_y + 1},
                         palette.color(row.has_error ? Role::violation : Role::near),
                         frame.fonts.icon(Icon::warning));
        else
            draw_mark(frame, list, {at.x + frame.px(8), at.y + 0.5F * height}, row.source);
        list.AddText(frame.fonts.text, frame.fonts.text->FontSize, {at.x + frame.px(20), text_y},
                     palette.color(Role::text), row.title.c_str());
    }
    const float title =
        frame.fonts.text->CalcTextSizeA(frame.fonts.text->FontSize, 1e9F, 0.0F, row.title.c_str())
            .x;
    const std::string detail =
        shortened(frame.fonts.small, row.detail, width - title - frame.px(36));
    const float room =
        frame.fonts.small->CalcTextSizeA(frame.fonts.small->FontSize, 1e9F, 0.0F, detail.c_str()).x;
    list.AddText(frame.fonts.small, frame.fonts.small->FontSize,
                 {at.x + width - room - frame.px(6), text_y + 1},
                 palette.ink(row.is_missing ? Role::near : Role::dim), detail.c_str());
    ImGui::PopID();
}

void SetupPanel::State::take_tree_keys(Frame& frame) {
    if (!ImGui::IsWindowFocused() || ImGui::GetIO().WantTextInput) return;
    const auto is_pressed = [](int key) { return ImGui::IsKeyPressed(key, false); };
    if (is_pressed(key::remove)) delete_selected(frame.model);
    if (is_pressed(key::function(2)))
        wants_name_ = frame.model.workspace.selected.kind == Kind::fixture;
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
    if (ImGui::Button("Add \xE2\x80\xA6")) ImGui::OpenPopup("add");
    tip(frame, "Add a fixture, the part, a tool library, a work offset, or state that there are no "
               "fixtures");
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.px(10), frame.px(8)));
    if (ImGui::BeginPopup("add")) {
        if (ImGui::MenuItem("Fixture: block")) add_box(model);
        if (ImGui::MenuItem("Fixture: mesh file \xE2\x80\xA6")) browse(model, FileWish::mesh);
        if (ImGui::MenuItem("Finished part: mesh file \xE2\x80\xA6")) browse(model, FileWish::part);
        if (ImGui::MenuItem("Tool library \xE2\x80\xA6")) browse(model, FileWish::tools);
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

void SetupPanel::State::draw_item_head(Frame& frame, const std::string& title, bool can_copy,
                                       bool can_delete) {
    ViewModel& model = frame.model;
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.strong, frame.palette.color(Role::text), title);
    const bool states = can_state(model, model.workspace.selected);
    float right = ImGui::GetContentRegionMax().x;
    const auto button = [&](const char* word, const std::string& words) {
        right -= ImGui::CalcTextSize(word).x + 2 * ImGui::GetStyle().FramePadding.x;
        ImGui::SameLine(right);
        right -= frame.px(5);
        const bool pressed = ImGui::SmallButton(word);
        tip(frame, words);
        return pressed;
    };
    if (can_delete && button("Delete", "Remove it from the set-up (Delete)"))
        delete_selected(model);
    if (can_copy && button("Copy", tip_of(Command::copy_item))) copy_selected(model);
    if (states && button("State", "The assumed values are right: write them into the set-up"))
        state_item(model, model.workspace.selected);
}

void SetupPanel::State::draw_machine(Frame& frame) {
    ViewModel& model = frame.model;
    const StatedSetup& stated = *model.workspace.stated;
    draw_item_head(frame, "Machine", false, false);
    field_name(frame, "File");
    const auto file =
        words(frame, "##file", stated.machine_file, "MACHINE.toml, .machine or .mch", 200);
    if (ImGui::Button("Browse \xE2\x80\xA6")) browse(model, FileWish::machine);
    if (file) use_machine(model, *file);
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                 model.program->sheet->has_machine
                     ? "Its axes, limits and bodies are in that file."
                     : "Without a machine, axis limits are not checked, and X, Y and Z move the "
                       "tool.");
}

void SetupPanel::State::draw_offset(Frame& frame, const SheetOffset& offset) {
    ViewModel& model = frame.model;
    draw_item_head(frame, "Work offset " + offset.name, false,
                   model.workspace.stated->has_offset(offset.name));
    field_name(frame, "X Y Z");
    const auto origin = vector(frame, "origin", offset.origin);
    source_mark(frame, offset.source);
    if (origin)
        edit_setup(model, "Change " + offset.name,
                   [&](const std::string& t) { return with_offset(t, offset.name, *origin); });
    draw_zero(frame, offset.name);
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                 offset.is_used ? "Machine coordinates of program zero, as on the control's page."
                                : "The program does not use it.");
}

void SetupPanel::State::draw_stock(Frame& frame) {
    ViewModel& model = frame.model;
    const SetupSheet& sheet = *model.program->sheet;
    draw_item_head(frame, "Stock", false, model.workspace.stated->stock.has_value());
    const auto restate = [&](const core::Solid& stock) {
        edit_setup(model, "Change the stock",
                   [&](const std::string& t) { return with_stock(t, stock, sheet.frame); });
    };
    const auto kept = model.workspace.stated;
    const auto& stated = kept->stock;
    const bool is_mesh = stated && (!stated->mesh.empty() || !stated->model.empty());
    const auto kind = is_mesh ? 2 : static_cast<int>(sheet.stock.shape.index());
    field_name(frame, "Shape");
    constexpr const char* kinds[] = {"box", "cylinder", "from a file"};
    ImGui::SetNextItemWidth(frame.px(140));
    if (ImGui::BeginCombo("##kind", kinds[std::min(kind, 2)])) {
        for (int i = 0; i < 2; ++i)
            if (ImGui::Selectable(kinds[i], i == kind) && i != kind)
                restate(reshaped_stock(sheet.stock, i));
        ImGui::EndCombo();
    }
    source_mark(frame, sheet.stock_source);
    core::Solid stock = sheet.stock;
    if (auto* box = std::get_if<core::SolidBox>(&stock.shape); box && !is_mesh) {
        field_name(frame, "Size X Y Z");
        if (const auto size = vector(frame, "size", box->box.size())) {
            box->box = resized(box->box, *size);
            restate(stock);
        }
        field_name(frame, "Lower corner");
        if (const auto corner = vector(frame, "corner", box->box.min)) {
            const core::Vec3 size = box->box.size();
            box->box = {*corner, *corner + size};
            restate(stock);
        }
    } else if (auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) {
        field_name(frame, "Diameter");
        if (const auto diameter = length(frame, "##diameter", 2.0 * round->radius)) {
            round->radius = 0.5 * *diameter;
            restate(stock);
        }
        field_name(frame, "Length");
        if (const auto height = length(frame, "##height", round->height)) {
            round->height = *height;
            restate(stock);
        }
        ImGui::SameLine();
        ImGui::SetNextItemWidth(frame.px(84));
        int axis = round->axis;
        if (ImGui::Combo("##axis", &axis, "along X\0along Y\0along Z\0")) {
            round->axis = axis;
            restate(stock);
        }
        field_name(frame, "Base centre");
        if (const auto base = vector(frame, "base", round->base)) {
            round->base = *base;
            restate(stock);
        }
    } else if (stated) {
        field_name(frame, "File");
        const char* key = stated->mesh.empty() ? "model" : "mesh";
        if (const auto file = words(frame, "##file", stated->mesh + stated->model, "", 200))
            edit_setup(model, "Change the stock", [&](const std::string& t) {
                return toml_with_value(t, {"stock", key}, toml_text(path_in_setup(model, *file)));
            });
        draw_pose(frame, *stated, "stock");
    }
    draw_placing(frame, stock_name);
    std::string why = "In " + sheet.frame + ".";
    if (sheet.stock_source == SetupSource::assumed && !sheet.stock_why.empty())
        why += " Assumed: " + sheet.stock_why + ".";
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim), why);
}

void SetupPanel::State::draw_shape(Frame& frame, const StatedBody& body, const BodyPath& path,
                                   bool has_cylinder) {
    ViewModel& model = frame.model;
    const std::string title = "Change " + (body.name.empty() ? "the part" : body.name);
    const auto change = [&](const SetupDocument::Edit& edit) { edit_setup(model, title, edit); };
    const int kind = body.box ? 0 : body.cylinder ? 1 : 2;
    constexpr const char* kinds[] = {"box", "cylinder", "mesh"};
    field_name(frame, "Shape");
    ImGui::SetNextItemWidth(frame.px(140));
    if (ImGui::BeginCombo("##kind", kinds[kind])) {
        if (ImGui::Selectable("box", kind == 0) && kind != 0)
            change([&](const std::string& t) {
                return with_box(t, path, {core::Vec3(0.0), core::Vec3(50.0, 25.0, 25.0)});
            });
        if (has_cylinder && ImGui::Selectable("cylinder", kind == 1) && kind != 1)
            change([&](const std::string& t) { return with_cylinder(t, path, 12.5, 25.0, 2); });
        ImGui::EndCombo();
    }
    if (body.box) {
        field_name(frame, "Size X Y Z");
        if (const auto size = vector(frame, "size", body.box->size()))
            change([&](const std::string& t) {
                return with_box(t, path, {body.box->min, body.box->min + *size});
            });
    } else if (body.cylinder) {
        StatedBody::Cylinder round = *body.cylinder;
        const auto rewrite = [&] {
            change([&](const std::string& t) {
                return with_cylinder(t, path, round.radius, round.height, round.axis);
            });
        };
        field_name(frame, "Diameter");
        if (const auto diameter = length(frame, "##diameter", 2.0 * round.radius)) {
            round.radius = 0.5 * *diameter;
            rewrite();
        }
        field_name(frame, "Length");
        if (const auto height = length(frame, "##height", round.height)) {
            round.height = *height;
            rewrite();
        }
        ImGui::SameLine();
        ImGui::SetNextItemWidth(frame.px(84));
        if (ImGui::Combo("##axis", &round.axis, "along X\0along Y\0along Z\0")) rewrite();
    } else {
        field_name(frame, "Mesh");
        if (const auto file = words(frame, "##mesh", body.mesh, "FILE.stl", 200))
            change([&](const std::string& t) {
                return with_mesh(t, path, path_in_setup(model, *file));
            });
    }
}

void SetupPanel::State::draw_pose(Frame& frame, const StatedBody& body, const BodyPath& path) {
    ViewModel& model = frame.model;
    const std::string name = body.name.empty() ? path.key() : body.name;
    field_name(frame, "At X Y Z");
    if (const auto at = vector(frame, "at", body.at))
        edit_setup(model, "Move " + name,
                   [&](const std::string& t) { return with_pose(t, path, *at, body.rotate_deg); });
    field_name(frame, "Rotation \xC2\xB0");
    if (const auto turn = vector(frame, "turn", body.rotate_deg, true))
        edit_setup(model, "Turn " + name,
                   [&](const std::string& t) { return with_pose(t, path, body.at, *turn); });
    field_name(frame, "In");
    ImGui::SetNextItemWidth(frame.px(140));
    if (!ImGui::BeginCombo("##frame", body.frame.c_str())) return;
    for (const auto& [frame_name, pose] : model.program->sheet->frames) {
        if (frame_name == body.name || (path.key() == "stock" && frame_name == "stock")) continue;
        if (ImGui::Selectable(frame_name.c_str(), frame_name == body.frame)
            && frame_name != body.frame)
            change_frame(model, name, frame_name);
    }
    ImGui::EndCombo();
}

/// Draws the list of the faces of a body; true if another one was chosen.
bool face_list(Frame& frame, const char* id, const std::vector<SceneFace>& faces, size_t& chosen) {
    chosen = faces.empty() ? 0 : std::min(chosen, faces.size() - 1);
    bool is_changed = false;
    ImGui::SetNextItemWidth(frame.px(208));
    if (!ImGui::BeginCombo(id, faces.empty() ? "" : faces[chosen].name.c_str())) return false;
    for (size_t i = 0; i < faces.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable(faces[i].name.c_str(), i == chosen)) {
            chosen = i;
            is_changed = true;
        }
        ImGui::PopID();
    }
    ImGui::EndCombo();
    return is_changed;
}

void SetupPanel::State::draw_face_lists(Frame& frame, const std::string& body) {
    ViewModel& model = frame.model;
    if (listed_body_ != body) {
        listed_body_ = body;
        own_face_ = other_face_ = 0;
        other_body_ = body == stock_name ? "" : stock_name;
    }
    const std::vector<SceneFace> own = faces_of(model, body);
    field_name(frame, "Its face");
    face_list(frame, "##own", own, own_face_);
    field_name(frame, "To body");
    ImGui::SetNextItemWidth(frame.px(208));
    if (ImGui::BeginCombo("##other body", other_body_.c_str())) {
        for (const std::string& name : bodies_to_meet(model))
            if (name != body && ImGui::Selectable(name.c_str(), name == other_body_)) {
                other_body_ = name;
                other_face_ = 0;
            }
        ImGui::EndCombo();
    }
    const std::vector<SceneFace> other = faces_of(model, other_body_);
    field_name(frame, "To face");
    face_list(frame, "##other", other, other_face_);
    field_name(frame, "");
    ImGui::BeginDisabled(own.empty() || other.empty());
    if (ImGui::Button("Place"))
        put_face_to_face(model, body, own[own_face_].plane, other[other_face_].plane);
    ImGui::EndDisabled();
}

void SetupPanel::State::draw_placing(Frame& frame, const std::string& body) {
    ViewModel& model = frame.model;
    Placing& placing = model.placing;
    if (!can_move(model, body)) return;
    const auto begin = [&](PickGoal goal) {
        placing.body = body;
        begin_picking(model, goal);
    };
    field_name(frame, "Place");
    if (ImGui::Button("Face to face")) begin(PickGoal::own_face);
    tip(frame, "Click one of its faces, then the face to put it to");
    ImGui::SameLine();
    if (ImGui::Button("Centre")) begin(PickGoal::between_first);
    tip(frame, "Click two parallel faces of other bodies: it comes into the middle between them");
    field_name(frame, "");
    ImGui::Checkbox("centred", &placing.centred);
    tip(frame, "Face to face: also bring the middles of both faces together");
    ImGui::SameLine();
    ImGui::Checkbox("flush", &placing.flush);
    tip(frame, "Face to face: the faces look the same way, in one plane");
    field_name(frame, "Slide to touch");
    constexpr std::pair<const char*, core::Vec3> ways[] = {
        {"\xE2\x88\x92X", {-1, 0, 0}}, {"+X", {1, 0, 0}},
        {"\xE2\x88\x92Y", {0, -1, 0}}, {"+Y", {0, 1, 0}},
        {"\xE2\x88\x92Z", {0, 0, -1}}, {"+Z", {0, 0, 1}}};
    for (const auto& [name, direction] : ways) {
        if (direction != ways[0].second) ImGui::SameLine(0, frame.px(3));
        if (ImGui::SmallButton(name)) slide_to_contact(model, body, direction);
        tip(frame, "Slide it until it touches another body: close a jaw, put it down");
    }
    if (ImGui::TreeNodeEx("Choose faces from lists", ImGuiTreeNodeFlags_NoTreePushOnOpen))
        draw_face_lists(frame, body);
}

void SetupPanel::State::draw_zero(Frame& frame, const std::string& offset) {
    ViewModel& model = frame.model;
    field_name(frame, "Set the zero");
    if (ImGui::Button("By clicking \xE2\x80\xA6")) {
        model.placing.offset = offset;
        model.placing.body.clear();
        begin_picking(model, PickGoal::zero);
    }
    tip(frame,
        "Click a corner, edge, face, bore or boss of the stock or a fixture, as a probe would");
    field_name(frame, "or at the stock");
    constexpr const char* sides[] = {"left\0middle\0right\0", "front\0middle\0back\0",
                                     "bottom\0middle\0top\0"};
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) ImGui::SameLine(0, frame.px(4));
        ImGui::PushID(axis);
        ImGui::SetNextItemWidth(frame.px(76));
        ImGui::Combo("##side", &zero_[axis], sides[axis]);
        ImGui::PopID();
    }
    field_name(frame, "");
    if (!ImGui::Button("Set the zero there")) return;
    const core::Aabb box = bounds_of_body(model, stock_name);
    if (box.empty()) return;
    core::FeaturePick corner{.kind = core::FeatureKind::corner};
    for (int axis = 0; axis < 3; ++axis)
        corner.point[axis] = zero_[axis] == 0   ? box.min[axis]
                             : zero_[axis] == 1 ? box.center()[axis]
                                                : box.max[axis];
    set_zero(model, offset, corner);
}

void SetupPanel::State::draw_fixture(Frame& frame, const StatedBody& body) {
    ViewModel& model = frame.model;
    const auto path = path_of_fixture(model.workspace.document.text(), body.name);
    if (!path) return;
    draw_item_head(frame, "Fixture", true, true);
    field_name(frame, "Name");
    if (std::exchange(wants_name_, false)) ImGui::SetKeyboardFocusHere();
    if (const auto name = words(frame, "##name", body.name, "name", 200))
        rename_selected(model, *name);
    draw_shape(frame, body, *path, true);
    draw_pose(frame, body, *path);
    draw_placing(frame, body.name);
    bool expendable = body.expendable;
    field_name(frame, "");
    if (ImGui::Checkbox("may be cut while feeding", &expendable))
        edit_setup(model, "Change " + body.name, [&](const std::string& t) {
            return expendable ? toml_with_value(t, *path / "expendable", "true")
                              : toml_without(t, *path / "expendable");
        });
}

void SetupPanel::State::draw_part(Frame& frame, const StatedBody& body) {
    draw_item_head(frame, "Part", false, true);
    draw_shape(frame, body, "part", false);
    draw_pose(frame, body, "part");
    field_name(frame, "Tolerance");
    if (const auto tolerance = length(frame, "##tolerance", body.tolerance.value_or(0.1)))
        edit_setup(frame.model, "Change the tolerance", [&](const std::string& t) {
            return toml_with_value(t, {"part", "tolerance"}, setup_number(*tolerance));
        });
}

void SetupPanel::State::draw_holder(Frame& frame, const SheetTool& shown) {
    ViewModel& model = frame.model;
    const core::ToolNumber number = shown.tool.number;
    const std::string known = holder_name(shown.tool);
    const std::string now = !known.empty()              ? known
                            : shown.tool.holder.empty() ? "none"
                                                        : "as described";
    const auto set = [&](const std::optional<std::string>& value) {
        edit_setup(
            model, fmt::format("Change the holder of T{}", core::value_of(number)),
            [&](const std::string& t) { return with_tool_value(t, number, "holder", value); });
    };
    field_name(frame, "Holder");
    ImGui::SetNextItemWidth(frame.px(190));
    if (ImGui::BeginCombo("##holder", now.c_str())) {
        if (ImGui::Selectable("none", shown.tool.holder.empty())) set(std::nullopt);
        for (const auto& [name, cones] : shipped_holder_library())
            if (ImGui::Selectable(name.c_str(), name == now)) set(toml_text(name));
        ImGui::EndCombo();
    }
    source_mark(frame, shown.source_of("holder"));
}

/// The tools of the library, to exchange a tool for one of them.
void SetupPanel::State::draw_library(Frame& frame, core::ToolNumber number) {
    ViewModel& model = frame.model;
    const SetupSheet& sheet = *model.program->sheet;
    if (sheet.library.empty()) return;
    field_name(frame, "Exchange for");
    ImGui::SetNextItemWidth(frame.px(190));
    if (!ImGui::BeginCombo("##library", "a tool of the library")) return;
    for (const core::ToolDescription& tool : sheet.library) {
        ImGui::PushID(core::value_of(tool.number));
        const std::string label =
            fmt::format("{}  {} {}  {}", core::value_of(tool.number), core::name_of(tool.shape),
                        length_text(model, tool.diameter), tool.name);
        if (ImGui::Selectable(label.c_str())) take_library_tool(model, number, tool);
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

void SetupPanel::State::draw_tool_sizes(Frame& frame, const SheetTool& shown) {
    ViewModel& model = frame.model;
    const core::ToolNumber number = shown.tool.number;
    const bool has_cones = !shown.tool.shank.empty();
    for (const core::ToolSize& field : fields_of(shown.tool.shape)) {
        const std::string key = field.key;
        if (has_cones && (key == "stick_out" || key == "shank_diameter")) continue;
        const bool is_angle = std::string_view(field.unit) == "deg";
        const double value = field.of(shown.tool).value_or(0.0);
        ImGui::PushID(field.key);
        field_name(frame, field.name);
        const auto typed = is_angle ? this->number(frame, "##size", value, "%.6g")
                                    : length(frame, "##size", value);
        unit_label(frame, is_angle ? "\xC2\xB0" : length_unit(model));
        source_mark(frame, shown.source_of(key));
        if (typed)
            edit_setup(model, fmt::format("Change T{}", core::value_of(number)),
                       [&](const std::string& t) {
                           return with_tool_value(
                               t, number, key,
                               *typed == 0.0 ? std::nullopt : std::optional(setup_number(*typed)));
                       });
        ImGui::PopID();
    }
    if (has_cones)
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     "Its shank is described by cones, which determine the stick-out.");
}

void SetupPanel::State::draw_tool(Frame& frame, const SheetTool& shown) {
    ViewModel& model = frame.model;
    const core::ToolNumber number = shown.tool.number;
    const bool is_stated = model.workspace.stated->has_tool(number);
    ImGui::PushID(core::value_of(number));
    draw_item_head(frame, fmt::format("Tool {}", core::value_of(number)), false, is_stated);
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
    if (!shown.why.empty())
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim), "Assumed: " + shown.why);
    ImGui::PopID();
}

void SetupPanel::State::draw_allowance(Frame& frame) {
    ViewModel& model = frame.model;
    const SetupSheet& sheet = *model.program->sheet;
    draw_item_head(frame, "Minimum clearance", false, sheet.allowance.has_value());
    field_name(frame, "All pairs");
    if (const auto distance = length(frame, "##allowance", sheet.allowance.value_or(0.0)))
        edit_setup(model, "Change the minimum clearance",
                   [&](const std::string& t) { return with_allowance(t, *distance); });
    unit_label(frame, length_unit(model));
    source_mark(frame, sheet.allowance ? SetupSource::stated : SetupSource::usual);
    if (!sheet.allowance)
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     fmt::format("Default: {0} {2} between holder and stock, {1} {2} to fixtures "
                                 "and machine.",
                                 length_text(model, 1.0), length_text(model, 2.0),
                                 length_unit(model)));
}

void SetupPanel::State::draw_item(Frame& frame) {
    ViewModel& model = frame.model;
    const SetupItem selected = model.workspace.selected;
    const SetupSheet& sheet = *model.program->sheet;
    const auto kept = model.workspace.stated; // edits replace it
    const StatedSetup& stated = *kept;
    switch (selected.kind) {
    case Kind::machine:
        return draw_machine(frame);
    case Kind::offset:
        if (const SheetOffset* offset = sheet.offset(selected.name)) draw_offset(frame, *offset);
        return;
    case Kind::stock:
        return draw_stock(frame);
    case Kind::fixture:
        if (const StatedBody* body = stated.fixture(selected.name)) draw_fixture(frame, *body);
        return;
    case Kind::part:
        if (stated.part) draw_part(frame, *stated.part);
        return;
    case Kind::tool:
        if (const SheetTool* tool = sheet.tool(selected.tool)) draw_tool(frame, *tool);
        return;
    case Kind::allowance:
        return draw_allowance(frame);
    case Kind::none:
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     "Select something in the list or click it in the view.");
    }
}

void SetupPanel::State::draw(Frame& frame) {
    ViewModel& model = frame.model;
    draw_list_tabs(frame);
    ImGui::Dummy(ImVec2(0, frame.px(3)));
    draw_head(frame);
    draw_banners(frame);
    if (!model.program || !model.program->sheet) {
        text(frame.fonts.text, frame.palette.color(Role::dim),
             "The set-up is being read \xE2\x80\xA6");
        return;
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
    ImGui::BeginChild("item", ImVec2(0, 0), false, ImGuiWindowFlags_NavFlattened);
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame.px(7), frame.px(2.5)));
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(frame.px(6), frame.px(4)));
    draw_item(frame);
    ImGui::PopStyleVar(2);
    ImGui::EndChild();
    model.workspace.has_keys = ImGui::IsWindowFocused(ImGuiFocusedFlags_ChildWindows);
    if (std::exchange(model.workspace.wants_focus, false)) ImGui::SetWindowFocus();
}

SetupPanel::SetupPanel() : state_(std::make_unique<State>()) {}

SetupPanel::~SetupPanel() = default;

void SetupPanel::draw(Frame& frame, const Area&) { state_->draw(frame); }

} // namespace app::viewer
