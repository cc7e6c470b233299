#include "app/batch/patience.h"

#include <algorithm>
#include <thread>

namespace app {
namespace {

using namespace std::chrono_literals;

constexpr auto whole_budget = 10s;
constexpr auto when_stopped = 1s;

} // namespace

Patience::Patience(std::function<bool()> is_stopped)
    : is_stopped_(std::move(is_stopped)), left_(whole_budget), told_(Clock::now()) {}

bool Patience::take(Clock::duration nap) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (now > told_) left_ = std::min<Clock::duration>(whole_budget, left_ + (now - told_) / 2);
    if (is_stopped_ && is_stopped_()) left_ = std::min<Clock::duration>(left_, when_stopped);
    if (left_ < nap) return false;
    left_ -= nap;
    told_ = now + nap;
    return true;
}

bool Patience::wait(int attempt) {
    const auto nap = std::chrono::milliseconds(std::clamp(attempt + 1, 1, 20));
    if (!take(nap)) return false;
    std::this_thread::sleep_for(nap);
    return true;
}

} // namespace app
