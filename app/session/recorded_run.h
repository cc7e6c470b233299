#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "app/session/keyframes.h"
#include "app/session/program_runner.h"
#include "app/session/what_if.h"

namespace app {

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
    core::Result<RunPlace> place_at(size_t place);
    /// Takes a copy of place `from` on to a later one that the record holds.
    ///
    /// Cost: running the blocks again, but for those before the nearest keyframe.
    void take_to(RunPlace& state, size_t from, size_t place);

    /// As BlockRunner::visit_ahead, from a copy of a place.
    void visit_ahead(size_t place, const RunPlace& state, const BlockVisit& visit) {
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
    RunPlace replayed(size_t place);
    /// Forgets the keyframes from a place on, and the changes behind it.
    void forget_from(size_t place);
    /// Makes the record go on from a place anew.
    void record_again_from(size_t place);
    /// The changes that are made at a place, to a copy of it.
    void change_at(size_t place, RunPlace& state);
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
