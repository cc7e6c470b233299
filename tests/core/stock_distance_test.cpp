#include <random>

#include <gtest/gtest.h>

#include "core/distance/stock_distance.h"
#include "tests/support/convex_oracle.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::certainly_outside;
using test_support::CutBox;
using test_support::random_cut_box;
using test_support::random_point;

using Shapes = std::vector<ConvexShape>;

ProfileElement cylinder(double r, double z0, double z1) { return {z0, r, z1, r, 0.0}; }

/// A shank and a holder, a ball, a rotated box or a triangle, at rest, moved straight or within the
/// region of a corner.
Shapes random_tool(std::mt19937& rng, const Aabb& near) {
    const Vec3 at = random_point(near, rng);
    std::vector<Vec3> positions = {Vec3(0.0), rng() % 3 ? Vec3(0.0) : random_point(near, rng) - at};
    if (rng() % 4 == 0) positions.push_back(random_point(near, rng) - at);
    Shapes shapes;
    switch (rng() % 4) {
    case 0:
        shapes = {convex(cylinder(0.8, 0, 4)), convex(ProfileElement{4, 1.5, 6, 2.5, 0})};
        break;
    case 1:
        shapes = {convex_sphere(0.5)};
        break;
    case 2:
        shapes = {posed(convex(Aabb{{-1, -0.5, -0.2}, {1, 0.5, 0.2}}),
                        {rotation_xyz_deg({30, 40, 50}), Vec3(0.0)})};
        break;
    default:
        shapes = {convex(Triangle{{0, 0, 0}, {1, 2, 0}, {0, 0, 1.5}})};
    }
    for (ConvexShape& shape : shapes) shape = swept(posed(shape, translation(at)), positions);
    return shapes;
}

double distance_to(const Shapes& shapes, const Vec3& p) {
    double least = infinity;
    for (const ConvexShape& shape : shapes)
        least = std::min(least, separation(shape, convex_segment(p, p)).upper);
    return least;
}

/// Random points of the remaining stock, many of them near cut faces and near `round`.
std::vector<Vec3> stock_points(const CutBox& world, const Vec3& round, std::mt19937& rng) {
    std::normal_distribution<double> away(0.0, 0.3);
    std::vector<Vec3> points;
    for (int i = 0; i < 700; ++i) {
        const Vec3 p =
            i % 2 ? random_point(world.box, rng) : round + Vec3(away(rng), away(rng), away(rng));
        if (distance_squared(p, world.box) == 0.0 && world.outside_cuts(p) > 0.0)
            points.push_back(p);
    }
    return points;
}

struct Seen {
    int far = 0, near = 0, overlapping = 0, clear = 0, violated = 0, undecided = 0;
};

/// Any point of the stock refutes a `lower` above its distance; the witness proves `upper`.
void expect_sound(const CutBox& world, const Shapes& shapes, const StockSeparation& result,
                  const StockGoal& goal, std::mt19937& rng, Seen& seen) {
    const Separation& found = result.separation;
    ASSERT_TRUE(found.lower >= 0.0 && found.lower <= found.upper && found.lower <= goal.limit);
    const Vec3 round = found.found() ? found.point_b : bounds(shapes[0]).center();
    double sampled = infinity;
    for (const Vec3& p : stock_points(world, round, rng))
        sampled = std::min(sampled, distance_to(shapes, p));
    EXPECT_LE(found.lower, sampled + 1e-9);
    ++(!found.found() ? seen.far : found.upper > 0.0 ? seen.near : seen.overlapping);
    ++(found.lower >= goal.threshold  ? seen.clear
       : found.upper < goal.threshold ? seen.violated
                                      : seen.undecided);
    if (!found.found()) return;
    double outside = infinity;
    for (const ConvexShape& shape : shapes)
        outside = std::min(outside, certainly_outside(shape, found.point_a, rng));
    EXPECT_LE(outside, 1e-9);
    EXPECT_LE(distance_squared(found.point_b, world.box), 1e-18);
    EXPECT_GE(world.outside_cuts(found.point_b), -1e-7);
    EXPECT_NEAR(glm::distance(found.point_a, found.point_b), found.upper, 1e-9);
}

/// The distance to the boxes of all columns: `lower` without refinement.
double to_columns(const Shapes& shapes, const CutModel& model) {
    double least = infinity;
    for (int j = 0; j < model.columns.v_count(); ++j)
        for (int i = 0; i < model.columns.u_count(); ++i) {
            const Square s = cell_square(model, i, j);
            for (const Interval& z : model.columns.line(i, j))
                for (const ConvexShape& shape : shapes) {
                    const Aabb box{{s.x0, s.y0, z.lower}, {s.x1, s.y1, z.upper}};
                    least = std::min(least, separation(shape, convex(box)).upper);
                }
        }
    return least;
}

/// The distance to the material on all lines: `upper` without refinement.
double to_lines(const Shapes& shapes, const CutModel& model) {
    double least = infinity;
    for (int axis = 0; axis < 3; ++axis) {
        const ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
        for (int v = 0; v < family.v_count(); ++v)
            for (int u = 0; u < family.u_count(); ++u)
                for (const Interval& i : family.line(u, v))
                    for (const ConvexShape& shape : shapes) {
                        const ScanGrid& grid = model.lines.grid;
                        const ConvexShape matter =
                            convex_segment(point_on_line(grid, axis, u, v, i.lower),
                                           point_on_line(grid, axis, u, v, i.upper));
                        least = std::min(least, separation(shape, matter).upper);
                    }
    }
    return least;
}

/// Tools up to `margin` beside randomly cut boxes.
struct ToolsAround {
    int boxes = 0, tools = 0; // of each box
    double margin = 0.0;
};

/// Calls `act(model, shapes, k)` for each tool, number k of its box. Ends at the first failure.
template <typename Act>
void for_tools(std::mt19937& rng, const ToolsAround& around, const Act& act) {
    for (int i = 0; i < around.boxes; ++i) {
        const CutBox world = random_cut_box(rng, i % 12, 0.0);
        const CutModel model = world.model(i % 2 ? 0.7 : 0.35); // one tile, or several
        for (int k = 0; k < around.tools; ++k) {
            act(model, random_tool(rng, world.box.grown(around.margin)), k);
            ASSERT_FALSE(testing::Test::HasFailure()) << i << ' ' << k;
        }
    }
}

TEST(StockDistance, IsThatOfTheNearestColumnAndTheNearestLine) {
    std::mt19937 rng(74);
    int near = 0;
    for_tools(rng, {40, 3, 4.0}, [&](const CutModel& model, const Shapes& shapes, int) {
        const Separation found = separation(shapes, model).separation;
        const double columns = to_columns(shapes, model), lines = to_lines(shapes, model);
        EXPECT_NEAR(found.lower, std::min(columns, 50.0), 1e-6);
        EXPECT_NEAR(std::min(found.upper, 50.0), std::min(lines, 50.0), 1e-6);
        near += lines > 0.0 && lines < 50.0;
    });
    EXPECT_GT(near, 20);
}

TEST(StockDistance, IsNoWiderThanItMayBeWhereLinesAlongZAreEnough) {
    std::mt19937 rng(77);
    int wider = 0, exact = 0;
    for_tools(rng, {60, 6, 8.0}, [&](const CutModel& model, const Shapes& shapes, int k) {
        const Separation truth = separation(shapes, model).separation;
        const double within = k % 2 ? 0.0 : truth.lower + 0.2;
        const Separation found = separation(shapes, model, {.exact_within = within}).separation;
        const Separation upper =
            separation(
                shapes, model,
                {.bound = StockBound::upper, .known_lower = truth.lower, .exact_within = within})
                .separation;
        ASSERT_NEAR(found.lower, truth.lower, 1e-6);
        if (!truth.found()) return;
        const double allowed = std::min(0.5 * model.lines.grid.spacing, 0.125 * truth.lower);
        for (const double coarse : {found.upper, upper.upper}) {
            ASSERT_GE(coarse, truth.upper - 1e-6);
            if (truth.lower <= within || truth.upper - truth.lower > allowed) {
                ASSERT_NEAR(coarse, truth.upper, 1e-6);
                ++exact;
            } else {
                ASSERT_LE(coarse, truth.lower + allowed + 1e-6);
                wider += coarse > truth.upper + 1e-3;
            }
        }
    });
    EXPECT_GT(wider, 10);
    EXPECT_GT(exact, 200);
}

TEST(StockDistance, MayBeZeroBelowALowerBoundThatIsNotNeeded) {
    std::mt19937 rng(78);
    int near = 0, far = 0;
    for_tools(rng, {40, 6, 4.0}, [&](const CutModel& model, const Shapes& shapes, int) {
        const double truth = separation(shapes, model).separation.lower;
        const double needed = 1.0;
        const StockGoal goal{.limit = needed, .bound = StockBound::lower, .coarse_below = needed};
        const double found = separation(shapes, model, goal).separation.lower;
        ASSERT_EQ(found, truth >= needed - 1e-7 ? needed : 0.0) << truth;
        ++(found > 0.0 ? far : near);
    });
    EXPECT_GT(near, 40);
    EXPECT_GT(far, 40);
}

TEST(StockDistance, LiesBetweenItsBoundsAfterRandomCuts) {
    std::mt19937 rng(71);
    Seen seen;
    for (int i = 0; i < 48; ++i) {
        const CutBox world = random_cut_box(rng, i % 12, 0.0);
        const CutModel model = world.model(0.7);
        for (int k = 0; k < 6; ++k) {
            const Shapes shapes = random_tool(rng, world.box.grown(k % 2 ? 3.0 : 0.0));
            const StockGoal goal{.limit = k % 3 ? 50.0 : 1.5};
            expect_sound(world, shapes, separation(shapes, model, goal), goal, rng, seen);
            ASSERT_FALSE(HasFailure()) << i << ' ' << k;
        }
    }
    EXPECT_GT(seen.near, 40);
    EXPECT_GT(seen.overlapping, 40);
    EXPECT_GT(seen.far, 5);
}

/// Calls `act(world, model, shapes, first, k)` for tools 0 .. 5 at each of many randomly cut boxes,
/// where `first`, the distance without a goal, is within the limit. Ends at the first failure.
template <typename Act>
void for_near_tools(std::mt19937& rng, int boxes, const Act& act) {
    for (int i = 0; i < boxes; ++i) {
        const CutBox world = random_cut_box(rng, 1 + i % 12, 0.0);
        const CutModel model = world.model(0.7);
        for (int k = 0; k < 6; ++k) {
            const Shapes shapes = random_tool(rng, world.box.grown(2.0));
            const Separation first = separation(shapes, model).separation;
            if (first.found()) act(world, model, shapes, first, k);
            ASSERT_FALSE(testing::Test::HasFailure()) << i << ' ' << k;
        }
    }
}

TEST(StockDistance, IsNeverDecidedWronglyByRefinement) {
    std::mt19937 rng(72);
    Seen seen;
    size_t refined = 0;
    for_near_tools(rng, 42,
                   [&](const CutBox& world, const CutModel& model, const Shapes& shapes,
                       const Separation& first, int k) {
                       const double fraction = k / 5.0;
                       const StockGoal goal{.threshold = first.lower
                                                         + fraction * (first.upper - first.lower),
                                            .finest = 0.02,
                                            .work_limit = k == 3 ? 10u : 3000u};
                       const StockSeparation found = separation(shapes, model, goal);
                       refined += found.refined > 0;
                       EXPECT_GE(found.separation.lower, first.lower - 1e-6);
                       EXPECT_LE(found.separation.upper, first.upper);
                       expect_sound(world, shapes, found, goal, rng, seen);
                   });
    EXPECT_GT(refined, 40u);
    EXPECT_GT(seen.clear, 25);
    EXPECT_GT(seen.violated, 10);
}

/// The distance to the boxes of all columns of squares that are divided once if they are wider than
/// `finest`: `lower` after a refinement that ends there.
double to_quarters(const Shapes& shapes, const CutModel& model, double finest) {
    double least = infinity;
    const auto add = [&](const Square& s, const auto& column) {
        for (const Interval& z : column)
            for (const ConvexShape& shape : shapes) {
                const Aabb box{{s.x0, s.y0, z.lower}, {s.x1, s.y1, z.upper}};
                least = std::min(least, separation(shape, convex(box)).lower);
            }
    };
    for (int j = 0; j < model.columns.v_count(); ++j)
        for (int i = 0; i < model.columns.u_count(); ++i) {
            const Square s = cell_square(model, i, j);
            if (std::max(s.x1 - s.x0, s.y1 - s.y0) <= finest) {
                add(s, model.columns.line(i, j));
                continue;
            }
            const double x = 0.5 * (s.x0 + s.x1), y = 0.5 * (s.y0 + s.y1);
            for (const Square& quarter : {Square{s.x0, x, s.y0, y}, Square{x, s.x1, s.y0, y},
                                          Square{s.x0, x, y, s.y1}, Square{x, s.x1, y, s.y1}})
                add(quarter, fresh_column(model, i, j, quarter));
        }
    return least;
}

TEST(StockDistance, HasTheExactBoundOfSquaresThatAreDividedNoFurther) {
    std::mt19937 rng(76);
    int open = 0, better = 0;
    for_near_tools(
        rng, 60,
        [&](const CutBox&, const CutModel& model, const Shapes& shapes, const Separation& first,
            int) {
            const StockGoal goal{.threshold = first.lower + 0.9 * (first.upper - first.lower),
                                 .finest = 0.36};
            const Separation found = separation(shapes, model, goal).separation;
            if (found.upper < goal.threshold || first.lower >= goal.threshold) return;
            const double wanted = std::min(to_quarters(shapes, model, goal.finest), goal.threshold);
            EXPECT_NEAR(found.lower, wanted, 1e-6);
            ++open;
            better += wanted < goal.threshold && wanted > first.lower + 1e-3;
        });
    EXPECT_GT(open, 40);
    EXPECT_GT(better, 15);
}

/// A plate in which two slots leave a wall of the given thickness at y = 0.13.
CutBox thin_wall(double thickness) {
    const RevolvedProfile flat{{cylinder(3, 0, 30)}};
    const double y = 0.13 + 3.0;
    return {{{-15, -15, -10}, {15, 15, 0}},
            0.0,
            {{flat, {-30, y + 0.5 * thickness, -8}, {30, y + 0.5 * thickness, -8}},
             {flat, {-30, y - 6.0 - 0.5 * thickness, -8}, {30, y - 6.0 - 0.5 * thickness, -8}}}};
}

TEST(StockDistance, SeesAWallThinnerThanTheMeshSize) {
    std::mt19937 rng(73);
    for (const double thickness : {0.3, 0.05, 0.004}) {
        const CutBox world = thin_wall(thickness);
        const CutModel model = world.model(0.5);
        // A ball next to the wall, above the floor of the slot.
        const double truth = 0.6;
        const Shapes ball = {posed(convex_sphere(1.0),
                                   translation({1.7, 0.13 + 0.5 * thickness + 1.0 + truth, -4}))};
        for (const double threshold : {0.0, 0.55, 0.65}) {
            const StockGoal goal{.threshold = threshold, .finest = 0.002};
            const StockSeparation found = separation(ball, model, goal);
            EXPECT_LE(found.separation.lower, truth + 1e-9);
            EXPECT_GE(found.separation.upper, truth - 1e-6);
            if (threshold > 0.0 && threshold < truth) {
                EXPECT_GE(found.separation.lower, threshold) << thickness;
            }
            if (threshold > truth && thickness > 0.1) {
                EXPECT_LT(found.separation.upper, threshold) << thickness;
            }
        }
        // A needle that passes through the wall between the scan lines.
        const Shapes needle = {convex_segment({0.01, -2, -3}, {0.01, 2, -3.01})};
        EXPECT_EQ(separation(needle, model).separation.lower, 0.0);
    }
}

TEST(StockDistance, RecomputesTheLineAtTheGivenPlaceFirst) {
    const CutBox world = thin_wall(0.05);
    const CutModel model = world.model(0.5);
    // A ball that overlaps the wall, which no scan line shows.
    const Shapes ball = {posed(convex_sphere(1.0), translation({2, 1.1, -4}))};
    StockGoal goal{.threshold = 1e-6};
    const StockSeparation found = separation(ball, model, goal);
    EXPECT_EQ(found.separation.upper, 0.0);
    EXPECT_GT(found.refined, 0u);
    goal.first_place = Vec3(2, 0.13, 5);
    const StockSeparation sooner = separation(ball, model, goal);
    EXPECT_EQ(sooner.separation.upper, 0.0);
    EXPECT_EQ(sooner.refined, 0u);
    // A place that is empty, or beside the stock, changes nothing.
    for (const Vec3& place : {Vec3(2, -3, 0), Vec3(300, 0, 0)}) {
        goal.first_place = place;
        const StockSeparation again = separation(ball, model, goal);
        EXPECT_EQ(again.refined, found.refined);
        EXPECT_EQ(again.separation.lower, found.separation.lower);
        EXPECT_EQ(again.separation.upper, found.separation.upper);
    }
}

TEST(StockDistance, FindsAnOverlapBesideAContact) {
    const CutBox world{{{0, 0, -10}, {10, 10, 0}}, 0.0, {}};
    const CutModel model = world.model(0.5);
    // One piece almost touches lines along Z; a needle between these lines meets one along X.
    const Shapes shapes = {posed(convex(cylinder(1.0, 0, 4)), translation({3, 3, 5e-11})),
                           posed(convex(cylinder(0.05, -0.5, 4)), translation({7, 7.25, 0}))};
    for (const double limit : {50.0, 1e-6, 6e-11})
        EXPECT_EQ(separation(shapes, model, {.limit = limit}).separation.upper, 0.0) << limit;
}

TEST(StockDistance, FindsTheOverlapAtTheEndOfACutThatIsRepeatedAndLengthened) {
    std::mt19937 rng(79);
    const ProfileElement taper{0, 0.5, 6, 1.4, 0};
    int overlapping = 0;
    for (int i = 0; i < 80; ++i) {
        const Aabb box{{-8, -8, -6}, {8, 8, 0}};
        const Aabb within{{-5, -5, -3}, {5, 5, -1}};
        const Vec3 from = random_point(within, rng), to = random_point(within, rng);
        const CutBox world{box, 0.0, {{RevolvedProfile{{taper}}, from, to}}};
        const CutModel model = world.model(0.4);
        const Vec3 path[] = {from, to + 0.1 * (to - from)};
        const Shapes shapes = {swept(convex(taper), path)};
        if (to_lines(shapes, model) > 0.0) continue;
        ++overlapping;
        EXPECT_EQ(separation(shapes, model).separation.upper, 0.0) << i;
    }
    EXPECT_GT(overlapping, 40);
}

TEST(StockDistance, IsBeyondTheLimitForBodiesFarAway) {
    const CutBox world{{{0, 0, 0}, {10, 10, 10}}, 0.0, {}};
    const CutModel model = world.model(1.0);
    const Shapes ball = {posed(convex_sphere(1.0), translation({41, 5, 5}))};
    for (const double limit : {1.0, 20.0, 29.9999999999}) {
        const Separation found = separation(ball, model, {.limit = limit}).separation;
        EXPECT_FALSE(found.found());
        EXPECT_EQ(found.lower, limit);
    }
    const Separation found = separation(ball, model, {.limit = 50.0}).separation;
    EXPECT_NEAR(found.lower, 30.0, 1e-6);
    EXPECT_NEAR(found.upper, 30.0, 0.1);
    EXPECT_LE(found.lower, 30.0);
    EXPECT_GE(found.upper, 30.0);
}

TEST(StockDistance, OfAStockThatIsCutAwayIsBeyondTheLimit) {
    const RevolvedProfile wide{{cylinder(40, 0, 60)}};
    const CutBox world{{{0, 0, 0}, {10, 10, 10}}, 0.0, {{wide, {5, 5, -1}, {5, 5, -1}}}};
    const Shapes ball = {posed(convex_sphere(1.0), translation({5, 5, 5}))};
    const Separation found = separation(ball, world.model(1.0), {.threshold = 1.0}).separation;
    EXPECT_FALSE(found.found());
    EXPECT_EQ(found.lower, 50.0);
}

TEST(StockDistance, IsNothingInsideTheStock) {
    const CutBox world{{{0, 0, 0}, {10, 10, 10}}, 0.0, {}};
    const Shapes small = {posed(convex_sphere(0.01), translation({5.2, 5.3, 5.1}))};
    const Separation found = separation(small, world.model(1.0)).separation;
    EXPECT_EQ(found.lower, 0.0);
    EXPECT_LE(found.upper, 1.0);
}

TEST(StockDistance, OfAFlatFaceOverAFlatStockIsExactAndCheap) {
    const CutBox world{{{-50, -50, -30}, {50, 50, 0}}, 0.0, {}};
    const CutModel model = world.model(0.5);
    const Shapes holder = {posed(convex(cylinder(20, 0, 30)), translation({3, 2, 1.25}))};
    const StockSeparation found = separation(holder, model, {.threshold = 1.0});
    EXPECT_NEAR(found.separation.lower, 1.25, 1e-6);
    EXPECT_NEAR(found.separation.upper, 1.25, 1e-6);
    EXPECT_LT(found.shape_tests, 300u); // ties are skipped
}

TEST(StockDistance, OfAContactIsNothing) {
    const CutBox world{{{-5, -5, -3}, {5, 5, 0}}, 0.0, {}};
    const CutModel model = world.model(0.5);
    const Shapes resting = {convex(cylinder(2, 0, 30))};
    const Separation found = separation(resting, model, {.threshold = 1e-6}).separation;
    EXPECT_LE(found.lower, 1e-9);
    EXPECT_LE(found.upper, 1e-9);
}

} // namespace
} // namespace core
