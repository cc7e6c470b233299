#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/distance/measurement.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using std::numbers::pi;
using test_support::random_pose;

/// Bodies of every kind, taken into one engine.
struct Bodies {
    std::unique_ptr<DistanceEngine> engine = fast_engine();
    std::vector<MeasuredBody> exact, scanned;
    MeasuredBody lines_only;

    MeasuredBody taken(Result<MeasuredBody> body) {
        return taken_into(*engine, std::move(body).value()).value();
    }
    Bodies() {
        const Primitive ball = Sphere{9.0}, block = Box{{30.0, 8.0, 12.0}},
                        rod = Cylinder{3.0, 40.0};
        for (const Primitive& primitive : {ball, block, rod})
            exact.push_back(taken(measured_body(primitive, 1.0)));
        exact.push_back(taken(measured_body(RevolvedProfile{{{0, 2, 20, 6, 0}}}, 1.0)));
        exact.push_back(
            taken(measured_body(solid_mesh(test_support::box_mesh({-4, -6, -8}, {4, 6, 8})), 1.0)));
        for (const Primitive& primitive : {block, rod}) {
            const Dbm lines = scan(primitive, 1.0).value();
            const Vec3 half(20.0);
            scanned.push_back(taken(measured_body(
                lines, outer_model({-half, half}, lines.grid, columns_of(primitive)))));
        }
        lines_only = taken(measured_body(scan(ball, 1.0).value()));
    }
};

RigidMotion random_motion(std::mt19937& rng, double reach) {
    std::uniform_real_distribution<double> share(-1.0, 1.0);
    if (rng() % 3 == 0) return motion_between(random_pose(rng, reach), random_pose(rng, reach));
    return turning_motion(random_pose(rng, reach), random_pose(rng, 0.5 * reach).translation,
                          random_pose(rng, 1.0).rotation[0], 2.5 * share(rng),
                          random_pose(rng, 0.7 * reach).translation);
}

/// No place on the way may prove the bounds wrong.
void expect_holds_on_the_way(const DistanceEngine& engine, const MeasuredBody& a,
                             const MeasuredBody& b, const RigidMotion& motion,
                             const MeasureGoal& goal, const Measurement& found) {
    double least_upper = infinity;
    for (int i = 0; i <= 150; ++i) {
        const Measurement there = measure(engine, a, b, motion.at(i / 150.0)).value();
        EXPECT_LE(found.lower, there.upper);
        least_upper = std::min(least_upper, there.upper);
    }
    EXPECT_LE(found.lower, found.upper);
    if (found.upper == infinity) {
        EXPECT_GE(least_upper, goal.limit);
        return;
    }
    EXPECT_LE(found.upper, least_upper + goal.tolerance + 1e-12);
    const Measurement at = measure(engine, a, b, motion.at(found.at)).value();
    EXPECT_GE(found.upper, at.lower);
    EXPECT_NEAR(glm::distance(found.witness_a, found.witness_b), found.upper, 1e-6);
}

TEST(MotionMeasurement, HoldsForExactBodiesAndIsAsTightAsAsked) {
    Bodies bodies;
    std::mt19937 rng(1);
    int apart = 0;
    for (int i = 0; i < 40; ++i) {
        const MeasuredBody& a = bodies.exact[rng() % 5];
        const MeasuredBody& b = bodies.exact[rng() % 5];
        const RigidMotion motion = random_motion(rng, 45.0);
        const MeasureGoal goal{.tolerance = 0.02};
        const auto found = measure(*bodies.engine, a, b, motion, goal);
        ASSERT_TRUE(found);
        EXPECT_LE(found->upper, found->lower + 0.02 + 1e-12);
        EXPECT_EQ(found->reason, "");
        expect_holds_on_the_way(*bodies.engine, a, b, motion, goal, *found);
        apart += found->lower > 0.0;
    }
    EXPECT_GT(apart, 8);
    EXPECT_LT(apart, 36);
}

TEST(MotionMeasurement, HoldsForScannedBodiesWithAnOuterModel) {
    Bodies bodies;
    std::mt19937 rng(2);
    int apart = 0;
    for (int i = 0; i < 16; ++i) {
        const MeasuredBody& a = bodies.scanned[rng() % 2];
        const MeasuredBody& b = bodies.exact[rng() % 5];
        const RigidMotion motion = random_motion(rng, 45.0);
        const MeasureGoal goal{.tolerance = 0.1};
        const auto found = measure(*bodies.engine, a, b, motion, goal);
        ASSERT_TRUE(found);
        EXPECT_LE(found->upper - found->lower, 4.0);
        expect_holds_on_the_way(*bodies.engine, a, b, motion, goal, *found);
        apart += found->lower > 0.0;
    }
    EXPECT_GT(apart, 2);
}

TEST(MotionMeasurement, SaysWhyNothingBoundsABodyKnownByLinesOnly) {
    Bodies bodies;
    const RigidMotion motion =
        turning_motion(translation({60.0, 0.0, 0.0}), Vec3(-60.0, 0.0, 0.0), Vec3(0, 0, 1), 1.0);
    const auto found = measure(*bodies.engine, bodies.lines_only, bodies.exact[0], motion);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->lower, 0.0);
    EXPECT_NE(found->reason.find("A is known by scan lines only"), std::string::npos);
    EXPECT_LE(found->upper, found->scan.distance + 1e-8);
    EXPECT_GT(found->upper, 42.0 - 1e-6); // two balls of 9 mm, 60 mm apart
}

TEST(MotionMeasurement, KnowsHowFarABallIsFromABallItIsTurnedRound) {
    Bodies bodies;
    const MeasuredBody& ball = bodies.exact[0];
    const RigidMotion round = turning_motion(translation({20.0, 0.0, 0.0}), Vec3(-20.0, 0.0, 0.0),
                                             Vec3(0, 0, 1), 2.0 * pi);
    const auto found = measure(*bodies.engine, ball, ball, round, {.tolerance = 0.05});
    EXPECT_LE(found->lower, 2.0 + 1e-9);
    EXPECT_GE(found->upper, 2.0 - 1e-9);
    EXPECT_LE(found->upper, found->lower + 0.05 + 1e-12);
}

TEST(MotionMeasurement, HoldsTheTruthWhereverABallOnAnArmPassesAPost) {
    Bodies bodies;
    const MeasuredBody small = bodies.taken(measured_body(Primitive(Sphere{1.0}), 0.7));
    for (int i = 0; i < 40; ++i) {
        // The post is 103 mm out, at an angle that the arm of 100 mm passes.
        const double angle = 0.02 + 0.96 * i / 39.0;
        const Vec3 post(103.0 * std::cos(angle), 103.0 * std::sin(angle), 0.0);
        const RigidMotion past = turning_motion(translation(Vec3(100.0, 0.0, 0.0) - post),
                                                Vec3(-100.0, 0.0, 0.0), Vec3(0, 0, 1), 1.0);
        const auto found = measure(*bodies.engine, small, small, past, {.tolerance = 1e-3});
        EXPECT_LE(found->lower, 1.0 + 1e-9);
        EXPECT_GE(found->upper, 1.0 - 1e-9);
        EXPECT_LE(found->upper, found->lower + 1e-3 + 1e-9);
    }
}

TEST(MotionMeasurement, SeesABarSwingThroughAPost) {
    Bodies bodies;
    // The rod, laid flat, turns about its end; the post's axis is 38 mm out, half a radian on.
    const Mat3 flat = rotation_xyz_deg({0.0, 90.0, 0.0});
    const Transform start{flat, Vec3(20.0, 0.0, 0.0)};
    const RigidMotion by = turning_motion(start, Vec3(0.0, 0.0, -20.0), Vec3(0, 0, 1), 1.0);
    ASSERT_LT(glm::length(start * by.centre), 1e-12);
    MeasuredBody post = bodies.taken(measured_body(Primitive(Cylinder{0.5, 30.0}), 0.2));
    const Transform post_from_origin =
        translation(Vec3(-38.0 * std::cos(0.5), -38.0 * std::sin(0.5), 0.0));
    RigidMotion past_post = by;
    past_post.start = post_from_origin * by.start;
    past_post.end = post_from_origin * by.end;
    const auto hit = measure(*bodies.engine, post, bodies.exact[2], past_post);
    EXPECT_EQ(hit->lower, 0.0);
    EXPECT_EQ(hit->upper, 0.0);
    EXPECT_NEAR(hit->at, 0.5, 0.1);
    const auto above =
        measure(*bodies.engine, post, bodies.exact[2],
                motion_between(translation({0, 0, 25.0}) * past_post.start,
                               translation({0, 0, 25.0}) * past_post.end, by.centre));
    EXPECT_NEAR(above->lower, 7.0, 1e-3); // 25 - 15 - 3
    EXPECT_NEAR(above->upper, 7.0, 1e-3);
}

/// A rotation may be off by a little: the end is then read in more than one way, and the bound
/// holds for all of them. One that is off by more is refused.
TEST(MotionMeasurement, HoldsAtAnEndThatIsNotQuiteARotation) {
    const auto engine = fast_engine();
    const auto cube = taken_into(*engine, measured_body(Box{Vec3(10.0)}, 1.0).value()).value();
    const auto bar = taken_into(*engine, measured_body(Box{{2000, 2, 2}}, 1.0).value()).value();
    const Transform start = translation({1010, 0, 0});
    for (const double turn_deg : {0.0, 1e-9, 1e-6}) {
        const Mat3 turned = rotation_xyz_deg({0, 0, turn_deg});
        const Transform end{(1.0 + 4.9e-10) * turned, start.translation};
        const auto found = measure(*engine, cube, bar, motion_between(start, end));
        ASSERT_TRUE(found);
        EXPECT_LE(found->lower, 5.0 - 4.9e-7); // as the matrix puts the bar's end
        EXPECT_GE(found->upper, 5.0 - 4.9e-7);
    }
    const Transform across{rotation_xyz_deg({0, 0, 90}), start.translation};
    EXPECT_FALSE(measure(*engine, cube, bar, RigidMotion{.start = start, .end = across}));
}

TEST(MotionMeasurement, LooksNoFartherThanTheLimit) {
    Bodies bodies;
    std::mt19937 rng(3);
    for (int i = 0; i < 20; ++i) {
        const MeasuredBody& a = bodies.exact[rng() % 5];
        const MeasuredBody& b = bodies.exact[rng() % 5];
        const RigidMotion motion = random_motion(rng, 60.0);
        const MeasureGoal goal{.limit = 10.0, .tolerance = 0.05};
        const auto found = measure(*bodies.engine, a, b, motion, goal);
        ASSERT_TRUE(found);
        expect_holds_on_the_way(*bodies.engine, a, b, motion, goal, *found);
        if (found->upper == infinity) {
            EXPECT_EQ(found->lower, 10.0);
        }
    }
    EXPECT_FALSE(measure(*bodies.engine, bodies.exact[0], bodies.exact[0], random_motion(rng, 9.0),
                         {.sweep = Vec3(1.0)}));
}

} // namespace
} // namespace core
