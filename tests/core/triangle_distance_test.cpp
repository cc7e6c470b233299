#include <random>

#include <gtest/gtest.h>

#include "core/geom/triangle_distance.h"
#include "tests/support/meshes.h"
#include "tests/support/triangle_oracle.h"

namespace core {
namespace {

using test_support::random_pose;

Vec3 random_point(std::mt19937& rng, double reach) {
    std::uniform_real_distribution<double> position(-reach, reach);
    return {position(rng), position(rng), position(rng)};
}

/// Well-shaped triangles, needles, caps, points and lines, in a random position.
Triangle random_triangle(std::mt19937& rng, double reach) {
    std::uniform_real_distribution<double> part(0.0, 1.0);
    const Vec3 a = random_point(rng, 10.0), b = random_point(rng, 10.0);
    const double thin = std::pow(10.0, -1.0 - 13.0 * part(rng));
    Triangle t{a, b, random_point(rng, 10.0)};
    switch (rng() % 6) {
    case 0: // a needle
        t.c = b + thin * random_point(rng, 10.0);
        break;
    case 1: // a cap
        t.c = a + part(rng) * (b - a) + thin * random_point(rng, 10.0);
        break;
    case 2: // no area
        t.c = rng() % 2 ? b : a + part(rng) * (b - a);
        if (rng() % 4 == 0) t.b = t.c = a;
        break;
    default:
        break;
    }
    const Transform pose = random_pose(rng, reach);
    return {pose * t.a, pose * t.b, pose * t.c};
}

/// Triangles that share a corner or a side, touch, intersect, or are in one plane.
Triangle related(const Triangle& t, std::mt19937& rng) {
    const Vec3 inside = 0.2 * t.a + 0.3 * t.b + 0.5 * t.c;
    switch (rng() % 6) {
    case 0:
        return {t.b, t.a, random_point(rng, 10.0)};
    case 1:
        return {random_point(rng, 10.0), t.c, random_point(rng, 10.0)};
    case 2: // intersects
        return {inside + random_point(rng, 1.0), inside - random_point(rng, 1.0), inside};
    case 3: // in the same plane, and inside
        return {inside, 0.1 * t.a + 0.9 * inside, 0.1 * t.b + 0.9 * inside};
    case 4: { // parallel, a little above
        const Vec3 up = 1e-5 * random_point(rng, 1.0);
        return {t.a + up, t.b + up, t.c + up};
    }
    default: // a corner on the face
        return {inside, random_point(rng, 10.0), random_point(rng, 10.0)};
    }
}

Vec3 sample(const Triangle& t, std::mt19937& rng) {
    std::uniform_real_distribution<double> part(0.0, 1.0);
    double u = part(rng), v = part(rng);
    if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
    }
    return t.a + u * (t.b - t.a) + v * (t.c - t.a);
}

/// Samples, each moved alternately towards the other triangle: the distances found exist.
double sampled_distance(const Triangle& a, const Triangle& b, std::mt19937& rng) {
    double least = infinity;
    for (int i = 0; i < 30; ++i) {
        Vec3 on_b = sample(b, rng);
        for (int k = 0; k < 8; ++k) {
            const Vec3 on_a = nearest_point(a, on_b);
            on_b = nearest_point(b, on_a);
            least = std::min(least, glm::distance(on_a, on_b));
        }
    }
    return least;
}

double scale(const Triangle& a, const Triangle& b) {
    Aabb box;
    for (const Vec3& p : {a.a, a.b, a.c, b.a, b.b, b.c}) box.extend(p);
    return std::max(glm::length(box.min), glm::length(box.max));
}

void expect_sound(const Triangle& a, const Triangle& b, std::mt19937& rng) {
    const Separation found = separation(a, b);
    const Separation other = separation(convex(a), convex(b));
    const double rounding = 2e-10 + 1e-14 * scale(a, b);
    EXPECT_LE(found.lower, other.upper + rounding);
    EXPECT_GE(found.upper, other.lower - rounding);
    const auto truth = static_cast<double>(
        test_support::wide_distance(test_support::wide(a), test_support::wide(b)));
    EXPECT_LE(found.lower, truth + rounding);
    EXPECT_GE(found.upper, truth - rounding);
    EXPECT_LE(found.upper - found.lower, 3e-7 + rounding); // 1e-7 but for slivers that nearly touch
    EXPECT_LE(found.lower, sampled_distance(a, b, rng) + rounding);
    EXPECT_NEAR(glm::distance(found.point_a, found.point_b), found.upper, rounding);
    EXPECT_LE(glm::distance(nearest_point(a, found.point_a), found.point_a), rounding);
    EXPECT_LE(glm::distance(nearest_point(b, found.point_b), found.point_b), rounding);
    const Separation turned = separation(b, a);
    EXPECT_NEAR(turned.upper, found.upper, 1e-7 + rounding);
}

TEST(TriangleDistance, AgreesWithTheSearchOfConvexShapes) {
    std::mt19937 rng(71);
    int meeting = 0, near = 0, far = 0;
    for (int i = 0; i < 12000 && !testing::Test::HasFailure(); ++i) {
        const double reach = i % 3 == 0 ? 40.0 : i % 3 == 1 ? 5.0 : 1000.0;
        const Triangle a = random_triangle(rng, reach), b = random_triangle(rng, reach);
        expect_sound(a, b, rng);
        const double d = separation(a, b).upper;
        ++(d == 0.0 ? meeting : d < 5.0 ? near : far);
    }
    EXPECT_GT(meeting, 100);
    EXPECT_GT(near, 300);
    EXPECT_GT(far, 1000);
}

TEST(TriangleDistance, HoldsForTrianglesThatTouchOrNearlyDo) {
    std::mt19937 rng(72);
    int meeting = 0, near = 0;
    for (int i = 0; i < 8000 && !testing::Test::HasFailure(); ++i) {
        const Triangle a = random_triangle(rng, 20.0);
        Triangle b = related(a, rng);
        if (i % 2) {
            const Vec3 off = std::pow(10.0, -(i % 11)) * random_point(rng, 1.0);
            b = {b.a + off, b.b + off, b.c + off};
        }
        expect_sound(a, b, rng);
        ++(separation(a, b).upper == 0.0 ? meeting : near);
    }
    EXPECT_GT(meeting, 1200);
    EXPECT_GT(near, 1200);
}

TEST(TriangleDistance, HoldsFarFromTheOrigin) {
    std::mt19937 rng(74);
    int meeting = 0, near = 0;
    for (int i = 0; i < 4000 && !testing::Test::HasFailure(); ++i) {
        const Vec3 position = random_point(rng, std::pow(10.0, 3 + i % 4));
        const auto put = [&](const Triangle& t) {
            return Triangle{t.a + position, t.b + position, t.c + position};
        };
        const Triangle a = random_triangle(rng, 5.0);
        const Triangle b = i % 2 ? random_triangle(rng, 5.0) : related(a, rng);
        expect_sound(put(a), put(b), rng);
        ++(separation(put(a), put(b)).upper < 1e-8 ? meeting : near);
    }
    EXPECT_GT(meeting, 500);
    EXPECT_GT(near, 500);
}

TEST(TriangleDistance, IsThatWorkedOutByHand) {
    const Triangle floor{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
    const struct {
        Triangle other;
        double distance;
    } cases[] = {
        {{{1, 1, 3}, {2, 1, 4}, {1, 2, 5}}, 3.0},                   // corner above face
        {{{1, 1, -1}, {2, 1, 4}, {1, 2, 5}}, 0.0},                  // through it
        {{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, 0.0},                   // in it
        {{{-3, 0, 4}, {-3, 9, 4}, {-9, 0, 9}}, 5.0},                // side parallel to side
        {{{-3, -4, 12}, {-9, -9, 20}, {-9, -4, 22}}, 13.0},         // corner to corner
        {{{5, -1, 1}, {5, -1, -1}, {5, -9, 0}}, 1.0},               // side across side
        {{{1, 1, 2}, {1, 1, 2}, {1, 1, 2}}, 2.0},                   // a point
        {{{-5, 1, 2}, {15, 1, 2}, {5, 1, 2}}, 2.0},                 // a line
        {{{-50, -50, 0.5}, {150, -50, 0.5}, {-50, 150, 0.5}}, 0.5}, // above all of it
    };
    for (const auto& c : cases) {
        const Separation found = separation(floor, c.other);
        EXPECT_NEAR(found.upper, c.distance, 1e-12);
        EXPECT_NEAR(found.lower, c.distance, 1e-12);
    }
}

TEST(TriangleDistance, EndsEarlyAtTheLimitWithBoundsThatHold) {
    std::mt19937 rng(73);
    for (int i = 0; i < 5000; ++i) {
        const Triangle a = random_triangle(rng, 20.0), b = random_triangle(rng, 20.0);
        const Separation exact = separation(a, b);
        const double limit = exact.upper * (i % 2 ? 0.7 : 1.3);
        const Separation found = separation(a, b, {.limit = limit});
        EXPECT_LE(found.lower, exact.upper + 1e-9);
        EXPECT_GE(found.upper, exact.lower - 1e-9);
        EXPECT_TRUE(found.lower >= limit || found.upper - found.lower <= 1e-7);
    }
}

} // namespace
} // namespace core
