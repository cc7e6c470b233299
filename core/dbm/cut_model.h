#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/dbm/cutter.h"
#include "core/dbm/solid.h"
#include "core/dbm/tile_boxes.h"

namespace core {

/// A list that only grows, but for its last element, in chunks that copies share: a copy costs a
/// pointer per chunk.
template <typename T>
class SharedLog {
public:
    static constexpr size_t chunk_size = 64;

    size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    const T& operator[](size_t i) const { return (*chunks_[i / chunk_size])[i % chunk_size]; }
    const T& back() const { return (*this)[size_ - 1]; }

    void push_back(const T& value) {
        if (size_ % chunk_size == 0)
            chunks_.push_back(std::make_shared<std::vector<T>>());
        else
            own_last_chunk();
        chunks_.back()->push_back(value);
        ++size_;
    }
    void replace_back(const T& value) {
        own_last_chunk();
        chunks_.back()->back() = value;
    }

private:
    void own_last_chunk() {
        if (chunks_.back().use_count() > 1)
            chunks_.back() = std::make_shared<std::vector<T>>(*chunks_.back());
    }

    std::vector<std::shared_ptr<std::vector<T>>> chunks_;
    size_t size_ = 0;
};

/// One move of a cutter that was carried out, with the box of what it may have removed.
struct LoggedSweep {
    CutterSweep sweep;
    Aabb box;
};

/// The moves that were carried out, in order. A move that goes on where the last one ended, with
/// the same cutter held the same way, takes some 36 bytes.
class SweepLog {
public:
    size_t size() const { return entries_.size(); }
    void push_back(const CutterSweep& sweep);

    LoggedSweep operator[](size_t i) const;
    uint32_t block(size_t i) const { return entries_[i].block; }
    /// The box of what move `i` may have removed.
    Aabb box(size_t i) const;

private:
    /// A cutter and how it is held; `body` is its box about its tip.
    struct Attitude {
        std::shared_ptr<const Cutter> cutter;
        Mat3 orientation;
        Aabb body;
    };
    struct Entry {
        uint32_t end; // the move goes from place end - 1 to place end
        uint32_t attitude;
        uint32_t block;
    };
    SharedLog<Attitude> attitudes_;
    SharedLog<Vec3> places_;
    SharedLog<Entry> entries_;
};

/// The numbers first .. last of moves in a log.
struct SweepRun {
    uint32_t first = 0, last = 0;
};

/// Adds the newest move to a list of runs.
void append(SharedLog<SweepRun>& runs, uint32_t number);

/// A stock as it is after some cuts: the discrete boundary model, an outer model that holds every
/// point of the stock, and the cuts themselves, from which either can be had again at any finer h.
///
/// The columns are the outer model of the Z family: cell (i, j) stands between lines i - 1, i and
/// j - 1, j, and its intervals hold every height at which the stock may have a point in the cell.
/// A copy is a snapshot; it shares whatever neither side has changed since.
struct CutModel {
    Solid solid;
    Aabb outer_box; // of the solid with its tolerance
    Dbm lines;
    ScanLines columns; // none, if the model was made without
    std::array<TileBoxes, 3> line_boxes;
    TileBoxes column_boxes;
    SweepLog log; // the moves that came near the stock; marks are numbers + 1
    std::vector<SharedLog<SweepRun>> history; // per tile of columns: which of them came near it
    CutterSweep last;                         // of all moves, near or not
    double volume_owed = 0.0;                 // removed, but not yet reported (see cut), mm3
    size_t loose_tests = 0;                   // of boxes, by searches since all boxes were fitted

    // Where lines run and where the corners of cells stand, along X, Y, Z.
    std::array<std::vector<double>, 3> places;
    std::array<std::vector<double>, 2> corners;
};

/// Whether a model keeps columns; without them it has no lower bound.
enum class WithColumns { no, yes };

/// The uncut model.
///
/// Errors: those of scan().
Result<CutModel> make_cut_model(Solid solid, double spacing,
                                double memory_limit = default_memory_limit,
                                WithColumns with_columns = WithColumns::yes);

/// Removes what one move of a cutter sweeps, and returns the volume, mm3.
///
/// The volume counts grid points and what ends lie beyond their cells, weighed by the normals there
/// (README.md, "Volume"): additive over cuts, and true to first order for faces of any direction.
/// One small cut alone may come out below 0; such a remainder is taken off the next ones, so that
/// nothing that is reported is negative and all of it adds up.
double cut(CutModel& model, const CutterSweep& sweep);

/// The same for many moves in order, on so many threads, and the volume that each removed.
///
/// Result: the same bits for any number of threads.
/// Cost:   on two threads some half of the time of one, if there are hundreds of moves.
std::vector<double> cut(CutModel& model, std::span<const CutterSweep> sweeps, unsigned threads);

/// Counts the boxes that a search has tested, and fits those round what has been cut since when
/// searches have spent as much on loose ones as the fitting costs. Changes no answer.
void note_search(CutModel& model, size_t box_tests);

/// The square of a column, clipped to where the stock can be.
Square cell_square(const CutModel& model, int i, int j);

/// The heights that cell (i, j)'s part `square` may hold matter at, worked out afresh from the log.
IntervalList fresh_column(const CutModel& model, int i, int j, const Square& square);

/// The matter on a line along Z through cell (i, j), worked out afresh from the log.
IntervalList fresh_line(const CutModel& model, int i, int j, double x, double y);

/// The numbers of the logged sweeps that may have come into a box, in order.
std::vector<uint32_t> sweeps_near(const CutModel& model, const Aabb& box);

/// Whether the model holds no matter any more.
bool is_gone(const CutModel& model);

} // namespace core
