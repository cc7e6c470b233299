#include "hwsim/segment_fifo.h"

namespace hwsim {

Stop push(SegmentFifo& fifo, const SegmentWords& words, uint64_t cycle, uint64_t lines) {
    const DecodedSegment decoded = segment_in(words);
    if (decoded.fault != Stop::none) return decoded.fault;
    if (fifo.entries.full()) return Stop::fifo_overrun;
    // Behind the last number comes 0, which is none: a permit must never fall.
    if (decoded.segment.sequence != fifo.next_sequence || fifo.next_sequence == 0)
        return Stop::sequence;
    fifo.entries.push({decoded.segment, cycle, lines});
    if (decoded.segment.last) ++fifo.next_sequence;
    return Stop::none;
}

} // namespace hwsim
