#pragma once

#include <array>
#include <bitset>
#include <deque>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/dbm/cutter.h"
#include "core/dbm/solid.h"
#include "core/dbm/tile_boxes.h"

namespace core {

template <typename T>
/// A list that changes only at its end, stored in chunks that copies share:
/// a copy costs a pointer per chunk.
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
    /// Removes all elements from number `size` on.
    void truncate(size_t size) {
        chunks_.resize((size + chunk_size - 1) / chunk_size);
        if (const size_t rest = size % chunk_size; rest != 0) {
            own_last_chunk();
            std::vector<T>& last = *chunks_.back();
            last.erase(last.begin() + static_cast<std::ptrdiff_t>(rest), last.end());
        }
        size_ = size;
    }

private:
    void own_last_chunk() {
        if (chunks_.back().use_count() > 1)
            chunks_.back() = std::make_shared<std::vector<T>>(*chunks_.back());
    }

    std::vector<std::shared_ptr<std::vector<T>>> chunks_;
    size_t size_ = 0;
};

/// One executed move of a cutter, with the box of what it may have removed.
struct LoggedSweep {
    CutterSweep sweep;
    Aabb box;
};

/// A prism with eight sides around everything that a tilted cutter may remove on one move. It
/// stands along the tool axis, so a line along Z that passes beside the cutter mostly misses it.
class TiltedPrism {
public:
    explicit TiltedPrism(const CutterSweep& sweep);

    /// Whether the box may come to a square between two heights.
    bool comes_to(const Square& square, const Interval& heights) const;

private:
    // Unit vectors: the tool axis, one across it and level, one across both, and those between
    // these two.
    std::array<Vec3, 5> axes_;
    std::array<double, 5> least_, most_; // along each
};

/// The executed moves in order. A move that continues where the last one ended, with the same
/// cutter in the same orientation, takes some 36 bytes.
class SweepLog {
public:
    size_t size() const { return entries_.size(); }
    /// Adds a move with a number above those of all others; by default one more than the last.
    void push_back(const CutterSweep& sweep) { push_back(sweep, last_mark() + 1); }
    void push_back(const CutterSweep& sweep, uint32_t mark);

    /// The index of the move with a number, which must be in the log.
    size_t index_of(uint32_t mark) const;
    /// The number of move `i`.
    uint32_t mark(size_t i) const;

    /// The sizes of the lists within, for cut_back().
    struct Sizes {
        size_t attitudes, positions, entries, marks;
    };
    Sizes sizes() const {
        return {attitudes_.size(), positions_.size(), entries_.size(), marks_.size()};
    }
    /// Removes the moves added since then.
    void cut_back(const Sizes& sizes);
    /// Removes all but the first moves.
    void keep_first(size_t moves);

    LoggedSweep operator[](size_t i) const;
    uint32_t block(size_t i) const { return entries_[i].block; }
    /// The box of what move `i` may have removed.
    Aabb box(size_t i) const;
    /// The box of the tip's path in move `i`.
    Aabb path_box(size_t i) const;

private:
    /// A cutter and its orientation; `body` is its box relative to the tip.
    struct Attitude {
        std::shared_ptr<const Cutter> cutter;
        Mat3 orientation;
        Aabb body;
    };
    struct Entry {
        uint32_t end; // the move goes from position end - 1 to position end
        uint32_t attitude;
        uint32_t block;
    };
    /// The move `first` and those after it have consecutive numbers from `mark` on.
    struct MarkRun {
        uint32_t first, mark;
    };
    uint32_t last_mark() const;

    SharedLog<Attitude> attitudes_;
    SharedLog<Vec3> positions_;
    SharedLog<Entry> entries_;
    SharedLog<MarkRun> marks_;
};

/// The moves first .. last of a log, and a box around the paths of their tips.
struct SweepRun {
    uint32_t first = 0, last = 0;
    Aabb paths;
};

/// Adds the newest move to a list of runs; `path` is the box of its tip's path.
void append(SharedLog<SweepRun>& runs, uint32_t number, const Aabb& path);

/// Removes the newest move from a list of runs.
void remove_newest(SharedLog<SweepRun>& runs);

/// A stock after some cuts: the discrete boundary model; an outer model that contains every point
/// of the stock; and the cuts themselves, from which both can be recomputed at any finer mesh size.
///
/// The columns are the outer model of the Z family: cell (i, j) is between lines i - 1, i and j -
/// 1, j, and its intervals contain every height at which the stock may have a point in the cell. A
/// copy is a snapshot; it shares everything that neither side has changed since.
struct CutModel {
    Solid solid;
    Aabb outer_box; // of the solid with its tolerance and play
    Dbm lines;
    ScanLines columns; // empty if the model has no columns
    std::array<TileBoxes, 3> line_boxes;
    TileBoxes column_boxes;
    SweepLog log;       // the moves that came near the stock, with their marks
    uint32_t marks = 0; // given out so far, from 1: one for each move that came to `outer_box`
    std::vector<SharedLog<SweepRun>> history; // per tile of columns: the moves that came near it
    CutterSweep last;                         // last of all moves, also those away from the stock
    double volume_owed = 0.0;                 // removed but not yet reported (see cut), mm3
    size_t loose_tests = 0;                   // box tests by searches since all boxes were fitted
    bool is_on_trial = false;                 // the last cut may be taken back (TrialCut)

    // Positions of the lines and of the corners of cells, along X, Y, Z.
    std::array<std::vector<double>, 3> positions;
    std::array<std::vector<double>, 2> corners;
};

/// Whether a model keeps columns. Without them it gives no lower bound.
enum class WithColumns { no, yes };

/// The uncut model.
///
/// Errors:  those of scan().
Result<CutModel> make_cut_model(Solid solid, double spacing,
                                double memory_limit = default_memory_limit,
                                WithColumns with_columns = WithColumns::yes);

/// Removes what one move of a cutter sweeps and returns the removed volume, mm3.
///
/// The volume counts grid points and the overlap of ends beyond their cells, weighted by the
/// normals there (README.md, "Volume"): additive over cuts, and exact to first order for faces of
/// any direction. The volume of one small cut may come out negative; such a remainder is carried
/// over to the next cuts, so no reported volume is negative and the sum is right.
///
/// `threads`: may be used for a move that comes near very many lines. Any number gives the same
/// bits.
double cut(CutModel& model, const CutterSweep& sweep, unsigned threads = 1);

/// Removes what several moves sweep, in order, on several threads; returns the volume removed by
/// each.
///
/// Result:  the same bits for any number of threads.
/// Cost:    with hundreds of moves, two threads take about half of the time of one.
std::vector<double> cut(CutModel& model, std::span<const CutterSweep> sweeps, unsigned threads);

/// A cut that can be taken back, at a cost that depends on the tiles that it touches and not on the
/// size of the model. Until it is decided, the model must not change otherwise; boxes around the
/// cut are as before it, so searches are right.
class TrialCut {
public:
    TrialCut(CutModel& model, const CutterSweep& sweep);
    TrialCut(const TrialCut&) = delete;
    TrialCut& operator=(const TrialCut&) = delete;
    /// Takes the cut back unless it was kept.
    ~TrialCut();

    /// Whether the move comes near the stock.
    bool is_near() const { return is_near_; }

    /// Makes it a cut like any other; returns the removed volume, as cut().
    double keep();

private:
    struct SavedTile {
        int family;
        size_t tile;
        uint16_t stale;
        std::shared_ptr<ScanTile> before;
    };

    CutModel* model_; // null once it is kept
    bool is_near_ = false;
    Aabb front_;
    double beyond_ = 0.0, points_ = 0.0; // removed, see RemovalSums
    CutterSweep last_before_;
    SweepLog::Sizes log_before_;
    uint32_t marks_before_ = 0;
    std::array<size_t, 4> stale_before_{}; // numbers of stale tiles
    std::vector<SavedTile> tiles_;
};

/// A box around what the logged moves from number `first` on can have removed.
Aabb box_of_cuts(const CutModel& model, size_t first);

/// Counts the box tests of a search, and refits the boxes around recent cuts once searches have
/// spent as much on outdated ones as refitting costs. Does not change any result.
void note_search(CutModel& model, size_t box_tests);

/// The square of a column, clipped to the extent of the stock.
Square cell_square(const CutModel& model, int i, int j);

/// A logged move near some cells.
struct NearSweep {
    LoggedSweep logged;
    std::optional<TiltedPrism> box; // none if the cutter is upright
};

/// Logged moves by their index, shared by the cells that they come near.
using SweepPool = std::unordered_map<size_t, NearSweep>;

/// The logged moves that may have cut a cell, in order.
class CellSweeps {
public:
    /// With a pool, moves are kept there; it must outlive this.
    explicit CellSweeps(SweepPool* pool = nullptr) : pool_(pool) {}
    CellSweeps(CellSweeps&&) = default;
    CellSweeps& operator=(CellSweeps&&) = default;

    size_t size() const { return sweeps_.size(); }
    const NearSweep& operator[](size_t i) const { return *sweeps_[i]; }

    /// Adds those near cell (i, j) from index `first` of the log on.
    void add(const CutModel& model, int i, int j, size_t first);

private:
    std::vector<const NearSweep*> sweeps_;
    std::deque<NearSweep> own_; // without a pool
    SweepPool* pool_;
};

CellSweeps sweeps_near_cell(const CutModel& model, int i, int j);

/// What is left of the stock in a square within a cell, between two heights, recomputed from the
/// moves that may have cut there. The square is divided into quarters; what a move sweeps at a
/// corner is computed once for all quarters, and quarters of quarters, that share it.
class SquareCuts {
public:
    /// `near`: those of the cell; they and the model must outlive this.
    SquareCuts(const CutModel& model, const CellSweeps& near, const Square& square,
               const Interval& heights);

    const Square& square() const { return square_; }

    /// The material on the line along Z through the centre.
    IntervalList line_at_centre() const;

    /// Quarter 0, 1: those at the lower Y, by X; 2, 3: those at the upper Y.
    Square quarter(int number) const;

    /// The heights at which a quarter may contain material.
    IntervalList column(int quarter);

    /// The same as this for a quarter, and heights within these.
    SquareCuts within(int quarter, const Interval& heights) const;

private:
    friend class KeptSquare;

    /// A convex piece of a cutter on one move. `at`: the segments that it sweeps on lines along Z
    /// through the corners of the quarters, by X and then Y; computed on demand.
    struct PieceCut {
        const LoggedSweep* sweep;
        const TiltedPrism* box; // null: the cutter is upright
        const Cutter::Piece* piece;
        std::array<std::optional<Interval>, 9> at;
        std::bitset<9> is_known;
    };

    SquareCuts(const CutModel& model, const Square& square, const Interval& heights)
        : model_(&model), square_(square), heights_(heights) {}
    double x(int column) const;
    double y(int row) const;
    const std::optional<Interval>& segment(PieceCut& cut, int column, int row) const;
    /// What a cut covers in a whole quarter; none if it covers nothing between the heights `left`.
    std::optional<Interval> covered(PieceCut& cut, int quarter, const Interval& left) const;
    /// Adds the moves near the cell from number `first` on.
    void add(const CellSweeps& near, size_t first);
    /// Removes from the line through the centre, or from the column of a quarter, what the cuts
    /// from number `first` on remove there.
    void subtract_from_line(IntervalList& line, size_t first) const;
    void subtract_from_column(IntervalList& column, int quarter, size_t first);

    const CutModel* model_;
    Square square_;
    Interval heights_;
    std::vector<PieceCut> cuts_;
};

/// How much may be kept: squares, moves, and pieces of moves in squares, some 300 bytes each.
struct KeptBudget {
    size_t most;
    size_t used = 0;

    bool is_spent() const { return used > most; }
};

/// As SquareCuts between all heights, with all answers kept. Moves that come near the cell later
/// are taken into account when the square is asked next.
class KeptSquare {
public:
    /// `near`: the moves near the cell, all of which are in `cuts`; more may be added to its end.
    /// Both `near` and `budget` must outlive this.
    KeptSquare(SquareCuts cuts, const CellSweeps& near, KeptBudget& budget);

    const Square& square() const { return cuts_.square(); }
    const IntervalList& line_at_centre();
    Square quarter(int number) const { return cuts_.quarter(number); }
    const IntervalList& column(int quarter);
    /// The square of a quarter; null if so much is kept that no more squares are.
    KeptSquare* within(int quarter);
    /// A quarter that is not kept: SquareCuts::within().
    SquareCuts loose_within(int quarter, const Interval& heights);

private:
    /// Takes the moves into account that were added since the last call.
    void catch_up();

    SquareCuts cuts_;
    const CellSweeps* near_;
    size_t seen_; // moves of `near_` that `cuts_` knows
    KeptBudget* budget_;
    std::optional<IntervalList> line_;
    std::array<std::optional<IntervalList>, 4> columns_;
    std::array<std::unique_ptr<KeptSquare>, 4> quarters_;
};

/// The squares that searches against the same stock have recomputed, also while more is cut from
/// it. Not for several threads.
class KeptSquares {
public:
    static constexpr size_t usual_budget = 40'000;

    /// The model must outlive this; it may be cut, but cuts must not be taken back between two
    /// calls. When `most` is kept, no new squares are; those that are kept grow with later cuts,
    /// and all are dropped at twice as much.
    explicit KeptSquares(const CutModel& model, size_t most = usual_budget)
        : model_(&model), budget_{most} {}
    KeptSquares(const KeptSquares&) = delete;
    KeptSquares& operator=(const KeptSquares&) = delete;

    /// Null if the last cut may be taken back, or if so much is kept that no more cells are. Valid
    /// until the next call.
    KeptSquare* of_cell(int i, int j);

    size_t used() const { return budget_.used; }

    const CutModel& model() const { return *model_; }

private:
    struct Cell {
        explicit Cell(SweepPool* pool) : sweeps(pool) {}

        CellSweeps sweeps;
        size_t logged = 0; // size of the log when `sweeps` were last taken from it
        std::optional<KeptSquare> square;
    };

    const CutModel* model_;
    SweepPool pool_;
    std::map<std::pair<int, int>, Cell> cells_;
    KeptBudget budget_;
};

/// The heights at which the part `square` of cell (i, j) may contain material, recomputed from the
/// log.
IntervalList fresh_column(const CutModel& model, int i, int j, const Square& square);

/// The material on a line along Z through cell (i, j), recomputed from the log.
IntervalList fresh_line(const CutModel& model, int i, int j, double x, double y);

/// The numbers of the logged sweeps that came near the columns at a box, or within `reach` of it,
/// and whose tip may have come into it, in order.
std::vector<uint32_t> tips_near(const CutModel& model, const Aabb& box, double reach = 0.0);

} // namespace core
