#pragma once

#include <optional>

#include "render/camera.h"
#include "render/scene.h"

namespace render {

/// Where a ray meets a surface.
struct SurfaceHit {
    double distance = core::infinity; // from the ray's origin, mm
    Vec3 point = Vec3(0.0);
    Vec3 normal = Vec3(0.0); // of the triangle, outwards
};

struct StockHit {
    SurfaceHit at;
    std::optional<uint32_t> block; // that cut there; empty: raw stock or a section face
};

struct BodyHit {
    SurfaceHit at;
    size_t body = 0; // index in the scene
};

struct PathHit {
    uint32_t block = 0;
    size_t point = 0; // index of the end of the piece
    Vec3 position = Vec3(0.0);
    double pixels = 0.0; // from the cursor
};

/// What is under the cursor: the nearer one of stock and body, and the path unless they hide it.
struct Pick {
    std::optional<StockHit> stock;
    std::optional<BodyHit> body;
    std::optional<PathHit> path;

    /// The nearest point of a surface.
    std::optional<SurfaceHit> surface() const;
};

/// For callers with a mesh that is in no scene: the nearest triangle that faces the ray's origin
/// and is not cut away by the section.
std::optional<SurfaceHit> pick_mesh(const TriangleMesh& mesh, const Ray& ray,
                                    const std::optional<SectionPlane>& section = {},
                                    size_t* triangle = nullptr);

std::optional<StockHit> pick_stock(const Scene& scene, const Ray& ray);

/// The nearest visible body; transparent ones are skipped unless `through_glass` is false.
std::optional<BodyHit> pick_body(const Scene& scene, const Ray& ray, bool through_glass = true);

/// The piece of the path nearest to the cursor in the picture, up to `reach` pixels away; of
/// several the one nearest to the eye. Pieces farther from the eye than `depth` are hidden.
std::optional<PathHit> pick_path(const ToolPath& path, const Camera& camera,
                                 const Viewport& viewport, const Vec2& cursor, double reach = 6.0,
                                 double depth = core::infinity);

Pick pick(const Scene& scene, const Camera& camera, const Viewport& viewport, const Vec2& cursor,
          double reach = 6.0);

} // namespace render
