#include <random>

#include <gtest/gtest.h>

#include "render/picking.h"
#include "render/stock_surface.h"
#include "tests/render/sample_scene.h"

namespace render {
namespace {

using core::CutModel;

/// A block with the sample's cuts.
CutModel cut_block(double h) {
    CutModel model =
        *core::make_cut_model({core::SolidBox{{{-45, -30, -30}, {45, 30, 0}}}, 0.0}, h);
    std::vector<PathPoint> path;
    for (const core::CutterSweep& move : sample_moves(path)) cut(model, move);
    return model;
}

struct Met {
    double distance = core::infinity;
    uint8_t tint = 0;
};

/// Where a ray meets bricks first.
Met met(const StockBricks& bricks, const Ray& ray, TriangleMesh StockBrick::*part) {
    Met nearest;
    for (const auto& brick : bricks) {
        const TriangleMesh& mesh = (*brick).*part;
        size_t triangle = 0;
        const auto hit = pick_mesh(mesh, ray, {}, &triangle);
        if (!hit || hit->distance >= nearest.distance) continue;
        nearest = {hit->distance, mesh.vertices[mesh.triangles[triangle][0]].tint};
    }
    return nearest;
}

size_t triangle_count(const StockBricks& bricks, TriangleMesh StockBrick::*part) {
    size_t count = 0;
    for (const auto& brick : bricks) count += ((*brick).*part).triangles.size();
    return count;
}

TEST(FlatFaces, LookLikeTheWholeSurfaceFromEverySide) {
    constexpr double h = 1.0;
    const StockBricks bricks = stock_bricks(cut_block(h));
    std::mt19937 random(11);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    size_t seen = 0, apart = 0;
    for (int i = 0; i < 6000; ++i) {
        const Vec3 from = 150.0 * glm::normalize(Vec3(any(random), any(random), any(random)));
        Vec3 to(44.0 * any(random), 29.0 * any(random), -15.0 + 14.0 * any(random));
        // Half of them through the corners of cells, where cracks would be.
        if (i % 2 == 0) to = glm::round(to) + Vec3(0.5);
        const Ray ray{from, glm::normalize(to - from)};
        const Met whole = met(bricks, ray, &StockBrick::mesh);
        const Met drawn = met(bricks, ray, &StockBrick::drawn);
        if (whole.distance == core::infinity) continue;
        ++seen;
        ASSERT_LT(drawn.distance, core::infinity) << "a hole, ray " << i;
        EXPECT_NEAR(drawn.distance, whole.distance, 0.5 * h) << i;
        apart += std::abs(drawn.distance - whole.distance) > 1e-4 || drawn.tint != whole.tint;
    }
    EXPECT_GT(seen, 5000U);
    EXPECT_LT(apart, seen / 200) << "except for details that protrude by a tenth of a cell";
}

TEST(FlatFaces, AreFew) {
    const CutModel raw =
        *core::make_cut_model({core::SolidBox{{{-45, -30, -30}, {45, 30, 0}}}, 0.0}, 0.5);
    const StockBricks bricks = stock_bricks(raw);
    EXPECT_GT(triangle_count(bricks, &StockBrick::mesh), 80'000U);
    EXPECT_LT(triangle_count(bricks, &StockBrick::drawn), 10'000U);
    const StockBricks after = stock_bricks(cut_block(0.5));
    EXPECT_LT(4 * triangle_count(after, &StockBrick::drawn),
              3 * triangle_count(after, &StockBrick::mesh));
}

/// Triangles that face against their normals: a surface has slivers that fold over.
size_t turned_over(const StockBricks& bricks, TriangleMesh StockBrick::*part) {
    size_t count = 0;
    for (const auto& brick : bricks) {
        const TriangleMesh& mesh = (*brick).*part;
        for (const TriangleMesh::Corners& t : mesh.triangles) {
            const auto at = [&](size_t i) { return Vec3(mesh.vertices[t[i]].position); };
            const Vec3 across = glm::cross(at(1) - at(0), at(2) - at(0));
            count += glm::dot(across, unpacked_normal(mesh.vertices[t[0]])) < 0.0;
        }
    }
    return count;
}

TEST(FlatFaces, FaceOutwards) {
    const StockBricks bricks = stock_bricks(cut_block(1.0));
    EXPECT_LE(turned_over(bricks, &StockBrick::drawn), turned_over(bricks, &StockBrick::mesh));
    EXPECT_LT(turned_over(bricks, &StockBrick::mesh), 100U);
}

} // namespace
} // namespace render
