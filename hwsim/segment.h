#pragma once

#include <cstdint>

#include "hwsim/fixed_point.h"
#include "hwsim/memory_line.h"

namespace hwsim {

/// The kinds of entries of the segment FIFO.
enum class SegmentKind : uint8_t {
    permit =
        0, // is the tool at least this far from the work over the whole path? Needed for the permit
    measure = 1, // how close does it come? Not needed for the permit
    model = 2,   // loads the model at `model_header` into slot `work_slot`
};

/// An entry of the segment FIFO. The tool model moves straight from `start` to `end` and is
/// compared at 2^log2_steps + 1 evenly spaced samples, including both ends.
///
/// Entries with the same sequence number form one segment of the path; `last` marks the last one.
struct Segment {
    static constexpr uint8_t most_log2_steps = 12;

    uint32_t sequence = 0;
    SegmentKind kind = SegmentKind::permit;
    uint8_t tool_slot = 0, work_slot = 0;
    uint8_t log2_steps = 0;
    bool last = true;
    FixedVec start{}, end{};
    uint32_t threshold = 0; // T: refused if d2 < (T + rounding_reserve)^2; for `measure` the search
                            // limit, 0: unlimited
    uint32_t work_epoch = 0;   // the required epoch of the work model
    uint32_t model_header = 0; // for `model`: the header line; its epoch is `work_epoch`
    bool is_timed = false;     // has a deadline
    uint32_t deadline = 0;     // low word of the cycle in which the permit is needed

    bool operator==(const Segment&) const = default;
};

/// Why the device does not permit, or none. Codes of the register `stop`.
enum class Stop : uint8_t {
    none = 0,
    violation = 1,      // the tool comes too close
    out_of_range = 2,   // a coordinate beyond 24 bits, or an invalid word
    sequence = 3,       // an unexpected sequence number
    fifo_overrun = 4,   // the doorbell names more descriptors than the ring holds
    model_missing = 5,  // a slot without a model
    model_changed = 6,  // the work model does not have the required epoch
    bad_check = 7,      // a line of memory with a wrong check word
    bad_address = 8,    // a reference beyond the memory
    stack_overflow = 9, // a search deeper than the stack
    too_long = 10,      // a search of more cycles than allowed
    memory_stalled = 11,
    host_silent = 12,    // no heartbeat
    bad_descriptor = 13, // with a wrong check word, or one that orders nothing
};
constexpr uint8_t stop_count = 14;

/// The name in reports, such as `stack-overflow`.
const char* name_of(Stop stop);

/// The work done by a search.
struct SearchCounts {
    uint32_t nodes = 0;      // lines of nodes opened
    uint32_t splits = 0;     // of the path, in two
    uint32_t box_tests = 0;  // of swept boxes against boxes
    uint32_t pair_tests = 0; // of records against records
    uint32_t deepest = 0;    // entries on the stack

    bool operator==(const SearchCounts&) const = default;
};

/// The nearest pair of records of a query.
struct Answer {
    Stop stop = Stop::none;   // a fault, never a violation
    uint32_t at_line = 0;     // of the fault
    bool found = false;       // a pair is nearer than the limit
    uint64_t squared = 0;     // its squared distance; the limit if none was found
    uint32_t tool_record = 0; // record numbers of the pair
    uint32_t work_record = 0;
    uint16_t sample = 0;
    SearchCounts counts;

    bool operator==(const Answer&) const = default;
};

/// A segment with its models.
struct Query {
    Segment segment;
    uint32_t tool_header = 0, work_header = 0; // lines
    uint32_t tool_epoch = 0, work_epoch = 0;
    uint64_t limit = 0; // only pairs with a squared distance below this count

    bool operator==(const Query&) const = default;
};

/// The initial limit of a search for this segment.
constexpr uint64_t limit_of(const Segment& segment) {
    const bool has_no_limit = segment.kind == SegmentKind::measure && segment.threshold == 0;
    return has_no_limit ? beyond_all_squares : squared_limit(segment.threshold);
}

/// The offset of the tool at sample `k`, 0 .. 2^log2_steps: the exact position rounded to the
/// nearest step, ties up. One product of 13 by 25 bits for each axis.
///
/// It is monotonic along each axis, so the box around any two samples contains those between.
constexpr FixedVec offset_at(const Segment& segment, uint32_t k) {
    FixedVec at{};
    const int64_t half = (int64_t{1} << segment.log2_steps) >> 1;
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t way = int64_t{segment.end[axis]} - segment.start[axis];
        const int64_t part = (static_cast<int64_t>(k) * way + half) >> segment.log2_steps;
        at[axis] = static_cast<int32_t>(segment.start[axis] + part);
    }
    return at;
}

} // namespace hwsim
