#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/dbm/dbm.h"
#include "core/distance/motion_search.h"
#include "tests/support/brute_force_pair.h"
#include "tests/support/meshes.h"
#include "tests/support/point_clouds.h"

namespace core {
namespace {

using std::numbers::pi;
using test_support::Points;
using test_support::random_cloud;
using test_support::random_pose;

RigidMotion random_motion(std::mt19937& rng, double size) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    if (rng() % 3 == 0) return motion_between(random_pose(rng, size), random_pose(rng, size));
    return turning_motion(random_pose(rng, size), random_pose(rng, size).translation,
                          random_pose(rng, 1.0).rotation[0],
                          (rng() % 4 ? 1.5 : 15.0) * (share(rng) - 0.5),
                          random_pose(rng, 0.5 * size).translation);
}

/// No sample may be nearer than the bound, and the answer no farther than the nearest sample.
void expect_never_misses(const DistanceEngine& engine, PointBody a, PointBody b,
                         const RigidMotion& motion, const PairGoal& goal, const ClosestPair& found,
                         int samples) {
    double least = infinity;
    for (int i = 0; i <= samples; ++i) {
        const Transform pose = motion.at(double(i) / samples);
        least = std::min(least, engine.closest_pair(a, b, pose).value().distance);
    }
    const double slack = std::max(goal.tolerance, least_motion_tolerance(100.0));
    EXPECT_LE(found.lower, least);
    if (!found.found()) {
        EXPECT_GE(least, goal.limit);
        EXPECT_EQ(found.lower, goal.limit);
        return;
    }
    EXPECT_LE(found.distance, least + slack);
    EXPECT_LE(found.distance, found.lower + slack + 1e-12);
    const ClosestPair there = engine.pair_at(a, b, found.points, motion.at(found.at)).value();
    EXPECT_EQ(there.distance, found.distance);
    EXPECT_EQ(there.witness_a, found.witness_a);
    EXPECT_EQ(there.witness_b, found.witness_b);
}

TEST(MotionSearch, NeverMissesWhatSamplesFind) {
    std::mt19937 rng(1);
    for (const auto& make : {paper_engine, fast_engine})
        for (int i = 0; i < 60; ++i) {
            const auto engine = make();
            const PointBody a = engine->add(random_cloud(rng, 60, 10.0)).value();
            const PointBody b = engine->add(random_cloud(rng, 60, 8.0)).value();
            const RigidMotion motion = random_motion(rng, 40.0);
            const PairGoal goal{.tolerance = i % 2 ? 1e-3 : 0.1};
            const auto found = closest_pair(*engine, a, b, motion, goal);
            ASSERT_TRUE(found);
            expect_never_misses(*engine, a, b, motion, goal, *found, 1000);
        }
}

TEST(MotionSearch, NeverMissesBetweenBodiesWithFaces) {
    std::mt19937 rng(2);
    const auto engine = fast_engine();
    const PointBody plate =
        engine->add(boundary_points(scan(Box{{40, 30, 4}}, 1.0).value())).value();
    const PointBody rod = engine->add(boundary_points(scan(Cylinder{4, 30}, 1.0).value())).value();
    for (int i = 0; i < 25; ++i) {
        const RigidMotion motion = random_motion(rng, 40.0);
        const PairGoal goal{.tolerance = 1e-2};
        const auto found = closest_pair(*engine, plate, rod, motion, goal);
        ASSERT_TRUE(found);
        expect_never_misses(*engine, plate, rod, motion, goal, *found, 400);
    }
}

TEST(MotionSearch, FindsThePassOfAPointOnACircle) {
    const auto engine = fast_engine();
    const PointBody post = engine->add(Points{{30.0, 40.0, 5.0}}).value(); // 50 from the Z axis
    const PointBody tip = engine->add(Points{{47.0, 0.0, 0.0}}).value();
    const RigidMotion past = turning_motion({}, Vec3(0.0), Vec3(0, 0, 1), pi, Vec3(0, 0, 10.0));
    const auto found = closest_pair(*engine, post, tip, past, {.tolerance = 1e-6});
    ASSERT_TRUE(found);
    // Half way up it stands 3 mm inside of the post's circle, but not yet at its angle; the truth
    // is found by going along the way finely.
    double truth = infinity;
    for (int i = 0; i <= 2'000'000; ++i) {
        const double t = i / 2e6;
        const Vec3 at(47.0 * std::cos(pi * t), 47.0 * std::sin(pi * t), 10.0 * t);
        truth = std::min(truth, glm::distance(at, Vec3(30.0, 40.0, 5.0)));
    }
    EXPECT_NEAR(found->distance, truth, 2e-6);
    EXPECT_LE(found->lower, truth);
    const RigidMotion flat = turning_motion({}, Vec3(0.0), Vec3(0, 0, 1), 4.0 * pi);
    const auto thrice = closest_pair(*engine, post, tip, flat, {.tolerance = 1e-6});
    EXPECT_NEAR(thrice->distance, std::hypot(3.0, 5.0), 2e-6);
}

TEST(MotionSearch, StaysAwayFromACrashBetweenTwoSafeEnds) {
    // A bar swings through a post; both ends of the swing, and all places a tenth of it apart,
    // are clear by more than 20 mm.
    const auto engine = fast_engine();
    Points bar;
    for (int i = 0; i <= 100; ++i) bar.emplace_back(i, 0.0, 0.0);
    const PointBody b = engine->add(bar).value();
    const double angle = 0.05 * pi + 0.3;
    const PointBody a =
        engine->add(Points{{99.0 * std::cos(angle), 99.0 * std::sin(angle), 0.0}}).value();
    const RigidMotion swing_by = turning_motion({}, Vec3(0.0), Vec3(0, 0, 1), 2.0);
    const auto found = closest_pair(*engine, a, b, swing_by, {.tolerance = 1e-5});
    EXPECT_LT(found->distance, 2e-5);
    EXPECT_NEAR(found->at, angle / 2.0, 1e-5);
}

TEST(MotionSearch, IsExactWhereNothingTurns) {
    std::mt19937 rng(4);
    const auto engine = fast_engine();
    const Points cloud = random_cloud(rng, 300, 10.0);
    const PointBody a = engine->add(cloud).value(), b = engine->add(cloud).value();
    const Transform start = random_pose(rng, 40.0);
    const Transform end{start.rotation, start.translation + Vec3(10, -20, 30)};
    const RigidMotion motion = motion_between(start, end);
    const auto found = closest_pair(*engine, a, b, motion);
    const PairGoal goal{.sweep = motion.travel()};
    EXPECT_EQ(found->distance, test_support::brute_force_distance(cloud, cloud, start, goal));
}

TEST(MotionSearch, LooksNoFartherThanTheLimitAndEndsWhenAnyWillDo) {
    std::mt19937 rng(5);
    for (int i = 0; i < 40; ++i) {
        const auto engine = fast_engine();
        const PointBody a = engine->add(random_cloud(rng, 60, 10.0)).value();
        const PointBody b = engine->add(random_cloud(rng, 60, 8.0)).value();
        const RigidMotion motion = random_motion(rng, 40.0);
        const double least = closest_pair(*engine, a, b, motion, {.tolerance = 1e-5})->distance;
        const PairGoal within{.limit = least + 1.0, .tolerance = 1e-3};
        expect_never_misses(*engine, a, b, motion, within,
                            closest_pair(*engine, a, b, motion, within).value(), 100);
        EXPECT_FALSE(closest_pair(*engine, a, b, motion, {.limit = least - 1e-4})->found());
        const auto some = closest_pair(*engine, a, b, motion, {.limit = least + 1.0, .any = true});
        EXPECT_LT(some->distance, least + 1.0);
        EXPECT_LE(some->lower, least);
    }
}

/// Rotations may be off by a little; the way then does not end quite where its turn leads, and the
/// bound must hold just before the end as well.
TEST(MotionSearch, BoundsTheWayUpToAnEndThatIsNotQuiteARotation) {
    const auto engine = fast_engine();
    const PointBody a = engine->add(Points{{1010, 0, 0}}).value();
    const PointBody b = engine->add(Points{{1000, 0, 0}, {-1000, 0, 0}}).value();
    for (const double turn_deg : {0.0, 1e-5, 30.0})
        for (const double scale : {1.0 - 4.9e-10, 1.0 + 4.9e-10}) {
            const Mat3 turned = rotation_xyz_deg({0, 0, turn_deg});
            const Transform start{glm::transpose(turned), Vec3(0.0)};
            const RigidMotion motion = motion_between(start, {scale * Mat3(1.0), {5, 0, 0}});
            const auto found = closest_pair(*engine, a, b, motion);
            ASSERT_TRUE(found);
            for (const double time : {1.0 - 1e-9, 1.0 - 1e-12, 1.0})
                EXPECT_LE(found->lower, engine->closest_pair(a, b, motion.at(time))->distance);
            EXPECT_LE(found->distance, found->lower + least_motion_tolerance(3100.0));
        }
}

TEST(MotionSearch, EndsForLargeBodiesFarAway) {
    std::mt19937 rng(6);
    const auto engine = fast_engine();
    const PointBody a = engine->add(random_cloud(rng, 60, 1e9)).value();
    const PointBody b = engine->add(random_cloud(rng, 60, 1e9)).value();
    const RigidMotion motion = random_motion(rng, 4e9);
    const auto found = closest_pair(*engine, a, b, motion, {.tolerance = 1e-9});
    ASSERT_TRUE(found);
    EXPECT_LE(found->distance - found->lower, least_motion_tolerance(1e11));
}

TEST(MotionSearch, RefusesWhatIsNoMotion) {
    const auto engine = fast_engine();
    const PointBody a = engine->add(Points{Vec3(0.0)}).value();
    const RigidMotion good = turning_motion({}, Vec3(1.0), Vec3(0, 0, 1), 1.0);
    EXPECT_TRUE(closest_pair(*engine, a, a, good));
    EXPECT_FALSE(closest_pair(*engine, a, a, good, {.sweep = Vec3(1.0)}));
    EXPECT_FALSE(closest_pair(*engine, a, a, good, {.end = Transform{}}));
    EXPECT_FALSE(closest_pair(*engine, a, a, good, {.tolerance = -1.0}));
    EXPECT_FALSE(closest_pair(*engine, a, PointBody(9), good));
    RigidMotion bad = good;
    bad.axis = Vec3(0, 0, 2);
    EXPECT_FALSE(closest_pair(*engine, a, a, bad));
    bad = good, bad.angle = 0.0; // and yet the end is turned
    EXPECT_FALSE(closest_pair(*engine, a, a, bad));
    bad = good, bad.angle = 1.1;
    EXPECT_FALSE(closest_pair(*engine, a, a, bad));
    bad = good, bad.angle = infinity;
    EXPECT_FALSE(closest_pair(*engine, a, a, bad));
    EXPECT_FALSE(closest_pair(*engine, a, a, turning_motion({}, Vec3(1.0), Vec3(0.0), 1.0)));
}

} // namespace
} // namespace core
