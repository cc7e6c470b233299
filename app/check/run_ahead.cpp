#include "app/check/run_ahead.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "app/check/block_events.h"
#include "app/check/prepared_check.h"
#include "app/check/run_state.h"
#include "core/base/file_reads.h"
#include "core/dbm/cut_ahead.h"
#include "core/sim/run/cut_forecast.h"

namespace app {
namespace {

// A window is worth the cost of handing it over, and what the run copies from it should still be in
// the cache.
constexpr size_t most_blocks = 32;
constexpr double usual_bytes = 2e6; // then no more blocks are added
constexpr double most_bytes = 16e6; // of a block and of all windows; the run makes larger blocks
constexpr size_t windows_ahead = 3;

/// So many that threads that finish early find more work.
unsigned parts_for(unsigned threads) { return threads <= 4 ? 1 : 2; }

} // namespace

/// A file access by another thread than the one that collects them.
struct RunAhead::EarlierAccess {
    core::FileAccess access; // without its answer
    std::optional<std::string> answer;

    /// Reports it to the observers of this thread.
    void report() {
        if (answer) access.answer = *answer;
        core::notify_file_access(access);
    }
};

/// Some blocks with their cuts.
struct RunAhead::Window {
    std::vector<ReadBlock> blocks;                    // the first `count` are in use
    std::vector<std::vector<EarlierAccess>> accesses; // made while each of them was read
    size_t count = 0;
    double estimate = 0.0; // of the memory of its cuts, bytes, without the scale
    std::unique_ptr<core::CutWindow> cuts;
    unsigned shards_done = 0;
    bool is_ready = false;

    void report_accesses(size_t block) {
        for (EarlierAccess& earlier : accesses[block]) earlier.report();
        accesses[block].clear();
    }
    void report_all_accesses() {
        for (size_t i = 0; i < accesses.size(); ++i) report_accesses(i);
    }
};

/// Reads the blocks of a program and foresees their cuts. For one thread.
class RunAhead::Reader {
public:
    Reader(const PreparedCheck& check, const core::Setup& setup, const RunState& from)
        : check_(check),
          setup_(setup),
          interpreter_(*check.library, check.file.environment),
          control_(from.control),
          lowering_(from.lowering),
          forecast_(setup, from.machine) {}

    /// Reads a window; false at the end of what can be foreseen. `scale`: windows have lately taken
    /// so many times the memory that was estimated.
    bool read(Window& window, core::CutAhead& cuts, double scale) {
        window.count = 0;
        window.shards_done = 0;
        window.is_ready = false;
        bool goes_on = true;
        std::vector<core::CutterSweep> moves;
        window.estimate = 0.0;
        while (goes_on && window.count < most_blocks && scale * window.estimate < usual_bytes) {
            if (window.count == window.blocks.size()) {
                window.blocks.emplace_back();
                window.accesses.emplace_back();
            }
            ReadBlock& block = window.blocks[window.count];
            block.first_move = moves.size();
            goes_on = read(block, window.accesses[window.count], moves);
            double more = 0.0;
            for (size_t i = block.first_move; i < moves.size(); ++i)
                more += static_cast<double>(sizeof(core::CutterSweep)) + cuts.bytes_for(moves[i]);
            goes_on = goes_on && scale * more < most_bytes;
            if (!goes_on) moves.resize(block.first_move);
            block.last_move = moves.size();
            if (!goes_on) break;
            window.estimate += more;
            ++window.count;
        }
        window.cuts = cuts.begin(std::move(moves), std::move(window.cuts));
        return goes_on;
    }

private:
    bool read(ReadBlock& into, std::vector<EarlierAccess>& accesses,
              std::vector<core::CutterSweep>& moves) {
        accesses.clear();
        const core::FileAccessObserver observer([&](const core::FileAccess& access) {
            EarlierAccess& noted = accesses.emplace_back(EarlierAccess{access, {}});
            if (access.answer) noted.answer = std::string(*access.answer);
            noted.access.answer.reset();
        });
        const auto read = interpreter_.next(control_);
        if (!read || !*read) return false;
        into.block = **read;
        into.text = into.block.text;
        into.file = into.block.file;
        into.control = control_;
        into.events = events_of(setup_, into.block, lowering_, check_.file.speed_by_hand);
        into.lowering = lowering_;
        return forecast_.add({.block = into.block.block,
                              .is_cycle = into.block.is_cycle,
                              .events = into.events,
                              .path = into.block.path},
                             moves);
    }

    const PreparedCheck& check_;
    const core::Setup& setup_;
    gcode::Interpreter interpreter_;
    gcode::InterpreterState control_;
    gcode::Lowering lowering_;
    core::CutForecast forecast_;
};

/// The threads, and the windows that they hand over. One thread reads, all of them cut.
class RunAhead::Team {
public:
    Team(const PreparedCheck& check, const core::Setup& setup, const RunState& from,
         unsigned threads)
        : reader_(check, setup, from),
          cuts_(from.machine.stock, parts_for(threads)),
          next_of_shard_(cuts_.shards()),
          is_cutting_(cuts_.shards()) {
        try {
            threads_.emplace_back([this] { work(true); });
            while (threads_.size() + 1 < threads) threads_.emplace_back([this] { work(false); });
        } catch (const std::exception&) { // the system is out of threads
            if (threads_.empty()) has_read_all_ = true;
        }
    }

    ~Team() {
        try {
            halt();
        } catch (const std::exception&) {
            // Out of memory: the observers miss some accesses.
        }
    }

    void halt() {
        {
            const std::lock_guard lock(mutex_);
            is_halted_ = true;
        }
        may_read_.notify_all();
        may_cut_.notify_all();
        for (std::thread& thread : threads_) thread.join();
        threads_.clear();
        // The library has kept what it found, and will not ask for it again.
        if (current_) current_->report_all_accesses();
        for (const auto& window : windows_) window->report_all_accesses();
        for (const auto& window : used_) window->report_all_accesses();
        windows_.clear();
    }

    ReadBlock* next(const core::CutModel& model) {
        if (!current_ || at_ == current_->count) take_window(model);
        if (!current_) return nullptr;
        current_->report_accesses(at_);
        ReadBlock& block = current_->blocks[at_++];
        block.block.text = block.text;
        block.block.file = block.file;
        return &block;
    }

    core::CutReplay& cuts(const core::CutModel& model) {
        const ReadBlock& block = current_->blocks[at_ - 1];
        return replay_ = {*current_->cuts, block.first_move, block.last_move, model};
    }

    bool went_as_foreseen() const { return replay_.is_complete(); }

private:
    void work(bool reads) {
        std::unique_lock lock(mutex_);
        try {
            while (!is_halted_ && !has_failed_) {
                if (reads && may_read())
                    read(lock);
                else if (!cut_a_shard(lock))
                    (reads ? may_read_ : may_cut_).wait(lock);
            }
        } catch (const std::exception&) { // out of memory
            if (!lock.owns_lock()) lock.lock();
            has_failed_ = true;
            is_ready_.notify_one();
        }
    }

    bool may_read() const {
        double bytes = 0.0;
        for (const auto& window : windows_) bytes += scale_ * window->estimate;
        return !has_read_all_ && windows_.size() < windows_ahead && bytes < most_bytes;
    }

    /// `lock` is released meanwhile.
    void read(std::unique_lock<std::mutex>& lock) {
        if (used_.empty()) used_.push_back(std::make_unique<Window>());
        windows_.reserve(windows_.size() + 1);
        std::unique_ptr<Window> window = std::move(used_.back());
        used_.pop_back();
        const double scale = scale_;
        lock.unlock();
        bool goes_on = false;
        try {
            goes_on = reader_.read(*window, cuts_, scale);
        } catch (...) {
            lock.lock();
            used_.push_back(std::move(window)); // with the accesses that it has noted
            throw;
        }
        lock.lock();
        has_read_all_ = !goes_on;
        (window->count > 0 ? windows_ : used_).push_back(std::move(window));
        may_cut_.notify_all();
        is_ready_.notify_one();
    }

    /// Cuts a shard of a window that waits for it; false if there is none. `lock` is released while
    /// cutting.
    bool cut_a_shard(std::unique_lock<std::mutex>& lock) {
        for (size_t i = 0; i < windows_.size(); ++i)
            for (unsigned shard = 0; shard < cuts_.shards(); ++shard) {
                if (is_cutting_[shard] || next_of_shard_[shard] != first_window_ + i) continue;
                Window& window = *windows_[i];
                is_cutting_[shard] = true;
                lock.unlock();
                cuts_.cut(*window.cuts, shard);
                lock.lock();
                is_cutting_[shard] = false;
                ++next_of_shard_[shard];
                if (++window.shards_done < cuts_.shards()) return true;
                lock.unlock();
                core::CutAhead::finish(*window.cuts);
                lock.lock();
                const auto bytes = static_cast<double>(core::CutAhead::bytes_in(*window.cuts));
                const double ratio = bytes / std::max(1.0, window.estimate);
                scale_ = std::clamp(std::max(ratio, 0.9 * scale_), 0.5, 100.0);
                window.is_ready = true;
                is_ready_.notify_one();
                return true;
            }
        return false;
    }

    /// Makes the next window the current one; none if there will be none.
    void take_window(const core::CutModel& model) {
        std::unique_lock lock(mutex_);
        if (current_) {
            core::CutAhead::share(*current_->cuts, model);
            used_.push_back(std::move(current_));
        }
        while (windows_.empty() || !windows_.front()->is_ready) {
            if (is_halted_ || has_failed_ || (windows_.empty() && has_read_all_)) return;
            if (!cut_a_shard(lock)) is_ready_.wait(lock);
        }
        current_ = std::move(windows_.front());
        windows_.erase(windows_.begin());
        ++first_window_;
        at_ = 0;
        lock.unlock();
        may_read_.notify_one();
        may_cut_.notify_one(); // what this thread has cut lets the next window be cut
    }

    Reader reader_; // for the thread that reads
    core::CutAhead cuts_;

    std::mutex mutex_;
    std::condition_variable may_read_; // or cut: for the thread that reads
    std::condition_variable may_cut_;  // for the threads that only cut
    std::condition_variable is_ready_; // a window, or there will be none: for the thread of the run
    std::vector<std::unique_ptr<Window>> windows_; // that were read and not yet run
    std::vector<std::unique_ptr<Window>> used_;
    std::vector<uint64_t> next_of_shard_; // number of the window that each shard cuts next
    std::vector<bool> is_cutting_;        // by shard
    uint64_t first_window_ = 0;           // number of windows_.front()
    double scale_ = 1.0;                  // memory of windows by its estimate
    bool has_read_all_ = false;
    bool is_halted_ = false;
    bool has_failed_ = false;

    std::unique_ptr<Window> current_; // for the thread of the run
    size_t at_ = 0;                   // index of the next block in it
    core::CutReplay replay_;          // of the block before

    std::vector<std::thread> threads_;
};

RunAhead::RunAhead(const PreparedCheck& check, const core::Setup& setup, const RunState& from,
                   unsigned threads)
    : team_(std::make_unique<Team>(check, setup, from, threads)) {}

RunAhead::~RunAhead() = default;

ReadBlock* RunAhead::next(const core::CutModel& model) { return team_->next(model); }

core::CutReplay& RunAhead::cuts(const core::CutModel& model) { return team_->cuts(model); }

bool RunAhead::went_as_foreseen() const { return team_->went_as_foreseen(); }

void RunAhead::halt() { team_->halt(); }

} // namespace app
