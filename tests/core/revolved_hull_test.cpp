#include <random>

#include <gtest/gtest.h>

#include "core/geom/profile.h"
#include "tests/support/meshes.h"
#include "tests/support/profile_oracle.h"

namespace core {
namespace {

using test_support::box_mesh;
using test_support::outside;

std::vector<Mesh> meshes() {
    std::mt19937 rng(7);
    std::vector<Mesh> all{box_mesh({-20, -10, 0}, {20, 10, 30}), box_mesh({5, 5, 2}, {9, 9, 12}),
                          test_support::ball_mesh(15, 40, 60),
                          test_support::torus_mesh(20, 5, 30, 20),
                          test_support::together(box_mesh({-5, -5, 0}, {5, 5, 10}),
                                                 box_mesh({-15, -15, 10}, {15, 15, 20}))};
    for (int i = 0; i < 20; ++i)
        all.push_back(test_support::moved(box_mesh({-9, -4, -12}, {9, 4, 12}),
                                          test_support::random_pose(rng, 10.0)));
    return all;
}

TEST(RevolvedHull, HoldsEveryPointOfTheMesh) {
    std::mt19937 rng(5);
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    for (const Mesh& mesh : meshes()) {
        const RevolvedProfile hull = revolved_hull(mesh, 0.005);
        for (size_t i = 0; i < mesh.triangles.size(); ++i) {
            const Triangle t = mesh.triangle(i);
            for (int k = 0; k < 10; ++k) {
                double u = fraction(rng), v = fraction(rng);
                if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
                EXPECT_LE(outside(hull, t.a + u * (t.b - t.a) + v * (t.c - t.a)), 1e-9);
            }
        }
    }
}

TEST(RevolvedHull, IsNoWiderThanItsTolerance) {
    // At each height the farthest point of the mesh is on one of its edges.
    for (const Mesh& mesh : meshes()) {
        const RevolvedProfile hull = revolved_hull(mesh, 0.005);
        const Aabb box = bounds(hull);
        EXPECT_NEAR(box.min.z, mesh.bounds().min.z, 1e-12);
        EXPECT_NEAR(box.max.z, mesh.bounds().max.z, 1e-12);
        double widest_edge = 0.0, widest = box.max.x;
        for (const Vec3& v : mesh.vertices)
            widest_edge = std::max(widest_edge, std::hypot(v.x, v.y));
        EXPECT_LE(widest, widest_edge + 0.01);
    }
    const RevolvedProfile ball = revolved_hull(test_support::ball_mesh(15, 40, 60), 0.005);
    for (double z = -14.5; z < 14.5; z += 0.37)
        EXPECT_GT(outside(ball, {std::sqrt(225 - z * z) + 0.01, 0, z}), 0.0) << z;
}

TEST(RevolvedHull, TakesOneConeWhereOneWillDo) {
    EXPECT_EQ(revolved_hull(box_mesh({-20, -10, 0}, {20, 10, 30}), 0.005).elements.size(), 1U);
    const Mesh steps = test_support::together(box_mesh({-5, -5, 0}, {5, 5, 10}),
                                              box_mesh({-15, -15, 10}, {15, 15, 20}));
    EXPECT_EQ(revolved_hull(steps, 0.005).elements.size(), 2U);
}

TEST(RevolvedHull, StaysOutsideWhenThereAreManyHeights) {
    const Mesh mesh = test_support::ball_mesh(15, 900, 8);
    const RevolvedProfile hull = revolved_hull(mesh, 0.005);
    for (const Vec3& v : mesh.vertices) EXPECT_LE(outside(hull, v), 1e-9);
    EXPECT_LT(bounds(hull).max.x, 15.01);
}

} // namespace
} // namespace core
