#pragma once

#include "hwsim/registers.h"
#include "hwsim/search_element.h"

namespace bench {

/// Stages of the gap unit for volumes and for pairs of records.
struct UnitStages {
    uint32_t volume = hwsim::GapUnit::latency;
    uint32_t pair = hwsim::GapUnit::latency;
};

/// The cycles of a device with one element of one thread that never waits for others. A question
/// takes one cycle, its answer as many as the unit has stages; memories of the element take a cycle
/// more. A line that is not in the cache takes the latency of the memory, the stages that check it,
/// and three cycles more: request, grant, entering the memory.
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

    void ask_path_unit() { cycles += 1 + hwsim::PathUnit::latency; }
    void test(uint32_t halves) { cycles += halves == 0 ? 0 : halves + stages.volume; }
    void compare(uint32_t pairs) { cycles += pairs; }
    void drain() { cycles += stages.pair; }
    void pop(bool is_empty) { cycles += is_empty ? 1 : 2; }
    void read(hwsim::LineCache& cache, uint32_t address) {
        cycles += 2;
        if (hwsim::cached_line(cache, address)) return;
        hwsim::fill(cache, address, {});
        cycles += 3 + memory_latency + hwsim::CheckUnit::latency;
        ++lines;
    }
};

} // namespace bench
