#include <gtest/gtest.h>

#include "core/dbm/cut_model.h"
#include "hwsim/search.h"
#include "hwsim/stock_model.h"
#include "tests/hwsim/random_models.h"
#include "tests/support/stock_oracle.h"

namespace hwsim {
namespace {

constexpr uint32_t tool_header = 1;

/// A memory with a small tool and a stock that is being cut.
struct Workshop {
    std::vector<Line> memory = std::vector<Line>(40'000);
    LineSpace space{.next = 10, .end = 40'000};
    core::CutModel stock;
    StockModel model;

    explicit Workshop(double h) {
        const test_support::CutBox world{{{-40, -30, -10}, {40, 30, 0}}, 0.0, {}};
        stock = world.uncut(h);
        model = stock_model(cells_of(stock));
        memory[2] = packed(Records{Record{{0, 0, 0}, 20'000, 9'000}}, 0, 2);
        const Volume box{{{0, 0, 0}, {0, 0, 20'000}}, 9'000};
        memory[tool_header] =
            packed(Node{{box, box}, {Reference::leaf(2, 1), Reference{}}}, 0, tool_header);
    }

    StockUpdate take_over() {
        StockUpdate done = update(model, space, stock.columns).value();
        for (const AddressedLine& line : done.lines) memory[line.address] = line.line;
        return done;
    }

    void cut(std::mt19937& rng) {
        static const std::vector<core::RevolvedProfile> tools = test_support::cutters();
        const core::Vec3 from = test_support::random_point({{-40, -30, -6}, {40, 30, 0}}, rng);
        const core::Vec3 to = from + test_support::random_point({{-3, -3, -1}, {3, 3, 1}}, rng);
        const auto cutter =
            std::make_shared<core::Cutter>(core::make_cutter(tools[rng() % tools.size()], 0.0));
        core::cut(stock, {cutter, from, to});
    }

    Answer ask(const Segment& segment, uint32_t header, uint32_t epoch) const {
        return search(memory, {.segment = segment,
                               .tool_header = tool_header,
                               .work_header = header,
                               .work_epoch = epoch,
                               .limit = beyond_all_squares});
    }
};

Segment segment_over_the_stock(std::mt19937& rng) {
    const auto position = [&] {
        const core::Vec3 p = test_support::random_point({{-45, -35, -3}, {45, 35, 3}}, rng);
        FixedVec v{};
        for (int axis = 0; axis < 3; ++axis)
            v[static_cast<size_t>(axis)] = fixed(p[axis], Rounding::nearest).value();
        return v;
    };
    const FixedVec start = position();
    return {.log2_steps = static_cast<uint8_t>(rng() % 9),
            .start = start,
            .end = rng() % 2 ? start : position()};
}

TEST(StockModel, AfterCutsAnswersAsOneMadeAfresh) {
    std::mt19937 rng(1);
    Workshop kept(1.0);
    kept.take_over();
    int rebuilt = 0, nearer = 0;
    for (int i = 0; i < 60; ++i) {
        for (unsigned n = 1 + rng() % 5; n > 0; --n) kept.cut(rng);
        rebuilt += static_cast<int>(kept.take_over().tiles);
        Workshop fresh(1.0);
        fresh.stock = kept.stock;
        fresh.take_over();
        for (int k = 0; k < 20; ++k) {
            const Segment s = segment_over_the_stock(rng);
            const Answer a = kept.ask(s, *kept.model.header, kept.model.epoch);
            const Answer b = fresh.ask(s, *fresh.model.header, fresh.model.epoch);
            ASSERT_EQ(a.squared, b.squared);
            ASSERT_EQ(a.stop, Stop::none);
            nearer += a.squared > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(rebuilt, 60);
    EXPECT_LT(rebuilt, 60 * 12); // of 24 tiles
    EXPECT_GT(nearer, 100);
}

TEST(StockModel, LeavesTheStockOfBeforeAsItWas) {
    std::mt19937 rng(2);
    Workshop shop(1.0);
    StockUpdate before = shop.take_over();
    int differ = 0;
    for (int i = 0; i < 60; ++i) {
        std::vector<std::pair<Segment, Answer>> asked;
        for (int k = 0; k < 400; ++k) {
            const Segment s = segment_over_the_stock(rng);
            asked.emplace_back(s, shop.ask(s, before.header, before.epoch));
        }
        for (int n = 0; n < 4; ++n) shop.cut(rng);
        const StockUpdate after = shop.take_over();
        for (const auto& [segment, answer] : asked) {
            ASSERT_EQ(shop.ask(segment, before.header, before.epoch), answer);
            const Answer now = shop.ask(segment, after.header, after.epoch);
            ASSERT_GE(now.squared, answer.squared);
            differ += now.squared > answer.squared ? 1 : 0;
        }
        for (const LineRun& run : after.released) give_back(shop.space, run);
        before = after;
    }
    EXPECT_GT(differ, 20);
}

TEST(StockModel, UsesItsLinesAgain) {
    std::mt19937 rng(3);
    Workshop shop(2.0);
    shop.take_over();
    uint32_t used = 0;
    for (int i = 0; i < 400; ++i) {
        shop.cut(rng);
        for (const LineRun& run : shop.take_over().released) give_back(shop.space, run);
        if (i == 200) used = shop.space.next;
    }
    EXPECT_LT(shop.space.next, used + used / 2);
}

TEST(StockModel, WritesNothingWhereNothingWasCut) {
    Workshop shop(1.0);
    shop.take_over();
    const StockUpdate again = shop.take_over();
    EXPECT_EQ(again.tiles, 0U);
    EXPECT_EQ(again.lines.size(), 1U); // the header
}

TEST(StockModel, WritesEveryUpdateInAnEpochOfItsOwn) {
    std::mt19937 rng(5);
    Workshop shop(1.0);
    for (uint32_t epoch = 1; epoch < 10; ++epoch) {
        const StockUpdate done = shop.take_over();
        ASSERT_EQ(done.epoch, epoch);
        ASSERT_EQ(shop.model.epoch, epoch);
        for (const AddressedLine& line : done.lines) ASSERT_EQ(epoch_of(line.line), epoch);
        shop.cut(rng);
    }
}

TEST(StockModel, StaysAsItWasWhenTheMemoryIsFull) {
    std::mt19937 rng(4);
    Workshop shop(1.0);
    shop.take_over();
    for (int i = 0; i < 10; ++i) shop.cut(rng);
    LineSpace none{.next = 100, .end = 102};
    const StockModel before = shop.model;
    EXPECT_FALSE(update(shop.model, none, shop.stock.columns));
    EXPECT_EQ(none.next, 100U);
    EXPECT_EQ(shop.model.header, before.header);
    EXPECT_EQ(shop.model.epoch, before.epoch);
    const StockUpdate done = shop.take_over();
    EXPECT_GT(done.tiles, 0U);
}

TEST(StockModel, IsEmptyWhenEverythingIsCut) {
    const test_support::CutBox world{{{-2, -2, -2}, {2, 2, 2}}, 0.0, {}};
    Workshop shop(1.0);
    shop.stock = world.uncut(1.0);
    shop.model = stock_model(cells_of(shop.stock));
    shop.take_over();
    const Segment here{};
    EXPECT_TRUE(shop.ask(here, *shop.model.header, shop.model.epoch).found);
    const core::RevolvedProfile large{{{0, 30, 50, 30, 0}}};
    core::cut(
        shop.stock,
        {std::make_shared<core::Cutter>(core::make_cutter(large, 0.0)), {0, 0, -10}, {0, 0, -10}});
    shop.take_over();
    const Answer answer = shop.ask(here, *shop.model.header, shop.model.epoch);
    EXPECT_FALSE(answer.found);
    EXPECT_EQ(answer.stop, Stop::none);
}

/// Over the last epoch and on: every answer is that of a model made afresh, and no line is lost.
TEST(StockModel, GoesOnAfterTheLastEpoch) {
    std::mt19937 rng(21);
    Workshop shop(2.0);
    shop.take_over();
    shop.model.epoch = UINT32_MAX - 3;
    for (int round = 0; round < 8; ++round) {
        shop.cut(rng);
        const StockUpdate done = shop.take_over();
        EXPECT_EQ(done.epoch, round < 3 ? UINT32_MAX - 2 + static_cast<uint32_t>(round)
                                        : static_cast<uint32_t>(round) - 2);
        for (const LineRun& run : done.released) give_back(shop.space, run);
        Workshop fresh(2.0);
        fresh.model = stock_model(cells_of(shop.stock));
        fresh.stock = shop.stock;
        const StockUpdate other = fresh.take_over();
        for (int i = 0; i < 30; ++i) {
            const Segment way = segment_over_the_stock(rng);
            const Answer a = shop.ask(way, done.header, done.epoch);
            ASSERT_EQ(a.stop, Stop::none);
            ASSERT_EQ(a.squared, fresh.ask(way, other.header, other.epoch).squared);
        }
    }
    uint32_t used = 0;
    for (const LineRun& run : lines_of(shop.model)) used += run.count;
    uint32_t returned = 0;
    for (uint32_t length = 1; length < shop.space.returned.size(); ++length)
        returned += length * static_cast<uint32_t>(shop.space.returned[length].size());
    EXPECT_EQ(used + returned, shop.space.next - 10);
}

} // namespace
} // namespace hwsim
