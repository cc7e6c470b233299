#pragma once

#include "hwsim/traversal.h"

namespace hwsim {

/// Tests both halves of a division: swept volume against box, twice, as a pipeline.
///
/// Latency:    15 cycles: offsets, then those of the pair unit, for the arithmetic is the same.
/// Throughput: one division a cycle, no stall.
struct BoxUnit {
    static constexpr uint32_t latency = 15;

    struct Output {
        bool valid = false;
        uint8_t thread = 0;
        std::array<bool, 2> in_range{};
        std::array<uint64_t, 2> squared{};
        bool operator==(const Output&) const = default;
    };
    /// The halves stay with their thread; only what is computed of them travels. Stages move round
    /// instead of their contents: `next` is where a question enters, and where the oldest leaves.
    std::array<Output, latency> stage{};
    uint32_t next = 0;

    const Output& output() const { return stage[next]; }
    bool operator==(const BoxUnit&) const = default;
};

/// What enters the first stage: both halves, of which some may not be there.
BoxUnit::Output box_question(uint8_t thread, const Halves& halves, const Segment& segment);

/// One rising clock edge.
void tick(BoxUnit& unit, const BoxUnit::Output& in);

} // namespace hwsim
