#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>

#include "app/check/check_job.h"
#include "app/library/result/batch_result.h"

namespace core {
struct FileAccess;
}

namespace app {

struct BatchPlan;
struct CheckJob;
struct CheckRun;

/// Limits of a batch.
struct BatchLimits {
    unsigned jobs = 1;     // threads: programs checked at the same time, and within programs
    double memory = 1e300; // estimated bytes for all of them together
};

/// Progress of a batch.
struct BatchProgress {
    size_t programs = 0, done = 0;
    size_t with_errors = 0; // programs with errors, or that could not be run
    double fraction = 0.0;  // of the bytes of all programs, 0..1
};

/// Callbacks of a batch; each may be empty.
struct BatchHooks {
    /// Returns a stored result, so that the check need not run. Called from several threads.
    std::function<std::optional<ProgramResult>(const CheckJob&)> known = {};

    /// Receives each finished check, in the thread that ran it, one at a time.
    std::function<void(const CheckJob&, const CheckRun&, const ProgramResult&)> keep = {};

    /// Receives every file access, in the thread that makes it.
    std::function<void(const core::FileAccess&)> file_accessed = {};

    /// Receives each result, in the caller's thread.
    std::function<void(const ProgramResult&)> ended = {};

    /// Receives the progress about ten times a second, in the caller's thread.
    std::function<void(const BatchProgress&)> waiting = {};

    /// Whether to stop: no further program starts, and running ones are abandoned.
    std::function<bool()> is_stopped = {};
};

/// Runs all checks of a plan, several at the same time. Except for `seconds`, the result does not
/// depend on how many. A check that fails does not affect the others.
BatchResult run_batch(const BatchPlan& plan, const BatchLimits& limits, const BatchHooks& hooks);

/// A memory budget shared by threads: each requests what it needs and waits until it is available.
/// Requests are served in order, so a large one is not postponed forever; a request larger than the
/// budget runs alone.
class MemoryBudget {
public:
    explicit MemoryBudget(double bytes) : bytes_(bytes) {}

    /// Waits until the memory is available and takes it. False, without taking any, if `is_stopped`
    /// returns true first.
    bool take(double bytes, const std::function<bool()>& is_stopped);

    void give_back(double bytes);

private:
    const double bytes_;
    double taken_ = 0.0;
    uint64_t next_ticket_ = 0, served_ = 0;
    std::mutex mutex_;
    std::condition_variable room_;
};

} // namespace app
