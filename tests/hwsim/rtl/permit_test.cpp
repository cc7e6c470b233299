// The permit unit of the circuit, held against the emulator's at every clock edge. All other units
// are the emulator's.

#include <gtest/gtest.h>

#include "PermitUnitCircuit.h"
#include "tests/hwsim/rtl/fields.h"
#include "tests/hwsim/rtl/random_host.h"

namespace hwsim::rtl {
namespace {

/// The device of a host that does anything, and the circuit beside it.
class PermitLockstep {
public:
    explicit PermitLockstep(uint32_t seed) : host_(seed) { reset_circuit(); }

    void step() {
        const auto write = host_.act();
        if (write && write->has(control_reset)) reset_circuit();
        circuit_.clear = write && !write->has(control_reset) && write->has(control_clear);
        edge();
    }

    const std::array<int, stop_count>& stops() const { return host_.stops; }
    size_t permits = 0;

private:
    void reset_circuit() {
        circuit_.reset = 1;
        clock(circuit_);
        circuit_.reset = 0;
    }

    void edge() {
        put_inputs();
        circuit_.clk = 0;
        circuit_.eval();
        const SearchElement& element = host_.device.state.elements[circuit_.first_element % 3];
        Fields answer;
        answer.put(element.threads[circuit_.first_thread % 2].answer);
        set(circuit_.answer, answer);
        clock(circuit_);
        const uint32_t permitted = host_.device.permitted();
        host_.device.clock();
        permits += host_.device.permitted() - permitted;
        expect_the_same();
    }

    void put_inputs() {
        const CoprocessorState& s = host_.device.state;
        const uint64_t next = s.cycle + 1;
        circuit_.enable = s.host.enabled;
        circuit_.cycle = next;
        circuit_.host_is_silent = s.host.watchdog != 0 && next - s.host.heartbeat > s.host.watchdog;
        circuit_.memory_is_stalled =
            is_stalled(s.memory, host_.device.config) || is_stalled(s.ring, host_.device.config);
        circuit_.lines_written = s.memory.writes_done;
        circuit_.entry_valid = s.ring.entry.valid;
        Fields entry;
        entry.put(s.ring.entry);
        set(circuit_.entry, entry);
        circuit_.fault_valid = s.ring.fault.valid;
        circuit_.fault = static_cast<uint8_t>(s.ring.fault.reason);
        circuit_.fault_has_sequence = s.ring.fault.sequence != 0;
        circuit_.fault_sequence = s.ring.fault.sequence;
        circuit_.fault_line = s.ring.fault.line;
        circuit_.done = 0;
        for (size_t i = 0; i < s.elements.size(); ++i)
            circuit_.done |= static_cast<uint8_t>(s.elements[i].done << 2 * i);
    }

    void expect_the_same() const {
        const CoprocessorState& s = host_.device.state;
        const PermitUnit& permits = s.permits;
        ASSERT_EQ(circuit_.permit_sequence, permits.permit_sequence) << s.cycle;
        ASSERT_EQ(circuit_.stop, static_cast<uint8_t>(permits.stopped)) << s.cycle;
        ASSERT_EQ(circuit_.stop_sequence, permits.stop_sequence) << s.cycle;
        ASSERT_EQ(circuit_.stop_line, permits.stop_line) << s.cycle;
        ASSERT_EQ(circuit_.retired, permits.retired) << s.cycle;
        ASSERT_EQ(circuit_.fifo_used, s.fifo.entries.size()) << s.cycle;
        ASSERT_EQ(circuit_.next_sequence, s.fifo.next_sequence) << s.cycle;
        ASSERT_EQ(circuit_.dispatched, permits.in_order.size()) << s.cycle;
        ASSERT_EQ(circuit_.flush != 0, s.flush) << s.cycle;
        ASSERT_EQ(circuit_.missed, permits.missed) << s.cycle;
        ASSERT_EQ(circuit_.longest, permits.longest) << s.cycle;
        ASSERT_EQ(circuit_.least_slack, static_cast<uint64_t>(permits.least_slack)) << s.cycle;
        uint32_t occupied = 0;
        for (size_t i = 0; i < s.occupied.size(); ++i) occupied |= s.occupied[i] << 2 * i;
        ASSERT_EQ(circuit_.occupied, occupied) << s.cycle;
        ASSERT_EQ(circuit_.start != 0, s.start.valid) << s.cycle;
        if (s.start.valid) {
            ASSERT_EQ(circuit_.start_element, s.start.element) << s.cycle;
            ASSERT_EQ(circuit_.start_thread, s.start.thread) << s.cycle;
            Fields query;
            query.put(s.start.query);
            ASSERT_TRUE(holds(circuit_.query, query)) << s.cycle;
        }
        ASSERT_EQ(circuit_.release_valid != 0, s.release.valid) << s.cycle;
        if (s.release.valid) {
            ASSERT_EQ(circuit_.release_element, s.release.element) << s.cycle;
            ASSERT_EQ(circuit_.release_thread, s.release.thread) << s.cycle;
        }
        ASSERT_EQ(circuit_.found_sequence, permits.found_sequence) << s.cycle;
        if (permits.found_sequence == 0) return; // nothing has been found since reset
        Fields found;
        found.put(permits.found);
        ASSERT_TRUE(holds(circuit_.found, found)) << s.cycle;
    }

    RandomHost host_;
    PermitUnitCircuit circuit_;
};

TEST(PermitCircuit, EqualsTheEmulatorWhateverTheHostDoes) {
    std::array<int, stop_count> stops{};
    size_t permits = 0;
    for (uint32_t seed = 0; seed < 20; ++seed) {
        PermitLockstep both(seed);
        for (int cycle = 0; cycle < 200'000; ++cycle) {
            both.step();
            if (HasFatalFailure()) return;
        }
        permits += both.permits;
        for (size_t i = 0; i < stops.size(); ++i) stops[i] += both.stops()[i];
    }
    EXPECT_GT(permits, 10'000U);
    for (const Stop stop : {Stop::violation, Stop::out_of_range, Stop::sequence,
                            Stop::model_missing, Stop::model_changed, Stop::bad_check,
                            Stop::memory_stalled, Stop::host_silent, Stop::bad_descriptor})
        EXPECT_GT(stops[static_cast<size_t>(stop)], 10) << name_of(stop);
}

} // namespace
} // namespace hwsim::rtl
