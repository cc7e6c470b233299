#include <random>

#include <gtest/gtest.h>

#include "core/dbm/earlier_model.h"
#include "core/dbm/tile_cutting.h"
#include "tests/support/random_moves.h"
#include "tests/support/stock_digest.h"

namespace core {
namespace {

using test_support::RandomMoves;

/// Expects that the boxes of a model contain its material.
void expect_boxes_around_material(const CutModel& model) {
    for (int family = 0; family < families; ++family) {
        const TileBoxes& boxes = boxes_of(model, family);
        for (size_t tile = 0; tile < boxes.boxes.size(); ++tile) {
            const Aabb exact =
                fitted_box(boxes, family_of(model, family), positions_of(model, family), tile);
            if (exact.empty()) continue;
            ASSERT_EQ(boxes.boxes[tile].min, exact.min) << family << ' ' << tile;
            ASSERT_EQ(boxes.boxes[tile].max, exact.max) << family << ' ' << tile;
        }
    }
}

TEST(EarlierModel, HoldsWhatTheMovesUpToThereHaveLeft) {
    std::mt19937 rng(72);
    for (int world = 0; world < 10; ++world) {
        SCOPED_TRACE(world);
        const Aabb box{{0, 0, 0}, {40.0 + world, 26, 9}};
        const bool has_columns = world % 3 != 0;
        const CutModel raw = make_cut_model({SolidBox{box}, 0.0}, 0.5, default_memory_limit,
                                            has_columns ? WithColumns::yes : WithColumns::no)
                                 .value();
        RandomMoves moves(box, rng);
        CutModel model = raw;
        // A copy of every state, by the number of its moves.
        std::vector<CutModel> states = {model};
        while (model.log.size() < 120) {
            const size_t before = model.log.size();
            cut(model, moves.next());
            if (model.log.size() > before) states.push_back(model);
        }
        for (const size_t number :
             {size_t{0}, size_t{1}, rng() % 60, 60 + rng() % 59, size_t{119}, size_t{120}}) {
            SCOPED_TRACE(number);
            const auto earlier = earlier_model(model, raw, number, 120);
            ASSERT_TRUE(earlier);
            EXPECT_EQ(test_support::digest(*earlier), test_support::digest(states[number]));
            ASSERT_EQ(earlier->log.size(), number);
            for (size_t i = 0; i < number; ++i) {
                EXPECT_EQ(earlier->log.mark(i), model.log.mark(i));
                EXPECT_EQ(earlier->log.index_of(model.log.mark(i)), i);
            }
            for (size_t tile = 0; tile < earlier->history.size(); ++tile) {
                const SharedLog<SweepRun>& now = earlier->history[tile];
                const SharedLog<SweepRun>& then = states[number].history[tile];
                ASSERT_EQ(now.size(), then.size());
                for (size_t i = 0; i < now.size(); ++i) {
                    EXPECT_EQ(now[i].first, then[i].first);
                    EXPECT_EQ(now[i].last, then[i].last);
                }
            }
            expect_boxes_around_material(*earlier);
            // It goes on like any other model.
            CutModel one = *earlier, other = states[number];
            for (int i = 0; i < 10; ++i) {
                const CutterSweep sweep = moves.next();
                cut(one, sweep);
                cut(other, sweep);
            }
            EXPECT_EQ(one.log.size(), other.log.size());
            EXPECT_EQ(model.log.size(), 120U);
        }
    }
}

TEST(EarlierModel, IsNotMadeIfTooMuchWouldBeCutAgain) {
    const CutModel raw = make_cut_model({SolidBox{{{0, 0, -10}, {20, 20, 0}}}, 0.0}, 0.5).value();
    const auto cutter =
        std::make_shared<const Cutter>(make_cutter(RevolvedProfile{{{0, 3, 30, 3, 0}}}, 0.0));
    CutModel model = raw;
    for (int i = 0; i < 5; ++i) cut(model, {cutter, {0, 10, -1.0 - i}, {20, 10, -1.0 - i}});
    EXPECT_FALSE(earlier_model(model, raw, 4, 3));
    EXPECT_TRUE(earlier_model(model, raw, 4, 4));
}

} // namespace
} // namespace core
