#include <random>

#include <gtest/gtest.h>

#include "core/dbm/solid.h"
#include "core/distance/body_distance.h"
#include "core/geom/triangle_bvh.h"
#include "tests/support/convex_oracle.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::ball_mesh;
using test_support::box_mesh;
using test_support::certainly_outside;
using test_support::inside_out;
using test_support::random_pose;
using test_support::together;
using test_support::torus_mesh;

SolidMesh hollow_box() {
    return solid_mesh(
        together(box_mesh(Vec3(-10), Vec3(10)), inside_out(box_mesh(Vec3(-6), Vec3(6)))));
}

ConvexShape ball_at(const Vec3& p, double radius) {
    return posed(convex_sphere(radius), translation(p));
}

void expect_distance(const Separation& found, double distance) {
    EXPECT_NEAR(found.upper, distance, 1e-6);
    EXPECT_NEAR(found.lower, distance, 1e-6);
    EXPECT_LE(found.lower, distance + 1e-9);
    EXPECT_NEAR(glm::distance(found.point_a, found.point_b), found.upper, 1e-9);
}

TEST(BodyDistance, OfAShapeInACavityIsToItsWalls) {
    const ExactBody hollow = hollow_box();
    expect_distance(separation(ball_at({1, 0, 0}, 2.0), hollow), 3.0);
    expect_distance(separation(ball_at({8, 0, 0}, 1.0), hollow), 0.0);  // in the wall
    expect_distance(separation(ball_at({0, 0, 0}, 40.0), hollow), 0.0); // encloses it
    expect_distance(separation(ball_at({14, 0, 0}, 1.0), hollow), 3.0);
    EXPECT_EQ(separation(ball_at({8, 0, 0}, 0.1), hollow, {.limit = 1.0}).upper, 0.0);
}

TEST(BodyDistance, OfNestedMeshes) {
    const ExactBody hollow = hollow_box();
    const ExactBody small = solid_mesh(box_mesh(Vec3(-1), Vec3(1)));
    const ExactBody two = solid_mesh(
        together(box_mesh({-31, -1, -1}, {-29, 1, 1}), box_mesh({-1, -1, -1}, {1, 1, 1})));
    const struct {
        Vec3 position;
        double distance;
    } cases[] = {{{0, 0, 0}, 5}, {{3, 0, 0}, 2}, {{8, 0, 0}, 0}, {{14, 0, 0}, 3}, {{11, 0, 0}, 0}};
    for (const auto& c : cases) {
        expect_distance(separation(hollow, small, translation(c.position), Vec3(0)), c.distance);
        expect_distance(separation(small, hollow, translation(-c.position), Vec3(0)), c.distance);
    }
    // One of two shells is inside the material, the other far outside.
    expect_distance(separation(hollow, two, translation({8, 0, 0}), Vec3(0)), 0.0);
    expect_distance(separation(two, hollow, translation({-8, 0, 0}), Vec3(0)), 0.0);
    expect_distance(separation(hollow, two, translation({38, 0, 0}), Vec3(0)), 0.0);
}

TEST(BodyDistance, IsZeroNextToAFoldOfOverlappingMaterial) {
    const ExactBody folded = solid_mesh(test_support::cube_with_a_fold());
    const ExactBody cube = solid_mesh(box_mesh(Vec3(0), Vec3(1)));
    const Transform position = translation({3.5, 0.229, 5.0}); // above the fold, in the material
    expect_distance(separation(folded, cube, position, Vec3(0)), 0.0);
    expect_distance(separation(ball_at({3.5, 0.229, 5.0}, 0.5), folded), 0.0);
}

TEST(BodyDistance, SeesABodySweptIntoAnother) {
    const ExactBody box = solid_mesh(box_mesh(Vec3(-10), Vec3(10)));
    const ExactBody small = solid_mesh(box_mesh(Vec3(-1), Vec3(1)));
    const ExactBody ball = convex_sphere(1.0);
    for (const ExactBody& body : {small, ball}) {
        expect_distance(separation(box, body, translation({20, 0, 0}), {0, 0, 5}), 9.0);
        expect_distance(separation(box, body, translation({20, 0, 0}), {-7, 0, 0}), 2.0);
        expect_distance(separation(box, body, translation({20, 0, 0}), {-40, 0, 0}), 0.0);
        expect_distance(separation(body, box, translation({-20, 0, 0}), {7, 0, 0}), 2.0);
        expect_distance(separation(body, box, translation({-20, 0, 0}), {20, 0, 0}), 0.0);
        expect_distance(separation(body, box, translation({0, 0, -11.0}), Vec3(0)), 0.0); // contact
    }
}

struct Body {
    ExactBody exact;
    bool is_mesh = false;
};

Body random_body(std::mt19937& rng) {
    switch (rng() % 5) {
    case 0:
        return {solid_mesh(torus_mesh(8.0, 3.0, 12, 8)), true};
    case 1:
        return {solid_mesh(ball_mesh(4.0, 6, 8)), true};
    case 2:
        return {hollow_box(), true};
    case 3:
        return {convex(ProfileElement{-2, 3, 4, 1, 0}), false};
    default:
        return {convex(Aabb{{-1, -3, -2}, {2, 3, 1}}), false};
    }
}

double outside_body(const Body& body, const Vec3& p, std::mt19937& rng) {
    if (!body.is_mesh) return certainly_outside(std::get<ConvexShape>(body.exact), p, rng);
    const SolidMesh& mesh = std::get<SolidMesh>(body.exact);
    return holds(mesh, p) ? 0.0 : separation(convex_segment(p, p), *mesh.bvh).upper;
}

TEST(BodyDistance, IsTheSameBothWaysAndBelowEverySampleOfTheSweep) {
    std::mt19937 rng(41);
    int apart = 0, overlapping = 0;
    for (int i = 0; i < 150; ++i) {
        const Body a = random_body(rng), b = random_body(rng);
        const Transform pose = random_pose(rng, 18.0);
        const Vec3 sweep = i % 4 ? random_pose(rng, 12.0).translation : Vec3(0.0);
        const Separation found = separation(a.exact, b.exact, pose, sweep);
        const Transform back = pose.inverse();
        const Separation turned = separation(b.exact, a.exact, back, -(back.rotation * sweep));
        EXPECT_NEAR(found.upper, turned.upper, 2e-7) << i;
        EXPECT_NEAR(found.lower, turned.lower, 2e-7) << i;
        EXPECT_LE(outside_body(a, found.point_a, rng), 1e-6) << i;
        const Vec3 on_b = back * (found.point_b - found.time_a * sweep);
        EXPECT_LE(outside_body(b, on_b, rng), 1e-6) << i;
        EXPECT_NEAR(glm::distance(found.point_a, found.point_b), found.upper, 1e-9);
        double sampled = infinity;
        for (int k = 0; k <= 10; ++k) {
            const Transform then = translation(0.1 * k * sweep) * pose;
            sampled = std::min(sampled, separation(a.exact, b.exact, then, Vec3(0)).upper);
        }
        EXPECT_LE(found.lower, sampled + 1e-9) << i;
        EXPECT_GE(found.upper, sampled - 0.05 * glm::length(sweep) - 1e-6) << i;
        ++(found.upper == 0.0 ? overlapping : apart);
    }
    EXPECT_GT(apart, 40);
    EXPECT_GT(overlapping, 40);
}

TEST(BodyDistance, SaysAtMostTheLimitWhenNothingIsNearer) {
    const ExactBody ball = convex_sphere(1.0);
    const ExactBody box = solid_mesh(box_mesh(Vec3(-1), Vec3(1)));
    for (const ExactBody& body : {ball, box})
        for (const double limit : {0.5, 3.0 - 1e-8, 3.0, 3.0 + 1e-8, 4.0}) {
            const Separation found = separation(ball_at({5, 0, 0}, 1.0), body, {.limit = limit});
            EXPECT_LE(found.lower, std::min(limit, 3.0) + 1e-12);
            EXPECT_EQ(found.found(), found.upper < limit);
        }
}

} // namespace
} // namespace core
