#include "app/viewer/setup_fields.h"

#include <fmt/format.h>
#include <imgui.h>

#include "app/viewer/widgets.h"

namespace app::viewer {
namespace {

using render::Role;

constexpr double inch = 25.4;

/// Three lengths in a row; whether one was changed.
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

void unit_behind(Frame& frame, const char* more = "") {
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.small, frame.look.color(Role::dim),
         std::string(length_unit(frame.model)) + more);
}

void draw_box(Frame& frame, core::SolidBox& stock) {
    core::Aabb& box = stock.box;
    core::Vec3 size = box.size();
    field_name(frame, "Lowest corner");
    core::Vec3 corner = box.min;
    if (place_field(frame, "corner", corner)) box = {corner, corner + size};
    unit_behind(frame, "   X Y Z");
    field_name(frame, "Size");
    if (place_field(frame, "size", size)) box.max = box.min + size;
    unit_behind(frame);
}

void draw_cylinder(Frame& frame, core::SolidCylinder& round) {
    field_name(frame, "Foot");
    place_field(frame, "foot", round.base);
    unit_behind(frame, "   X Y Z");
    field_name(frame, "Diameter");
    double diameter = 2.0 * round.radius;
    if (length_field(frame, "##diameter", diameter)) round.radius = 0.5 * diameter;
    unit_behind(frame);
    field_name(frame, "Height");
    length_field(frame, "##height", round.height);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(frame.px(110));
    ImGui::Combo("##axis", &round.axis, "along X\0along Y\0along Z\0");
}

/// A box or cylinder of the size of what stands there now.
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
    if (!why.empty()) wrapped_text(frame.fonts.small, frame.look.color(Role::dim), why);
}

} // namespace

void field_name(Frame& frame, const std::string& name, double width) {
    const float left = ImGui::GetCursorPosX();
    ImGui::AlignTextToFramePadding();
    text(frame.fonts.text, frame.look.color(Role::dim), name);
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + frame.px(width)); // also in a group
}

bool length_field(const Frame& frame, const char* id, double& mm) {
    const bool is_inch = frame.model.settings.inch;
    double shown = is_inch ? mm / inch : mm;
    ImGui::SetNextItemWidth(frame.px(92));
    if (!ImGui::InputDouble(id, &shown, 0.0, 0.0, is_inch ? "%.5f" : "%.3f")) return false;
    mm = is_inch ? shown * inch : shown;
    return true;
}

void source_mark(Frame& frame, SetupSource source, bool is_in_heading) {
    const Role role = source == SetupSource::stated     ? Role::accent
                      : source == SetupSource::inferred ? Role::near
                                                        : Role::dim;
    ImGui::SameLine(0, frame.px(10));
    if (!is_in_heading) ImGui::AlignTextToFramePadding();
    text(frame.fonts.small, frame.look.ink(role),
         source == SetupSource::stated ? "stated by you" : name_of(source));
}

void field_refusal(Frame& frame, const std::vector<EditRefusal>& refused,
                   std::optional<core::ToolNumber> tool, std::string_view key) {
    for (const EditRefusal& one : refused)
        if (one.tool == tool && one.key == key)
            wrapped_text(frame.fonts.small, frame.look.color(Role::violation),
                         std::string(frame.fonts.icon(Icon::warning)) + " " + one.why);
}

void draw_stock_fields(Frame& frame, const SetupSheet& shown, SetupSheet& wanted,
                       const std::vector<EditRefusal>& refused) {
    core::Solid& stock = wanted.stock;
    const auto kind = static_cast<int>(stock.shape.index());
    text(frame.fonts.strong, frame.look.color(Role::text), "Stock");
    source_mark(frame, shown.stock_source, true);
    ImGui::PushID("stock");
    int wish = kind;
    field_name(frame, "Shape");
    ImGui::RadioButton("Box", &wish, 0);
    ImGui::SameLine();
    ImGui::RadioButton("Cylinder", &wish, 1);
    if (kind > 1) {
        ImGui::SameLine();
        text(frame.fonts.small, frame.look.color(Role::dim),
             "now a mesh of the set-up; a box or cylinder takes its place");
    }
    if (wish != kind) reshape(stock, wish);
    if (auto* box = std::get_if<core::SolidBox>(&stock.shape)) draw_box(frame, *box);
    if (auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) draw_cylinder(frame, *round);
    field_refusal(frame, refused, {}, "box");
    field_refusal(frame, refused, {}, "cylinder");
    why_it_is_so(frame, "Coordinates of " + shown.frame
                            + (shown.stock_source == SetupSource::inferred ? "; " + shown.stock_why
                                                                           : std::string()));
    ImGui::PopID();
}

void draw_allowance_field(Frame& frame, const SetupSheet& shown, SetupSheet& wanted,
                          const std::vector<EditRefusal>& refused) {
    text(frame.fonts.strong, frame.look.color(Role::text), "Allowance");
    source_mark(frame, shown.allowance_source, true);
    field_name(frame, "Clearance to keep");
    bool is_usual = !wanted.allowance;
    // What a set-up states cannot be made usual again here.
    ImGui::BeginDisabled(shown.allowance_source != SetupSource::usual);
    if (ImGui::Checkbox("usual", &is_usual)) {
        wanted.allowance.reset();
        if (!is_usual) wanted.allowance = 2.0;
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (wanted.allowance) {
        length_field(frame, "##allowance", *wanted.allowance);
        unit_behind(frame);
    } else {
        const std::string unit = std::string(" ") + length_unit(frame.model);
        text(frame.fonts.small, frame.look.color(Role::dim),
             fmt::format("{}{} to the stock, {}{} to fixtures and machine",
                         length_text(frame.model, 1.0), unit, length_text(frame.model, 2.0), unit));
    }
    field_refusal(frame, refused, {}, "allowance");
}

} // namespace app::viewer
