#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "app/view/model/axis_display.h"
#include "app/view/model/navigation.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/section.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "app/view/ui/placing_overlay.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "render/ground.h"
#include "render/picking.h"
#include "render/renderer.h"

namespace app::viewer {
namespace {

using render::Role;

/// A picture that takes longer is drawn coarsely while the view turns: the panels need the rest of
/// the 33 ms of a frame.
constexpr std::chrono::milliseconds slow_picture(20);

/// The effect of a mouse drag.
enum class Drag : uint8_t { none, orbit, pan };

Drag drag_of(const Settings& settings) {
    const ImGuiIO& io = ImGui::GetIO();
    const float threshold = 3.0F;
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, threshold))
        return io.KeyShift ? Drag::pan : Drag::orbit;
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Right, threshold)) return Drag::pan;
    if (!ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 0.0F)) return Drag::none;
    switch (settings.mouse) {
    case MousePreset::middle_orbits:
        return io.KeyShift ? Drag::pan : Drag::orbit;
    case MousePreset::middle_pans:
        return io.KeyShift ? Drag::orbit : Drag::pan;
    case MousePreset::middle_orbits_ctrl:
        return io.KeyCtrl ? Drag::pan : Drag::orbit;
    }
    return Drag::none;
}

/// Draws a box with text. `middle`: of the box.
void draw_tag(const Frame& frame, ImDrawList& list, ImVec2 middle, const std::string& words,
              ImU32 fill, ImU32 ink) {
    ImFont* const font = frame.fonts.strong;
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, words.c_str());
    const float x = frame.px(10), y = frame.px(6);
    const ImVec2 a(middle.x - 0.5F * size.x - x, middle.y - 0.5F * size.y - y);
    const ImVec2 b(middle.x + 0.5F * size.x + x, middle.y + 0.5F * size.y + y);
    list.AddRectFilled(a, b, fill, frame.px(4));
    list.AddText(font, font->FontSize, {a.x + x, a.y + y}, ink, words.c_str());
}

/// Draws the summary of an inferred set-up over the view, so that it cannot be overlooked.
void draw_summary(const Frame& frame, ImDrawList& list, const Area& area) {
    const std::vector<std::string> lines = inferred_summary(frame.model);
    if (lines.empty() || area.height < frame.px(360)) return;
    ImFont* const font = frame.fonts.small;
    const float step = font->FontSize + frame.px(4), x = frame.px(12), y = frame.px(9);
    float width = 0.0F;
    for (const std::string& line : lines)
        width = std::max(width, font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, line.c_str()).x);
    const float height = step * static_cast<float>(lines.size()) + 2 * y;
    const ImVec2 corner(area.x + frame.px(14), area.y + area.height - frame.px(56) - height);
    if (corner.y < area.y + frame.px(60)) return;
    list.AddRectFilled(corner, {corner.x + width + 2 * x, corner.y + height},
                       frame.palette.color(Role::panel, 0.86), frame.px(5));
    list.AddRectFilled(corner, {corner.x + frame.px(3), corner.y + height},
                       frame.palette.color(Role::near), frame.px(1));
    for (size_t i = 0; i < lines.size(); ++i)
        list.AddText(font, font->FontSize,
                     {corner.x + x, corner.y + y + step * static_cast<float>(i)},
                     frame.palette.color(i == 0 ? Role::text : Role::dim), lines[i].c_str());
}

std::string location_text(const ViewModel& model) {
    const BlockRow& row = model.row();
    const BlockRow& last = model.rows.back();
    return fmt::format("Block {} of {}   \xC2\xB7   {} / {}", model.cursor.block,
                       model.rows.size() - 1,
                       clock_text(row.time + model.cursor.fraction * row.duration),
                       clock_text(last.time + last.duration));
}

/// Why the view may be outdated or incomplete: a file is missing, or the program stops early.
std::string warning_text(const Frame& frame) {
    const char* const sign = frame.fonts.icon(Icon::warning);
    std::string words;
    if (!frame.model.missing.empty())
        words = fmt::format("{}  {} is missing or empty: this is its last known state", sign,
                            std::filesystem::path(frame.model.missing).filename().generic_string());
    if (const std::string stale = last_good_words(frame.model); !stale.empty())
        words += fmt::format("{}{}  {}", words.empty() ? "" : "\n", sign, stale);
    if (!frame.model.stopped) return words;
    const core::Error& error = *frame.model.stopped;
    return words + (words.empty() ? "" : "\n")
           + fmt::format("{}  Line {} could not be run; nothing after it is checked: {}", sign,
                         error.where.line, error.message);
}

/// Draws the warning over the view, so that it cannot be overlooked.
void draw_warning(const Frame& frame, ImDrawList& list, const Area& area) {
    const std::string words = warning_text(frame);
    if (words.empty()) return;
    ImFont* const font = frame.fonts.text;
    const float x = frame.px(11), y = frame.px(7);
    const ImVec2 corner(area.x + frame.px(14), area.y + frame.px(52));
    const float room_next_to_axes = area.width - frame.px(128) - 2 * x;
    const float room = std::max(room_next_to_axes, frame.px(200));
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e9F, room, words.c_str());
    list.AddRectFilled(corner, {corner.x + size.x + 2 * x, corner.y + size.y + 2 * y},
                       frame.palette.color(Role::violation), frame.px(5));
    list.AddText(font, font->FontSize, {corner.x + x, corner.y + y}, IM_COL32(255, 255, 255, 255),
                 words.c_str(), nullptr, room);
}

/// Draws the names of the two bodies below a tag, each with its colour.
void draw_pair_names(const Frame& frame, ImDrawList& list, ImVec2 middle, const PairWitness& pair) {
    ImFont* const font = frame.fonts.small;
    const float step = font->FontSize + frame.px(4), swatch = frame.px(9);
    float width = 0.0F;
    for (const std::string& name : pair.names)
        width = std::max(width, font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, name.c_str()).x);
    const ImVec2 a(middle.x - 0.5F * width - frame.px(16), middle.y + frame.px(20));
    const ImVec2 b(middle.x + 0.5F * width + frame.px(16), a.y + 2.0F * step + frame.px(8));
    list.AddRectFilled(a, b, frame.palette.color(Role::panel, 0.88), frame.px(4));
    const Role roles[] = {Role::pair_tool, Role::pair_body};
    for (size_t i = 0; i < 2; ++i) {
        const float y = a.y + frame.px(5) + step * static_cast<float>(i);
        list.AddRectFilled({a.x + frame.px(8), y + frame.px(2)},
                           {a.x + frame.px(8) + swatch, y + frame.px(2) + swatch},
                           frame.palette.color(roles[i]), frame.px(2));
        list.AddText(font, font->FontSize, {a.x + frame.px(14) + swatch, y},
                     frame.palette.color(Role::text), pair.names[i].c_str());
    }
}

std::string words_of(const ViewModel& model, const BlockRow& row) {
    if (row.verdict == core::Verdict::collision)
        return row.overlap ? fmt::format("collision, {} {} deep", depth_words(model, *row.overlap),
                                         length_unit(model))
                           : "collision";
    if (is_contact(row)) return clearance_words(model, row);
    return length_at_least(model, *row.lower) + " " + length_unit(model);
}

/// What the next click defines, while a plane is being picked.
std::string section_hint(const ViewModel& model) {
    if (!model.section) return {};
    switch (model.section->pick) {
    case SectionPick::none:
        return {};
    case SectionPick::face:
        return "Click a face to cut parallel to it; Esc cancels";
    case SectionPick::points:
        return fmt::format("Click point {} of 3 on a surface; Esc cancels",
                           model.section->picked.size() + 1);
    }
    return {};
}

/// One end of an axis. A click on it selects the view along the axis.
struct AxisBall {
    const char* name;
    core::Vec3 axis;
    ImU32 color;
    Command command;
};

constexpr std::array<AxisBall, 6> axis_balls = {
    {{"X", {1, 0, 0}, IM_COL32(232, 72, 85, 255), Command::view_right},
     {"Y", {0, 1, 0}, IM_COL32(69, 168, 84, 255), Command::view_back},
     {"Z", {0, 0, 1}, IM_COL32(58, 134, 228, 255), Command::view_top},
     {"", {-1, 0, 0}, IM_COL32(232, 72, 85, 255), Command::view_left},
     {"", {0, -1, 0}, IM_COL32(69, 168, 84, 255), Command::view_front},
     {"", {0, 0, -1}, IM_COL32(58, 134, 228, 255), Command::view_bottom}}};

void draw_ball(Frame& frame, ImDrawList& list, const AxisBall& ball, const ImVec2& middle,
               const ImVec2& at) {
    const bool is_named = ball.name[0] != 0;
    const float size = frame.px(is_named ? 9.5 : 5.5);
    if (is_named) list.AddLine(middle, at, ball.color, frame.px(2));
    list.AddCircleFilled(at, size, is_named ? ball.color : (ball.color & 0x66FFFFFF));
    ImFont* const font = frame.fonts.small;
    const ImVec2 room = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, ball.name);
    list.AddText(font, font->FontSize, {at.x - 0.5F * room.x, at.y - 0.5F * room.y},
                 IM_COL32(255, 255, 255, 255), ball.name);
    ImGui::SetCursorScreenPos({at.x - size, at.y - size});
    ImGui::PushID(static_cast<int>(ball.command));
    if (ImGui::InvisibleButton("ball", ImVec2(2 * size, 2 * size))) frame.perform(ball.command);
    tip(frame, tip_of(ball.command));
    ImGui::PopID();
}

} // namespace

struct ScenePanel::State {
    explicit State(render::Renderer renderer) : renderer_(std::move(renderer)) {}

    void draw(Frame& frame, const Area& area);

    void place_camera(ViewModel& model, const render::Viewport& size);
    void render_scene(Frame& frame, const render::Viewport& view);
    void take_mouse(Frame& frame, const Area& area, const render::Viewport& size);
    void take_drag(ViewModel& model, const render::Viewport& size);
    void take_click(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_labels(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_witness(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_measure(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_triads(Frame& frame, const Area& area, const render::Viewport& size);
    void draw_grid_note(Frame& frame, const Area& area, const render::Viewport& size);
    void find_again(ViewModel& model, const render::Viewport& size);
    bool draws_coarsely();
    void draw_axes(Frame& frame, const Area& area);

    render::Renderer renderer_;
    std::optional<render::Canvas> canvas_;
    SceneKey drawn_;
    render::Scene scene_;
    int samples_ = 1;
    uint64_t framed_ = 0; // number of the opened program for which the camera was placed
    uint64_t found_ = 0;  // and of that for which the work was in sight
    PlacingOverlay placing_;
    float foot_ = 0.0F;                            // height of the bar at the lower edge, pixels
    bool is_turning_ = false, is_slow_ = false;    // see draws_coarsely
    render::Vec2 last_hover_ = render::Vec2(-1.0); // of the mouse
    std::optional<size_t> hovered_;                // block of the path under the mouse
};

void ScenePanel::State::place_camera(ViewModel& model, const render::Viewport& size) {
    model.camera.projection = model.settings.projection;
    if (model.camera_placed) return find_again(model, size);
    if (!model.program) return;
    const core::Aabb box = render::work_bounds(scene_of(model));
    if (box.empty()) return;
    const bool is_first = framed_ == 0;
    if (is_first) model.camera = render::seen_from(model.camera, render::StandardView::iso);
    model.camera = render::framing(model.camera, size, box);
    // The first picture lacks the tool: place the camera once more when the tool is known.
    model.camera_placed = model.block_state != nullptr;
    framed_ = model.camera_placed ? model.opening : 0;
}

/// Places the camera again if the work of a program that has just been opened is out of sight.
void ScenePanel::State::find_again(ViewModel& model, const render::Viewport& size) {
    if (found_ == model.opening || !model.block_state || model.block_state->is_outdated) return;
    found_ = model.opening;
    const core::Aabb box = render::work_bounds(scene_of(model));
    if (!box.empty() && !render::is_in_sight(model.camera, size, box))
        model.camera = render::framing(model.camera, size, box);
}

/// Whether the view is being turned or moved, and its first picture took too long: the others then
/// have half the size, until the button is released.
bool ScenePanel::State::draws_coarsely() {
    is_turning_ = is_turning_ && ImGui::IsAnyMouseDown();
    if (!is_turning_) is_slow_ = false;
    return is_turning_ && is_slow_;
}

void ScenePanel::State::render_scene(Frame& frame, const render::Viewport& view) {
    const bool is_coarse = draws_coarsely();
    const render::Viewport size =
        is_coarse ? render::Viewport{(view.width + 1) / 2, (view.height + 1) / 2} : view;
    const SceneKey key = key_of(frame.model, size);
    const bool fits = canvas_ && canvas_->size().width == size.width
                      && canvas_->size().height == size.height && canvas_->samples() == samples_;
    if (fits && key == drawn_) return;
    if (!fits) {
        auto canvas = render::Canvas::make(size, samples_);
        if (!canvas) {
            say(frame.model, canvas.error().message, frame.now);
            return;
        }
        canvas_ = *std::move(canvas);
    }
    scene_ = scene_of(frame.model);
    render::DrawOptions options;
    options.theme = frame.palette.theme;
    options.scale = frame.fonts.scale * (is_coarse ? 0.5 : 1.0);
    options.edges = !is_coarse;
    options.rough = is_coarse;
    const auto begin = std::chrono::steady_clock::now();
    renderer_.draw(scene_, frame.model.camera, options, *canvas_);
    drawn_ = key;
    if (!is_turning_ || is_coarse) return;
    glFinish(); // with software OpenGL, the time is spent here
    is_slow_ = std::chrono::steady_clock::now() - begin > slow_picture;
}

void ScenePanel::State::take_drag(ViewModel& model, const render::Viewport& size) {
    const ImGuiIO& io = ImGui::GetIO();
    const render::Vec2 by(io.MouseDelta.x, io.MouseDelta.y);
    if (by == render::Vec2(0.0)) return;
    const Drag drag = drag_of(model.settings);
    is_turning_ = is_turning_ || drag != Drag::none;
    switch (drag) {
    case Drag::none:
        return;
    case Drag::orbit:
        model.camera = render::orbited(model.camera, size, by);
        return;
    case Drag::pan: {
        const render::Vec2 middle(0.5 * size.width, 0.5 * size.height);
        model.camera = render::panned(model.camera, size, middle, middle + by, model.camera.target);
        return;
    }
    }
}

void ScenePanel::State::take_click(Frame& frame, const Area& area, const render::Viewport& size) {
    ViewModel& model = frame.model;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const render::Vec2 at(mouse.x - area.x, mouse.y - area.y);
    const render::Pick found = render::pick(scene_, model.camera, size, at, frame.px(6));
    if (model.section && model.section->pick != SectionPick::none) {
        if (const auto surface = found.surface()) take_section_click(model, *surface, frame.now);
        return;
    }
    if (placing_.take_pick_click(frame)) return;
    if (model.measuring.on) {
        const auto surface = found.surface();
        if (!surface) return;
        if (model.measuring.positions.size() == 2) model.measuring.positions.clear();
        model.measuring.positions.push_back(surface->point);
        return;
    }
    if (placing_.take_selection(model, found, scene_)) return;
    if (found.path) return go_to(model, found.path->block);
    if (found.stock && found.stock->block) {
        go_to(model, *found.stock->block);
        say(model, fmt::format("Cut by block {}, line {}", model.cursor.block, model.row().line),
            frame.now);
        return;
    }
    if (found.body && found.body->body < scene_.bodies.size())
        say(model, scene_.bodies[found.body->body].name, frame.now);
    else if (found.stock)
        say(model, "Raw stock: no block has cut here", frame.now);
}

void ScenePanel::State::take_mouse(Frame& frame, const Area& area, const render::Viewport& size) {
    ViewModel& model = frame.model;
    const ImGuiIO& io = ImGui::GetIO();
    const render::Vec2 at(io.MousePos.x - area.x, io.MousePos.y - area.y);
    if (ImGui::IsItemActive()) take_drag(model, size);
    if (!ImGui::IsItemHovered()) return;
    if (io.MouseWheel != 0.0F && io.KeyCtrl && model.section) {
        set_section_position(model, section_position(model) + io.MouseWheel * section_step(model));
    } else if (io.MouseWheel != 0.0F) {
        const auto surface = render::pick(scene_, model.camera, size, at).surface();
        model.camera =
            render::zoomed(model.camera, size, at, core::pow(0.85, io.MouseWheel),
                           surface ? std::optional<core::Vec3>(surface->point) : std::nullopt);
    }
    const ImVec2 dragged = ImGui::GetMouseDragDelta(ImGuiMouseButton_Left, 0.0F);
    const bool stood = std::abs(dragged.x) + std::abs(dragged.y) < 4.0F;
    if (ImGui::IsMouseReleased(ImGuiMouseButton_Left) && stood) take_click(frame, area, size);
    if (ImGui::IsAnyMouseDown() || !model.path || !model.settings.shown.path) return;
    if (at != last_hover_) {
        const auto hit = render::pick_path(*model.path, model.camera, size, at, frame.px(6));
        hovered_ = hit ? std::optional<size_t>(hit->block) : std::nullopt;
        last_hover_ = at;
    }
    if (hovered_) model.pointed_at = hovered_;
}

void ScenePanel::State::draw_witness(Frame& frame, const Area& area, const render::Viewport& size) {
    const ViewModel& model = frame.model;
    const auto witness = witness_of(model);
    if (!witness) return;
    const auto seen = render::project(model.camera, size, 0.5 * (witness->a + witness->b));
    if (!seen) return;
    const BlockRow& row = model.row();
    const bool loud = is_offending(row) || is_near(row);
    const ImVec2 at(area.x + static_cast<float>(seen->position.x),
                    area.y + static_cast<float>(seen->position.y));
    const std::string words = words_of(model, row);
    const float half =
        0.5F
            * frame.fonts.strong
                  ->CalcTextSizeA(frame.fonts.strong->FontSize, 1e9F, 0.0F, words.c_str())
                  .x
        + frame.px(16);
    // Beside the line, but within the view.
    const ImVec2 middle(
        std::clamp(at.x + frame.px(62), area.x + half,
                   std::max(area.x + area.width - half, area.x + half)),
        std::clamp(at.y - frame.px(58), area.y + frame.px(60),
                   std::max(area.y + area.height - frame.px(90), area.y + frame.px(60))));
    const ImU32 fill =
        loud ? frame.palette.of(row, Role::clear) : frame.palette.color(Role::raised, 0.95);
    ImU32 ink = frame.palette.color(Role::text);
    if (is_near(row)) ink = IM_COL32(20, 23, 28, 255);
    if (is_offending(row)) ink = IM_COL32(255, 255, 255, 255);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddLine(at, {middle.x - frame.px(20), middle.y + frame.px(10)}, fill, frame.px(1.5));
    draw_tag(frame, list, middle, words, fill, ink);
    const auto pair = witness_in(row, model.shown_pair);
    if (pair && loud) draw_pair_names(frame, list, middle, *pair);
}

namespace {

/// Draws the name of a zero below its arrows.
void draw_name_tag(const Frame& frame, const Area& area, const render::Viewport& size,
                   const render::Triad& triad) {
    const auto seen = render::project(frame.model.camera, size, triad.origin);
    if (!seen || triad.name.empty()) return;
    ImFont* const font = frame.fonts.small;
    const ImVec2 room = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, triad.name.c_str());
    const ImVec2 a(area.x + static_cast<float>(seen->position.x) - 0.5F * room.x - frame.px(5),
                   area.y + static_cast<float>(seen->position.y) + frame.px(10));
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(a, {a.x + room.x + frame.px(10), a.y + room.y + frame.px(4)},
                       frame.palette.color(Role::panel, 0.8), frame.px(3));
    list.AddText(font, font->FontSize, {a.x + frame.px(5), a.y + frame.px(2)},
                 frame.palette.color(triad.is_minor ? Role::dim : Role::text), triad.name.c_str());
}

} // namespace

/// Draws the letters of the arrows at the zeros, and their names.
void ScenePanel::State::draw_triads(Frame& frame, const Area& area, const render::Viewport& size) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ImFont* const font = frame.fonts.small;
    const auto label = [&](const core::Vec3& at, const std::string& words, ImVec2 by, ImU32 ink) {
        const auto seen = render::project(frame.model.camera, size, at);
        if (!seen) return;
        const ImVec2 room = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, words.c_str());
        const ImVec2 p(area.x + static_cast<float>(seen->position.x) - 0.5F * room.x + by.x,
                       area.y + static_cast<float>(seen->position.y) - 0.5F * room.y + by.y);
        list.AddText(font, font->FontSize, {p.x + 1.0F, p.y + 1.0F},
                     frame.palette.color(Role::background, 0.9), words.c_str());
        list.AddText(font, font->FontSize, p, ink, words.c_str());
    };
    const Role roles[] = {Role::axis_x, Role::axis_y, Role::axis_z};
    constexpr const char* letters[] = {"X", "Y", "Z"};
    for (const render::Triad& triad : scene_.triads) {
        const double pixel = render::pixel_size(frame.model.camera, size, triad.origin);
        const double length = (render::length_in_pixels(triad) + 20.0) * frame.fonts.scale * pixel;
        for (int axis = 0; axis < 3; ++axis)
            label(triad.origin + length * triad.axes[axis], letters[axis], {0, 0},
                  frame.palette.color(roles[axis]));
        draw_name_tag(frame, area, size, triad);
    }
}

/// Draws the distances of the lines of the grid in the lower right corner.
void ScenePanel::State::draw_grid_note(Frame& frame, const Area& area,
                                       const render::Viewport& size) {
    if (!scene_.ground || area.width < frame.px(440)) return;
    const render::GridStep step =
        render::grid_view(*scene_.ground, frame.model.camera, size, frame.fonts.scale).step;
    const double unit = scene_.ground->inch ? core::mm_per_inch : 1.0;
    const std::string words = fmt::format("Grid {:g} / {:g} {}", step.fine / unit,
                                          step.coarse / unit, length_unit(frame.model));
    ImFont* const font = frame.fonts.small;
    const ImVec2 room = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, words.c_str());
    ImGui::GetWindowDrawList()->AddText(font, font->FontSize,
                                        {area.x + area.width - room.x - frame.px(14),
                                         area.y + area.height - foot_ - room.y - frame.px(12)},
                                        frame.palette.color(Role::dim), words.c_str());
}

void ScenePanel::State::draw_measure(Frame& frame, const Area& area, const render::Viewport& size) {
    const ViewModel& model = frame.model;
    const std::vector<core::Vec3>& positions = model.measuring.positions;
    if (positions.size() != 2) return;
    const core::Vec3 way = positions[1] - positions[0];
    const auto seen = render::project(model.camera, size, 0.5 * (positions[0] + positions[1]));
    if (!seen) return;
    draw_tag(frame, *ImGui::GetWindowDrawList(),
             {area.x + static_cast<float>(seen->position.x),
              area.y + static_cast<float>(seen->position.y) - frame.px(26)},
             fmt::format("{} {}   X {}  Y {}  Z {}", length_text(model, glm::length(way)),
                         length_unit(model), length_text(model, way.x), length_text(model, way.y),
                         length_text(model, way.z)),
             frame.palette.color(Role::accent), IM_COL32(255, 255, 255, 255));
}

void ScenePanel::State::draw_labels(Frame& frame, const Area& area, const render::Viewport& size) {
    const ViewModel& model = frame.model;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.PushClipRect(area.corner(), area.far_corner(), true);
    draw_triads(frame, area, size);
    draw_witness(frame, area, size);
    draw_measure(frame, area, size);
    placing_.draw_picks(frame, area, size);
    draw_grid_note(frame, area, size);
    if (model.has_rows())
        draw_pill(frame, list, {area.x + frame.px(14), area.y + frame.px(14)},
                  is_jogged(model) ? "Axes moved by hand: not checked (Esc)"
                                   : location_text(model));
    draw_warning(frame, list, area);
    const Area free{area.x, area.y, area.width, area.height - foot_};
    draw_summary(frame, list, free);
    std::string words = section_hint(model);
    if (frame.now < model.message_until) words = model.message;
    if (model.is_busy && !model.block_state)
        words = model.has_rows() ? "Modelling the stock \xE2\x80\xA6" : "Reading \xE2\x80\xA6";
    if (!model.reading_text.empty()) words = model.reading_text;
    if (!words.empty())
        draw_pill(frame, list, {free.x + frame.px(14), free.y + free.height - frame.px(44)}, words);
    list.PopClipRect();
}

void ScenePanel::State::draw_axes(Frame& frame, const Area& area) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float radius = frame.px(43);
    const ImVec2 middle(area.x + area.width - radius - frame.px(14),
                        area.y + radius + frame.px(14));
    list.AddCircleFilled(middle, radius, frame.palette.color(Role::panel, 0.6), 48);
    const render::CameraAxes seen = render::axes(frame.model.camera);
    std::array<AxisBall, 6> balls = axis_balls;
    std::sort(balls.begin(), balls.end(), [&](const AxisBall& a, const AxisBall& b) {
        return glm::dot(a.axis, seen.backward) < glm::dot(b.axis, seen.backward);
    });
    const float reach = radius - frame.px(13);
    for (const AxisBall& ball : balls)
        draw_ball(frame, list, ball, middle,
                  {middle.x + reach * static_cast<float>(glm::dot(ball.axis, seen.right)),
                   middle.y - reach * static_cast<float>(glm::dot(ball.axis, seen.up))});
}

void ScenePanel::State::draw(Frame& frame, const Area& area) {
    const render::Viewport size{std::max(static_cast<int>(area.width), 16),
                                std::max(static_cast<int>(area.height), 16)};
    place_camera(frame.model, size);
    render_scene(frame, size);
    if (!canvas_) return;
    ImGui::SetCursorScreenPos(area.corner());
    const auto texture = reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(canvas_->texture()));
    ImGui::GetWindowDrawList()->AddImage(texture, area.corner(), area.far_corner(), ImVec2(0, 1),
                                         ImVec2(1, 0));
    ImGui::InvisibleButton("scene", area.size(),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle
                               | ImGuiButtonFlags_MouseButtonRight);
    ImGui::SetItemAllowOverlap();
    if (!placing_.draw_handles(frame, area, size)) {
        placing_.find_picks(frame, area, size, scene_);
        take_mouse(frame, area, size);
    }
    foot_ = draw_section_bar(frame, area);
    draw_labels(frame, area, size);
    if (area.width > frame.px(440)) draw_axes(frame, area);
}

ScenePanel::ScenePanel(render::Renderer renderer)
    : state_(std::make_unique<State>(std::move(renderer))) {}

ScenePanel::~ScenePanel() = default;

void ScenePanel::draw(Frame& frame, const Area& area) { state_->draw(frame, area); }

void ScenePanel::set_samples(int samples) { state_->samples_ = samples; }

} // namespace app::viewer
