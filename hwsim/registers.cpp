#include "hwsim/registers.h"

#include <bit>

namespace hwsim {
core::Result<DeviceConfig> checked(const DeviceConfig& c) {
    const auto is_within = [](uint32_t value, uint32_t most) {
        return value >= 1 && value <= most;
    };
    const auto is_cache = [&](uint32_t lines) {
        return is_within(lines, DeviceConfig::most_cache_lines) && std::has_single_bit(lines);
    };
    const bool good =
        is_within(c.clock_mhz, 10'000) && is_within(c.elements, DeviceConfig::most_elements)
        && is_within(c.threads, DeviceConfig::most_threads)
        && is_within(c.stack_depth, DeviceConfig::most_stack) && is_within(c.fifo_depth, 4096)
        && is_within(c.memory_lines, 1U << Reference::line_bits)
        && is_within(c.memory_latency, 10'000) && is_within(c.cycles_per_line, 1'000)
        && is_within(c.memory_queue, 4096) && is_within(c.write_queue, 4096)
        && is_within(c.host_latency, 100'000) && is_within(c.host_cycles_per_line, 1'000)
        && is_within(c.host_queue, 256) && c.search_limit > 0 && c.memory_limit > 0
        && is_cache(c.node_cache_lines) && is_cache(c.record_cache_lines);
    if (!good)
        return core::fail(
            core::ErrorCode::invalid_value,
            "invalid coprocessor: sizes and times must be at least 1, elements at most 64, threads "
            "at most 16, the stack at most 64, and caches powers of two up to 16384 lines");
    return c;
}

} // namespace hwsim
