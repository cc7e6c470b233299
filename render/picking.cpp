#include "render/picking.h"

#include <algorithm>
#include <cmath>

namespace render {
namespace {

/// Whether a ray meets a box nearer than `limit`.
bool meets(const Aabb& box, const Ray& ray, double limit) {
    if (box.empty()) return false;
    double near = 0.0, far = limit;
    for (int i = 0; i < 3; ++i) {
        if (ray.direction[i] == 0.0) {
            if (ray.origin[i] < box.min[i] || ray.origin[i] > box.max[i]) return false;
            continue;
        }
        const double a = (box.min[i] - ray.origin[i]) / ray.direction[i];
        const double b = (box.max[i] - ray.origin[i]) / ray.direction[i];
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    return near <= far * (1.0 + 1e-12) + 1e-9;
}

/// Distance along the ray at which it hits the front of a triangle (Moeller, Trumbore 1997).
double distance_along(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a;
    const Vec3 p = glm::cross(ray.direction, ac);
    const double volume = glm::dot(ab, p);
    if (volume <= 0.0) return core::infinity;
    const Vec3 from = ray.origin - a;
    const double u = glm::dot(from, p);
    if (u < 0.0 || u > volume) return core::infinity;
    const Vec3 q = glm::cross(from, ab);
    const double v = glm::dot(ray.direction, q);
    if (v < 0.0 || u + v > volume) return core::infinity;
    const double along = glm::dot(ac, q) / volume;
    return along >= 0.0 ? along : core::infinity;
}

bool is_visible(const std::optional<SectionPlane>& section, const Vec3& p) {
    return !section || glm::dot(section->normal, p) <= section->offset;
}

enum class Side : uint8_t { front, back };

/// The nearest hit of one side of a mesh's triangles before `limit`.
std::optional<SurfaceHit> hit_before(const TriangleMesh& mesh, const Ray& ray,
                                     const std::optional<SectionPlane>& section, double limit,
                                     size_t& triangle, Side side = Side::front) {
    if (!meets(mesh.bounds, ray, limit)) return std::nullopt;
    std::optional<SurfaceHit> best;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!mesh.boxes.empty() && t % TriangleMesh::stretch == 0
            && !meets(mesh.boxes[t / TriangleMesh::stretch], ray, limit)) {
            t += TriangleMesh::stretch - 1;
            continue;
        }
        const TriangleMesh::Corners& corners = mesh.triangles[t];
        const Vec3 a(mesh.vertices[corners[0]].position), b(mesh.vertices[corners[1]].position),
            c(mesh.vertices[corners[2]].position);
        const double along =
            side == Side::front ? distance_along(ray, a, b, c) : distance_along(ray, a, c, b);
        if (!(along < limit)) continue;
        const Vec3 point = ray.origin + along * ray.direction;
        if (!is_visible(section, point)) continue;
        limit = along;
        triangle = t;
        best = {along, point, glm::normalize(glm::cross(b - a, c - a))};
    }
    return best;
}

/// Where a ray crosses the plane of a section from the side that is cut away.
std::optional<SurfaceHit> plane_hit(const SectionPlane& section, const Ray& ray) {
    const double towards = -glm::dot(section.normal, ray.direction);
    const double above = glm::dot(section.normal, ray.origin) - section.offset;
    if (!(towards > 0.0) || above < 0.0) return std::nullopt;
    const double along = above / towards;
    return SurfaceHit{along, ray.origin + along * ray.direction, section.normal};
}

/// The section face where a ray leaves a mesh without having entered it: the ray was inside when it
/// crossed the plane.
std::optional<SurfaceHit> cap_before(const TriangleMesh& mesh, const Ray& ray,
                                     const std::optional<SectionPlane>& section, double limit) {
    if (!section) return std::nullopt;
    const auto cap = plane_hit(*section, ray);
    size_t ignored = 0;
    const bool is_within = cap && hit_before(mesh, ray, section, limit, ignored, Side::back);
    return is_within ? cap : std::nullopt;
}

/// The box in the picture; everything if a part of it is behind the eye.
struct Rectangle {
    Vec2 min = Vec2(core::infinity), max = Vec2(-core::infinity);

    double distance(const Vec2& p) const {
        return glm::length(glm::max(glm::max(min - p, p - max), Vec2(0.0)));
    }
};

Rectangle seen(const Aabb& box, const Camera& camera, const Viewport& viewport) {
    Rectangle all;
    if (box.empty()) return all;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p((corner & 1) != 0 ? box.max.x : box.min.x,
                     (corner & 2) != 0 ? box.max.y : box.min.y,
                     (corner & 4) != 0 ? box.max.z : box.min.z);
        const auto position = project(camera, viewport, p);
        if (!position) return {Vec2(-core::infinity), Vec2(core::infinity)};
        all.min = glm::min(all.min, position->position);
        all.max = glm::max(all.max, position->position);
    }
    return all;
}

/// The path near the cursor.
class PathSearch {
public:
    PathSearch(const ToolPath& path, const Camera& camera, const Viewport& viewport,
               const Vec2& cursor, double reach, double depth)
        : path_(path),
          camera_(camera),
          viewport_(viewport),
          cursor_(cursor),
          reach_(reach),
          depth_(depth) {}

    std::optional<PathHit> run() {
        for (size_t g = 0; g < path_.groups.size(); ++g) {
            if (!is_near(path_.groups[g])) continue;
            const size_t end = std::min((g + 1) * ToolPath::group, path_.boxes.size());
            for (size_t b = g * ToolPath::group; b < end; ++b)
                if (is_near(path_.boxes[b])) try_stretch(b);
        }
        return best_;
    }

private:
    bool is_near(const Aabb& box) const {
        return !box.empty() && seen(box, camera_, viewport_).distance(cursor_) <= reach_;
    }
    void try_stretch(size_t box) {
        const size_t end = std::min((box + 1) * ToolPath::stretch, path_.points.size());
        for (size_t i = std::max<size_t>(1, box * ToolPath::stretch); i < end; ++i)
            if (!path_.points[i].begins) try_piece(i);
    }
    void try_piece(size_t end);

    const ToolPath& path_;
    const Camera& camera_;
    const Viewport& viewport_;
    Vec2 cursor_;
    double reach_, depth_;
    double best_depth_ = core::infinity;
    std::optional<PathHit> best_;
};

void PathSearch::try_piece(size_t end) {
    const Vec3 a(path_.points[end - 1].position), b(path_.points[end].position);
    const auto from = project(camera_, viewport_, a), to = project(camera_, viewport_, b);
    if (!from || !to) return;
    const Vec2 by = to->position - from->position;
    const double size = glm::dot(by, by);
    const double fraction =
        size > 0.0 ? std::clamp(glm::dot(cursor_ - from->position, by) / size, 0.0, 1.0) : 0.0;
    const double pixels = glm::distance(cursor_, from->position + fraction * by);
    // With perspective, a fraction in the picture differs from the fraction in space: farther
    // pieces look shorter.
    const double along =
        camera_.projection == Projection::perspective
            ? fraction * from->depth / (fraction * from->depth + (1.0 - fraction) * to->depth)
            : fraction;
    const Vec3 position = a + along * (b - a);
    const double depth = from->depth + along * (to->depth - from->depth);
    if (pixels > reach_ || depth > depth_) return;
    const bool nearer_to_cursor = !best_ || pixels < best_->pixels - 1.0;
    const bool as_near = best_ && pixels < best_->pixels + 1.0;
    if (!nearer_to_cursor && !(as_near && depth < best_depth_ - 1e-9)) return;
    best_ = PathHit{path_.points[end].block, end, position, pixels};
    best_depth_ = depth;
}

} // namespace

std::optional<SurfaceHit> Pick::surface() const {
    if (stock) return stock->at;
    if (body) return body->at;
    return std::nullopt;
}

std::optional<SurfaceHit> pick_mesh(const TriangleMesh& mesh, const Ray& ray,
                                    const std::optional<SectionPlane>& section, size_t* triangle) {
    size_t met = 0;
    const auto hit = hit_before(mesh, ray, section, core::infinity, met);
    if (hit && triangle != nullptr) *triangle = met;
    return hit;
}

std::optional<StockHit> pick_stock(const Scene& scene, const Ray& ray) {
    std::optional<StockHit> best;
    if (!scene.stock_visible) return best;
    for (const auto& brick : scene.stock) {
        size_t triangle = 0;
        const auto hit = hit_before(brick->mesh, ray, scene.section,
                                    best ? best->at.distance : core::infinity, triangle);
        if (!hit) continue;
        const uint32_t block = brick->blocks[triangle / 2];
        best = StockHit{*hit, block == StockBrick::raw ? std::nullopt : std::optional(block)};
    }
    const double limit = best ? best->at.distance : core::infinity;
    for (const auto& brick : scene.stock)
        if (const auto cap = cap_before(brick->mesh, ray, scene.section, limit))
            return StockHit{*cap, std::nullopt};
    return best;
}

std::optional<BodyHit> pick_body(const Scene& scene, const Ray& ray, bool through_glass) {
    std::optional<BodyHit> best;
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
        const Body& body = scene.bodies[i];
        if (!body.visible || !body.mesh || (through_glass && body.alpha < 1.0)) continue;
        const core::Transform back = body.stock_from_body.inverse();
        const Ray own{back * ray.origin, back.rotation * ray.direction};
        std::optional<SectionPlane> section;
        if (is_cut_by_section(scene, body.role))
            section = {back.rotation * scene.section->normal,
                       scene.section->offset
                           - glm::dot(scene.section->normal, body.stock_from_body.translation)};
        const double limit = best ? best->at.distance : core::infinity;
        size_t triangle = 0;
        // A section face is in front of anything that the ray hits inside, at any distance.
        auto hit = hit_before(*body.mesh, own, section, section ? core::infinity : limit, triangle);
        if (body.mesh->closed)
            if (const auto cap =
                    cap_before(*body.mesh, own, section, hit ? hit->distance : core::infinity))
                hit = cap;
        if (!hit || hit->distance >= limit) continue;
        hit->point = body.stock_from_body * hit->point;
        hit->normal = body.stock_from_body.rotation * hit->normal;
        best = BodyHit{*hit, i};
    }
    return best;
}

std::optional<PathHit> pick_path(const ToolPath& path, const Camera& camera,
                                 const Viewport& viewport, const Vec2& cursor, double reach,
                                 double depth) {
    return PathSearch(path, camera, viewport, cursor, reach, depth).run();
}

Pick pick(const Scene& scene, const Camera& camera, const Viewport& viewport, const Vec2& cursor,
          double reach) {
    const Ray ray = ray_through(camera, viewport, cursor);
    Pick found{pick_stock(scene, ray), pick_body(scene, ray), {}};
    if (found.stock && found.body) {
        if (found.body->at.distance < found.stock->at.distance)
            found.stock.reset();
        else
            found.body.reset();
    }
    double depth = core::infinity;
    if (const auto surface = found.surface())
        if (const auto position = project(camera, viewport, surface->point))
            depth = position->depth + 2.0 * pixel_size(camera, viewport, surface->point) * reach;
    if (scene.path && scene.path_visible)
        found.path = pick_path(*scene.path, camera, viewport, cursor, reach, depth);
    return found;
}

} // namespace render
