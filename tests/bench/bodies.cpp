#include "tests/bench/bodies.h"

#include <numbers>
#include <utility>

#include "core/dbm/mesh_scan.h"
#include "tests/support/meshes.h"

namespace bench {
namespace {

/// A body of revolution about Z: an outline of (r, z), counterclockwise, that starts and ends on
/// the axis.
core::Mesh revolved(const std::vector<std::pair<double, double>>& outline, uint32_t facets) {
    core::Mesh mesh;
    mesh.vertices.emplace_back(0.0, 0.0, outline.front().second);
    mesh.vertices.emplace_back(0.0, 0.0, outline.back().second);
    const auto rings = static_cast<uint32_t>(outline.size() - 2);
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t i = 0; i < facets; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / facets;
            const auto [r, z] = outline[ring + 1];
            mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
        }
    const auto at = [&](uint32_t ring, uint32_t i) { return 2 + ring * facets + i % facets; };
    for (uint32_t i = 0; i < facets; ++i) {
        mesh.triangles.push_back({0, at(0, i + 1), at(0, i)});
        mesh.triangles.push_back({1, at(rings - 1, i), at(rings - 1, i + 1)});
        for (uint32_t ring = 0; ring + 1 < rings; ++ring) {
            mesh.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
            mesh.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
        }
    }
    return mesh;
}

/// The radius of the gear's outline at `turn` teeth around it: straight flanks, a quarter of the
/// pitch for each flank, top and bottom.
double gear_radius(double turn) {
    const double root = 21.5, tip = 26.0;
    const double share = 4.0 * (turn - std::floor(turn));
    if (share < 1.0) return root + (tip - root) * share;
    if (share < 2.0) return tip;
    if (share < 3.0) return tip - (tip - root) * (share - 2.0);
    return root;
}

} // namespace

Points scanned(const core::Primitive& body, double spacing) {
    return core::boundary_points(core::scan(body, spacing).value());
}

Points scanned(const core::Mesh& body, double spacing) {
    return core::boundary_points(core::scan(body, spacing).value());
}

core::Mesh cup_mesh() {
    return revolved({{0, -30}, {20, -30}, {20, 30}, {16, 30}, {16, -25}, {0, -25}}, 96);
}

core::Mesh pin_mesh() { return revolved({{0, -35}, {12, -35}, {14, -33}, {14, 35}, {0, 35}}, 96); }

core::Mesh lump_mesh(double seed) {
    core::Mesh mesh = test_support::ball_mesh(1.0, 120, 240);
    for (core::Vec3& n : mesh.vertices) {
        const double large = std::sin(3.0 * n.x + seed) * std::sin(4.0 * n.y + 2.0 * seed);
        const double middle = std::sin(9.0 * n.z + 5.0 * n.x + 3.0 * seed);
        const double small = std::sin(23.0 * n.y + 17.0 * n.z) * std::sin(19.0 * n.x + seed);
        n *= 25.0 * (1.0 + 0.15 * large + 0.05 * middle + 0.012 * small);
    }
    return mesh;
}

core::Mesh gear_mesh() {
    const uint32_t teeth = 24, steps = 16, count = teeth * steps;
    core::Mesh mesh;
    for (const double z : {-6.0, 6.0}) {
        mesh.vertices.emplace_back(0.0, 0.0, z);
        for (uint32_t i = 0; i < count; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / count;
            const double r = gear_radius(static_cast<double>(i) / steps);
            mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
        }
    }
    const auto low = [&](uint32_t i) { return 1 + i % count; };
    const auto high = [&](uint32_t i) { return count + 2 + i % count; };
    for (uint32_t i = 0; i < count; ++i) {
        mesh.triangles.push_back({0, low(i + 1), low(i)});
        mesh.triangles.push_back({count + 1, high(i), high(i + 1)});
        mesh.triangles.push_back({low(i), low(i + 1), high(i + 1)});
        mesh.triangles.push_back({low(i), high(i + 1), high(i)});
    }
    return mesh;
}

} // namespace bench
