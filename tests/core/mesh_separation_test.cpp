#include <random>

#include <gtest/gtest.h>

#include "core/geom/triangle_bvh.h"
#include "core/geom/triangle_distance.h"
#include "tests/support/meshes.h"
#include "tests/support/triangle_oracle.h"

namespace core {
namespace {

using test_support::ball_mesh;
using test_support::box_mesh;
using test_support::random_pose;
using test_support::torus_mesh;
using test_support::wide_distance;

/// A triangle soup with slivers and triangles of no area.
Mesh random_soup(std::mt19937& rng) {
    std::uniform_real_distribution<double> position(-8.0, 8.0);
    Mesh mesh;
    for (int i = 0; i < 40; ++i)
        mesh.vertices.emplace_back(position(rng), position(rng), i % 7 ? position(rng) : 0.0);
    for (int i = 0; i < 9; ++i) {
        const Vec3 off(position(rng), position(rng), position(rng));
        mesh.vertices.push_back(mesh.vertices[rng() % 40] + 1e-9 * off);
    }
    const auto any = [&] { return static_cast<uint32_t>(rng() % mesh.vertices.size()); };
    for (int i = 0; i < 60; ++i) mesh.triangles.push_back({any(), any(), any()});
    return mesh;
}

Mesh random_mesh(std::mt19937& rng) {
    switch (rng() % 4) {
    case 0:
        return torus_mesh(8.0, 3.0, 12, 7);
    case 1:
        return ball_mesh(6.0, 6, 8);
    case 2:
        return box_mesh({-5, -1, -0.01}, {5, 1, 0.01});
    default:
        return random_soup(rng);
    }
}

double off_surface(const Mesh& mesh, const Vec3& p) {
    double least = infinity;
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
        least = std::min(least, glm::distance(p, nearest_point(mesh.triangle(i), p)));
    return least;
}

struct Seen {
    int touching = 0, near = 0, far = 0;

    void count(double distance) { ++(distance == 0.0 ? touching : distance < 5.0 ? near : far); }
};

void expect_representative(const Seen& seen, int times) {
    EXPECT_GT(seen.touching, times);
    EXPECT_GT(seen.near, times);
    EXPECT_GT(seen.far, times);
}

/// The least distance of all pairs of triangles, each swept, by the search for convex shapes.
double least_of_all_pairs(const Mesh& a, const Mesh& b, const Transform& pose, const Vec3& sweep) {
    const Vec3 positions[] = {Vec3(0.0), sweep};
    double least = infinity;
    for (size_t j = 0; j < b.triangles.size(); ++j) {
        const Triangle t = b.triangle(j);
        const ConvexShape shape =
            swept(convex(Triangle{pose * t.a, pose * t.b, pose * t.c}), positions);
        for (size_t i = 0; i < a.triangles.size(); ++i)
            least =
                std::min(least, separation(shape, convex(a.triangle(i)), {.limit = least}).upper);
    }
    return least;
}

TEST(MeshSeparation, HoldsTheDistanceRoundingIncluded) {
    std::mt19937 rng(91);
    Seen seen;
    for (int i = 0; i < 240 && !testing::Test::HasFailure(); ++i) {
        // Up to 1 km from the origin, on both sides of the transform.
        const double offset = i % 3 ? 0.0 : std::pow(10.0, 1 + i % 6);
        const Vec3 position = random_pose(rng, offset).translation;
        const Mesh a = test_support::moved(random_mesh(rng), translation(position));
        const Mesh b = test_support::moved(random_mesh(rng), random_pose(rng, i % 2 * offset));
        Transform pose = random_pose(rng, i % 4 ? 12.0 : 30.0);
        pose.translation += position - pose.rotation * b.bounds().center();
        const Separation found = separation(build_bvh(a), build_bvh(b), pose, Vec3(0.0));
        const long double truth = wide_distance(a, b, pose);
        const double rounding = 1e-13 * (100.0 + 3.0 * offset);
        EXPECT_LE(found.lower, truth) << i;
        EXPECT_GE(found.upper, truth - (found.upper == 0.0 ? 1e-10L + rounding : 0.0L)) << i;
        EXPECT_LE(found.upper - found.lower, 3e-7 + 4.0 * rounding) << i;
        EXPECT_NEAR(glm::distance(found.point_a, found.point_b), found.upper, 2.0 * rounding) << i;
        EXPECT_LE(off_surface(a, found.point_a), rounding + 1e-10) << i;
        EXPECT_LE(off_surface(b, pose.inverse() * found.point_b), rounding + 1e-10) << i;
        seen.count(found.upper);
    }
    expect_representative(seen, 30);
}

TEST(MeshSeparation, IsTheLeastOfAllPairsOverASweep) {
    std::mt19937 rng(92);
    Seen seen;
    for (int i = 0; i < 60; ++i) {
        const Mesh a = random_mesh(rng), b = random_mesh(rng);
        const Transform pose = random_pose(rng, i % 2 ? 10.0 : 25.0);
        const Vec3 sweep = random_pose(rng, 10.0).translation;
        const double truth = least_of_all_pairs(a, b, pose, sweep);
        const Separation found = separation(build_bvh(a), build_bvh(b), pose, sweep);
        EXPECT_LE(found.lower, truth + 1e-10);
        EXPECT_GE(found.upper, truth - 2e-7);
        EXPECT_LE(found.upper - found.lower, 1e-6);
        EXPECT_LE(off_surface(a, found.point_a), 1e-9);
        const Vec3 on_b = pose.inverse() * (found.point_b - found.time_a * sweep);
        EXPECT_LE(off_surface(b, on_b), 1e-9);
        seen.count(found.upper);
    }
    expect_representative(seen, 8);
}

TEST(MeshSeparation, EndsAtTheLimitAndWithinTheTolerance) {
    std::mt19937 rng(93);
    for (int i = 0; i < 200; ++i) {
        const TriangleBvh a = build_bvh(random_mesh(rng)), b = build_bvh(random_mesh(rng));
        const Transform pose = random_pose(rng, 25.0);
        const Vec3 sweep = i % 2 ? random_pose(rng, 10.0).translation : Vec3(0.0);
        const Separation exact = separation(a, b, pose, sweep);
        const Separation rough = separation(a, b, pose, sweep, {.tolerance = 1.0});
        EXPECT_LE(rough.lower, exact.upper);
        EXPECT_GE(rough.upper, exact.lower);
        EXPECT_LE(rough.upper - rough.lower, 1.0 + 1e-10);
        if (exact.upper == 0.0) continue;
        for (const double fraction : {0.3, 0.9, 1.0 - 1e-7, 1.1}) {
            const double limit = fraction * exact.upper;
            const Separation found = separation(a, b, pose, sweep, {.limit = limit});
            EXPECT_EQ(found.found(), fraction > 1.0);
            EXPECT_LE(found.lower, std::min(limit, exact.upper));
            EXPECT_GE(found.lower, std::min(limit, exact.lower - 1e-7));
        }
        EXPECT_EQ(separation(a, b, pose, sweep, {.limit = 0.5 * exact.upper}).lower,
                  0.5 * exact.upper);
    }
}

TEST(MeshSeparation, HoldsForATransformThatIsNotQuiteARotation) {
    std::mt19937 rng(94);
    for (int i = 0; i < 30; ++i) {
        const Mesh a = torus_mesh(80.0, 30.0, 12, 7), b = ball_mesh(60.0, 6, 8);
        Transform pose = random_pose(rng, 200.0);
        pose.rotation[i % 3] *= 1.0 + (i % 2 ? 1e-6 : -1e-6);
        pose.rotation[(i + 1) % 3] += 1e-6 * pose.rotation[i % 3];
        const Separation found = separation(build_bvh(a), build_bvh(b), pose, Vec3(0.0));
        const long double truth = wide_distance(a, b, pose);
        EXPECT_LE(found.lower, truth);
        EXPECT_GE(found.upper, truth);
        EXPECT_LE(found.upper - found.lower, 0.02);
    }
}

TEST(MeshSeparation, IsInfiniteWithoutTriangles) {
    const TriangleBvh none = build_bvh({}), box = build_bvh(box_mesh(Vec3(-1), Vec3(1)));
    EXPECT_FALSE(separation(none, box, {}, Vec3(0.0)).found());
    EXPECT_FALSE(separation(box, none, {}, Vec3(0.0)).found());
    EXPECT_EQ(separation(none, none, {}, Vec3(0.0)).lower, infinity);
}

} // namespace
} // namespace core
