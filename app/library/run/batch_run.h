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

/// What a batch may take.
struct BatchLimits {
    unsigned jobs = 1;     // programs at the same time
    double memory = 1e300; // bytes that they may take together, by their estimates
};

/// How far a batch has come.
struct BatchProgress {
    size_t programs = 0, done = 0;
    size_t with_errors = 0; // programs that have an error, or could not be run
    double share = 0.0;     // of the bytes of all programs, 0..1
};

/// What a batch asks and tells its caller; each may be empty.
struct BatchHooks {
    /// The result of a check that need not be run; asked in several threads at the same time.
    std::function<std::optional<ProgramResult>(const CheckJob&)> known = {};

    /// Told of each check that has run, in the thread that ran it, but one at a time.
    std::function<void(const CheckJob&, const CheckRun&, const ProgramResult&)> keep = {};

    /// Told of every look at the disk, in the thread that takes it.
    std::function<void(const core::FileAccess&)> looked = {};

    /// Told of each program as it ends, in the caller's thread.
    std::function<void(const ProgramResult&)> ended = {};

    /// Told some ten times a second how far it is, in the caller's thread.
    std::function<void(const BatchProgress&)> waiting = {};

    /// Whether to stop: no program is begun any more, and those that are being run are dropped.
    std::function<bool()> is_stopped = {};
};

/// Runs all checks of a plan, several at the same time. What comes out does not depend on how many
/// these are, but for the seconds. A check that fails, for whatever reason, leaves the others as
/// they are.
BatchResult run_batch(const BatchPlan& plan, const BatchLimits& limits, const BatchHooks& hooks);

/// Memory that threads share: each asks for what it will take, and waits until there is room. Who
/// asks first is served first, so that a large one is not passed by for ever; one that is larger
/// than all of it has it alone.
class MemoryBudget {
public:
    explicit MemoryBudget(double bytes) : bytes_(bytes) {}

    /// Waits for room. False if `is_stopped` came true before there was any: nothing is taken then.
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
