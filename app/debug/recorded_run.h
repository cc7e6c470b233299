#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

#include "app/check/check_job.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/check/run_state.h"
#include "app/debug/what_if.h"
#include "core/dbm/tile_boxes.h"

namespace app {

/// A list in pieces that several may share.
template <typename T>
class SharedPieces {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    static constexpr size_t piece = 64;

    SharedPieces() = default;
    /// Shares the pieces that are the same as in another one.
    SharedPieces(const std::vector<T>& list, const SharedPieces& like) : size_(list.size()) {
        for (size_t first = 0; first < list.size(); first += piece) {
            const size_t count = std::min(piece, list.size() - first);
            const size_t i = pieces_.size();
            const bool is_same =
                i < like.pieces_.size() && like.pieces_[i]->size() == count
                && std::memcmp(like.pieces_[i]->data(), list.data() + first, count * sizeof(T))
                       == 0;
            const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
            pieces_.push_back(is_same ? like.pieces_[i]
                                      : std::make_shared<const std::vector<T>>(
                                          begin, begin + static_cast<std::ptrdiff_t>(count)));
        }
    }

    std::vector<T> whole() const {
        std::vector<T> list;
        list.reserve(size_);
        for (const auto& part : pieces_) list.insert(list.end(), part->begin(), part->end());
        return list;
    }

    /// Bytes that it does not share with another one.
    size_t bytes_apart(const SharedPieces& other) const {
        size_t bytes = pieces_.size() * sizeof(pieces_[0]);
        for (size_t i = 0; i < pieces_.size(); ++i)
            if (i >= other.pieces_.size() || pieces_[i] != other.pieces_[i])
                bytes += pieces_[i]->size() * sizeof(T);
        return bytes;
    }

private:
    std::vector<std::shared_ptr<const std::vector<T>>> pieces_;
    size_t size_ = 0;
};

/// The boxes of a family of lines, to be had again bit for bit.
struct SavedBoxes {
    SharedPieces<core::Aabb> boxes, blocks;
    SharedPieces<core::BoxGap> gaps, block_gaps;
    core::TileBoxes rest; // what is small

    size_t bytes_apart(const SavedBoxes& other) const;
};

/// Takes the boxes out of where they are.
SavedBoxes kept(core::TileBoxes boxes, const SavedBoxes& like);

core::TileBoxes restored(const SavedBoxes& kept);

/// A place that is kept, to come back from. It shares with the keyframe before it what is the same.
struct Keyframe {
    size_t blocks = 0;    // that were run before it
    double seconds = 0.0; // of work from the first place to here
    RunState place;       // but for the boxes round its lines and columns
    std::array<SavedBoxes, 4> boxes;
    size_t bytes = 0; // that it does not share with the keyframe before it

    RunState restored() const;
};

/// Places along a run, kept within a budget of memory: close to one another where the run is looked
/// at, and farther apart the farther it is from there.
class Keyframes {
public:
    explicit Keyframes(size_t memory_budget) : budget_(memory_budget) {}

    /// Keeps a place if it is far enough from the one before it.
    void note(size_t blocks, double seconds, const RunState& place);

    /// The last one at or before a place; there is one, once the first place was added.
    const Keyframe& before(size_t blocks) const;

    /// Where the run is looked at, in seconds of work.
    void look_at(double seconds) { focus_ = seconds; }

    /// Forgets those after a place.
    void drop_after(size_t blocks);

    size_t memory() const { return memory_; }
    size_t size() const { return frames_.size(); }
    const std::vector<Keyframe>& frames() const { return frames_; }

private:
    /// Where the first keyframe behind a place is, or would be.
    size_t index_after(size_t blocks) const;
    /// Whether a keyframe there would be worth its memory.
    bool wants(size_t blocks, double seconds) const;
    void thin_out();
    void remove(size_t index);
    /// How bad it would be to go without a keyframe: 1 is a wait that is noticed.
    double worth(size_t index) const;

    size_t budget_;
    size_t memory_ = 0;
    double focus_ = 0.0;
    std::vector<Keyframe> frames_ = {};
};

/// A change and where it was made.
struct MadeChange {
    size_t block = 0; // it counts from this block on
    WhatIf change;
};

/// A check that is carried out piece by piece, every place of which can be had again, and that can
/// be changed on the way.
///
/// A place is counted in blocks that have been run: at place p block p of the record is the next.
class RecordedRun {
public:
    /// Of a check that was read, but not placed. The job's `after_block` can end it as it ends
    /// run_check.
    ///
    /// Errors: as run_check.
    static core::Result<std::unique_ptr<RecordedRun>> open(const CheckJob& job, PreparedCheck check,
                                                           size_t memory_budget);

    /// What is known so far: blocks in order, and findings as they were told. Once it is complete,
    /// what run_check gives.
    const CheckRun& record() const { return check_.run; }
    bool is_complete() const { return is_complete_; }
    /// The last place that is known.
    size_t last_place() const { return marks_.size() - 1; }
    /// How far it has come, 0..1, by lines.
    double share() const { return is_complete_ ? 1.0 : runner_->progress().share; }

    /// Carries the record on by a block; whether there was one.
    bool advance();

    const PreparedCheck& check() const { return check_; }
    /// That all places of the run refer to.
    gcode::ProgramLibrary& library() const { return *check_.library; }
    /// The set-up that a block is run under.
    const core::Setup& setup_at(size_t block) const;

    /// A copy of a place.
    ///
    /// Errors: the program does not go that far.
    /// Cost:   as take_to, from the nearest keyframe.
    core::Result<RunState> place_at(size_t place);
    /// Takes a copy of place `from` on to a later one that the record holds.
    ///
    /// Cost: running the blocks again, but for those before the nearest keyframe.
    void take_to(RunState& state, size_t from, size_t place);

    /// As BlockRunner::visit_ahead, from a copy of a place.
    void visit_ahead(size_t place, const RunState& state, const BlockVisit& visit) {
        replayer_.use(setup_at(place));
        replayer_.visit_ahead(state.control, state.lowering, visit);
    }

    /// Where one looks: keyframes are kept near it.
    void look_at(size_t place) { keyframes_.look_at(marks_[place].seconds); }
    const Keyframes& keyframes() const { return keyframes_; }

    /// Changes something from a place on, and drops what the record holds behind it, later changes
    /// included.
    ///
    /// Errors: as apply; the program does not go that far. Nothing has changed then.
    core::Result<void> change(size_t place, const WhatIf& change);
    /// Takes the last change back; the place where it was made.
    ///
    /// Errors: invalid_value when there is none.
    core::Result<size_t> take_back();
    const std::vector<MadeChange>& changes() const { return changes_; }

private:
    /// What the record was when it held so many blocks.
    struct Mark {
        double seconds = 0.0; // of work
        size_t findings = 0;
    };
    /// The run as it was told, before what only the whole of it says.
    struct Told {
        std::vector<core::Finding> findings;
        std::vector<std::string> assumptions;
    };

    RecordedRun(PreparedCheck check, size_t memory_budget);
    void finish();
    /// A copy of a place that the record holds, by way of keyframes, changes there included.
    RunState replayed(size_t place);
    /// Forgets the keyframes from a place on, and the changes behind it.
    void forget_from(size_t place);
    /// Makes the record go on from a place anew.
    void record_again_from(size_t place);
    /// The changes that are made at a place, to a copy of it.
    void change_at(size_t place, RunState& state);
    /// A place from which the record can be made again up to another one.
    size_t restart_place(size_t place);

    PreparedCheck check_;
    bool needs_surface_ = false;
    std::function<bool(const CheckProgress&)> after_block_ = {};
    std::unique_ptr<ProgramRunner> runner_;
    BlockRunner replayer_;
    Keyframes keyframes_;
    std::vector<Mark> marks_ = std::vector<Mark>(1); // by place
    std::vector<MadeChange> changes_ = {};
    std::vector<std::unique_ptr<core::Setup>> setups_ = {}; // behind each change
    Told told_ = {};
    bool is_complete_ = false;
};

} // namespace app
