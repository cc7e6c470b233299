#include <random>

#include <gtest/gtest.h>

#include "core/dbm/covered_path.h"
#include "core/dbm/cut_model.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::for_cells_at;

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

/// A shank as wide as the flutes of 20 mm, and one that is 1 mm slimmer.
const RevolvedProfile shank{{{20.0, 5.0, 60.0, 5.0, 0.0}}};
const RevolvedProfile neck{{{20.0, 4.0, 60.0, 4.0, 0.0}}};

/// A block of 100 x 100 x 60 with its top at Z 0, cut along levels at Y50.
struct DeepSlot {
    CutModel stock = *make_cut_model({SolidBox{{{0, 0, -60}, {100, 100, 0}}}, 0.0}, 1.0);
    std::shared_ptr<const Cutter> cutter =
        std::make_shared<const Cutter>(make_cutter(end_mill, 0.0));

    void mill(const Vec3& from, const Vec3& to, const Mat3& orientation = Mat3(1.0)) {
        cut(stock, {.cutter = cutter, .from = from, .to = to, .orientation = orientation});
    }
    bool holds(const Vec3& from, const Vec3& to, const RevolvedProfile& part = shank,
               uint32_t first_move = 0, double sideways = 0.2) const {
        return stays_in_own_cut(stock, {.part = part,
                                        .flutes = end_mill,
                                        .from = from,
                                        .to = to,
                                        .sideways = sideways,
                                        .first_move = first_move,
                                        .gap = sideways});
    }
};

TEST(OwnCutOfAPart, HoldsBelowLevelsThatAreOpenAtTheSide) {
    DeepSlot slot;
    for (const double z : {-15.0, -30.0, -45.0}) slot.mill({-10, 50, z}, {110, 50, z});
    EXPECT_TRUE(slot.holds({-10, 50, -45}, {110, 50, -45}));
    EXPECT_TRUE(slot.holds({110, 50.1, -45}, {30, 49.9, -45}, neck));
    EXPECT_FALSE(slot.holds({-10, 50.3, -45}, {110, 50.3, -45}));
    EXPECT_FALSE(slot.holds({-10, 50, -45}, {110, 50, -45}, shank, 1)); // without the first level
}

TEST(OwnCutOfAPart, BeginsWithTheSlotUnlessThatIsOpenThere) {
    for (const double x : {0.0, 3.0}) {
        DeepSlot slot;
        for (const double z : {-15.0, -30.0, -45.0}) slot.mill({x, 50, z}, {90, 50, z});
        EXPECT_EQ(slot.holds({-20, 50, -45}, {90, 50, -45}), x == 0.0);
    }
}

/// A level may be made of many pieces that are not those of the next one. Those that meet nothing
/// are not logged.
TEST(OwnCutOfAPart, HoldsBelowLevelsInPieces) {
    for (const double step : {0.1, 4.0}) {
        DeepSlot slot;
        for (int k = 0; k * step < 120.0; ++k)
            slot.mill({-10 + step * k, 50, -20}, {-10 + step * (k + 1), 50, -20});
        EXPECT_TRUE(slot.holds({-10, 50, -40}, {110, 50, -40})) << step;
        EXPECT_TRUE(slot.holds({90, 50, -40}, {90, 50, -30})) << step;
        EXPECT_FALSE(slot.holds({-10, 50, -40}, {130, 60, -40})) << step;
        EXPECT_FALSE(slot.holds({-5.1, 20, -40}, {-5.1, 80, -40})) << step << ": beside the face";
    }
}

/// The tool's axis may stay outside of the stock, or leave it obliquely.
TEST(OwnCutOfAPart, HoldsBesideTheBlockAndThroughItsSides) {
    DeepSlot slot;
    for (const double z : {-15.0, -30.0, -45.0}) {
        slot.mill({-10, -3, z}, {110, -3, z});
        slot.mill({40, 60, z}, {120, 100, z});
    }
    EXPECT_TRUE(slot.holds({-10, -3, -45}, {110, -3, -45}));
    EXPECT_FALSE(slot.holds({-10, -2.7, -45}, {110, -2.7, -45}));
    EXPECT_TRUE(slot.holds({40, 60, -45}, {120, 100, -45}));
    // In pieces round a corner of the block, of which some meet nothing.
    DeepSlot round;
    for (const double z : {-15.0, -30.0, -45.0})
        for (double x = 90; x < 110; x += 0.5) round.mill({x, -3, z}, {x + 0.5, -3, z});
    EXPECT_TRUE(round.holds({92, -3, -45}, {108, -3, -45}));
}

/// Where a pocket was cut before, the cells below the axis hold nothing.
TEST(OwnCutOfAPart, HoldsAtTheWallOfAPocket) {
    DeepSlot slot;
    for (const double z : {-15.0, -30.0, -45.0, -60.5})
        for (double y = 10; y < 70; y += 6) slot.mill({10, y, z}, {90, y, z});
    for (const double z : {-15.0, -30.0, -45.0}) slot.mill({10, 70, z}, {90, 70, z});
    EXPECT_TRUE(slot.holds({10, 70, -45}, {90, 70, -45}));
    EXPECT_FALSE(slot.holds({10, 70, -45}, {90, 72, -45}));
}

TEST(OwnCutOfAPart, CountsMovesBetweenTwoNumbers) {
    DeepSlot slot;
    for (const double z : {-30.0, -15.0, -45.0}) slot.mill({-10, 50, z}, {110, 50, z});
    for (const uint32_t first : {0U, 1U})
        for (const uint32_t end : {1U, 2U})
            EXPECT_EQ(stays_in_own_cut(slot.stock, {.part = shank,
                                                    .flutes = end_mill,
                                                    .from = {0, 50, -45},
                                                    .to = {90, 50, -45},
                                                    .sideways = 0.2,
                                                    .first_move = first,
                                                    .moves_end = end,
                                                    .gap = 0.2}),
                      first == 0 && end == 2);
}

TEST(OwnCutOfAPart, HoldsWhereTheToolPlungesAndRises) {
    DeepSlot slot;
    slot.mill({50, 50, 10}, {50, 50, -50});
    EXPECT_TRUE(slot.holds({50, 50, 10}, {50, 50, -50}));
    EXPECT_TRUE(slot.holds({50, 50, -50}, {50, 50, 80}));
    EXPECT_FALSE(slot.holds({50, 50, -50}, {51, 50, -50}));
}

/// Flutes below an overhang: the shank stands beside material that no flutes have touched.
TEST(OwnCutOfAPart, EndsBesideRawStock) {
    DeepSlot slot;
    slot.mill({50, -6, -50}, {50, -1, -50});
    slot.mill({50, -1, -50}, {90, -1, -50});
    EXPECT_FALSE(slot.holds({50, -1, -50}, {90, -1, -50}));
    EXPECT_FALSE(slot.holds({50, -4.1, -50}, {90, -4.1, -50}, neck));
    EXPECT_TRUE(slot.holds({50, -4.21, -50}, {90, -4.21, -50}, neck)); // too far from it
    EXPECT_FALSE(slot.holds({50, -3.9, -50}, {90, -4.3, -50}, neck));
}

/// Between two levels that do not meet, material is left.
TEST(OwnCutOfAPart, EndsWhereHeightsWereLeftOut) {
    DeepSlot slot;
    slot.mill({-10, 50, -15}, {110, 50, -15});
    slot.mill({-10, 50, -37}, {110, 50, -37});
    EXPECT_FALSE(slot.holds({0, 50, -50}, {110, 50, -50}));
    slot.mill({-10, 50, -35}, {110, 50, -35});
    EXPECT_TRUE(slot.holds({0, 50, -50}, {110, 50, -50}));
}

/// A ball does not make room for a shank at the heights of its lower half.
TEST(OwnCutOfAPart, NeedsFlutesThatAreWideEnough) {
    const RevolvedProfile ball{{{5.0, 0.0, 5.0, 0.0, 5.0}, {5.0, 5.0, 20.0, 5.0, 0.0}}};
    DeepSlot slot;
    slot.cutter = std::make_shared<const Cutter>(make_cutter(ball, 0.0));
    slot.mill({-10, 50, -20}, {110, 50, -20});
    EXPECT_FALSE(slot.holds({0, 50, -40}, {110, 50, -40}));
    slot.mill({-10, 50, -30}, {110, 50, -30});
    EXPECT_TRUE(slot.holds({0, 50, -40}, {110, 50, -40}));
}

TEST(OwnCutOfAPart, HoldsForTiltedTools) {
    const double angle = 0.4;
    const Mat3 tilted(Vec3(std::cos(angle), 0, -std::sin(angle)), Vec3(0, 1, 0),
                      Vec3(std::sin(angle), 0, std::cos(angle)));
    DeepSlot slot;
    const auto at = [&](double x, double along) { return Vec3(x, 50, 0) + along * tilted[2]; };
    for (const double along : {-15.0, -30.0, -45.0})
        slot.mill(at(60, along), at(90, along), tilted);
    const auto holds = [&](double from, double to, const Mat3& orientation, double gap = 0.0) {
        return stays_in_own_cut(slot.stock, {.part = shank,
                                             .flutes = end_mill,
                                             .from = at(from, -45),
                                             .to = at(to, -45),
                                             .sideways = 0.2,
                                             .orientation = orientation,
                                             .gap = gap});
    };
    EXPECT_TRUE(holds(61, 89, tilted));
    EXPECT_FALSE(holds(61, 91, tilted));
    EXPECT_FALSE(holds(61, 89, Mat3(1.0)));
    const Mat3 nearly = rotation_xyz_deg({0, 0.3, 0}) * tilted;
    EXPECT_FALSE(holds(75, 75, nearly)) << "nothing is proven";
    EXPECT_TRUE(holds(75, 75, nearly, 0.2));
}

TEST(OwnCutOfAPart, IsEmptyWhereItIsProven) {
    const std::vector<RevolvedProfile> all_flutes{
        {{{0.0, 5.0, 12.0, 5.0, 0.0}}},
        {{{5.0, 0.0, 5.0, 0.0, 5.0}, {5.0, 5.0, 12.0, 5.0, 0.0}}},
        {{{1.5, 3.5, 1.5, 3.5, 1.5}, {1.5, 5.0, 12.0, 5.0, 0.0}}},
        {{{0.0, 5.0, 12.0, 3.0, 0.0}}},
        {{{0.0, 2.0, 12.0, 6.0, 0.0}}},
        {{{0.0, 6.0, 4.0, 6.0, 0.0}, {4.0, 3.0, 12.0, 3.0, 0.0}}}};
    std::mt19937 rng(20);
    const auto pick = [&](int most) { return static_cast<int>(rng() % (most + 1)); };
    const auto part_of = [&](double range) { return range * pick(1'000'000) / 1e6; };
    const auto tilted_by = [](double angle) {
        return Mat3(Vec3(std::cos(angle), 0, -std::sin(angle)), Vec3(0, 1, 0),
                    Vec3(std::sin(angle), 0, std::cos(angle)));
    };
    int held = 0;
    for (int trial = 0; trial < 800; ++trial) {
        CutModel stock = *make_cut_model({SolidBox{{{0, 0, -40}, {40, 40, 0}}}, 0.0}, 1.0);
        const RevolvedProfile& flutes = all_flutes[rng() % all_flutes.size()];
        const double radius = 2.0 + 0.5 * pick(6), error = 0.01 * pick(2);
        const RevolvedProfile part{{{12.0, radius, 35.0, radius, 0.0}}};
        const auto cutter = std::make_shared<const Cutter>(make_cutter(flutes, error));
        const double angle = trial % 3 == 0 ? 0.1 * pick(6) : 0.0;
        const Mat3 orientation = tilted_by(angle);
        // Levels of the same ways, from the top down, and a part that takes one of them.
        std::vector<Vec3> ways;
        for (int k = 0; k < 5; ++k) ways.push_back({5 * pick(10) - 5, 10 * pick(4), 0});
        const double step = trial % 4 == 0 ? 11.9 + part_of(0.3) : 4.0 + pick(8);
        const double inexact = trial % 2 == 0 ? 0.02 : 0.08;
        const auto shift = [&](double depth) {
            const auto off = [&] { return part_of(2.0 * inexact) - inexact; };
            return Vec3(off(), off(), off()) - depth * orientation[2];
        };
        for (double depth = step; depth < 36.0; depth += step)
            for (size_t k = 0; k < 4; ++k)
                cut(stock, {.cutter = cutter,
                            .from = ways[k] + shift(depth),
                            .to = ways[k + 1] + shift(depth),
                            .orientation = orientation});
        for (int query = 0; query < 12; ++query) {
            const size_t k = rng() % 4;
            const double first = part_of(1.4) - 0.2, last = part_of(1.4) - 0.2;
            const double depth = pick(34), sinking = query % 2 == 0 ? 0.0 : pick(8) - 4.0;
            const auto at = [&](double t) { return ways[k] + t * (ways[k + 1] - ways[k]); };
            const Vec3 from = at(first) + shift(depth), to = at(last) + shift(depth + sinking);
            const Mat3 held_by = query % 5 == 0 ? tilted_by(angle + part_of(0.02)) : orientation;
            const double sideways = 0.03 + part_of(0.1);
            if (!stays_in_own_cut(stock, {part, flutes, from, to, sideways, held_by})) continue;
            ++held;
            for (int point = 0; point < 400; ++point) {
                const double t = part_of(1.0), h = 12 + sideways + part_of(23 - sideways);
                const double around = part_of(6.2832), inner = pick(3) == 0 ? part_of(1.0) : 1.0;
                const double r = (radius - sideways) * 0.99999 * inner;
                const Vec3 p = from + t * (to - from)
                               + held_by * Vec3(r * std::cos(around), r * std::sin(around), h);
                if (p.x <= 0 || p.x >= 40 || p.y <= 0 || p.y >= 40 || p.z <= -40 || p.z >= 0)
                    continue;
                for_cells_at(stock, p, [&](int i, int j, const Square&) {
                    EXPECT_FALSE(fresh_line(stock, i, j, p.x, p.y).contains(p.z))
                        << trial << ' ' << p.x << ' ' << p.y << ' ' << p.z;
                });
            }
        }
    }
    EXPECT_GT(held, 400);
}

} // namespace
} // namespace core
