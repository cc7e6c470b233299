#include "hwsim/vcd_trace.h"

#include <bit>

#include <fmt/format.h>

namespace hwsim {
namespace {

/// Short names of printable characters, as the format wants them.
std::string identifier(size_t number) {
    std::string id;
    do {
        id += static_cast<char>('!' + number % 94);
        number /= 94;
    } while (number > 0);
    return id;
}

std::string binary(uint64_t value) { return fmt::format("{:b}", value); }

/// What the trace shows of a state, in the order in which it is declared.
std::vector<uint64_t> values_of(const CoprocessorState& state) {
    std::vector<uint64_t> values = {
        state.host.enabled,
        state.permits.stopped != Stop::none,
        static_cast<uint64_t>(state.permits.stopped),
        state.permits.permit_sequence,
        state.permits.retired,
        state.fifo.entries.size(),
        state.permits.in_order.size(),
        state.searching,
        state.memory.asked.size(),
        state.memory.under_way.size(),
        state.memory.writes.size(),
        state.memory.response.request.valid,
        interrupt(state),
        state.retired.valid,
        state.retired.segment.sequence,
    };
    for (const SearchElement& element : state.elements) {
        values.push_back(static_cast<uint64_t>(std::popcount(element.busy)));
        values.push_back(static_cast<uint64_t>(std::popcount(element.waiting)));
        values.push_back(static_cast<uint64_t>(std::popcount(element.done)));
    }
    return values;
}

} // namespace

VcdTrace::VcdTrace(const DeviceConfig& config)
    : picoseconds_(1'000'000 / config.clock_mhz), elements_(config.elements) {
    text_ = "$version feeler $end\n$timescale 1ps $end\n$scope module coprocessor $end\n";
    declare("enabled", 1);
    declare("stopped", 1);
    declare("stop", 4);
    declare("permit_seq", 32);
    declare("retired", 32);
    declare("fifo_used", 8);
    declare("dispatched", 8);
    declare("searching", 16);
    declare("memory_asked", 8);
    declare("memory_under_way", 8);
    declare("memory_writes", 8);
    declare("memory_response", 1);
    declare("irq", 1);
    declare("retires", 1);
    declare("retired_seq", 32);
    for (uint32_t i = 0; i < elements_; ++i)
        for (const char* what : {"busy", "waiting", "done"})
            declare(fmt::format("element{}_{}", i, what), 5);
    text_ += "$upscope $end\n$enddefinitions $end\n";
}

void VcdTrace::declare(const std::string& name, uint32_t bits) {
    signals_.push_back({identifier(signals_.size()), bits});
    text_ += fmt::format("$var wire {} {} {} $end\n", bits, signals_.back().id, name);
}

void VcdTrace::write(size_t signal, uint64_t value, bool& has_time, uint64_t cycle) {
    Signal& known = signals_[signal];
    if (known.value == value) return;
    known.value = value;
    if (!has_time) text_ += fmt::format("#{}\n", cycle * picoseconds_);
    has_time = true;
    text_ += known.bits == 1 ? fmt::format("{}{}\n", value, known.id)
                             : fmt::format("b{} {}\n", binary(value), known.id);
}

void VcdTrace::note(const CoprocessorState& state) {
    const std::vector<uint64_t> values = values_of(state);
    bool has_time = false;
    for (size_t i = 0; i < values.size(); ++i) write(i, values[i], has_time, state.cycle);
}

} // namespace hwsim
