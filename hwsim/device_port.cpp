#include "hwsim/device_port.h"

#include "hwsim/search.h"

namespace hwsim {
namespace {

void clock(EmulatedDevice& device) {
    for (uint32_t i = 0; i < device.bus_cycles; ++i) tick(device.state, device.config);
}

/// One entry of the FIFO, from its models to its permit.
void answer_first(FunctionalDevice& device) {
    CoprocessorState& s = device.state;
    const SegmentFifo::Entry entry = s.fifo.entries.front();
    s.fifo.entries.pop();
    s.permits.in_order.push({.segment = entry.segment, .pushed = entry.pushed});
    Answer answer;
    if (entry.segment.kind == SegmentKind::model)
        take_model(s, entry.segment);
    else
        answer.stop = fault_of_models(s, entry.segment);
    if (entry.segment.kind != SegmentKind::model && answer.stop == Stop::none)
        answer = search(s.memory.lines, query_of(s, entry.segment), device.config.stack_depth);
    retire_with(s, answer);
}

/// Whatever can be done is done.
void settle(FunctionalDevice& device) {
    CoprocessorState& s = device.state;
    for (; !s.memory.writes.empty(); s.memory.writes.pop()) {
        s.memory.lines[s.memory.writes.front().address] = s.memory.writes.front().line;
        ++s.memory.writes_done;
    }
    while (s.host.enabled && !s.fifo.entries.empty()) answer_first(device);
}

} // namespace

core::Result<EmulatedDevice> emulated_device(const DeviceConfig& config) {
    FEELER_TRY(const DeviceConfig good, checked(config));
    return EmulatedDevice{good, power_up(good)};
}

core::Result<FunctionalDevice> functional_device(const DeviceConfig& config) {
    FEELER_TRY(const DeviceConfig good, checked(config));
    FunctionalDevice device{good, power_up(good)};
    device.state.elements.clear();
    return device;
}

DevicePort port_of(EmulatedDevice& device) {
    return {.read =
                [&device](Register r) {
                    clock(device);
                    return read(device.state, device.config, address_of(r));
                },
            .write =
                [&device](uint32_t address, uint32_t value) {
                    clock(device);
                    write(device.state, device.config, address, value);
                },
            .store =
                [&device](uint32_t line, const Line& content) {
                    tick(device.state, device.config);
                    return store(device.state, line, content);
                },
            .wait = [&device] { clock(device); }};
}

DevicePort port_of(FunctionalDevice& device) {
    return {
        .read = [&device](Register r) { return read(device.state, device.config, address_of(r)); },
        .write =
            [&device](uint32_t address, uint32_t value) {
                write(device.state, device.config, address, value);
                device.state.elements.clear(); // a reset makes them anew
                settle(device);
            },
        .store =
            [&device](uint32_t line, const Line& content) {
                const bool taken = store(device.state, line, content);
                settle(device);
                return taken;
            },
        .wait = [] {}};
}

} // namespace hwsim
