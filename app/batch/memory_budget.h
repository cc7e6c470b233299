#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>

namespace app {

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
