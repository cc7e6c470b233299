#pragma once

#include <chrono>

#include "app/batch/watched_files.h"

namespace app {

/// When a watch looks at the disk again, and when it checks what has changed.
class WatchPace {
public:
    using Clock = std::chrono::steady_clock;

    /// Nothing has changed up to now.
    explicit WatchPace(Clock::time_point now) : since_(now) {}

    /// Told of a look, when it began and how long it took. Whether what has changed is to be
    /// checked: once whoever writes it has finished. Names that come and go without end, and a file
    /// that is written for long, are not waited for.
    bool is_time(const WatchedFiles::Change& change, Clock::time_point begin, Clock::duration took);

    /// How long to wait before the next look: a twentieth of the time goes into looking at most,
    /// however many files there are.
    Clock::duration pause() const { return pause_; }

private:
    static constexpr Clock::duration least_pause = std::chrono::milliseconds(200);

    Clock::duration pause_ = least_pause;
    Clock::time_point since_; // nothing had changed
};

} // namespace app
