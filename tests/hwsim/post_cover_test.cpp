#include <gtest/gtest.h>

#include "core/dbm/cut_model.h"
#include "core/distance/outer_model.h"
#include "hwsim/post_cover.h"
#include "tests/support/stock_oracle.h"

namespace hwsim {
namespace {

bool holds(const Record& post, double x, double y, double z) {
    return std::abs(x - length_of(post.base[0])) <= length_of(post.half)
           && std::abs(y - length_of(post.base[1])) <= length_of(post.half)
           && z >= length_of(post.base[2]) && z <= length_of(post.base[2] + post.run);
}

/// Whether some column is no farther from the point than a sliver of a cell allows.
bool is_near_a_column(const ColumnCells& cells, double h, double x, double y, double z) {
    for (int j = 0; j < cells.columns->v_count(); ++j)
        for (int i = 0; i < cells.columns->u_count(); ++i) {
            const auto u = static_cast<size_t>(i), v = static_cast<size_t>(j);
            const double beside = h / 8.0 + 3 * lsb;
            if (x < cells.x[u] - beside || x > cells.x[u + 1] + beside) continue;
            if (y < cells.y[v] - beside || y > cells.y[v + 1] + beside) continue;
            for (const core::Interval& matter : cells.columns->line(i, j))
                if (z >= matter.lower - 2 * lsb && z <= matter.upper + 2 * lsb) return true;
        }
    return false;
}

/// Corners and middles of all columns, and of all posts.
void expect_cover(const ColumnCells& cells, double h) {
    const std::vector<Record> posts = posts_of(cells).value();
    for (int j = 0; j < cells.columns->v_count(); ++j)
        for (int i = 0; i < cells.columns->u_count(); ++i)
            for (const core::Interval& matter : cells.columns->line(i, j))
                for (const double share : {0.0, 0.5, 1.0})
                    for (const double z : {matter.lower, matter.upper}) {
                        const auto u = static_cast<size_t>(i), v = static_cast<size_t>(j);
                        const double x = std::lerp(cells.x[u], cells.x[u + 1], share);
                        const double y = std::lerp(cells.y[v], cells.y[v + 1], 1.0 - share);
                        ASSERT_TRUE(std::any_of(posts.begin(), posts.end(),
                                                [&](const Record& p) { return holds(p, x, y, z); }))
                            << i << " " << j;
                    }
    for (const Record& post : posts)
        for (const double share : {-1.0, 0.0, 1.0}) {
            const double x = length_of(post.base[0]) + share * length_of(post.half);
            const double y = length_of(post.base[1]) - share * length_of(post.half);
            ASSERT_TRUE(is_near_a_column(cells, h, x, y, length_of(post.base[2])));
            ASSERT_TRUE(is_near_a_column(cells, h, x, y, length_of(post.base[2] + post.run)));
        }
}

TEST(PostCover, HoldsTheColumnsAndLittleMore) {
    std::mt19937 rng(1);
    for (int i = 0; i < 12; ++i) {
        const double h = i % 2 ? 0.7 : 1.3;
        const core::CutModel stock = test_support::random_cut_box(rng, rng() % 6, 0.0).model(h);
        expect_cover(cells_of(stock), h);
    }
}

TEST(PostCover, HoldsTheColumnsOfAMesh) {
    const core::Cylinder cylinder{9.3, 7.1};
    const core::ScanGrid grid = scan_grid(bounds(core::Primitive(cylinder)), 0.9);
    const core::OuterModel model = outer_model(bounds(core::Primitive(cylinder)), grid,
                                               columns_of(core::Primitive(cylinder)), {2});
    expect_cover(cells_of(model).value(), 0.9);
}

TEST(PostCover, TakesFewPostsForAPlainBlock) {
    const test_support::CutBox world{{{0, 0, 0}, {80, 48, 20}}, 0.0, {}};
    const core::CutModel stock = world.uncut(0.5);
    const std::vector<Record> posts = posts_of(cells_of(stock)).value();
    EXPECT_GE(posts.size(), 11U * 7U); // tiles of 8 mm
    EXPECT_LE(posts.size(), 600U);     // of 15,617 columns; most stand along the border
}

TEST(PostCover, SplitsWhatIsTooHighForOneRecord) {
    const test_support::CutBox world{{{0, 0, 0}, {4, 4, 600}}, 0.0, {}};
    const core::CutModel stock = world.uncut(2.0);
    expect_cover(cells_of(stock), 2.0);
}

TEST(PostCover, RefusesWhatIsOutOfReach) {
    const test_support::CutBox world{{{2046, 0, 0}, {2050, 4, 6}}, 0.0, {}};
    EXPECT_FALSE(posts_of(cells_of(world.uncut(1.0))));
}

} // namespace
} // namespace hwsim
