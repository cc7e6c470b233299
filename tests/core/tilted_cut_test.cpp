#include <random>

#include <gtest/gtest.h>

#include "core/dbm/covered_path.h"
#include "core/dbm/cut_model.h"
#include "tests/support/convex_oracle.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::CutBox;
using test_support::for_cells_at;
using test_support::random_direction;
using test_support::random_point;
using test_support::random_tilted_cut_box;

constexpr double spacing = 0.7;

TEST(TiltedCut, LeavesEveryPointThatIsStillStockInTheColumns) {
    std::mt19937 rng(161);
    int close = 0, held = 0;
    for (int i = 0; i < 40; ++i) {
        const CutBox world = random_tilted_cut_box(rng, 1 + i % 10, i % 3 ? 0.0 : 0.15);
        const CutModel model = world.model(spacing);
        const Vec3 off = world.path_error * random_direction(rng);
        for (int k = 0; k < 400; ++k) {
            const Vec3 p = random_point(world.box, rng);
            const double outside = world.outside_cuts(p, off);
            if (outside <= 0.0) continue;
            ++held;
            close += outside < 0.1;
            for_cells_at(model, p, [&](int ci, int cj, const Square& s) {
                EXPECT_TRUE(model.columns.line(ci, cj).contains(p.z)) << i << ' ' << k;
                EXPECT_TRUE(fresh_column(model, ci, cj, s).contains(p.z)) << i << ' ' << k;
            });
        }
        ASSERT_FALSE(HasFailure());
    }
    EXPECT_GT(held, 3000);
    EXPECT_GT(close, 300);
}

TEST(TiltedCut, EmptiesColumnsThatItCoversWhole) {
    // A column three cells inside the cut must be empty there.
    std::mt19937 rng(162);
    int deep = 0;
    for (int i = 0; i < 30; ++i) {
        CutBox world = random_tilted_cut_box(rng, 1, 0.0);
        world.cuts[0].flutes = {{{0, 4, 12, 4, 0}}};
        const CutModel model = world.model(spacing);
        for (int k = 0; k < 400; ++k) {
            const Vec3 p = random_point(world.box, rng);
            if (world.outside_cuts(p) > -3.0 * spacing) continue;
            ++deep;
            for_cells_at(model, p, [&](int ci, int cj, const Square&) {
                EXPECT_FALSE(model.columns.line(ci, cj).contains(p.z)) << i << ' ' << k;
            });
        }
    }
    EXPECT_GT(deep, 300);
}

TEST(TiltedCut, LeavesOnTheLinesWhatIsStockAndNothingElse) {
    std::mt19937 rng(163);
    int in = 0, out = 0;
    for (int i = 0; i < 40; ++i) {
        const CutBox world = random_tilted_cut_box(rng, 1 + i % 8, 0.0);
        const CutModel model = world.model(spacing);
        for (int k = 0; k < 600; ++k) {
            const int axis = k % 3;
            const ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
            const int u = static_cast<int>(rng() % static_cast<unsigned>(family.u_count()));
            const int v = static_cast<int>(rng() % static_cast<unsigned>(family.v_count()));
            const Vec3 p =
                point_on_line(model.lines.grid, axis, u, v, random_point(world.box, rng)[axis]);
            const double outside = world.outside_cuts(p);
            if (std::abs(outside) < 1e-6) continue;
            ++(outside > 0.0 ? in : out);
            ASSERT_EQ(family.line(u, v).contains(p[axis]), outside > 0.0) << i << ' ' << k;
        }
    }
    EXPECT_GT(in, 5000);
    EXPECT_GT(out, 5000);
}

TEST(TiltedCut, KeepsEveryPointThatSomePathLeavesOnTheLinesWithin) {
    // With a path error, what the lines keep must be stock for every path within that error.
    std::mt19937 rng(164);
    int ends = 0;
    for (int i = 0; i < 12; ++i) {
        const CutBox world = random_tilted_cut_box(rng, 1 + i % 6, 0.15);
        const CutModel model = world.model(spacing);
        const Vec3 off = world.path_error * random_direction(rng);
        for (int axis = 0; axis < 3; ++axis) {
            const ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
            for (int v = 0; v < family.v_count(); ++v)
                for (int u = 0; u < family.u_count(); ++u)
                    for (const Interval& matter : family.line(u, v))
                        for (const double along : {matter.lower, matter.upper}) {
                            const Vec3 p = point_on_line(model.lines.grid, axis, u, v, along);
                            ++ends;
                            ASSERT_GE(world.outside_cuts(p, off), -1e-7) << i << ' ' << axis;
                        }
        }
    }
    EXPECT_GT(ends, 5000);
}

TEST(TiltedCut, StaysWithinItsBox) {
    std::mt19937 rng(165);
    int near = 0;
    for (int i = 0; i < 2000; ++i) {
        const CutBox world = random_tilted_cut_box(rng, 1, 0.0);
        const Aabb box = bounds(world.sweep(0));
        const Vec3 p = random_point(box.grown(0.5), rng);
        if (world.outside_cuts(p) > 0.0) continue;
        ++near;
        EXPECT_LE(distance_squared(p, box), 1e-20);
    }
    EXPECT_GT(near, 300);
}

TEST(OwnCut, IsKnownFromTheSideToo) {
    const RevolvedProfile flutes{{{0.0, 5.0, 20.0, 5.0, 0.0}}};
    const Mat3 from_the_right = rotation_xyz_deg({0.0, 90.0, 0.0}); // the tool's axis along X
    CutModel stock = *make_cut_model({SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0}, 1.0);
    const auto cutter = std::make_shared<const Cutter>(make_cutter(flutes, 0.0));
    cut(stock, {cutter, {95, -20, -15}, {95, 60, -15}, from_the_right});
    const auto holds = [&](const Vec3& from, const Vec3& to, const Mat3& orientation) {
        return runs_in_own_cut(stock, {flutes, from, to, 0.02, orientation});
    };
    EXPECT_TRUE(holds({95, 60, -15}, {95, -20, -15}, from_the_right));
    EXPECT_TRUE(holds({95, 60, -15}, {140, 60, -15}, from_the_right)); // out along the tool axis
    EXPECT_FALSE(holds({95, 60, -15}, {94.9, 60, -15}, from_the_right));
    EXPECT_FALSE(holds({95, 60, -15}, {95, 60, 20}, from_the_right));
    EXPECT_FALSE(holds({95, 60, -15}, {95, -20, -15}, Mat3(1.0)));
}

} // namespace
} // namespace core
