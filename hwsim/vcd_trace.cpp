#include "hwsim/vcd_trace.h"

#include <bit>

#include <fmt/format.h>

#include "hwsim/coprocessor.h"

namespace hwsim {
namespace {

/// Short names of printable characters, as required by the format.
std::string identifier(size_t number) {
    std::string id;
    do {
        id += static_cast<char>('!' + number % 94);
        number /= 94;
    } while (number > 0);
    return id;
}

/// A signal of the device as a whole.
struct DeviceSignal {
    const char* name;
    uint32_t bits;
    uint64_t (*value)(const CoprocessorState&);
};

constexpr DeviceSignal device_signals[] = {
    {"enabled", 1, [](const CoprocessorState& s) { return uint64_t{s.host.enabled}; }},
    {"stopped", 1,
     [](const CoprocessorState& s) { return uint64_t{s.permits.stopped != Stop::none}; }},
    {"stop", 4, [](const CoprocessorState& s) { return static_cast<uint64_t>(s.permits.stopped); }},
    {"permit_seq", 32,
     [](const CoprocessorState& s) { return uint64_t{s.permits.permit_sequence}; }},
    {"retired", 32, [](const CoprocessorState& s) { return uint64_t{s.permits.retired}; }},
    {"fifo_used", 16, [](const CoprocessorState& s) { return uint64_t{s.fifo.entries.size()}; }},
    {"ring_used", 32,
     [](const CoprocessorState& s) { return uint64_t{s.ring.tail - s.ring.head}; }},
    {"host_reads", 16, [](const CoprocessorState& s) { return uint64_t{s.ring.under_way.size()}; }},
    {"dispatched", 16,
     [](const CoprocessorState& s) { return uint64_t{s.permits.in_order.size()}; }},
    {"searching", 16, [](const CoprocessorState& s) { return uint64_t{s.searching}; }},
    {"memory_asked", 16, [](const CoprocessorState& s) { return uint64_t{s.memory.asked.size()}; }},
    {"memory_under_way", 16,
     [](const CoprocessorState& s) { return uint64_t{s.memory.under_way.size()}; }},
    {"memory_writes", 16,
     [](const CoprocessorState& s) { return uint64_t{s.memory.writes.size()}; }},
    {"memory_response", 1,
     [](const CoprocessorState& s) { return uint64_t{s.memory.check.output().valid}; }},
    {"irq", 1, [](const CoprocessorState& s) { return uint64_t{interrupt(s)}; }},
    {"retires", 1, [](const CoprocessorState& s) { return uint64_t{s.retired.valid}; }},
    {"retired_seq", 32,
     [](const CoprocessorState& s) { return uint64_t{s.retired.segment.sequence}; }}};

/// A signal of an element: the number of threads in a state.
struct ElementSignal {
    const char* name;
    uint32_t SearchElement::*threads;
};

constexpr ElementSignal element_signals[] = {{"busy", &SearchElement::busy},
                                             {"waiting", &SearchElement::waiting},
                                             {"done", &SearchElement::done}};

} // namespace

VcdTrace::VcdTrace(const DeviceConfig& config) : clock_mhz_(config.clock_mhz) {
    text_ = "$version feeler $end\n$timescale 1ps $end\n$scope module coprocessor $end\n";
    for (const DeviceSignal& signal : device_signals) declare(signal.name, signal.bits);
    for (uint32_t i = 0; i < config.elements; ++i)
        for (const ElementSignal& signal : element_signals)
            declare(fmt::format("element{}_{}", i, signal.name), 5);
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
    if (!has_time) text_ += fmt::format("#{}\n", cycle * 1'000'000 / clock_mhz_);
    has_time = true;
    text_ += known.bits == 1 ? fmt::format("{}{}\n", value, known.id)
                             : fmt::format("b{:b} {}\n", value, known.id);
}

void VcdTrace::note(const CoprocessorState& state) {
    bool has_time = false;
    size_t next = 0;
    for (const DeviceSignal& signal : device_signals)
        write(next++, signal.value(state), has_time, state.cycle);
    for (const SearchElement& element : state.elements)
        for (const ElementSignal& signal : element_signals)
            write(next++, static_cast<uint64_t>(std::popcount(element.*signal.threads)), has_time,
                  state.cycle);
}

} // namespace hwsim
