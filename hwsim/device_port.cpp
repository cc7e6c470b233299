#include "hwsim/device_port.h"

#include "hwsim/search.h"

namespace hwsim {
namespace {

/// An emulated device with whoever looks on.
struct WatchedDevice {
    EmulatedDevice& device;
    std::function<void(const CoprocessorState&)> after_cycle;

    void cycles(uint32_t count) const {
        for (uint32_t i = 0; i < count; ++i) {
            tick(device.state, device.config);
            if (after_cycle) after_cycle(device.state);
        }
    }
    void access() const { cycles(device.bus_cycles); }
};

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

DevicePort port_of(EmulatedDevice& device,
                   std::function<void(const CoprocessorState&)> after_cycle) {
    const WatchedDevice watched{device, std::move(after_cycle)};
    return {.read =
                [watched](Register r) {
                    watched.access();
                    return read(watched.device.state, watched.device.config, address_of(r));
                },
            .write =
                [watched](uint32_t address, uint32_t value) {
                    watched.access();
                    write(watched.device.state, watched.device.config, address, value);
                },
            .store =
                [watched](uint32_t line, const Line& content) {
                    watched.cycles(1);
                    return store(watched.device.state, line, content);
                },
            .wait = [watched] { watched.access(); }};
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
