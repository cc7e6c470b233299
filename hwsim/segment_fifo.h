#pragma once

#include "hwsim/registers.h"
#include "hwsim/ring.h"

namespace hwsim {

/// Segments on their way, and which number comes next.
struct SegmentFifo {
    struct Entry {
        Segment segment;
        uint64_t pushed = 0; // cycle
        uint64_t lines = 0;  // that the memory had been given by then
        bool operator==(const Entry&) const = default;
    };
    Ring<Entry> entries;
    uint32_t next_sequence = 1; // 0: all numbers are used up

    bool operator==(const SegmentFifo&) const = default;
};

/// Takes a segment in, or says why not; then nothing has changed.
Stop push(SegmentFifo& fifo, const SegmentWords& words, uint64_t cycle, uint64_t lines);

} // namespace hwsim
