#include <random>

#include <gtest/gtest.h>

#include "core/distance/shape_outline.h"

namespace core {
namespace {

/// Half of its numbers are on a lattice, so that faces, rims and edges are often in one plane.
class Dice {
public:
    double length(double most) {
        const double any = std::uniform_real_distribution<double>(0.0, most)(rng_);
        return rng_() % 2 ? any : std::round(2.0 * any) / 2.0;
    }
    double position(double most) { return length(2.0 * most) - most; }
    bool chance(unsigned one_in) { return rng_() % one_in == 0; }

    UprightSweep sweep() {
        UprightSweep s;
        s.element.z0 = position(2.0);
        s.element.z1 = s.element.z0 + (chance(5) ? 0.0 : length(4.0));
        s.element.r0 = length(2.0);
        s.element.r1 = chance(2) ? s.element.r0 : length(2.0);
        if (chance(6)) s.element.r0 = 0.0;
        if (chance(3)) s.element.margin = length(1.0);
        s.from = {position(6.0), position(6.0), position(6.0)};
        for (int axis = 0; axis < 3; ++axis)
            if (chance(2)) s.by[axis] = position(5.0);
        return s;
    }
    Aabb box() {
        Aabb b;
        b.min = {position(2.0), position(2.0), position(2.0)};
        b.max = b.min;
        for (int axis = 0; axis < 3; ++axis)
            if (!chance(3)) b.max[axis] += length(4.0);
        return b;
    }

private:
    std::mt19937 rng_{20'261};
};

ConvexShape shape_of(const UprightSweep& sweep) {
    const Vec3 positions[] = {sweep.from, sweep.from + sweep.by};
    return swept(convex(sweep.element), positions);
}

/// The distance of a point from a piece at rest, from its definition.
double outside(const ProfileElement& element, const Vec3& p) {
    const double r = std::hypot(p.x, p.y);
    double least = infinity;
    constexpr int steps = 2000;
    for (int i = 0; i <= steps; ++i) {
        const double fraction = double(i) / steps;
        const double z = element.z0 + fraction * (element.z1 - element.z0);
        const double wide = element.r0 + fraction * (element.r1 - element.r0);
        const double inner = element.z0 == element.z1 ? std::max(element.r0, element.r1) : wide;
        least = std::min(least, std::hypot(std::max(0.0, r - inner), p.z - z));
    }
    return std::max(0.0, least - element.margin);
}

TEST(UprightSweep, IsAsFarFromABoxAsTheGeneralSearchSays) {
    Dice dice;
    for (int i = 0; i < 200'000; ++i) {
        const UprightSweep sweep = dice.sweep();
        const Aabb box = dice.box();
        const Separation found = separation(sweep, box, {.tolerance = 1e-9});
        const Separation truth = separation(shape_of(sweep), convex(box), {.tolerance = 1e-9});
        ASSERT_LE(found.lower, truth.upper + 1e-8) << i;
        ASSERT_GE(found.upper, truth.lower - 1e-8) << i;
        ASSERT_LE(found.lower, found.upper) << i;
        ASSERT_LE(found.upper - found.lower, 1e-8) << i;
    }
}

TEST(UprightSweep, GivesPointsOfThePieceAndTheBox) {
    Dice dice;
    for (int i = 0; i < 3'000; ++i) {
        const UprightSweep sweep = dice.sweep();
        const Aabb box = dice.box();
        const Separation found = separation(sweep, box);
        ASSERT_NEAR(glm::length(found.point_a - found.point_b), found.upper, 1e-9) << i;
        ASSERT_LE(distance_squared(found.point_b, box), 1e-18) << i;
        const Vec3 here = sweep.from + found.time_a * sweep.by;
        ASSERT_LE(outside(sweep.element, found.point_a - here), 2e-3) << i;
    }
}

TEST(UprightSweep, StaysBelowTheDistanceWhereALimitEndsTheSearch) {
    Dice dice;
    for (int i = 0; i < 100'000; ++i) {
        const UprightSweep sweep = dice.sweep();
        const Aabb box = dice.box();
        const double limit = dice.length(6.0);
        const double distance = separation(sweep, box, {.tolerance = 1e-9}).upper;
        const double bound = distance_bound(sweep, box, limit);
        ASSERT_LE(bound, distance + 1e-9) << i;
        ASSERT_GE(bound, std::min(limit, distance) - 2e-7) << i;
    }
}

TEST(UprightSweep, FindsTheMomentOnASlope) {
    // A cylinder that moves up past an edge: 5 - 8 t next to it and 1 + 6 t above it.
    const UprightSweep sweep{{.z0 = 0, .r0 = 1, .z1 = 5, .r1 = 1}, {-6, 0, 2}, {8, 0, 6}};
    const Separation found = separation(sweep, {{0, -1, 0}, {1, 1, 1}}, {.tolerance = 1e-12});
    EXPECT_NEAR(found.upper, 3.8, 1e-9);
    EXPECT_NEAR(found.lower, 3.8, 1e-9);
    EXPECT_NEAR(found.time_a, 0.34, 1e-6);
    EXPECT_NEAR(found.point_b.x, 0.0, 1e-12);
    EXPECT_NEAR(found.point_b.z, 1.0, 1e-12);
    EXPECT_NEAR(found.point_a.z, 4.04, 1e-5);
}

/// A box as a convex shape; a point or a line as a segment.
ConvexShape shape_of(const Aabb& box) {
    const Vec3 size = box.size();
    const int flat = int(size.x == 0.0) + int(size.y == 0.0) + int(size.z == 0.0);
    return flat >= 2 ? convex_segment(box.min, box.max) : convex(box);
}

/// A piece, tilted or not, on a path with corners.
ConvexShape on_a_bent_path(Dice& dice) {
    ConvexShape piece = convex(dice.sweep().element);
    if (dice.chance(3)) {
        const double by = dice.position(1.5);
        const Mat3 tilt(Vec3(std::cos(by), 0.0, std::sin(by)), Vec3(0.0, 1.0, 0.0),
                        Vec3(-std::sin(by), 0.0, std::cos(by)));
        piece = posed(piece, Transform(tilt, Vec3(0.0)));
    }
    std::vector<Vec3> path;
    for (int i = dice.chance(2) ? 3 : 4; i > 0; --i)
        path.emplace_back(dice.position(6.0), dice.position(6.0), dice.position(6.0));
    if (dice.chance(5)) path[1] = path[0];
    if (dice.chance(5)) path[2] = 2.0 * path[1] - path[0];
    return swept(piece, path);
}

TEST(ShapeOutline, OfABentPathIsNoFartherFromABoxThanTheShape) {
    Dice dice;
    int sharper = 0, near_contact = 0;
    for (int i = 0; i < 50'000; ++i) {
        const ConvexShape shape = on_a_bent_path(dice);
        const Aabb box = dice.box();
        const ShapeOutline around = outline(shape);
        const double bound = distance_bound(around, box, infinity);
        const Separation found = separation(shape, shape_of(box));
        ASSERT_LE(bound, found.upper + 1e-9) << i;
        sharper += bound > distance(around.box, box) + 0.01;
        near_contact += bound > 0.0 && bound > found.upper - 1e-3;
        ASSERT_LT(distance_bound(around, box, 0.5 * found.upper), found.upper + 1e-9) << i;
    }
    EXPECT_GE(sharper, 15'000);
    EXPECT_GE(near_contact, 1'000);
}

/// A turn about a random direction, often about an axis of the frame by a multiple of 15 degrees.
Mat3 random_turn(Dice& dice) {
    const Vec3 angles(dice.position(180.0), dice.position(180.0), dice.position(180.0));
    if (!dice.chance(3)) return rotation_xyz_deg(angles);
    Vec3 one(0.0);
    one[static_cast<int>(dice.length(2.4))] = 15.0 * std::round(angles.x / 15.0);
    return rotation_xyz_deg(one);
}

/// A tilted piece of revolution, a ball, the sweep of one along a segment, or a box, at rest or on
/// a straight way.
ConvexShape tilted(Dice& dice) {
    const UprightSweep s = dice.sweep();
    ConvexShape piece = convex(s.element);
    if (dice.chance(6)) piece = convex(dice.box());
    if (dice.chance(6)) piece = convex_sphere(dice.length(2.0));
    piece = posed(piece, Transform(random_turn(dice), Vec3(0.0)));
    const Vec3 by = dice.chance(4) ? 20.0 * s.by : s.by;
    return swept(piece, std::vector<Vec3>{s.from, s.from + by});
}

TEST(ShapeOutline, OfATiltedPieceIsNoFartherFromABoxThanThePiece) {
    Dice dice;
    int apart = 0, close = 0, loose = 0;
    for (int i = 0; i < 100'000; ++i) {
        const ConvexShape shape = tilted(dice);
        Aabb box = dice.box();
        if (dice.chance(3)) box.max.z = box.min.z + 50.0; // a column
        const ShapeOutline around = outline(shape);
        const double bound = distance_bound(around, box, infinity);
        const Separation found = separation(shape, shape_of(box));
        ASSERT_LE(bound, found.upper + 1e-9) << i;
        ASSERT_LT(distance_bound(around, box, 0.5 * found.upper), found.upper + 1e-9) << i;
        if (!around.tilted || found.upper <= 0.0) continue;
        ++apart;
        close += bound >= 0.95 * found.upper;
        loose += bound < 0.5 * found.upper;
    }
    EXPECT_GE(apart, 30'000);
    EXPECT_GE(close, apart * 9 / 10) << "so good that the exact distance is seldom asked for";
    EXPECT_LE(loose, apart / 20);
}

TEST(ShapeOutline, OfATiltedPrismIsCutByItsFaces) {
    // A bar along the diagonal of X and Y: its own box is far larger.
    const ConvexShape bar = posed(convex(Aabb{{-20, -1, -1}, {20, 1, 1}}),
                                  Transform(rotation_xyz_deg({0, 0, 45}), Vec3(0.0)));
    const ShapeOutline around = outline(swept(bar, std::vector<Vec3>{Vec3(0.0), Vec3(0, 0, 1)}));
    const double bound = distance_bound(around, {{10, -10, 0}, {10, -10, 0}}, infinity);
    EXPECT_NEAR(bound, std::sqrt(200.0) - 1.0, 1e-9);
}

TEST(Separation, EndsOnceItIsBelowWhatIsEnough) {
    Dice dice;
    int loose = 0;
    for (int i = 0; i < 20'000; ++i) {
        const ConvexShape shape = on_a_bent_path(dice), box = shape_of(dice.box());
        const double enough = dice.length(4.0);
        const Separation whole = separation(shape, box);
        const Separation early = separation(shape, box, {.enough = enough});
        ASSERT_LE(early.lower, whole.upper + 1e-9) << i;
        ASSERT_GE(early.upper, whole.lower - 1e-9) << i;
        const bool is_close = std::abs(whole.upper - enough) <= 1e-6;
        ASSERT_TRUE(is_close || (early.upper < enough) == (whole.upper < enough)) << i;
        ASSERT_TRUE(early.upper < enough || early.upper == whole.upper) << i;
        loose += early.upper > whole.upper + 1e-3;
    }
    EXPECT_GE(loose, 500);
}

} // namespace
} // namespace core
