#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "core/geom/mesh_file.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::box_mesh;
using test_support::torus_mesh;

/// Two adjacent unit cubes that share corners; `partition` keeps both faces between them.
Mesh two_cells(bool partition) {
    Mesh mesh;
    for (int i = 0; i < 12; ++i) mesh.vertices.emplace_back(i / 4, i % 2, i / 2 % 2);
    const auto cell = [&](uint32_t first, bool low_face, bool high_face) {
        const uint32_t o = first, p = first + 4;
        const auto face = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        };
        if (low_face) face(o, o + 2, o + 3, o + 1);
        if (high_face) face(p, p + 1, p + 3, p + 2);
        face(o, o + 1, p + 1, p);
        face(o + 2, p + 2, p + 3, o + 3);
        face(o, p, p + 2, o + 2);
        face(o + 1, o + 3, p + 3, p + 1);
    };
    cell(0, true, partition);
    cell(4, partition, true);
    return mesh;
}

void shuffle(Mesh& mesh, unsigned seed) {
    std::mt19937 rng(seed);
    for (size_t i = mesh.triangles.size(); i > 1; --i)
        std::swap(mesh.triangles[i - 1], mesh.triangles[rng() % i]);
}

void expect_each_closed(const Mesh& mesh) {
    const Shells shells = shells_of(mesh);
    ASSERT_EQ(shells.of_triangle.size(), mesh.triangles.size());
    const std::vector<EdgeUse> uses = edge_uses(mesh);
    for (size_t i = 0, end = 0; i < uses.size(); i = end) {
        end = end_of_edge(uses, i);
        std::vector<int> balance(shells.count, 0);
        for (size_t k = i; k < end; ++k)
            balance[shells.of_triangle[uses[k].triangle]] += uses[k].upwards ? 1 : -1;
        EXPECT_EQ(balance, std::vector<int>(shells.count, 0));
    }
}

TEST(Shells, AreClosedEachOnItsOwn) {
    for (unsigned seed = 0; seed < 20; ++seed)
        for (const bool partition : {false, true}) {
            Mesh cells = two_cells(partition);
            EXPECT_EQ(signed_volume(cells), 2.0);
            shuffle(cells, seed);
            expect_each_closed(cells);
        }
}

TEST(Shells, StayApartWhereOnlyAnEdgeIsShared) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        Mesh mesh = box_mesh(Vec3(0.0), Vec3(1.0));
        const Mesh other = box_mesh(Vec3(1.0, 1.0, 0.0), Vec3(2.0, 2.0, 1.0));
        // The corners 0 and 4 of the other cube are the corners 3 and 7 of this one.
        const uint32_t number[8] = {3, 8, 9, 10, 7, 11, 12, 13};
        mesh.vertices.resize(14);
        for (size_t i = 0; i < 8; ++i) mesh.vertices[number[i]] = other.vertices[i];
        for (const auto& t : other.triangles)
            mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
        shuffle(mesh, seed);
        EXPECT_EQ(shells_of(mesh).count, 2u);
        expect_each_closed(mesh);
    }
}

TEST(Shells, AreOneForATorus) { EXPECT_EQ(shells_of(torus_mesh(10.0, 3.0, 12, 8)).count, 1u); }

} // namespace
} // namespace core
