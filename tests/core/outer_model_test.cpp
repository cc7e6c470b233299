#include <gtest/gtest.h>

#include "tests/support/known_body.h"
#include "tests/support/outer_boxes.h"

namespace core {
namespace {

using test_support::KnownBody;
using test_support::TruePart;
using test_support::uniform;

std::vector<std::vector<TruePart>> bodies() {
    using namespace test_support;
    return {{ball_at(Vec3(0.0), 4.0)},
            {box_round(Vec3(0.0), {3.0, 4.0, 2.5})},
            {TrueCylinder{-3.0, 4.0, 2.7}},
            {TrueCapsule{{0, 0, -3}, {0, 0, 2}, 1.9}},
            {TrueTorus{4.0, 1.3}},
            {ball_at({0, 0, 2.0}, 2.0), TrueCylinder{2.0, 6.0, 2.0}},
            {box_round(Vec3(0.0), Vec3(3.0)), box_round({0, 0, 4}, {0.04, 0.04, 3.0})}};
}

double to_nearest(const std::vector<Aabb>& boxes, const Vec3& p) {
    double least = infinity;
    for (const Aabb& box : boxes) least = std::min(least, distance_squared(p, box));
    return std::sqrt(least);
}

test_support::Real to_body(const std::vector<TruePart>& parts, const Vec3& p) {
    test_support::Real least = test_support::real_infinity;
    for (const TruePart& part : parts)
        least = std::min(least, test_support::point_to(part, test_support::RealVec(p)));
    return least;
}

using Axes = std::initializer_list<int>;
const Axes choices_of_axes[] = {{2, 0, 1}, {0, 1, 2}, {1}, {0, 2}};

std::vector<Aabb> boxes(const std::vector<TruePart>& parts, double h, Axes axes) {
    const KnownBody known{parts, h};
    const Dbm lines = test_support::lines_of(known).value();
    return test_support::boxes_of(outer_model(test_support::bounds(parts), lines.grid,
                                              test_support::columns_of(known), axes));
}

TEST(OuterModel, HoldsEveryPointOfTheBody) {
    std::mt19937 rng(3);
    for (const auto& parts : bodies())
        for (const Axes& axes : choices_of_axes) {
            const std::vector<Aabb> cover = boxes(parts, 0.7, axes);
            const Aabb round = test_support::bounds(parts);
            int inside = 0;
            for (int i = 0; i < 3000; ++i) {
                Vec3 p;
                for (int axis = 0; axis < 3; ++axis)
                    p[axis] = uniform(rng, round.min[axis], round.max[axis]);
                if (to_body(parts, p) > 0) continue;
                ++inside;
                EXPECT_EQ(to_nearest(cover, p), 0.0);
            }
            EXPECT_GT(inside, 100);
        }
}

/// The largest distance of a corner of the boxes from the body.
double standing_out(const std::vector<TruePart>& parts, double h) {
    double most = 0.0;
    for (const Aabb& box : boxes(parts, h, {2, 0, 1}))
        for (int i = 0; i < 8; ++i)
            most = std::max(most, double(to_body(parts, {i & 1 ? box.max.x : box.min.x,
                                                         i & 2 ? box.max.y : box.min.y,
                                                         i & 4 ? box.max.z : box.min.z})));
    return most;
}

TEST(OuterModel, ExceedsTheBodyByLessThanTheDiagonalOfACell) {
    for (const auto& parts : bodies())
        for (const double h : {0.7, 0.35})
            EXPECT_LT(standing_out(parts, h), 1.0001 * std::sqrt(3.0) * h);
}

/// Boxes of a floor with two walls, known only from the cuts of flat tools.
TEST(OuterModel, OfACutStockHoldsEveryPointThatWasLeft) {
    std::mt19937 rng(9);
    for (int round = 0; round < 10; ++round) {
        const KnownBody known{test_support::floor_and_walls(rng, 1.0), 1.0};
        const std::vector<Aabb> cover =
            test_support::boxes_of(test_support::outer_model_of(test_support::cut_model_of(known)));
        for (const TruePart& part : known.parts) {
            const Aabb box = test_support::bounds(part);
            for (int i = 0; i < 200; ++i) {
                Vec3 p;
                for (int axis = 0; axis < 3; ++axis)
                    p[axis] = uniform(rng, box.min[axis], box.max[axis]);
                EXPECT_EQ(to_nearest(cover, p), 0.0);
            }
        }
    }
}

} // namespace
} // namespace core
