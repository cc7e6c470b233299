#include "hwsim/post_cover.h"

#include <cmath>

#include "core/dbm/cut_model.h"
#include "core/distance/outer_model.h"

namespace hwsim {
namespace {

using core::ScanLines;

constexpr int side = ScanLines::tile_side;
constexpr int32_t most_squares = 4; // maximum in a row that covers a rectangle

struct FixedInterval {
    int32_t low, high;
    bool operator==(const FixedInterval&) const = default;
};
using FixedColumn = std::vector<FixedInterval>;

struct FixedRectangle {
    int32_t x0, x1, y0, y1;
};

/// The columns of a tile, rounded outwards, and their posts.
class TileCover {
public:
    TileCover(const ColumnCells& cells, size_t tile) : cells_(cells) {
        const int across = (cells.columns->u_count() + side - 1) / side;
        u_ = static_cast<int>(tile) % across * side;
        v_ = static_cast<int>(tile) / across * side;
    }

    core::Result<std::vector<Record>> run() {
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i)
                if (auto taken = take(i, j); !taken)
                    return tl::unexpected(std::move(taken).error());
        if (auto covered = cover(0, 0, side); !covered)
            return tl::unexpected(std::move(covered).error());
        return std::move(records_);
    }

private:
    bool is_there(int i, int j) const {
        return u_ + i < cells_.columns->u_count() && v_ + j < cells_.columns->v_count();
    }
    FixedColumn& column(int i, int j) {
        return columns_[static_cast<size_t>(j) * side + static_cast<size_t>(i)];
    }

    core::Result<void> take(int i, int j) {
        if (!is_there(i, j)) return {};
        for (const core::Interval& matter : cells_.columns->line(u_ + i, v_ + j)) {
            FEELER_TRY(const int32_t low, fixed(matter.lower, Rounding::down));
            FEELER_TRY(const int32_t high, fixed(matter.upper, Rounding::up));
            column(i, j).push_back({low, high});
        }
        return {};
    }

    /// Covers a block of columns by one stack of posts if they are equal, else quarter by quarter.
    core::Result<void> cover(int i0, int j0, int size) {
        if (!is_there(i0, j0)) return {};
        FEELER_TRY(const FixedRectangle r, rectangle(i0, j0, size));
        if (size > 1 && (is_slender(r) || !are_equal(i0, j0, size))) {
            const int half = size / 2;
            for (const int j : {j0, j0 + half})
                for (const int i : {i0, i0 + half})
                    if (auto covered = cover(i, j, half); !covered) return covered;
            return {};
        }
        for (const FixedInterval& heights : column(i0, j0)) add(r, heights);
        return {};
    }

    /// The existing cells of a block.
    core::Result<FixedRectangle> rectangle(int i0, int j0, int size) const {
        int i1 = i0 + size - 1, j1 = j0 + size - 1;
        while (!is_there(i1, j0)) --i1;
        while (!is_there(i0, j1)) --j1;
        FEELER_TRY(const int32_t x0, fixed(edge(cells_.x, u_ + i0), Rounding::down));
        FEELER_TRY(const int32_t x1, fixed(edge(cells_.x, u_ + i1 + 1), Rounding::up));
        FEELER_TRY(const int32_t y0, fixed(edge(cells_.y, v_ + j0), Rounding::down));
        FEELER_TRY(const int32_t y1, fixed(edge(cells_.y, v_ + j1 + 1), Rounding::up));
        return FixedRectangle{x0, x1, y0, y1};
    }

    static bool is_slender(const FixedRectangle& r) {
        const int32_t width = r.x1 - r.x0, depth = r.y1 - r.y0;
        return std::max(width, depth) / most_squares > std::min(width, depth);
    }

    bool are_equal(int i0, int j0, int size) {
        for (int j = j0; j < j0 + size; ++j)
            for (int i = i0; i < i0 + size; ++i)
                if (is_there(i, j) && column(i, j) != column(i0, j0)) return false;
        return true;
    }

    static double edge(const std::vector<double>& edges, int i) {
        return edges[static_cast<size_t>(i)];
    }

    /// A rectangle is covered by squares in a row.
    void add(const FixedRectangle& r, const FixedInterval& heights) {
        const int32_t width = r.x1 - r.x0, depth = r.y1 - r.y0;
        const int32_t longer = std::max(width, depth);
        int32_t square =
            std::max({std::min(width, depth), (longer + most_squares - 1) / most_squares, 1});
        square += square % 2; // so that its centre is a whole step
        const int32_t count = std::max((longer + square - 1) / square, 1);
        for (int32_t n = 0; n < count; ++n) {
            const auto position = [&](int32_t from, int32_t length) {
                if (length < square || count == 1) return from + length / 2;
                const int64_t room = length - square; // of the centres, end to end
                return static_cast<int32_t>(from + square / 2 + room * n / (count - 1));
            };
            add_stack({position(r.x0, width), position(r.y0, depth), heights.low}, square / 2,
                      heights);
        }
    }

    /// Splits a post that exceeds the number range.
    void add_stack(FixedVec base, int32_t half, const FixedInterval& heights) {
        int64_t low = heights.low;
        do {
            const int64_t run = std::min<int64_t>(heights.high - low, Record::greatest_extent);
            base[2] = static_cast<int32_t>(low);
            records_.push_back({base, static_cast<int32_t>(run), half});
            low += run;
        } while (low < heights.high);
    }

    const ColumnCells& cells_;
    int u_ = 0, v_ = 0;
    std::array<FixedColumn, static_cast<size_t>(side) * side> columns_;
    std::vector<Record> records_;
};

} // namespace

ColumnCells cells_of(const core::CutModel& stock) {
    ColumnCells cells{.columns = &stock.columns};
    const auto count = [](int cells_across) { return static_cast<size_t>(cells_across) + 1; };
    cells.x.assign(stock.corners[0].begin(),
                   stock.corners[0].begin()
                       + static_cast<std::ptrdiff_t>(count(stock.columns.u_count())));
    cells.y.assign(stock.corners[1].begin(),
                   stock.corners[1].begin()
                       + static_cast<std::ptrdiff_t>(count(stock.columns.v_count())));
    return cells;
}

core::Result<ColumnCells> cells_of(const core::OuterModel& model) {
    for (const core::ScanLines& family : model.families) {
        if (family.axis() != 2) continue;
        ColumnCells cells{.columns = &family};
        for (int i = 0; i < family.u_count(); ++i) cells.x.push_back(cell_of(model, 0, i).lower);
        for (int j = 0; j < family.v_count(); ++j) cells.y.push_back(cell_of(model, 1, j).lower);
        cells.x.push_back(cell_of(model, 0, family.u_count() - 1).upper);
        cells.y.push_back(cell_of(model, 1, family.v_count() - 1).upper);
        return cells;
    }
    return core::fail(core::ErrorCode::invalid_value, "the outer model has no columns along Z");
}

core::Result<std::vector<Record>> posts_of_tile(const ColumnCells& cells, size_t tile) {
    return TileCover(cells, tile).run();
}

core::Result<std::vector<Record>> posts_of(const ColumnCells& cells) {
    std::vector<Record> records;
    for (size_t tile = 0; tile < cells.columns->tile_count(); ++tile) {
        if (!cells.columns->tile(tile)) continue;
        FEELER_TRY(const std::vector<Record> more, posts_of_tile(cells, tile));
        records.insert(records.end(), more.begin(), more.end());
    }
    return records;
}

} // namespace hwsim
