#include "app/view/ui/setup_forms.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "app/check/setup_sheet.h"
#include "app/setup/presets/preset.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_text.h"
#include "app/view/model/placing.h"
#include "app/view/model/preset_fixture.h"
#include "app/view/model/unit_words.h"
#include "app/view/model/view_model.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "core/cad/cad_file.h"
#include "core/dbm/solid.h"
#include "gcode/language/canonical.h"

namespace app::viewer {
namespace {

using render::Role;
using Kind = SetupItem::Kind;

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

void SetupForms::draw_item_head(Frame& frame, const std::string& title, bool can_copy,
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

void SetupForms::draw_offset(Frame& frame, const SheetOffset& offset) {
    ViewModel& model = frame.model;
    draw_item_head(frame, "Work offset " + offset.shown, false,
                   model.workspace.stated->has_offset(offset.name));
    field_name(frame, "X Y Z");
    // What is stated comes from the text: the last check may not know it yet.
    const auto origin = fields_.point(frame, "origin", origin_of(*model.workspace.stated, offset));
    source_mark(frame, offset.source);
    if (origin)
        edit_setup(model, "Change " + offset.shown,
                   [&](const std::string& t) { return with_offset(t, offset.shown, *origin); });
    draw_zero(frame, offset.name);
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                 offset.is_used ? "Machine coordinates of program zero, as on the control's page."
                                : "The program does not use it.");
}

void SetupForms::draw_stock(Frame& frame) {
    ViewModel& model = frame.model;
    const SetupSheet& sheet = *model.program->sheet;
    const auto kept = model.workspace.stated; // edits replace it
    draw_item_head(frame, "Stock", false, kept->stock.has_value());
    if (kept->stock && kept->stock->has_shape()) {
        draw_shape(frame, *kept->stock, stock_name);
        draw_pose(frame, *kept->stock, stock_name);
    } else {
        draw_assumed_stock(frame, sheet);
    }
    draw_placing(frame, stock_name);
    std::string why;
    if (sheet.stock_source == SetupSource::assumed && !sheet.stock_why.empty())
        why = "In " + sheet.frame + ". Assumed: " + sheet.stock_why + ".";
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim), why);
}

/// The fields of a stock that is not stated; a change states it.
void SetupForms::draw_assumed_stock(Frame& frame, const SetupSheet& sheet) {
    ViewModel& model = frame.model;
    const auto restate = [&](const core::Solid& stock) {
        edit_setup(model, "Change the stock",
                   [&](const std::string& t) { return with_stock(t, stock, sheet.frame); });
    };
    const bool is_box = std::holds_alternative<core::SolidBox>(sheet.stock.shape);
    draw_kinds(frame, is_box ? 0 : 1, "from a file \xE2\x80\xA6", [&](int kind) {
        kind == 2 ? browse(model, FileWish::stock) : restate(reshaped_stock(sheet.stock, kind));
    });
    source_mark(frame, sheet.stock_source);
    core::Solid stock = sheet.stock;
    if (auto* box = std::get_if<core::SolidBox>(&stock.shape)) {
        field_name(frame, "Size X Y Z");
        if (const auto size = fields_.sizes(frame, "size", box->box.size())) {
            box->box = resized(box->box, *size);
            restate(stock);
        }
        field_name(frame, "Lower corner");
        if (const auto corner = fields_.point(frame, "corner", box->box.min)) {
            box->box = {*corner, *corner + box->box.size()};
            restate(stock);
        }
    } else if (auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) {
        StatedBody::Cylinder shape{round->radius, round->height, round->axis};
        if (draw_cylinder(frame, shape)) {
            round->radius = shape.radius;
            round->height = shape.height;
            round->axis = shape.axis;
            restate(stock);
        }
        field_name(frame, "Base centre");
        if (const auto base = fields_.point(frame, "base", round->base)) {
            round->base = *base;
            restate(stock);
        }
    }
}

/// A list of the kinds of shapes: a box, a cylinder, a file. Calls `choose` for another one.
void SetupForms::draw_kinds(Frame& frame, int kind, const char* file,
                            const std::function<void(int)>& choose) {
    const char* const kinds[] = {"box", "cylinder", file};
    field_name(frame, "Shape");
    ImGui::SetNextItemWidth(frame.px(140));
    if (!ImGui::BeginCombo("##kind", kinds[kind])) return;
    for (int i = 0; i < 3; ++i)
        if (ImGui::Selectable(kinds[i], i == kind) && (i != kind || i == 2)) choose(i);
    ImGui::EndCombo();
}

/// The fields of a cylinder. True if one was changed.
bool SetupForms::draw_cylinder(Frame& frame, StatedBody::Cylinder& round) {
    bool is_changed = false;
    field_name(frame, "Diameter");
    if (const auto diameter = fields_.size(frame, "##diameter", 2.0 * round.radius)) {
        round.radius = 0.5 * *diameter;
        is_changed = true;
    }
    field_name(frame, "Length");
    if (const auto height = fields_.size(frame, "##height", round.height)) {
        round.height = *height;
        is_changed = true;
    }
    ImGui::SameLine();
    ImGui::SetNextItemWidth(frame.px(84));
    return ImGui::Combo("##axis", &round.axis, "along X\0along Y\0along Z\0") || is_changed;
}

/// A list of the presets of the same kind. Calls `choose` for another one.
void draw_presets(Frame& frame, const StatedBody& body,
                  const std::function<void(std::string_view)>& choose) {
    const Preset* const preset = find_preset(body.preset);
    field_name(frame, "Preset");
    ImGui::SetNextItemWidth(frame.px(208));
    if (!ImGui::BeginCombo("##preset", body.preset.c_str())) return;
    for (const Preset& other : presets()) {
        if (preset && other.kind != preset->kind) continue;
        const std::string name(other.name);
        if (ImGui::Selectable(name.c_str(), name == body.preset) && name != body.preset)
            choose(name);
    }
    ImGui::EndCombo();
}

/// A list of the solids and assemblies of a CAD file, each with its colour there. Calls `choose`
/// for another one; with an empty name for all.
void draw_solids(Frame& frame, const StatedBody& body,
                 const std::function<void(const std::string&)>& choose) {
    const std::shared_ptr<const core::CadNames> files = frame.model.program->sheet->cad_names;
    std::vector<core::CadName> names;
    if (files)
        if (const auto known = files->by_file.find(body.mesh); known != files->by_file.end())
            names = known->second;
    field_name(frame, "Solid");
    ImGui::SetNextItemWidth(frame.px(208));
    const char* const all = "all of the file";
    if (!ImGui::BeginCombo("##solid", body.solid.empty() ? all : body.solid.c_str(),
                           ImGuiComboFlags_HeightLargest))
        return;
    if (ImGui::Selectable(all, body.solid.empty()) && !body.solid.empty()) choose({});
    const float side = ImGui::GetTextLineHeight();
    for (const core::CadName& each : names) {
        ImGui::PushID(each.name.c_str());
        const ImVec2 at = ImGui::GetCursorScreenPos();
        if (each.colour)
            ImGui::GetWindowDrawList()->AddRectFilled(
                at, {at.x + side, at.y + side},
                IM_COL32((*each.colour)[0], (*each.colour)[1], (*each.colour)[2], 255),
                frame.px(2));
        const std::string label = fmt::format("      {}##", each.name);
        if (ImGui::Selectable(label.c_str(), each.name == body.solid) && each.name != body.solid)
            choose(each.name);
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

void SetupForms::draw_preset_sizes(Frame& frame, const StatedBody& body, const BodyPath& path,
                                   std::span<const PresetParameter> parameters) {
    ViewModel& model = frame.model;
    for (const PresetParameter& parameter : parameters) {
        const auto stated = body.preset_values.find(parameter.key);
        const bool is_stated = stated != body.preset_values.end();
        const double value = is_stated ? stated->second : parameter.standard;
        const std::string id = "##" + std::string(parameter.key);
        const bool is_length = parameter.measure == PresetMeasure::length;
        field_name(frame, label_of(parameter.key));
        const auto typed = is_length ? fields_.length(frame, id.c_str(), value)
                                     : fields_.number(frame, id.c_str(), value);
        tip(frame, std::string(parameter.meaning));
        if (typed)
            edit_setup(model, "Change " + body.name, [&](const std::string& t) {
                return with_preset_value(t, path, parameter.key, *typed);
            });
        if (is_length) unit_label(frame, length_unit(model));
        source_mark(frame, is_stated ? SetupSource::stated : SetupSource::assumed);
    }
}

void SetupForms::draw_preset(Frame& frame, const StatedBody& body, const BodyPath& path) {
    ViewModel& model = frame.model;
    const auto change = [&](const SetupDocument::Edit& edit) {
        edit_setup(model, "Change " + body.name, edit);
    };
    draw_presets(frame, body, [&](std::string_view name) {
        change([&](const std::string& t) { return with_preset(t, path, name); });
    });
    const Preset* const preset = find_preset(body.preset);
    if (!preset) return;
    if (const auto usual = usual_grip(model, body)) {
        field_name(frame, "In the jaws");
        if (const auto depth = fields_.size(frame, "##grip", grip_.value_or(*usual))) grip_ = depth;
        unit_label(frame, length_unit(model));
        field_name(frame, "");
        ImGui::BeginDisabled(!is_current(model));
        if (ImGui::Button("Clamp the stock")) clamp_stock(model, body, grip_.value_or(*usual));
        ImGui::EndDisabled();
        tip(frame, "Puts the vise around the stock, so deep in its jaws, and closes it");
    }
    constexpr size_t shown = 3;
    const std::span<const PresetParameter> all = preset->parameters;
    const size_t first = std::min(shown, all.size());
    draw_preset_sizes(frame, body, path, all.first(first));
    if (first == all.size()
        || !ImGui::TreeNodeEx("More sizes", ImGuiTreeNodeFlags_NoTreePushOnOpen))
        return;
    draw_preset_sizes(frame, body, path, all.subspan(first));
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim), std::string(preset->source));
}

void SetupForms::draw_shape(Frame& frame, const StatedBody& body, const BodyPath& path) {
    ViewModel& model = frame.model;
    const bool is_stock = path.key() == stock_name, is_part = path.key() == part_name;
    const std::string name = body.name.empty() ? "the " + path.key() : body.name;
    const auto change = [&](const SetupDocument::Edit& edit) {
        edit_setup(model, "Change " + name, edit);
    };
    const auto set_box = [&](const core::Aabb& box) {
        change([&](const std::string& t) { return with_box(t, path, box); });
    };
    const auto set_cylinder = [&](const StatedBody::Cylinder& round) {
        change([&](const std::string& t) {
            return with_cylinder(t, path, round.radius, round.height, round.axis);
        });
    };
    if (!body.preset.empty()) return draw_preset(frame, body, path);
    const FileWish wish = is_stock ? FileWish::stock : is_part ? FileWish::part : FileWish::mesh;
    const int kind = body.box ? 0 : body.cylinder ? 1 : 2;
    if (!is_part)
        draw_kinds(frame, kind, is_stock ? "from a file \xE2\x80\xA6" : "mesh", [&](int chosen) {
            if (chosen == 0) set_box({core::Vec3(0.0), usual_block(model)});
            if (chosen == 1) set_cylinder({0.5 * usual_block(model).y, usual_block(model).y, 2});
            if (chosen == 2 && is_stock) browse(model, wish);
        });
    if (is_stock) source_mark(frame, model.program->sheet->stock_source);
    if (body.box) {
        const core::Aabb box = *body.box;
        field_name(frame, "Size X Y Z");
        if (const auto size = fields_.sizes(frame, "size", box.size()))
            set_box(is_stock ? resized(box, *size) : core::Aabb{box.min, box.min + *size});
        if (box.min == core::Vec3(0.0) && !is_stock) return;
        field_name(frame, "Lower corner");
        if (const auto corner = fields_.point(frame, "corner", box.min))
            set_box({*corner, *corner + box.size()});
    } else if (body.cylinder) {
        StatedBody::Cylinder round = *body.cylinder;
        if (draw_cylinder(frame, round)) set_cylinder(round);
    } else {
        field_name(frame, "File");
        const char* const key = body.model.empty() ? "mesh" : "model";
        if (const auto file =
                fields_.words(frame, "##file", body.mesh + body.model, "FILE.stl", 150))
            change([&](const std::string& t) {
                return toml_with_value(t, path / key, toml_text(path_in_setup(model, *file)));
            });
        if (is_stock || is_part) {
            ImGui::SameLine(0, frame.px(5));
            if (ImGui::Button("Browse \xE2\x80\xA6")) browse(model, wish);
        }
        if (body.mesh.empty()) return;
        if (core::is_cad_file(body.mesh)) {
            draw_solids(frame, body, [&](const std::string& solid) {
                change([&](const std::string& t) {
                    return solid.empty() ? toml_without(t, path / "solid")
                                         : toml_with_value(t, path / "solid", toml_text(solid));
                });
            });
            field_name(frame, "Deviation");
            const auto typed = fields_.size(
                frame, "##deviation", body.mesh_deviation.value_or(core::default_cad_deviation));
            tip(frame, "How far the triangles may be from the surface of the file");
            if (typed)
                change([&](const std::string& t) { return with_mesh_deviation(t, path, *typed); });
            source_mark(frame, body.mesh_deviation ? SetupSource::stated : SetupSource::usual);
            return;
        }
        field_name(frame, "Its unit");
        ImGui::SetNextItemWidth(frame.px(84));
        using gcode::LengthUnit;
        int unit = body.mesh_unit == LengthUnit::inch ? 1 : 0;
        if (ImGui::Combo("##mesh_unit", &unit, "mm\0inch\0"))
            change([&](const std::string& t) {
                return with_mesh_unit(t, path, unit == 1 ? LengthUnit::inch : LengthUnit::mm);
            });
    }
}

/// The frames in which a body can stand: bodies that the set-up states before it, the work offsets
/// of the program and the set-up, the machine.
std::vector<std::string> frames_for(const ViewModel& model, const StatedBody& body,
                                    const std::string& key) {
    const SetupSheet& sheet = *model.program->sheet;
    std::vector<std::string> names;
    if (key != stock_name)
        for (const StatedBody& other : model.workspace.stated->fixtures) {
            if (!body.name.empty() && other.name == body.name) break;
            if (sheet.frames.contains(other.name)) names.push_back(other.name);
        }
    if (key != stock_name) names.emplace_back(stock_name);
    for (const auto& [name, pose] : sheet.frames)
        if (gcode::offset_of_name(name) && (sheet.offset(name) || name == body.frame))
            names.push_back(name);
    names.emplace_back("machine");
    return names;
}

void SetupForms::draw_pose(Frame& frame, const StatedBody& body, const BodyPath& path) {
    ViewModel& model = frame.model;
    const std::string name = body.name.empty() ? path.key() : body.name;
    field_name(frame, "At X Y Z");
    if (const auto at = fields_.point(frame, "at", body.at))
        edit_setup(model, "Move " + name,
                   [&](const std::string& t) { return with_pose(t, path, *at, body.rotate_deg); });
    field_name(frame, "Rotation \xC2\xB0");
    if (const auto turn = fields_.angles(frame, "turn", body.rotate_deg))
        edit_setup(model, "Turn " + name,
                   [&](const std::string& t) { return with_pose(t, path, body.at, *turn); });
    field_name(frame, "In");
    ImGui::SetNextItemWidth(frame.px(140));
    if (!ImGui::BeginCombo("##frame", body.frame.c_str())) return;
    for (const std::string& frame_name : frames_for(model, body, path.key()))
        if (ImGui::Selectable(frame_name.c_str(), frame_name == body.frame)
            && frame_name != body.frame)
            change_frame(model, name, frame_name);
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

void SetupForms::draw_face_lists(Frame& frame, const std::string& body) {
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

void SetupForms::draw_placing(Frame& frame, const std::string& body) {
    ViewModel& model = frame.model;
    Placing& placing = model.placing;
    if (!can_move(model, body)) return;
    ImGui::BeginDisabled(!is_current(model)); // the view must show what is measured
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
    const bool is_narrow = ImGui::GetContentRegionAvail().x < frame.px(212);
    for (const auto& [name, direction] : ways) {
        if (is_narrow && direction.y < 0.0)
            field_name(frame, "");
        else if (direction != ways[0].second)
            ImGui::SameLine(0, frame.px(3));
        if (ImGui::SmallButton(name)) slide_to_contact(model, body, direction);
        tip(frame, "Slide it until it touches another body: close a jaw, put it down");
    }
    if (ImGui::TreeNodeEx("Choose faces from lists", ImGuiTreeNodeFlags_NoTreePushOnOpen))
        draw_face_lists(frame, body);
    ImGui::EndDisabled();
}

void SetupForms::draw_zero(Frame& frame, const std::string& offset) {
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

void SetupForms::draw_fixture(Frame& frame, const StatedBody& body) {
    ViewModel& model = frame.model;
    const auto path = path_of_fixture(model.workspace.document.text(), body.name);
    if (!path) return;
    draw_item_head(frame, "Fixture", true, true);
    field_name(frame, "Name");
    if (std::exchange(wants_name, false)) ImGui::SetKeyboardFocusHere();
    if (const auto name = fields_.words(frame, "##name", body.name, "name", 200))
        rename_selected(model, *name);
    draw_shape(frame, body, *path);
    draw_pose(frame, body, *path);
    if (body.moves)
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     "It is moved during the program ([[fixture.move]] in the set-up): this is its "
                     "place before. The mouse moves it while the cursor is before that block.");
    draw_placing(frame, body.name);
    bool expendable = body.expendable;
    field_name(frame, "");
    const bool is_switched = ImGui::Checkbox("may be cut while feeding", &expendable);
    tip(frame, "Sacrificial: feeds into it are then no errors, rapids still are");
    if (is_switched)
        edit_setup(model, "Change " + body.name, [&](const std::string& t) {
            return expendable ? toml_with_value(t, *path / "expendable", "true")
                              : toml_without(t, *path / "expendable");
        });
}

void SetupForms::draw_part(Frame& frame, const StatedBody& body) {
    draw_item_head(frame, "Part", false, true);
    draw_shape(frame, body, "part");
    draw_pose(frame, body, "part");
    field_name(frame, "Tolerance");
    if (const auto tolerance = fields_.length(frame, "##tolerance", body.tolerance.value_or(0.1)))
        edit_setup(frame.model, "Change the tolerance",
                   [&](const std::string& t) { return with_part_tolerance(t, *tolerance); });
}

void SetupForms::draw_allowance(Frame& frame) {
    ViewModel& model = frame.model;
    const SetupSheet& sheet = *model.program->sheet;
    draw_item_head(frame, "Minimum clearance", false, sheet.allowance.has_value());
    field_name(frame, "All pairs");
    if (const auto distance = fields_.length(frame, "##allowance", sheet.allowance,
                                             SetupFields::field_width, "default"))
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
    draw_pair_allowances(frame);
}

void SetupForms::draw_pair_allowances(Frame& frame) {
    ViewModel& model = frame.model;
    const auto kept = model.workspace.stated; // edits replace it
    for (const StatedAllowance& pair : kept->allowances) {
        const std::string names = pair.between[0] + ", " + pair.between[1];
        ImGui::PushID(static_cast<int>(pair.index));
        field_name(frame, shortened(frame.fonts.text, names, frame.px(100)));
        tip(frame, names);
        if (const auto distance = fields_.length(frame, "##pair", pair.distance))
            edit_setup(model, "Change the minimum clearance", [&](const std::string& t) {
                return with_pair_allowance(t, pair.index, *distance);
            });
        unit_label(frame, length_unit(model));
        ImGui::SameLine();
        if (ImGui::SmallButton("Delete"))
            edit_setup(model, "Delete a minimum clearance",
                       [&](const std::string& t) { return without_pair_allowance(t, pair.index); });
        ImGui::PopID();
    }
    std::vector<std::string> names = {"flutes", "shank",   "holder", "nose",
                                      "stock",  "fixture", "machine"};
    for (const StatedBody& fixture : kept->fixtures) names.push_back(fixture.name);
    field_name(frame, "Between");
    for (size_t side = 0; side < 2; ++side) {
        if (std::find(names.begin(), names.end(), pair_[side]) == names.end())
            pair_[side] = side == 0 ? "holder" : "fixture";
        if (side == 1) ImGui::SameLine();
        ImGui::SetNextItemWidth(frame.px(86));
        if (!ImGui::BeginCombo(side == 0 ? "##first" : "##second", pair_[side].c_str())) continue;
        for (const std::string& name : names)
            if (ImGui::Selectable(name.c_str(), name == pair_[side])) pair_[side] = name;
        ImGui::EndCombo();
    }
    ImGui::SameLine();
    if (ImGui::SmallButton("Add"))
        edit_setup(model, "Add a minimum clearance",
                   [&](const std::string& t) { return with_new_pair_allowance(t, pair_, 2.0); });
    tip(frame, "A minimum clearance of their own for these two");
}

void SetupForms::draw_item(Frame& frame) {
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

void SetupForms::draw(Frame& frame, float below) {
    ImGui::BeginChild("item", ImVec2(0, -below), false, ImGuiWindowFlags_NavFlattened);
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame.px(7), frame.px(2.5)));
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(frame.px(6), frame.px(4)));
    fields_.begin(frame);
    draw_item(frame);
    fields_.end(frame);
    ImGui::PopStyleVar(2);
    ImGui::EndChild();
}

} // namespace app::viewer
