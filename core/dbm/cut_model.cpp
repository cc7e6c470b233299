#include "core/dbm/cut_model.h"

namespace core {
namespace {

/// The lines of a family whose place along `axis` lies within lower .. upper.
std::pair<int, int> lines_between(const ScanGrid& grid, int axis, double lower, double upper) {
    const double first = grid.coordinate(axis, 0);
    const double last = grid.count(axis);
    const double from = std::ceil((lower - first) / grid.spacing);
    const double to = std::floor((upper - first) / grid.spacing) + 1.0;
    return {static_cast<int>(std::clamp(from, 0.0, last)),
            static_cast<int>(std::clamp(to, 0.0, last))};
}

LineRange lines_in(const Dbm& dbm, int axis, const Aabb& box) {
    const int ua = u_axis(axis), va = v_axis(axis);
    const auto [u0, u1] = lines_between(dbm.grid, ua, box.min[ua], box.max[ua]);
    const auto [v0, v1] = lines_between(dbm.grid, va, box.min[va], box.max[va]);
    return {u0, u1, v0, v1};
}

/// The cells that `box` meets.
LineRange cells_in(const CutModel& model, const Aabb& box) {
    const double h = model.lines.grid.spacing;
    const LineRange lines = lines_in(model.lines, 2, box.grown(h));
    // Cell i lies between lines i - 1 and i; the lines beyond the last one are not in the range.
    return {lines.u_first, std::min(lines.u_last + 1, model.columns.u_count()), lines.v_first,
            std::min(lines.v_last + 1, model.columns.v_count())};
}

Aabb box_of_line(const Dbm& dbm, int axis, int u, int v) {
    Aabb box;
    const LineView line = dbm.families[static_cast<size_t>(axis)].line(u, v);
    if (line.empty()) return box;
    box.extend(point_on_line(dbm.grid, axis, u, v, line[0].lower));
    box.extend(point_on_line(dbm.grid, axis, u, v, line[line.size() - 1].upper));
    return box;
}

Aabb box_of_column(const CutModel& model, int i, int j) {
    const LineView column = model.columns.line(i, j);
    if (column.empty()) return {};
    const Square s = cell_square(model, i, j);
    return {{s.x0, s.y0, column[0].lower}, {s.x1, s.y1, column[column.size() - 1].upper}};
}

/// Fits the box of the block round line (u, v).
template <typename BoxOf>
void refit_block(const ScanLines& lines, TileBoxes& tiles, int u, int v, const BoxOf& box_of) {
    constexpr int side = TileBoxes::block_side;
    Aabb box;
    for (int j = v / side * side; j < std::min((v / side + 1) * side, lines.v_count()); ++j)
        for (int i = u / side * side; i < std::min((u / side + 1) * side, lines.u_count()); ++i)
            box.extend(box_of(i, j));
    tiles.blocks[tiles.block_index(u, v)] = box;
}

/// Fits the boxes of all blocks and tiles that a range of lines touches.
template <typename BoxOf>
void refit(const ScanLines& lines, TileBoxes& tiles, const LineRange& touched,
           const BoxOf& box_of) {
    constexpr int small = TileBoxes::block_side, large = ScanLines::tile_side;
    for (int v = touched.v_first / small * small; v < touched.v_last; v += small)
        for (int u = touched.u_first / small * small; u < touched.u_last; u += small)
            refit_block(lines, tiles, u, v, box_of);
    for (int v = touched.v_first / large * large; v < touched.v_last; v += large) {
        for (int u = touched.u_first / large * large; u < touched.u_last; u += large) {
            const size_t tile = tiles.index(u, v);
            Aabb box;
            for (size_t block = 0; block < TileBoxes::blocks_per_tile; ++block)
                box.extend(tiles.blocks[tile * TileBoxes::blocks_per_tile + block]);
            tiles.boxes[tile] = box;
        }
    }
}

void refit_lines(CutModel& model, int axis, const LineRange& touched) {
    const auto family = static_cast<size_t>(axis);
    refit(model.lines.families[family], model.line_boxes[family], touched,
          [&](int u, int v) { return box_of_line(model.lines, axis, u, v); });
}

void refit_columns(CutModel& model, const LineRange& touched) {
    refit(model.columns, model.column_boxes, touched,
          [&](int u, int v) { return box_of_column(model, u, v); });
}

/// Whether a line or column holds anything within lower .. upper.
bool reaches_into(const LineView& matter, double lower, double upper) {
    return !matter.empty() && matter[0].lower < upper && matter[matter.size() - 1].upper > lower;
}

/// Takes the sweep out of one family and returns the volume that it says is gone.
double cut_lines(CutModel& model, int axis, const LoggedSweep& logged, const LineRange& range) {
    const ScanGrid& grid = model.lines.grid;
    ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
    const double low = logged.box.min[axis], high = logged.box.max[axis];
    double length = 0.0;
    for (int v = range.v_first; v < range.v_last; ++v) {
        for (int u = range.u_first; u < range.u_last; ++u) {
            for (const Cutter::Piece& piece : logged.sweep.cutter->pieces) {
                const LineView line = family.line(u, v);
                if (!reaches_into(line, low, high)) break;
                const auto gone = line_interval(piece.around, logged.sweep, axis,
                                                grid.coordinate(u_axis(axis), u),
                                                grid.coordinate(v_axis(axis), v));
                if (gone && reaches_into(line, gone->lower, gone->upper))
                    length += family.edit(u, v).subtract(*gone);
            }
        }
    }
    return length * grid.spacing * grid.spacing;
}

/// What one convex piece sweeps on the lines through the corners of a row of cells.
using CornerRow = std::vector<std::optional<Interval>>;

CornerRow corner_row(const CutModel& model, const RevolvedProfile& within, const CutterSweep& sweep,
                     const LineRange& cells, double y) {
    CornerRow row;
    for (int i = cells.u_first; i < cells.u_last; ++i)
        row.push_back(line_interval(within, sweep, 2, cell_square(model, i, 0).x0, y));
    row.push_back(line_interval(within, sweep, 2, cell_square(model, cells.u_last - 1, 0).x1, y));
    return row;
}

/// The heights covered over a whole cell: those that all four of its corners share.
std::optional<Interval> shared_by(const CornerRow& front, const CornerRow& back, size_t cell) {
    std::optional<Interval> common = front[cell];
    for (const auto& corner : {front[cell + 1], back[cell], back[cell + 1]}) {
        if (!common || !corner) return std::nullopt;
        common = Interval{std::max(common->lower, corner->lower),
                          std::min(common->upper, corner->upper)};
    }
    return safely_within(common);
}

/// Takes a convex piece out of the columns; returns whether any changed.
bool cut_columns(CutModel& model, const RevolvedProfile& within, const LoggedSweep& logged,
                 const LineRange& cells) {
    bool changed = false;
    CornerRow front =
        corner_row(model, within, logged.sweep, cells, cell_square(model, 0, cells.v_first).y0);
    for (int j = cells.v_first; j < cells.v_last; ++j) {
        CornerRow back =
            corner_row(model, within, logged.sweep, cells, cell_square(model, 0, j).y1);
        for (int i = cells.u_first; i < cells.u_last; ++i) {
            const auto gone = shared_by(front, back, static_cast<size_t>(i - cells.u_first));
            if (!gone || !reaches_into(model.columns.line(i, j), gone->lower, gone->upper))
                continue;
            model.columns.edit(i, j).subtract(*gone);
            changed = true;
        }
        front = std::move(back);
    }
    return changed;
}

/// Notes the sweep for all tiles of columns that it may have touched; false when there are none.
bool log_sweep(CutModel& model, const LoggedSweep& logged, const LineRange& range) {
    constexpr int side = ScanLines::tile_side;
    const auto number = static_cast<uint32_t>(model.log.size());
    bool noted = false;
    for (int v = range.v_first / side * side; v < range.v_last; v += side) {
        for (int u = range.u_first / side * side; u < range.u_last; u += side) {
            const size_t tile = model.column_boxes.index(u, v);
            if (!overlaps(model.column_boxes.boxes[tile], logged.box)) continue;
            model.history[tile].push_back(number);
            noted = true;
        }
    }
    if (noted) model.log.push_back(logged);
    return noted;
}

/// Runs `act` over the logged sweeps that may reach into a square of cell (i, j).
template <typename Act>
void for_sweeps_over(const CutModel& model, int i, int j, const Square& square, const Act& act) {
    const SharedLog<uint32_t>& numbers = model.history[model.column_boxes.index(i, j)];
    for (size_t k = 0; k < numbers.size(); ++k) {
        const LoggedSweep& logged = model.log[numbers[k]];
        if (logged.box.min.x <= square.x1 && logged.box.max.x >= square.x0
            && logged.box.min.y <= square.y1 && logged.box.max.y >= square.y0)
            act(logged.sweep);
    }
}

} // namespace

LineRange lines_of_tile(const ScanLines& lines, const TileBoxes& tiles, size_t tile) {
    constexpr int side = ScanLines::tile_side;
    const int u = static_cast<int>(tile % static_cast<size_t>(tiles.u_tiles)) * side;
    const int v = static_cast<int>(tile / static_cast<size_t>(tiles.u_tiles)) * side;
    return {u, std::min(u + side, lines.u_count()), v, std::min(v + side, lines.v_count())};
}

LineRange lines_of_block(const ScanLines& lines, const TileBoxes& tiles, size_t tile,
                         size_t block) {
    const LineRange whole = lines_of_tile(lines, tiles, tile);
    const int side = TileBoxes::block_side;
    const int u = whole.u_first + static_cast<int>(block) % TileBoxes::blocks_per_side * side;
    const int v = whole.v_first + static_cast<int>(block) / TileBoxes::blocks_per_side * side;
    return {u, std::min(u + side, whole.u_last), v, std::min(v + side, whole.v_last)};
}

TileBoxes empty_tile_boxes(const ScanLines& lines) {
    constexpr int side = ScanLines::tile_side;
    TileBoxes tiles{(lines.u_count() + side - 1) / side, (lines.v_count() + side - 1) / side, {}};
    tiles.boxes.resize(static_cast<size_t>(tiles.u_tiles) * static_cast<size_t>(tiles.v_tiles));
    tiles.blocks.resize(tiles.boxes.size() * TileBoxes::blocks_per_tile);
    return tiles;
}

Result<CutModel> make_cut_model(Solid solid, double spacing, double memory_limit) {
    FEELER_TRY(Dbm lines, scan(solid, spacing, memory_limit));
    CutModel model;
    model.outer_box = bounds(solid).grown(solid.tolerance);
    model.solid = std::move(solid);
    model.lines = std::move(lines);
    const ScanGrid& grid = model.lines.grid;
    model.columns = ScanLines(2, grid.count(0) + 1, grid.count(1) + 1);
    model.column_boxes = empty_tile_boxes(model.columns);
    model.history.resize(model.column_boxes.boxes.size());
    for (int j = 0; j < model.columns.v_count(); ++j)
        for (int i = 0; i < model.columns.u_count(); ++i) {
            IntervalList column = column_of(model.solid, cell_square(model, i, j));
            if (!column.empty()) model.columns.edit(i, j) = std::move(column);
        }
    refit_columns(model, {0, model.columns.u_count(), 0, model.columns.v_count()});
    for (int axis = 0; axis < 3; ++axis) {
        const ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
        model.line_boxes[static_cast<size_t>(axis)] = empty_tile_boxes(family);
        refit_lines(model, axis, {0, family.u_count(), 0, family.v_count()});
    }
    return model;
}

double cut(CutModel& model, const CutterSweep& sweep) {
    const LoggedSweep logged{sweep, bounds(sweep)};
    if (!overlaps(logged.box, model.outer_box)) return 0.0;
    const LineRange cells = cells_in(model, logged.box);
    if (cells.empty() || !log_sweep(model, logged, cells)) return 0.0;

    double volume = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const LineRange range = lines_in(model.lines, axis, logged.box);
        if (range.empty()) continue;
        const double gone = cut_lines(model, axis, logged, range);
        if (gone > 0.0) refit_lines(model, axis, range);
        volume += gone / 3.0;
    }
    bool changed = false;
    for (const Cutter::Piece& piece : sweep.cutter->pieces)
        changed = cut_columns(model, piece.within, logged, cells) || changed;
    if (changed) refit_columns(model, cells);
    return volume;
}

std::vector<uint32_t> sweeps_near(const CutModel& model, const Aabb& box) {
    constexpr int side = ScanLines::tile_side;
    const LineRange cells = cells_in(model, box);
    std::vector<uint32_t> numbers;
    for (int v = cells.v_first / side * side; v < cells.v_last; v += side) {
        for (int u = cells.u_first / side * side; u < cells.u_last; u += side) {
            const SharedLog<uint32_t>& tile = model.history[model.column_boxes.index(u, v)];
            for (size_t k = 0; k < tile.size(); ++k)
                if (overlaps(model.log[tile[k]].box, box)) numbers.push_back(tile[k]);
        }
    }
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
}

Square cell_square(const CutModel& model, int i, int j) {
    const ScanGrid& grid = model.lines.grid;
    const Aabb& box = model.outer_box;
    const auto within = [&](int axis, int k) {
        return std::clamp(grid.coordinate(axis, k), box.min[axis], box.max[axis]);
    };
    // The outermost cells reach to the border, however far the tolerance moves it out.
    const bool last_i = i == grid.count(0), last_j = j == grid.count(1);
    return {i == 0 ? box.min.x : within(0, i - 1), last_i ? box.max.x : within(0, i),
            j == 0 ? box.min.y : within(1, j - 1), last_j ? box.max.y : within(1, j)};
}

IntervalList fresh_column(const CutModel& model, int i, int j, const Square& square) {
    IntervalList column = column_of(model.solid, square);
    for_sweeps_over(model, i, j, square, [&](const CutterSweep& sweep) {
        for (const Cutter::Piece& piece : sweep.cutter->pieces) {
            if (column.empty()) return;
            if (const auto gone = covered_heights(piece.within, sweep, square))
                column.subtract(*gone);
        }
    });
    return column;
}

IntervalList fresh_line(const CutModel& model, int i, int j, double x, double y) {
    IntervalList line = line_of(model.solid, 2, x, y);
    for_sweeps_over(model, i, j, {x, x, y, y}, [&](const CutterSweep& sweep) {
        for (const Cutter::Piece& piece : sweep.cutter->pieces)
            if (const auto gone = line_interval(piece.around, sweep, 2, x, y)) line.subtract(*gone);
    });
    return line;
}

bool is_gone(const CutModel& model) {
    // A box that was not fitted since the last cut may stand round nothing.
    for (int j = 0; j < model.columns.v_count(); ++j)
        for (int i = 0; i < model.columns.u_count(); ++i)
            if (!model.columns.line(i, j).empty()) return false;
    return true;
}

} // namespace core
