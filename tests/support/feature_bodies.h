#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "core/geom/mesh.h"

// Bodies whose faces, edges and bores are known. Circles go through the vertices.
namespace test_support {

struct ProfilePoint {
    double radius, height;
};

/// A body of revolution about Z: the profile runs counter-clockwise in (radius, height), so upwards
/// on the outside. A radius of 0 is a tip. `twist` turns each ring by half a chord: no quads.
inline core::Mesh turned_mesh(std::span<const ProfilePoint> profile, uint32_t chords,
                              bool twist = false) {
    core::Mesh mesh;
    std::vector<uint32_t> first;
    for (size_t k = 0; k < profile.size(); ++k) {
        first.push_back(static_cast<uint32_t>(mesh.vertices.size()));
        const uint32_t count = profile[k].radius == 0.0 ? 1 : chords;
        for (uint32_t i = 0; i < count; ++i) {
            const double turn = i + (twist && k % 2 ? 0.5 : 0.0);
            const double a = 2.0 * std::numbers::pi * turn / chords;
            mesh.vertices.emplace_back(profile[k].radius * std::cos(a),
                                       profile[k].radius * std::sin(a), profile[k].height);
        }
    }
    for (size_t k = 0; k < profile.size(); ++k) {
        const size_t n = (k + 1) % profile.size();
        const bool tip = profile[k].radius == 0.0, next_tip = profile[n].radius == 0.0;
        const auto at = [&](size_t ring, uint32_t i) {
            return first[ring] + (profile[ring].radius == 0.0 ? 0 : i % chords);
        };
        for (uint32_t i = 0; i < chords && !(tip && next_tip); ++i) {
            // The diagonal is the shorter one of a twisted ring.
            const bool back = twist && k % 2;
            if (!tip) mesh.triangles.push_back({at(k, i), at(k, i + 1), at(n, back ? i + 1 : i)});
            if (!next_tip)
                mesh.triangles.push_back({at(k, back ? i : i + 1), at(n, i + 1), at(n, i)});
        }
    }
    return mesh;
}

/// The prism over an outline, counter-clockwise, from z0 to z1. It must be visible from `eye`.
inline core::Mesh prism_mesh(std::span<const glm::dvec2> outline, double z0, double z1,
                             const glm::dvec2& eye = glm::dvec2(0.0)) {
    core::Mesh mesh;
    const auto count = static_cast<uint32_t>(outline.size());
    for (const double z : {z0, z1})
        for (const glm::dvec2& p : outline) mesh.vertices.emplace_back(p.x, p.y, z);
    mesh.vertices.emplace_back(eye.x, eye.y, z0);
    mesh.vertices.emplace_back(eye.x, eye.y, z1);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t k = (i + 1) % count;
        mesh.triangles.push_back({i, k, count + k});
        mesh.triangles.push_back({i, count + k, count + i});
        mesh.triangles.push_back({2 * count, k, i});
        mesh.triangles.push_back({2 * count + 1, count + i, count + k});
    }
    return mesh;
}

/// A square block of half width `half` from Z 0 to `height`, with a bore through it about Z. The
/// number of chords is a multiple of 8.
inline core::Mesh bored_block(double half, double height, double radius, uint32_t chords) {
    core::Mesh mesh;
    for (const double z : {0.0, height})
        for (uint32_t i = 0; i < chords; ++i) {
            const double a = 2.0 * std::numbers::pi * i / chords;
            const double c = std::cos(a), s = std::sin(a);
            const double out = half / std::max(std::abs(c), std::abs(s));
            const auto side = [&](double x) {
                return std::abs(std::abs(x) - half) < 1e-9 ? std::copysign(half, x) : x;
            };
            mesh.vertices.emplace_back(radius * c, radius * s, z);
            mesh.vertices.emplace_back(side(out * c), side(out * s), z);
        }
    const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (uint32_t i = 0; i < chords; ++i) {
        const uint32_t k = (i + 1) % chords, top = 2 * chords;
        quad(2 * i, 2 * k, 2 * k + 1, 2 * i + 1);                         // bottom
        quad(top + 2 * i, top + 2 * i + 1, top + 2 * k + 1, top + 2 * k); // top
        quad(2 * i + 1, 2 * k + 1, top + 2 * k + 1, top + 2 * i + 1);     // outside
        quad(2 * k, 2 * i, top + 2 * i, top + 2 * k);                     // bore
    }
    return mesh;
}

/// A rectangle with its corners rounded, as an outline of chords.
inline std::vector<glm::dvec2> rounded_rectangle(double half_x, double half_y, double radius,
                                                 uint32_t chords_per_corner) {
    std::vector<glm::dvec2> outline;
    for (uint32_t corner = 0; corner < 4; ++corner) {
        const glm::dvec2 center((corner == 0 || corner == 3 ? 1 : -1) * (half_x - radius),
                                (corner < 2 ? 1 : -1) * (half_y - radius));
        for (uint32_t i = 0; i <= chords_per_corner; ++i) {
            const double a = std::numbers::pi / 2 * (corner + double(i) / chords_per_corner);
            outline.emplace_back(center.x + radius * std::cos(a), center.y + radius * std::sin(a));
        }
    }
    return outline;
}

/// A box about the origin with all edges rounded, in `chords` chords each. Its corners are parts of
/// a ball with poles on Z; their vertices are shared.
inline core::Mesh rounded_box(const core::Vec3& half, double radius, uint32_t chords) {
    const uint32_t columns = 4 * (chords + 1), rows = 2 * (chords + 1);
    core::Mesh mesh;
    std::vector<uint32_t> number;
    const auto add = [&](const core::Vec3& p) {
        for (uint32_t i = 0; i < mesh.vertices.size(); ++i)
            if (glm::distance(mesh.vertices[i], p) < 1e-9) return i;
        mesh.vertices.push_back(p);
        return static_cast<uint32_t>(mesh.vertices.size() - 1);
    };
    const double step = std::numbers::pi / 2 / chords;
    for (uint32_t i = 0; i < rows; ++i)
        for (uint32_t j = 0; j < columns; ++j) {
            const bool up = i > chords;
            const uint32_t quarter = j / (chords + 1);
            const double height = step * (double(i) - (up ? chords + 1 : chords));
            const double turn = std::numbers::pi / 2 * quarter + step * (j % (chords + 1));
            const core::Vec3 side(quarter == 0 || quarter == 3 ? 1 : -1, quarter < 2 ? 1 : -1,
                                  up ? 1 : -1);
            number.push_back(
                add(side * (half - core::Vec3(radius))
                    + radius
                          * core::Vec3(std::cos(height) * std::cos(turn),
                                       std::cos(height) * std::sin(turn), std::sin(height))));
        }
    const auto triangle = [&](uint32_t a, uint32_t b, uint32_t c) {
        if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
    };
    const auto at = [&](uint32_t i, uint32_t j) { return number[i * columns + j % columns]; };
    for (uint32_t i = 0; i + 1 < rows; ++i)
        for (uint32_t j = 0; j < columns; ++j) {
            triangle(at(i, j), at(i, j + 1), at(i + 1, j + 1));
            triangle(at(i, j), at(i + 1, j + 1), at(i + 1, j));
        }
    const uint32_t q = chords + 1, top = rows - 1;
    triangle(at(top, 0), at(top, q), at(top, 2 * q));
    triangle(at(top, 0), at(top, 2 * q), at(top, 3 * q));
    triangle(at(0, 2 * q), at(0, q), at(0, 0));
    triangle(at(0, 3 * q), at(0, 2 * q), at(0, 0));
    return mesh;
}

/// Coordinates as they come from an STL file.
inline core::Mesh in_single_precision(core::Mesh mesh) {
    for (core::Vec3& v : mesh.vertices) v = core::Vec3(glm::vec3(v));
    return mesh;
}

/// The triangles in another order, starting at other corners.
inline core::Mesh shuffled(core::Mesh mesh, std::mt19937& rng) {
    for (size_t i = mesh.triangles.size(); i > 1; --i)
        std::swap(mesh.triangles[i - 1], mesh.triangles[rng() % i]);
    for (core::Mesh::Corners& t : mesh.triangles)
        for (uint32_t turns = rng() % 3; turns > 0; --turns) t = {t[1], t[2], t[0]};
    return mesh;
}

} // namespace test_support
