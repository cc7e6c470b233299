#include <cmath>

#include <gtest/gtest.h>

#include "core/dbm/dbm.h"

namespace core {
namespace {

TEST(Dbm, HasThePointsOfThePapersSphere) {
    // The paper counts 47119, 11780, 5233, 2904; it does not state the position of its grid.
    EXPECT_EQ(point_count(scan(Sphere{25.0}, 0.5).value()), 47160u);
    EXPECT_EQ(point_count(scan(Sphere{25.0}, 1.0).value()), 11856u);
    EXPECT_EQ(point_count(scan(Sphere{25.0}, 1.5).value()), 5232u);
    EXPECT_EQ(point_count(scan(Sphere{25.0}, 2.0).value()), 2904u);
}

TEST(Dbm, HasItsPointsOnTheBody) {
    const Dbm ball = scan(Sphere{10.0}, 0.75).value();
    const std::vector<Vec3> points = boundary_points(ball);
    EXPECT_EQ(points.size(), point_count(ball));
    for (const Vec3& p : points) EXPECT_NEAR(glm::length(p), 10.0, 1e-13);

    for (const Vec3& p : boundary_points(scan(Cylinder{4.0, 7.0}, 0.6).value())) {
        const double r = std::hypot(p.x, p.y);
        EXPECT_TRUE(std::abs(r - 4.0) < 1e-13 || (std::abs(p.z) == 3.5 && r < 4.0));
    }
}

TEST(Dbm, OfABoxHasTwoPointsPerLine) {
    const Dbm box = scan(Box{Vec3(4.0, 6.0, 8.0)}, 1.0).value();
    EXPECT_EQ(line_count(box), 6u * 8u + 8u * 4u + 4u * 6u);
    EXPECT_EQ(point_count(box), 2 * line_count(box));
    EXPECT_EQ(box.families[0].u_count(), 6);
    EXPECT_EQ(box.families[0].v_count(), 8);
    EXPECT_EQ(boundary_points(box).front(), Vec3(-2.0, -2.5, -3.5));
    EXPECT_EQ(boundary_points(box).back(), Vec3(1.5, 2.5, 4.0));
}

TEST(Dbm, TakesAMeshSizeLargerThanTheBodyWhileALineMeetsIt) {
    // One line on either side, half a mesh size from the centre.
    EXPECT_EQ(point_count(scan(Box{Vec3(10.0)}, 9.0).value()), 24u);
    const auto missed = scan(Box{Vec3(10.0)}, 11.0);
    ASSERT_FALSE(missed);
    EXPECT_NE(missed.error().message.find("larger than the body"), std::string::npos);
}

TEST(Dbm, RefusesMeshSizesThatAreNoLength) {
    for (const double bad : {0.0, -0.5, std::nan(""), infinity})
        EXPECT_FALSE(scan(Sphere{5.0}, bad)) << bad;
}

TEST(Dbm, RefusesSizesThatAreNoLength) {
    EXPECT_FALSE(scan(Sphere{0.0}, 0.5));
    EXPECT_FALSE(scan(Sphere{std::nan("")}, 0.5));
    EXPECT_FALSE(scan(Box{Vec3(1.0, -1.0, 1.0)}, 0.5));
    EXPECT_FALSE(scan(Cylinder{1.0, infinity}, 0.5));
}

TEST(Dbm, SaysBeforeItAllocatesWhatAFineMeshWouldTake) {
    for (const double spacing : {1e-6, 1e-9, 1e-300}) {
        const auto refused = scan(Box{Vec3(1000.0)}, spacing);
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().message.find("would do"), std::string::npos);
    }
    const auto refused = scan(Box{Vec3(1000.0)}, 0.01, 1e6);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message,
              "a mesh size of 0.01 mm needs 3e+10 scan lines and 2.01e+03 GiB (the limit is "
              "0.000931 GiB); 16 mm would do");
    EXPECT_TRUE(scan(Box{Vec3(1000.0)}, 16.0, 1e6));
}

} // namespace
} // namespace core
