#include "app/batch/memory_budget.h"

namespace app {

bool MemoryBudget::take(double bytes, const std::function<bool()>& is_stopped) {
    using namespace std::chrono_literals;
    std::unique_lock lock(mutex_);
    const uint64_t ticket = next_ticket_++;
    bool gave_up = false;
    const auto is_my_turn = [&] {
        gave_up = gave_up || is_stopped();
        return ticket == served_ && (gave_up || taken_ == 0.0 || taken_ + bytes <= bytes_);
    };
    // Nobody wakes who waits when a signal comes, so each looks for itself.
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
    // Sums of differences leave crumbs; bytes are whole.
    if (taken_ < 1.0) taken_ = 0.0;
    room_.notify_all();
}

} // namespace app
