#include "app/batch/watch_pace.h"

#include <algorithm>

namespace app {

using namespace std::chrono_literals;

bool WatchPace::is_time(const WatchedFiles::Change& change, Clock::time_point begin,
                        Clock::duration took) {
    constexpr int idle_share = 20; // of the time to that of looking
    pause_ = std::max(least_pause, idle_share * took);
    if (change.paths.empty()) {
        since_ = begin + took;
        return false;
    }
    const Clock::duration waited = begin - since_;
    const bool are_names_settled = change.are_names_settled || waited > 2s;
    return (change.are_files_settled && are_names_settled) || waited > 30s;
}

} // namespace app
