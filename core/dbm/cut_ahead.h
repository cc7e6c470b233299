#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/dbm/cut_model.h"

namespace core {

/// Consecutive moves of a cutter, and what they change in a model, so that the same change can be
/// made in an equal model by copying.
class CutWindow {
public:
    CutWindow();
    ~CutWindow();
    CutWindow(const CutWindow&) = delete;
    CutWindow& operator=(const CutWindow&) = delete;

    size_t size() const;
    const CutterSweep& sweep(size_t i) const;

private:
    friend class CutAhead;
    struct Contents;

    std::unique_ptr<Contents> contents_;
};

/// Cuts a copy of a model ahead of its owner, by several threads, window by window. Every thread
/// has its own tiles (a shard), so each tile gets its moves in order, and the result does not
/// depend on the number of threads.
///
/// The owner makes the same moves later with `repeat`, which gives the same bits as cut() at the
/// cost of copying the changed lines. Between two moves the owner's model is as after cut(): all
/// searches, snapshots and further cuts work as usual.
///
/// Memory:  the copy shares tiles with the owner's model that neither has changed. A tile that was
///          cut is shared again once it has not been touched for many windows.
class CutAhead {
public:
    /// Copies the model. The owner may change it at once. Each family of lines is divided into
    /// `parts` shards.
    CutAhead(const CutModel& model, unsigned parts);

    unsigned shards() const { return static_cast<unsigned>(warm_.size()); }

    /// About how much memory a window takes for a move, bytes: an upper bound for a cutter that is
    /// one convex piece and material that is one interval on each line.
    double bytes_for(const CutterSweep& sweep) const;
    /// How much memory a finished window takes.
    static size_t bytes_in(const CutWindow& window);

    /// Prepares the next moves. `used`: a window that is not needed any more, to use its memory.
    ///
    /// Threads: one at a time, in the order of the moves; cut() may run meanwhile.
    std::unique_ptr<CutWindow> begin(std::vector<CutterSweep> sweeps,
                                     std::unique_ptr<CutWindow> used = {});

    /// Cuts the tiles of one shard in a window. The windows of a shard come in order.
    ///
    /// Threads: any, for different shards.
    void cut(CutWindow& window, unsigned shard);

    /// Completes a window that all shards have cut.
    static void finish(CutWindow& window);

    /// Makes move `i` of a finished window in a model that has made all moves before it. `sweep`
    /// must be equal to the move; its cutter and block are those of the model's log.
    ///
    /// Result:  as cut().
    static double repeat(const CutWindow& window, size_t i, const CutterSweep& sweep,
                         CutModel& model);

    /// Whether a move of a finished window changes any line.
    static bool changes_stock(const CutWindow& window, size_t i);

    /// Notes for the copy which tiles it can share with a model that has just made all moves of a
    /// window. Use the window for later moves.
    static void share(CutWindow& window, const CutModel& model);

private:
    CutModel model_; // without log and history; only the boxes of whole tiles are in use
    uint32_t windows_ = 0;
    std::vector<std::vector<uint32_t>>
        warm_; // by shard: tiles that are not shared, as far as known
    // By family and tile: the number of the last window that touched it; 0: it is cool.
    std::array<std::vector<uint32_t>, 4> touched_in_;
};

/// Makes the moves of a block in a model, from a window that foresaw them. The first move that was
/// not foreseen ends this: it and all later ones are cut as usual.
class CutReplay {
public:
    CutReplay() = default;
    /// The moves first .. last - 1 of a finished window.
    CutReplay(const CutWindow& window, size_t first, size_t last, const CutModel& model)
        : window_(&window), next_(first), last_(last), model_(&model) {}

    /// Makes a move in any model.
    ///
    /// Result:  as core::cut().
    double cut(CutModel& model, const CutterSweep& sweep, unsigned threads = 1);

    /// Notes a move that was made in another way.
    void skip(const CutModel& model, const CutterSweep& sweep);

    /// Whether exactly the moves that were foreseen were made.
    bool is_complete() const { return !is_lost_ && next_ == last_; }

private:
    bool foresaw(const CutterSweep& sweep) const {
        return !is_lost_ && next_ < last_ && cut_alike(sweep, window_->sweep(next_));
    }

    const CutWindow* window_ = nullptr;
    size_t next_ = 0, last_ = 0;
    const CutModel* model_ = nullptr; // others are cut as usual
    bool is_lost_ = false;
};

} // namespace core
