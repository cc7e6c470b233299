#include "hwsim/memory_unit.h"

#include "hwsim/registers.h"

namespace hwsim {
namespace {

/// The line that arrives at this edge, if any.
ReadResponse arriving(MemoryUnit& unit, uint64_t cycle) {
    if (unit.under_way.empty() || unit.under_way.front().arrives > cycle) return {};
    const MemoryUnit::Pending& read = unit.under_way.front();
    const ReadResponse line{true, is_intact(read.line, read.request.address), read.request,
                            read.line};
    unit.under_way.pop();
    ++unit.reads_done;
    return line;
}

/// What the port does next. Reads have priority; while the write queue is full, reads and writes
/// alternate.
enum class NextUse : uint8_t { none, read, write };
NextUse next_use(const MemoryUnit& unit, uint64_t cycle) {
    if (unit.free_at > cycle) return NextUse::none;
    const bool can_read = !unit.asked.empty() && !unit.under_way.full();
    if (!unit.writes.empty() && (!can_read || (unit.writes.full() && !unit.write_was_last)))
        return NextUse::write;
    return can_read ? NextUse::read : NextUse::none;
}

void use_port(MemoryUnit& unit, NextUse use, const DeviceConfig& config, uint64_t cycle) {
    unit.has_written = use == NextUse::write;
    if (use == NextUse::none) return;
    unit.write_was_last = unit.has_written;
    unit.free_at = cycle + config.cycles_per_line;
    if (unit.has_written) {
        const MemoryUnit::Write& write = unit.writes.front();
        unit.lines[write.address] = write.line;
        unit.written = write.address;
        unit.writes.pop();
        ++unit.writes_done;
    } else {
        const ReadRequest& request = unit.asked.front();
        unit.under_way.push({request, cycle + config.memory_latency, unit.lines[request.address]});
        unit.asked.pop();
    }
}

} // namespace

MemoryUnit memory_unit(const DeviceConfig& config) {
    MemoryUnit unit;
    unit.lines = DeviceMemory(config.memory_lines);
    unit.asked = Ring<ReadRequest>(config.memory_queue);
    unit.under_way = Ring<MemoryUnit::Pending>(config.memory_queue);
    unit.writes = Ring<MemoryUnit::Write>(config.write_queue);
    return unit;
}

void tick(MemoryUnit& unit, const DeviceConfig& config, uint64_t cycle, const ReadRequest& in) {
    const bool is_due = !unit.asked.empty() || !unit.under_way.empty() || !unit.writes.empty();
    const NextUse use = unit.stalled ? NextUse::none : next_use(unit, cycle);
    const ReadResponse answer = unit.stalled ? ReadResponse() : arriving(unit, cycle);
    unit.check.tick(answer);
    use_port(unit, use, config, cycle);
    if (in.valid) unit.asked.push(in);
    unit.waited = is_due && use == NextUse::none && !answer.valid ? unit.waited + 1 : 0;
}

bool is_stalled(const MemoryUnit& unit, const DeviceConfig& config) {
    return unit.waited > config.memory_limit;
}

} // namespace hwsim
