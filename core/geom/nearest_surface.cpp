#include "core/geom/nearest_surface.h"

#include <utility>

#include "core/geom/triangle_distance.h"

namespace core {

NearestSurface nearest_surface(const TriangleBvh& mesh, const Vec3& point, double limit) {
    NearestSurface best;
    double best_squared = limit * limit;
    if (mesh.nodes.empty()) return best;
    std::vector<std::pair<double, uint32_t>> open = {
        {distance_squared(point, mesh.nodes[0].box), 0}};
    while (!open.empty()) {
        const auto [bound, index] = open.back();
        open.pop_back();
        if (bound >= best_squared) continue;
        const TriangleBvh::Node& node = mesh.nodes[index];
        if (!node.is_leaf()) {
            std::pair<double, uint32_t> children[2];
            for (uint32_t k = 0; k < 2; ++k)
                children[k] = {distance_squared(point, mesh.nodes[node.first + k].box),
                               node.first + k};
            if (children[0].first < children[1].first) std::swap(children[0], children[1]);
            open.insert(open.end(), {children[0], children[1]});
            continue;
        }
        for (uint32_t i = node.first; i < node.first + node.count; ++i) {
            const Vec3 near = nearest_point(mesh.triangles[i], point);
            const Vec3 by = near - point;
            if (const double squared = glm::dot(by, by); squared < best_squared) {
                best_squared = squared;
                best = {std::sqrt(squared), near, mesh.ids[i]};
            }
        }
    }
    return best;
}

NearestSurface SurfaceTracker::at(const Vec3& point) {
    // No point of the surface is farther from here than the one found last is.
    const double limit = last_distance_ + glm::distance(point, last_place_);
    const NearestSurface found = nearest_surface(mesh_, point, limit * (1.0 + 1e-9) + 1e-9);
    last_place_ = point;
    last_distance_ = found.distance;
    return found;
}

} // namespace core
