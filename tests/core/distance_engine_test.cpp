#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "core/dbm/dbm.h"
#include "core/distance/distance_engine.h"
#include "tests/support/brute_force_pair.h"
#include "tests/support/meshes.h"
#include "tests/support/point_clouds.h"

namespace core {
namespace {

using test_support::block_of_points;
using test_support::brute_force_distance;
using test_support::Points;
using test_support::random_cloud;
using test_support::random_pose;

struct EngineCase {
    const char* name;
    std::unique_ptr<DistanceEngine> (*make)();
};

/// Requirements on every engine; run for each.
class AnyEngine : public testing::TestWithParam<EngineCase> {
protected:
    std::unique_ptr<DistanceEngine> engine = GetParam().make();

    PointBody add(const Points& points) { return engine->add(points).value(); }

    ClosestPair find(PointBody a, PointBody b, const Transform& pose, const PairGoal& goal = {}) {
        return engine->closest_pair(a, b, pose, goal).value();
    }

    /// The result must be an existing pair with the least distance, to the last bit.
    ClosestPair expect_least(const Points& a, const Points& b, const Transform& pose,
                             const PairGoal& goal = {}) {
        const ClosestPair found = find(add(a), add(b), pose, goal);
        const double least = brute_force_distance(a, b, pose, goal);
        EXPECT_EQ(found.found(), least < goal.limit);
        EXPECT_LE(found.lower, std::min(least, goal.limit));
        if (!found.found()) {
            EXPECT_EQ(found.lower, goal.limit);
            return found;
        }
        EXPECT_EQ(found.distance, least);
        EXPECT_EQ(found.lower, least);
        expect_real(a, b, pose, goal, found);
        return found;
    }

    static void expect_real(const Points& a, const Points& b, const Transform& pose,
                            const PairGoal& goal, const ClosestPair& found) {
        const Vec3& q = b[found.points.b];
        const Vec3 from = pose * q, sweep = goal.sweep;
        EXPECT_EQ(found.witness_a, a[found.points.a]);
        EXPECT_EQ(found.distance, swept_distance(found.witness_a - from, sweep));
        EXPECT_EQ(found.at, nearest_time(found.witness_a - from, sweep));
        EXPECT_LE(glm::distance(found.witness_b, from + found.at * sweep),
                  1e-15 * (glm::length(from) + glm::length(sweep)));
    }
};

TEST_P(AnyEngine, AgreesWithBruteForceOnRandomClouds) {
    std::mt19937 rng(21);
    int far = 0;
    for (int i = 0; i < 200; ++i) {
        const Points a = random_cloud(rng, 1 + i, 10.0), b = random_cloud(rng, 300 - i, 8.0);
        far += expect_least(a, b, random_pose(rng, 30.0)).distance > 5.0;
    }
    EXPECT_GT(far, 30); // a sample of only near or only far pairs would prove little
    EXPECT_LT(far, 170);
}

TEST_P(AnyEngine, AgreesWithBruteForceOnScansOfSolids) {
    const Points plate = boundary_points(scan(Box{{30.0, 20.0, 3.0}}, 1.0).value());
    const Points rod = boundary_points(scan(Cylinder{4.0, 25.0}, 0.7).value());
    const Points ball = boundary_points(scan(Sphere{9.0}, 0.8).value());
    std::mt19937 rng(22);
    for (int i = 0; i < 10; ++i) {
        expect_least(plate, rod, random_pose(rng, 25.0));
        expect_least(rod, ball, random_pose(rng, 18.0));
        expect_least(ball, plate, random_pose(rng, 25.0));
    }
}

TEST_P(AnyEngine, AgreesWithBruteForceAtAnySizeAndPosition) {
    std::mt19937 rng(23);
    for (const double size : {1e-9, 1e-3, 1.0, 1e4, 1e9})
        for (const double away : {0.0, 1.0, 1e5, 1e11}) {
            Points a = random_cloud(rng, 300, size), b = random_cloud(rng, 200, size);
            Transform pose = random_pose(rng, 2.0 * size);
            const Vec3 position(away, -0.3 * away, 0.7 * away);
            for (Vec3& p : a) p += position;
            pose.translation += position;
            expect_least(a, b, pose);
        }
}

TEST_P(AnyEngine, AgreesWithBruteForceWhenOneBodyIsTinyOrFar) {
    std::mt19937 rng(24);
    const Points dust = random_cloud(rng, 100, 1e-7), cloud = random_cloud(rng, 400, 100.0);
    for (const double reach : {0.0, 100.0, 1e6, 5e11}) {
        expect_least(dust, cloud, random_pose(rng, reach));
        expect_least(cloud, dust, random_pose(rng, reach));
    }
}

TEST_P(AnyEngine, AgreesWithBruteForceWhereLargeBodiesAlmostTouch) {
    std::mt19937 rng(36);
    for (int i = 0; i < 40; ++i) {
        // Every point of A is next to one of B; single precision cannot distinguish them.
        const Transform pose = random_pose(rng, 500.0);
        const Points a = random_cloud(rng, 300, 1000.0), off = random_cloud(rng, 300, 1e-6);
        Points b;
        for (size_t k = 0; k < a.size(); ++k) b.push_back(pose.inverse() * (a[k] + off[k]));
        expect_least(a, b, pose);
        const Vec3 sweep(0.0, 3e-7, 0.0);
        expect_least(a, b, pose, {.sweep = sweep});
    }
}

TEST_P(AnyEngine, FindsTheLastBitAmongPairsThatDifferByRoundingOnly) {
    std::mt19937 rng(25);
    for (int i = 0; i < 100; ++i) {
        // Two blocks with the same rotation: all columns have the same distance, except for
        // rounding.
        const Transform turned = random_pose(rng, 40.0);
        Points a = block_of_points(9, 5, 8), b = a;
        for (Vec3& p : a) p = turned * p;
        for (Vec3& p : b) p = turned * (p + Vec3(0.0, 0.0, 8.0 + i % 7));
        expect_least(a, b, {});
    }
}

TEST_P(AnyEngine, AcceptsSingleAndCoincidentPoints) {
    const Points one = {Vec3(1.0, 2.0, 3.0)}, same(90, Vec3(1.0, 2.0, 7.0));
    const Points line = block_of_points(70, 1, 1);
    expect_least(one, one, translation({0.0, 3.0, 4.0}));
    expect_least(one, one, {});
    expect_least(one, same, {});
    expect_least(same, same, translation({0.5, 0.0, 0.0}));
    expect_least(line, same, translation({3.25, -1.0, 0.0}));
    expect_least(line, line, {rotation_xyz_deg({0.0, 0.0, 45.0}), Vec3(5.0, 0.0, 1e-3)});
}

TEST_P(AnyEngine, FindsPointsThatCoincide) {
    const Points block = block_of_points(20, 20, 20);
    const ClosestPair found = find(add(block), add(block), {});
    EXPECT_EQ(found.distance, 0.0);
    EXPECT_EQ(found.lower, 0.0);
    EXPECT_LT(found.point_tests, 10'000u);
}

TEST_P(AnyEngine, IsTheSameEachTime) {
    std::mt19937 rng(26);
    const PointBody a = add(random_cloud(rng, 500, 5.0)), b = add(random_cloud(rng, 500, 5.0));
    const Transform pose = translation({9.0, 0.0, 0.0});
    const ClosestPair first = find(a, b, pose), again = find(a, b, pose);
    EXPECT_EQ(first.points, again.points);
    EXPECT_EQ(first.node_tests, again.node_tests);
    EXPECT_EQ(first.point_tests, again.point_tests);
}

TEST_P(AnyEngine, LooksNoFartherThanTheLimit) {
    std::mt19937 rng(27);
    for (int i = 0; i < 60; ++i) {
        const Points a = random_cloud(rng, 250, 10.0), b = random_cloud(rng, 150, 8.0);
        const Transform pose = random_pose(rng, 30.0);
        const double least = brute_force_distance(a, b, pose);
        for (const double limit :
             {0.0, 0.5 * least, least, std::nextafter(least, 1e9), 2.0 * least, 1e300})
            expect_least(a, b, pose, {.limit = limit});
    }
}

TEST_P(AnyEngine, FindsLessToDoWithALimitAndWithAGoodFirstPair) {
    const Points ball = boundary_points(scan(Sphere{25.0}, 1.0).value());
    const PointBody a = add(ball), b = add(ball);
    const Transform pose = translation(52.0 * glm::normalize(Vec3(1.0, 0.35, 0.2)));
    const ClosestPair cold = find(a, b, pose);
    const ClosestPair warm = find(a, b, pose, {.first = cold.points});
    EXPECT_EQ(warm.distance, cold.distance);
    EXPECT_EQ(warm.points, cold.points);
    EXPECT_LT(warm.node_tests, cold.node_tests);
    EXPECT_LT(find(a, b, pose, {.limit = 1.0}).node_tests, cold.node_tests);
}

TEST_P(AnyEngine, SaysWhetherAnyPairIsNearer) {
    std::mt19937 rng(28);
    for (int i = 0; i < 60; ++i) {
        const Points a = random_cloud(rng, 250, 10.0), b = random_cloud(rng, 150, 8.0);
        const Transform pose = random_pose(rng, 30.0);
        const double least = brute_force_distance(a, b, pose);
        const PointBody in_a = add(a), in_b = add(b);
        const PairGoal never{.limit = least, .any = true};
        EXPECT_FALSE(find(in_a, in_b, pose, never).found());
        EXPECT_EQ(find(in_a, in_b, pose, never).lower, least);
        const PairGoal yes{.limit = std::nextafter(least, 1e9), .any = true};
        EXPECT_EQ(find(in_a, in_b, pose, yes).distance, least);
        const PairGoal wide{.limit = least + 5.0, .any = true};
        const ClosestPair found = find(in_a, in_b, pose, wide);
        EXPECT_LT(found.distance, least + 5.0);
        EXPECT_LE(found.lower, least);
        expect_real(a, b, pose, wide, found);
    }
}

TEST_P(AnyEngine, GivesUpNoMoreThanTheTolerance) {
    std::mt19937 rng(29);
    int inexact = 0;
    for (int i = 0; i < 100; ++i) {
        const Points a = random_cloud(rng, 250, 10.0), b = random_cloud(rng, 150, 8.0);
        const Transform pose = random_pose(rng, 30.0);
        const double least = brute_force_distance(a, b, pose);
        for (const double tolerance : {1e-9, 0.1, 2.0}) {
            const PairGoal goal{.tolerance = tolerance};
            const ClosestPair found = find(add(a), add(b), pose, goal);
            EXPECT_LE(found.lower, least);
            EXPECT_GE(found.distance, least);
            EXPECT_LE(found.distance, found.lower + tolerance + 1e-14 * found.distance);
            expect_real(a, b, pose, goal, found);
            inexact += found.distance > least;
        }
    }
    EXPECT_GT(inexact, 0); // otherwise the search never gives up
}

TEST_P(AnyEngine, TakesAnyFirstPair) {
    std::mt19937 rng(30);
    for (int i = 0; i < 60; ++i) {
        const Points a = random_cloud(rng, 250, 10.0), b = random_cloud(rng, 150, 8.0);
        const PointPair any{rng() % a.size(), rng() % b.size()};
        expect_least(a, b, random_pose(rng, 30.0), {.first = any});
        expect_least(a, b, random_pose(rng, 30.0), {.limit = 10.0, .first = any});
    }
}

TEST_P(AnyEngine, FindsTheLeastDistanceOfAWholeTranslation) {
    std::mt19937 rng(31);
    std::uniform_real_distribution<double> reach(-1.0, 1.0);
    int within = 0;
    for (int i = 0; i < 150; ++i) {
        const Points a = random_cloud(rng, 200, 10.0), b = random_cloud(rng, 200, 8.0);
        const double length = std::pow(10.0, i % 7 - 3);
        const Vec3 sweep = length * Vec3(reach(rng), reach(rng), reach(rng));
        const ClosestPair found = expect_least(a, b, random_pose(rng, 40.0), {.sweep = sweep});
        within += found.at > 0.0 && found.at < 1.0;
    }
    EXPECT_GT(within, 25);
}

TEST_P(AnyEngine, TakesAWayToWhereItIsAndOneOfAHair) {
    std::mt19937 rng(34);
    for (const double length : {0.0, 1e-300, 1e-16, 1e-15, 1e-9}) {
        const Points a = random_cloud(rng, 300, 10.0), b = random_cloud(rng, 200, 8.0);
        const Transform pose = random_pose(rng, 30.0);
        expect_least(a, b, pose, {.sweep = Vec3(0.0, length, 0.0)});
    }
}

TEST_P(AnyEngine, KeepsTheLastBitWhenTheTransformIsOffByWhatIsAllowed) {
    std::mt19937 rng(35);
    for (int i = 0; i < 100; ++i) {
        Points block = block_of_points(9, 5, 8);
        Transform pose = {random_pose(rng, 1.0).rotation, Vec3(0.0)};
        for (Vec3& p : block) p = pose.rotation * p;
        pose = {Mat3(1.0), pose.rotation * Vec3(0.0, 0.0, 8.0 + i % 7)};
        pose.rotation *= 1.0 + 4e-10;
        expect_least(block, block, pose);
    }
}

TEST_P(AnyEngine, SweepsNeverExceedDenseSamples) {
    const Points plate = boundary_points(scan(Box{{30.0, 20.0, 3.0}}, 1.0).value());
    const Points ball = boundary_points(scan(Sphere{9.0}, 1.0).value());
    const PointBody a = add(plate), b = add(ball);
    std::mt19937 rng(32);
    for (int i = 0; i < 20; ++i) {
        const Transform from = random_pose(rng, 60.0);
        const Vec3 sweep = random_pose(rng, 30.0).translation - from.translation;
        const ClosestPair found = find(a, b, from, {.sweep = sweep});
        double sampled = infinity;
        for (int step = 0; step <= 200; ++step) {
            Transform pose = from;
            pose.translation += step / 200.0 * sweep;
            sampled = std::min(sampled, find(a, b, pose).distance);
        }
        EXPECT_LE(found.distance, sampled * (1.0 + 1e-12));
        EXPECT_GE(found.distance, sampled - glm::length(sweep) / 400.0);
    }
}

TEST_P(AnyEngine, RefusesInvalidBodies) {
    EXPECT_NE(engine->add({}).error().message.find("without boundary points"), std::string::npos);
    for (const double bad : {std::nan(""), infinity, -infinity, 1e200}) {
        const Points points = {Vec3(0.0), Vec3(1.0, bad, 0.0)};
        ASSERT_FALSE(engine->add(points));
        EXPECT_NE(engine->add(points).error().message.find("point 1 "), std::string::npos);
    }
}

TEST_P(AnyEngine, EstimatesTheMemoryOfABodyBeforeAllocating) {
    const Points block = block_of_points(100, 100, 10);
    const auto refused = engine->add(block, 1e6);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("100000 points needs"), std::string::npos);
    EXPECT_FALSE(engine->closest_pair(PointBody(0), PointBody(0), {})) << "nothing was added";
    EXPECT_TRUE(engine->add(block, 2e7));
}

TEST_P(AnyEngine, RefusesInvalidQueries) {
    const PointBody body = add(block_of_points(2, 2, 2));
    const auto message = [&](const Transform& pose, const PairGoal& goal, PointBody other) {
        const auto found = engine->closest_pair(body, other, pose, goal);
        return found ? std::string() : found.error().message;
    };
    const double nan = std::nan("");
    Transform flat, mirror, scaled, none;
    flat.rotation[2] = Vec3(0.0);
    mirror.rotation[1] = -mirror.rotation[1];
    scaled.rotation *= 1.001;
    none.rotation[0][0] = nan;
    for (const Transform& t : {flat, mirror, scaled, none})
        EXPECT_NE(message(t, {}, body).find("not rigid"), std::string::npos);
    EXPECT_NE(message(translation({nan, 0, 0}), {}, body), "");
    EXPECT_NE(message(translation({1e13, 0, 0}), {}, body), "");
    EXPECT_NE(message({}, {.sweep = Vec3(0, infinity, 0)}, body), "");
    EXPECT_NE(message({}, {.limit = -1.0}, body), "");
    EXPECT_NE(message({}, {.limit = nan}, body), "");
    EXPECT_NE(message({}, {.tolerance = -1e-9}, body), "");
    EXPECT_NE(message({}, {.first = PointPair{8, 0}}, body), "");
    EXPECT_NE(message({}, {.first = PointPair{0, uint64_t(1) << 32U}}, body), "");
    EXPECT_NE(message({}, {}, PointBody(7)).find("no body"), std::string::npos);
    EXPECT_EQ(message({}, {}, body), "");
}

INSTANTIATE_TEST_SUITE_P(Engines, AnyEngine,
                         testing::Values(EngineCase{"Paper", paper_engine},
                                         EngineCase{"Fast", fast_engine}),
                         [](const auto& engine) { return std::string(engine.param.name); });

} // namespace
} // namespace core
