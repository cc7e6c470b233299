#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/geom/feature_pick.h"
#include "core/geom/shape_features.h"
#include "core/geom/triangle_distance.h"
#include "tests/support/feature_bodies.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::bored_block;
using test_support::moved;
using test_support::prism_mesh;
using test_support::random_pose;
using test_support::rounded_rectangle;

/// A body that can be clicked.
struct Clickable {
    explicit Clickable(Mesh m)
        : mesh(std::move(m)), features(features_of(mesh)), bvh(build_bvh(mesh)) {}

    std::vector<FeaturePick> candidates(const Vec3& p, double reach) const {
        const NearestSurface hit = nearest_surface(bvh, p);
        return feature_candidates(features, hit.triangle, hit.point, reach);
    }
    FeatureKind kind(const Vec3& p, double reach) const { return candidates(p, reach).at(0).kind; }

    Mesh mesh;
    MeshFeatures features;
    TriangleBvh bvh;
};

TEST(FeaturePick, IsTheCornerThenTheRimThenTheEdgeThenTheFace) {
    const Clickable body(bored_block(50.0, 30.0, 12.0, 40));
    EXPECT_EQ(body.kind({49, 49.5, 30}, 2.0), FeatureKind::corner);
    EXPECT_EQ(body.candidates({49, 49.5, 30}, 2.0)[0].point, Vec3(50, 50, 30));
    EXPECT_EQ(body.kind({45, 49.5, 30}, 2.0), FeatureKind::edge);
    EXPECT_EQ(body.kind({30, 30, 30}, 2.0), FeatureKind::face);
    EXPECT_EQ(body.kind({13, 0.5, 30}, 2.0), FeatureKind::circle);
    const FeaturePick rim = body.candidates({13, 0.5, 30}, 2.0)[0];
    EXPECT_NEAR(glm::distance(rim.point, Vec3(0, 0, 30)), 0.0, 1e-9);
    EXPECT_NEAR(rim.radius, 12.0, 1e-9);
    const FeaturePick wall = body.candidates({11.9, 0, 15}, 2.0)[0];
    EXPECT_EQ(wall.kind, FeatureKind::wall);
    EXPECT_NEAR(glm::distance(wall.point, Vec3(0, 0, 15)), 0.0, 1e-9);
}

TEST(FeaturePick, OffersAllThatAClickCanMean) {
    const Clickable body(bored_block(50.0, 30.0, 12.0, 40));
    std::vector<FeatureKind> kinds;
    for (const FeaturePick& pick : body.candidates({49.5, 49, 30}, 2.0)) kinds.push_back(pick.kind);
    EXPECT_EQ(kinds, (std::vector{FeatureKind::corner, FeatureKind::edge, FeatureKind::edge,
                                  FeatureKind::face}));
    // A disc offers its centre everywhere.
    const Clickable disc(test_support::turned_mesh(
        std::vector<test_support::ProfilePoint>{{0, 0}, {20, 0}, {20, 5}, {0, 5}}, 36));
    const auto on_disc = disc.candidates({3, 4, 5}, 1.0);
    ASSERT_EQ(on_disc.size(), 2u);
    EXPECT_EQ(on_disc[0].kind, FeatureKind::face);
    EXPECT_EQ(on_disc[1].kind, FeatureKind::circle);
}

TEST(FeaturePick, PrefersTheEdgeOfAFaceToItsArcsAndOffersPartsOfWalls) {
    const Clickable body(prism_mesh(rounded_rectangle(40.0, 25.0, 6.0, 8), 0, 10));
    EXPECT_EQ(body.kind({0, 24.5, 10}, 1.0), FeatureKind::edge);
    const double corner = 6.0 * std::numbers::sqrt2 / 2.0 - 0.3;
    const auto arc = body.candidates({34 + corner, 19 + corner, 10}, 1.0);
    ASSERT_EQ(arc[0].kind, FeatureKind::circle);
    EXPECT_TRUE(body.features.circles[arc[0].index].arc);
    EXPECT_NEAR(glm::distance(arc[0].point, Vec3(34, 19, 10)), 0.0, 1e-9);
    // Opposite the arc its circle passes through the face, but the arc does not.
    EXPECT_EQ(body.kind({34 - 6, 19, 10}, 1.0), FeatureKind::face);
    const auto wall = body.candidates({40, 25, 5}, 1.0);
    ASSERT_EQ(wall.size(), 1u);
    EXPECT_EQ(wall[0].kind, FeatureKind::wall);
}

TEST(FeaturePick, IsOfTheSurfaceThatWasHit) {
    // The corner of the other side of a thin plate is within reach, but behind.
    const Clickable plate(test_support::box_mesh(Vec3(0.0), Vec3(40.0, 30.0, 1.0)));
    const auto picks = plate.candidates({1, 1, 1}, 3.0);
    ASSERT_EQ(picks.size(), 4u);
    EXPECT_EQ(picks[0].point, Vec3(0, 0, 1));
    for (const FeaturePick& pick : picks) EXPECT_EQ(pick.point.z, 1.0);
}

TEST(FeaturePick, IsStableWhereTwoAreEquallyNear) {
    const Clickable plate(test_support::box_mesh(Vec3(0.0), Vec3(40.0, 40.0, 10.0)));
    const FeaturePick first = plate.candidates({3, 3, 10}, 4.0)[0];
    EXPECT_EQ(first.kind, FeatureKind::edge);
    std::mt19937 rng(3);
    std::uniform_real_distribution<double> random(-1e-8, 1e-8);
    for (int i = 0; i < 100; ++i) {
        const Vec3 nearby(3 + random(rng), 3 + random(rng), 10);
        EXPECT_EQ(plate.candidates(nearby, 4.0)[0].index, first.index);
    }
}

TEST(FeaturePick, IsEmptyOnAFreeFormAndForNoPoint) {
    const Clickable ball(test_support::ball_mesh(20.0, 40, 40));
    EXPECT_TRUE(ball.candidates({20, 1, 1}, 5.0).empty());
    EXPECT_FALSE(pick_feature(ball.features, 0, Vec3(std::nan("")), 5.0));
    EXPECT_FALSE(pick_feature(MeshFeatures{}, no_index, Vec3(0.0), 5.0));
}

TEST(FeaturePick, MovesWithTheBody) {
    std::mt19937 rng(4);
    const Mesh mesh = bored_block(50.0, 30.0, 12.0, 40);
    const Clickable here(mesh);
    for (int i = 0; i < 20; ++i) {
        const Transform pose = random_pose(rng, 50.0);
        const Clickable there(moved(mesh, pose));
        for (const Vec3& p : {Vec3(49, 49.5, 30), Vec3(13, 0.5, 30), Vec3(45, 49.5, 30),
                              Vec3(30, 20, 30), Vec3(11.9, 0, 15)}) {
            const FeaturePick a = moved(here.candidates(p, 2.0)[0], pose);
            const FeaturePick b = there.candidates(pose * p, 2.0)[0];
            EXPECT_EQ(a.kind, b.kind);
            EXPECT_NEAR(glm::distance(a.point, b.point), 0.0, 1e-6);
            EXPECT_NEAR(a.distance, b.distance, 1e-6);
        }
    }
}

TEST(ShapeFeatures, OfABoxInAnyPoseAreItsFacesEdgesAndCorners) {
    std::mt19937 rng(5);
    for (int i = 0; i < 20; ++i) {
        const Transform pose = i == 0 ? Transform{} : random_pose(rng, 300.0);
        const MeshFeatures f = features_of(posed(convex(Aabb{{-1, -2, -3}, {4, 5, 6}}), pose));
        ASSERT_EQ(f.faces.size(), 6u);
        EXPECT_EQ(f.edges.size(), 12u);
        EXPECT_EQ(f.corners.size(), 8u);
        const Vec3 corner = pose * Vec3(4, 5, 6);
        const auto pick = pick_feature(f, 4711, corner + Vec3(0.1), 1.0);
        ASSERT_TRUE(pick);
        EXPECT_EQ(pick->kind, FeatureKind::corner);
        EXPECT_NEAR(glm::distance(pick->point, corner), 0.0, 1e-9);
    }
    EXPECT_TRUE(features_of(convex_sphere(3.0)).faces.empty());
}

TEST(ShapeFeatures, OfACylinderAreTwoFacesTwoRimsAndABoss) {
    std::mt19937 rng(6);
    for (int i = 0; i < 20; ++i) {
        const Transform pose = i == 0 ? Transform{} : random_pose(rng, 300.0);
        const MeshFeatures f = features_of(posed(convex(ProfileElement{-5, 10, 20, 10, 0}), pose));
        ASSERT_EQ(f.faces.size(), 2u);
        ASSERT_EQ(f.circles.size(), 2u);
        ASSERT_EQ(f.walls.size(), 1u);
        EXPECT_EQ(f.walls[0].kind, RoundKind::boss);
        EXPECT_EQ(f.circles[0].radius, 10.0);
        EXPECT_NEAR(f.faces[1].area, 100.0 * std::numbers::pi, 1e-9);
        const auto kind_at = [&](const Vec3& p) {
            return pick_feature(f, no_index, pose * p, 1.0).value().kind;
        };
        EXPECT_EQ(kind_at({10, 0, 5}), FeatureKind::wall);
        EXPECT_EQ(kind_at({0, 9.5, 20}), FeatureKind::circle);
        EXPECT_EQ(kind_at({0, 4, 20}), FeatureKind::face);
    }
    EXPECT_EQ(features_of(convex(ProfileElement{0, 0, 20, 10, 0})).faces.size(), 1u);
}

} // namespace
} // namespace core
