#include <random>

#include <gtest/gtest.h>

#include "core/geom/triangle_bvh.h"
#include "tests/support/convex_oracle.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::ball_mesh;
using test_support::box_mesh;
using test_support::certainly_outside;
using test_support::random_pose;
using test_support::torus_mesh;

/// Tests every triangle.
double brute_force(const ConvexShape& shape, const Mesh& mesh) {
    double least = infinity;
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
        least = std::min(least, separation(shape, convex(mesh.triangle(i))).upper);
    return least;
}

Mesh random_mesh(std::mt19937& rng) {
    switch (rng() % 4) {
    case 0:
        return torus_mesh(8.0, 3.0, 14, 9);
    case 1:
        return ball_mesh(6.0, 7, 9);
    case 2:
        return box_mesh({-5, -1, -0.01}, {5, 1, 0.01});
    default: { // a soup with slivers and triangles of no area
        std::uniform_real_distribution<double> position(-8.0, 8.0);
        Mesh mesh;
        for (int i = 0; i < 60; ++i)
            mesh.vertices.emplace_back(position(rng), position(rng), i % 7 ? position(rng) : 0.0);
        for (uint32_t i = 0; i + 2 < 60; ++i) mesh.triangles.push_back({i, i + 1, i + 2 - i % 2});
        return mesh;
    }
    }
}

ConvexShape random_probe(std::mt19937& rng, double reach) {
    const Transform pose = random_pose(rng, reach);
    switch (rng() % 4) {
    case 0:
        return posed(convex_sphere(0.5), pose);
    case 1:
        return posed(convex(ProfileElement{0, 2, 5, 1, 0}), pose);
    case 2:
        return posed(convex(Triangle{{0, 0, 0}, {3, 0, 0}, {0, 1e-9, 4}}), pose);
    default: {
        const Vec3 positions[] = {Vec3(0.0), random_pose(rng, 8.0).translation};
        return swept(posed(convex_sphere(1.0), pose), positions);
    }
    }
}

TEST(TriangleBvh, GivesTheLeastDistanceOverAllTriangles) {
    std::mt19937 rng(31);
    int near = 0, far = 0, overlapping = 0;
    for (int i = 0; i < 250; ++i) {
        const Mesh mesh = test_support::moved(random_mesh(rng), random_pose(rng, 4.0));
        const TriangleBvh bvh = build_bvh(mesh);
        for (int k = 0; k < 4; ++k) {
            const ConvexShape shape = random_probe(rng, k % 2 ? 7.0 : 15.0);
            const Separation found = separation(shape, bvh);
            const double truth = brute_force(shape, mesh);
            EXPECT_LE(found.lower, truth + 1e-9);
            EXPECT_GE(found.upper, truth - 2e-7);
            EXPECT_LE(found.upper - found.lower, 1e-6);
            EXPECT_NEAR(glm::distance(found.point_a, found.point_b), found.upper, 1e-9);
            EXPECT_LE(certainly_outside(shape, found.point_a, rng), 1e-9);
            EXPECT_LE(brute_force(convex_segment(found.point_b, found.point_b), mesh), 1e-6);
            ++(truth == 0.0 ? overlapping : truth < 3.0 ? near : far);
        }
    }
    EXPECT_GT(overlapping, 100);
    EXPECT_GT(near, 100);
    EXPECT_GT(far, 100);
}

TEST(TriangleBvh, SaysAtMostTheLimitWhenNothingIsNearer) {
    const TriangleBvh bvh = build_bvh(box_mesh(Vec3(-1), Vec3(1)));
    const ConvexShape probe = posed(convex_sphere(1.0), translation({7, 0, 0}));
    for (const double limit : {0.5, 4.999, 5.0 - 1e-8, 5.0, 5.0 + 1e-8, 5.001, 50.0}) {
        const Separation found = separation(probe, bvh, {.limit = limit});
        EXPECT_LE(found.lower, std::min(limit, 5.0) + 1e-12);
        EXPECT_GE(found.lower, std::min(limit, 5.0) - 1e-6);
        EXPECT_EQ(found.found(), found.upper < limit);
    }
    EXPECT_FALSE(separation(probe, build_bvh({})).found());
}

TEST(TrianglesIn, AreThoseWhoseBoxesMeetTheBox) {
    std::mt19937 rng(33);
    size_t some = 0;
    for (int i = 0; i < 100; ++i) {
        const Mesh mesh = random_mesh(rng);
        Aabb box;
        box.extend(random_pose(rng, 8.0).translation);
        box.extend(i % 5 ? random_pose(rng, 8.0).translation : box.min);
        std::vector<uint32_t> expected;
        for (size_t k = 0; k < mesh.triangles.size(); ++k)
            if (overlaps(bounds(convex(mesh.triangle(k))), box))
                expected.push_back(static_cast<uint32_t>(k));
        EXPECT_EQ(triangles_in(build_bvh(mesh), box), expected);
        some += expected.size();
    }
    EXPECT_GT(some, 500u);
}

} // namespace
} // namespace core
