#pragma once

#include <cstdint>
#include <vector>

#include "render/camera.h"
#include "render/scene.h"

namespace render {

/// Distances of the lines of a grid, mm.
struct GridStep {
    double fine = 10.0;
    double coarse = 100.0; // between the stronger lines, a multiple of `fine`
};

/// The least distances that are 1, 2 or 5 times a power of ten in mm or inch and at least this, mm.
GridStep step_of_at_least(double least, bool inch);

/// The part of the grid that a picture shows. Frame: the ground's.
struct GridView {
    GridStep step;
    Vec2 middle = Vec2(0.0); // below the target of the camera
    double reach = 0.0;      // mm; beyond it the lines have faded

    /// The same for the lines between the strong ones.
    double fine_reach() const { return 0.5 * reach; }
};

/// Lines are at least 24 pixels times `scale` apart where the camera looks.
GridView grid_view(const Ground& ground, const Camera& camera, const Viewport& viewport,
                   double scale = 1.0);

/// The box of that part, in the scene.
core::Aabb ground_bounds(const Ground& ground, const Camera& camera, const Viewport& viewport,
                         double scale = 1.0);

/// An end of a grid line.
struct GridPoint {
    glm::vec3 position = glm::vec3(0.0F); // in the frame of the ground
    float strength = 1.0F;                // 0..1
};

/// The lines of a grid, two points each. Lines are at multiples of the step, so that they do not
/// move with the view.
std::vector<GridPoint> grid_lines(const GridView& view);

/// How dark the ground is below the work: bytes on a grid, rows along X.
struct ShadowMask {
    Vec2 origin = Vec2(0.0); // corner of the first cell, in the frame of the ground, mm
    Vec2 cell = Vec2(1.0);   // mm
    int columns = 0, rows = 0;
    std::vector<uint8_t> values; // 255: something touches the ground

    bool empty() const { return values.empty(); }
};

/// The shadow of what stands on the ground: dark below what touches it, lighter and softer below
/// what is higher. Neither the machine nor the tool casts one. Below a mesh with very many
/// triangles, and below the stock, it is that of boxes.
///
/// Cost:    about 1 ms for 20,000 triangles. Same bits for the same scene.
ShadowMask shadow_mask(const Scene& scene);

/// What a shadow depends on: equal keys give equal shadows. Shares the meshes, so that none of them
/// can be replaced by another at its address.
struct ShadowKey {
    core::Transform ground;
    std::vector<std::pair<SharedMesh, core::Transform>> bodies;
    StockBricks stock;

    bool operator==(const ShadowKey&) const = default;
};

ShadowKey shadow_key(const Scene& scene);

} // namespace render
