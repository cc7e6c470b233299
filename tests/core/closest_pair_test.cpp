#include <random>

#include <gtest/gtest.h>

#include "core/dbm/dbm.h"
#include "core/distance/sphere_search.h"
#include "tests/support/brute_force_pair.h"
#include "tests/support/meshes.h"
#include "tests/support/point_clouds.h"

namespace core {
namespace {

using test_support::block_of_points;
using test_support::brute_force_distance;
using test_support::random_cloud;
using test_support::random_pose;

SphereTree tree_of(const std::vector<Vec3>& points) { return sphere_tree(points).value(); }

SphereTree paper_sphere(double spacing) {
    return tree_of(boundary_points(scan(Sphere{25.0}, spacing).value()));
}

/// The result must be an existing pair with the least distance, to the last bit.
void expect_least(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const Transform& pose) {
    const ClosestPair found = closest_pair(tree_of(a), tree_of(b), pose);
    EXPECT_EQ(found.distance, brute_force_distance(a, b, pose));
    EXPECT_EQ(found.witness_a, a[found.points.a]);
    EXPECT_EQ(found.witness_b, pose * b[found.points.b]);
    EXPECT_EQ(found.distance, glm::distance(found.witness_a, found.witness_b));
    EXPECT_GT(found.node_tests, 0u);
    EXPECT_GE(found.node_tests, found.point_tests);
}

TEST(SphereTree, RefusesEmptyAndInvalidPoints) {
    EXPECT_FALSE(sphere_tree({}));
    for (const double bad : {std::nan(""), infinity, -infinity, 1e200}) {
        const std::vector<Vec3> points = {Vec3(0.0), Vec3(1.0, bad, 0.0)};
        ASSERT_FALSE(sphere_tree(points));
        EXPECT_NE(sphere_tree(points).error().message.find("point 1 "), std::string::npos);
    }
}

TEST(SphereTree, HoldsEveryPointOnceInsideEveryNodeAboveIt) {
    std::mt19937 rng(1);
    const std::vector<Vec3> points = random_cloud(rng, 777, 10.0);
    const SphereTree tree = tree_of(points);
    ASSERT_EQ(tree.nodes.size(), 2 * points.size() - 1);
    std::vector<int> seen(points.size(), 0);
    const auto visit = [&](const auto& self, uint32_t at, std::vector<uint32_t> above) -> void {
        const SphereTree::Node& node = tree.nodes[at];
        if (node.is_leaf()) {
            ++seen[node.point];
            EXPECT_EQ(node.centre, points[node.point]);
            EXPECT_EQ(node.radius, 0.0);
            for (const uint32_t i : above)
                EXPECT_LE(glm::distance(tree.nodes[i].centre, node.centre),
                          tree.nodes[i].radius * (1.0 + 1e-15));
            EXPECT_LE(above.size(), 10u);
            return;
        }
        above.push_back(at);
        self(self, at + 1, above);
        self(self, node.right, above);
    };
    visit(visit, 0, {});
    EXPECT_EQ(seen, std::vector<int>(points.size(), 1));
}

TEST(SphereTree, SplitsEqualCoordinatesByIndex) {
    const SphereTree tree = tree_of(std::vector<Vec3>(1000, Vec3(1.0)));
    uint32_t next = 0; // depth first; the leaves are in the order of the points
    for (const SphereTree::Node& node : tree.nodes)
        if (node.is_leaf()) {
            EXPECT_EQ(node.point, next++);
        }
    EXPECT_EQ(next, 1000u);
}

TEST(ClosestPair, AgreesWithBruteForceOnRandomClouds) {
    std::mt19937 rng(12345);
    int far = 0;
    for (int i = 0; i < 200; ++i) {
        const auto a = random_cloud(rng, 1 + i, 10.0);
        const auto b = random_cloud(rng, 300 - i, 8.0);
        const Transform pose = random_pose(rng, 30.0);
        expect_least(a, b, pose);
        far += brute_force_distance(a, b, pose) > 5.0;
    }
    EXPECT_GT(far, 30); // a sample of only near or only far pairs would prove little
    EXPECT_LT(far, 170);
}

TEST(ClosestPair, AgreesWithBruteForceFarFromTheOrigin) {
    std::mt19937 rng(7);
    for (int i = 0; i < 50; ++i) {
        auto a = random_cloud(rng, 200, 1.0);
        auto b = random_cloud(rng, 200, 1.0);
        Transform pose = random_pose(rng, 3.0);
        for (Vec3& p : a) p += Vec3(1e7, -1e7, 1e7);
        pose.translation += Vec3(1e7, -1e7, 1e7);
        expect_least(a, b, pose);
    }
}

TEST(ClosestPair, AgreesWithBruteForceOnLattices) {
    const auto plate = block_of_points(12, 12, 2);
    for (const double lift : {1.5, 2.0, 3.0, 7.25}) // all columns have the same distance
        expect_least(plate, plate, translation({0.0, 0.0, lift}));
    expect_least(plate, plate, {rotation_xyz_deg({0.0, 0.0, 90.0}), Vec3(3.0, -2.0, 4.0)});
    expect_least(plate, plate, {rotation_xyz_deg({30.0, 0.0, 45.0}), Vec3(5.0, 5.0, 14.0)});
}

TEST(ClosestPair, FindsTheLastBitAmongPairsThatDifferByRoundingOnly) {
    std::mt19937 rng(11);
    for (int i = 0; i < 400; ++i) {
        // Two blocks with the same rotation: all columns have the same distance, except for
        // rounding. The spheres of a column touch its end points, so their gaps also differ by the
        // last bits.
        const Transform turned = random_pose(rng, 40.0);
        std::vector<Vec3> a = block_of_points(5, 5, 8), b = a;
        for (Vec3& p : a) p = turned * p;
        for (Vec3& p : b) p = turned * (p + Vec3(0.0, 0.0, 8.0 + i % 7));
        expect_least(a, b, {});
    }
}

TEST(ClosestPair, TakesDuplicatesAndSinglePoints) {
    const std::vector<Vec3> one = {Vec3(1.0, 2.0, 3.0)};
    const std::vector<Vec3> same(9, Vec3(1.0, 2.0, 7.0));
    expect_least(one, one, translation({0.0, 3.0, 4.0}));
    expect_least(one, same, {});
    expect_least(same, same, translation({0.5, 0.0, 0.0}));
    const ClosestPair tie = closest_pair(tree_of(one), tree_of(same), {});
    EXPECT_EQ(tie.distance, 4.0);
}

TEST(ClosestPair, EndsAtTheFirstPointsThatCoincide) {
    const auto block = block_of_points(20, 20, 20);
    const ClosestPair found = closest_pair(tree_of(block), tree_of(block), {});
    EXPECT_EQ(found.distance, 0.0);
    EXPECT_LT(found.point_tests, 1000u);
}

TEST(ClosestPair, IsTheSameEachTime) {
    std::mt19937 rng(3);
    const auto a = random_cloud(rng, 500, 5.0), b = random_cloud(rng, 500, 5.0);
    const ClosestPair first = closest_pair(tree_of(a), tree_of(b), translation({9.0, 0.0, 0.0}));
    const ClosestPair again = closest_pair(tree_of(a), tree_of(b), translation({9.0, 0.0, 0.0}));
    EXPECT_EQ(first.points, again.points);
    EXPECT_EQ(first.node_tests, again.node_tests);
    EXPECT_EQ(first.point_tests, again.point_tests);
}

constexpr double separations[] = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0};

TEST(PaperSpheres, AreNeverFoundNearerThanTheyAre) {
    for (const double spacing : {0.5, 1.0, 1.5, 2.0}) {
        const SphereTree ball = paper_sphere(spacing);
        for (const double gap : separations)
            for (const Vec3& direction : {Vec3(1.0, 0.0, 0.0), glm::normalize(Vec3(3, 2, 1))}) {
                const auto found = closest_pair(ball, ball, translation((50.0 + gap) * direction));
                EXPECT_GE(found.distance, gap * (1.0 - 1e-12));
                EXPECT_LT(found.distance, gap + 2.0 * spacing);
            }
    }
}

TEST(PaperSpheres, AreWithinATenthOfAPercentFromTwentyMillimetresOn) {
    const SphereTree ball = paper_sphere(0.5);
    for (const double gap : {20.0, 30.0, 50.0}) {
        const auto found = closest_pair(ball, ball, translation({50.0 + gap, 0.0, 0.0}));
        EXPECT_LT((found.distance - gap) / gap, 0.001) << gap;
    }
}

TEST(PaperSpheres, NeedMoreSphereTestsThanPointTests) {
    const SphereTree ball = paper_sphere(0.5);
    for (const double gap : separations) {
        const auto found = closest_pair(ball, ball, translation({50.0 + gap, 0.0, 0.0}));
        EXPECT_GT(found.node_tests, found.point_tests);
        EXPECT_GT(found.point_tests, 0u);
    }
}

TEST(PaperSpheres, TakeTheTestsThatTheOrderOfTheSearchImplies) {
    // Other orders of splitting and visiting give the same distance with other counts.
    const SphereTree ball = paper_sphere(0.5);
    const auto near = closest_pair(ball, ball, translation({50.5, 0.0, 0.0}));
    EXPECT_EQ(near.node_tests, 6629u);
    EXPECT_EQ(near.point_tests, 4u);
    const auto unequal = closest_pair(ball, paper_sphere(2.0), translation({70.0, 10.0, 5.0}));
    EXPECT_EQ(unequal.node_tests, 13159u);
    EXPECT_EQ(unequal.point_tests, 20u);
}

} // namespace
} // namespace core
