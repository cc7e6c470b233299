#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/geom/rigid_motion.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using std::numbers::pi;
using test_support::random_pose;

double apart(const Transform& a, const Transform& b) {
    double most = glm::distance(a.translation, b.translation);
    for (int i = 0; i < 3; ++i) most = std::max(most, glm::distance(a.rotation[i], b.rotation[i]));
    return most;
}

TEST(RigidMotion, LeadsFromOnePoseToTheOther) {
    std::mt19937 rng(1);
    for (int i = 0; i < 500; ++i) {
        const Transform start = random_pose(rng, 20.0), end = random_pose(rng, 20.0);
        const Vec3 centre = random_pose(rng, 10.0).translation;
        const RigidMotion motion = motion_between(start, end, centre);
        EXPECT_EQ(motion.at(0.0), start);
        EXPECT_EQ(motion.at(1.0), end);
        EXPECT_LE(motion.angle, pi + 1e-15);
        EXPECT_NEAR(glm::length(motion.axis), 1.0, 1e-14);
        EXPECT_LT(apart(motion.at(1e-13), start), 1e-11);
        EXPECT_LT(apart(motion.at(1.0 - 1e-13), end), 1e-11);
        EXPECT_LT(distortion(motion.at(0.37).rotation), 1e-14);
        EXPECT_LT(glm::distance(motion.at(0.25) * centre,
                                0.75 * (start * centre) + 0.25 * (end * centre)),
                  1e-13);
    }
}

TEST(RigidMotion, KeepsItsDigitsForTurnsNextToNoneAndNextToHalfATurn) {
    std::mt19937 rng(2);
    for (const double base : {0.0, pi})
        for (const double off : {0.0, 1e-15, 1e-12, 1e-8, 1e-6, 1e-3})
            for (int i = 0; i < 50; ++i) {
                const Transform start = random_pose(rng, 20.0);
                const Vec3 axis = random_pose(rng, 1.0).rotation[1];
                const double angle = base == 0.0 ? off : base - off;
                const RigidMotion turn = turning_motion(start, Vec3(3, 4, 5), axis, angle);
                const RigidMotion found = motion_between(start, turn.end, Vec3(3, 4, 5));
                EXPECT_NEAR(found.angle, angle, 1e-14);
                EXPECT_LT(apart(found.at(1.0 - 1e-13), turn.end), 1e-11) << base << ' ' << off;
                if (angle < pi) {
                    EXPECT_LT(apart(found.at(0.5), turn.at(0.5)), 1e-13) << base << ' ' << off;
                }
            }
}

TEST(RigidMotion, TurnsAboutItsAxisAsOftenAsIsSaid) {
    const Transform start{rotation_xyz_deg({10, 20, 30}), Vec3(1, 2, 3)};
    const RigidMotion motion =
        turning_motion(start, Vec3(7, 0, 0), Vec3(0, 0, 2), 6.0 * pi, Vec3(0, 0, 9));
    EXPECT_EQ(motion.axis, Vec3(0, 0, 1));
    const Transform third = motion.at(1.0 / 3.0);
    EXPECT_LT(apart(third, {start.rotation, start.translation + Vec3(0, 0, 3)}), 1e-13);
    EXPECT_LT(glm::distance(motion.travel(), Vec3(0, 0, 9)), 1e-13);
}

TEST(RigidMotion, BulgesAndSwingsNoMoreThanSaid) {
    std::mt19937 rng(3);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    double fullest_bulge = 0.0, fullest_swing = 0.0;
    for (int i = 0; i < 3000; ++i) {
        const Vec3 corner = glm::abs(random_pose(rng, 10.0).translation);
        const Aabb box{-corner, 0.5 * corner};
        const RigidMotion motion = turning_motion(
            random_pose(rng, 20.0), random_pose(rng, 20.0).translation,
            random_pose(rng, 1.0).rotation[0], 8.0 * share(rng), random_pose(rng, 5.0).translation);
        const double reach = reach_from_axis(motion, box);
        const double from = share(rng), to = from + (1.0 - from) * share(rng);
        const double inner = share(rng), time = from + inner * (to - from);
        const Vec3 p(box.min.x, i % 2 ? box.max.y : box.min.y, i % 3 ? box.max.z : box.min.z);
        const Vec3 chord = (1.0 - inner) * (motion.at(from) * p) + inner * (motion.at(to) * p);
        const double off_chord = glm::distance(motion.at(time) * p, chord);
        EXPECT_LE(off_chord, bulge(motion, reach, to - from) + 1e-12);
        if (bulge(motion, reach, to - from) > 1e-6)
            fullest_bulge = std::max(fullest_bulge, off_chord / bulge(motion, reach, to - from));

        const Mat3 kept = motion.at(0.5 * (from + to)).rotation;
        const Vec3 unturned = motion.at(time) * motion.centre + kept * (p - motion.centre);
        const double off = glm::distance(motion.at(time) * p, unturned);
        EXPECT_LE(off, swing(motion, reach, to - from) + 1e-12);
        if (swing(motion, reach, to - from) > 1e-6)
            fullest_swing = std::max(fullest_swing, off / swing(motion, reach, to - from));
    }
    EXPECT_GT(fullest_bulge, 0.8); // the bounds are no larger than need be
    EXPECT_GT(fullest_swing, 0.8);
}

} // namespace
} // namespace core
