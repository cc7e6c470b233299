#include <thread>

#include "core/dbm/sweep_front.h"
#include "core/dbm/tile_cutting.h"

namespace core {
namespace {

constexpr int column_family = 3; // beside the three of lines
constexpr int families = 4;

/// Notes the sweep for all tiles of columns that it may change; false when there are none.
bool log_sweep(CutModel& model, const CutterSweep& sweep, const Aabb& front) {
    const auto number = static_cast<uint32_t>(model.log.size());
    bool noted = model.columns.u_count() == 0;
    const LineRange tiles = tiles_of(cells_in(model, front));
    for (int v = tiles.v_first; v < tiles.v_last; ++v) {
        for (int u = tiles.u_first; u < tiles.u_last; ++u) {
            const auto tile = static_cast<size_t>(v * model.column_boxes.u_tiles + u);
            if (!overlaps(model.column_boxes.boxes[tile], front)) continue;
            append(model.history[tile], number);
            noted = true;
        }
    }
    if (noted) model.log.push_back(sweep);
    return noted;
}

/// Whether the cutter stands where the last move left it, having cut there.
bool goes_on(const CutModel& model, const CutterSweep& sweep) {
    const CutterSweep& last = model.last;
    return last.cutter == sweep.cutter && last.to == sweep.from
           && last.orientation == sweep.orientation;
}

/// The sweep as it will be cut, written down in the log; none if it does not come near the stock.
std::optional<ReadySweep> begin(CutModel& model, const CutterSweep& sweep) {
    const bool on = goes_on(model, sweep);
    if (model.last.cutter != sweep.cutter) model.last.cutter = sweep.cutter;
    model.last.to = sweep.to;
    model.last.orientation = sweep.orientation;
    const ReadySweep ready{.sweep = &sweep,
                           .front = on ? front_bounds(sweep, model.outer_box.max.z) : bounds(sweep),
                           .mark = static_cast<uint32_t>(model.log.size() + 1)};
    if (!overlaps(ready.front, model.outer_box) || !log_sweep(model, sweep, ready.front))
        return std::nullopt;
    return ready;
}

TileBoxes& boxes_of(CutModel& model, int family) {
    return family == column_family ? model.column_boxes
                                   : model.line_boxes[static_cast<size_t>(family)];
}

/// Runs `act(family, tile, outcome)` for every tile of lines and columns that `mine(family, tile)`
/// accepts, always in the same order, with `cut_tile` having been done.
template <typename Mine, typename Act>
void cut_tiles(CutModel& model, const ReadySweep& ready, const Mine& mine, const Act& act) {
    const double top = model.outer_box.max.z;
    for (int family = 0; family < families; ++family) {
        const bool columns = family == column_family;
        if (columns && model.columns.u_count() == 0) return;
        const LineRange range =
            columns ? cells_in(model, ready.front) : lines_in(model, family, ready.front);
        for (const Cutter::Piece& piece : ready.sweep->cutter->pieces) {
            const RevolvedProfile& profile = columns ? piece.within : piece.around;
            const LanePlan plan = lane_plan(profile, *ready.sweep, columns ? 2 : family, top);
            for_tiles(range, boxes_of(model, family), [&](size_t tile) {
                if (!mine(family, tile)) return;
                act(family, tile,
                    columns ? cut_columns(model, tile, range, plan, ready)
                            : cut_lines(model, tile, range, plan, ready));
            });
        }
    }
}

/// How many tiles of one family wait for their boxes, at most.
size_t most_stale(const CutModel& model) {
    size_t most = model.column_boxes.stale_tiles.size();
    for (const TileBoxes& boxes : model.line_boxes) most = std::max(most, boxes.stale_tiles.size());
    return most;
}

void fit_when_many_are_stale(CutModel& model) {
    if (most_stale(model) >= TileBoxes::most_stale) fit_boxes(model);
}

/// What is to be reported of a volume that has been removed.
double reported(CutModel& model, const LineSums& sums) {
    const double h = model.lines.grid.spacing;
    model.volume_owed += h * h * (sums.beyond + h * sums.points);
    const double now = std::max(0.0, model.volume_owed);
    model.volume_owed -= now;
    return now;
}

/// What became of one tile, kept until all threads are done.
struct KeptOutcome {
    uint32_t sweep;
    int family;
    size_t tile;
    TileOutcome outcome;
};

/// Some moves in a row, each thread with tiles of its own: within a tile the order stays.
class Batch {
public:
    Batch(CutModel& model, std::span<const CutterSweep> sweeps) : model_(model) {
        for (const CutterSweep& sweep : sweeps) ready_.push_back(begin(model, sweep));
    }

    std::vector<double> run(unsigned threads) {
        kept_.resize(threads);
        std::vector<std::thread> others;
        for (unsigned thread = 1; thread < threads; ++thread)
            others.emplace_back([this, thread] { work(thread); });
        work(0);
        for (std::thread& other : others) other.join();
        return gather();
    }

private:
    void work(unsigned thread) {
        const auto threads = static_cast<unsigned>(kept_.size());
        const auto mine = [&](int family, size_t tile) {
            const auto across = static_cast<size_t>(boxes_of(model_, family).u_tiles);
            return (tile % across + tile / across + static_cast<size_t>(family)) % threads
                   == thread;
        };
        for (uint32_t i = 0; i < ready_.size(); ++i) {
            if (!ready_[i]) continue;
            cut_tiles(model_, *ready_[i], mine,
                      [&](int family, size_t tile, const TileOutcome& outcome) {
                          if (outcome.blocks != 0)
                              kept_[thread].push_back({i, family, tile, outcome});
                      });
        }
    }

    /// Sums up in the order in which one thread would have come by, whoever did the work.
    std::vector<double> gather() {
        std::vector<KeptOutcome> all;
        for (const auto& some : kept_) all.insert(all.end(), some.begin(), some.end());
        std::stable_sort(all.begin(), all.end(), [](const KeptOutcome& a, const KeptOutcome& b) {
            if (a.sweep != b.sweep) return a.sweep < b.sweep;
            return a.family != b.family ? a.family < b.family : a.tile < b.tile;
        });
        std::vector<LineSums> sums(ready_.size());
        for (const KeptOutcome& one : all) {
            sums[one.sweep].beyond += one.outcome.removed.beyond;
            sums[one.sweep].points += one.outcome.removed.points;
            boxes_of(model_, one.family).note(one.tile, one.outcome.blocks);
        }
        std::vector<double> volumes;
        for (const LineSums& sum : sums) volumes.push_back(reported(model_, sum));
        fit_when_many_are_stale(model_);
        return volumes;
    }

    CutModel& model_;
    std::vector<std::optional<ReadySweep>> ready_;
    std::vector<std::vector<KeptOutcome>> kept_; // by thread
};

} // namespace

double cut(CutModel& model, const CutterSweep& sweep) {
    const std::optional<ReadySweep> ready = begin(model, sweep);
    LineSums sums;
    if (ready) {
        cut_tiles(
            model, *ready, [](int, size_t) { return true; },
            [&](int family, size_t tile, const TileOutcome& outcome) {
                sums.beyond += outcome.removed.beyond;
                sums.points += outcome.removed.points;
                boxes_of(model, family).note(tile, outcome.blocks);
            });
        fit_when_many_are_stale(model);
    }
    return reported(model, sums);
}

void note_search(CutModel& model, size_t box_tests) {
    constexpr size_t tests_per_tile = 1024; // with fewer, fitting takes longer than it saves
    model.loose_tests += box_tests;
    const size_t stale = most_stale(model);
    if (stale > 0 && model.loose_tests > tests_per_tile * stale) fit_boxes(model);
}

std::vector<double> cut(CutModel& model, std::span<const CutterSweep> sweeps, unsigned threads) {
    constexpr size_t batch = 512; // enough work that starting threads is nothing beside it
    std::vector<double> volumes;
    for (size_t first = 0; first < sweeps.size(); first += batch) {
        Batch some(model, sweeps.subspan(first, std::min(batch, sweeps.size() - first)));
        const std::vector<double> here = some.run(std::max(1U, threads));
        volumes.insert(volumes.end(), here.begin(), here.end());
    }
    return volumes;
}

} // namespace core
