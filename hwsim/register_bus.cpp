#include "hwsim/coprocessor.h"

namespace hwsim {
namespace {

constexpr uint32_t segment_base = address_of(Register::segment);
constexpr uint32_t counter_base = address_of(Register::counter);

/// What elements count, none for what they do not.
uint64_t ElementCounts::*element_count(Counter which) {
    switch (which) {
    case Counter::busy:
        return &ElementCounts::busy;
    case Counter::node_hits:
        return &ElementCounts::node_hits;
    case Counter::node_misses:
        return &ElementCounts::node_misses;
    case Counter::record_hits:
        return &ElementCounts::record_hits;
    case Counter::record_misses:
        return &ElementCounts::record_misses;
    case Counter::wait_memory:
        return &ElementCounts::wait_memory;
    case Counter::wait_port:
        return &ElementCounts::wait_port;
    case Counter::wait_retire:
        return &ElementCounts::wait_retire;
    default:
        return nullptr;
    }
}

uint64_t counter(const CoprocessorState& s, Counter which) {
    switch (which) {
    case Counter::cycles:
        return s.cycle;
    case Counter::queries:
        return s.searched.queries;
    case Counter::nodes:
        return s.searched.nodes;
    case Counter::splits:
        return s.searched.splits;
    case Counter::box_tests:
        return s.searched.box_tests;
    case Counter::pair_tests:
        return s.searched.pair_tests;
    case Counter::lines_read:
        return s.memory.reads_done;
    case Counter::lines_written:
        return s.memory.writes_done;
    case Counter::missed:
        return s.permits.missed;
    case Counter::deepest:
        return s.searched.deepest;
    case Counter::least_slack:
        return static_cast<uint64_t>(s.permits.least_slack);
    case Counter::longest:
        return s.permits.longest;
    default:
        break;
    }
    uint64_t sum = 0;
    for (const SearchElement& element : s.elements) sum += element.counts.*element_count(which);
    return sum;
}

uint32_t status(const CoprocessorState& s) {
    const bool is_idle = s.fifo.entries.empty() && s.permits.in_order.empty();
    return (s.host.enabled ? status_enabled : 0U)
           | (s.permits.stopped != Stop::none ? status_stopped : 0U) | (is_idle ? status_idle : 0U)
           | (s.fifo.entries.full() ? status_fifo_full : 0U);
}

uint32_t read_of_device(const CoprocessorState& s, const DeviceConfig& config, Register r) {
    switch (r) {
    case Register::identification:
        return identification_word;
    case Register::version:
        return version_word;
    case Register::elements:
        return config.elements;
    case Register::threads:
        return config.threads;
    case Register::lines:
        return config.memory_lines;
    case Register::fifo_depth:
        return config.fifo_depth;
    case Register::status:
        return status(s);
    case Register::irq_pending:
        return s.host.irq_pending;
    case Register::irq_enable:
        return s.host.irq_enable;
    case Register::watchdog:
        return s.host.watchdog;
    case Register::fifo_used:
        return static_cast<uint32_t>(s.fifo.entries.size());
    case Register::permit_seq:
        return s.permits.permit_sequence;
    case Register::retired:
        return s.permits.retired;
    case Register::next_seq:
        return s.fifo.next_sequence;
    default:
        return 0;
    }
}

uint32_t read_of_stop(CoprocessorState& s, Register r) {
    switch (r) {
    case Register::stop:
        return static_cast<uint32_t>(s.permits.stopped);
    case Register::stop_seq:
        return s.permits.stop_sequence;
    case Register::stop_line:
        return s.permits.stop_line;
    case Register::found_low:
        s.host.high_word = static_cast<uint32_t>(s.permits.found.squared >> 32);
        return static_cast<uint32_t>(s.permits.found.squared);
    case Register::found_high:
        return s.host.high_word;
    case Register::found_tool:
        return s.permits.found.tool_record;
    case Register::found_work:
        return s.permits.found.work_record;
    case Register::found_sample:
        return s.permits.found.sample;
    case Register::found_seq:
        return s.permits.found_sequence;
    case Register::found_valid:
        return s.permits.found.found ? 1 : 0;
    default:
        return 0;
    }
}

/// Host and memory have their whole time from now on.
void watch_from_here(CoprocessorState& s) { s.host.heartbeat = s.memory.watched_from = s.cycle; }

void clear(CoprocessorState& s) {
    if (s.permits.stopped == Stop::none) return;
    s.permits.stopped = Stop::none;
    s.permits.stop_sequence = s.permits.stop_line = 0;
    s.fifo.next_sequence = s.permits.permit_sequence + 1;
    s.slots = {};
    watch_from_here(s);
}

void reset(CoprocessorState& s, const DeviceConfig& config) {
    std::vector<Line> lines = std::move(s.memory.lines);
    DeviceConfig without_memory = config;
    without_memory.memory_lines = 1;
    const bool is_stalled = s.memory.stalled;
    s = power_up(without_memory);
    s.memory.lines = std::move(lines);
    s.memory.stalled = is_stalled;
}

void write_control(CoprocessorState& s, const DeviceConfig& config, uint32_t value) {
    if ((value & control_reset) != 0) return reset(s, config);
    if ((value & control_clear) != 0) clear(s);
    const bool enable = (value & control_enable) != 0;
    if (enable && !s.host.enabled) watch_from_here(s);
    s.host.enabled = enable;
}

/// A push that is refused stops the device; one into a stopped device does nothing.
void write_push(CoprocessorState& s) {
    if (s.permits.stopped != Stop::none) return;
    const Stop fault = push(s.fifo, s.host.segment, s.cycle, lines_given(s.memory));
    if (fault != Stop::none) halt(s, fault, segment_in(s.host.segment).segment.sequence);
}

} // namespace

uint32_t read(CoprocessorState& s, const DeviceConfig& config, uint32_t address) {
    if (address >= counter_base && address < counter_base + 8 * counter_count && address % 4 == 0) {
        const auto which = static_cast<Counter>((address - counter_base) / 8);
        if (address % 8 == 4) return s.host.high_word;
        const uint64_t value = counter(s, which);
        s.host.high_word = static_cast<uint32_t>(value >> 32);
        return static_cast<uint32_t>(value);
    }
    const auto r = static_cast<Register>(address);
    return r < Register::stop ? read_of_device(s, config, r) : read_of_stop(s, r);
}

void write(CoprocessorState& s, const DeviceConfig& config, uint32_t address, uint32_t value) {
    if (address >= segment_base && address < segment_base + 4 * segment_words && address % 4 == 0) {
        s.host.segment[(address - segment_base) / 4] = value;
        return;
    }
    switch (static_cast<Register>(address)) {
    case Register::control:
        return write_control(s, config, value);
    case Register::irq_pending:
        s.host.irq_pending &= ~value;
        return;
    case Register::irq_enable:
        s.host.irq_enable = value;
        return;
    case Register::heartbeat:
        s.host.heartbeat = s.cycle;
        return;
    case Register::watchdog:
        s.host.watchdog = value;
        return;
    case Register::segment_push:
        return write_push(s);
    default:
        return;
    }
}

} // namespace hwsim
