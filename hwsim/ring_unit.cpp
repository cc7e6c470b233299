#include "hwsim/ring_unit.h"

#include "hwsim/registers.h"

namespace hwsim {
namespace {

uint32_t pairs_in_line(const RingUnit& unit) {
    return unit.is_first_line ? Descriptor::pairs_in_first : Descriptor::pairs_in_next;
}

void fail(RingUnit& unit, Stop reason, uint32_t run, uint32_t sequence, uint32_t line) {
    unit.fault = {true, run, reason, sequence, line};
    unit.current = {};
    unit.is_faulty = true;
}

/// Takes a line from the host, if one arrives at this edge; returns it if it is one of the ring.
FetchedDescriptor take_arrival(RingUnit& unit, const HostMemory& host, const RingInput& in) {
    unit.has_copied = false;
    const bool was_due = !unit.under_way.empty();
    if (unit.stalled || !was_due || unit.under_way.front().arrives > in.cycle) {
        unit.waited = was_due ? unit.waited + 1 : 0;
        return {};
    }
    unit.waited = 0;
    const RingUnit::Read read = unit.under_way.front();
    unit.under_way.pop();
    ++unit.reads_done;
    const Line* line = host.at(read.from);
    if (!read.of_copy)
        return {true,
                !line,
                line && is_intact(*line, read.number),
                read.run,
                read.number,
                read.asked,
                line ? *line : Line()};
    // Without a line there is nothing to write, but it counts as written: what reads it finds a
    // wrong check word or an old epoch, and the device stops anyway.
    --unit.copying;
    unit.has_copied = true;
    unit.copied_is_missing = !line;
    unit.copied_run = read.run;
    unit.copied_to = read.number;
    unit.copied = line ? *line : Line();
    return {};
}

/// What the unit reads next from the host: a line of the ring, if there is room, otherwise one to
/// be copied.
enum class NextRead : uint8_t { none, of_ring, of_copy };
NextRead next_read(const RingUnit& unit, const DeviceConfig& config, const RingInput& in) {
    if (unit.free_at > in.cycle || unit.under_way.full()) return NextRead::none;
    const uint32_t ahead = unit.fetched - unit.head;
    if (unit.fetched != unit.tail && ahead < config.host_queue) return NextRead::of_ring;
    const uint32_t on_the_way = unit.copying + (unit.has_copied ? 1U : 0U);
    return has_copy(unit) && on_the_way < in.memory_room ? NextRead::of_copy : NextRead::none;
}

/// `of`: the copy as it was before this edge, at which a fault may have dropped it.
void read(RingUnit& unit, NextRead which, const LineCopy& of, const DeviceConfig& config,
          const RingInput& in) {
    RingUnit::Read read{
        .run = in.run, .asked = in.cycle, .arrives = in.cycle + config.host_latency};
    if (which == NextRead::of_ring) {
        read.number = unit.fetched;
        read.from = address_in_ring(unit, unit.fetched++);
    } else {
        read.of_copy = true;
        read.number = of.line;
        read.from = of.from;
        if (has_copy(unit)) {
            LineCopy& copy = unit.current.copy;
            ++copy.line;
            copy.from += sizeof(Line);
            --copy.count;
        }
        ++unit.copying;
        ++unit.lines_asked;
    }
    unit.under_way.push(read);
    unit.free_at = in.cycle + config.host_cycles_per_line;
}

void carry_out(RingUnit& unit, const DeviceConfig& config, const RingInput& in) {
    if (is_overrun(unit)) return fail(unit, Stop::fifo_overrun, in.run, 0, unit.tail);
    if (has_entry(unit)) {
        if (in.has_room) unit.entry = take_entry(unit, in.run);
    } else if (needs_line(unit) && !unit.waiting.empty()) {
        take_line(unit, unit.waiting.front(), config);
        unit.waiting.pop();
    }
}

} // namespace

const Line* HostMemory::at(uint64_t address) const {
    const uint64_t line = (address - base) / sizeof(Line);
    return address >= base && line < lines.size() ? &lines[line] : nullptr;
}

RingUnit ring_unit(const DeviceConfig& config) {
    RingUnit unit;
    unit.under_way = Ring<RingUnit::Read>(config.host_queue);
    unit.waiting = Ring<FetchedDescriptor>(config.host_queue);
    return unit;
}

uint64_t address_in_ring(const RingUnit& unit, uint32_t number) {
    return unit.base + sizeof(Line) * (number & ((1U << unit.log2_size) - 1));
}

bool has_entry(const RingUnit& unit) {
    if (unit.current.order == Order::model) return true;
    return unit.current.pairs > 0 && unit.next_pair < pairs_in_line(unit);
}

bool needs_line(const RingUnit& unit) { return !has_entry(unit) && !has_copy(unit); }

bool is_idle(const RingUnit& unit) {
    return unit.head == unit.tail && unit.current.order != Order::model && unit.current.pairs == 0
           && !has_copy(unit) && !unit.entry.valid && !unit.fault.valid;
}

void ring_doorbell(RingUnit& unit, uint32_t tail) { unit.tail = tail; }

bool is_overrun(const RingUnit& unit) { return unit.tail - unit.head > 1U << unit.log2_size; }

void skip_all(RingUnit& unit) { unit.fetched = unit.head = unit.tail; }

void drop_orders(RingUnit& unit) {
    unit.waiting.clear();
    unit.current = {};
    unit.is_faulty = unit.fault.valid = false;
}

void take_line(RingUnit& unit, const FetchedDescriptor& line, const DeviceConfig& config) {
    ++unit.head;
    if (line.is_missing) return fail(unit, Stop::bad_address, line.run, 0, line.number);
    if (!line.is_intact) return fail(unit, Stop::bad_descriptor, line.run, 0, line.number);
    const bool is_first = unit.current.pairs == 0;
    if (is_first) {
        const DecodedDescriptor decoded = descriptor_in(line.line, config);
        unit.current = decoded.descriptor;
        unit.asked = line.asked;
        if (decoded.fault == Stop::bad_address)
            return fail(unit, decoded.fault, line.run, 0,
                        unit.current.order == Order::model ? unit.current.segment.model_header
                                                           : unit.current.copy.line);
        if (decoded.fault != Stop::none)
            return fail(unit, decoded.fault, line.run, unit.current.segment.sequence, line.number);
    }
    unit.is_first_line = is_first;
    unit.pairs = line.line;
    unit.next_pair = 0;
}

OrderedEntry take_entry(RingUnit& unit, uint32_t run) {
    OrderedEntry entry{true, run, unit.current.segment, unit.asked, unit.lines_asked};
    if (unit.current.order == Order::model) {
        unit.current = {};
        return entry;
    }
    entry.segment =
        with_pair(unit.current.segment, unit.pairs, unit.next_pair++, unit.is_first_line);
    entry.segment.last = unit.current.segment.last && unit.current.pairs == 1;
    if (--unit.current.pairs == 0) unit.current = {};
    if (const Stop fault = fault_of(entry.segment); fault != Stop::none) {
        fail(unit, fault, run, entry.segment.sequence, unit.head - 1);
        return {};
    }
    return entry;
}

void tick(RingUnit& unit, const HostMemory& host, const DeviceConfig& config, const RingInput& in) {
    unit.entry.valid = unit.fault.valid = false;
    if (in.flush) drop_orders(unit);
    const FetchedDescriptor checked = unit.check.output();
    const bool has_lost_copy =
        unit.has_copied && unit.copied_is_missing && unit.copied_run == in.run;
    const bool works = !in.flush && !in.is_stopped && !unit.is_faulty;
    const NextRead next = works ? next_read(unit, config, in) : NextRead::none;
    const LineCopy copy = unit.current.copy;
    if (works && has_lost_copy)
        fail(unit, Stop::bad_address, in.run, 0, unit.copied_to);
    else if (works)
        carry_out(unit, config, in);
    unit.check.tick(take_arrival(unit, host, in));
    if (checked.valid && checked.run == in.run) unit.waiting.push(checked);
    if (next != NextRead::none) read(unit, next, copy, config, in);
}

bool is_stalled(const RingUnit& unit, const DeviceConfig& config) {
    return unit.waited > config.memory_limit;
}

} // namespace hwsim
