#include "app/session/recorded_run.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "app/session/conclusion.h"
#include "app/session/stopwatch.h"

namespace app {

core::Result<std::unique_ptr<RecordedRun>>
RecordedRun::open(const CheckJob& job, PreparedCheck check, size_t memory_budget) {
    if (const auto placed = place_check(job, check); !placed) return tl::unexpected(placed.error());
    std::unique_ptr<RecordedRun> run(new RecordedRun(std::move(check), memory_budget));
    run->needs_surface_ = job.needs_surface;
    run->after_block_ = job.after_block;
    if (!job.start_line.empty())
        if (const auto begun = run->runner_->start_at(job.start_line); !begun)
            return tl::unexpected(named(begun.error(), job.program));
    run->marks_[0].findings = run->record().findings.size();
    run->keyframes_.note(0, 0.0, run->runner_->place());
    run->told_.assumptions = run->record().assumptions;
    return run;
}

RecordedRun::RecordedRun(PreparedCheck check, size_t memory_budget)
    : check_(std::move(check)),
      runner_(std::make_unique<ProgramRunner>(check_)),
      replayer_(check_),
      keyframes_(memory_budget) {}

bool RecordedRun::advance() {
    if (is_complete_) return false;
    const Stopwatch work;
    if (!runner_->advance()) {
        finish();
        return false;
    }
    const double seconds = marks_.back().seconds + work.seconds();
    marks_.push_back({seconds, record().findings.size()});
    keyframes_.note(last_place(), seconds, runner_->place());
    if (!after_block_ || after_block_(runner_->progress())) return true;
    runner_->stop_here();
    finish();
    return false;
}

void RecordedRun::finish() {
    is_complete_ = true;
    told_.findings = record().findings;
    for (const MadeChange& made : changes_)
        check_.run.assumptions.push_back(
            fmt::format("from block {} on, {}", made.block, text_of(made.change)));
    check_.run.times.check = marks_.back().seconds;
    conclude(check_, runner_->place().machine, runner_->length_doubts(), needs_surface_);
}

const core::Setup& RecordedRun::setup_at(size_t block) const {
    for (size_t i = changes_.size(); i-- > 0;)
        if (changes_[i].block <= block) return *setups_[i];
    return check_.run.setup;
}

void RecordedRun::change_at(size_t place, RunPlace& state) {
    for (size_t i = 0; i < changes_.size(); ++i) {
        if (changes_[i].block != place) continue;
        core::Setup scratch = i == 0 ? check_.run.setup : *setups_[i - 1]; // as it was for this one
        [[maybe_unused]] const auto done = apply(changes_[i].change, scratch, state);
        assert(done);
    }
}

core::Result<RunPlace> RecordedRun::place_at(size_t place) {
    while (last_place() < place && advance()) {
    }
    if (place > last_place())
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("the program ends after {} blocks", last_place()));
    // Behind the end the runner has closed what was open.
    if (place == last_place() && !is_complete_) return runner_->place();
    return replayed(place);
}

RunPlace RecordedRun::replayed(size_t place) {
    const Keyframe& frame = keyframes_.before(place);
    RunPlace state = frame.restored();
    if (frame.blocks == 0) change_at(0, state); // it is the program's start, whatever was changed
    take_to(state, frame.blocks, place);
    return state;
}

void RecordedRun::take_to(RunPlace& state, size_t from, size_t place) {
    assert(from <= place && place <= last_place());
    if (const Keyframe& frame = keyframes_.before(place); frame.blocks > from) {
        state = frame.restored();
        from = frame.blocks;
    }
    while (from < place) {
        replayer_.use(setup_at(from));
        [[maybe_unused]] const auto step = replayer_.step(state);
        assert(step && *step);
        ++from;
        change_at(from, state);
        keyframes_.note(from, marks_[from].seconds, state);
    }
}

size_t RecordedRun::restart_place(size_t place) {
    // Blocks whose time was still open, and those of a length doubt, are run again whole.
    while (true) {
        const RunPlace state = replayed(place);
        size_t first = std::min<size_t>(place, state.clock.first_open);
        if (state.lengths.is_open)
            first = std::min<size_t>(first, core::value_of(state.lengths.doubts.back().first));
        const bool is_open = first < place && replayed(first).lengths.is_open;
        if (!is_open) return first;
        place = first;
    }
}

void RecordedRun::record_again_from(size_t place) {
    const size_t first = restart_place(place);
    const RunPlace state = replayed(first); // the runner's own may hold what is taken back
    CheckRun& run = check_.run;
    if (is_complete_) {
        run.findings = told_.findings;
        run.assumptions = told_.assumptions;
        run.taken_in.clear();
        run.comparison.reset();
        run.surface.reset();
        run.stock.reset();
    }
    is_complete_ = false;
    runner_->go_back(state, first, marks_[first].findings);
    for (size_t block = first; block < place; ++block) {
        runner_->use(setup_at(block));
        if (block > first) change_at(block, runner_->place_to_change());
        [[maybe_unused]] const bool done = runner_->advance();
        assert(done);
    }
    if (first < place) change_at(place, runner_->place_to_change());
    runner_->use(setup_at(place));
    marks_.resize(place + 1);
}

void RecordedRun::forget_from(size_t place) {
    keyframes_.drop_after(place == 0 ? 0 : place - 1);
    while (!changes_.empty() && changes_.back().block > place) {
        changes_.pop_back();
        setups_.pop_back();
    }
}

core::Result<void> RecordedRun::change(size_t place, const WhatIf& change) {
    FEELER_TRY(RunPlace state, place_at(place));
    auto setup = std::make_unique<core::Setup>(setup_at(place));
    if (const auto done = apply(change, *setup, state); !done) return done;
    forget_from(place);
    record_again_from(place);
    changes_.push_back({place, change});
    setups_.push_back(std::move(setup));
    runner_->place_to_change() = std::move(state);
    runner_->use(*setups_.back());
    return {};
}

core::Result<size_t> RecordedRun::take_back() {
    if (changes_.empty())
        return core::fail(core::ErrorCode::invalid_value, "nothing has been changed");
    const size_t place = changes_.back().block;
    const auto setup = std::move(setups_.back()); // the runner looks at it until it went back
    changes_.pop_back();
    setups_.pop_back();
    forget_from(place);
    record_again_from(place);
    return place;
}

} // namespace app
