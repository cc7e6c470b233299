#pragma once

#include "hwsim/traversal.h"

namespace hwsim {

/// Tests both halves of a division: swept box against box, twice, as a pipeline.
///
/// Latency:    4 cycles: offsets, stretched boxes, gaps, squares and sum.
/// Throughput: one division a cycle, no stall.
struct BoxUnit {
    static constexpr size_t latency = 4;

    struct Output {
        bool valid = false;
        uint8_t thread = 0;
        std::array<bool, 2> in_range{};
        std::array<uint64_t, 2> squared{};
        bool operator==(const Output&) const = default;
    };
    /// The halves stay with their thread; only what is computed of them travels.
    std::array<Output, latency> stage{};

    const Output& output() const { return stage[latency - 1]; }
    bool operator==(const BoxUnit&) const = default;
};

/// What enters the first stage: both halves, of which some may not be there.
BoxUnit::Output box_question(uint8_t thread, const Halves& halves, const Segment& segment);

/// One rising clock edge.
void tick(BoxUnit& unit, const BoxUnit::Output& in);

} // namespace hwsim
