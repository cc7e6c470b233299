#include "core/dbm/tile_cutting.h"

namespace core {
namespace {

constexpr int side = ScanLines::tile_side;

/// The places first .. last - 1 of an evenly spaced grid that lie within lower .. upper.
std::pair<int, int> places_between(const ScanGrid& grid, int axis, double lower, double upper) {
    const double first = grid.coordinate(axis, 0);
    const double count = grid.count(axis);
    const double from = std::ceil((lower - first) / grid.spacing);
    const double to = std::floor((upper - first) / grid.spacing) + 1.0;
    return {static_cast<int>(std::clamp(from, 0.0, count)),
            static_cast<int>(std::clamp(to, 0.0, count))};
}

/// Bits for the places of `range` among those that begin at `first`.
uint32_t lanes_of(int first, int range_first, int range_last) {
    const int from = std::max(range_first - first, 0), to = std::min(range_last - first, side);
    return ((1U << to) - 1U) & ~((1U << from) - 1U);
}

/// How many of the grid's coordinates lie below x, and those on it if so wanted.
double points_below(const ScanGrid& grid, int axis, double x, bool itself) {
    const double half = grid.half_count[static_cast<size_t>(axis)];
    const double index = std::nearbyint((x - grid.centre[axis]) / grid.spacing + (half - 0.5));
    const double there = grid.centre[axis] + (index - half + 0.5) * grid.spacing;
    return index + (there < x || (itself && there == x) ? 1.0 : 0.0);
}

/// What a line's matter counts for.
LineSums counted(const TileTask& task, const ScanTile& tile, size_t place) {
    const double half = task.grid->half_count[static_cast<size_t>(task.axis)];
    const auto end = [&](double x, bool is_upper, uint8_t tilt) {
        const double points = points_below(*task.grid, task.axis, x, !is_upper);
        const double border = task.grid->centre[task.axis] + (points - half) * task.grid->spacing;
        return LineSums{(x - border) * (1.0 - tilt * (1.0 / ScanTile::steepest)), points};
    };
    LineSums sums;
    const LineView matter = tile.line(place);
    for (size_t k = 0; k < matter.size(); ++k) {
        const EndMarks marks = tile.marks_of(place, k);
        const LineSums upper = end(matter[k].upper, true, marks.upper_tilt);
        const LineSums lower = end(matter[k].lower, false, marks.lower_tilt);
        sums.beyond += upper.beyond - lower.beyond;
        sums.points += upper.points - lower.points;
    }
    return sums;
}

double sum_of(const std::array<double, ScanTile::side>& lanes) {
    std::array<double, 8> halves;
    for (size_t i = 0; i < 8; ++i) halves[i] = lanes[i] + lanes[i + 8];
    std::array<double, 4> quarters;
    for (size_t i = 0; i < 4; ++i) quarters[i] = halves[i] + halves[i + 4];
    return (quarters[0] + quarters[2]) + (quarters[1] + quarters[3]);
}

/// Does what the lanes have left, and sums up.
LineSums finish(const TileTask& task, ScanTile& tile, const TileCut& done) {
    LineSums sums{sum_of(done.beyond), sum_of(done.points)};
    for (size_t i = 0; i < done.by_hand_count; ++i) {
        const HandCut& hand = done.by_hand[i];
        const LineSums before = task.grid ? counted(task, tile, hand.place) : LineSums{};
        subtract(tile, hand.place, {hand.lower, hand.upper},
                 {task.mark, task.mark, hand.high_tilt, hand.low_tilt});
        const LineSums after = task.grid ? counted(task, tile, hand.place) : LineSums{};
        sums.beyond += before.beyond - after.beyond;
        if (task.axis == 2) sums.points += before.points - after.points;
    }
    return sums;
}

struct TilePlace {
    int u, v; // of its first line
};

TilePlace place_of(const TileBoxes& boxes, size_t tile) {
    return {static_cast<int>(tile % static_cast<size_t>(boxes.u_tiles)) * side,
            static_cast<int>(tile / static_cast<size_t>(boxes.u_tiles)) * side};
}

/// The stretches on rows of corners, worked out only where they are asked for.
class CornerRows {
public:
    CornerRows(const LanePlan& plan, const TileTask& task)
        : loops_(lane_cut()), plan_(plan), task_(task) {}

    /// Those on the corners `wanted`, bit by bit.
    const CornerStretches& at(int row, uint32_t wanted) {
        Corners& kept = rows_[static_cast<size_t>(row % 2)];
        if (kept.of != row) kept.of = row, kept.known = 0;
        const uint32_t missing = wanted & ~kept.known;
        if (missing == 0) return kept.ends;
        loops_.stretches(plan_, task_.u, task_.v[row], wanted | kept.known, kept.ends);
        kept.known |= wanted;
        return kept.ends;
    }

private:
    struct Corners {
        int of = -1;
        uint32_t known = 0;
        CornerStretches ends;
    };

    const LaneCut& loops_;
    const LanePlan& plan_;
    const TileTask& task_;
    std::array<Corners, 2> rows_;
};

} // namespace

LineRange tiles_of(const LineRange& lines) {
    return {lines.u_first / side, (lines.u_last + side - 1) / side, lines.v_first / side,
            (lines.v_last + side - 1) / side};
}

void fit_boxes(CutModel& model) {
    model.loose_tests = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto family = static_cast<size_t>(axis);
        fit(model.line_boxes[family], model.lines.families[family],
            {model.places[static_cast<size_t>(u_axis(axis))].data(),
             model.places[static_cast<size_t>(v_axis(axis))].data(), false});
    }
    fit(model.column_boxes, model.columns,
        {model.corners[0].data(), model.corners[1].data(), true});
}

LineRange lines_in(const CutModel& model, int axis, const Aabb& box) {
    const int ua = u_axis(axis), va = v_axis(axis);
    const ScanGrid& grid = model.lines.grid;
    const auto [u0, u1] = places_between(grid, ua, box.min[ua], box.max[ua]);
    const auto [v0, v1] = places_between(grid, va, box.min[va], box.max[va]);
    return {u0, u1, v0, v1};
}

LineRange cells_in(const CutModel& model, const Aabb& box) {
    const LineRange lines = lines_in(model, 2, box.grown(model.lines.grid.spacing));
    // Cell i lies between lines i - 1 and i; the lines beyond the last one are not in the range.
    return {lines.u_first, std::min(lines.u_last + 1, model.columns.u_count()), lines.v_first,
            std::min(lines.v_last + 1, model.columns.v_count())};
}

TileOutcome cut_lines(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                      const ReadySweep& ready) {
    const int axis = plan.axis;
    ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
    const TileBoxes& boxes = model.line_boxes[static_cast<size_t>(axis)];
    if (family.tile(tile) == nullptr || !overlaps(boxes.boxes[tile], ready.front)) return {};
    const auto [u, v] = place_of(boxes, tile);
    const TileTask task{
        .u = &model.places[static_cast<size_t>(u_axis(axis))][static_cast<size_t>(u)],
        .v = &model.places[static_cast<size_t>(v_axis(axis))][static_cast<size_t>(v)],
        .row_first = std::max(range.v_first - v, 0),
        .row_last = std::min(range.v_last - v, side),
        .lanes = lanes_of(u, range.u_first, range.u_last),
        .low = ready.front.min[axis],
        .high = ready.front.max[axis],
        .mark = ready.mark,
        .grid = &model.lines.grid,
        .axis = axis};
    const LaneCut& loops = lane_cut();
    if (family.is_shared(tile) && !loops.changes(plan, task, *family.tile(tile))) return {};
    ScanTile& own = family.edit_tile(tile);
    if (own.marks.empty()) own.keep_marks();
    TileCut done;
    loops.cut(plan, task, own, done);
    if (done.blocks == 0) return {};
    return {finish(task, own, done), done.blocks};
}

TileOutcome cut_columns(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                        const ReadySweep& ready) {
    const TileBoxes& boxes = model.column_boxes;
    if (model.columns.tile(tile) == nullptr || !overlaps(boxes.boxes[tile], ready.front)) return {};
    const auto [u, v] = place_of(boxes, tile);
    const TileTask task{.u = &model.corners[0][static_cast<size_t>(u)],
                        .v = &model.corners[1][static_cast<size_t>(v)],
                        .row_first = std::max(range.v_first - v, 0),
                        .row_last = std::min(range.v_last - v, side),
                        .lanes = lanes_of(u, range.u_first, range.u_last),
                        .low = ready.front.min.z,
                        .high = ready.front.max.z,
                        .axis = 2};
    CornerRows corners(plan, task);
    const LaneCut& loops = lane_cut();
    TileCut done;
    ScanTile* own = nullptr;
    TileReach reach;
    // What all four corners of a cell share is no more than what the first of them has.
    loops.in_reach(plan, task, *model.columns.tile(tile), reach);
    for (int row = task.row_first; row < task.row_last; ++row) {
        const ScanTile& now = *model.columns.tile(tile);
        const uint32_t cells = reach[static_cast<size_t>(row)];
        if (cells == 0) continue;
        const CornerStretches& front = corners.at(row, cells | (cells << 1U));
        const CornerStretches& back = corners.at(row + 1, cells | (cells << 1U));
        if (own == nullptr && !loops.meets_shared(now, row, front, back, cells)) continue;
        if (own == nullptr) own = &model.columns.edit_tile(tile);
        loops.take_shared(task, row, front, back, cells, *own, done);
    }
    if (own == nullptr) return {};
    finish(task, *own, done);
    return {{}, done.blocks};
}

} // namespace core
