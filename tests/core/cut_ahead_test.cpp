#include <bit>
#include <map>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "core/dbm/contour.h"
#include "core/dbm/cut_ahead.h"
#include "tests/support/random_moves.h"
#include "tests/support/stock_digest.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::cutters;
using test_support::random_point;
using test_support::RandomMoves;

/// Cuts all shards of a window on threads of their own.
void cut_all(CutAhead& ahead, CutWindow& window) {
    std::vector<std::thread> threads;
    for (unsigned shard = 0; shard < ahead.shards(); ++shard)
        threads.emplace_back([&, shard] { ahead.cut(window, shard); });
    for (std::thread& thread : threads) thread.join();
    CutAhead::finish(window);
}

/// Expects that everything about two models is the same, bit for bit.
void expect_same(const CutModel& a, const CutModel& b) {
    EXPECT_EQ(test_support::digest(a), test_support::digest(b));
    ASSERT_EQ(a.log.size(), b.log.size());
    EXPECT_EQ(a.marks, b.marks);
    for (size_t i = 0; i < a.log.size(); ++i) {
        EXPECT_EQ(a.log.block(i), b.log.block(i));
        EXPECT_EQ(a.log[i].sweep.from, b.log[i].sweep.from);
        EXPECT_EQ(a.log[i].sweep.to, b.log[i].sweep.to);
    }
    EXPECT_EQ(std::bit_cast<uint64_t>(a.volume_owed), std::bit_cast<uint64_t>(b.volume_owed));
    for (size_t family = 0; family < 3; ++family) {
        const TileBoxes &mine = a.line_boxes[family], &other = b.line_boxes[family];
        EXPECT_EQ(mine.stale, other.stale);
        for (size_t i = 0; i < mine.boxes.size(); ++i) {
            EXPECT_EQ(mine.boxes[i].min, other.boxes[i].min);
            EXPECT_EQ(mine.boxes[i].max, other.boxes[i].max);
        }
        const ScanLines &lines = a.lines.families[family], &others = b.lines.families[family];
        for (int v = 0; v < lines.v_count(); ++v)
            for (int u = 0; u < lines.u_count(); ++u)
                for (size_t i = 0; i < lines.line(u, v).size(); ++i)
                    ASSERT_EQ(lines.marks(u, v, i), others.marks(u, v, i));
    }
    ASSERT_EQ(a.history.size(), b.history.size());
    for (size_t tile = 0; tile < a.history.size(); ++tile) {
        ASSERT_EQ(a.history[tile].size(), b.history[tile].size());
        for (size_t i = 0; i < a.history[tile].size(); ++i)
            EXPECT_EQ(a.history[tile][i].last, b.history[tile][i].last);
    }
}

CutModel box_model(const Aabb& box, double spacing) {
    return make_cut_model({SolidBox{box}, 0.0}, spacing).value();
}

TEST(CutAhead, RepeatsEveryMoveWithTheSameBits) {
    std::mt19937 rng(71);
    size_t removing = 0;
    for (int world = 0; world < 12; ++world) {
        SCOPED_TRACE(world);
        const Aabb box{{0, 0, 0}, {20.0 + world, 16, 9}};
        RandomMoves moves(box, rng);
        CutModel one = box_model(box, 0.4);
        for (int i = 0; i < 20; ++i) cut(one, moves.next());
        CutModel other = one;
        // The model that is cut ahead shares tiles with both.
        CutAhead ahead(other, 1 + world % 3);
        std::unique_ptr<CutWindow> used;
        std::vector<std::pair<CutModel, CutModel>> snapshots;
        for (int w = 0; w < 90; ++w) {
            std::vector<CutterSweep> sweeps;
            for (size_t i = rng() % 12; i > 0; --i) sweeps.push_back(moves.next());
            auto window = ahead.begin(sweeps, std::move(used));
            cut_all(ahead, *window);
            for (size_t i = 0; i < sweeps.size(); ++i) {
                const double a = cut(one, sweeps[i]);
                const double b = CutAhead::repeat(*window, i, sweeps[i], other);
                removing += a > 0.0;
                ASSERT_EQ(std::bit_cast<uint64_t>(a), std::bit_cast<uint64_t>(b)) << w << ' ' << i;
            }
            CutAhead::share(*window, other);
            used = std::move(window);
            if (w % 20 == 7) snapshots.emplace_back(one, other);
            if (w % 10 != 0) continue;
            ASSERT_NO_FATAL_FAILURE(expect_same(one, other));
        }
        ASSERT_NO_FATAL_FAILURE(expect_same(one, other));
        // Later cuts have not changed the snapshots.
        for (const auto& [a, b] : snapshots)
            EXPECT_EQ(test_support::digest(a), test_support::digest(b));
    }
    EXPECT_GT(removing, 1500u);
}

TEST(Cut, OfALargeMoveIsTheSameOnSeveralThreads) {
    std::mt19937 rng(74);
    const Aabb box{{0, 0, 0}, {60, 50, 8}};
    CutModel one = box_model(box, 0.11), other = one;
    size_t removing = 0;
    for (const RevolvedProfile& flutes : cutters()) {
        const auto cutter = std::make_shared<const Cutter>(make_cutter(flutes, 0.0));
        for (int i = 0; i < 3; ++i) {
            const Vec3 from(-5.0, random_point(box, rng).y, random_point(box, rng).z);
            const Vec3 to(65.0, random_point(box, rng).y, random_point(box, rng).z);
            const CutterSweep sweep{cutter, from, to, Mat3(1.0), 1};
            const double a = cut(one, sweep), b = cut(other, sweep, 3);
            removing += a > 0.0;
            ASSERT_EQ(std::bit_cast<uint64_t>(a), std::bit_cast<uint64_t>(b));
        }
    }
    EXPECT_GT(removing, 15u);
    ASSERT_NO_FATAL_FAILURE(expect_same(one, other));
}

TEST(CutAhead, NumbersMovesAlikeWhateverTheBoxesAroundTheStockAre) {
    // Moves through a part of the raw box that is empty are not in the log if the boxes around the
    // stock are fitted, and these depend on searches.
    const Aabb box{{0, 0, 0}, {30, 30, 10}};
    const auto flat = std::make_shared<const Cutter>(make_cutter(cutters()[0], 0.0));
    CutModel one = box_model(box, 1.0);
    CutModel other = one;
    CutAhead ahead(other, 1);
    std::vector<CutterSweep> sweeps;
    for (int row = 0; row <= 8; ++row)
        sweeps.push_back({flat, {-5.0, 4.0 * row, 5.0}, {35.0, 4.0 * row, 5.0}, Mat3(1.0), 1});
    const size_t clearing = sweeps.size();
    for (int row = 0; row <= 4; ++row)
        sweeps.push_back({flat, {-5.0, 4.0 * row, 7.0}, {35.0, 4.0 * row, 7.0}, Mat3(1.0), 2});
    sweeps.push_back({flat, {-5, 15, 2}, {35, 15, 2}, Mat3(1.0), 3});
    auto window = ahead.begin(sweeps);
    cut_all(ahead, *window);
    for (size_t i = 0; i < sweeps.size(); ++i) {
        if (i == clearing) {
            note_search(one, 10'000'000); // fits the boxes
            note_search(other, 10'000'000);
        }
        cut(one, sweeps[i]);
        CutAhead::repeat(*window, i, sweeps[i], other);
    }
    EXPECT_LT(one.log.size(), sweeps.size());
    ASSERT_NO_FATAL_FAILURE(expect_same(one, other));
    // The mark of an end leads to the move that made it.
    size_t ends = 0;
    for (int u = 0; u < one.lines.families[2].u_count(); ++u) {
        const LineEnd end{2, u, 15, 0, true};
        const auto block = surface_point(one, end).block;
        ASSERT_TRUE(block);
        EXPECT_EQ(*block, 3u);
        ++ends;
    }
    EXPECT_GT(ends, 25u);
}

TEST(CutReplay, CutsWhatWasNotForeseenAsUsual) {
    std::mt19937 rng(72);
    const Aabb box{{0, 0, 0}, {20, 16, 9}};
    for (int world = 0; world < 10; ++world) {
        RandomMoves moves(box, rng);
        std::vector<CutterSweep> sweeps;
        for (int i = 0; i < 30; ++i) sweeps.push_back(moves.next());
        CutModel one = box_model(box, 0.4);
        CutModel other = one, third = one;
        CutAhead ahead(other, 2);
        auto window = ahead.begin(sweeps);
        cut_all(ahead, *window);
        CutReplay replay(*window, 0, sweeps.size(), other);
        const auto skipped = static_cast<size_t>(world);
        // A cutter of the same shape from another maker is the same cutter.
        std::map<const Cutter*, std::shared_ptr<const Cutter>> copies;
        const auto alike = [&](CutterSweep sweep) {
            auto& copy = copies[sweep.cutter.get()];
            if (!copy) copy = std::make_shared<const Cutter>(*sweep.cutter);
            sweep.cutter = copy;
            return sweep;
        };
        for (size_t i = 0; i < sweeps.size(); ++i) {
            if (i == 20 + skipped) {
                const CutterSweep more = moves.next(); // not foreseen
                EXPECT_EQ(cut(one, more), replay.cut(other, alike(more)));
                replay.cut(third, more); // another model
            }
            replay.cut(third, sweeps[i]);
            if (i == skipped) { // made in another way
                TrialCut trial(other, alike(sweeps[i]));
                replay.skip(other, sweeps[i]);
                EXPECT_EQ(cut(one, sweeps[i]), trial.keep());
                continue;
            }
            EXPECT_EQ(cut(one, sweeps[i]), replay.cut(other, alike(sweeps[i])));
        }
        EXPECT_FALSE(replay.is_complete());
        EXPECT_EQ(test_support::digest(one), test_support::digest(other));
        EXPECT_EQ(test_support::digest(one), test_support::digest(third));
    }
}

TEST(CutReplay, TellsWhetherTheMovesWereThoseForeseen) {
    const Aabb box{{0, 0, 0}, {20, 16, 9}};
    std::mt19937 rng(73);
    RandomMoves moves(box, rng);
    const std::vector<CutterSweep> sweeps{moves.next(), moves.next()};
    CutModel model = box_model(box, 1.0);
    CutAhead ahead(model, 1);
    auto window = ahead.begin(sweeps);
    cut_all(ahead, *window);
    CutReplay replay(*window, 0, 2, model);
    EXPECT_FALSE(replay.is_complete());
    replay.cut(model, sweeps[0]);
    EXPECT_FALSE(replay.is_complete());
    replay.cut(model, sweeps[1]);
    EXPECT_TRUE(replay.is_complete());
    replay.cut(model, sweeps[1]);
    EXPECT_FALSE(replay.is_complete());
}

} // namespace
} // namespace core
