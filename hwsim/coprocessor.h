#pragma once

#include <array>
#include <functional>
#include <span>

#include "hwsim/memory_unit.h"
#include "hwsim/registers.h"
#include "hwsim/ring_unit.h"
#include "hwsim/search_element.h"
#include "hwsim/segment.h"

namespace hwsim {

/// The source of the answer to an entry of the FIFO.
struct Dispatched {
    Segment segment;
    uint64_t asked = 0;    // cycle in which its descriptor was asked for
    bool searched = false; // by a thread; otherwise `fault` is the whole answer
    uint8_t element = 0, thread = 0;
    Stop fault = Stop::none;

    bool operator==(const Dispatched&) const = default;
};

/// Decides what is permitted: takes answers in FIFO order and stops at the first refusal.
struct PermitUnit {
    Ring<Dispatched> in_order;
    uint32_t permit_sequence = 0; // all segments up to this one may be entered
    uint32_t retired = 0;         // entries

    Stop stopped = Stop::none; // nothing is permitted unless this is none
    uint32_t stop_sequence = 0, stop_line = 0;

    Answer found; // of the violation or the last measurement
    uint32_t found_sequence = 0;

    uint64_t missed = 0, longest = 0;
    int64_t least_slack = INT64_MAX;

    bool operator==(const PermitUnit&) const = default;
};

/// The effect of an answer on the permits.
struct Retirement {
    bool permitted = false, measured = false;
    Stop stopped = Stop::none; // why the device must stop
};

/// Processes the answer to the first entry. A positive answer advances the permit if the entry is
/// the last of its segment; any other stops the device.
Retirement retire(PermitUnit& unit, const Answer& answer, uint64_t cycle);

/// Stops with a reason unless already stopped. Waiting entries are dropped.
void stop(PermitUnit& unit, Stop reason, uint32_t sequence, uint32_t line = 0);

/// Waiting segments and the next sequence number.
struct SegmentFifo {
    Ring<OrderedEntry> entries;
    uint32_t next_sequence = 1; // 0: all numbers are used up

    bool operator==(const SegmentFifo&) const = default;
};

/// Adds a segment, or returns the reason for refusal and changes nothing. The FIFO has room.
Stop push(SegmentFifo& fifo, const OrderedEntry& entry);

/// The header of the model in a slot.
struct ModelSlot {
    bool valid = false;
    uint32_t header = 0, epoch = 0;

    bool operator==(const ModelSlot&) const = default;
};

/// Sums over all retired searches.
struct SearchTotals {
    uint64_t queries = 0, nodes = 0, splits = 0, box_tests = 0, pair_tests = 0;
    uint32_t deepest = 0;

    bool operator==(const SearchTotals&) const = default;
};

/// The registers that the host writes and reads directly.
struct HostRegisters {
    bool enabled = false;
    uint32_t irq_pending = 0, irq_enable = 0;
    uint32_t watchdog = 10'000'000; // cycles; 0: off
    uint64_t heartbeat = 0;         // cycle of the last heartbeat
    uint32_t high_word = 0;         // of the pair whose low word was read last

    bool operator==(const HostRegisters&) const = default;
};

/// An entry that was finished in the last cycle, for observers.
struct Retired {
    bool valid = false;
    Segment segment;
    Answer answer;
    uint64_t asked = 0; // cycle in which its descriptor was asked for

    bool operator==(const Retired&) const = default;
};

/// The whole state of the device in a cycle. A copy is a snapshot from which it continues
/// identically.
struct CoprocessorState {
    uint64_t cycle = 0;
    uint32_t run = 0; // counts stops
    HostRegisters host;
    SegmentFifo fifo;
    PermitUnit permits;
    std::array<ModelSlot, model_slots> slots{};
    std::vector<SearchElement> elements;
    MemoryUnit memory;
    RingUnit ring;
    std::vector<uint32_t> occupied; // bit sets of the threads of each element that have a search
    uint32_t searching = 0;         // their number
    uint8_t next_element = 0;       // has priority for the next search
    uint8_t next_request = 0;       // has priority for the memory
    SearchStart start;              // outputs of the permit unit
    ThreadRelease release;
    bool flush = false;
    SearchTotals searched;
    Retired retired;
    HostMemory shared; // of the host, which writes it

    bool operator==(const CoprocessorState&) const = default;
};

/// The device after power-up: nothing is permitted, no models are loaded.
CoprocessorState power_up(const DeviceConfig& config);

/// One rising clock edge.
void tick(CoprocessorState& state, const DeviceConfig& config);

/// The same, for a given order of the units: an element for each number below the number of
/// elements, then the memory, the ring unit, and the permit unit. The order does not matter: units
/// see of each other only what was there before the edge.
void tick_in_order(CoprocessorState& state, const DeviceConfig& config,
                   std::span<const size_t> order);

/// A read or write on the register bus between two edges; `address` in bytes, see Register.
uint32_t read(CoprocessorState& state, const DeviceConfig& config, uint32_t address);
void write(CoprocessorState& state, const DeviceConfig& config, uint32_t address, uint32_t value);

/// Stops the device unless it is stopped: the reason is latched, and everything waiting or pending
/// is dropped.
void halt(CoprocessorState& state, Stop reason, uint32_t sequence, uint32_t line = 0);

/// What the ring unit orders: an entry goes into the FIFO, a fault stops the device. Outputs from
/// before a stop are ignored.
void take_order(CoprocessorState& state, const OrderedEntry& entry, const OrderFault& fault);

/// Shared by the emulator and the functional model: the fault of the models of a segment, its
/// query, loading a model into its slot, and the effect of the answer to the first entry.
Stop fault_of_models(const CoprocessorState& state, const Segment& segment);
Query query_of(const CoprocessorState& state, const Segment& segment);
void store_model(CoprocessorState& state, const Segment& segment);
void retire_with(CoprocessorState& state, const Answer& answer);

/// The interrupt line.
inline bool interrupt(const CoprocessorState& state) {
    return (state.host.irq_pending & state.host.irq_enable) != 0;
}

struct DevicePort;

/// A device with every cycle emulated. Each register access and each wait takes some cycles.
struct EmulatedDevice {
    DeviceConfig config;
    CoprocessorState state;
    uint32_t bus_cycles = 4;

    bool operator==(const EmulatedDevice&) const = default;
};

/// Errors: those of checked().
core::Result<EmulatedDevice> emulated_device(const DeviceConfig& config);

/// The functional model with the same registers: entries are answered at once.
struct FunctionalDevice {
    DeviceConfig config;
    CoprocessorState state; // without elements

    bool operator==(const FunctionalDevice&) const = default;
};

/// Errors: those of checked().
core::Result<FunctionalDevice> functional_device(const DeviceConfig& config);

/// The devices must outlive the ports and must not move. `after_cycle` is called after each cycle.
DevicePort port_of(EmulatedDevice& device,
                   std::function<void(const CoprocessorState&)> after_cycle = {});
DevicePort port_of(FunctionalDevice& device);

} // namespace hwsim
