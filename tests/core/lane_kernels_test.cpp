#include <random>

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "core/dbm/dbm.h"
#include "core/distance/lane_kernels.h"
#include "core/distance/point_search.h"
#include "tests/support/meshes.h"
#include "tests/support/point_clouds.h"

namespace core {
namespace {

using test_support::random_cloud;
using test_support::random_pose;

/// Restricts searches to one instruction set during its lifetime.
class OnlyTarget {
public:
    explicit OnlyTarget(int64_t target) { use(target); }
    ~OnlyTarget() { use(0); }
    OnlyTarget(const OnlyTarget&) = delete;
    OnlyTarget& operator=(const OnlyTarget&) = delete;

private:
    static void use(int64_t targets) {
        hwy::SetSupportedTargetsForTest(targets);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
};

std::vector<int64_t> targets_here() {
    std::vector<int64_t> targets;
    for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1)
        targets.push_back(left & -left);
    return targets;
}

struct Scene {
    PointTree a, b;
    std::vector<Transform> poses;
};

PointTree tree_of(const Primitive& shape, double spacing) {
    return point_tree(boundary_points(scan(shape, spacing).value())).value();
}

std::vector<Scene> scenes() {
    std::mt19937 rng(1);
    std::vector<Scene> all;
    all.push_back({tree_of(Sphere{25.0}, 1.0), tree_of(Sphere{25.0}, 1.5), {}});
    all.push_back({tree_of(Box{{60, 50, 5}}, 1.0), tree_of(Cylinder{8, 40}, 0.7), {}});
    all.push_back({point_tree(random_cloud(rng, 999, 20.0)).value(),
                   point_tree(random_cloud(rng, 777, 15.0)).value(),
                   {}});
    for (Scene& scene : all)
        for (int i = 0; i < 8; ++i) scene.poses.push_back(random_pose(rng, 60.0));
    return all;
}

TEST(LaneKernels, GiveTheSameBitsOnEveryInstructionSet) {
    const std::vector<int64_t> targets = targets_here();
    ASSERT_GE(targets.size(), 2u) << "only one instruction set is compiled in";
    for (const Scene& scene : scenes())
        for (const Transform& pose : scene.poses)
            for (const Vec3& sweep : {Vec3(0.0), Vec3(7.0, -3.0, 2.0)}) {
                const PairGoal goal{.sweep = sweep};
                const ClosestPair best = closest_pair(scene.a, scene.b, pose, goal);
                for (const int64_t target : targets) {
                    const OnlyTarget only(target);
                    const ClosestPair found = closest_pair(scene.a, scene.b, pose, goal);
                    EXPECT_EQ(found.distance, best.distance) << hwy::TargetName(target);
                    EXPECT_EQ(found.points, best.points) << hwy::TargetName(target);
                    EXPECT_EQ(found.at, best.at) << hwy::TargetName(target);
                    EXPECT_EQ(found.node_tests, best.node_tests) << hwy::TargetName(target);
                    EXPECT_EQ(found.point_tests, best.point_tests) << hwy::TargetName(target);
                }
            }
}

TEST(LaneKernels, AreReallyThoseOfTheInstructionSetChosen) {
    std::vector<const LaneKernels*> tables;
    for (const int64_t target : targets_here()) {
        const OnlyTarget only(target);
        tables.push_back(&lane_kernels());
    }
    std::sort(tables.begin(), tables.end());
    EXPECT_EQ(std::adjacent_find(tables.begin(), tables.end()), tables.end());
}

TEST(LaneKernels, BoundWhatTheyProject) {
    std::mt19937 rng(2);
    for (int i = 0; i < 50; ++i) {
        const PointTree tree =
            point_tree(random_cloud(rng, 128, std::pow(10.0, i % 9 - 4))).value();
        const Mat3 turn = random_pose(rng, 1.0).rotation;
        FrameView view;
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j)
                view.direction[static_cast<size_t>(k)][static_cast<size_t>(j)] =
                    static_cast<float>(turn[k][j]);
        const PointTree::Node& root = tree.nodes[0];
        for (auto* bound : {&view.lower, &view.upper})
            bound->fill((bound == &view.lower ? -2e-6F : 2e-6F) * root.reach);
        BoxLanes boxes;
        lane_kernels().project_boxes(root, view, boxes);
        for (size_t lane = 0; lane < 8; ++lane) {
            ASSERT_TRUE(root.used >> lane & 1U);
            const PointTree::Leaf& leaf = tree.leaves[root.child[lane] & ~PointTree::leaf_flag];
            for (uint32_t p = leaf.first; p < leaf.first + leaf.count; ++p)
                for (int k = 0; k < 3; ++k) {
                    const auto axis = static_cast<size_t>(k);
                    const double at = glm::dot(turn[k], tree.points[p] - root.origin);
                    EXPECT_LE(static_cast<double>(boxes.lower[axis][lane]), at);
                    EXPECT_GE(static_cast<double>(boxes.upper[axis][lane]), at);
                }
        }
    }
}

} // namespace
} // namespace core
