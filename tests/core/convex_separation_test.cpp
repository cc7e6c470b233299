#include <random>

#include <gtest/gtest.h>

#include "core/geom/gjk.h"
#include "tests/support/convex_oracle.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::certainly_outside;
using test_support::random_direction;
using test_support::random_pose;
using test_support::slab_between;

struct Seen {
    int far = 0, near = 0, touching = 0, overlapping = 0, wide = 0;
};

/// Witnesses on the bodies prove `upper` and refute a `lower` above them; a slab between the bodies
/// proves that the witnesses are the nearest points.
void expect_proven(const ConvexShape& a, const ConvexShape& b, std::mt19937& rng, Seen& seen,
                   double tolerance = 1e-6) {
    const Separation found = separation(a, b);
    ASSERT_TRUE(std::isfinite(found.lower) && std::isfinite(found.upper));
    ASSERT_TRUE(is_finite(found.point_a) && is_finite(found.point_b));
    EXPECT_LE(0.0, found.lower);
    EXPECT_LE(found.lower, found.upper);
    EXPECT_NEAR(glm::distance(found.point_a, found.point_b), found.upper, 1e-9);
    EXPECT_LE(certainly_outside(a, found.point_a, rng), 1e-9);
    EXPECT_LE(certainly_outside(b, found.point_b, rng), 1e-9);
    const Separation best = separation(a, b, {.tolerance = 0.0});
    EXPECT_LE(certainly_outside(a, best.point_a, rng), 1e-9);
    EXPECT_LE(certainly_outside(b, best.point_b, rng), 1e-9);
    EXPECT_LE(found.lower, best.upper + 1e-9);
    EXPECT_LE(best.lower, found.upper + 1e-9);
    const double slab = slab_between(a, b, best.point_a - best.point_b, rng);
    EXPECT_LE(slab, best.upper + 1e-9);
    if (best.upper > 1e-2) {
        EXPECT_LE(found.lower, slab + 1e-5);
    }
    EXPECT_LE(found.upper - found.lower, tolerance);
    for (const double limit : {0.5 * found.upper, 0.999 * found.upper, 1.5 * found.upper}) {
        const Separation early = separation(a, b, {.limit = limit});
        EXPECT_LE(early.lower, best.upper + 1e-9);
        EXPECT_GE(early.upper, best.lower - 1e-9);
        EXPECT_TRUE(early.lower >= limit || early.upper - early.lower <= tolerance);
    }
    ++(found.upper == 0.0   ? seen.overlapping
       : found.upper < 1e-6 ? seen.touching
       : found.upper < 5.0  ? seen.near
                            : seen.far);
}

ProfileElement random_element(std::mt19937& rng) {
    std::uniform_real_distribution<double> size(0.0, 8.0);
    switch (rng() % 6) {
    case 0: // cylinder
        return [&](double r, double z) {
            return ProfileElement{z, r, z + size(rng), r, 0.0};
        }(size(rng), size(rng));
    case 1: // pointed downwards
        return {0.0, 0.0, size(rng), size(rng), 0.0};
    case 2: // pointed upwards
        return {0.0, size(rng), size(rng), 0.0, 0.0};
    case 3: // rounded disc
        return [&](double r, double m) {
            return ProfileElement{m, r, m, r, m};
        }(size(rng), 0.2 * size(rng));
    case 4: // ball
        return [&](double r) { return ProfileElement{r, 0.0, r, 0.0, r}; }(size(rng));
    default:
        return {-size(rng), size(rng), size(rng), size(rng), 0.0};
    }
}

ConvexShape random_shape(std::mt19937& rng) {
    std::uniform_real_distribution<double> position(-6.0, 6.0);
    const auto point = [&] { return Vec3(position(rng), position(rng), position(rng)); };
    switch (rng() % 8) {
    case 0:
        return convex_sphere(std::abs(position(rng)));
    case 1: {
        Aabb box;
        box.extend(point());
        box.extend(point());
        return convex(box);
    }
    case 2:
        return convex(Triangle{point(), point(), point()});
    case 3:
        return convex_segment(point(), point());
    default:
        return convex(random_element(rng));
    }
}

/// A body with a random pose, in two of three cases swept over 2 to 9 positions.
ConvexShape random_body(std::mt19937& rng, double reach) {
    ConvexShape shape = posed(random_shape(rng), random_pose(rng, reach));
    if (rng() % 4 == 0) shape = posed(random_shape(rng), translation(shape.positions[0].at));
    if (rng() % 3 == 0) return shape;
    std::uniform_real_distribution<double> step(-10.0, 10.0);
    std::vector<Vec3> positions(2 + rng() % 8, Vec3(0.0));
    for (size_t i = 1; i < positions.size(); ++i) positions[i] = {step(rng), step(rng), step(rng)};
    return swept(shape, positions);
}

TEST(ConvexSeparation, IsProvenByItsWitnessesAndByASlabBetweenTheBodies) {
    std::mt19937 rng(11);
    Seen seen;
    for (int i = 0; i < 1200; ++i) {
        const double reach = i % 3 == 0 ? 5.0 : i % 3 == 1 ? 15.0 : 40.0;
        const ConvexShape a = random_body(rng, reach), b = random_body(rng, reach);
        SCOPED_TRACE(i);
        expect_proven(a, b, rng, seen);
        if (HasFatalFailure() || ::testing::Test::HasFailure()) return;
    }
    EXPECT_GT(seen.far, 200);
    EXPECT_GT(seen.near, 100);
    EXPECT_GT(seen.overlapping, 200);
}

TEST(ConvexSeparation, HoldsForBodiesThatTouch) {
    std::mt19937 rng(12);
    Seen seen;
    for (int i = 0; i < 600; ++i) {
        const ConvexShape a = random_body(rng, 20.0), b = random_body(rng, 20.0);
        const Separation apart = separation(a, b);
        if (apart.upper == 0.0) continue;
        ConvexShape touching = b; // moved to contact, or to a small gap or overlap
        const double by[] = {0.0, 1e-12, -1e-12, 1e-8, -1e-8, 1e-4, -1e-4};
        const Vec3 towards = (apart.point_a - apart.point_b) / apart.upper;
        for (size_t k = 0; k < touching.position_count; ++k)
            touching.positions[k].at += (apart.upper - by[i % 7]) * towards;
        SCOPED_TRACE(i);
        expect_proven(a, touching, rng, seen);
        if (HasFailure()) return;
    }
    EXPECT_GT(seen.touching, 100);
    EXPECT_GT(seen.overlapping, 50);
    EXPECT_GT(seen.near, 50);
}

Vec3 farthest(const ConvexShape& shape, const Vec3& n) {
    return support(shape, n).point + shape.margin * n;
}

/// Where a curved rim touches a face or another rim, the computed gap is only rounding.
TEST(ConvexSeparation, ClosesWhereRimsTouch) {
    std::mt19937 rng(4);
    std::uniform_real_distribution<double> size(0.01, 3.0);
    int open = 0;
    double widest = 0.0;
    for (int i = 0; i < 6000; ++i) {
        const double r = size(rng), h = size(rng);
        const ConvexShape rod = convex(ProfileElement{-h, r, h, r, 0.0});
        const Vec3 half(size(rng), size(rng), 0.3 * size(rng));
        const ConvexShape other = i % 2 == 0 ? convex(Aabb{-half, half}) : rod;
        const Mat3 turn = i % 5 == 0
                              ? rotation_xyz_deg(90.0 * Vec3(rng() % 4, rng() % 4, rng() % 4))
                              : random_pose(rng, 1.0).rotation;
        const Vec3 n = i % 3 == 0 ? Vec3(0.0, 0.0, 1.0) : random_direction(rng);
        const Vec3 at = farthest(other, n) - farthest(posed(rod, {turn, Vec3(0.0)}), -n);
        const Separation found = separation(other, posed(rod, {turn, at}));
        EXPECT_LE(found.lower, 1e-12);
        EXPECT_NEAR(glm::distance(found.point_a, found.point_b), found.upper, 1e-9);
        open += found.upper > 1e-7;
        widest = std::max(widest, found.upper);
    }
    EXPECT_LE(open, 4);
    EXPECT_LT(widest, 1e-6);
}

TEST(ConvexSeparation, HoldsFarFromTheOrigin) {
    std::mt19937 rng(13);
    Seen seen;
    for (int i = 0; i < 400; ++i) {
        const Vec3 there = 2000.0 * random_direction(rng);
        const ConvexShape a = posed(random_shape(rng), translation(there));
        const ConvexShape b = posed(random_shape(rng), random_pose(rng, i % 2 ? 2000.0 : 0.01));
        ConvexShape moved = b;
        if (i % 2 == 0) moved.positions[0].at += there + 12.0 * random_direction(rng);
        SCOPED_TRACE(i);
        expect_proven(a, moved, rng, seen);
        if (HasFailure()) return;
    }
    EXPECT_GT(seen.far, 100);
    EXPECT_GT(seen.near, 30);
}

TEST(ConvexSeparation, OfSliversAndNeedlesAndPointsIsProven) {
    std::mt19937 rng(14);
    Seen seen;
    std::uniform_real_distribution<double> position(-6.0, 6.0);
    const auto point = [&] { return Vec3(position(rng), position(rng), position(rng)); };
    const auto thin = [&](int kind) {
        const Vec3 a = point(), b = point();
        const double by = std::pow(10.0, -3.0 - rng() % 12);
        switch (kind) {
        case 0: // a needle
            return convex(Triangle{a, b, b + by * random_direction(rng)});
        case 1: // a cap: the third corner is close to the middle of the opposite side
            return convex(Triangle{a, b, 0.5 * (a + b) + by * random_direction(rng)});
        case 2: // no area
            return convex(Triangle{a, b, a + 0.3 * (b - a)});
        case 3:
            return convex(Triangle{a, a, a});
        case 4:
            return convex_segment(a, a);
        case 5:
            return convex(Aabb{a, a + Vec3(10.0, by, by)});
        default:
            return convex(ProfileElement{a.z, 5.0, a.z + by, 5.0 - by, 0.0});
        }
    };
    for (int i = 0; i < 1400; ++i) {
        const ConvexShape a = thin(i % 7);
        const ConvexShape b = i % 2 ? thin(static_cast<int>(rng() % 7)) : random_body(rng, 5.0);
        const Vec3 rest[] = {Vec3(0.0), Vec3(0.0)};
        SCOPED_TRACE(i);
        expect_proven(i % 5 ? a : swept(a, rest), b, rng, seen);
        if (HasFailure()) return;
    }
    EXPECT_GT(seen.near, 300);
}

TEST(ConvexSeparation, IsNoOverlapForFacesThatLeanByALittle) {
    // Long thin tetrahedra far from the origin: their volume says nothing about their extent.
    std::mt19937 rng(15);
    Seen seen;
    for (int i = 0; i < 800; ++i) {
        const double lean = std::pow(10.0, -13.0 + 0.01 * i), gap = i % 2 ? 2000.0 : 100.0;
        const ConvexShape a = convex(Aabb{Vec3(-1.0), Vec3(1.0)});
        ConvexShape b =
            posed(a, {rotation_xyz_deg({lean * 57.3, lean * 31.0, 0.37 * i}), Vec3(0.1, 0.2, gap)});
        SCOPED_TRACE(lean);
        expect_proven(a, b, rng, seen);
        if (HasFailure()) return;
    }
    EXPECT_EQ(seen.far, 800);
}

TEST(ConvexSeparation, IsThatOfTheClosedForms) {
    const auto cylinder = [](double r, double z0, double z1) {
        return convex(ProfileElement{z0, r, z1, r, 0.0});
    };
    const auto at = [](const ConvexShape& s, const Vec3& p) { return posed(s, translation(p)); };
    const Vec3 along[] = {Vec3(-50, 0, 0), Vec3(50, 0, 0)};
    const struct {
        ConvexShape a, b;
        double distance;
    } cases[] = {
        {convex_sphere(25), at(convex_sphere(25), {55, 0, 0}), 5.0},
        {convex(Aabb{Vec3(0), Vec3(1)}), convex(Aabb{{4, 5, 1}, {6, 6, 2}}), 5.0},
        {cylinder(10, 0, 5), at(cylinder(3, 0, 5), {20, 0, 0}), 7.0},
        {cylinder(10, 0, 5), at(cylinder(3, 9, 11), {2, 0, 0}), 4.0},
        {convex(ProfileElement{0, 0, 5, 5, 0}), at(convex_sphere(1), {5, 0, 0}),
         std::sqrt(12.5) - 1.0},
        {convex(ProfileElement{2, 8, 2, 8, 2}), at(convex_sphere(1), {8 + 6, 0, 10}), 7.0},
        {swept(convex_sphere(2), along), at(convex_sphere(3), {7, 8, 15}), 12.0},
        {cylinder(5, 0, 10), at(convex_sphere(1), {0, 0, 5}), 0.0}, // nested
        {cylinder(5, 0, 10), convex(Aabb{{-9, -9, 10}, {9, 9, 20}}), 0.0},
    };
    for (const auto& c : cases) {
        for (const bool turned : {false, true}) {
            const Separation found = turned ? separation(c.b, c.a) : separation(c.a, c.b);
            EXPECT_NEAR(found.upper, c.distance, 2e-7);
            EXPECT_NEAR(found.lower, c.distance, 2e-7);
            EXPECT_LE(found.lower, c.distance + 1e-9);
            EXPECT_GE(found.upper, c.distance - 1e-9);
        }
    }
}

TEST(ConvexSeparation, SaysWhenInTheSweepTheWitnessIs) {
    std::mt19937 rng(16);
    int checked = 0;
    for (int i = 0; i < 300; ++i) {
        const ConvexShape still = posed(random_shape(rng), random_pose(rng, 10.0));
        const Vec3 move = 20.0 * random_direction(rng);
        const Vec3 positions[] = {Vec3(0.0), move};
        const ConvexShape b = posed(random_shape(rng), random_pose(rng, 20.0));
        const Separation found = separation(swept(still, positions), b);
        ASSERT_GE(found.time_a, 0.0);
        ASSERT_LE(found.time_a, 1.0 + 1e-12);
        if (found.upper > 0.0) ++checked;
        const ConvexShape then = posed(still, translation(found.time_a * move));
        EXPECT_LE(certainly_outside(then, found.point_a, rng), 1e-9) << i;
    }
    EXPECT_GT(checked, 100);
}

TEST(ConvexBounds, HoldTheShapeAndTouchIt) {
    std::mt19937 rng(17);
    for (int i = 0; i < 300; ++i) {
        const ConvexShape shape = random_body(rng, 100.0);
        const Aabb box = bounds(shape);
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 n(0.0);
            n[axis] = 1.0;
            EXPECT_NEAR(box.max[axis], test_support::reach(shape, n), 1e-9);
            EXPECT_NEAR(box.min[axis], -test_support::reach(shape, -n), 1e-9);
        }
    }
}

} // namespace
} // namespace core
