#include <gtest/gtest.h>

#include "render/body_mesh.h"
#include "render/coarse_mesh.h"
#include "tests/render/sample_scene.h"

namespace render {
namespace {

using core::Vec3;

std::vector<const TriangleMesh*> surface_of(const StockBricks& bricks) {
    std::vector<const TriangleMesh*> parts;
    for (const auto& brick : bricks) parts.push_back(&brick->mesh);
    return parts;
}

core::Aabb box_of(std::span<const TriangleMesh* const> parts) {
    core::Aabb box;
    for (const TriangleMesh* part : parts)
        for (const MeshVertex& vertex : part->vertices) box.extend(Vec3(vertex.position));
    return box;
}

/// Enclosed by triangles that face outwards, whole or nearly so.
double volume_of(std::span<const TriangleMesh* const> parts) {
    double volume = 0.0;
    for (const TriangleMesh* part : parts)
        for (const TriangleMesh::Corners& t : part->triangles) {
            const Vec3 a(part->vertices[t[0]].position), b(part->vertices[t[1]].position),
                c(part->vertices[t[2]].position);
            volume += glm::dot(a, glm::cross(b, c)) / 6.0;
        }
    return volume;
}

size_t triangles_of(std::span<const TriangleMesh* const> parts) {
    size_t count = 0;
    for (const TriangleMesh* part : parts) count += part->triangles.size();
    return count;
}

TEST(CoarseMesh, HasTheShapeOfACutStockWithAFewOfItsTriangles) {
    const Scene scene = sample_scene(0.5);
    const auto fine = surface_of(scene.stock);
    ASSERT_GT(triangles_of(fine), 50'000U);
    const TriangleMesh mesh = coarse(fine, 6000);
    const TriangleMesh* const parts[] = {&mesh};
    EXPECT_LE(mesh.triangles.size(), 6000U);
    EXPECT_GT(mesh.triangles.size(), 300U);
    EXPECT_NEAR(volume_of(parts) / volume_of(fine), 1.0, 0.01);
    const core::Aabb box = box_of(parts), whole = box_of(fine);
    EXPECT_LT(glm::length(box.min - whole.min), 0.25); // half the mesh size
    EXPECT_LT(glm::length(box.max - whole.max), 0.25);
}

TEST(CoarseMesh, LiesOnTheSurface) {
    const Scene scene = sample_scene(0.5);
    const auto fine = surface_of(scene.stock);
    const TriangleMesh mesh = coarse(fine, 6000);
    std::vector<Vec3> positions;
    for (const TriangleMesh* part : fine)
        for (const MeshVertex& vertex : part->vertices) positions.emplace_back(vertex.position);
    size_t off = 0;
    for (const MeshVertex& vertex : mesh.vertices) {
        double nearest = 1e9;
        for (const Vec3& position : positions)
            nearest = std::min(nearest, glm::length(position - Vec3(vertex.position)));
        off += nearest > 0.5;
    }
    // Where the planes of a cell meet between lines.
    EXPECT_LT(off, mesh.vertices.size() / 20);
}

TEST(CoarseMesh, KeepsRawAndCutStockApart) {
    const Scene scene = sample_scene(0.5);
    const TriangleMesh mesh = coarse(surface_of(scene.stock), 6000);
    std::array<size_t, 2> count{};
    for (const TriangleMesh::Corners& t : mesh.triangles) {
        ++count.at(mesh.vertices[t[0]].tint);
        EXPECT_EQ(mesh.vertices[t[0]].tint, mesh.vertices[t[1]].tint);
        EXPECT_EQ(mesh.vertices[t[0]].tint, mesh.vertices[t[2]].tint);
    }
    EXPECT_GT(count[0], 50U);
    EXPECT_GT(count[1], 50U);
}

TEST(CoarseMesh, LeavesABoxABox) {
    const TriangleMesh box = mesh_of(core::Primitive(core::Box{{10, 20, 30}}));
    const TriangleMesh* const fine[] = {&box};
    const TriangleMesh mesh = coarse(fine, 500);
    const TriangleMesh* const parts[] = {&mesh};
    EXPECT_EQ(mesh.triangles.size(), 12U);
    EXPECT_NEAR(volume_of(parts), 6000.0, 0.1);
}

TEST(CoarseMesh, MakesSomethingOfNothing) {
    const TriangleMesh empty;
    const TriangleMesh* const parts[] = {&empty};
    EXPECT_TRUE(coarse(parts, 100).triangles.empty());
    EXPECT_TRUE(coarse({}, 100).triangles.empty());
}

TEST(CoarseMesh, IsTheSameEachTime) {
    const Scene scene = sample_scene(1.0);
    const TriangleMesh a = coarse(surface_of(scene.stock), 2000),
                       b = coarse(surface_of(scene.stock), 2000);
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
}

} // namespace
} // namespace render
