#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "core/base/vec.h"
#include "core/geom/mesh.h"

namespace test_support {

/// The box between two corners, twelve triangles.
inline core::Mesh box_mesh(const core::Vec3& min, const core::Vec3& max) {
    core::Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.emplace_back((i & 1) ? max.x : min.x, (i & 2) ? max.y : min.y,
                                   (i & 4) ? max.z : min.z);
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

/// A cube of half size 10 with a needle-thin hole that runs from (-8.2, 0.2) in the top face
/// obliquely through the bottom and ends outside: there the mesh is inside out.
inline core::Mesh cube_with_a_fold() {
    core::Mesh mesh = box_mesh(core::Vec3(-10.0), core::Vec3(10.0));
    mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4); // the top
    for (const auto& p : {core::Vec3(-8.23, 0.17, 10.0), core::Vec3(-8.13, 0.17, 10.0),
                          core::Vec3(-8.18, 0.27, 10.0), core::Vec3(4.31, 0.23, -13.0)})
        mesh.vertices.push_back(p);
    for (const core::Mesh::Corners& t : {core::Mesh::Corners{4, 5, 8},
                                         {5, 9, 8},
                                         {5, 7, 9},
                                         {7, 10, 9},
                                         {7, 6, 10},
                                         {6, 4, 10},
                                         {4, 8, 10},
                                         {8, 9, 11},
                                         {9, 10, 11},
                                         {10, 8, 11}})
        mesh.triangles.push_back(t);
    return mesh;
}

/// A torus about Z; radius of the ring, radius of the tube, facets round each.
inline core::Mesh torus_mesh(double ring, double tube, uint32_t ring_count, uint32_t tube_count) {
    core::Mesh mesh;
    for (uint32_t i = 0; i < ring_count; ++i)
        for (uint32_t j = 0; j < tube_count; ++j) {
            const double a = 2.0 * std::numbers::pi * i / ring_count;
            const double b = 2.0 * std::numbers::pi * j / tube_count;
            const double r = ring + tube * std::cos(b);
            mesh.vertices.emplace_back(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
        }
    const auto at = [&](uint32_t i, uint32_t j) {
        return (i % ring_count) * tube_count + j % tube_count;
    };
    for (uint32_t i = 0; i < ring_count; ++i)
        for (uint32_t j = 0; j < tube_count; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

/// A ball of stacks and slices with poles on Z.
inline core::Mesh ball_mesh(double radius, uint32_t stacks, uint32_t slices) {
    core::Mesh mesh;
    mesh.vertices.emplace_back(0.0, 0.0, -radius);
    for (uint32_t i = 1; i < stacks; ++i)
        for (uint32_t j = 0; j < slices; ++j) {
            const double polar = std::numbers::pi * i / stacks;
            const double round = 2.0 * std::numbers::pi * j / slices;
            mesh.vertices.emplace_back(radius * std::sin(polar) * std::cos(round),
                                       radius * std::sin(polar) * std::sin(round),
                                       -radius * std::cos(polar));
        }
    mesh.vertices.emplace_back(0.0, 0.0, radius);
    const auto top = static_cast<uint32_t>(mesh.vertices.size() - 1);
    const auto at = [&](uint32_t i, uint32_t j) { return 1 + (i - 1) * slices + j % slices; };
    for (uint32_t j = 0; j < slices; ++j) {
        mesh.triangles.push_back({0, at(1, j + 1), at(1, j)});
        mesh.triangles.push_back({top, at(stacks - 1, j), at(stacks - 1, j + 1)});
        for (uint32_t i = 1; i + 1 < stacks; ++i) {
            mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return mesh;
}

inline core::Mesh inside_out(core::Mesh mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

inline core::Mesh moved(core::Mesh mesh, const core::Transform& by) {
    for (auto& v : mesh.vertices) v = by * v;
    return mesh;
}

/// Combines both meshes into one, as in a file with several shells.
inline core::Mesh together(core::Mesh a, const core::Mesh& b) {
    const auto first = static_cast<uint32_t>(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const auto& t : b.triangles)
        a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return a;
}

inline core::Transform random_pose(std::mt19937& rng, double reach) {
    std::uniform_real_distribution<double> angle(-180.0, 180.0), position(-reach, reach);
    const core::Vec3 turn(angle(rng), angle(rng), angle(rng));
    return {core::rotation_xyz_deg(turn), core::Vec3(position(rng), position(rng), position(rng))};
}

} // namespace test_support
