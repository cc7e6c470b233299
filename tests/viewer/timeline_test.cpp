#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "app/view/model/timeline.h"
#include "tests/viewer/rows.h"

namespace {

using namespace app::viewer;

std::vector<BlockRow> random_rows(size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    std::exponential_distribution<double> clearance(0.2);
    std::vector<BlockRow> rows;
    for (size_t i = 0; i < count; ++i) {
        rows.push_back(viewer_test::row_with(clearance(random)));
        if (random() % 9 == 0) rows.back() = BlockRow();
    }
    return rows;
}

MinimumTree tree_of(const std::vector<BlockRow>& rows) {
    MinimumTree tree;
    // As it grows while a program is checked.
    for (size_t i = 0; i < rows.size(); ++i) {
        if (tree.size() <= i) tree.resize(std::min(rows.size(), i + 1 + i / 3));
        tree.set(i, cell_of(rows[i]));
    }
    return tree;
}

TimelineCell slow_cell(const std::vector<BlockRow>& rows, size_t first, size_t last) {
    TimelineCell cell;
    for (size_t i = first; i < std::min(last, rows.size()); ++i)
        cell = merged(cell, cell_of(rows[i]));
    return cell;
}

TEST(Timeline, EveryPixelHasTheMinimumOfItsBlocks) {
    const auto rows = random_rows(1237, 1);
    const MinimumTree tree = tree_of(rows);
    std::mt19937 random(2);
    size_t offending = 0, calm = 0;
    for (int round = 0; round < 200; ++round) {
        TimelineRange range = whole(rows.size());
        range = zoomed(range, rows.size(), 0.01 * (random() % 100), 0.01 * (1 + random() % 100));
        const size_t pixels = 1 + random() % 900;
        const auto cells = columns(tree, range, pixels);
        ASSERT_EQ(cells.size(), pixels);
        const double step = range.width() / static_cast<double>(pixels);
        for (size_t i = 0; i < pixels; ++i) {
            const double begin = range.first + static_cast<double>(i) * step;
            const auto first = static_cast<size_t>(begin);
            const auto last = std::max(static_cast<size_t>(std::ceil(begin + step)), first + 1);
            const TimelineCell slow = slow_cell(rows, first, last);
            ASSERT_EQ(cells[i], slow) << round << ' ' << i;
            slow.offending ? ++offending : ++calm;
        }
    }
    EXPECT_GT(offending, 1000U);
    EXPECT_GT(calm, 1000U);
}

TEST(Timeline, NoViolationIsLostHoweverFewPixelsThereAre) {
    std::vector<BlockRow> rows(50000, viewer_test::row_with(9.0));
    rows[31234] = viewer_test::row_with(0.1);
    const auto cells = columns(tree_of(rows), whole(rows.size()), 700);
    EXPECT_EQ(std::count_if(cells.begin(), cells.end(), [](const auto& c) { return c.offending; }),
              1);
}

TEST(Timeline, ZoomKeepsTheBlockUnderTheCursor) {
    TimelineRange range = whole(1000);
    for (int i = 0; i < 12; ++i) {
        const size_t before = block_at(range, 1000, 0.3);
        range = zoomed(range, 1000, 0.3, 0.8);
        EXPECT_NEAR(static_cast<double>(block_at(range, 1000, 0.3)), static_cast<double>(before),
                    1.0);
    }
    for (int i = 0; i < 60; ++i) range = zoomed(range, 1000, 0.9, 0.5);
    EXPECT_DOUBLE_EQ(range.width(), 10.0);
    for (int i = 0; i < 60; ++i) range = zoomed(range, 1000, 0.1, 2.0);
    EXPECT_EQ(range, whole(1000));
}

TEST(Timeline, ShowsABlockWithoutMovingMoreThanNeeded) {
    const TimelineRange range{100.0, 150.0};
    EXPECT_EQ(showing(range, 1000, 120), range);
    EXPECT_EQ(showing(range, 1000, 150), (TimelineRange{101.0, 151.0}));
    EXPECT_EQ(showing(range, 1000, 7), (TimelineRange{7.0, 57.0}));
}

TEST(Timeline, PositionAndBlockAreInverse) {
    const TimelineRange range{17.0, 92.0};
    for (size_t block = 17; block < 92; ++block)
        EXPECT_EQ(block_at(range, 1000, column_of(range, block)), block);
}

TEST(Timeline, BandsCoverEveryBlockOnce) {
    auto rows = random_rows(300, 5);
    for (size_t i = 0; i < rows.size(); ++i)
        if (i > 20) rows[i].tool = core::ToolNumber(static_cast<int>(i / 70));
    size_t next = 0;
    for (const ToolBand& band : tool_bands(rows)) {
        EXPECT_EQ(band.first, next);
        for (size_t i = band.first; i < band.last; ++i) EXPECT_EQ(rows[i].tool, band.tool);
        next = band.last;
    }
    EXPECT_EQ(next, rows.size());
}

} // namespace
