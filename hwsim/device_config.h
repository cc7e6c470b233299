#pragma once

#include "hwsim/registers.h"

namespace hwsim {

/// The sizes and times of a device that is built, as it were.
struct DeviceConfig {
    uint32_t clock_mhz = 100;
    uint32_t elements = 8;           // processing elements, at most 64
    uint32_t threads = 4;            // of each, at most 16
    uint32_t stack_depth = 64;       // waiting pairs of a thread, at most `most_stack`
    uint32_t node_cache_lines = 256; // of each element; powers of two up to `most_cache_lines`
    uint32_t record_cache_lines = 256;
    uint32_t fifo_depth = 32;          // segments
    uint32_t memory_lines = 1U << 20;  // 64 MiB
    uint32_t memory_latency = 30;      // cycles from a request to its line
    uint32_t cycles_per_line = 2;      // of memory: its bandwidth
    uint32_t memory_queue = 64;        // requests
    uint32_t write_queue = 16;         // lines on their way by DMA
    uint32_t search_limit = 2'000'000; // cycles of one search
    uint32_t memory_limit = 100'000;   // cycles for a line

    static constexpr uint32_t most_elements = 64;
    static constexpr uint32_t most_threads = 16;
    static constexpr uint32_t most_stack = 64;
    static constexpr uint32_t most_cache_lines = 1U << 14; // 1 MiB
    bool operator==(const DeviceConfig&) const = default;
};

/// Errors: a size of zero or beyond what can be built, a cache that is no power of two.
core::Result<DeviceConfig> checked(const DeviceConfig& config);

} // namespace hwsim
