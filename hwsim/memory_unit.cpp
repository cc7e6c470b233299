#include "hwsim/memory_unit.h"

#include <algorithm>

#include "hwsim/registers.h"

namespace hwsim {
namespace {

/// The line that arrives in this cycle, if any.
ReadResponse arriving(MemoryUnit& unit, uint64_t cycle) {
    if (unit.under_way.empty() || unit.under_way.front().cycle > cycle) return {};
    const MemoryUnit::Pending& read = unit.under_way.front();
    const ReadResponse line{true, is_intact(read.line, read.request.address), read.request,
                            read.line};
    unit.under_way.pop();
    ++unit.reads_done;
    return line;
}

/// Reads have priority; while the write queue is full, reads and writes alternate.
void use_port(MemoryUnit& unit, const DeviceConfig& config, uint64_t cycle) {
    unit.has_written = false;
    if (unit.free_at > cycle) return;
    const bool can_read = !unit.asked.empty() && !unit.under_way.full();
    if (!unit.writes.empty() && (!can_read || (unit.writes.full() && !unit.write_was_last))) {
        unit.write_was_last = true;
        const MemoryUnit::Write& write = unit.writes.front();
        unit.lines[write.address] = write.line;
        unit.has_written = true;
        unit.written = write.address;
        unit.writes.pop();
        ++unit.writes_done;
        unit.free_at = cycle + config.cycles_per_line;
    } else if (can_read) {
        unit.write_was_last = false;
        const ReadRequest& request = unit.asked.front().request;
        unit.under_way.push({request, cycle + config.memory_latency, unit.lines[request.address]});
        unit.asked.pop();
        unit.free_at = cycle + config.cycles_per_line;
    }
}

} // namespace

MemoryUnit memory_unit(const DeviceConfig& config) {
    MemoryUnit unit;
    unit.lines = DeviceMemory(config.memory_lines);
    unit.asked = Ring<MemoryUnit::Pending>(config.memory_queue);
    unit.under_way = Ring<MemoryUnit::Pending>(config.memory_queue);
    unit.writes = Ring<MemoryUnit::Write>(config.write_queue);
    return unit;
}

void tick(MemoryUnit& unit, const DeviceConfig& config, uint64_t cycle, const ReadRequest& in) {
    if (unit.stalled) {
        unit.check.tick({});
        unit.has_written = false;
    } else {
        unit.check.tick(arriving(unit, cycle));
        use_port(unit, config, cycle);
    }
    if (in.valid) unit.asked.push({in, cycle, {}});
}

bool is_stalled(const MemoryUnit& unit, const DeviceConfig& config, uint64_t cycle) {
    const auto is_late = [&](uint64_t since) {
        return cycle > std::max(since, unit.watchdog_since) + config.memory_limit;
    };
    const auto is_read_late = [&](const Ring<MemoryUnit::Pending>& queue) {
        return !queue.empty() && is_late(queue.front().cycle);
    };
    // Reads may delay a write; then the port is not idle for long.
    return is_read_late(unit.asked) || is_read_late(unit.under_way)
           || (!unit.writes.empty() && is_late(std::max(unit.writes.front().cycle, unit.free_at)));
}

} // namespace hwsim
