#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/dbm/dbm.h"
#include "core/distance/pair_tracker.h"
#include "core/geom/rigid_motion.h"
#include "tests/support/meshes.h"
#include "tests/support/point_clouds.h"

namespace core {
namespace {

using test_support::Points;
using test_support::random_cloud;
using test_support::random_pose;

constexpr auto engines = {paper_engine, fast_engine};

/// A way of many small steps, some of them of no length, some long, from pose to pose.
std::vector<Transform> random_path(std::mt19937& rng, double reach, int corners, int steps) {
    std::vector<Transform> path;
    Transform from = random_pose(rng, reach);
    for (int corner = 0; corner < corners; ++corner) {
        const Transform to = random_pose(rng, reach);
        const RigidMotion motion = motion_between(from, to);
        for (int i = 0; i < steps; ++i)
            path.push_back(motion.at(corner % 3 ? double(i) / steps : 0.02 * i / steps));
        from = path.back();
        path.push_back(from);
    }
    return path;
}

TEST(PairTracker, FindsTheSameDistancesAsSearchesOfTheirOwn) {
    std::mt19937 rng(1);
    for (const auto& make : engines)
        for (const double size : {1e-3, 1.0, 1e5}) {
            const auto engine = make();
            const PointBody a = engine->add(random_cloud(rng, 200, 10.0 * size)).value();
            const PointBody b = engine->add(random_cloud(rng, 150, 8.0 * size)).value();
            PairTracker tracker(*engine, a, b);
            for (const Transform& pose : random_path(rng, 25.0 * size, 6, 150)) {
                const ClosestPair found = tracker.closest_pair(pose).value();
                const ClosestPair alone = engine->closest_pair(a, b, pose).value();
                EXPECT_EQ(found.distance, alone.distance);
                EXPECT_EQ(found.lower, alone.lower);
                EXPECT_EQ(found.distance,
                          engine->pair_at(a, b, found.points, pose).value().distance);
            }
        }
}

TEST(PairTracker, FindsTheLastBitAlongFacesThatLieOverEachOther) {
    const auto engine = fast_engine();
    const PointBody plate =
        engine->add(boundary_points(scan(Box{{40, 30, 4}}, 1.0).value())).value();
    const PointBody block =
        engine->add(boundary_points(scan(Box{{10, 10, 10}}, 1.0).value())).value();
    PairTracker tracker(*engine, plate, block);
    for (int i = 0; i < 600; ++i) {
        const Transform pose{rotation_xyz_deg({0, 0, i < 300 ? 0.0 : 0.1 * i}),
                             Vec3(-10.0 + 0.03 * i, 0.01 * i, 8.0 + (i % 50 ? 0.0 : 0.5))};
        EXPECT_EQ(tracker.closest_pair(pose)->distance,
                  engine->closest_pair(plate, block, pose)->distance);
    }
}

TEST(PairTracker, MixesGoalsOfAllKinds) {
    std::mt19937 rng(2);
    const auto engine = fast_engine();
    const PointBody a = engine->add(random_cloud(rng, 200, 10.0)).value();
    const PointBody b = engine->add(random_cloud(rng, 150, 8.0)).value();
    PairTracker tracker(*engine, a, b);
    for (const Transform& pose : random_path(rng, 25.0, 12, 150)) {
        PairGoal goal;
        switch (rng() % 8) {
        case 0:
            goal.limit = 5.0;
            break;
        case 1:
            goal.sweep = Vec3(1.0, 0.5, 0.0);
            break;
        case 2:
            goal.limit = 3.0, goal.any = true;
            break;
        case 3:
            goal.tolerance = 0.5;
            break;
        default:
            break;
        }
        const ClosestPair found = tracker.closest_pair(pose, goal).value();
        const ClosestPair alone = engine->closest_pair(a, b, pose, goal).value();
        EXPECT_EQ(found.found(), alone.found());
        const double exact =
            engine->closest_pair(a, b, pose, {.sweep = goal.sweep}).value().distance;
        EXPECT_LE(found.lower, exact);
        if (goal.tolerance == 0.0 && !goal.any) {
            EXPECT_EQ(found.distance, alone.distance);
        } else if (found.found() && !goal.any) {
            EXPECT_LE(found.distance, exact + goal.tolerance);
        }
    }
}

TEST(PairTracker, SaysWhatIsNearerWithoutSearchingForMostPoses) {
    std::mt19937 rng(3);
    const auto engine = fast_engine();
    const PointBody ball = engine->add(boundary_points(scan(Sphere{25.0}, 1.0).value())).value();
    PairTracker tracker(*engine, ball, ball);
    int nearer = 0, poses = 0;
    for (int i = 0; i < 2000; ++i) {
        const double angle = 0.003 * i;
        const Transform pose{rotation_xyz_deg({0.0, 0.0, 0.01 * i}),
                             (54.5 + 4.0 * std::sin(0.01 * i))
                                 * Vec3(std::cos(angle), std::sin(angle), 0.1)};
        const double exact = engine->closest_pair(ball, ball, pose)->distance;
        EXPECT_EQ(tracker.is_nearer(pose, 2.0).value(), exact < 2.0);
        EXPECT_LE(tracker.lower_bound(pose), exact);
        nearer += exact < 2.0;
        ++poses;
    }
    EXPECT_GT(nearer, poses / 20);
    EXPECT_LT(nearer, poses / 2);
    EXPECT_LT(tracker.searches(), uint64_t(poses) / 5);
}

TEST(PairTracker, SettlesDistancesThatAreEqualToTheQuestion) {
    const auto engine = fast_engine();
    const PointBody one = engine->add(Points{Vec3(0.0)}).value();
    PairTracker tracker(*engine, one, one);
    for (const double x : {9.0, 4.0, 3.0, 3.0, 2.0, 3.0, 4.0}) {
        EXPECT_EQ(tracker.is_nearer(translation({x, 0.0, 0.0}), 3.0).value(), x < 3.0);
        EXPECT_LE(tracker.lower_bound(translation({x, 0.0, 0.0})), x);
    }
}

TEST(PairTracker, KnowsHowFarBHasMovedAtMost) {
    std::mt19937 rng(4);
    double fullest = 0.0;
    for (int i = 0; i < 500; ++i) {
        const Vec3 corner = glm::abs(random_pose(rng, 10.0).translation);
        const Aabb box{-0.3 * corner, corner};
        const Transform from = random_pose(rng, 5.0), to = random_pose(rng, 5.0);
        const double most = displacement(from, to, box);
        for (int k = 0; k < 8; ++k) {
            const Vec3 p(k & 1 ? box.min.x : box.max.x, k & 2 ? box.min.y : box.max.y,
                         k & 4 ? box.min.z : box.max.z);
            EXPECT_LE(glm::distance(from * p, to * p), most + 1e-12);
            fullest = std::max(fullest, glm::distance(from * p, to * p) / most);
        }
    }
    EXPECT_NEAR(fullest, 1.0, 1e-12);
}

/// The squares of such lengths have lost most of their digits.
TEST(PairTracker, BoundsDistancesWhoseSquaresUnderflow) {
    const auto engine = fast_engine();
    const PointBody one = engine->add(Points{Vec3(0.0)}).value();
    const auto pose = [](double tiny) { return translation(tiny * Vec3(1.0, 0.7, 0.3)); };
    const double exact = engine->closest_pair(one, one, pose(3e-161))->distance;
    for (int i = 0; i < 200; ++i) {
        PairTracker tracker(*engine, one, one);
        ASSERT_TRUE(tracker.closest_pair(pose((30.0 + 0.3 * i) * 1e-162)));
        EXPECT_LE(tracker.lower_bound(pose(3e-161)), exact);
        EXPECT_EQ(tracker.closest_pair(pose(3e-161))->distance, exact);
    }
}

TEST(PairTracker, PassesOnWhatIsWrong) {
    const auto engine = fast_engine();
    const PointBody one = engine->add(Points{Vec3(0.0)}).value();
    PairTracker tracker(*engine, one, one), nobody(*engine, one, PointBody(5));
    EXPECT_FALSE(tracker.closest_pair({Mat3(2.0), Vec3(0.0)}));
    EXPECT_FALSE(tracker.is_nearer({Mat3(2.0), Vec3(0.0)}, 1.0));
    EXPECT_FALSE(tracker.is_nearer({}, std::nan("")));
    EXPECT_FALSE(nobody.closest_pair({}));
    EXPECT_FALSE(nobody.is_nearer({}, 1.0));
}

} // namespace
} // namespace core
