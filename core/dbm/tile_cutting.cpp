#include "core/dbm/tile_cutting.h"

#include <exception>
#include <thread>
#include <tuple>
#include <utility>

#include "core/base/math.h"

namespace core {
namespace {

constexpr int side = ScanLines::tile_side;

/// The lines first .. last - 1 of the grid whose positions are within lower .. upper.
std::pair<int, int> lines_between(const ScanGrid& grid, int axis, double lower, double upper) {
    const double first = grid.coordinate(axis, 0);
    const double count = grid.count(axis);
    const double from = std::ceil((lower - first) / grid.spacing);
    const double to = std::floor((upper - first) / grid.spacing) + 1.0;
    return {static_cast<int>(std::clamp(from, 0.0, count)),
            static_cast<int>(std::clamp(to, 0.0, count))};
}

/// Bits for the lines range_first .. range_last - 1 in a tile that begins at line `first`.
uint32_t lanes_of(int first, int range_first, int range_last) {
    const int from = std::max(range_first - first, 0), to = std::min(range_last - first, side);
    return ((1U << to) - 1U) & ~((1U << from) - 1U);
}

/// Number of grid coordinates below x, with `itself` also one exactly at x.
double points_below(const ScanGrid& grid, int axis, double x, bool itself) {
    const double half = grid.half_count[static_cast<size_t>(axis)];
    const double index = std::nearbyint((x - grid.centre[axis]) / grid.spacing + (half - 0.5));
    const double there = grid.centre[axis] + (index - half + 0.5) * grid.spacing;
    return index + (there < x || (itself && there == x) ? 1.0 : 0.0);
}

/// The contribution of a line's material to the sums.
RemovalSums counted(const TileTask& task, const ScanTile& tile, size_t slot) {
    const double half = task.grid->half_count[static_cast<size_t>(task.axis)];
    const auto end = [&](double x, bool is_upper, uint8_t tilt) {
        const double points = points_below(*task.grid, task.axis, x, !is_upper);
        const double border = task.grid->centre[task.axis] + (points - half) * task.grid->spacing;
        return RemovalSums{(x - border) * (1.0 - tilt * (1.0 / ScanTile::steepest)), points};
    };
    RemovalSums sums;
    const LineView matter = tile.line(slot);
    for (size_t k = 0; k < matter.size(); ++k) {
        const EndMarks marks = tile.marks_of(slot, k);
        const RemovalSums upper = end(matter[k].upper, true, marks.upper_tilt);
        const RemovalSums lower = end(matter[k].lower, false, marks.lower_tilt);
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

/// Removes the segments that the lanes left, and sums up.
RemovalSums finish(const TileTask& task, ScanTile& tile, const TileCut& done) {
    RemovalSums sums{sum_of(done.beyond), sum_of(done.points)};
    for (size_t i = 0; i < done.by_hand_count; ++i) {
        const ScalarCut& hand = done.by_hand[i];
        const RemovalSums before = task.grid ? counted(task, tile, hand.slot) : RemovalSums{};
        subtract(tile, hand.slot, {hand.lower, hand.upper},
                 {task.mark, task.mark, hand.high_tilt, hand.low_tilt});
        const RemovalSums after = task.grid ? counted(task, tile, hand.slot) : RemovalSums{};
        sums.beyond += before.beyond - after.beyond;
        if (task.axis == 2) sums.points += before.points - after.points;
    }
    return sums;
}

struct TileIndex {
    int u, v; // of its first line
};

TileIndex index_of(const TileBoxes& boxes, size_t tile) {
    return {static_cast<int>(tile % static_cast<size_t>(boxes.u_tiles)) * side,
            static_cast<int>(tile / static_cast<size_t>(boxes.u_tiles)) * side};
}

/// The segments on rows of corners, computed on demand.
class CornerRows {
public:
    CornerRows(const LanePlan& plan, const TileTask& task)
        : loops_(lane_cut()), plan_(plan), task_(task) {}

    /// The segments on the corners of a row whose bits are set in `wanted`.
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

const TileBoxes& boxes_of(const CutModel& model, int family) {
    return family == column_family ? model.column_boxes
                                   : model.line_boxes[static_cast<size_t>(family)];
}

const ScanLines& family_of(const CutModel& model, int family) {
    return family == column_family ? model.columns
                                   : model.lines.families[static_cast<size_t>(family)];
}

LinePositions positions_of(const CutModel& model, int family) {
    if (family == column_family) return {model.corners[0].data(), model.corners[1].data(), true};
    return {model.positions[static_cast<size_t>(u_axis(family))].data(),
            model.positions[static_cast<size_t>(v_axis(family))].data(), false};
}

void fit_boxes(CutModel& model) {
    model.loose_tests = 0;
    for (int family = 0; family < families; ++family)
        fit(boxes_of(model, family), family_of(model, family), positions_of(model, family));
}

LineRange lines_in(const CutModel& model, int axis, const Aabb& box) {
    const int ua = u_axis(axis), va = v_axis(axis);
    const ScanGrid& grid = model.lines.grid;
    const auto [u0, u1] = lines_between(grid, ua, box.min[ua], box.max[ua]);
    const auto [v0, v1] = lines_between(grid, va, box.min[va], box.max[va]);
    return {u0, u1, v0, v1};
}

LineRange cells_in(const CutModel& model, const Aabb& box) {
    const LineRange lines = lines_in(model, 2, box.grown(model.lines.grid.spacing));
    // Cell i is between lines i - 1 and i, so there is one more cell than lines.
    return {lines.u_first, std::min(lines.u_last + 1, model.columns.u_count()), lines.v_first,
            std::min(lines.v_last + 1, model.columns.v_count())};
}

TileOutcome cut_lines(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                      const ReadySweep& ready) {
    const int axis = plan.axis;
    ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
    const TileBoxes& boxes = model.line_boxes[static_cast<size_t>(axis)];
    if (family.tile(tile) == nullptr || !overlaps(boxes.boxes[tile], ready.front)) return {};
    const auto [u, v] = index_of(boxes, tile);
    const TileTask task{
        .u = &model.positions[static_cast<size_t>(u_axis(axis))][static_cast<size_t>(u)],
        .v = &model.positions[static_cast<size_t>(v_axis(axis))][static_cast<size_t>(v)],
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
    return {finish(task, own, done), done.blocks, done.lower_chunks, done.upper_chunks,
            done.layers};
}

TileOutcome cut_columns(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                        const ReadySweep& ready) {
    const TileBoxes& boxes = model.column_boxes;
    if (model.columns.tile(tile) == nullptr || !overlaps(boxes.boxes[tile], ready.front)) return {};
    const auto [u, v] = index_of(boxes, tile);
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
    // The intersection of the four corners of a cell is contained in the segment of the first.
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
    return {{}, done.blocks, done.lower_chunks, done.upper_chunks, done.layers};
}

namespace {

/// Calls `act` for the tiles of columns that a sweep may change.
template <typename Act>
void for_tiles_of_columns(const CutModel& model, const Aabb& front, const Act& act) {
    for_tiles(cells_in(model, front), model.column_boxes, [&](size_t tile) {
        if (overlaps(model.column_boxes.boxes[tile], front)) act(tile);
    });
}

/// Records the sweep for all tiles of columns that it may change; false if there are none.
bool log_sweep(CutModel& model, const CutterSweep& sweep, const Aabb& front, uint32_t mark) {
    const auto number = static_cast<uint32_t>(model.log.size());
    Aabb path;
    path.extend(sweep.from);
    path.extend(sweep.to);
    bool noted = model.columns.u_count() == 0;
    for_tiles_of_columns(model, front, [&](size_t tile) {
        append(model.history[tile], number, path);
        noted = true;
    });
    if (noted) model.log.push_back(sweep, mark);
    return noted;
}

/// Whether the cutter is where another move ended, so that it has already cut there.
bool continues(const CutterSweep& sweep, const CutterSweep& last) {
    return last.cutter == sweep.cutter && last.to == sweep.from
           && last.orientation == sweep.orientation;
}

} // namespace

std::optional<ReadySweep> prepare(CutModel& model, const CutterSweep& sweep) {
    const bool on = continues(sweep, model.last);
    if (model.last.cutter != sweep.cutter) model.last.cutter = sweep.cutter;
    model.last.to = sweep.to;
    model.last.orientation = sweep.orientation;
    const Aabb front = on ? front_bounds(sweep, model.outer_box.max.z) : bounds(sweep);
    if (!overlaps(front, model.outer_box)) return std::nullopt;
    return ReadySweep{.sweep = &sweep, .front = front, .mark = ++model.marks};
}

std::optional<ReadySweep> begin(CutModel& model, const CutterSweep& sweep) {
    const std::optional<ReadySweep> ready = prepare(model, sweep);
    if (!ready || !log_sweep(model, sweep, ready->front, ready->mark)) return std::nullopt;
    return ready;
}

TileBoxes& boxes_of(CutModel& model, int family) {
    return family == column_family ? model.column_boxes
                                   : model.line_boxes[static_cast<size_t>(family)];
}

ScanLines& family_of(CutModel& model, int family) {
    return family == column_family ? model.columns
                                   : model.lines.families[static_cast<size_t>(family)];
}

LineRange range_of(const CutModel& model, int family, const Aabb& front) {
    return family == column_family ? cells_in(model, front) : lines_in(model, family, front);
}

namespace {

/// Largest number of tiles of one family whose boxes are outdated.
size_t most_stale(const CutModel& model) {
    size_t most = model.column_boxes.stale_tiles.size();
    for (const TileBoxes& boxes : model.line_boxes) most = std::max(most, boxes.stale_tiles.size());
    return most;
}

} // namespace

void fit_when_many_are_stale(CutModel& model) {
    if (most_stale(model) >= TileBoxes::most_stale) fit_boxes(model);
}

double reported(CutModel& model, const RemovalSums& sums) {
    const double h = model.lines.grid.spacing;
    model.volume_owed += h * h * (sums.beyond + h * sums.points);
    const double now = std::max(0.0, model.volume_owed);
    model.volume_owed -= now;
    return now;
}

namespace {

/// The outcome of one tile, stored until all threads are done.
struct StoredOutcome {
    uint32_t sweep;
    int family;
    uint32_t piece;
    size_t tile;
    TileOutcome outcome;
};

/// Consecutive moves. Each thread has its own tiles, so the order within a tile is kept.
class Batch {
public:
    Batch(CutModel& model, std::span<const CutterSweep> sweeps) : model_(model) {
        for (const CutterSweep& sweep : sweeps) ready_.push_back(begin(model, sweep));
    }
    /// A single move, which has begun.
    Batch(CutModel& model, const ReadySweep& sweep) : model_(model), ready_{sweep} {}

    /// Errors: std::bad_alloc, after all threads have ended.
    std::vector<double> run(unsigned threads) {
        kept_.resize(threads);
        std::vector<std::exception_ptr> failures(threads);
        const auto work_safely = [&](unsigned thread) {
            try {
                work(thread);
            } catch (...) {
                failures[thread] = std::current_exception();
            }
        };
        std::vector<std::thread> others;
        unsigned next = 1;
        try {
            for (; next < threads; ++next) others.emplace_back(work_safely, next);
        } catch (const std::exception&) {
            // The system has no more threads or memory for them: this one does their work.
        }
        work_safely(0);
        for (; next < threads; ++next) work_safely(next);
        for (std::thread& other : others) other.join();
        for (const std::exception_ptr& failure : failures)
            if (failure) std::rethrow_exception(failure);
        return gather();
    }

private:
    void work(unsigned thread) {
        const auto threads = static_cast<unsigned>(kept_.size());
        for (uint32_t i = 0; i < ready_.size(); ++i)
            for (int family = 0; ready_[i] && family < families; ++family) {
                const auto across = static_cast<size_t>(boxes_of(model_, family).u_tiles);
                const auto mine = [&](size_t tile) {
                    return (tile % across + tile / across + static_cast<size_t>(family)) % threads
                           == thread;
                };
                cut_tiles(model_, family, *ready_[i], mine,
                          [&](uint32_t piece, size_t tile, const TileOutcome& outcome) {
                              if (outcome.blocks != 0)
                                  kept_[thread].push_back({i, family, piece, tile, outcome});
                          });
            }
    }

    /// Sums up in the order of a single thread, so that the result does not depend on the number of
    /// threads.
    std::vector<double> gather() {
        std::vector<StoredOutcome> all;
        for (const auto& some : kept_) all.insert(all.end(), some.begin(), some.end());
        std::sort(all.begin(), all.end(), [](const StoredOutcome& a, const StoredOutcome& b) {
            return std::tie(a.sweep, a.family, a.piece, a.tile)
                   < std::tie(b.sweep, b.family, b.piece, b.tile);
        });
        std::vector<RemovalSums> sums(ready_.size());
        for (const StoredOutcome& one : all) {
            sums[one.sweep].beyond += one.outcome.removed.beyond;
            sums[one.sweep].points += one.outcome.removed.points;
            boxes_of(model_, one.family).note(one.tile, one.outcome.blocks);
        }
        std::vector<double> volumes;
        for (const RemovalSums& sum : sums) volumes.push_back(reported(model_, sum));
        fit_when_many_are_stale(model_);
        return volumes;
    }

    CutModel& model_;
    std::vector<std::optional<ReadySweep>> ready_;
    std::vector<std::vector<StoredOutcome>> kept_; // by thread
};

/// Cuts all tiles that a sweep may change.
RemovalSums cut_all_tiles(CutModel& model, const ReadySweep& ready) {
    RemovalSums sums;
    for (int family = 0; family < families; ++family)
        cut_tiles(
            model, family, ready, [](size_t) { return true; },
            [&](uint32_t, size_t tile, const TileOutcome& outcome) {
                sums.beyond += outcome.removed.beyond;
                sums.points += outcome.removed.points;
                boxes_of(model, family).note(tile, outcome.blocks);
            });
    return sums;
}

} // namespace

Aabb box_of_cuts(const CutModel& model, size_t first) {
    Aabb box;
    for (size_t i = first; i < model.log.size(); ++i) {
        const LoggedSweep logged = model.log[i];
        if (i > 0 && continues(logged.sweep, model.log[i - 1].sweep))
            box.extend(front_bounds(logged.sweep, model.outer_box.max.z));
        else
            box.extend(logged.box);
    }
    return box;
}

namespace {

/// Number of lines and columns within a box.
double lines_near(const CutModel& model, const Aabb& front) {
    double lines = 0.0;
    for (int family = 0; family < families; ++family) {
        const LineRange range = range_of(model, family, front);
        lines += double(range.u_last - range.u_first) * double(range.v_last - range.v_first);
    }
    return lines;
}

} // namespace

double cut(CutModel& model, const CutterSweep& sweep, unsigned threads) {
    constexpr double many_lines = 200'000; // some milliseconds, many times the start of a thread
    const std::optional<ReadySweep> ready = begin(model, sweep);
    if (!ready) return reported(model, {});
    if (threads > 1 && lines_near(model, ready->front) > many_lines)
        return Batch(model, *ready).run(threads)[0];
    const RemovalSums sums = cut_all_tiles(model, *ready);
    fit_when_many_are_stale(model);
    return reported(model, sums);
}

TrialCut::TrialCut(CutModel& model, const CutterSweep& sweep)
    : model_(&model),
      last_before_(model.last),
      log_before_(model.log.sizes()),
      marks_before_(model.marks) {
    model.is_on_trial = true;
    const std::optional<ReadySweep> ready = begin(model, sweep);
    if (!ready) return;
    is_near_ = true;
    front_ = ready->front;
    for (int family = 0; family < families; ++family) {
        if (family == column_family && model.columns.u_count() == 0) break;
        const TileBoxes& boxes = boxes_of(model, family);
        stale_before_[static_cast<size_t>(family)] = boxes.stale_tiles.size();
        for_tiles(range_of(model, family, front_), boxes, [&](size_t tile) {
            tiles_.push_back(
                {family, tile, boxes.stale[tile], family_of(model, family).share_tile(tile)});
        });
    }
    const RemovalSums sums = cut_all_tiles(model, *ready);
    beyond_ = sums.beyond;
    points_ = sums.points;
}

TrialCut::~TrialCut() {
    if (!model_) return;
    CutModel& model = *model_;
    model.is_on_trial = false;
    model.last = last_before_;
    model.marks = marks_before_;
    if (!is_near_) return;
    for (SavedTile& saved : tiles_) {
        family_of(model, saved.family).put_back(saved.tile, std::move(saved.before));
        boxes_of(model, saved.family).stale[saved.tile] = saved.stale;
    }
    for (int family = 0; family < families; ++family)
        if (family != column_family || model.columns.u_count() > 0)
            boxes_of(model, family).stale_tiles.resize(stale_before_[static_cast<size_t>(family)]);
    for_tiles_of_columns(model, front_, [&](size_t tile) { remove_newest(model.history[tile]); });
    model.log.cut_back(log_before_);
}

double TrialCut::keep() {
    CutModel& model = *std::exchange(model_, nullptr);
    model.is_on_trial = false;
    if (is_near_) fit_when_many_are_stale(model);
    return reported(model, {beyond_, points_});
}

void note_search(CutModel& model, size_t box_tests) {
    constexpr size_t tests_per_tile = 1024; // with fewer, fitting takes longer than it saves
    model.loose_tests += box_tests;
    const size_t stale = most_stale(model);
    if (stale > 0 && model.loose_tests > tests_per_tile * stale) fit_boxes(model);
}

std::vector<double> cut(CutModel& model, std::span<const CutterSweep> sweeps, unsigned threads) {
    constexpr size_t batch = 512; // enough work to make the cost of starting threads negligible
    std::vector<double> volumes;
    for (size_t first = 0; first < sweeps.size(); first += batch) {
        Batch some(model, sweeps.subspan(first, std::min(batch, sweeps.size() - first)));
        const std::vector<double> here = some.run(std::max(1U, threads));
        volumes.insert(volumes.end(), here.begin(), here.end());
    }
    return volumes;
}

namespace {

/// Added where the front begins, mm; more than its rounding error.
constexpr double margin = 1e-6;

/// Distance behind the axis, seen from above along the move, up to which the surface of an element
/// faces the motion `by`; end faces count only if they are not covered.
double reach_back(const ProfileElement& e, const Vec3& by, bool bottom_open, bool top_open) {
    if (by.z == 0.0) return 0.0;
    const double widest = std::max(e.r0, e.r1);
    if (e.margin > 0.0) return widest + e.margin * std::abs(by.z) / glm::length(by);
    double back = 0.0;
    if (e.z1 > e.z0) {
        // The flank's normal is (cos, sin, -slope): it faces the motion where its cosine is at
        // least slope * by.z / length.
        const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
        back = widest * std::clamp(-slope * by.z / core::hypot(by.x, by.y), 0.0, 1.0);
    }
    if (by.z < 0.0 && bottom_open) back = std::max(back, e.r0);
    if (by.z > 0.0 && top_open) back = std::max(back, e.r1);
    return back;
}

/// The part of a disc from which the front of a cutter extends forwards: at least -back along the
/// path.
struct FrontDisc {
    double radius = 0.0, back = 0.0;
};

FrontDisc front_disc(const CutterSweep& sweep, double top) {
    const double lowest = std::min(sweep.from.z, sweep.to.z);
    FrontDisc disc;
    for (const Cutter::Piece& piece : sweep.cutter->pieces) {
        // Within a convex piece the elements cover each other's faces.
        const auto& all = piece.around.elements;
        for (size_t i = 0; i < all.size(); ++i) {
            const bool top_open = i + 1 == all.size() && lowest + all[i].z1 < top;
            const double back = reach_back(all[i], sweep.to - sweep.from, i == 0, top_open);
            disc.back = std::max(disc.back, back);
            disc.radius = std::max(disc.radius, bounds(all[i]).max.x);
        }
    }
    disc.back = std::min(disc.back + margin, disc.radius);
    return disc;
}

/// Extent of the part of the disc at least -back along a path in a direction, given by its
/// components along the path and across it.
double reach(const FrontDisc& disc, double along, double across) {
    if (along * disc.radius >= -disc.back) return disc.radius;
    const double chord = std::sqrt((disc.radius - disc.back) * (disc.radius + disc.back));
    return -disc.back * along + chord * std::abs(across);
}

} // namespace

Aabb front_bounds(const CutterSweep& sweep, double top) {
    Aabb front = bounds(sweep);
    const Vec3 by = sweep.to - sweep.from;
    const double length = core::hypot(by.x, by.y);
    if (!is_upright(sweep.orientation) || sweep.cutter->path_error > 0.0 || length <= margin)
        return front;
    const FrontDisc disc = front_disc(sweep, top);
    const double x = by.x / length, y = by.y / length;
    front.max.x = std::max(sweep.from.x, sweep.to.x) + reach(disc, x, y);
    front.min.x = std::min(sweep.from.x, sweep.to.x) - reach(disc, -x, y);
    front.max.y = std::max(sweep.from.y, sweep.to.y) + reach(disc, y, x);
    front.min.y = std::min(sweep.from.y, sweep.to.y) - reach(disc, -y, x);
    return front;
}

} // namespace core
