#include <random>

#include <gtest/gtest.h>

#include "core/geom/gjk.h"
#include "core/geom/triangle_bvh.h"
#include "tests/support/meshes.h"
#include "tests/support/triangle_oracle.h"

namespace core {
namespace {

using test_support::random_pose;
using test_support::Wide;

/// Sets of triangles that are flat, thin, on one line, in one point, or none of these.
std::vector<Triangle> random_heap(std::mt19937& rng, double offset) {
    std::uniform_real_distribution<double> position(-1.0, 1.0), power(-14.0, 1.0);
    const Vec3 size(std::pow(10.0, power(rng)), std::pow(10.0, power(rng)),
                    rng() % 3 ? std::pow(10.0, power(rng)) : 0.0);
    const Transform pose = random_pose(rng, offset);
    std::vector<Triangle> heap;
    for (size_t i = 0, count = 1 + rng() % 5; i < count; ++i) {
        Vec3 corners[3];
        for (Vec3& p : corners)
            p = pose * (size * Vec3(position(rng), position(rng), position(rng)));
        if (rng() % 5 == 0) corners[2] = corners[1];
        if (rng() % 9 == 0) corners[1] = corners[0];
        heap.push_back({corners[0], corners[1], corners[2]});
    }
    return heap;
}

/// The distance of a point from the box, computed with eleven more bits.
long double outside(const OrientedBox& box, const Vec3& p) {
    const glm::tmat3x3<long double> axes(box.axes);
    const Wide local = glm::inverse(axes) * (Wide(p) - Wide(box.center));
    long double most = 0;
    for (int i = 0; i < 3; ++i) most = std::max(most, std::abs(local[i]) - Wide(box.half)[i]);
    return most;
}

TEST(OrientedBox, HoldsEveryCornerRoundingIncluded) {
    std::mt19937 rng(81);
    int turned = 0;
    for (int i = 0; i < 20000 && !testing::Test::HasFailure(); ++i) {
        const std::vector<Triangle> heap = random_heap(rng, std::pow(10.0, i % 7));
        const OrientedBox box = fitted_box(heap);
        EXPECT_LE(lean(box.axes), box_lean);
        for (const Triangle& t : heap)
            for (const Vec3& p : {t.a, t.b, t.c}) EXPECT_EQ(outside(box, p), 0.0L);
        turned += box.axes != Mat3(1.0);
    }
    EXPECT_GT(turned, 10000);
}

TEST(OrientedBox, FitsAFlatFaceAtAnyAngle) {
    std::mt19937 rng(82);
    for (int i = 0; i < 200; ++i) {
        const Transform pose = random_pose(rng, 100.0);
        const Vec3 p[] = {pose * Vec3(0), pose * Vec3(30, 0, 0), pose * Vec3(30, 5, 0),
                          pose * Vec3(0, 5, 0)};
        const OrientedBox box =
            fitted_box(std::vector<Triangle>{{p[0], p[1], p[2]}, {p[0], p[2], p[3]}});
        std::array<double, 3> half = {box.half.x, box.half.y, box.half.z};
        std::sort(half.begin(), half.end());
        EXPECT_NEAR(half[0], 0.0, 1e-10);
        EXPECT_NEAR(half[1], 2.5, 1e-10);
        EXPECT_NEAR(half[2], 15.0, 1e-10);
    }
}

OrientedBox random_box(std::mt19937& rng, double offset) {
    std::uniform_real_distribution<double> size(0.0, 8.0);
    const Transform pose = random_pose(rng, offset);
    return {pose.translation, pose.rotation, {size(rng), size(rng), rng() % 3 ? size(rng) : 0.0}};
}

ConvexShape hull(const OrientedBox& box) {
    return posed(convex(Aabb{-box.half, box.half}), {box.axes, box.center});
}

TEST(DistanceBound, IsNeverMoreThanTheDistance) {
    std::mt19937 rng(83);
    int near = 0, far = 0, tight = 0;
    for (int i = 0; i < 20000; ++i) {
        const OrientedBox a = random_box(rng, 15.0), b = random_box(rng, 15.0);
        const Vec3 sweep = i % 2 ? random_pose(rng, 10.0).translation : Vec3(0.0);
        const Vec3 positions[] = {Vec3(0.0), sweep};
        const double truth = separation(swept(hull(b), positions), hull(a)).upper;
        const double bound = distance_bound(a, b, sweep);
        EXPECT_LE(bound, truth + 1e-10);
        EXPECT_GE(bound, 0.0);
        if (truth > 0.0) ++(truth < 5.0 ? near : far);
        tight += truth > 0.0 && bound > 0.8 * truth;
    }
    EXPECT_GT(near, 1000);
    EXPECT_GT(far, 1000);
    EXPECT_GT(tight, (near + far) / 2);
}

TEST(DistanceBound, IsExactWhereFacesAreParallel) {
    std::mt19937 rng(84);
    for (int i = 0; i < 200; ++i) {
        const Transform pose = random_pose(rng, 50.0);
        const auto box_at = [&](const Vec3& center, const Vec3& half) {
            return moved(OrientedBox{center, Mat3(1.0), half}, pose);
        };
        const OrientedBox a = box_at({0, 0, 0}, {50, 40, 1});
        EXPECT_NEAR(distance_bound(a, box_at({3, 4, 7}, {30, 10, 2}), Vec3(0)), 4.0, 1e-12);
        EXPECT_NEAR(distance_bound(a, box_at({54, 44, 0}, {1, 1, 1}), Vec3(0)), std::sqrt(18.0),
                    1e-12);
        const Vec3 down = pose.rotation * Vec3(0, 0, -3), up = pose.rotation * Vec3(0, 0, 9);
        EXPECT_NEAR(distance_bound(a, box_at({3, 4, 7}, {30, 10, 2}), down), 1.0, 1e-12);
        EXPECT_NEAR(distance_bound(a, box_at({3, 4, 7}, {30, 10, 2}), up), 4.0, 1e-12);
    }
}

} // namespace
} // namespace core
