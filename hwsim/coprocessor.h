#pragma once

#include "hwsim/memory_unit.h"
#include "hwsim/registers.h"
#include "hwsim/search_element.h"
#include "hwsim/segment.h"

namespace hwsim {

/// Where the answer to an entry of the FIFO comes from.
struct Dispatched {
    Segment segment;
    uint64_t pushed = 0;   // cycle
    bool searched = false; // by a thread; else `fault` is all there is to say
    uint8_t element = 0, thread = 0;
    Stop fault = Stop::none;

    bool operator==(const Dispatched&) const = default;
};

/// Decides what is permitted: takes answers in the order of the FIFO, and stops at the first that
/// is no yes.
struct PermitUnit {
    Ring<Dispatched> in_order;
    uint32_t permit_sequence = 0; // everything up to this may be entered
    uint32_t retired = 0;         // entries

    Stop stopped = Stop::none; // nothing is permitted while it is not none
    uint32_t stop_sequence = 0, stop_line = 0;

    Answer found; // of the violation or the last measurement
    uint32_t found_sequence = 0;

    uint64_t missed = 0, longest = 0;
    int64_t least_slack = INT64_MAX;

    bool operator==(const PermitUnit&) const = default;
};

/// What an answer made of the permits.
struct Retirement {
    bool permitted = false, measured = false;
    Stop stopped = Stop::none; // why the device has to stop
};

/// Takes the answer to the first entry: one that permits advances the permit if it is the last of
/// its segment; any other is a reason to stop.
Retirement retire(PermitUnit& unit, const Answer& answer, uint64_t cycle);

/// Stops for a reason, unless stopped already. Entries that wait are dropped.
void stop(PermitUnit& unit, Stop reason, uint32_t sequence, uint32_t line = 0);

/// Segments on their way, and which number comes next.
struct SegmentFifo {
    struct Entry {
        Segment segment;
        uint64_t pushed = 0; // cycle
        uint64_t lines = 0;  // that the memory had been given by then
        bool operator==(const Entry&) const = default;
    };
    Ring<Entry> entries;
    uint32_t next_sequence = 1; // 0: all numbers are used up

    bool operator==(const SegmentFifo&) const = default;
};

/// Takes a segment in, or says why not; then nothing has changed.
Stop push(SegmentFifo& fifo, const SegmentWords& words, uint64_t cycle, uint64_t lines);

/// The header of the model that a slot holds.
struct ModelSlot {
    bool valid = false;
    uint32_t header = 0, epoch = 0;

    bool operator==(const ModelSlot&) const = default;
};

/// Sums over all searches that were retired.
struct SearchSums {
    uint64_t queries = 0, nodes = 0, splits = 0, box_tests = 0, pair_tests = 0;
    uint32_t deepest = 0;

    bool operator==(const SearchSums&) const = default;
};

/// What the host writes and reads directly.
struct HostRegisters {
    bool enabled = false;
    uint32_t irq_pending = 0, irq_enable = 0;
    uint32_t watchdog = 10'000'000; // cycles; 0: nobody watches
    uint64_t heartbeat = 0;         // cycle of the last one
    uint32_t high_word = 0;         // of the pair whose low word was read last
    SegmentWords segment{};

    bool operator==(const HostRegisters&) const = default;
};

/// An entry that was finished in the last cycle, for whoever looks on.
struct Retired {
    bool valid = false;
    Segment segment;
    Answer answer;
    uint64_t pushed = 0; // cycle

    bool operator==(const Retired&) const = default;
};

/// All that the device is at a cycle. A copy is a snapshot; put back, it goes on the same way.
struct CoprocessorState {
    uint64_t cycle = 0;
    uint32_t run = 0; // counts stops
    HostRegisters host;
    SegmentFifo fifo;
    PermitUnit permits;
    std::array<ModelSlot, model_slots> slots{};
    std::vector<SearchElement> elements;
    MemoryUnit memory;
    uint32_t searching = 0;   // threads that have a search
    uint8_t next_element = 0; // is asked first for an idle thread
    uint8_t next_request = 0; // may ask the memory first
    SearchSums searched;
    Retired retired;

    bool operator==(const CoprocessorState&) const = default;
};

/// The device as it is after power-up: nothing is permitted, no model is there.
CoprocessorState power_up(const DeviceConfig& config);

/// One rising clock edge.
void tick(CoprocessorState& state, const DeviceConfig& config);

/// A read or write on the register bus between two edges; `address` in bytes, see Register.
uint32_t read(CoprocessorState& state, const DeviceConfig& config, uint32_t address);
void write(CoprocessorState& state, const DeviceConfig& config, uint32_t address, uint32_t value);

/// Puts a line on its way into the memory; false if the queue is full or the address beyond it.
bool store(CoprocessorState& state, uint32_t address, const Line& line);

/// Stops the device, unless it is stopped: the reason is latched, and whatever waits or is under
/// way is dropped.
void halt(CoprocessorState& state, Stop reason, uint32_t sequence, uint32_t line = 0);

/// What the emulator and the functional model do alike: what is wrong with the models of a segment,
/// what is asked, a model for its slot, and what an answer to the first entry leads to.
Stop fault_of_models(const CoprocessorState& state, const Segment& segment);
Query query_of(const CoprocessorState& state, const Segment& segment);
void take_model(CoprocessorState& state, const Segment& segment);
void retire_with(CoprocessorState& state, const Answer& answer);

/// The interrupt line.
inline bool interrupt(const CoprocessorState& state) {
    return (state.host.irq_pending & state.host.irq_enable) != 0;
}

} // namespace hwsim
