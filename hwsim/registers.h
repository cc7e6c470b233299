#pragma once

#include <cstdint>

#include "hwsim/segment.h"

namespace hwsim {

/// The registers, by byte address on a 32-bit bus (AXI4-Lite). Registers are read-only unless
/// stated otherwise; writing to them, or to another address, has no effect. Pairs of words: low,
/// then high; reading the low word stores the high one for the next read. The place of the ring can
/// be written while the device is not enabled.
enum class Register : uint32_t {
    identification = 0x000, // `identification_word`
    version = 0x004,
    elements = 0x008, // processing elements
    threads = 0x00C,  // of each element
    lines = 0x010,    // of memory
    fifo_depth = 0x014,
    control = 0x018,     // write: `ControlBit`
    status = 0x01C,      // `StatusBit`
    irq_pending = 0x020, // `IrqBit`; write 1 to clear
    irq_enable = 0x024,  // read and write
    heartbeat = 0x028,   // write any value: the host is alive
    watchdog = 0x02C,    // read and write: cycles without a heartbeat that stop the device
    fifo_used = 0x030,
    permit_seq = 0x034, // every segment up to this one may be entered
    retired = 0x038,    // entries finished since reset; they no longer need their models
    next_seq = 0x03C,   // the next expected sequence number; 0: all numbers are used up

    stop = 0x040,      // `Stop`: why there are no permits
    stop_seq = 0x044,  // the segment that stopped the device
    stop_line = 0x048, // the line of memory at fault
    found_low = 0x050, // squared distance of the violation or of the last measurement
    found_high = 0x054,
    found_tool = 0x058, // names of the records of the pair
    found_work = 0x05C,
    found_sample = 0x060,
    found_seq = 0x064,   // the segment to which it belongs
    found_valid = 0x068, // whether a pair was below the limit

    volumes = 0x06C, // `Volumes`: what the nodes of models must hold

    ring_base_low = 0x080,  // read and write: byte address of the ring in the host's memory;
    ring_base_high = 0x084, // the low 6 bits are 0
    ring_log2_size = 0x088, // read and write: it has 2^this lines, at most 2^16
    ring_tail = 0x08C,      // read and write: the doorbell, lines written to the ring since reset
    ring_head = 0x090,      // lines of it that are taken; they may be overwritten

    counter = 0x100, // `Counter` number i at 0x100 + 8 i, pairs of words
};

constexpr uint32_t identification_word = 0x464C'5231; // "FLR1"
constexpr uint32_t version_word = 2;
constexpr uint32_t most_log2_ring_size = 16;

enum ControlBit : uint32_t {
    control_enable = 1U << 0, // if 0, segments wait and nothing is permitted
    control_clear = 1U << 1,  // clears a stop; the FIFO is then empty
    control_reset = 1U << 2,  // as after power-up, except for the contents of the memory
};

enum StatusBit : uint32_t {
    status_enabled = 1U << 0,
    status_stopped = 1U << 1, // nothing is permitted until the host clears it
    status_idle = 1U << 2,    // no segment waits or is searched
    status_fifo_full = 1U << 3,
};

enum IrqBit : uint32_t {
    irq_permit = 1U << 0, // permit_seq has advanced
    irq_stop = 1U << 1,
    irq_measured = 1U << 2,
};

constexpr uint32_t model_slots = 32;

/// Counters of the device since reset.
enum class Counter : uint32_t {
    cycles,
    busy, // element-cycles in which at least one thread had a search
    queries,
    nodes,
    splits,
    box_tests,
    pair_tests,
    node_hits,
    node_misses,
    record_hits,
    record_misses,
    lines_read,    // from memory
    lines_written, // of copies
    wait_memory,   // thread-cycles: for a line
    wait_port,     // for a cache or a unit used by another thread
    wait_retire,   // done, but waiting for an earlier segment
    missed,        // permits after their deadline
    deepest,       // stack of any search
    least_slack,   // cycles before the deadline, signed; the greatest number if there was none
    longest,       // cycles of a query, from the request for its descriptor to its permit
    host_lines,    // read from the host's memory
};
constexpr uint32_t counter_count = 21;
constexpr uint64_t no_slack = 0x7FFF'FFFF'FFFF'FFFFULL;

constexpr uint32_t address_of(Register r) { return static_cast<uint32_t>(r); }
constexpr uint32_t address_of(Counter c) {
    return address_of(Register::counter) + 8 * static_cast<uint32_t>(c);
}

/// The current state of a device, as its registers state it.
struct DeviceReport {
    uint32_t permitted = 0; // all segments up to this one may be entered
    Stop stop = Stop::none;
    uint32_t stop_sequence = 0, stop_line = 0;
    bool idle = false;
};

/// The sizes and times of an emulated device.
struct DeviceConfig {
    uint32_t clock_mhz = 100;
    uint32_t elements = 8; // processing elements, at most 64
    uint32_t threads = 4;  // of each, at most 16
    Volumes volumes = Volumes::boxes;
    uint32_t stack_depth = 64;       // waiting pairs per thread, at most `most_stack`
    uint32_t node_cache_lines = 256; // of each element; powers of two up to `most_cache_lines`
    uint32_t record_cache_lines = 256;
    uint32_t fifo_depth = 32;          // segments
    uint32_t memory_lines = 1U << 20;  // 64 MiB
    uint32_t memory_latency = 30;      // cycles from a request to its line
    uint32_t cycles_per_line = 2;      // of memory: its bandwidth
    uint32_t memory_queue = 64;        // requests
    uint32_t write_queue = 16;         // lines to be written
    uint32_t host_latency = 60;        // cycles from a request to a line of the host's memory
    uint32_t host_cycles_per_line = 4; // its bandwidth
    uint32_t host_queue = 16;          // such requests, and descriptors that wait
    uint32_t search_limit = 2'000'000; // cycles of one search
    uint32_t memory_limit = 100'000;   // cycles for a line

    static constexpr uint32_t most_elements = 64;
    static constexpr uint32_t most_threads = 16;
    static constexpr uint32_t most_stack = 64;
    static constexpr uint32_t most_cache_lines = 1U << 14; // 1 MiB
    bool operator==(const DeviceConfig&) const = default;
};

/// Errors: a size of zero or above its maximum, a cache that is not a power of two.
core::Result<DeviceConfig> checked(const DeviceConfig& config);

} // namespace hwsim
