#include "hwsim/rtl_device.h"

#include <Coprocessor.h>
#include <SmallCoprocessor.h>
#include <fmt/format.h>

#include "hwsim/circuit_port.h"

namespace hwsim {
namespace {

/// The pins of the device before an edge.
struct Pins {
    bool bus_write = false, bus_read = false;
    uint32_t bus_address = 0, bus_data = 0;
    bool memory_is_ready = false, host_is_ready = false;
    const Line* memory_line = nullptr; // that arrives
    const Line* host_line = nullptr;
    bool host_is_missing = false;
};

/// What the device does at the edge.
struct Outputs {
    bool memory_reads = false, memory_writes = false, host_read = false;
    uint32_t memory_address = 0;
    Line memory_line;
    uint64_t host_from = 0; // line
};

/// A circuit of any size.
class Circuit {
public:
    virtual ~Circuit() = default;
    virtual Outputs settle(const Pins& pins) = 0;
    virtual uint32_t answer(uint32_t address) = 0;
    virtual bool irq() = 0;
    virtual void edge() = 0;
};

template <typename Model>
class CircuitOf : public Circuit {
public:
    explicit CircuitOf(const DeviceConfig& config) {
        model_.memory_lines = config.memory_lines;
        model_.search_limit = config.search_limit;
        model_.memory_limit = config.memory_limit;
        model_.bus_write = 1; // of a reset
        model_.bus_address = address_of(Register::control);
        model_.bus_data = control_reset;
        model_.clk = 0;
        model_.eval();
        edge();
    }

    Outputs settle(const Pins& pins) override {
        model_.clk = 0;
        model_.bus_write = pins.bus_write;
        model_.bus_read = pins.bus_read;
        model_.bus_address = static_cast<uint16_t>(pins.bus_address);
        model_.bus_data = pins.bus_data;
        model_.memory_is_ready = pins.memory_is_ready;
        model_.host_is_ready = pins.host_is_ready;
        model_.memory_arrives = pins.memory_line != nullptr;
        model_.host_arrives = pins.host_line != nullptr;
        model_.host_is_missing = pins.host_is_missing;
        if (pins.memory_line) set(model_.memory_line, *pins.memory_line);
        if (pins.host_line) set(model_.host_line, *pins.host_line);
        model_.eval();
        Outputs out{.memory_reads = model_.memory_reads != 0,
                    .memory_writes = model_.memory_writes != 0,
                    .host_read = model_.host_read != 0,
                    .memory_address = model_.memory_address,
                    .host_from = model_.host_from};
        if (out.memory_writes)
            for (size_t i = 0; i < Line::words; ++i)
                out.memory_line.word[i] = model_.memory_write_line[i];
        return out;
    }

    uint32_t answer(uint32_t address) override {
        model_.bus_address = static_cast<uint16_t>(address);
        model_.eval();
        return model_.bus_answer;
    }

    bool irq() override { return model_.irq != 0; }

    void edge() override {
        model_.clk = 1;
        model_.eval();
    }

private:
    template <typename Port>
    static void set(Port& port, const Line& line) {
        for (size_t i = 0; i < Line::words; ++i) port[i] = line.word[i];
    }

    Model model_;
};

bool has_sizes(const DeviceConfig& config, const DeviceConfig& sizes) {
    return config.volumes == Volumes::boxes && config.elements == sizes.elements
           && config.threads == sizes.threads && config.stack_depth == sizes.stack_depth
           && config.node_cache_lines == sizes.node_cache_lines
           && config.record_cache_lines == sizes.record_cache_lines
           && config.fifo_depth == sizes.fifo_depth && config.memory_queue == sizes.memory_queue
           && config.write_queue == sizes.write_queue && config.host_queue == sizes.host_queue;
}

// As in CMakeLists.txt.
constexpr DeviceConfig usual{.elements = 2, .threads = 4};
constexpr DeviceConfig small{.elements = 3,
                             .threads = 2,
                             .node_cache_lines = 8,
                             .record_cache_lines = 4,
                             .fifo_depth = 8,
                             .memory_queue = 4,
                             .write_queue = 4,
                             .host_queue = 3};

/// A line that the memory will give, as it was when it was read.
struct DueLine {
    uint64_t arrives = 0; // cycle
    Line line;
};

/// A line of the host's memory that is read when it arrives.
struct DueFromHost {
    uint64_t arrives = 0; // cycle
    uint64_t from = 0;    // byte address
};

} // namespace

struct RtlDevice::Board {
    DeviceConfig config;
    std::unique_ptr<Circuit> circuit;
    DeviceMemory own_memory;
    HostMemory own_shared;
    DeviceMemory* memory = &own_memory;
    HostMemory* shared = &own_shared;
    bool is_memory_stalled = false, is_host_stalled = false;

    uint64_t cycle = 0, memory_free_at = 0, host_free_at = 0;
    Ring<DueLine> from_memory;
    Ring<DueFromHost> from_host;
    bool writes = false, reads = false; // on the bus, at the coming edge
    uint32_t address = 0, data = 0;

    Board(const DeviceConfig& with, std::unique_ptr<Circuit> made)
        : config(with), circuit(std::move(made)), own_memory(with.memory_lines) {
        begin();
    }

    /// After a reset.
    void begin() {
        cycle = memory_free_at = host_free_at = 0;
        from_memory = Ring<DueLine>(config.memory_queue);
        from_host = Ring<DueFromHost>(config.host_queue);
    }

    bool resets() const {
        return writes && address == address_of(Register::control) && (data & control_reset) != 0;
    }

    template <typename Due>
    static bool arrives(const Ring<Due>& due, uint64_t at, bool is_stalled) {
        return !is_stalled && !due.empty() && due.front().arrives <= at;
    }

    Pins pins_at(uint64_t next) const {
        static const Line nothing;
        Pins pins{.bus_write = writes,
                  .bus_read = reads,
                  .bus_address = address,
                  .bus_data = data,
                  .memory_is_ready = memory_free_at <= next && !is_memory_stalled,
                  .host_is_ready = host_free_at <= next};
        if (arrives(from_memory, next, is_memory_stalled))
            pins.memory_line = &from_memory.front().line;
        if (arrives(from_host, next, is_host_stalled)) {
            const Line* line = shared->at(from_host.front().from);
            pins.host_is_missing = !line;
            pins.host_line = line ? line : &nothing;
        }
        return pins;
    }

    void clock() {
        const Pins pins = pins_at(cycle + 1);
        const Outputs out = circuit->settle(pins);
        const bool was_reset = resets();
        circuit->edge();
        writes = reads = false;
        if (was_reset) return begin();
        ++cycle;
        if (pins.memory_line) from_memory.pop();
        if (pins.host_line) from_host.pop();
        if (pins.memory_is_ready && (out.memory_reads || out.memory_writes)) use_memory(out);
        if (pins.host_is_ready && out.host_read) {
            from_host.push({cycle + config.host_latency, out.host_from * sizeof(Line)});
            host_free_at = cycle + config.host_cycles_per_line;
        }
    }

    void use_memory(const Outputs& out) {
        Line& line = (*memory)[out.memory_address];
        if (out.memory_writes)
            line = out.memory_line;
        else
            from_memory.push({cycle + config.memory_latency, line});
        memory_free_at = cycle + config.cycles_per_line;
    }
};

RtlDevice::RtlDevice(std::unique_ptr<Board> board) : board_(std::move(board)) {}
RtlDevice::RtlDevice(RtlDevice&&) noexcept = default;
RtlDevice& RtlDevice::operator=(RtlDevice&&) noexcept = default;
RtlDevice::~RtlDevice() = default;

core::Result<RtlDevice> RtlDevice::with(const DeviceConfig& config) {
    FEELER_TRY(const DeviceConfig good, checked(config));
    std::unique_ptr<Circuit> circuit;
    if (has_sizes(good, usual)) circuit = std::make_unique<CircuitOf<Coprocessor>>(good);
    if (has_sizes(good, small)) circuit = std::make_unique<CircuitOf<SmallCoprocessor>>(good);
    if (!circuit)
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("the circuit has {} elements of {} threads, boxes in its "
                                      "nodes, and the other sizes that are usual",
                                      usual.elements, usual.threads));
    return RtlDevice(std::make_unique<Board>(good, std::move(circuit)));
}

const DeviceConfig& RtlDevice::config() const { return board_->config; }
DeviceMemory& RtlDevice::memory() { return *board_->memory; }
HostMemory& RtlDevice::shared() { return *board_->shared; }

void RtlDevice::share(DeviceMemory& memory, HostMemory& host) {
    board_->memory = &memory;
    board_->shared = &host;
}

void RtlDevice::set_stalled(bool memory, bool host) {
    board_->is_memory_stalled = memory;
    board_->is_host_stalled = host;
}

void RtlDevice::clock() { board_->clock(); }
uint64_t RtlDevice::cycle() const { return board_->cycle; }

uint32_t RtlDevice::read(uint32_t address) {
    board_->reads = true;
    board_->address = address;
    return board_->circuit->answer(address);
}

void RtlDevice::write(uint32_t address, uint32_t value) {
    board_->writes = true;
    board_->address = address;
    board_->data = value;
    if (board_->resets()) board_->clock();
}

bool RtlDevice::interrupt() { return board_->circuit->irq(); }

DevicePort port_of(RtlDevice& device, std::function<void()> after_cycle) {
    const auto access = [&device, after_cycle = std::move(after_cycle)] {
        for (uint32_t i = 0; i < device.bus_cycles; ++i) {
            device.clock();
            if (after_cycle) after_cycle();
        }
    };
    return {.read =
                [&device, access](Register r) {
                    access();
                    return device.read(address_of(r));
                },
            .write =
                [&device, access](uint32_t address, uint32_t value) {
                    access();
                    device.write(address, value);
                },
            .wait = access,
            .shared = &device.shared()};
}

core::Result<DevicePort> port_with_circuit(EmulatedDevice& device,
                                           std::function<void(const CoprocessorState&)> after_cycle,
                                           const CircuitDifference& difference) {
    FEELER_TRY(RtlDevice made, RtlDevice::with(device.config));
    const auto circuit = std::make_shared<RtlDevice>(std::move(made));
    circuit->share(device.state.memory.lines, device.state.shared);
    DevicePort port = port_of(
        device, [circuit, after_cycle = std::move(after_cycle)](const CoprocessorState& state) {
            circuit->clock();
            if (after_cycle) after_cycle(state);
        });
    port.read = [circuit, difference, &device, read = std::move(port.read)](Register r) {
        const uint32_t emulated = read(r);
        const uint32_t value = circuit->read(address_of(r));
        if (value != emulated && difference->empty())
            *difference = fmt::format("in cycle {}, register {:#05x} of the circuit is {:#x}, and "
                                      "that of the emulator {:#x}",
                                      device.state.cycle, address_of(r), value, emulated);
        return value;
    };
    port.write = [circuit, write = std::move(port.write)](uint32_t address, uint32_t value) {
        write(address, value);
        circuit->write(address, value);
    };
    return port;
}

} // namespace hwsim
