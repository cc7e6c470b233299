#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/check/setup_sheet.h"
#include "app/setup/holder_library.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "core/base/units.h"

namespace app::viewer {
namespace {

using render::Role;

/// An input field for a length in the unit of the window. True if it was changed; an untouched
/// value keeps every bit.
bool length_field(const Frame& frame, const char* id, double& mm);

/// A small mark for the source of a value. Values entered by the user are highlighted.
void source_mark(Frame& frame, SetupSource source, bool is_in_heading = false);

/// The error of the field above, if any.
void field_refusal(Frame& frame, const std::vector<EditRefusal>& refused,
                   std::optional<core::ToolNumber> tool, std::string_view key);

/// Draws the stock: its shape, corner and size, and their source.
void draw_stock_fields(Frame& frame, const SetupSheet& shown, SetupSheet& wanted,
                       const std::vector<EditRefusal>& refused);

/// Draws the general allowance.
void draw_allowance_field(Frame& frame, const SetupSheet& shown, SetupSheet& wanted,
                          const std::vector<EditRefusal>& refused);

/// Draws the label of a row; its field follows on the same line.
void field_name(Frame& frame, const std::string& name, double width = 150.0);

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

/// Draws the choice of the holder: none, one of the built-in library, or the one described.
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

/// Draws a size of the tool. Angles are in degrees for both units of the window.
void draw_size(Frame& frame, const core::ToolSize& field, core::ToolDescription& tool) {
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
    text(frame.fonts.small, frame.palette.color(Role::dim),
         is_angle ? "\xC2\xB0" : length_unit(frame.model));
}

std::string label_of(const Frame& frame, const core::ToolDescription& tool) {
    return fmt::format("T{}  {} {}", core::value_of(tool.number), core::name_of(tool.shape),
                       length_text(frame.model, tool.diameter));
}

} // namespace

struct SetupPopup::State {
    void draw(Frame& frame);

    void begin(const std::shared_ptr<const SetupSheet>& sheet);
    void draw_tools(Frame& frame);
    void draw_tool(Frame& frame, size_t index);
    void draw_buttons(Frame& frame);
    void draw_saving(Frame& frame);
    /// The edits, if all of them are valid; otherwise empty, and the errors are shown.
    std::optional<SetupEdits> checked_edits(const ViewModel& model);

    std::shared_ptr<const SetupSheet> shown_; // the sheet that `wanted_` was copied from
    SetupSheet wanted_;
    std::vector<EditRefusal> refused_;
    size_t tool_ = 0;
    bool is_saving_ = false, asks_to_replace_ = false;
    std::string path_, refusal_; // of the save dialog
};

void SetupPopup::State::begin(const std::shared_ptr<const SetupSheet>& sheet) {
    shown_ = sheet;
    wanted_ = *sheet;
    refused_.clear();
    refusal_.clear();
    is_saving_ = asks_to_replace_ = false;
    tool_ = std::min(tool_, sheet->tools.empty() ? 0 : sheet->tools.size() - 1);
}

std::optional<SetupEdits> SetupPopup::State::checked_edits(const ViewModel& model) {
    SetupEdits edits = edits_between(*shown_, wanted_, model.edits ? *model.edits : SetupEdits{});
    refused_ = refusals_of(edits);
    if (refused_.empty()) return edits;
    for (size_t i = 0; i < wanted_.tools.size(); ++i)
        if (refused_.front().tool == wanted_.tools[i].tool.number) tool_ = i;
    return {};
}

void SetupPopup::State::draw_tool(Frame& frame, size_t index) {
    const SheetTool& shown = shown_->tools[index];
    core::ToolDescription& tool = wanted_.tools[index].tool;
    const core::ToolNumber number = tool.number;
    ImGui::PushID(core::value_of(number));
    if (tool.shape == core::ToolShape::profile) {
        wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                     "Edit its outline in the set-up file.");
        ImGui::PopID();
        return;
    }
    field_name(frame, "Kind", 130.0);
    ImGui::SetNextItemWidth(frame.px(130));
    draw_shape(tool);
    source_mark(frame, source_of(shown, "shape"));
    const bool has_cones = !tool.shank.empty();
    for (const core::ToolSize& field : fields_of(tool.shape)) {
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
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     "Its shank is described by cones, which determine the stick-out.");
    field_name(frame, "Holder", 130.0);
    draw_holder(frame, shown.tool, tool);
    source_mark(frame, source_of(shown, "holder"));
    for (const char* key : {"holder", "gauge_length", "neck_length", "teeth", "thread_deg", ""})
        field_refusal(frame, refused_, number, key);
    if (!shown.why.empty())
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim), "Inferred: " + shown.why);
    ImGui::PopID();
}

void SetupPopup::State::draw_tools(Frame& frame) {
    text(frame.fonts.strong, frame.palette.color(Role::text), "Tools");
    if (wanted_.tools.empty()) {
        text(frame.fonts.text, frame.palette.color(Role::dim), "The program uses no tools.");
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
    ImGui::BeginGroup(); // in the same ImGui window, so that Tab reaches its fields
    draw_tool(frame, tool_);
    ImGui::EndGroup();
}

void SetupPopup::State::draw_saving(Frame& frame) {
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
    save = ImGui::Button(asks_to_replace_ ? "Replace" : "Save") || save;
    if (!refusal_.empty())
        wrapped_text(frame.fonts.small, frame.palette.color(Role::violation),
                     asks_to_replace_ ? "This file already exists. Replace it, or enter another "
                                        "name."
                                      : refusal_);
    if (!save) return;
    refusal_.clear();
    if (auto edits = checked_edits(model))
        model.wanted_setup = SetupRequest{std::make_shared<const SetupEdits>(*std::move(edits)),
                                          path_, asks_to_replace_};
}

void SetupPopup::State::draw_buttons(Frame& frame) {
    ViewModel& model = frame.model;
    const bool enter =
        ImGui::GetIO().KeyCtrl && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false);
    if (ImGui::Button("Check") || enter) {
        if (auto edits = checked_edits(model)) {
            model.wanted_setup =
                SetupRequest{std::make_shared<const SetupEdits>(*std::move(edits))};
            model.popup = Popup::none;
        }
    }
    tip(frame, "Ctrl+Enter");
    ImGui::SameLine();
    if (ImGui::Button("Save as set-up \xE2\x80\xA6")) is_saving_ = !is_saving_;
    ImGui::SameLine();
    ImGui::BeginDisabled(!model.edits);
    if (ImGui::Button("Undo all changes")) {
        model.wanted_setup = SetupRequest{};
        model.popup = Popup::none;
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (ImGui::Button("Tolerances")) frame.perform(Command::tolerances);
    tip(frame, tip_of(Command::tolerances));
    if (!refused_.empty()) {
        ImGui::SameLine();
        text(frame.fonts.text, frame.palette.color(Role::violation),
             "Nothing was changed: correct the marked fields.");
    }
    if (is_saving_) draw_saving(frame);
}

void SetupPopup::State::draw(Frame& frame) {
    const ViewModel& model = frame.model;
    if (!model.program || !model.program->sheet) {
        text(frame.fonts.text, frame.palette.color(Role::dim),
             "The set-up is being read \xE2\x80\xA6");
        return;
    }
    const auto& sheet = model.program->sheet;
    if (ImGui::IsWindowAppearing() || shown_ != sheet) {
        begin(sheet);
        path_ = model.program->proposed_path;
    }
    if (std::exchange(frame.model.wants_saving, false)) is_saving_ = true;
    text(frame.fonts.text, frame.palette.color(Role::dim),
         sheet->path.empty()
             ? "No set-up file was given: all values are inferred from the program. "
               "Enter those that you know."
             : "From " + sheet->path);
    ImGui::Dummy(ImVec2(0, frame.px(4)));
    draw_stock_fields(frame, *shown_, wanted_, refused_);
    ImGui::Dummy(ImVec2(0, frame.px(4)));
    draw_tools(frame);
    draw_allowance_field(frame, *shown_, wanted_, refused_);
    ImGui::Dummy(ImVec2(0, frame.px(6)));
    draw_buttons(frame);
}

namespace {

/// Three input fields for lengths in a row. True if one was changed.
bool place_field(const Frame& frame, const char* id, core::Vec3& mm) {
    bool changed = false;
    ImGui::PushID(id);
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) ImGui::SameLine(0, frame.px(6));
        ImGui::PushID(axis);
        double value = mm[axis];
        if (length_field(frame, "##axis", value)) {
            mm[axis] = value;
            changed = true;
        }
        ImGui::PopID();
    }
    ImGui::PopID();
    return changed;
}

void unit_label(Frame& frame, const char* more = "") {
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.small, frame.palette.color(Role::dim),
         std::string(length_unit(frame.model)) + more);
}

void draw_box(Frame& frame, core::SolidBox& stock) {
    core::Aabb& box = stock.box;
    core::Vec3 size = box.size();
    field_name(frame, "Lower corner");
    core::Vec3 corner = box.min;
    if (place_field(frame, "corner", corner)) box = {corner, corner + size};
    unit_label(frame, "   X Y Z");
    field_name(frame, "Size");
    if (place_field(frame, "size", size)) box.max = box.min + size;
    unit_label(frame);
}

void draw_cylinder(Frame& frame, core::SolidCylinder& round) {
    field_name(frame, "Base centre");
    place_field(frame, "foot", round.base);
    unit_label(frame, "   X Y Z");
    field_name(frame, "Diameter");
    double diameter = 2.0 * round.radius;
    if (length_field(frame, "##diameter", diameter)) round.radius = 0.5 * diameter;
    unit_label(frame);
    field_name(frame, "Height");
    length_field(frame, "##height", round.height);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(frame.px(110));
    ImGui::Combo("##axis", &round.axis, "along X\0along Y\0along Z\0");
}

/// Changes the stock to a box (0) or cylinder (1) of the same size.
void reshape(core::Solid& stock, int kind) {
    const core::Aabb box = core::bounds(stock);
    const core::Vec3 size = box.size(), middle = 0.5 * (box.min + box.max);
    if (kind == 0)
        stock.shape = core::SolidBox{box};
    else
        stock.shape = core::SolidCylinder{
            {middle.x, middle.y, box.min.z}, 0.5 * std::max(size.x, size.y), size.z, 2};
}

void why_it_is_so(Frame& frame, const std::string& why) {
    if (!why.empty()) wrapped_text(frame.fonts.small, frame.palette.color(Role::dim), why);
}

void field_name(Frame& frame, const std::string& name, double width) {
    const float left = ImGui::GetCursorPosX();
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.text, frame.palette.color(Role::dim), name);
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + frame.px(width)); // also in a group
}

bool length_field(const Frame& frame, const char* id, double& mm) {
    const bool is_inch = frame.model.settings.inch;
    double shown = is_inch ? mm / core::mm_per_inch : mm;
    ImGui::SetNextItemWidth(frame.px(92));
    if (!ImGui::InputDouble(id, &shown, 0.0, 0.0, is_inch ? "%.5f" : "%.3f")) return false;
    mm = is_inch ? shown * core::mm_per_inch : shown;
    return true;
}

void source_mark(Frame& frame, SetupSource source, bool is_in_heading) {
    const Role role = source == SetupSource::stated     ? Role::accent
                      : source == SetupSource::inferred ? Role::near
                                                        : Role::dim;
    ImGui::SameLine(0, frame.px(10));
    if (!is_in_heading) ImGui::AlignTextToFramePadding();
    text(frame.fonts.small, frame.palette.ink(role),
         source == SetupSource::stated ? "entered by you" : name_of(source));
}

void field_refusal(Frame& frame, const std::vector<EditRefusal>& refused,
                   std::optional<core::ToolNumber> tool, std::string_view key) {
    for (const EditRefusal& one : refused)
        if (one.tool == tool && one.key == key)
            wrapped_text(frame.fonts.small, frame.palette.color(Role::violation),
                         std::string(frame.fonts.icon(Icon::warning)) + " " + one.why);
}

void draw_stock_fields(Frame& frame, const SetupSheet& shown, SetupSheet& wanted,
                       const std::vector<EditRefusal>& refused) {
    core::Solid& stock = wanted.stock;
    const auto kind = static_cast<int>(stock.shape.index());
    text(frame.fonts.strong, frame.palette.color(Role::text), "Stock");
    source_mark(frame, shown.stock_source, true);
    ImGui::PushID("stock");
    int wish = kind;
    field_name(frame, "Shape");
    ImGui::RadioButton("Box", &wish, 0);
    ImGui::SameLine();
    ImGui::RadioButton("Cylinder", &wish, 1);
    if (kind > 1) {
        ImGui::SameLine();
        text(frame.fonts.small, frame.palette.color(Role::dim),
             "now a mesh from the set-up; a box or cylinder replaces it");
    }
    if (wish != kind) reshape(stock, wish);
    if (auto* box = std::get_if<core::SolidBox>(&stock.shape)) draw_box(frame, *box);
    if (auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) draw_cylinder(frame, *round);
    field_refusal(frame, refused, {}, "box");
    field_refusal(frame, refused, {}, "cylinder");
    why_it_is_so(frame, "Frame: " + shown.frame
                            + (shown.stock_source == SetupSource::inferred ? "; " + shown.stock_why
                                                                           : std::string()));
    ImGui::PopID();
}

void draw_allowance_field(Frame& frame, const SetupSheet& shown, SetupSheet& wanted,
                          const std::vector<EditRefusal>& refused) {
    text(frame.fonts.strong, frame.palette.color(Role::text), "Clearance");
    source_mark(frame, shown.allowance_source, true);
    field_name(frame, "Minimum clearance");
    bool is_usual = !wanted.allowance;
    // An allowance stated in the set-up cannot be reset to the usual one here.
    ImGui::BeginDisabled(shown.allowance_source != SetupSource::usual);
    if (ImGui::Checkbox("usual", &is_usual)) {
        wanted.allowance.reset();
        if (!is_usual) wanted.allowance = 2.0;
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (wanted.allowance) {
        length_field(frame, "##allowance", *wanted.allowance);
        unit_label(frame);
    } else {
        const std::string unit = std::string(" ") + length_unit(frame.model);
        text(frame.fonts.small, frame.palette.color(Role::dim),
             fmt::format("{}{} to the stock, {}{} to fixtures and machine",
                         length_text(frame.model, 1.0), unit, length_text(frame.model, 2.0), unit));
    }
    field_refusal(frame, refused, {}, "allowance");
}

} // namespace

SetupPopup::SetupPopup() : state_(std::make_unique<State>()) {}

SetupPopup::~SetupPopup() = default;

void SetupPopup::draw(Frame& frame) { state_->draw(frame); }

} // namespace app::viewer
