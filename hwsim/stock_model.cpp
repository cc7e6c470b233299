#include "hwsim/stock_model.h"

#include <cassert>

namespace hwsim {
namespace {

using core::ScanLines;

/// A rectangle of tiles, by their places.
struct TileRange {
    size_t u0, u1, v0, v1;
};

/// One update, on copies: a model that could not be written stays as it was.
class Update {
public:
    Update(StockModel& model, LineSpace& space, const ScanLines& columns)
        : model_(model), columns_(columns), space_(space) {
        writer_ = {.space = &space_, .epoch = model.epoch + 1};
        across_ = tiles_along(columns.u_count());
    }

    core::Result<StockUpdate> run(StockModel& model, LineSpace& space) {
        const TileRange all{0, across_, 0, tiles_along(columns_.v_count())};
        FEELER_TRY(const bool changed, refresh(all));
        (void)changed;
        const Branch root = model_.above.empty() ? Branch{} : model_.above[0].branch;
        FEELER_TRY(const uint32_t header, add_header(writer_, root));
        if (model_.header) done_.released.push_back({*model_.header, 1});
        model_.header = done_.header = header;
        model_.epoch = done_.epoch = writer_.epoch;
        model_.columns = columns_;
        done_.lines = std::move(writer_.lines);
        model = std::move(model_);
        space = std::move(space_);
        return std::move(done_);
    }

private:
    static size_t tiles_along(int lines) {
        return (static_cast<size_t>(lines) + ScanLines::tile_side - 1) / ScanLines::tile_side;
    }

    bool is_changed(size_t tile) const {
        return !model_.header || columns_.tile(tile) != model_.columns.tile(tile);
    }

    /// What `make` puts into the memory takes the place of a part's lines.
    template <typename Make>
    core::Result<void> replace(StockModel::Part& part, const Make& make) {
        done_.released.insert(done_.released.end(), part.runs.begin(), part.runs.end());
        const size_t before = writer_.runs.size();
        FEELER_TRY(part.branch, make());
        const auto first = writer_.runs.begin() + static_cast<std::ptrdiff_t>(before);
        part.runs.assign(first, writer_.runs.end());
        return {};
    }

    core::Result<Branch> tile_tree(size_t tile) {
        const ColumnCells cells{&columns_, model_.x, model_.y};
        FEELER_TRY(std::vector<Record> posts, posts_of_tile(cells, tile));
        if (posts.empty()) return Branch{};
        return add_tree(writer_, std::move(posts), model_.leaf_size);
    }

    core::Result<bool> refresh_tile(size_t tile, StockModel::Part& above) {
        if (!is_changed(tile)) return false;
        ++done_.tiles;
        StockModel::Part& part = model_.tiles[tile];
        if (auto made = replace(part, [&] { return tile_tree(tile); }); !made)
            return tl::unexpected(std::move(made).error());
        above.branch = part.branch;
        return true;
    }

    /// Halves the longer side. Parts above are counted as they are met.
    core::Result<bool> refresh(const TileRange& r) {
        const size_t own = next_++;
        const size_t width = r.u1 - r.u0, depth = r.v1 - r.v0;
        if (width * depth == 1) return refresh_tile(r.v0 * across_ + r.u0, model_.above[own]);
        TileRange a = r, b = r;
        if (width >= depth)
            a.u1 = b.u0 = r.u0 + width / 2;
        else
            a.v1 = b.v0 = r.v0 + depth / 2;
        const size_t left = next_;
        FEELER_TRY(const bool left_changed, refresh(a));
        const size_t right = next_;
        FEELER_TRY(const bool right_changed, refresh(b));
        if (!left_changed && !right_changed) return false;
        const auto join = [&] {
            return add_above(writer_, model_.above[left].branch, model_.above[right].branch);
        };
        if (auto made = replace(model_.above[own], join); !made)
            return tl::unexpected(std::move(made).error());
        return true;
    }

    StockModel model_;
    const ScanLines& columns_;
    LineSpace space_;
    ModelWriter writer_;
    StockUpdate done_;
    size_t across_ = 0, next_ = 0;
};

} // namespace

StockModel stock_model(const ColumnCells& cells, uint32_t leaf_size) {
    StockModel model{.columns = *cells.columns, .x = cells.x, .y = cells.y};
    model.tiles.resize(cells.columns->tile_count());
    model.above.resize(model.tiles.empty() ? 0 : 2 * model.tiles.size() - 1);
    model.leaf_size = leaf_size;
    return model;
}

std::vector<LineRun> lines_of(const StockModel& model) {
    std::vector<LineRun> runs;
    if (model.header) runs.push_back({*model.header, 1});
    for (const auto* parts : {&model.tiles, &model.above})
        for (const StockModel::Part& part : *parts)
            runs.insert(runs.end(), part.runs.begin(), part.runs.end());
    return runs;
}

bool is_current(const StockModel& model, const ScanLines& columns) {
    if (!model.header) return false;
    for (size_t tile = 0; tile < model.tiles.size(); ++tile)
        if (columns.tile(tile) != model.columns.tile(tile)) return false;
    return true;
}

core::Result<StockUpdate> update(StockModel& model, LineSpace& space, const ScanLines& columns) {
    assert(columns.u_count() == model.columns.u_count()
           && columns.v_count() == model.columns.v_count());
    return Update(model, space, columns).run(model, space);
}

} // namespace hwsim
