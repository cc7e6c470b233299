#include "app/view/ui/gizmo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "app/view/model/view_model.h"
#include "core/base/math.h"
#include "core/base/units.h"

namespace app::viewer {
namespace {

constexpr double arrow = 78.0, arrow_begin = 14.0, square_near = 20.0, square_far = 36.0,
                 ring = 96.0; // pixels at scale 1
constexpr double reach = 7.0; // pixels around a handle in which it is grasped
constexpr std::array<ImU32, 3> axis_colors = {
    IM_COL32(232, 72, 85, 255), IM_COL32(69, 168, 84, 255), IM_COL32(58, 134, 228, 255)};
constexpr ImU32 bright_color = IM_COL32(255, 214, 64, 255);

core::Vec3 unit(int axis) {
    core::Vec3 v(0.0);
    v[axis] = 1.0;
    return v;
}

double distance_to_segment(ImVec2 p, ImVec2 a, ImVec2 b) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double length = dx * dx + dy * dy;
    const double t =
        length > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length, 0.0, 1.0) : 0.0;
    const double x = a.x + t * dx - p.x, y = a.y + t * dy - p.y;
    return std::sqrt(x * x + y * y);
}

double distance_to_line(ImVec2 p, const std::vector<ImVec2>& line) {
    double least = core::infinity;
    for (size_t i = 1; i < line.size(); ++i)
        least = std::min(least, distance_to_segment(p, line[i - 1], line[i]));
    return least;
}

double snapped(double value, double step) {
    return step > 0.0 ? core::round(value / step) * step : value;
}

double length_step(bool inch) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.KeyShift) return 0.0;
    const double step = inch ? 0.05 * core::mm_per_inch : 1.0;
    return io.KeyCtrl ? 0.1 * step : step;
}

double angle_step() {
    const ImGuiIO& io = ImGui::GetIO();
    return io.KeyShift ? 0.0 : io.KeyCtrl ? 1.0 : 15.0;
}

} // namespace

struct Gizmo::Place {
    const Frame& frame;
    const Area& area;
    const render::Viewport& size;
    core::Vec3 center;
    double pixel; // mm

    double mm(double pixels) const { return frame.fonts.scale * pixels * pixel; }
    std::optional<ImVec2> on_screen(const core::Vec3& point) const {
        const auto seen = render::project(frame.model.camera, size, point);
        if (!seen) return std::nullopt;
        return ImVec2(area.x + static_cast<float>(seen->position.x),
                      area.y + static_cast<float>(seen->position.y));
    }
    render::Ray ray() const {
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        return render::ray_through(frame.model.camera, size, {mouse.x - area.x, mouse.y - area.y});
    }
    std::vector<ImVec2> line(const std::vector<core::Vec3>& points) const {
        std::vector<ImVec2> seen;
        for (const core::Vec3& point : points)
            if (const auto at = on_screen(point)) seen.push_back(*at);
        return seen;
    }
    std::vector<core::Vec3> arrow_of(int axis) const {
        return {center + mm(arrow_begin) * unit(axis), center + mm(arrow) * unit(axis)};
    }
    std::vector<core::Vec3> square_of(int axis) const {
        const core::Vec3 u = unit((axis + 1) % 3), v = unit((axis + 2) % 3);
        const double a = mm(square_near), b = mm(square_far);
        return {center + a * u + a * v, center + b * u + a * v, center + b * u + b * v,
                center + a * u + b * v};
    }
    /// The half of the ring that is nearer to the eye.
    std::vector<core::Vec3> ring_of(int axis) const {
        constexpr int count = 32;
        const core::Vec3 u = unit((axis + 1) % 3), v = unit((axis + 2) % 3);
        const core::Vec3 backward = render::axes(frame.model.camera).backward;
        const double middle = core::atan2(glm::dot(backward, v), glm::dot(backward, u));
        std::vector<core::Vec3> points;
        for (int i = 0; i <= count; ++i) {
            const double angle = middle + std::numbers::pi * (static_cast<double>(i) / count - 0.5);
            points.push_back(center + mm(ring) * (core::cos(angle) * u + core::sin(angle) * v));
        }
        return points;
    }
};

/// Where a handle is grasped by the mouse: on its axis, or in its plane; empty if that is seen end
/// on.
std::optional<core::Vec3> Gizmo::grasped_at(const Place& place, const Grip& grip) const {
    constexpr double least = 0.02; // sine of the angle between ray and axis, or ray and plane
    const render::Ray ray = place.ray();
    const core::Vec3 axis = unit(grip.axis), to = ray.origin - center_;
    const double along = glm::dot(ray.direction, axis);
    if (grip.kind == Handle::axis) {
        const double across = 1.0 - along * along;
        if (across < least) return std::nullopt;
        const double t = (glm::dot(to, axis) - along * glm::dot(to, ray.direction)) / across;
        return center_ + t * axis;
    }
    if (std::abs(along) < least) return std::nullopt;
    return ray.origin - (glm::dot(to, axis) / along) * ray.direction;
}

Gizmo::Grip Gizmo::under_mouse(const Place& place, bool can_turn) const {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const double near = place.frame.fonts.scale * reach;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<ImVec2> square = place.line(place.square_of(axis));
        if (square.size() < 4) continue;
        square.push_back(square.front());
        double turn = 0.0; // inside a convex polygon all products have one sign
        bool is_inside = true;
        for (size_t i = 1; i < square.size(); ++i) {
            const double product = (square[i].x - square[i - 1].x) * (mouse.y - square[i - 1].y)
                                   - (square[i].y - square[i - 1].y) * (mouse.x - square[i - 1].x);
            is_inside = is_inside && product * turn >= 0.0;
            turn = product;
        }
        if (is_inside) return {Handle::plane, axis};
    }
    Grip best;
    double least = near;
    const auto offer = [&](Handle kind, int axis, const std::vector<core::Vec3>& points) {
        const double distance = distance_to_line(mouse, place.line(points));
        if (distance >= least) return;
        least = distance;
        best = {kind, axis};
    };
    for (int axis = 0; axis < 3; ++axis) offer(Handle::axis, axis, place.arrow_of(axis));
    for (int axis = 0; axis < 3 && can_turn; ++axis) offer(Handle::ring, axis, place.ring_of(axis));
    return best;
}

void Gizmo::draw_handles(const Place& place, const Grip& bright, bool can_turn) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const auto color = [&](Handle kind, int axis) {
        return bright == Grip{kind, axis} ? bright_color : axis_colors[static_cast<size_t>(axis)];
    };
    const auto thick = static_cast<float>(place.frame.fonts.scale);
    for (int axis = 0; axis < 3; ++axis) {
        if (can_turn) {
            const std::vector<ImVec2> line = place.line(place.ring_of(axis));
            list.AddPolyline(line.data(), static_cast<int>(line.size()), color(Handle::ring, axis),
                             0, 2.0F * thick);
        }
        const std::vector<ImVec2> square = place.line(place.square_of(axis));
        if (square.size() == 4) {
            const ImU32 fill = color(Handle::plane, axis);
            list.AddConvexPolyFilled(square.data(), 4, (fill & 0x00FFFFFF) | 0x70000000);
        }
        const std::vector<ImVec2> line = place.line(place.arrow_of(axis));
        if (line.size() != 2) continue;
        const ImU32 ink = color(Handle::axis, axis);
        list.AddLine(line[0], line[1], ink, 3.0F * thick);
        list.AddCircleFilled(line[1], 5.5F * thick, ink);
    }
}

core::Transform Gizmo::moved(const Frame& frame, std::string& words) const {
    const ViewModel& model = frame.model;
    const core::Vec3 axis = unit(grip_.axis);
    if (grip_.kind == Handle::ring) {
        const core::Vec3 a = begin_ - center_, b = now_ - center_;
        const double radians = core::atan2(glm::dot(glm::cross(a, b), axis), glm::dot(a, b));
        const double degrees = snapped(radians * 180.0 / std::numbers::pi, angle_step());
        const core::Mat3 turn = core::rotation_xyz_deg(degrees * axis);
        words = fmt::format("{} {:+.6g}\xC2\xB0", "XYZ"[grip_.axis], degrees);
        return {turn, center_ - turn * center_};
    }
    const double step = length_step(model.settings.inch);
    core::Vec3 by = now_ - begin_;
    words.clear();
    for (int i = 0; i < 3; ++i) {
        by[i] = snapped(by[i], step);
        const bool counts = grip_.kind == Handle::axis ? i == grip_.axis : i != grip_.axis;
        if (!counts) by[i] = 0.0;
        if (counts)
            words += fmt::format("{}{} {}{}", words.empty() ? "" : "   ", "XYZ"[i],
                                 by[i] < 0.0 ? "" : "+", length_text(model, by[i], 3));
    }
    words += std::string(" ") + length_unit(model);
    return core::translation(by);
}

Gizmo::Drag Gizmo::draw(Frame& frame, const Area& area, const render::Viewport& size,
                        const core::Vec3& center, bool can_turn) {
    Drag drag;
    const double pixel = render::pixel_size(frame.model.camera, size, center);
    const Place place{frame, area, size, center, pixel};
    const bool is_dragging = grip_.kind != Handle::none;
    if (!is_dragging) center_ = center;
    const bool is_over_view = ImGui::IsItemHovered() || is_dragging;
    const Grip over = is_dragging ? grip_ : is_over_view ? under_mouse(place, can_turn) : Grip{};
    draw_handles(place, over, can_turn);
    drag.takes_mouse = over.kind != Handle::none;
    if (!is_dragging && drag.takes_mouse && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
        if (const auto at = grasped_at(place, over)) {
            grip_ = over;
            begin_ = now_ = *at;
        }
        return drag;
    }
    if (!is_dragging) return drag;
    if (const auto at = grasped_at(place, grip_)) now_ = *at;
    drag.by = moved(frame, drag.words);
    drag.is_done = !ImGui::IsMouseDown(ImGuiMouseButton_Left);
    const bool is_dropped = ImGui::IsKeyDown(key::escape);
    if (is_dropped) drag.by.reset();
    if (drag.is_done || is_dropped) grip_ = {};
    return drag;
}

} // namespace app::viewer
