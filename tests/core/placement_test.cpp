#include <random>

#include <gtest/gtest.h>

#include "core/base/units.h"
#include "core/geom/placement.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::random_pose;

Vec3 random_direction(std::mt19937& rng) { return random_pose(rng, 1.0).rotation[0]; }

double largest_difference(const Mat3& a, const Mat3& b) {
    double most = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(a[i][j] - b[i][j]));
    return most;
}

/// The angle of a rotation, radians.
double angle_of_turn(const Mat3& r) {
    return std::acos(std::clamp(0.5 * (r[0][0] + r[1][1] + r[2][2] - 1.0), -1.0, 1.0));
}

TEST(AnglesXyz, GiveTheSameRotationAgain) {
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> angle(-180.0, 180.0), tiny(-14.0, 0.0);
    for (int i = 0; i < 20000; ++i) {
        Vec3 angles(angle(rng), angle(rng), angle(rng));
        if (i % 4 == 0) angles.y = (i % 8 ? 90.0 : -90.0) + std::pow(10.0, tiny(rng));
        if (i % 4 == 1) angles = 45.0 * glm::round(angles / 45.0);
        if (i % 4 == 2) angles = 0.001 * glm::round(angles / 0.001);
        const Mat3 rotation = rotation_xyz_deg(angles);
        const Mat3 again = rotation_xyz_deg(angles_xyz_deg(rotation));
        EXPECT_LE(largest_difference(rotation, again), 1e-9) << angles.x << " " << angles.y;
    }
}

TEST(AnglesXyz, AreRoundWhereTheRotationIs) {
    std::mt19937 rng(2);
    std::uniform_int_distribution<int> tenth(-899, 899);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 angles(0.2 * tenth(rng), 0.1 * tenth(rng), 0.2 * tenth(rng));
        const Vec3 found = angles_xyz_deg(rotation_xyz_deg(angles));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], angles[k], 1e-13);
    }
    EXPECT_EQ(angles_xyz_deg(rotation_xyz_deg({0, 120, 0})), Vec3(0, 120, 0));
    EXPECT_EQ(angles_xyz_deg(rotation_xyz_deg({180, 0, 0})), Vec3(180, 0, 0));
    EXPECT_EQ(angles_xyz_deg(rotation_xyz_deg({0, 0, -180})), Vec3(0, 0, 180));
    EXPECT_EQ(angles_xyz_deg(rotation_xyz_deg({30, 90, 0})), Vec3(0, 90, -30));
    EXPECT_EQ(angles_xyz_deg(rotation_xyz_deg({33.3, 0, 0})), Vec3(33.3, 0, 0));
    EXPECT_EQ(angles_xyz_deg(Mat3(1.0)), Vec3(0.0));
}

TEST(LeastRotation, TurnsByTheAngleBetweenTheDirections) {
    std::mt19937 rng(3);
    std::uniform_real_distribution<double> exponent(-12.0, 0.0);
    for (int i = 0; i < 5000; ++i) {
        const Vec3 a = random_direction(rng);
        Vec3 b = random_direction(rng);
        if (i % 3 == 1) b = glm::normalize(a + std::pow(10.0, exponent(rng)) * b);
        if (i % 3 == 2) b = glm::normalize(-a + std::pow(10.0, exponent(rng)) * b);
        const Mat3 turn = least_rotation(a, b);
        EXPECT_LE(glm::distance(turn * a, b), 2e-12);
        EXPECT_LE(distortion(turn), 1e-14);
        EXPECT_NEAR(glm::determinant(turn), 1.0, 1e-12);
        const double angle = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
        EXPECT_NEAR(angle_of_turn(turn), angle, 2e-6); // acos loses half of the digits
    }
}

TEST(LeastRotation, IsExactBetweenAxes) {
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k) {
            Vec3 a(0.0), b(0.0);
            a[i / 2] = i % 2 ? 1.0 : -1.0;
            b[k / 2] = k % 2 ? 1.0 : -1.0;
            const Mat3 turn = least_rotation(a + Vec3(1e-15, -1e-16, 1e-15), b);
            EXPECT_EQ(turn * a, b);
            for (int c = 0; c < 3; ++c)
                for (int r = 0; r < 3; ++r)
                    EXPECT_TRUE(turn[c][r] == 0.0 || std::abs(turn[c][r]) == 1.0);
        }
    // Upright faces turn about Z: the body keeps standing.
    EXPECT_EQ(least_rotation({1, 0, 0}, {-1, 0, 0})[2], Vec3(0, 0, 1));
    const Vec3 oblique(0.6, 0.8, 0.0);
    EXPECT_EQ(least_rotation(oblique, -oblique)[2], Vec3(0, 0, 1));
}

TEST(FaceToFace, BringsThePlanesTogether) {
    std::mt19937 rng(4);
    std::uniform_real_distribution<double> offset(-5.0, 20.0);
    for (int i = 0; i < 2000; ++i) {
        const Transform pose = random_pose(rng, 200.0), other = random_pose(rng, 200.0);
        const FacePlane moving{random_pose(rng, 80.0).translation, random_direction(rng)};
        const FacePlane fixed{other.translation, other.rotation[2]};
        const FaceFit fit{i % 2 == 0, i % 3 == 0, offset(rng)};
        const Transform found = face_to_face(moving, fixed, pose, fit);
        const FacePlane now = moved(moving, found), before = moved(moving, pose);
        EXPECT_LE(glm::distance(now.normal, fit.flush ? fixed.normal : -fixed.normal), 1e-12);
        EXPECT_NEAR(glm::dot(now.point - fixed.point, fixed.normal), fit.offset, 1e-10);
        // Along the normal only, or straight above the point of the fixed face.
        const Vec3 aside = now.point - (fit.centred ? fixed.point : before.point);
        EXPECT_LE(glm::length(glm::cross(aside, fixed.normal)), 1e-10);
        EXPECT_NEAR(angle_of_turn(found.rotation * glm::transpose(pose.rotation)),
                    std::acos(glm::dot(before.normal, now.normal)), 1e-6);
    }
}

TEST(FaceToFace, KeepsExactNumbersExact) {
    const FacePlane jaw{{0, 58, 25}, {0, -1, 0}}, side{{40.5, 0, 10}, {1, 0, 0}};
    const Transform pose{rotation_xyz_deg({0, 0, 180}), {3.25, 4.5, 7.125}};
    const Transform found = face_to_face(side, jaw, pose);
    EXPECT_EQ(found.rotation, rotation_xyz_deg({0, 0, 90}));
    EXPECT_EQ((found * side.point).y, 58.0);
    EXPECT_EQ((found * side.point).z, 17.125);
    // Without a rotation only the coordinate along the normal changes.
    const Transform again = face_to_face(side, jaw, found, {.offset = 0.5});
    EXPECT_EQ(again.rotation, found.rotation);
    EXPECT_EQ(again.translation, found.translation - Vec3(0, 0.5, 0));
    // A rotation with rounding is not carried on.
    const Mat3 noisy = rotation_xyz_deg({0, 0, 90}) + Mat3(1e-16);
    EXPECT_EQ(tidied(noisy), rotation_xyz_deg({0, 0, 90}));
}

TEST(CentredBetween, LeavesEqualGaps) {
    std::mt19937 rng(5);
    for (int i = 0; i < 200; ++i) {
        const Mesh mesh = test_support::box_mesh({-1, -2, -3}, {4, 2, 9});
        const Transform pose = random_pose(rng, 50.0);
        const Vec3 d = random_direction(rng);
        const FacePlane a{random_pose(rng, 90.0).translation, d};
        const FacePlane b{random_pose(rng, 90.0).translation, -d};
        const Vec3 shift = centred_between(extent_along(mesh, pose, d), d, a, b);
        EXPECT_LE(glm::length(glm::cross(shift, d)), 1e-12);
        const BodyExtent now = extent_along(mesh, translation(shift) * pose, d);
        EXPECT_NEAR(now.from - glm::dot(a.point, d), glm::dot(b.point, d) - now.to, 1e-9);
    }
}

} // namespace
} // namespace core
