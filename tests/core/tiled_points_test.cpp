#include <random>

#include <gtest/gtest.h>

#include "core/distance/point_search.h"
#include "core/distance/tiled_points.h"
#include "tests/support/meshes.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::CutBox;
using test_support::cutters;
using test_support::random_point;
using test_support::random_pose;

const Aabb stock_box{{-40, -30, -10}, {40, 30, 0}};

/// A short move of any cutter somewhere in the upper part of the stock.
CutterSweep random_cut(std::mt19937& rng) {
    static const std::vector<RevolvedProfile> tools = cutters();
    Aabb upper = stock_box;
    upper.min.z = -6.0;
    const Vec3 from = random_point(upper, rng);
    const Vec3 to = from + random_point({{-3, -3, -0.5}, {3, 3, 0.5}}, rng);
    const auto cutter = std::make_shared<Cutter>(make_cutter(tools[rng() % tools.size()], 0.0));
    return {cutter, from, to};
}

CutModel stock(double spacing) {
    return make_cut_model({SolidBox{stock_box}, 0.0}, spacing).value();
}

PointTree ball() { return point_tree(boundary_points(scan(Sphere{7.0}, 1.0).value())).value(); }

/// What a tree built afresh says must be said by the one that was kept up to date.
void expect_as_afresh(const TiledPoints& kept, const Dbm& lines, const PointTree& probe,
                      const Transform& pose, const Vec3& sweep) {
    const PointTree fresh = point_tree(boundary_points(lines)).value();
    const PointTreeView of_probe{&probe, {}};
    for (const PairGoal& goal : {PairGoal{}, PairGoal{.sweep = sweep}}) {
        const ClosestPair whole = closest_pair(fresh, probe, pose, goal);
        const ClosestPair found = closest_pair(kept.view(), of_probe, pose, goal);
        EXPECT_EQ(found.distance, whole.distance);
        EXPECT_EQ(found.lower, whole.lower);
        const PairGoal again{.sweep = goal.sweep, .first = found.points};
        EXPECT_EQ(closest_pair(kept.view(), of_probe, pose, again).distance, whole.distance);
        const ClosestPair turned =
            closest_pair(of_probe, kept.view(), pose.inverse(), {.limit = 1e3});
        EXPECT_NEAR(turned.distance, closest_pair(kept.view(), of_probe, pose).distance, 1e-9);
    }
}

TEST(TiledPoints, AnswerAsATreeBuiltAfreshAfterTenThousandCuts) {
    std::mt19937 rng(1);
    CutModel model = stock(1.0);
    TiledPoints kept = TiledPoints::of(model.lines).value();
    const PointTree probe = ball();
    const size_t before = point_count(model.lines);
    for (int i = 1; i <= 10'000; ++i) {
        cut(model, random_cut(rng));
        kept.update(model.lines);
        if (i % 250 == 0 || i < 5)
            expect_as_afresh(kept, model.lines, probe, random_pose(rng, 45.0),
                             random_point(stock_box, rng));
    }
    EXPECT_NE(point_count(model.lines), before);
}

TEST(TiledPoints, RebuildTheTilesThatACutTouchesAndNoOthers) {
    CutModel model = stock(0.5);
    TiledPoints kept = TiledPoints::of(model.lines).value();
    EXPECT_EQ(kept.update(model.lines), 0u);
    const auto before = kept.view().tiles;
    const TiledPoints snapshot = kept;
    const auto cutter =
        std::make_shared<Cutter>(make_cutter(RevolvedProfile{{{0, 1, 20, 1, 0}}}, 0.0));
    cut(model, {cutter, {20.2, 10.1, -1}, {20.4, 10.1, -1}});
    const size_t rebuilt = kept.update(model.lines);
    EXPECT_GT(rebuilt, 0u);
    EXPECT_LE(rebuilt, 12u); // a pocket of 2.4 x 2 x 1 mm; tiles are 8 mm wide
    size_t other = 0;
    for (size_t i = 0; i < before.size(); ++i)
        other += kept.view().tiles[i] != snapshot.view().tiles[i];
    EXPECT_EQ(other, rebuilt);
    EXPECT_GT(before.size(), 10 * rebuilt);
}

TEST(TiledPoints, SnapshotsStayAsTheyWere) {
    std::mt19937 rng(3);
    CutModel model = stock(1.0);
    TiledPoints kept = TiledPoints::of(model.lines).value();
    std::vector<std::pair<TiledPoints, Dbm>> snapshots;
    for (int i = 0; i < 200; ++i) {
        cut(model, random_cut(rng));
        kept.update(model.lines);
        if (i % 20 == 0) snapshots.emplace_back(kept, model.lines);
    }
    const PointTree probe = ball();
    for (const auto& [points, lines] : snapshots)
        expect_as_afresh(points, lines, probe, random_pose(rng, 40.0), Vec3(3.0, -2.0, 1.0));
}

TEST(TiledPoints, MayGoBackToAnEarlierState) {
    std::mt19937 rng(4);
    CutModel model = stock(1.0);
    TiledPoints kept = TiledPoints::of(model.lines).value();
    const CutModel early = model;
    for (int i = 0; i < 50; ++i) cut(model, random_cut(rng));
    kept.update(model.lines);
    kept.update(early.lines);
    expect_as_afresh(kept, early.lines, ball(), random_pose(rng, 40.0), Vec3(0.0));
}

TEST(TiledPoints, AreEmptyWhenEverythingIsGone) {
    CutModel model = make_cut_model({SolidBox{{{-4, -4, -2}, {4, 4, 0}}}, 0.0}, 1.0).value();
    TiledPoints kept = TiledPoints::of(model.lines).value();
    EXPECT_FALSE(kept.empty());
    const auto cutter =
        std::make_shared<Cutter>(make_cutter(RevolvedProfile{{{0, 30, 20, 30, 0}}}, 0.0));
    cut(model, {cutter, {0, 0, -5}, {1, 0, -5}});
    kept.update(model.lines);
    EXPECT_TRUE(kept.empty());
    const PointTree probe = ball();
    const ClosestPair none = closest_pair(kept.view(), {&probe, {}}, {});
    EXPECT_FALSE(none.found());
    EXPECT_EQ(none.lower, infinity);
}

} // namespace
} // namespace core
