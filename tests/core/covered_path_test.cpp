#include <gtest/gtest.h>

#include "core/dbm/covered_path.h"
#include "core/dbm/cut_model.h"

namespace core {
namespace {

const RevolvedProfile end_mill{{{0.0, 5.0, 20.0, 5.0, 0.0}}};
const RevolvedProfile slimmer{{{0.0, 4.9, 20.0, 4.9, 0.0}}};
const RevolvedProfile dovetail{{{0.0, 5.0, 20.0, 2.0, 0.0}}};
const RevolvedProfile bare_ball{{{4.0, 0.0, 4.0, 0.0, 4.0}}};

/// A block of 100 x 100 x 30 with its top at Z 0, cut along a slot from X-20 to X60 at Y50, Z-5.
struct Slot {
    CutModel stock = *make_cut_model({SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0}, 1.0);

    explicit Slot(const RevolvedProfile& flutes = end_mill, double z = -5.0) {
        const auto cutter = std::make_shared<const Cutter>(make_cutter(flutes, 0.0));
        cut(stock, {cutter, {-20, 50, z}, {60, 50, z}});
    }
    bool holds(const Vec3& from, const Vec3& to, const RevolvedProfile& flutes = end_mill,
               double sideways = 0.02) const {
        return runs_in_own_cut(stock, {flutes, from, to, sideways});
    }
};

TEST(OwnCut, HoldsTheWayBackAndUp) {
    const Slot slot;
    EXPECT_TRUE(slot.holds({60, 50, -5}, {-20, 50, -5}));
    EXPECT_TRUE(slot.holds({60, 50, -5}, {60, 50, 40}));
    EXPECT_TRUE(slot.holds({60, 50.01, -5}, {20, 49.99, 3}));
}

TEST(OwnCut, EndsWhereTheCutEnded) {
    const Slot slot;
    EXPECT_FALSE(slot.holds({60, 50, -5}, {60.1, 50, -5}));
    EXPECT_FALSE(slot.holds({60, 50, -5}, {60, 50, -5.03}));
    EXPECT_FALSE(slot.holds({60, 50, -5}, {20, 50.1, -5}));
    EXPECT_FALSE(slot.holds({60, 49.9, -5}, {60, 49.9, 30}));
}

TEST(OwnCut, ContinuesFromOneMoveToTheNext) {
    Slot slot;
    const auto cutter = std::make_shared<const Cutter>(make_cutter(end_mill, 0.0));
    cut(slot.stock, {cutter, {60, 50, -5}, {60, 90, -8}});
    EXPECT_TRUE(slot.holds({60, 90, -8}, {60, 50, -5}));
    EXPECT_TRUE(slot.holds({60, 70, -6}, {60, 50, -4}));
    EXPECT_FALSE(slot.holds({60, 70, -7}, {60, 50, -5}));
    EXPECT_FALSE(slot.holds({30, 50, -5}, {60, 80, -5}));
}

/// The tip may have been farther below the path than the stock is large.
TEST(OwnCut, HoldsAboveADeepTip) {
    const RevolvedProfile mill{{{0.0, 2.0, 20.0, 2.0, 0.0}}};
    CutModel thin = *make_cut_model({SolidBox{{{0, 0, -3}, {10, 10, 0}}}, 0.0}, 0.5);
    const auto cutter = std::make_shared<const Cutter>(make_cutter(mill, 0.0));
    cut(thin, {cutter, {-5, 5, -18}, {15, 5, -18}});
    EXPECT_TRUE(runs_in_own_cut(thin, {mill, {6, 5, -1}, {4, 5, -1}, 0.02}));
    EXPECT_TRUE(runs_in_own_cut(thin, {mill, {6, 5, 1}, {4, 5, 1}, 0.02}));
}

/// Moves that follow each other are found as one, wherever on them the path is.
TEST(OwnCut, HoldsOnTheLastOfManyMoves) {
    Slot slot;
    const auto cutter = std::make_shared<const Cutter>(make_cutter(end_mill, 0.0));
    cut(slot.stock, {cutter, {60, 50, -5}, {60, 53, -5}});
    cut(slot.stock, {cutter, {60, 53, -5}, {63, 53, -5}});
    cut(slot.stock, {cutter, {63, 53, -5}, {63, 50, -5}});
    EXPECT_TRUE(slot.holds({63, 52, -5}, {63, 51, -5}));
    EXPECT_TRUE(slot.holds({61, 53, -5}, {62, 53, 0}));
    EXPECT_FALSE(slot.holds({64, 52, -5}, {64, 51, -5}));
}

TEST(OwnCut, IsThatOfTheSameFlutesOnly) {
    EXPECT_FALSE(Slot(slimmer).holds({60, 50, -5}, {0, 50, -5}));
}

TEST(OwnCut, DoesNotExistForFlutesThatGetSlimmerUpwards) {
    EXPECT_FALSE(Slot(dovetail).holds({60, 50, -5}, {60, 50, 10}, dovetail));
}

TEST(OwnCut, IsClosedAboveABallWithoutAShank) {
    EXPECT_FALSE(Slot(bare_ball, -8.0).holds({60, 50, -8}, {60, 50, 10}, bare_ball));
}

TEST(OwnCut, IsClosedAboveWhereTheFlutesEndBelowTheTop) {
    EXPECT_FALSE(Slot(end_mill, -25.0).holds({60, 50, -25}, {60, 50, 0}));
    EXPECT_FALSE(Slot(end_mill, -25.0).holds({60, 50, -24.97}, {0, 50, -24.97}));
}

TEST(OwnCut, HoldsTheWayBackOfAnyFlutes) {
    for (const RevolvedProfile& flutes : {dovetail, bare_ball, end_mill}) {
        const Slot slot(flutes, -25.0);
        EXPECT_TRUE(slot.holds({60, 50, -25}, {-20, 50.01, -25.01}, flutes));
        EXPECT_FALSE(slot.holds({60, 50, -25}, {-20, 50, -25.03}, flutes));
        EXPECT_FALSE(slot.holds({60, 50, -25}, {-20, 50, -24.97}, flutes));
    }
}

} // namespace
} // namespace core
