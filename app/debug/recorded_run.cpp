#include "app/debug/recorded_run.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "app/base/stopwatch.h"
#include "app/check/block_runner.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/check/run_state.h"
#include "core/dbm/tile_boxes.h"

namespace app {

/// A list in pieces that copies can share.
template <typename T>
class SharedPieces {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    static constexpr size_t piece = 64;

    SharedPieces() = default;
    /// Shares the pieces that are equal in `like`.
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

    /// The number of bytes not shared with `other`.
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

/// The boxes of a family of scan lines, stored so that they can be restored bit for bit.
struct SavedBoxes {
    SharedPieces<core::Aabb> boxes, blocks;
    SharedPieces<core::BoxGap> gaps, block_gaps;
    core::TileBoxes rest; // the small members

    size_t bytes_apart(const SavedBoxes& other) const;
};

/// Stores boxes; shares pieces with `like`.
SavedBoxes saved(core::TileBoxes boxes, const SavedBoxes& like);

core::TileBoxes restored(const SavedBoxes& saved);

/// A stored run state. Shares equal data with the previous keyframe.
struct Keyframe {
    size_t blocks = 0;    // run before it
    double seconds = 0.0; // of work from the beginning to here
    RunState state;       // without the boxes of its scan lines and columns
    std::array<SavedBoxes, 4> boxes;
    size_t bytes = 0; // not shared with the previous keyframe

    RunState restored() const;
};

/// Keyframes along a run within a memory budget: close together near the position in focus, and
/// farther apart with the distance from it.
class Keyframes {
public:
    explicit Keyframes(size_t memory_budget) : budget_(memory_budget) {}

    /// Stores a keyframe if it is far enough from the one before it.
    void note(size_t blocks, double seconds, const RunState& state);

    /// The last keyframe at or before a position. Exists once the first position was added.
    const Keyframe& before(size_t blocks) const;

    /// Sets the position in focus, in seconds of work.
    void focus_on(double seconds) { focus_ = seconds; }

    /// Drops the keyframes after a position.
    void drop_after(size_t blocks);

    size_t memory() const { return memory_; }
    size_t size() const { return frames_.size(); }
    const std::vector<Keyframe>& frames() const { return frames_; }

private:
    /// The index of the first keyframe after a position, or where it would be inserted.
    size_t index_after(size_t blocks) const;
    /// Whether a keyframe at this position is worth its memory.
    bool wants(size_t blocks, double seconds) const;
    void thin_out();
    void remove(size_t index);
    /// The cost of dropping a keyframe: the wait that it would cause, relative to the bearable one.
    double worth(size_t index) const;

    size_t budget_;
    size_t memory_ = 0;
    double focus_ = 0.0;
    std::vector<Keyframe> frames_ = {};
};

size_t SavedBoxes::bytes_apart(const SavedBoxes& other) const {
    size_t bytes = boxes.bytes_apart(other.boxes) + blocks.bytes_apart(other.blocks)
                   + gaps.bytes_apart(other.gaps) + block_gaps.bytes_apart(other.block_gaps)
                   + rest.stale.size() * sizeof(uint16_t)
                   + rest.stale_tiles.size() * sizeof(uint32_t);
    for (const core::TileLevel& level : rest.above)
        bytes += level.boxes.size() * sizeof(core::Aabb);
    return bytes;
}

SavedBoxes saved(core::TileBoxes boxes, const SavedBoxes& like) {
    SavedBoxes saved;
    saved.boxes = {std::exchange(boxes.boxes, {}), like.boxes};
    saved.blocks = {std::exchange(boxes.blocks, {}), like.blocks};
    saved.gaps = {std::exchange(boxes.gaps, {}), like.gaps};
    saved.block_gaps = {std::exchange(boxes.block_gaps, {}), like.block_gaps};
    saved.rest = std::move(boxes);
    return saved;
}

core::TileBoxes restored(const SavedBoxes& saved) {
    core::TileBoxes boxes = saved.rest;
    boxes.boxes = saved.boxes.whole();
    boxes.blocks = saved.blocks.whole();
    boxes.gaps = saved.gaps.whole();
    boxes.block_gaps = saved.block_gaps.whole();
    return boxes;
}

namespace {

constexpr double near_spacing = 0.012; // seconds of work between keyframes near the focus
constexpr double far_spacing = 0.04;   // elsewhere, if there is memory
constexpr double longest_wait = 0.5;   // for a jump, seconds

/// The bearable wait for positions this many seconds of work away from the focus, seconds.
double bearable_wait(double away) { return std::clamp(away / 8.0, 0.02, longest_wait); }

size_t bytes_of(const core::ScanTile& tile) {
    return sizeof(tile) + tile.layers.capacity() * sizeof(core::ScanTile::Layer)
           + tile.marks.capacity() * sizeof(core::ScanTile::Marks);
}

size_t bytes_apart(const core::ScanLines& lines, const core::ScanLines& other) {
    size_t bytes = lines.tile_count() * sizeof(std::shared_ptr<core::ScanTile>);
    const bool comparable = lines.tile_count() == other.tile_count();
    for (size_t i = 0; i < lines.tile_count(); ++i)
        if (lines.tile(i) && (!comparable || lines.tile(i) != other.tile(i)))
            bytes += bytes_of(*lines.tile(i));
    return bytes;
}

/// The number of bytes of the logs: pointers to chunks, and last chunks, which may not be shared.
size_t bytes_of_logs(const core::CutModel& stock) {
    constexpr size_t pointer = sizeof(std::shared_ptr<void>);
    constexpr size_t per_tile = 64; // a list of chunks and the pointer of its one chunk
    return 3 * pointer * (stock.log.size() / 64 + 1) + stock.history.size() * per_tile;
}

/// The boxes of a stock: 0 to 2 of its families of scan lines, 3 of its columns.
core::TileBoxes& boxes_of(core::CutModel& stock, size_t i) {
    return i < 3 ? stock.line_boxes[i] : stock.column_boxes;
}

/// The number of bytes of a keyframe that it does not share with `other`.
size_t bytes_apart(const Keyframe& frame, const Keyframe& other) {
    constexpr size_t of_the_rest = 16384; // control, clock and rules, roughly
    const core::CutModel& stock = frame.state.machine.stock;
    const core::CutModel& other_stock = other.state.machine.stock;
    size_t bytes =
        of_the_rest + bytes_of_logs(stock) + bytes_apart(stock.columns, other_stock.columns);
    for (size_t axis = 0; axis < 3; ++axis)
        bytes += bytes_apart(stock.lines.families[axis], other_stock.lines.families[axis]);
    for (size_t i = 0; i < frame.boxes.size(); ++i)
        bytes += frame.boxes[i].bytes_apart(other.boxes[i]);
    return bytes;
}

} // namespace

RunState Keyframe::restored() const {
    RunState whole = state;
    for (size_t i = 0; i < boxes.size(); ++i)
        boxes_of(whole.machine.stock, i) = app::restored(boxes[i]);
    return whole;
}

size_t Keyframes::index_after(size_t blocks) const {
    const auto is_before = [](size_t wanted, const Keyframe& frame) {
        return wanted < frame.blocks;
    };
    const auto after = std::upper_bound(frames_.begin(), frames_.end(), blocks, is_before);
    return static_cast<size_t>(after - frames_.begin());
}

bool Keyframes::wants(size_t blocks, double seconds) const {
    if (frames_.empty()) return true;
    const Keyframe& last = before(blocks);
    if (last.blocks == blocks) return false;
    const double spacing = std::abs(seconds - focus_) < 1.0 ? near_spacing : far_spacing;
    return seconds - last.seconds >= spacing;
}

const Keyframe& Keyframes::before(size_t blocks) const {
    const size_t after = index_after(blocks);
    assert(after > 0);
    return frames_[after - 1];
}

void Keyframes::note(size_t blocks, double seconds, const RunState& state) {
    if (!wants(blocks, seconds)) return;
    const size_t after = index_after(blocks);
    static const Keyframe nothing;
    const Keyframe& before = after == 0 ? nothing : frames_[after - 1];
    Keyframe frame{blocks, seconds, state, {}, 0};
    for (size_t i = 0; i < frame.boxes.size(); ++i)
        frame.boxes[i] =
            saved(std::exchange(boxes_of(frame.state.machine.stock, i), {}), before.boxes[i]);
    frame.bytes = bytes_apart(frame, before);
    memory_ += frame.bytes;
    frames_.insert(frames_.begin() + static_cast<std::ptrdiff_t>(after), std::move(frame));
    thin_out();
}

void Keyframes::drop_after(size_t blocks) {
    while (frames_.size() > 1 && frames_.back().blocks > blocks) remove(frames_.size() - 1);
}

double Keyframes::worth(size_t index) const {
    const double begin = frames_[index - 1].seconds;
    const bool is_last = index + 1 == frames_.size();
    const double gap = (is_last ? frames_[index].seconds : frames_[index + 1].seconds) - begin;
    return gap / bearable_wait(std::abs(frames_[index].seconds - focus_));
}

void Keyframes::remove(size_t index) {
    memory_ -= frames_[index].bytes;
    if (index + 1 < frames_.size()) {
        Keyframe& next = frames_[index + 1];
        memory_ -= next.bytes;
        next.bytes = bytes_apart(next, frames_[index - 1]);
        memory_ += next.bytes;
    }
    frames_.erase(frames_.begin() + static_cast<std::ptrdiff_t>(index));
}

void Keyframes::thin_out() {
    while (memory_ > budget_ && frames_.size() > 2) {
        size_t least = 1;
        for (size_t i = 2; i < frames_.size(); ++i)
            if (worth(i) < worth(least)) least = i;
        remove(least);
    }
}

core::Result<std::unique_ptr<RecordedRun>>
RecordedRun::open(const CheckJob& job, PreparedCheck check, size_t memory_budget) {
    if (const auto placed = place_check(job, check); !placed) return tl::unexpected(placed.error());
    std::unique_ptr<RecordedRun> run(new RecordedRun(std::move(check), memory_budget));
    run->needs_surface_ = job.needs_surface;
    run->after_block_ = job.after_block;
    run->runner_->use_threads(job.threads);
    if (!job.start_line.empty())
        if (const auto begun = run->runner_->start_at(job.start_line); !begun)
            return tl::unexpected(core::in_file(begun.error(), job.program));
    run->marks_[0].findings = run->record().findings.size();
    run->keyframes_->note(0, 0.0, run->runner_->state());
    run->reported_.assumptions = run->record().later_assumptions;
    return run;
}

RecordedRun::RecordedRun(PreparedCheck check, size_t memory_budget)
    : check_(std::make_unique<PreparedCheck>(std::move(check))),
      runner_(std::make_unique<ProgramRunner>(*check_)),
      replayer_(std::make_unique<BlockRunner>(*check_)),
      keyframes_(std::make_unique<Keyframes>(memory_budget)) {
    runner_->keep_readings();
}

RecordedRun::~RecordedRun() = default;

const CheckRun& RecordedRun::record() const { return check_->run; }

double RecordedRun::fraction() const { return is_complete_ ? 1.0 : runner_->progress().fraction; }

void RecordedRun::work_alone() const { runner_->work_alone(); }

gcode::ProgramLibrary& RecordedRun::library() const {
    work_alone();
    return *check_->library;
}

const gcode::Program& RecordedRun::program() const {
    work_alone();
    return *check_->program;
}

void RecordedRun::visit_ahead(size_t position, const RunState& state, const BlockVisit& visit) {
    work_alone();
    replayer_->use(setup_at(position));
    replayer_->visit_ahead(state.control, state.lowering, visit);
}

void RecordedRun::focus_on(size_t position) { keyframes_->focus_on(marks_[position].seconds); }

size_t RecordedRun::keyframe_before(size_t position) const {
    return keyframes_->before(position).blocks;
}

size_t RecordedRun::keyframe_count() const { return keyframes_->size(); }

size_t RecordedRun::keyframe_memory() const { return keyframes_->memory(); }

bool RecordedRun::advance() {
    if (is_complete_) return false;
    const Stopwatch work;
    if (!runner_->advance()) {
        finish();
        return false;
    }
    const double seconds = marks_.back().seconds + work.seconds();
    marks_.push_back({seconds, record().findings.size()});
    keyframes_->note(last_position(), seconds, runner_->state());
    if (!after_block_ || after_block_(runner_->progress())) return true;
    runner_->stop_here();
    finish();
    return false;
}

void RecordedRun::finish() {
    is_complete_ = true;
    reported_.findings = record().findings;
    for (const AppliedChange& made : changes_)
        check_->run.later_assumptions.push_back(
            fmt::format("from block {} on, {}", made.block, text_of(made.change)));
    check_->run.times.check = marks_.back().seconds;
    runner_->conclude(needs_surface_);
}

const core::Setup& RecordedRun::setup_at(size_t block) const {
    for (size_t i = changes_.size(); i-- > 0;)
        if (changes_[i].block <= block) return *setups_[i];
    return check_->run.setup;
}

void RecordedRun::change_at(size_t position, RunState& state) {
    for (size_t i = 0; i < changes_.size(); ++i) {
        if (changes_[i].block != position) continue;
        core::Setup scratch = i == 0
                                  ? check_->run.setup
                                  : *setups_[i - 1]; // the set-up to which this change was applied
        [[maybe_unused]] const auto done = apply(changes_[i].change, scratch, state);
        assert(done);
    }
}

core::Result<RunState> RecordedRun::state_at(size_t position) {
    while (last_position() < position && advance()) {
    }
    if (position > last_position())
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("the program ends after {} blocks", last_position()));
    // At the end, the runner has already closed what was open, so its state cannot be used.
    if (position == last_position() && !is_complete_) return runner_->state();
    return replayed(position);
}

RunState RecordedRun::replayed(size_t position) {
    const Keyframe& frame = keyframes_->before(position);
    RunState state = frame.restored();
    if (frame.blocks == 0) change_at(0, state); // the first keyframe has no changes applied
    advance_to(state, frame.blocks, position);
    return state;
}

void RecordedRun::advance_to(RunState& state, size_t from, size_t position) {
    assert(from <= position && position <= last_position());
    if (const Keyframe& frame = keyframes_->before(position); frame.blocks > from) {
        state = frame.restored();
        from = frame.blocks;
    }
    if (from < position) work_alone();
    while (from < position) {
        replayer_->use(setup_at(from));
        [[maybe_unused]] const auto step = replayer_->step(state);
        assert(step && *step);
        ++from;
        change_at(from, state);
        keyframes_->note(from, marks_[from].seconds, state);
    }
}

size_t RecordedRun::restart_position(size_t position) {
    // Start before blocks whose time was still open, and before an open length mismatch.
    while (true) {
        const RunState state = replayed(position);
        size_t first = std::min<size_t>(position, state.clock.first_open);
        if (state.lengths.is_open)
            first = std::min<size_t>(first, core::value_of(state.lengths.mismatches.back().first));
        const bool is_open = first < position && replayed(first).lengths.is_open;
        if (!is_open) return first;
        position = first;
    }
}

void RecordedRun::record_again_from(size_t position) {
    const size_t first = restart_position(position);
    const RunState state =
        replayed(first); // the runner's own state may contain what is being undone
    CheckRun& run = check_->run;
    if (is_complete_) {
        run.findings = reported_.findings;
        run.later_assumptions = reported_.assumptions;
        run.combined_findings.clear();
        run.comparison.reset();
        run.surface.reset();
        run.stock.reset();
    }
    is_complete_ = false;
    runner_->go_back(state, first, marks_[first].findings);
    for (size_t block = first; block < position; ++block) {
        runner_->use(setup_at(block));
        if (block > first) change_at(block, runner_->mutable_state());
        [[maybe_unused]] const bool done = runner_->advance();
        assert(done);
    }
    if (first < position) change_at(position, runner_->mutable_state());
    runner_->use(setup_at(position));
    marks_.resize(position + 1);
}

void RecordedRun::forget_from(size_t position) {
    keyframes_->drop_after(position == 0 ? 0 : position - 1);
    while (!changes_.empty() && changes_.back().block > position) {
        changes_.pop_back();
        setups_.pop_back();
    }
}

core::Result<void> RecordedRun::change(size_t position, const WhatIf& change) {
    FEELER_TRY(RunState state, state_at(position));
    auto setup = std::make_unique<core::Setup>(setup_at(position));
    if (const auto done = apply(change, *setup, state); !done) return done;
    forget_from(position);
    record_again_from(position);
    changes_.push_back({position, change});
    setups_.push_back(std::move(setup));
    runner_->mutable_state() = std::move(state);
    runner_->use(*setups_.back());
    return {};
}

core::Result<size_t> RecordedRun::take_back() {
    if (changes_.empty())
        return core::fail(core::ErrorCode::invalid_value, "there is no change to undo");
    const size_t position = changes_.back().block;
    const auto setup = std::move(setups_.back()); // the runner refers to it until it has gone back
    changes_.pop_back();
    setups_.pop_back();
    forget_from(position);
    record_again_from(position);
    return position;
}

} // namespace app
