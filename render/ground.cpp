#include "render/ground.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/base/units.h"

namespace render {
namespace {

constexpr double least_pixels = 24.0; // between two lines

/// A number times a power of ten, rounded once.
double scaled(double number, int power) {
    double ten = 1.0;
    for (int i = 0; i < std::abs(power); ++i) ten *= 10.0;
    return power < 0 ? number / ten : number * ten;
}

constexpr int finest = -4, coarsest = 6; // powers of ten; nobody zooms further

constexpr double reach_in_steps = 44.0; // of the grid, from the middle of the view
constexpr float weak_line = 0.45F;      // strength of the lines between the strong ones

core::Aabb box_in(const core::Transform& target_from_box, const core::Aabb& box) {
    core::Aabb moved;
    if (box.empty()) return moved;
    for (int corner = 0; corner < 8; ++corner)
        moved.extend(target_from_box
                     * Vec3((corner & 1) != 0 ? box.max.x : box.min.x,
                            (corner & 2) != 0 ? box.max.y : box.min.y,
                            (corner & 4) != 0 ? box.max.z : box.min.z));
    return moved;
}

} // namespace

GridStep step_of_at_least(double least, bool inch) {
    const double unit = inch ? core::mm_per_inch : 1.0;
    GridStep step{unit * scaled(1.0, coarsest + 1), unit * scaled(1.0, coarsest + 2)};
    for (int power = coarsest; power >= finest; --power)
        for (const double number : {5.0, 2.0, 1.0}) {
            const double fine = unit * scaled(number, power);
            if (fine < least) return step;
            step = {fine, unit * scaled(number > 2.0 ? 50.0 : 10.0, power)};
        }
    return step;
}

GridView grid_view(const Ground& ground, const Camera& camera, const Viewport& viewport,
                   double scale) {
    const double pixel = pixel_size(camera, viewport, camera.target);
    const GridStep step = step_of_at_least(least_pixels * scale * pixel, ground.inch);
    return {step, Vec2(ground.scene_from_ground.inverse() * camera.target),
            reach_in_steps * step.fine};
}

core::Aabb ground_bounds(const Ground& ground, const Camera& camera, const Viewport& viewport,
                         double scale) {
    const GridView view = grid_view(ground, camera, viewport, scale);
    return box_in(ground.scene_from_ground, {Vec3(view.middle - Vec2(view.reach), 0.0),
                                             Vec3(view.middle + Vec2(view.reach), 0.0)});
}

std::vector<GridPoint> grid_lines(const GridView& view) {
    const double fine = view.step.fine, many = core::round(view.step.coarse / fine);
    std::vector<GridPoint> points;
    for (const int axis : {0, 1}) {
        const double first = std::ceil((view.middle[axis] - view.reach) / fine);
        const double last = std::floor((view.middle[axis] + view.reach) / fine);
        for (double line = first; line <= last; line += 1.0) {
            const bool is_strong = std::fmod(line, many) == 0.0;
            const double reach = is_strong ? view.reach : view.fine_reach();
            if (std::abs(line * fine - view.middle[axis]) > reach) continue;
            for (const double end : {-reach, reach}) {
                Vec3 place(0.0);
                place[axis] = line * fine;
                place[1 - axis] = view.middle[1 - axis] + end;
                points.push_back({glm::vec3(place), is_strong ? 1.0F : weak_line});
            }
        }
    }
    return points;
}

namespace {

constexpr int shadow_cells = 144;         // along the longer side
constexpr size_t many_triangles = 40'000; // more: the shadow of the boxes of the mesh

/// The least height of anything above each cell.
class HeightField {
public:
    HeightField(const core::Aabb& box, double margin) {
        const Vec3 size = box.size() + Vec3(2.0 * margin);
        const double side = std::max(size.x, size.y) / shadow_cells;
        mask.origin = Vec2(box.min) - Vec2(margin);
        mask.cell = Vec2(side);
        mask.columns = std::clamp(static_cast<int>(size.x / side) + 1, 1, shadow_cells + 1);
        mask.rows = std::clamp(static_cast<int>(size.y / side) + 1, 1, shadow_cells + 1);
        heights.assign(static_cast<size_t>(mask.columns) * static_cast<size_t>(mask.rows),
                       core::infinity);
    }

    void add(const core::Aabb& box) {
        if (box.empty()) return;
        const Span x = cells(0, box.min.x, box.max.x), y = cells(1, box.min.y, box.max.y);
        for (int row = y.first; row < y.last; ++row)
            for (int column = x.first; column < x.last; ++column) lower(column, row, box.min.z);
    }

    void add(const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 across = glm::cross(b - a, c - a);
        if (across.z == 0.0) return; // upright: its neighbours cover its cells
        const Span x = cells(0, std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}));
        const Span y = cells(1, std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
        for (int row = y.first; row < y.last; ++row)
            for (int column = x.first; column < x.last; ++column) {
                const Vec2 p = mask.origin + (Vec2(column, row) + 0.5) * mask.cell;
                if (!contains(a, b, c, across.z, p)) continue;
                const Vec2 from = p - Vec2(a);
                lower(column, row, a.z - (across.x * from.x + across.y * from.y) / across.z);
            }
    }

    ShadowMask mask;
    std::vector<double> heights;

private:
    struct Span {
        int first = 0, last = 0;
    };

    /// The cells whose centres are between two positions.
    Span cells(int axis, double from, double to) const {
        const int count = axis == 0 ? mask.columns : mask.rows;
        const auto first_at_or_after = [&](double position) {
            const double at = (position - mask.origin[axis]) / mask.cell[axis] - 0.5;
            return static_cast<int>(std::ceil(std::clamp(at, 0.0, static_cast<double>(count))));
        };
        return {first_at_or_after(from), first_at_or_after(to)};
    }

    static bool contains(const Vec3& a, const Vec3& b, const Vec3& c, double area, const Vec2& p) {
        const auto side = [&](const Vec3& from, const Vec3& to) {
            return ((to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x)) * area;
        };
        return side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0;
    }

    void lower(int column, int row, double height) {
        double& known = heights[static_cast<size_t>(row) * static_cast<size_t>(mask.columns)
                                + static_cast<size_t>(column)];
        known = std::min(known, height);
    }
};

bool casts_shadow(const Body& body) {
    return body.visible && body.mesh && body.role != BodyRole::machine
           && body.role != BodyRole::part && !is_of_tool(body.role);
}

void add_body(HeightField& field, const TriangleMesh& mesh, const core::Transform& pose) {
    if (mesh.triangles.size() > many_triangles) {
        for (const core::Aabb& box : mesh.boxes) field.add(box_in(pose, box));
        if (mesh.boxes.empty()) field.add(box_in(pose, mesh.bounds));
        return;
    }
    std::vector<Vec3> places;
    places.reserve(mesh.vertices.size());
    for (const MeshVertex& vertex : mesh.vertices) places.push_back(pose * Vec3(vertex.position));
    for (const TriangleMesh::Corners& t : mesh.triangles)
        field.add(places[t[0]], places[t[1]], places[t[2]]);
}

/// The mean over a window, along the columns or the rows; beyond the border there is no shadow.
void blur(std::vector<double>& values, int count, int step, int lines, int line_step, int reach) {
    std::vector<double> line(static_cast<size_t>(count));
    for (int l = 0; l < lines; ++l) {
        double sum = 0.0;
        const auto at = [&](int i) -> double& {
            return values[static_cast<size_t>(l * line_step + i * step)];
        };
        for (int i = 0; i < std::min(reach, count); ++i) sum += at(i);
        for (int i = 0; i < count; ++i) {
            if (i + reach < count) sum += at(i + reach);
            line[static_cast<size_t>(i)] = sum / (2 * reach + 1);
            if (i - reach >= 0) sum -= at(i - reach);
        }
        for (int i = 0; i < count; ++i) at(i) = std::max(line[static_cast<size_t>(i)], 0.0);
    }
}

} // namespace

ShadowKey shadow_key(const Scene& scene) {
    ShadowKey key;
    if (!scene.ground) return key;
    key.ground = scene.ground->scene_from_ground;
    for (const Body& body : scene.bodies)
        if (casts_shadow(body)) key.bodies.emplace_back(body.mesh, body.stock_from_body);
    if (scene.stock_visible) key.stock = scene.stock;
    return key;
}

ShadowMask shadow_mask(const Scene& scene) {
    const ShadowKey key = shadow_key(scene);
    const core::Transform ground_from_scene = key.ground.inverse();
    core::Aabb box;
    for (const auto& [mesh, pose] : key.bodies)
        box.extend(box_in(ground_from_scene * pose, mesh->bounds));
    for (const auto& brick : key.stock) box.extend(box_in(ground_from_scene, brick->mesh.bounds));
    if (box.empty() || !core::is_finite(box.min) || !core::is_finite(box.max)) return {};
    const double size = std::max({box.size().x, box.size().y, 1.0});
    HeightField field(box, 0.14 * size);
    for (const auto& [mesh, pose] : key.bodies) add_body(field, *mesh, ground_from_scene * pose);
    for (const auto& brick : key.stock) field.add(box_in(ground_from_scene, brick->mesh.bounds));
    std::vector<double> dark;
    dark.reserve(field.heights.size());
    for (const double height : field.heights) {
        const double left = std::clamp(1.0 - height / (0.6 * size), 0.0, 1.0);
        dark.push_back(left * left);
    }
    ShadowMask mask = std::move(field.mask);
    for (int pass = 0; pass < 3; ++pass) {
        blur(dark, mask.columns, 1, mask.rows, mask.columns, 4);
        blur(dark, mask.rows, mask.columns, mask.columns, 1, 4);
    }
    for (const double value : dark)
        mask.values.push_back(static_cast<uint8_t>(std::floor(255.0 * std::min(value, 1.0) + 0.5)));
    return mask;
}

} // namespace render
