#include "app/library/run/batch_run.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <limits>
#include <mutex>
#include <new>
#include <numeric>
#include <thread>

#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/library/run/batch_job.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"

namespace app {
namespace {

constexpr double much = 100e6; // bytes; memory of larger models is returned to the system

core::Result<CheckRun> run_whatever_comes(const CheckJob& job) {
    try {
        return run_check(job);
    } catch (const std::bad_alloc&) {
        return tl::unexpected<core::Error>(
            {core::ErrorCode::io,
             {},
             "not enough memory: use a larger mesh size or fewer --jobs",
             job.program});
    } catch (const std::exception& mistake) {
        return tl::unexpected<core::Error>({core::ErrorCode::io,
                                            {},
                                            std::string("internal error: ") + mistake.what(),
                                            job.program});
    }
}

/// The size of a program, bytes; at least 1, so that every program counts.
double program_size(const std::string& program) {
    std::error_code failure;
    const auto size = std::filesystem::file_size(program, failure);
    return failure ? 1.0 : static_cast<double>(std::max<std::uintmax_t>(size, 1));
}

class BatchRunner {
public:
    BatchRunner(const std::vector<CheckJob>& jobs, const BatchLimits& limits,
                const BatchHooks& hooks)
        : jobs_(jobs),
          hooks_(hooks),
          budget_(limits.memory),
          threads_(std::max(1U, limits.jobs)),
          results_(jobs.size()) {
        for (const CheckJob& job : jobs_) sizes_.push_back(program_size(job.program));
        const size_t most = std::min<size_t>(threads_, jobs.size());
        order_.resize(jobs.size());
        std::iota(order_.begin(), order_.end(), size_t(0));
        // Largest first, so that the batch does not end with a long program running alone.
        if (most > 1)
            std::stable_sort(order_.begin(), order_.end(),
                             [&](size_t a, size_t b) { return sizes_[a] > sizes_[b]; });
        fractions_ = std::vector<std::atomic<double>>(most);
    }

    std::vector<std::optional<ProgramResult>> run() {
        std::vector<std::thread> threads;
        begin(threads);
        tell_what_ends();
        for (std::thread& thread : threads) thread.join();
        return std::move(results_);
    }

private:
    /// Starts the threads. If not all can be created, uses at most as many as there are cores, and
    /// ends the others before the first check begins. If there are none, the caller's thread does
    /// all the work.
    void begin(std::vector<std::thread>& threads) {
        size_t most = fractions_.size();
        try {
            threads.reserve(most);
            while (threads.size() < fractions_.size())
                threads.emplace_back([this, i = threads.size()] { work_in_turn(i); });
        } catch (const std::exception&) { // the system is out of threads or memory
            const size_t cores = std::max(1U, std::thread::hardware_concurrency());
            most = std::min(threads.size(), cores);
        }
        let_begin(most, false);
        for (; threads.size() > most; threads.pop_back()) threads.back().join();
        working_ = std::max<size_t>(most, fractions_.empty() ? 0 : 1);
        let_begin(most, true);
        if (most == 0 && !fractions_.empty()) work(0);
    }

    void let_begin(size_t most, bool now) {
        const std::lock_guard lock(mutex_);
        most_ = most;
        is_begun_ = now;
        may_begin_.notify_all();
    }

    void work_in_turn(size_t thread) {
        {
            std::unique_lock lock(mutex_);
            may_begin_.wait(lock, [&] { return is_begun_ || thread >= most_; });
            if (thread >= most_) return;
        }
        work(thread);
    }

    bool is_stopped() const { return hooks_.is_stopped && hooks_.is_stopped(); }

    void work(size_t thread) {
        std::optional<core::FileAccessObserver> listening;
        if (hooks_.file_accessed) listening.emplace(hooks_.file_accessed);
        while (!is_stopped()) {
            const size_t index = next_++;
            if (index >= order_.size()) break;
            const unsigned threads = threads_for(order_.size() - index);
            ++running_;
            check_whatever_comes(order_[index], thread, threads);
            --running_;
        }
        const std::lock_guard lock(mutex_);
        --working_;
        something_ended_.notify_one();
    }

    /// The number of threads for a check that begins while so many programs wait, itself included:
    /// its share of what it, the waiting and the running ones can use. So the last programs of a
    /// batch, and few programs, use several threads each.
    unsigned threads_for(size_t waiting) const {
        return static_cast<unsigned>(std::max<size_t>(1, threads_ / (waiting + running_)));
    }

    void check_whatever_comes(size_t i, size_t thread, unsigned threads) {
        try {
            check(i, thread, threads);
        } catch (const std::exception&) {
            // Out of memory outside of the check itself, and maybe too little for a message: the
            // program counts as not checked.
        }
    }

    void check(size_t i, size_t thread, unsigned threads) {
        const CheckJob& job = jobs_[i];
        if (hooks_.known)
            if (auto known = hooks_.known(job)) return end(i, thread, *std::move(known));
        double taken = 0.0;
        bool is_cut = false;
        CheckJob hooked = job;
        hooked.threads = threads;
        hooked.before_model = [&](double bytes) {
            is_cut = !budget_.take(bytes, [this] { return is_stopped(); });
            if (!is_cut) taken = bytes;
            return !is_cut;
        };
        hooked.after_block = [&](const CheckProgress& progress) {
            fractions_[thread].store(sizes_[i] * progress.fraction, std::memory_order_relaxed);
            is_cut = is_stopped();
            return !is_cut;
        };
        hooked.is_stopped = [&] { return is_cut = is_cut || is_stopped(); };
        {
            const auto run = run_whatever_comes(hooked);
            if (!is_cut) end(i, thread, result(job, run));
        }
        // Return the memory of a large model to the system; otherwise the allocator keeps it.
        if (taken > much) core::platform::release_free_memory();
        budget_.give_back(taken);
    }

    ProgramResult result(const CheckJob& job, const core::Result<CheckRun>& run) {
        if (!run) return failed_result(job, run.error());
        ProgramResult made = result_of(*run, job.setup);
        const std::lock_guard lock(keeping_);
        if (hooks_.keep) hooks_.keep(job, *run, made);
        return made;
    }

    void end(size_t i, size_t thread, ProgramResult result) {
        const std::lock_guard lock(mutex_);
        results_[i] = std::move(result);
        fractions_[thread].store(0.0, std::memory_order_relaxed);
        ended_.push_back(i);
        something_ended_.notify_one();
    }

    /// Reports results and progress in the caller's thread until all threads have finished.
    void tell_what_ends() {
        using namespace std::chrono_literals;
        const double all = std::accumulate(sizes_.begin(), sizes_.end(), 0.0);
        double done = 0.0;
        BatchProgress progress{.programs = jobs_.size()};
        std::unique_lock lock(mutex_);
        while (working_ > 0 || !ended_.empty()) {
            something_ended_.wait_for(lock, 100ms,
                                      [&] { return working_ == 0 || !ended_.empty(); });
            for (const size_t i : std::exchange(ended_, {})) {
                done += sizes_[i];
                ++progress.done;
                progress.with_errors += status_of(*results_[i]) != 0;
                lock.unlock();
                if (hooks_.ended) hooks_.ended(*results_[i]);
                lock.lock();
            }
            progress.fraction = (done + under_way()) / all;
            lock.unlock();
            if (hooks_.waiting) hooks_.waiting(progress);
            lock.lock();
        }
    }

    double under_way() const {
        double bytes = 0.0;
        for (const auto& fraction : fractions_) bytes += fraction.load(std::memory_order_relaxed);
        return bytes;
    }

    const std::vector<CheckJob>& jobs_;
    const BatchHooks& hooks_;
    MemoryBudget budget_;
    unsigned threads_;
    std::atomic<size_t> running_{0}; // programs
    std::vector<double> sizes_;      // of the programs, bytes
    std::vector<size_t> order_;
    std::atomic<size_t> next_{0};                // index in order_
    std::vector<std::atomic<double>> fractions_; // of each thread's program, bytes
    std::vector<std::optional<ProgramResult>> results_;
    std::deque<size_t> ended_;                         // results not reported yet
    size_t working_ = 0;                               // number of running threads
    size_t most_ = std::numeric_limits<size_t>::max(); // number of threads to use
    bool is_begun_ = false;
    std::mutex mutex_, keeping_;
    std::condition_variable something_ended_, may_begin_;
};

} // namespace

BatchResult run_batch(const BatchPlan& plan, const BatchLimits& limits, const BatchHooks& hooks) {
    BatchResult batch{.programs = {}, .unchecked = {}, .skipped = plan.skipped};
    for (SkippedFile& file : batch.skipped)
        file = {shown_name(file.path, batch.file_bytes), utf8_text(file.why)};
    auto results = BatchRunner(plan.jobs, limits, hooks).run();
    for (size_t i = 0; i < results.size(); ++i) {
        if (results[i])
            batch.programs.push_back(*std::move(results[i]));
        else
            batch.unchecked.push_back(shown_name(plan.jobs[i].program, batch.file_bytes));
    }
    for (const core::Error& error : plan.failures) {
        CheckJob nothing;
        nothing.program = error.file;
        batch.programs.push_back(failed_result(nothing, error));
        batch.programs.back().sha256.clear(); // a folder or pattern has no digest
        if (hooks.ended) hooks.ended(batch.programs.back());
    }
    return batch;
}

bool MemoryBudget::take(double bytes, const std::function<bool()>& is_stopped) {
    using namespace std::chrono_literals;
    std::unique_lock lock(mutex_);
    const uint64_t ticket = next_ticket_++;
    bool gave_up = false;
    const auto is_my_turn = [&] {
        gave_up = gave_up || is_stopped();
        return ticket == served_ && (gave_up || taken_ == 0.0 || taken_ + bytes <= bytes_);
    };
    // A signal does not wake waiting threads, so each polls is_stopped.
    while (!room_.wait_for(lock, 100ms, is_my_turn)) {
    }
    ++served_;
    if (!gave_up) taken_ += bytes;
    room_.notify_all();
    return !gave_up;
}

void MemoryBudget::give_back(double bytes) {
    const std::lock_guard lock(mutex_);
    taken_ -= bytes;
    // Remove the rounding error of sums and differences; bytes are whole numbers.
    if (taken_ < 1.0) taken_ = 0.0;
    room_.notify_all();
}

} // namespace app
