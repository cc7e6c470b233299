#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/view/model/axis_display.h"
#include "app/view/model/navigation.h"
#include "app/view/model/unit_words.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "core/base/rule.h"
#include "core/base/units.h"
#include "core/sim/run/finding_text.h"

namespace app::viewer {
namespace {

using render::Role;

void draw_number(Frame& frame) {
    const ViewModel& model = frame.model;
    const BlockRow& row = model.row();
    text(frame.fonts.small, frame.palette.color(Role::dim), "CLEARANCE");
    std::string number = "\xE2\x80\x94";
    const bool is_touching = is_contact(row), is_moved = is_jogged(model);
    if (row.is_known && row.lower && !is_moved) number = clearance_words(model, row);
    const ImVec2 at = ImGui::GetCursorPos();
    text(frame.fonts.big,
         is_moved ? frame.palette.color(Role::dim) : frame.palette.of(row, Role::text), number);
    if (!row.lower || !row.is_known || is_touching || is_moved) return;
    const float width =
        frame.fonts.big->CalcTextSizeA(frame.fonts.big->FontSize, 1e9F, 0.0F, number.c_str()).x;
    ImGui::SameLine(at.x + width + frame.px(9));
    ImGui::SetCursorPosY(at.y + frame.px(21));
    text(frame.fonts.text, frame.palette.color(Role::dim), length_unit(model));
    if (is_offending(row)) {
        ImGui::SameLine(0, frame.px(10));
        text(frame.fonts.text, frame.palette.color(Role::violation),
             frame.fonts.icon(Icon::warning));
    }
    ImGui::SetCursorPosY(at.y + frame.px(46));
}

std::string sentence_of(const ViewModel& model, const BlockRow& row) {
    if (is_jogged(model)) return "axes moved by hand: not checked";
    if (!row.is_known) return "not checked yet";
    if (!moves(row)) return "this block moves nothing";
    if (!row.is_judged) return "this motion cannot be checked";
    if (!row.upper) return "nothing within the search limit";
    const std::string unit = length_unit(model);
    const std::string allowance =
        "minimum clearance " + length_at_most(model, *row.allowance) + " " + unit;
    if (row.verdict == core::Verdict::collision)
        return allowance + " \xC2\xB7 collision"
               + (row.overlap ? ", " + depth_words(model, *row.overlap) + " " + unit + " deep"
                              : "");
    if (is_contact(row)) return "the bodies touch as intended: no minimum clearance";
    const double margin = *row.lower - *row.allowance;
    if (margin >= -core::resolution)
        return allowance + " \xC2\xB7 " + length_at_least(model, margin) + " " + unit + " to spare";
    return allowance + " \xC2\xB7 short by " + length_at_most(model, -margin) + " " + unit;
}

/// Draws the scale of violation, near and clear up to six times the allowance, with the clearance
/// of the block marked on it.
void draw_scale(Frame& frame) {
    const BlockRow& row = frame.model.row();
    const float width = ImGui::GetContentRegionAvail().x, height = frame.px(10);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float top = at.y + frame.px(11);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const auto part = [&](double from, double to, Role role) {
        list.AddRectFilled({at.x + width * static_cast<float>(from), top},
                           {at.x + width * static_cast<float>(to), top + height},
                           frame.palette.color(role, 0.9));
    };
    const bool has_scale =
        row.is_known && row.upper && *row.allowance > 0.0 && !is_jogged(frame.model);
    if (has_scale) {
        part(0.0, 1.0 / 6.0, Role::violation);
        part(1.0 / 6.0, 2.0 / 6.0, Role::near);
        part(2.0 / 6.0, 1.0, Role::clear);
        const double fraction = std::clamp(*row.lower / (6.0 * *row.allowance), 0.0, 1.0);
        const float x = at.x + width * static_cast<float>(fraction), half = frame.px(5);
        list.AddTriangleFilled({x - half, at.y}, {x + half, at.y}, {x, at.y + frame.px(8)},
                               frame.palette.color(Role::text));
        ImGui::Dummy(ImVec2(width, frame.px(24)));
    } else {
        list.AddRectFilled({at.x, top}, {at.x + width, top + height},
                           frame.palette.color(Role::raised));
        ImGui::Dummy(ImVec2(width, frame.px(24)));
    }
    wrapped_text(frame.fonts.small, frame.palette.color(Role::dim), sentence_of(frame.model, row));
}

/// A body of the pair, with its colour in the view.
void pair_row(Frame& frame, const char* name, const std::string& body, Role role) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float side = frame.px(10);
    const ImVec2 corner(at.x + frame.px(70), at.y + frame.px(4));
    ImGui::GetWindowDrawList()->AddRectFilled(corner, {corner.x + side, corner.y + side},
                                              frame.palette.color(role), frame.px(2));
    value_row(frame, name, body, 88.0);
}

void draw_pair(Frame& frame) {
    const BlockRow& row = frame.model.row();
    if (!row.has_pair() || !row.is_known) return;
    heading(frame, is_jogged(frame.model) ? "Closest pair in the block" : "Closest pair");
    const bool is_marked = state_of(row) >= render::ClearanceState::near && !is_jogged(frame.model);
    pair_row(frame, "Tool side", row.part, is_marked ? Role::pair_tool : Role::panel);
    pair_row(frame, "Obstacle", row.body, is_marked ? Role::pair_body : Role::panel);
    if (row.duration > 0.0)
        value_row(frame, "When",
                  core::moment_text(std::clamp(row.witness_time / row.duration, 0.0, 1.0)));
    value_row(frame, "Bounds",
              fmt::format("{} \xE2\x80\xA6 {} {}", length_at_least(frame.model, *row.lower, 3),
                          length_at_most(frame.model, *row.upper, 3), length_unit(frame.model)));
    if (ImGui::Button("Show it", ImVec2(ImGui::GetContentRegionAvail().x, 0)))
        frame.perform(Command::frame_witness);
    tip(frame, tip_of(Command::frame_witness));
}

void draw_finding(Frame& frame, const core::Finding& finding) {
    const bool bad = finding.severity == core::Severity::error;
    const Role role = bad ? Role::violation
                          : (finding.severity == core::Severity::warning ? Role::near : Role::dim);
    const Icon icon = bad ? Icon::warning
                          : (finding.severity == core::Severity::warning ? Icon::near : Icon::note);
    text(frame.fonts.text, frame.palette.color(role), frame.fonts.icon(icon));
    ImGui::SameLine(0, frame.px(7));
    text(frame.fonts.strong, frame.palette.color(Role::text), core::title_of_rule(finding.rule));
    tip(frame, finding.rule);
    wrapped_text(frame.fonts.text, frame.palette.color(Role::text),
                 words_in_unit(frame.model, finding.message));
    if (finding.cure.empty()) return;
    text(frame.fonts.text, frame.palette.color(Role::accent), frame.fonts.icon(Icon::bulb));
    ImGui::SameLine(0, frame.px(7));
    wrapped_text(frame.fonts.text, frame.palette.color(Role::dim),
                 words_in_unit(frame.model, finding.cure));
}

void draw_findings(Frame& frame) {
    const auto found = findings_of(frame.model, frame.model.cursor.block);
    if (found.empty()) return;
    heading(frame, found.size() == 1 ? "Finding" : "Findings");
    for (const core::Finding* finding : found) draw_finding(frame, *finding);
}

/// The kind of motion, and its code.
std::string motion_text(const ViewModel& model) {
    std::string words = core::name_of(model.row().motion);
    if (!model.block_state) return words;
    for (const ShownValue& value : model.block_state->modal)
        if (value.name == "motion" && value.text != words) words += "  " + value.text;
    return words;
}

std::string plain_name(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

void draw_block(Frame& frame) {
    const ViewModel& model = frame.model;
    const BlockRow& row = model.row();
    heading(frame, fmt::format("Block {}", model.cursor.block).c_str());
    value_row(frame, "line",
              row.file.empty() ? std::to_string(row.line)
                               : fmt::format("{} of {}", row.line, row.file),
              104.0);
    value_row(frame, "motion", motion_text(model), 104.0);
    if (row.duration > 0.0) value_row(frame, "time", fmt::format("{:.2f} s", row.duration), 104.0);
    if (!model.block_state) return;
    for (const ShownValue& value : model.block_state->modal)
        if (value.name != "motion")
            value_row(frame, plain_name(value.name).c_str(), words_in_unit(model, value.text),
                      104.0, value.changed);
}

void draw_values(Frame& frame, const char* title, const std::vector<ShownValue>& values) {
    if (values.empty() || !ImGui::CollapsingHeader(title)) return;
    for (const ShownValue& value : values)
        value_row(frame, value.name.c_str(),
                  positions_in_unit(frame.model, words_in_unit(frame.model, value.text)), 104.0,
                  value.changed);
}

void draw_watches(Frame& frame, std::string& typed) {
    ViewModel& model = frame.model;
    if (!ImGui::CollapsingHeader("Watch")) return;
    if (model.block_state)
        for (const ShownValue& value : model.block_state->watched)
            value_row(frame, value.name.c_str(), words_in_unit(model, value.text), 104.0);
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::InputTextWithHint("##watch", "#100, machine.z, G54.x, H3 \xE2\x80\xA6", &typed,
                                 ImGuiInputTextFlags_EnterReturnsTrue)
        && !typed.empty()) {
        model.watches.push_back(std::exchange(typed, {}));
        model.watches_changed = true;
    }
    if (!model.watches.empty() && ImGui::SmallButton("Clear")) {
        model.watches.clear();
        model.watches_changed = true;
    }
}

void draw_show(Frame& frame) {
    VisibleParts& shown = frame.model.settings.shown;
    heading(frame, "Show");
    if (!ImGui::BeginTable("show", 2)) return;
    const auto box = [&](const char* name, bool& value) {
        ImGui::TableNextColumn();
        ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame.px(2), frame.px(2)));
        ImGui::Checkbox(name, &value);
        ImGui::PopStyleVar();
    };
    box("Stock", shown.stock);
    box("Fixtures", shown.fixtures);
    box("Tool", shown.tool);
    box("Holder x-ray", shown.holder_xray);
    box("Path", shown.path);
    box("Machine", shown.machine);
    box("Witness line", shown.witness);
    box("Zeros", shown.zeros);
    box("Ground", shown.ground);
    ImGui::EndTable();
}

void draw_assumptions(Frame& frame) {
    const OpenedProgram* program = frame.model.program.get();
    if (!program) return;
    heading(frame, program->is_inferred ? "Inferred set-up" : "Set-up");
    if (program->is_inferred)
        wrapped_text(frame.fonts.small, frame.palette.color(Role::near),
                     "No set-up file was given: this set-up is inferred from the program. Drop a "
                     "set-up file here to replace it.");
    else
        value_row(frame, "File", program->setup, 50.0);
    if (ImGui::Button("Edit and save \xE2\x80\xA6", ImVec2(ImGui::GetContentRegionAvail().x, 0)))
        frame.perform(Command::edit_setup);
    tip(frame, tip_of(Command::edit_setup));
    for (const std::string& words : program->assumptions) {
        text(frame.fonts.small, frame.palette.color(Role::dim), "\xC2\xB7");
        ImGui::SameLine(0, frame.px(6));
        wrapped_text(frame.fonts.small, frame.palette.color(Role::dim),
                     words_in_unit(frame.model, words));
    }
}

/// The colour of a verdict on the whole program.
Role role_of(render::ClearanceState state) {
    switch (state) {
    case render::ClearanceState::violation:
        return Role::violation;
    case render::ClearanceState::near:
        return Role::near;
    case render::ClearanceState::clear:
        return Role::clear;
    case render::ClearanceState::none:
        break;
    }
    return Role::dim;
}

void draw_verdict(Frame& frame) {
    const ViewModel& model = frame.model;
    if (!model.program) return;
    if (!is_current(model))
        wrapped_text(frame.fonts.strong, frame.palette.color(Role::dim),
                     model.workspace.error ? "The last good state is shown"
                                           : "Reading what has changed \xE2\x80\xA6");
    else if (!model.verdict.text.empty())
        wrapped_text(frame.fonts.strong, frame.palette.ink(role_of(model.verdict.state)),
                     model.verdict.text);
    if (!model.coverage.empty())
        wrapped_text(frame.fonts.small, frame.palette.ink(Role::near), model.coverage);
}

void draw_whole(Frame& frame) {
    const ViewModel& model = frame.model;
    const auto whole = findings_of(model, std::nullopt);
    if (whole.empty() && !model.stopped && model.changes.empty()) return;
    heading(frame, "Program");
    for (const std::string& change : model.changes)
        wrapped_text(frame.fonts.text, frame.palette.color(Role::accent),
                     "what if: " + words_in_unit(model, change));
    if (model.stopped)
        wrapped_text(frame.fonts.text, frame.palette.color(Role::violation),
                     fmt::format("Line {}: {}", model.stopped->where.line, model.stopped->message));
    for (const core::Finding* finding : whole) draw_finding(frame, *finding);
}

/// In the unit of the display: such a value is not shown as "-0.000".
constexpr double shown_as_zero = 5e-4;

/// A coordinate in the unit of the window, or an angle.
std::string axis_text(const ViewModel& model, size_t axis, double value) {
    const bool is_inch = model.settings.inch && !core::is_rotary(axis);
    if (std::abs(value) < shown_as_zero * (is_inch ? core::mm_per_inch : 1.0)) value = 0.0;
    return core::is_rotary(axis) ? fmt::format("{:.3f}", value) : length_text(model, value, 3);
}

/// The travel to the nearer limit of an axis.
void draw_travel(Frame& frame, const AxisRow& row) {
    if (!row.below && !row.above) {
        text(frame.fonts.text, frame.palette.color(Role::dim), "no limit");
        return;
    }
    const double below = row.below.value_or(core::infinity),
                 above = row.above.value_or(core::infinity);
    const double least = std::min(below, above);
    const bool is_beyond = least < -core::resolution;
    text(frame.fonts.mono, frame.palette.color(is_beyond ? Role::violation : Role::dim),
         fmt::format("{}{}", below < above ? "\xE2\x88\x92" : "+",
                     core::is_rotary(row.axis) ? fmt::format("{:.1f}", std::abs(least))
                                               : length_text(frame.model, std::abs(least), 1)));
    const auto words = [&](const char* limit, const std::optional<double>& travel) {
        if (!travel) return std::string("no ") + limit + " limit";
        return axis_text(frame.model, row.axis, std::abs(*travel))
               + (*travel < 0.0 ? " beyond the " : " to the ") + limit + " limit";
    };
    tip(frame, words("lower", row.below) + ", " + words("upper", row.above));
}

/// The machine coordinate of an axis, to be dragged or typed.
void draw_position(Frame& frame, const AxisRow& row) {
    const bool is_angle = core::is_rotary(row.axis), is_inch = frame.model.settings.inch;
    const double unit = is_inch && !is_angle ? core::mm_per_inch : 1.0;
    double shown = std::abs(row.machine) < shown_as_zero ? 0.0 : row.machine / unit;
    ImGui::SetNextItemWidth(frame.px(80));
    const float speed = is_angle ? 0.5F : is_inch ? 0.01F : 0.2F;
    const char* const format = is_inch && !is_angle ? "%.4f" : "%.3f";
    ImGui::PushFont(frame.fonts.mono);
    if (ImGui::DragScalar("##machine", ImGuiDataType_Double, &shown, speed, nullptr, nullptr,
                          format)
        && std::isfinite(shown))
        jog(frame.model, row.axis, shown * unit);
    ImGui::PopFont();
    tip(frame, "Drag it to move the axis by hand, or double-click to type. The program stays as it "
               "is");
}

void draw_axes(Frame& frame) {
    ViewModel& model = frame.model;
    const std::vector<AxisRow> rows = axis_rows(model);
    if (rows.empty()) return;
    heading(frame, "Axes");
    const float left = ImGui::GetCursorPosX();
    const std::array<float, 3> columns = {left + frame.px(22), left + frame.px(92),
                                          left + frame.px(180)};
    const auto at = [&](size_t column) {
        ImGui::SameLine();
        ImGui::SetCursorPosX(columns[column]);
    };
    const ImU32 dim = frame.palette.color(Role::dim);
    text(frame.fonts.small, dim, "");
    at(0), text(frame.fonts.small, dim, "Program");
    tip(frame, "In the coordinates of the program with all its offsets and planes, as the control "
               "shows them");
    at(1), text(frame.fonts.small, dim, "Machine");
    tip(frame, "Machine coordinates of the gauge line");
    at(2), text(frame.fonts.small, dim, "Travel");
    tip(frame, "To the nearer limit of the axis");
    for (const AxisRow& row : rows) {
        ImGui::PushID(static_cast<int>(row.axis));
        ImGui::AlignTextToFramePadding();
        text(frame.fonts.strong, frame.palette.color(row.moves ? Role::accent : Role::text),
             std::string(1, core::axis_letters[row.axis]));
        at(0);
        text(frame.fonts.mono, frame.palette.color(Role::text),
             row.program ? axis_text(model, row.axis, *row.program) : "\xE2\x80\x94");
        at(1);
        draw_position(frame, row);
        at(2);
        draw_travel(frame, row);
        ImGui::PopID();
    }
    if (!is_jogged(model)) return;
    wrapped_text(frame.fonts.small, frame.palette.ink(Role::near),
                 "Moved by hand: what is shown is no position of the program and was not checked.");
    if (ImGui::Button("Back to the program", ImVec2(ImGui::GetContentRegionAvail().x, 0)))
        end_jog(model);
    tip(frame, "Esc");
}

} // namespace

void InspectorPanel::draw(Frame& frame, const Area&) {
    draw_verdict(frame);
    if (!frame.model.has_rows()) return draw_assumptions(frame);
    draw_number(frame);
    draw_scale(frame);
    draw_findings(frame);
    draw_pair(frame);
    draw_axes(frame);
    draw_block(frame);
    if (frame.model.block_state) {
        const BlockState& block_state = *frame.model.block_state;
        draw_values(frame, "Offsets", block_state.offsets);
        draw_values(frame, "Parameters", block_state.parameters);
        draw_watches(frame, watch_);
    }
    if (ImGui::Button("What if \xE2\x80\xA6", ImVec2(ImGui::GetContentRegionAvail().x, 0)))
        frame.perform(Command::what_if);
    tip(frame, tip_of(Command::what_if));
    draw_show(frame);
    draw_whole(frame);
    draw_assumptions(frame);
}

} // namespace app::viewer
