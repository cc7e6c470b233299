#pragma once

#include <vector>

#include "hwsim/descriptor.h"
#include "hwsim/memory_unit.h"

namespace hwsim {

/// The part of the host's memory that it shares with the device, from `base` on.
struct HostMemory {
    static constexpr uint64_t base = 0x8'4000'0000; // byte address
    std::vector<Line> lines;

    static constexpr uint64_t address_of(size_t line) { return base + sizeof(Line) * line; }
    /// The line at a byte address, or null if there is none.
    const Line* at(uint64_t address) const;

    bool operator==(const HostMemory&) const = default;
};

/// A line of the ring on its way.
struct FetchedDescriptor {
    bool valid = false;
    bool is_missing = false; // the host has no memory there
    bool is_intact = false;  // by its check word
    uint32_t run = 0;        // counts stops
    uint32_t number = 0;     // of the line, counted since reset
    uint64_t asked = 0;      // cycle
    Line line;

    bool operator==(const FetchedDescriptor&) const = default;
};

/// An entry for the FIFO.
struct OrderedEntry {
    bool valid = false;
    uint32_t run = 0;
    Segment segment;
    uint64_t asked = 0; // cycle in which its descriptor was asked for
    uint64_t lines = 0; // copied since reset by the orders before it

    bool operator==(const OrderedEntry&) const = default;
};

/// Why orders cannot be carried out.
struct OrderFault {
    bool valid = false;
    uint32_t run = 0;
    Stop reason = Stop::none;
    uint32_t sequence = 0; // 0: of no segment
    uint32_t line = 0;     // of the ring, or of the memory for bad_address

    bool operator==(const OrderFault&) const = default;
};

/// Reads descriptors from a ring in the host's memory and carries them out in order: entries go
/// into the FIFO, copied lines into the memory. Lines of the ring are read ahead. Reads are
/// answered in order. What the unit does at an edge follows from what was there before.
struct RingUnit {
    struct Read {
        bool of_copy = false;
        uint32_t run = 0;
        uint32_t number = 0;             // of the ring; for a copy the line of the device's memory
        uint64_t from = 0;               // byte address
        uint64_t asked = 0, arrives = 0; // cycles
        bool operator==(const Read&) const = default;
    };

    uint64_t base = 0; // of the ring: byte address; its low 6 bits are 0
    uint32_t log2_size = 0;
    uint32_t tail = 0;    // lines that the host has written
    uint32_t fetched = 0; // asked for
    uint32_t head = 0;    // carried out or in progress

    Ring<Read> under_way;
    uint64_t free_at = 0; // cycle in which the port to the host is free
    uint64_t waited = 0;  // cycles without an answer while one is due
    bool stalled = false; // no responses: injected fault
    Pipeline<FetchedDescriptor, 4> check;
    Ring<FetchedDescriptor> waiting;

    Descriptor current;        // in progress
    Line pairs;                // of the path
    uint32_t next_pair = 0;    // its place in `pairs`
    bool is_first_line = true; // of the descriptor
    uint64_t asked = 0;        // cycle
    bool is_faulty = false;    // until the stop
    uint32_t copying = 0;      // reads of lines under way
    uint64_t lines_asked = 0;  // for copies, since reset
    uint64_t reads_done = 0;

    OrderedEntry entry; // outputs
    OrderFault fault;
    bool has_copied = false;
    bool copied_is_missing = false; // then the line is 0
    uint32_t copied_run = 0;
    uint32_t copied_to = 0;
    Line copied;

    bool operator==(const RingUnit&) const = default;
};

RingUnit ring_unit(const DeviceConfig& config);

/// Whether everything that the host has written is carried out.
bool is_idle(const RingUnit& unit);

/// The doorbell: the host has written lines up to this number.
void ring_doorbell(RingUnit& unit, uint32_t tail);

/// Whether the doorbell names more lines than the ring holds.
bool is_overrun(const RingUnit& unit);

/// Skips all that the host has written.
void skip_all(RingUnit& unit);

/// What the unit sees of the others.
struct RingInput {
    uint64_t cycle = 0;
    uint32_t run = 0;
    bool flush = false, is_stopped = false;
    bool has_room = false;    // in the FIFO
    uint32_t memory_room = 0; // lines that the memory takes
};

/// One rising clock edge.
void tick(RingUnit& unit, const HostMemory& host, const DeviceConfig& config, const RingInput& in);

/// Whether answers are due, and none has come for longer than the limit.
bool is_stalled(const RingUnit& unit, const DeviceConfig& config);

/// The byte address of a line of the ring.
uint64_t address_in_ring(const RingUnit& unit, uint32_t number);

// The steps of carrying out, shared with the functional model.

/// After a stop: nothing is in progress.
void drop_orders(RingUnit& unit);

/// Takes the next line of the ring: the first of a descriptor, or pairs of the current one.
void take_line(RingUnit& unit, const FetchedDescriptor& line, const DeviceConfig& config);

/// Whether the current descriptor has an entry for the FIFO, or lines to copy, or needs a line.
bool has_entry(const RingUnit& unit);
inline bool has_copy(const RingUnit& unit) { return unit.current.copy.count > 0; }
bool needs_line(const RingUnit& unit);

/// The next entry; its fault, if any, goes to `fault`.
OrderedEntry take_entry(RingUnit& unit, uint32_t run);

} // namespace hwsim
