#include "hwsim/stock_model.h"

#include <algorithm>
#include <cassert>
#include <tuple>

#include <fmt/format.h>

namespace hwsim {
namespace {

core::Result<LineRun> taken(ModelWriter& writer, uint32_t count) {
    const auto run = take(*writer.space, count);
    if (!run)
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("the models do not fit into the coprocessor's memory of {} "
                                      "lines; use a larger mesh size",
                                      writer.space->end));
    writer.runs.push_back(*run);
    return *run;
}

bool fits(const Record& record) {
    const Box box = box_of(record);
    for (size_t axis = 0; axis < 3; ++axis)
        if (!is_coordinate(box.min[axis]) || !is_coordinate(box.max[axis])) return false;
    const auto is_extent = [](int32_t x) { return x >= 0 && x <= Record::greatest_extent; };
    return is_extent(record.run) && is_extent(record.half);
}

/// Twice the centre of a record along an axis.
int64_t middle(const Record& record, size_t axis) {
    return 2 * int64_t{record.base[axis]} + (axis == 2 ? record.run : 0);
}

size_t longest_axis(std::span<const Record> records) {
    size_t longest = 0;
    int64_t length = -1;
    for (size_t axis = 0; axis < 3; ++axis) {
        int64_t min = middle(records[0], axis), max = min;
        for (const Record& record : records) {
            min = std::min(min, middle(record, axis));
            max = std::max(max, middle(record, axis));
        }
        if (max - min <= length) continue;
        longest = axis;
        length = max - min;
    }
    return longest;
}

core::Result<Branch> subtree(ModelWriter& writer, std::span<Record> records, uint32_t leaf_size) {
    if (records.size() <= leaf_size) return writer.add_leaf(records);
    const size_t axis = longest_axis(records);
    const auto by_position = [axis](const Record& r) {
        return std::tuple(middle(r, axis), middle(r, 0), middle(r, 1), middle(r, 2), r.run, r.half);
    };
    // Whole lines on the left, so that leaves are well filled.
    const size_t half =
        (records.size() / 2 + records_per_line - 1) / records_per_line * records_per_line;
    const size_t left = records.size() > size_t{2} * records_per_line ? half : records.size() / 2;
    const auto at = static_cast<std::ptrdiff_t>(left);
    std::nth_element(
        records.begin(), records.begin() + at, records.end(),
        [&](const Record& a, const Record& b) { return by_position(a) < by_position(b); });
    FEELER_TRY(const Branch a, subtree(writer, records.first(left), leaf_size));
    FEELER_TRY(const Branch b, subtree(writer, records.subspan(left), leaf_size));
    FEELER_TRY(Branch above, add_above(writer, a, b));
    if (writer.volumes == Volumes::spheres) above.volume = sphere_round(records, writer.side);
    return above;
}

/// The distance of the farther of two ends from a point on a line.
int64_t farthest(int64_t low, int64_t high, int64_t from) {
    return std::max(std::abs(low - from), std::abs(high - from));
}

int64_t squared_reach(const Box& box, const FixedVec& from) {
    int64_t squared = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t along = farthest(box.min[axis], box.max[axis], from[axis]);
        squared += along * along;
    }
    return squared;
}

/// The squared distance from a point to the farthest point of a record, not rounded down.
int64_t squared_reach(const Record& r, Side side, const FixedVec& from) {
    if (side == Side::work) return squared_reach(box_of(r), from);
    const int64_t up = farthest(r.base[2], int64_t{r.base[2]} + r.run, from[2]);
    const int64_t x = int64_t{r.base[0]} - from[0], y = int64_t{r.base[1]} - from[1];
    const int64_t level = root_up(x * x + y * y) + r.half;
    return level * level + up * up;
}

Box box_round(std::span<const Record> records) {
    Box box = box_of(records[0]);
    for (const Record& record : records) box.extend(box_of(record));
    return box;
}

FixedVec centre_of(const Box& box) {
    FixedVec centre{};
    for (size_t axis = 0; axis < 3; ++axis)
        centre[axis] = static_cast<int32_t>((int64_t{box.min[axis]} + box.max[axis]) >> 1);
    return centre;
}

Volume sphere_above(const Box& box, const Volume& a, const Volume& b) {
    const FixedVec centre = centre_of(box);
    const auto far_side = [&](const Volume& sphere) {
        return root_up(squared_reach(sphere.box, centre)) + sphere.radius;
    };
    const int64_t to_corners = root_up(squared_reach(box, centre));
    return {{centre, centre},
            static_cast<int32_t>(std::min(to_corners, std::max(far_side(a), far_side(b))))};
}

} // namespace

core::Result<uint32_t> ModelWriter::add(const Node& node) {
    FEELER_TRY(const LineRun run, taken(*this, 1));
    lines.push_back({run.first, packed(node, epoch, run.first)});
    return run.first;
}

core::Result<Branch> ModelWriter::add_leaf(std::span<const Record> records) {
    const auto count = static_cast<uint32_t>(records.size());
    FEELER_TRY(const LineRun run, taken(*this, leaf_lines(count)));
    Branch leaf{Reference::leaf(run.first, count), volume_of(records[0], side), {}};
    for (const Record& record : records) leaf.volume.extend(volume_of(record, side));
    if (volumes == Volumes::spheres) {
        leaf.box = box_round(records);
        leaf.volume = sphere_round(records, side);
    }
    for (uint32_t i = 0; i < run.count; ++i) {
        Records four{};
        const auto part = records.subspan(size_t{i} * records_per_line);
        std::copy_n(part.begin(), std::min<size_t>(records_per_line, part.size()), four.begin());
        lines.push_back({run.first + i, packed(four, epoch, run.first + i)});
    }
    return leaf;
}

Volume sphere_round(std::span<const Record> records, Side side) {
    const FixedVec centre = centre_of(box_round(records));
    int64_t squared = 0;
    for (const Record& record : records)
        squared = std::max(squared, squared_reach(record, side, centre));
    return {{centre, centre}, static_cast<int32_t>(root_up(squared))};
}

core::Result<Branch> add_tree(ModelWriter& writer, std::vector<Record> records,
                              uint32_t leaf_size) {
    if (records.empty() || leaf_size < 1 || leaf_size > Reference::most_records)
        return core::fail(core::ErrorCode::invalid_value,
                          "a model needs at least one record, and leaves of 1 to 32 records");
    if (!std::all_of(records.begin(), records.end(), fits))
        return core::fail(
            core::ErrorCode::invalid_value,
            "a model extends beyond the coprocessor's range of 2048 mm, or one of its "
            "records is larger than 256 mm");
    return subtree(writer, records, leaf_size);
}

core::Result<Branch> add_above(ModelWriter& writer, const Branch& a, const Branch& b) {
    if (a.reference.is_none()) return b;
    if (b.reference.is_none()) return a;
    FEELER_TRY(const uint32_t line,
               writer.add(Node{{a.volume, b.volume}, {a.reference, b.reference}}));
    Branch above{Reference::node(line), a.volume, a.box};
    if (writer.volumes == Volumes::spheres) {
        above.box.extend(b.box);
        above.volume = sphere_above(above.box, a.volume, b.volume);
    } else {
        above.volume.extend(b.volume);
    }
    return above;
}

core::Result<uint32_t> add_header(ModelWriter& writer, const Branch& root) {
    return writer.add(Node{{root.volume, root.volume}, {root.reference, Reference{}}});
}

namespace {

using core::ScanLines;

/// A rectangle of tiles, by their indices.
struct TileRange {
    size_t u0, u1, v0, v1;
};

/// One update, on copies: on an error the model is unchanged.
class Update {
public:
    Update(StockModel& model, LineSpace& space, const ScanLines& columns)
        : model_(model), columns_(columns), space_(space) {
        if (model.epoch == UINT32_MAX) begin_again();
        writer_ = {.space = &space_, .volumes = model_.volumes, .epoch = model_.epoch + 1};
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

    /// After the last epoch: no line of the model remains.
    void begin_again() {
        done_.released = lines_of(model_);
        model_.header.reset();
        for (auto* parts : {&model_.tiles, &model_.above})
            for (StockModel::Part& part : *parts) part.runs.clear();
        model_.epoch = 0;
    }

    /// Replaces the lines of a part by those that `make` creates.
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

    /// Halves the longer side. Parts above are numbered in order of traversal.
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

StockModel stock_model(const ColumnCells& cells, uint32_t leaf_size, Volumes volumes) {
    StockModel model{.columns = *cells.columns, .x = cells.x, .y = cells.y};
    model.tiles.resize(cells.columns->tile_count());
    model.above.resize(model.tiles.empty() ? 0 : 2 * model.tiles.size() - 1);
    model.leaf_size = leaf_size;
    model.volumes = volumes;
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
