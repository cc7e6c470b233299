#include "core/dbm/cut_model.h"

#include "core/dbm/tile_cutting.h"

namespace core {

uint32_t SweepLog::last_mark() const {
    if (marks_.empty()) return 0;
    return marks_.back().mark + static_cast<uint32_t>(entries_.size()) - 1 - marks_.back().first;
}

namespace {

/// The last run of a list that passes a test; the first ones pass it, the others do not.
template <typename Runs, typename Test>
const auto& last_run(const Runs& runs, const Test& passes) {
    size_t from = 0, to = runs.size();
    while (to - from > 1) {
        const size_t middle = from + (to - from) / 2;
        (passes(runs[middle]) ? from : to) = middle;
    }
    return runs[from];
}

} // namespace

size_t SweepLog::index_of(uint32_t mark) const {
    const MarkRun& run = last_run(marks_, [&](const MarkRun& one) { return one.mark <= mark; });
    return run.first + (mark - run.mark);
}

uint32_t SweepLog::mark(size_t i) const {
    const MarkRun& run = last_run(marks_, [&](const MarkRun& one) { return one.first <= i; });
    return run.mark + static_cast<uint32_t>(i) - run.first;
}

void SweepLog::push_back(const CutterSweep& sweep, uint32_t mark) {
    if (marks_.empty() || mark != last_mark() + 1)
        marks_.push_back({static_cast<uint32_t>(entries_.size()), mark});
    const bool same_attitude = !attitudes_.empty() && attitudes_.back().cutter == sweep.cutter
                               && attitudes_.back().orientation == sweep.orientation;
    if (!same_attitude)
        attitudes_.push_back({sweep.cutter, sweep.orientation,
                              bounds(CutterSweep{sweep.cutter, {}, {}, sweep.orientation})});
    if (positions_.empty() || positions_.back() != sweep.from) positions_.push_back(sweep.from);
    positions_.push_back(sweep.to);
    entries_.push_back({static_cast<uint32_t>(positions_.size() - 1),
                        static_cast<uint32_t>(attitudes_.size() - 1), sweep.block});
}

Aabb SweepLog::path_box(size_t i) const {
    const Entry& entry = entries_[i];
    Aabb path;
    path.extend(positions_[entry.end - 1]);
    path.extend(positions_[entry.end]);
    return path;
}

Aabb SweepLog::box(size_t i) const {
    const Aabb path = path_box(i);
    const Aabb& body = attitudes_[entries_[i].attitude].body;
    return {path.min + body.min, path.max + body.max};
}

void SweepLog::cut_back(const Sizes& sizes) {
    attitudes_.truncate(sizes.attitudes);
    positions_.truncate(sizes.positions);
    entries_.truncate(sizes.entries);
    marks_.truncate(sizes.marks);
}

void SweepLog::keep_first(size_t moves) {
    if (moves >= size()) return;
    if (moves == 0) return cut_back({});
    const Entry& last = entries_[moves - 1];
    size_t runs = marks_.size();
    while (marks_[runs - 1].first >= moves) --runs;
    cut_back({last.attitude + size_t{1}, last.end + size_t{1}, moves, runs});
}

LoggedSweep SweepLog::operator[](size_t i) const {
    const Entry& entry = entries_[i];
    const Attitude& attitude = attitudes_[entry.attitude];
    return {{attitude.cutter, positions_[entry.end - 1], positions_[entry.end],
             attitude.orientation, entry.block},
            box(i)};
}

void append(SharedLog<SweepRun>& runs, uint32_t number, const Aabb& path) {
    if (runs.empty() || runs.back().last + 1 != number) {
        runs.push_back({number, number, path});
        return;
    }
    SweepRun longer = runs.back();
    longer.last = number;
    longer.paths.extend(path.min);
    longer.paths.extend(path.max);
    runs.replace_back(longer);
}

void remove_newest(SharedLog<SweepRun>& runs) {
    const SweepRun newest = runs.back();
    if (newest.first == newest.last)
        runs.truncate(runs.size() - 1);
    else
        runs.replace_back({newest.first, newest.last - 1, newest.paths});
}

namespace {

/// Positions of the lines, padded to fill the last tile.
std::vector<double> line_coordinates(const ScanGrid& grid, int axis) {
    std::vector<double> positions;
    for (int i = 0; i < grid.count(axis) + ScanLines::tile_side; ++i)
        positions.push_back(grid.coordinate(axis, i));
    return positions;
}

/// Positions of the cell corners; entries beyond the last one have no meaning.
std::vector<double> corners_along(const CutModel& model, int axis) {
    const auto edge = [&](int i) {
        const Square cell = cell_square(model, axis == 0 ? i : 0, axis == 1 ? i : 0);
        return axis == 0 ? std::pair(cell.x0, cell.x1) : std::pair(cell.y0, cell.y1);
    };
    std::vector<double> corners;
    const int last = model.lines.grid.count(axis);
    for (int i = 0; i <= last; ++i) corners.push_back(edge(i).first);
    corners.resize(corners.size() + 2 * ScanLines::tile_side, edge(last).second);
    return corners;
}

void add_columns(CutModel& model) {
    const ScanGrid& grid = model.lines.grid;
    model.columns = ScanLines(2, grid.count(0) + 1, grid.count(1) + 1);
    for (int j = 0; j < model.columns.v_count(); ++j)
        for (int i = 0; i < model.columns.u_count(); ++i) {
            const IntervalList column = column_of(model.solid, cell_square(model, i, j));
            if (!column.empty()) model.columns.edit(i, j) = column;
        }
}

} // namespace

Result<CutModel> make_cut_model(Solid solid, double spacing, double memory_limit,
                                WithColumns with_columns) {
    FEELER_TRY(Dbm lines, scan(solid, spacing, memory_limit));
    CutModel model;
    model.outer_box = outer_bounds(solid);
    model.solid = std::move(solid);
    model.lines = std::move(lines);
    for (int axis = 0; axis < 3; ++axis)
        model.positions[static_cast<size_t>(axis)] = line_coordinates(model.lines.grid, axis);
    for (int axis = 0; axis < 2; ++axis)
        model.corners[static_cast<size_t>(axis)] = corners_along(model, axis);
    if (with_columns == WithColumns::yes) add_columns(model);
    for (size_t family = 0; family < 3; ++family)
        model.line_boxes[family] = unfitted_boxes(model.lines.families[family]);
    model.column_boxes = unfitted_boxes(model.columns);
    fit_boxes(model);
    model.history.resize(model.column_boxes.boxes.size());
    return model;
}

std::vector<uint32_t> tips_near(const CutModel& model, const Aabb& box, double reach) {
    std::vector<uint32_t> numbers;
    if (model.columns.u_count() == 0) return numbers;
    // Neighbouring tiles have many moves in common.
    std::vector<std::pair<uint32_t, uint32_t>> ranges; // first .. last
    for_tiles(cells_in(model, box.grown(reach)), model.column_boxes, [&](size_t tile) {
        const SharedLog<SweepRun>& runs = model.history[tile];
        for (size_t k = 0; k < runs.size(); ++k)
            if (overlaps(runs[k].paths, box)) ranges.emplace_back(runs[k].first, runs[k].last);
    });
    std::sort(ranges.begin(), ranges.end());
    uint32_t next = 0;
    for (const auto& [first, last] : ranges)
        for (next = std::max(next, first); next <= last; ++next)
            if (overlaps(model.log.path_box(next), box)) numbers.push_back(next);
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

namespace {

bool overlaps(const Aabb& box, const Square& square) {
    return box.min.x <= square.x1 && box.max.x >= square.x0 && box.min.y <= square.y1
           && box.max.y >= square.y0;
}

/// Whether the box around the cutter comes to a square, between two heights, at some moment of the
/// move. Much sharper than the box of the whole move if that is long and oblique.
bool comes_to(const LoggedSweep& logged, const Square& square, const Interval& heights) {
    constexpr double slack = 1e-6; // mm, far above the rounding errors of this test
    const Vec3 &from = logged.sweep.from, &to = logged.sweep.to;
    const double least[] = {square.x0, square.y0, heights.lower};
    const double most[] = {square.x1, square.y1, heights.upper};
    double first = 0.0, last = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = std::min(from[axis], to[axis]), high = std::max(from[axis], to[axis]);
        // The position of the tip must be between these.
        const double lower = least[axis] - (logged.box.max[axis] - high) - slack;
        const double upper = most[axis] + (low - logged.box.min[axis]) + slack;
        if (high < lower || low > upper) return false;
        const double way = to[axis] - from[axis];
        if (high - low <= slack) continue;
        const double at_lower = (lower - from[axis]) / way, at_upper = (upper - from[axis]) / way;
        first = std::max(first, std::min(at_lower, at_upper));
        last = std::min(last, std::max(at_lower, at_upper));
    }
    return first <= last;
}

/// No point that an upright cutter sweeps over a square is lower; infinite if there is none.
double lowest_over(const CutterSweep& sweep, const Square& square) {
    constexpr double slack = 1e-6; // mm, far above the rounding errors of this bound
    const double x = 0.5 * (square.x0 + square.x1) - sweep.from.x;
    const double y = 0.5 * (square.y0 + square.y1) - sweep.from.y;
    const double way_x = sweep.to.x - sweep.from.x, way_y = sweep.to.y - sweep.from.y;
    const double way_2 = way_x * way_x + way_y * way_y;
    const double t = way_2 > 0.0 ? std::clamp((x * way_x + y * way_y) / way_2, 0.0, 1.0) : 0.0;
    const double off_x = x - t * way_x, off_y = y - t * way_y;
    const double wide = square.x1 - square.x0, deep = square.y1 - square.y0;
    const double apart = std::sqrt(off_x * off_x + off_y * off_y)
                         - 0.5 * std::sqrt(wide * wide + deep * deep) - slack;
    return std::min(sweep.from.z, sweep.to.z) + sweep.cutter->underside.beyond(apart) - slack;
}

constexpr Interval any_height{-infinity, infinity};

bool comes_to(const LoggedSweep& logged, const TiltedPrism* box, const Square& square,
              const Interval& heights) {
    return comes_to(logged, square, heights)
           && (box ? box->comes_to(square, heights)
                   : lowest_over(logged.sweep, square) <= heights.upper);
}

/// From the lowest to the highest of some intervals; empty if there are none.
template <typename Intervals>
Interval hull(const Intervals& all) {
    Interval heights{infinity, -infinity};
    for (const Interval& one : all) {
        heights.lower = std::min(heights.lower, one.lower);
        heights.upper = std::max(heights.upper, one.upper);
    }
    return heights;
}

/// The part of the intervals between two heights.
IntervalList clipped(IntervalList all, const Interval& heights) {
    all.subtract({-infinity, heights.lower});
    all.subtract({heights.upper, infinity});
    return all;
}

} // namespace

TiltedPrism::TiltedPrism(const CutterSweep& sweep) {
    const Vec3& axis = sweep.orientation[2];
    const double level = std::sqrt(axis.x * axis.x + axis.y * axis.y);
    const Vec3 across = level > 0.0 ? Vec3(-axis.y, axis.x, 0.0) / level : Vec3(1.0, 0.0, 0.0);
    const Vec3 third = glm::cross(axis, across);
    const double diagonal = std::sqrt(0.5);
    axes_ = {axis, across, third, diagonal * (across + third), diagonal * (across - third)};
    const Aabb& body = sweep.cutter->body;
    const double radius = std::max({body.max.x, body.max.y, -body.min.x, -body.min.y});
    for (size_t i = 0; i < axes_.size(); ++i) {
        const double from = glm::dot(axes_[i], sweep.from), to = glm::dot(axes_[i], sweep.to);
        least_[i] = std::min(from, to) + (i == 0 ? body.min.z : -radius);
        most_[i] = std::max(from, to) + (i == 0 ? body.max.z : radius);
    }
}

bool TiltedPrism::comes_to(const Square& square, const Interval& heights) const {
    constexpr double slack = 1e-6; // mm, far above the rounding errors of this test
    constexpr double far = 1e9;    // mm, beyond every height
    const Vec3 low(square.x0, square.y0, std::max(heights.lower, -far));
    const Vec3 high(square.x1, square.y1, std::min(heights.upper, far));
    for (size_t i = 0; i < axes_.size(); ++i) {
        const Vec3 a = axes_[i] * low, b = axes_[i] * high;
        const Vec3 least = glm::min(a, b), most = glm::max(a, b);
        if (least.x + least.y + least.z > most_[i] + slack
            || most.x + most.y + most.z < least_[i] - slack)
            return false;
    }
    return true;
}

CellSweeps sweeps_near_cell(const CutModel& model, int i, int j) {
    CellSweeps near;
    near.add(model, i, j, 0);
    return near;
}

void CellSweeps::add(const CutModel& model, int i, int j, size_t first) {
    const Square cell = cell_square(model, i, j);
    const auto is_near = [&](const NearSweep& sweep) {
        const LoggedSweep& logged = sweep.logged;
        return comes_to(logged, cell, any_height)
               && (!sweep.box || sweep.box->comes_to(cell, {logged.box.min.z, logged.box.max.z}));
    };
    const auto add = [&](size_t number) {
        if (!overlaps(model.log.box(number), cell)) return;
        if (pool_) {
            const auto known = pool_->find(number);
            if (known != pool_->end()) {
                if (is_near(known->second)) sweeps_.push_back(&known->second);
                return;
            }
        }
        NearSweep sweep{model.log[number], {}};
        if (!is_upright(sweep.logged.sweep.orientation)) sweep.box.emplace(sweep.logged.sweep);
        if (!is_near(sweep)) return;
        sweeps_.push_back(pool_ ? &pool_->emplace(number, std::move(sweep)).first->second
                                : &own_.emplace_back(std::move(sweep)));
    };
    const SharedLog<SweepRun>& runs = model.history[model.column_boxes.index(i, j)];
    size_t run = runs.size();
    while (run > 0 && runs[run - 1].last >= first) --run;
    for (; run < runs.size(); ++run)
        for (size_t number = std::max<size_t>(runs[run].first, first); number <= runs[run].last;
             ++number)
            add(number);
}

SquareCuts::SquareCuts(const CutModel& model, const CellSweeps& near, const Square& square,
                       const Interval& heights)
    : SquareCuts(model, square, heights) {
    add(near, 0);
}

void SquareCuts::add(const CellSweeps& near, size_t first) {
    struct Deep {
        double low;
        const NearSweep* sweep;
    };
    std::vector<Deep> all;
    for (size_t i = first; i < near.size(); ++i) {
        const LoggedSweep& logged = near[i].logged;
        const TiltedPrism* const box = near[i].box ? &*near[i].box : nullptr;
        if (comes_to(logged, box, square_, heights_))
            all.push_back({box ? logged.box.min.z : lowest_over(logged.sweep, square_), &near[i]});
    }
    // The last in the list are subtracted first: the lowest ones leave little to the others.
    std::stable_sort(all.begin(), all.end(),
                     [](const Deep& a, const Deep& b) { return a.low > b.low; });
    for (const Deep& one : all)
        for (const Cutter::Piece& piece : one.sweep->logged.sweep.cutter->pieces)
            cuts_.push_back(
                {&one.sweep->logged, one.sweep->box ? &*one.sweep->box : nullptr, &piece, {}, {}});
}

SquareCuts SquareCuts::within(int number, const Interval& heights) const {
    SquareCuts part(
        *model_, quarter(number),
        {std::max(heights_.lower, heights.lower), std::min(heights_.upper, heights.upper)});
    const int column = number % 2, row = number / 2;
    for (const PieceCut& cut : cuts_) {
        if (!comes_to(*cut.sweep, cut.box, part.square_, part.heights_)) continue;
        PieceCut& same = part.cuts_.emplace_back(PieceCut{cut.sweep, cut.box, cut.piece, {}, {}});
        for (const int i : {0, 1})
            for (const int j : {0, 1}) {
                const auto from = static_cast<size_t>(column + i + 3 * (row + j));
                const auto to = static_cast<size_t>(2 * i + 6 * j);
                same.at[to] = cut.at[from];
                same.is_known[to] = cut.is_known[from];
            }
    }
    return part;
}

double SquareCuts::x(int column) const {
    if (column == 1) return 0.5 * (square_.x0 + square_.x1);
    return column == 0 ? square_.x0 : square_.x1;
}

double SquareCuts::y(int row) const {
    if (row == 1) return 0.5 * (square_.y0 + square_.y1);
    return row == 0 ? square_.y0 : square_.y1;
}

Square SquareCuts::quarter(int number) const {
    const int column = number % 2, row = number / 2;
    return {x(column), x(column + 1), y(row), y(row + 1)};
}

const std::optional<Interval>& SquareCuts::segment(PieceCut& cut, int column, int row) const {
    const auto at = static_cast<size_t>(column + 3 * row);
    if (!cut.is_known[at]) {
        cut.at[at] = line_interval(cut.piece->within, cut.sweep->sweep, 2, x(column), y(row));
        cut.is_known[at] = true;
    }
    return cut.at[at];
}

std::optional<Interval> SquareCuts::covered(PieceCut& cut, int number, const Interval& left) const {
    const CutterSweep& sweep = cut.sweep->sweep;
    // The corner that is farthest from the axis of the tool is the first to be missed.
    Vec3 middle = 0.5 * (sweep.from + sweep.to);
    const Vec3& axis = sweep.orientation[2];
    if (cut.box && std::abs(axis.z) > 0.1)
        middle += (0.5 * (left.lower + left.upper) - middle.z) / axis.z * axis;
    const int right = middle.x < x(1) ? 1 : 0;
    const int back = middle.y < y(1) ? 1 : 0;
    Interval common{-infinity, infinity};
    for (const int i : {right, 1 - right})
        for (const int j : {back, 1 - back}) {
            const int column = number % 2 + i, row = number / 2 + j;
            const bool is_known = cut.is_known[static_cast<size_t>(column + 3 * row)];
            if (!is_known && cut.box
                && !cut.box->comes_to({x(column), x(column), y(row), y(row)}, left))
                return std::nullopt;
            const auto& corner = segment(cut, column, row);
            if (!corner) return std::nullopt;
            common.lower = std::max(common.lower, corner->lower);
            common.upper = std::min(common.upper, corner->upper);
            if (common.lower >= left.upper || common.upper <= left.lower) return std::nullopt;
        }
    return safely_within(common);
}

IntervalList SquareCuts::column(int number) {
    IntervalList column = clipped(column_of(model_->solid, quarter(number)), heights_);
    subtract_from_column(column, number, 0);
    return column;
}

void SquareCuts::subtract_from_column(IntervalList& column, int number, size_t first) {
    const Square part = quarter(number);
    for (size_t i = cuts_.size(); i-- > first && !column.empty();) {
        const Interval left = hull(column);
        if (!comes_to(*cuts_[i].sweep, cuts_[i].box, part, left)) continue;
        // Most moves of a tilted tool pass where the material is gone already.
        const TiltedPrism* const box = cuts_[i].box;
        const auto is_met = [&](const Interval& matter) { return box->comes_to(part, matter); };
        if (box && column.size() > 1 && std::none_of(column.begin(), column.end(), is_met))
            continue;
        if (const auto gone = covered(cuts_[i], number, left)) column.subtract(*gone);
    }
}

IntervalList SquareCuts::line_at_centre() const {
    IntervalList line = clipped(line_of(model_->solid, 2, x(1), y(1)), heights_);
    subtract_from_line(line, 0);
    return line;
}

void SquareCuts::subtract_from_line(IntervalList& line, size_t first) const {
    const double at_x = x(1), at_y = y(1);
    for (size_t i = cuts_.size(); i-- > first && !line.empty();) {
        const PieceCut& cut = cuts_[i];
        if (!comes_to(*cut.sweep, cut.box, {at_x, at_x, at_y, at_y}, hull(line))) continue;
        if (const auto gone = line_interval(cut.piece->around, cut.sweep->sweep, 2, at_x, at_y))
            line.subtract(*gone);
    }
}

KeptSquare::KeptSquare(SquareCuts cuts, const CellSweeps& near, KeptBudget& budget)
    : cuts_(std::move(cuts)), near_(&near), seen_(near.size()), budget_(&budget) {
    budget_->used += 1 + cuts_.cuts_.size();
}

void KeptSquare::catch_up() {
    if (seen_ == near_->size()) return;
    const size_t known = cuts_.cuts_.size();
    cuts_.add(*near_, seen_);
    seen_ = near_->size();
    budget_->used += cuts_.cuts_.size() - known;
    if (line_) cuts_.subtract_from_line(*line_, known);
    for (int quarter = 0; quarter < 4; ++quarter)
        if (auto& column = columns_[static_cast<size_t>(quarter)])
            cuts_.subtract_from_column(*column, quarter, known);
}

const IntervalList& KeptSquare::line_at_centre() {
    catch_up();
    if (!line_) line_ = cuts_.line_at_centre();
    return *line_;
}

const IntervalList& KeptSquare::column(int quarter) {
    catch_up();
    std::optional<IntervalList>& column = columns_[static_cast<size_t>(quarter)];
    if (!column) column = cuts_.column(quarter);
    return *column;
}

KeptSquare* KeptSquare::within(int quarter) {
    catch_up();
    std::unique_ptr<KeptSquare>& part = quarters_[static_cast<size_t>(quarter)];
    if (!part && budget_->is_spent()) return nullptr;
    if (!part)
        part = std::make_unique<KeptSquare>(cuts_.within(quarter, hull(column(quarter))), *near_,
                                            *budget_);
    return part.get();
}

SquareCuts KeptSquare::loose_within(int quarter, const Interval& heights) {
    catch_up();
    return cuts_.within(quarter, heights);
}

KeptSquare* KeptSquares::of_cell(int i, int j) {
    if (model_->is_on_trial) return nullptr;
    if (budget_.used > 2 * budget_.most) {
        cells_.clear();
        pool_.clear();
        budget_.used = 0;
    }
    const auto known = cells_.find({i, j});
    if (known == cells_.end() && budget_.is_spent()) return nullptr;
    Cell& cell =
        known != cells_.end() ? known->second : cells_.try_emplace({i, j}, &pool_).first->second;
    const size_t pooled = pool_.size();
    cell.sweeps.add(*model_, i, j, std::exchange(cell.logged, model_->log.size()));
    budget_.used += pool_.size() - pooled;
    if (!cell.square) {
        const Interval heights = hull(model_->columns.line(i, j));
        cell.square.emplace(SquareCuts(*model_, cell.sweeps, cell_square(*model_, i, j), heights),
                            cell.sweeps, budget_);
    }
    return &*cell.square;
}

IntervalList fresh_column(const CutModel& model, int i, int j, const Square& square) {
    IntervalList column = column_of(model.solid, square);
    const CellSweeps near = sweeps_near_cell(model, i, j);
    for (size_t k = 0; k < near.size(); ++k) {
        const LoggedSweep& one = near[k].logged;
        if (!comes_to(one, square, any_height)) continue;
        for (const Cutter::Piece& piece : one.sweep.cutter->pieces) {
            if (column.empty()) return column;
            if (const auto gone = covered_heights(piece.within, one.sweep, square))
                column.subtract(*gone);
        }
    }
    return column;
}

IntervalList fresh_line(const CutModel& model, int i, int j, double x, double y) {
    const Square point{x, x, y, y};
    IntervalList line = line_of(model.solid, 2, x, y);
    const auto subtract = [&](size_t number) {
        if (!overlaps(model.log.box(number), point)) return;
        const LoggedSweep one = model.log[number];
        std::optional<TiltedPrism> box;
        if (!is_upright(one.sweep.orientation)) box.emplace(one.sweep);
        if (!comes_to(one, box ? &*box : nullptr, point, hull(line))) return;
        for (const Cutter::Piece& piece : one.sweep.cutter->pieces)
            if (const auto gone = line_interval(piece.around, one.sweep, 2, x, y))
                line.subtract(*gone);
    };
    // The last moves are usually the lowest.
    const SharedLog<SweepRun>& runs = model.history[model.column_boxes.index(i, j)];
    for (size_t run = runs.size(); run-- > 0;)
        for (size_t number = runs[run].last + size_t{1}; number-- > runs[run].first;)
            if (!line.empty()) subtract(number);
    return line;
}

} // namespace core
