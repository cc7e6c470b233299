#pragma once

#include "hwsim/memory_line.h"

namespace hwsim {

/// The squared distance of two records, as a pipeline.
///
/// Latency:    14 cycles: gaps, squares, 9 of the root (3 bits each), less the radius, squares,
/// sum. Throughput: one pair a cycle, no stall.
struct PairUnit {
    static constexpr size_t latency = 14;

    struct Output {
        bool valid = false;
        uint8_t thread = 0;
        uint32_t tool_record = 0, work_record = 0;
        uint64_t squared = 0;
        bool operator==(const Output&) const = default;
    };
    /// Stages move round instead of their contents: `next` is where the next pair enters, and
    /// where the oldest leaves.
    std::array<Output, latency> stage{};
    uint32_t next = 0;

    const Output& output() const { return stage[next]; }
    bool operator==(const PairUnit&) const = default;
};

/// One rising clock edge.
void tick(PairUnit& unit, const PairUnit::Output& in);

} // namespace hwsim
