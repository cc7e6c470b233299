#pragma once

#include "hwsim/registers.h"
#include "hwsim/search_element.h"

namespace bench {

/// Stages of the two pipelines.
struct UnitStages {
    uint32_t volume = hwsim::BoxUnit::latency;
    uint32_t pair = hwsim::PairUnit::latency;
};

/// The cycles of a device with one element of one thread that never waits for others. A step of a
/// thread takes one cycle, a unit as many more as it has stages. A line that is not in the cache
/// takes the latency of the memory plus four cycles: request, grant, entering the memory, return.
///
/// With the device's own units this is exactly what the emulator counts.
struct LoneThread {
    hwsim::LineCache nodes, records;
    UnitStages stages;
    uint32_t memory_latency = 0;
    uint64_t cycles = 0;
    uint64_t lines = 0; // from memory

    explicit LoneThread(const hwsim::DeviceConfig& config, UnitStages units = {})
        : stages(units), memory_latency(config.memory_latency) {
        nodes.entries.resize(config.node_cache_lines);
        records.entries.resize(config.record_cache_lines);
    }

    void step() { ++cycles; }
    void test() { cycles += 1 + stages.volume; }
    void compare(uint32_t pairs) { cycles += pairs; }
    void drain() { cycles += stages.pair; }
    void read(hwsim::LineCache& cache, uint32_t address) {
        constexpr uint32_t way_to_memory = 4;
        ++cycles;
        if (hwsim::cached_line(cache, address)) return;
        hwsim::fill(cache, address, {});
        cycles += way_to_memory + memory_latency;
        ++lines;
    }
};

} // namespace bench
