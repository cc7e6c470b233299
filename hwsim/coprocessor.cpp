#include "hwsim/coprocessor.h"

#include <algorithm>
#include <bit>

namespace hwsim {
namespace {

void note_time(PermitUnit& unit, const Dispatched& entry, uint64_t cycle) {
    unit.longest = std::max(unit.longest, cycle - entry.asked);
    if (!entry.segment.is_timed) return;
    const int64_t slack =
        static_cast<int32_t>(entry.segment.deadline - static_cast<uint32_t>(cycle));
    unit.least_slack = std::min(unit.least_slack, slack);
    if (slack < 0) ++unit.missed;
}

} // namespace

void stop(PermitUnit& unit, Stop reason, uint32_t sequence, uint32_t line) {
    if (unit.stopped != Stop::none) return;
    unit.stopped = reason;
    unit.stop_sequence = sequence;
    unit.stop_line = line;
    unit.in_order.clear();
}

Retirement retire(PermitUnit& unit, const Answer& answer, uint64_t cycle) {
    const Dispatched entry = unit.in_order.front();
    unit.in_order.pop();
    const uint32_t sequence = entry.segment.sequence;
    if (answer.stop != Stop::none) return {.stopped = answer.stop};
    ++unit.retired;
    if (entry.segment.kind == SegmentKind::model) return {};
    const bool is_measured = entry.segment.kind == SegmentKind::measure;
    if (is_measured || answer.found) {
        unit.found = answer;
        unit.found_sequence = sequence;
    }
    if (is_measured) return {.measured = true};
    if (answer.found) return {.stopped = Stop::violation};
    if (!entry.segment.last) return {};
    note_time(unit, entry, cycle);
    unit.permit_sequence = sequence;
    return {.permitted = true};
}

Stop push(SegmentFifo& fifo, const OrderedEntry& entry) {
    // The number after the last one is 0, which is invalid: a permit must never decrease.
    if (entry.segment.sequence != fifo.next_sequence || fifo.next_sequence == 0)
        return Stop::sequence;
    fifo.entries.push(entry);
    if (entry.segment.last) ++fifo.next_sequence;
    return Stop::none;
}

namespace {

/// The sequence number reported for a fault of the whole device: the first not permitted.
uint32_t next_to_permit(const CoprocessorState& s) { return s.permits.permit_sequence + 1; }

/// What units see of each other: their outputs before the edge.
struct Wires {
    uint64_t cycle = 0; // that of the edge
    uint32_t run = 0;
    bool flush = false;
    SearchStart start;
    ThreadRelease release;
    size_t granted = 0; // element
    ReadRequest request;
    ReadResponse response;
    bool has_written = false;
    uint32_t written = 0;
    uint64_t writes_done = 0;
    bool is_memory_stalled = false; // or that of the host
    RingInput ring;
    OrderedEntry entry;
    OrderFault fault;
    const Line* copied = nullptr; // a line for the memory
    uint32_t copied_to = 0;
    std::optional<Answer> answer; // to the first entry
};

void check_watchdog(CoprocessorState& s, const Wires& wires) {
    if (s.permits.stopped != Stop::none || !s.host.enabled) return;
    if (s.host.watchdog != 0 && s.cycle - s.host.heartbeat > s.host.watchdog)
        halt(s, Stop::host_silent, next_to_permit(s));
    else if (wires.is_memory_stalled)
        halt(s, Stop::memory_stalled, next_to_permit(s));
}

/// The answer to the first entry, if available.
std::optional<Answer> first_answer(const CoprocessorState& s) {
    if (s.permits.in_order.empty()) return {};
    const Dispatched& first = s.permits.in_order.front();
    if (!first.searched) return Answer{.stop = first.fault};
    const SearchElement& element = s.elements[first.element];
    if ((element.done >> first.thread & 1U) == 0) return {};
    return element.threads[first.thread].answer;
}

void add(SearchTotals& sum, const SearchCounts& counts) {
    ++sum.queries;
    sum.deepest = std::max(sum.deepest, counts.deepest);
    sum.nodes += counts.nodes;
    sum.splits += counts.splits;
    sum.box_tests += counts.box_tests;
    sum.pair_tests += counts.pair_tests;
}

void retire_first(CoprocessorState& s, const Wires& wires) {
    s.retired.valid = false;
    if (!s.host.enabled || !wires.answer || s.permits.in_order.empty()) return;
    const Dispatched& first = s.permits.in_order.front();
    if (first.searched) s.release = {true, first.element, first.thread};
    retire_with(s, *wires.answer);
}

/// Gives a segment to an idle thread; false if there is none.
bool begin_search(CoprocessorState& s, const DeviceConfig& config, const Segment& segment,
                  Dispatched& entry) {
    const size_t count = s.elements.size();
    for (size_t i = 0; i < count; ++i) {
        size_t number = s.next_element + i;
        if (number >= count) number -= count;
        const auto thread = static_cast<uint32_t>(std::countr_one(s.occupied[number]));
        if (thread >= config.threads) continue;
        ++s.searching;
        s.occupied[number] |= 1U << thread;
        entry.searched = true;
        entry.element = static_cast<uint8_t>(number);
        entry.thread = static_cast<uint8_t>(thread);
        s.start = {true, entry.element, entry.thread, query_of(s, segment)};
        s.next_element = static_cast<uint8_t>(number + 1 == count ? 0 : number + 1);
        return true;
    }
    return false;
}

/// Takes the first entry of the FIFO: a model goes into its slot once all lines before it are
/// written, a segment to a thread.
void dispatch(CoprocessorState& s, const DeviceConfig& config, const Wires& wires) {
    if (s.permits.stopped != Stop::none || !s.host.enabled) return;
    if (s.fifo.entries.empty() || s.permits.in_order.full()) return;
    const OrderedEntry& first = s.fifo.entries.front();
    const Segment& segment = first.segment;
    Dispatched entry{.segment = segment, .asked = first.asked};
    if (segment.kind == SegmentKind::model) {
        if (wires.writes_done < first.lines) return;
        store_model(s, segment);
    } else {
        entry.fault = fault_of_models(s, segment);
        if (entry.fault == Stop::none && !begin_search(s, config, segment, entry)) return;
    }
    s.permits.in_order.push(entry);
    s.fifo.entries.pop();
}

/// The element whose request is accepted, in rotation; `none` if there is no request or the memory
/// accepts none.
constexpr size_t none = SIZE_MAX;
size_t granted_element(const CoprocessorState& s) {
    if (!accepts(s.memory)) return none;
    const size_t count = s.elements.size();
    size_t number = s.next_request;
    for (size_t i = 0; i < count; ++i) {
        if (s.elements[number].request.valid) return number;
        if (++number == count) number = 0;
    }
    return none;
}

/// The outputs of the ring unit before the edge, and what it sees of the others.
void connect_ring(Wires& wires, const CoprocessorState& s, Line& copied) {
    wires.ring = {.cycle = wires.cycle,
                  .run = s.run,
                  .flush = s.flush,
                  .is_stopped = s.permits.stopped != Stop::none,
                  .has_room = s.fifo.entries.free() > (s.ring.entry.valid ? 1U : 0U),
                  .memory_room = static_cast<uint32_t>(s.memory.writes.free())};
    if (s.ring.entry.valid) wires.entry = s.ring.entry;
    if (s.ring.fault.valid) wires.fault = s.ring.fault;
    if (!s.ring.has_copied) return;
    wires.copied_to = s.ring.copied_to;
    copied = s.ring.copied;
    wires.copied = &copied;
}

Wires outputs_of(const CoprocessorState& s, const DeviceConfig& config, Line& copied) {
    Wires wires;
    wires.cycle = s.cycle + 1;
    wires.run = s.run;
    wires.flush = s.flush;
    if (s.start.valid) wires.start = s.start;
    wires.release = s.release;
    wires.granted = granted_element(s);
    if (wires.granted != none) wires.request = s.elements[wires.granted].request;
    if (s.memory.check.output().valid) wires.response = s.memory.check.output();
    wires.has_written = s.memory.has_written;
    wires.written = s.memory.written;
    wires.writes_done = s.memory.writes_done;
    wires.is_memory_stalled = is_stalled(s.memory, config) || is_stalled(s.ring, config);
    wires.answer = first_answer(s);
    connect_ring(wires, s, copied);
    return wires;
}

void tick_element(CoprocessorState& s, const DeviceConfig& config, const Wires& wires,
                  size_t number) {
    const auto is_for_it = [&](const auto& output) {
        return output.valid && output.element == number;
    };
    ElementInput in{.number = static_cast<uint8_t>(number),
                    .cycle = wires.cycle,
                    .run = wires.run,
                    .flush = wires.flush,
                    .granted = wires.granted == number,
                    .forget = wires.has_written,
                    .forgotten = wires.written};
    if (wires.response.valid && wires.response.request.element == number)
        in.response = &wires.response;
    if (is_for_it(wires.start)) in.start = &wires.start;
    if (is_for_it(wires.release)) in.release = &wires.release;
    tick(s.elements[number], config, in);
}

void tick_memory(CoprocessorState& s, const DeviceConfig& config, const Wires& wires) {
    if (wires.granted != none)
        s.next_request = static_cast<uint8_t>((wires.granted + 1) % s.elements.size());
    tick(s.memory, config, wires.cycle, wires.request);
    if (wires.copied) s.memory.writes.push({wires.copied_to, *wires.copied});
}

void tick_permits(CoprocessorState& s, const DeviceConfig& config, const Wires& wires) {
    s.cycle = wires.cycle;
    s.flush = s.start.valid = s.release.valid = false;
    // A thread is free once its element has seen the release.
    if (wires.release.valid) {
        s.occupied[wires.release.element] &= ~(1U << wires.release.thread);
        --s.searching;
    }
    retire_first(s, wires);
    dispatch(s, config, wires);
    take_order(s, wires.entry, wires.fault);
    check_watchdog(s, wires);
}

} // namespace

CoprocessorState power_up(const DeviceConfig& config) {
    CoprocessorState s;
    s.fifo.entries = Ring<OrderedEntry>(config.fifo_depth);
    const size_t entries = size_t{config.elements} * config.threads + config.fifo_depth;
    s.permits.in_order = Ring<Dispatched>(entries);
    s.elements.assign(config.elements, search_element(config));
    s.occupied.assign(config.elements, 0);
    s.memory = memory_unit(config);
    s.ring = ring_unit(config);
    return s;
}

void tick(CoprocessorState& s, const DeviceConfig& config) {
    Line copied;
    const Wires wires = outputs_of(s, config, copied);
    for (size_t i = 0; i < s.elements.size(); ++i) tick_element(s, config, wires, i);
    tick_memory(s, config, wires);
    tick(s.ring, s.shared, config, wires.ring);
    tick_permits(s, config, wires);
}

void tick_in_order(CoprocessorState& s, const DeviceConfig& config, std::span<const size_t> order) {
    Line copied;
    const Wires wires = outputs_of(s, config, copied);
    for (const size_t unit : order) {
        if (unit < s.elements.size())
            tick_element(s, config, wires, unit);
        else if (unit == s.elements.size())
            tick_memory(s, config, wires);
        else if (unit == s.elements.size() + 1)
            tick(s.ring, s.shared, config, wires.ring);
        else
            tick_permits(s, config, wires);
    }
}

void halt(CoprocessorState& s, Stop reason, uint32_t sequence, uint32_t line) {
    stop(s.permits, reason, sequence, line);
    ++s.run;
    s.fifo.entries.clear();
    s.flush = true;
    s.start.valid = s.release.valid = false;
    s.occupied.assign(s.occupied.size(), 0);
    s.searching = 0;
    s.host.irq_pending |= irq_stop;
}

void take_order(CoprocessorState& s, const OrderedEntry& entry, const OrderFault& fault) {
    const auto is_current = [&](const auto& output) {
        return output.valid && output.run == s.run && s.permits.stopped == Stop::none;
    };
    if (is_current(entry))
        if (const Stop reason = push(s.fifo, entry); reason != Stop::none)
            halt(s, reason, entry.segment.sequence);
    if (is_current(fault))
        halt(s, fault.reason, fault.sequence != 0 ? fault.sequence : next_to_permit(s), fault.line);
}

Stop fault_of_models(const CoprocessorState& s, const Segment& segment) {
    const ModelSlot& tool = s.slots[segment.tool_slot];
    const ModelSlot& work = s.slots[segment.work_slot];
    if (!tool.valid || !work.valid) return Stop::model_missing;
    return work.epoch == segment.work_epoch ? Stop::none : Stop::model_changed;
}

Query query_of(const CoprocessorState& s, const Segment& segment) {
    const ModelSlot& tool = s.slots[segment.tool_slot];
    const ModelSlot& work = s.slots[segment.work_slot];
    return {segment, tool.header, work.header, tool.epoch, work.epoch, limit_of(segment)};
}

void store_model(CoprocessorState& s, const Segment& segment) {
    s.slots[segment.work_slot] = {true, segment.model_header, segment.work_epoch};
}

void retire_with(CoprocessorState& s, const Answer& answer) {
    const Dispatched entry = s.permits.in_order.front();
    if (entry.segment.kind != SegmentKind::model) add(s.searched, answer.counts);
    s.retired = {true, entry.segment, answer, entry.asked};
    const Retirement done = retire(s.permits, answer, s.cycle);
    if (done.permitted) s.host.irq_pending |= irq_permit;
    if (done.measured) s.host.irq_pending |= irq_measured;
    if (done.stopped != Stop::none) halt(s, done.stopped, entry.segment.sequence, answer.at_line);
}

namespace {

constexpr uint32_t counter_base = address_of(Register::counter);

/// The counter of the elements, or null.
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
    case Counter::host_lines:
        return s.ring.reads_done;
    default:
        break;
    }
    uint64_t sum = 0;
    for (const SearchElement& element : s.elements) sum += element.counts.*element_count(which);
    return sum;
}

uint32_t status(const CoprocessorState& s) {
    const bool has_orders = s.permits.stopped == Stop::none && !is_idle(s.ring);
    const bool is_idle = !has_orders && s.fifo.entries.empty() && s.permits.in_order.empty();
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
    case Register::volumes:
        return static_cast<uint32_t>(config.volumes);
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

uint32_t read_of_ring(const CoprocessorState& s, Register r) {
    switch (r) {
    case Register::ring_base_low:
        return static_cast<uint32_t>(s.ring.base);
    case Register::ring_base_high:
        return static_cast<uint32_t>(s.ring.base >> 32);
    case Register::ring_log2_size:
        return s.ring.log2_size;
    case Register::ring_tail:
        return s.ring.tail;
    case Register::ring_head:
        return s.ring.head;
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

/// Restarts the watchdogs of the host and of both memories.
void restart_watchdog(CoprocessorState& s) {
    s.host.heartbeat = s.cycle;
    s.memory.waited = s.ring.waited = 0;
}

void clear(CoprocessorState& s) {
    if (s.permits.stopped == Stop::none) return;
    s.permits.stopped = Stop::none;
    s.permits.stop_sequence = s.permits.stop_line = 0;
    s.fifo.next_sequence = s.permits.permit_sequence + 1;
    s.slots = {};
    skip_all(s.ring);
    restart_watchdog(s);
}

void reset(CoprocessorState& s, const DeviceConfig& config) {
    DeviceMemory lines = std::move(s.memory.lines);
    DeviceConfig without_memory = config;
    without_memory.memory_lines = 1;
    HostMemory shared = std::move(s.shared);
    const bool is_stalled = s.memory.stalled, is_host_stalled = s.ring.stalled;
    s = power_up(without_memory);
    s.memory.lines = std::move(lines);
    s.shared = std::move(shared);
    s.memory.stalled = is_stalled;
    s.ring.stalled = is_host_stalled;
}

void write_control(CoprocessorState& s, const DeviceConfig& config, uint32_t value) {
    if ((value & control_reset) != 0) return reset(s, config);
    if ((value & control_clear) != 0) clear(s);
    const bool enable = (value & control_enable) != 0;
    if (enable && !s.host.enabled) restart_watchdog(s);
    s.host.enabled = enable;
}

void write_ring_place(CoprocessorState& s, Register r, uint32_t value) {
    if (s.host.enabled) return;
    constexpr uint64_t low = 0xFFFF'FFFFU;
    if (r == Register::ring_base_low)
        s.ring.base = (s.ring.base & ~low) | (value & ~uint32_t{sizeof(Line) - 1});
    if (r == Register::ring_base_high) s.ring.base = (s.ring.base & low) | uint64_t{value} << 32;
    if (r == Register::ring_log2_size) s.ring.log2_size = std::min(value, most_log2_ring_size);
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
    if (r < Register::stop || r == Register::volumes) return read_of_device(s, config, r);
    return r < Register::ring_base_low ? read_of_stop(s, r) : read_of_ring(s, r);
}

void write(CoprocessorState& s, const DeviceConfig& config, uint32_t address, uint32_t value) {
    const auto r = static_cast<Register>(address);
    switch (r) {
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
    case Register::ring_base_low:
    case Register::ring_base_high:
    case Register::ring_log2_size:
        return write_ring_place(s, r, value);
    case Register::ring_tail:
        return ring_doorbell(s.ring, value);
    default:
        return;
    }
}

} // namespace hwsim
