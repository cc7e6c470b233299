#pragma once

#include <chrono>
#include <functional>
#include <mutex>

namespace app {

/// How long one run waits for databases that others have, in all: ten seconds, and of what it has
/// waited it gets back half of the time that it then need not wait. Who is to stop gives others a
/// second more. Several threads may wait.
class Patience {
public:
    explicit Patience(std::function<bool()> is_stopped = {});

    /// Waits some milliseconds, longer with every attempt; false, at once, when there is no
    /// patience left.
    bool wait(int attempt);

private:
    using Clock = std::chrono::steady_clock;

    bool take(Clock::duration nap);

    std::function<bool()> is_stopped_;
    std::mutex mutex_; // over all below
    Clock::duration left_;
    Clock::time_point told_; // when the last wait ends
};

} // namespace app
