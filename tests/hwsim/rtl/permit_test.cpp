// The permit unit of the circuit, held against the emulator's at every clock edge. All other units
// are the emulator's.

#include <random>

#include <gtest/gtest.h>

#include "PermitUnitCircuit.h"
#include "tests/hwsim/faulty_device.h"
#include "tests/hwsim/rtl/fields.h"

namespace hwsim::rtl {
namespace {

/// A device whose host does anything, also what is wrong, and the circuit beside it.
class PermitLockstep {
public:
    explicit PermitLockstep(uint32_t seed) : rng_(seed) {
        std::vector<Record> posts = row_of_posts();
        posts.resize(4); // so that searches are short
        for (const auto& lines :
             {device_.lines_of(Side::tool, {tool}), device_.lines_of(Side::work, posts)}) {
            for (const AddressedLine& line : lines) device_.image_of(line.address) = line.line;
            headers_.push_back(lines.back().address);
        }
        reset_circuit();
        order_models();
    }

    void step() {
        act();
        if (::testing::Test::HasFatalFailure()) return;
        edge();
    }

    std::array<int, stop_count> stops{};
    size_t permits = 0;

private:
    bool one_in(uint32_t n) { return rng_() % n == 0; }
    bool has_room() const { return device_.tail - device_.state.ring.head < 50; }

    /// One thing that a host, a memory, or chance may do.
    void act() {
        CoprocessorState& s = device_.state;
        circuit_.clear = 0;
        const bool is_stopped = s.permits.stopped != Stop::none;
        if (is_stopped != was_stopped_ && is_stopped)
            ++stops[static_cast<size_t>(s.permits.stopped)];
        was_stopped_ = is_stopped;
        if (one_in(is_stopped ? 40 : 5'000)) clear();
        if (one_in(8) && has_room()) order();
        if (one_in(30)) device_.write(Register::heartbeat, 1);
        if (one_in(20'000)) device_.write(Register::watchdog, 20);
        if (one_in(500)) device_.write(Register::watchdog, 100'000);
        for (bool* stalled : {&s.memory.stalled, &s.ring.stalled})
            if (one_in(*stalled ? 900 : 20'000)) *stalled = !*stalled;
        if (one_in(s.host.enabled ? 3'000 : 100))
            device_.write(Register::control, s.host.enabled ? 0U : uint32_t{control_enable});
        if (one_in(5'000))
            s.shared.lines[(device_.tail - rng_() % 3) % TestDevice::ring_size].word[rng_() % 16] ^=
                1U << rng_() % 32;
        if (one_in(10'000))
            s.memory.lines[rng_() % device_.space.next].word[rng_() % 16] ^= 1U << rng_() % 32;
        if (one_in(20'000)) {
            device_.reset();
            reset_circuit();
            sequence_ = 1;
            order_models();
        }
    }

    void clear() {
        // Orders that wait are skipped.
        device_.write(Register::control, control_clear | control_enable);
        circuit_.clear = 1;
        sequence_ = device_.read(Register::next_seq);
        if (has_room() && !one_in(8)) order_models();
    }

    /// Copies all lines again, and loads both models.
    void order_models() {
        device_.post_copy(0, device_.space.next);
        for (const uint8_t slot : {uint8_t{0}, uint8_t{1}}) {
            Segment model{.sequence = sequence_, .kind = SegmentKind::model, .work_slot = slot};
            model.last = false;
            model.work_epoch = one_in(50) ? 2 : 1;
            model.model_header = headers_[slot];
            device_.post(model);
        }
    }
    void order() {
        if (one_in(30)) return order_models();
        const size_t count = one_in(3) ? 1 + rng_() % 7 : 1;
        std::vector<Segment> list(count, along_the_row(sequence_));
        const SegmentKind kind = one_in(5) ? SegmentKind::measure : SegmentKind::permit;
        const bool is_last = kind == SegmentKind::permit && !one_in(6);
        for (Segment& s : list) {
            s.kind = kind;
            s.last = false;
            if (one_in(300)) s.work_slot = 7;
            if (one_in(300)) s.work_epoch = 2;
            if (one_in(40)) s.threshold = 4'000;
            if (kind == SegmentKind::measure && one_in(2)) s.threshold = 0;
            if (!one_in(6)) s.start = s.end = {0, 0, 800'000};
            s.is_timed = list[0].is_timed;
        }
        list[0].is_timed = !one_in(3);
        list[0].deadline = static_cast<uint32_t>(device_.state.cycle) + rng_() % 3'000;
        list.back().last = is_last;
        if (one_in(200)) list[0].sequence += rng_() % 3 - 1;
        if (one_in(400)) list[0].end[1] = greatest_coordinate + 1;
        device_.post(descriptor_of(list));
        if (is_last) ++sequence_;
    }

    void reset_circuit() {
        circuit_.reset = 1;
        clock(circuit_);
        circuit_.reset = 0;
    }

    void edge() {
        put_inputs();
        circuit_.clk = 0;
        circuit_.eval();
        const SearchElement& element = device_.state.elements[circuit_.first_element % 3];
        Fields answer;
        answer.put(element.threads[circuit_.first_thread % 2].answer);
        set(circuit_.answer, answer);
        clock(circuit_);
        const uint32_t permitted = device_.permitted();
        device_.clock();
        permits += device_.permitted() - permitted;
        expect_the_same();
    }

    void put_inputs() {
        const CoprocessorState& s = device_.state;
        const uint64_t next = s.cycle + 1;
        circuit_.enable = s.host.enabled;
        circuit_.cycle = next;
        circuit_.host_is_silent = s.host.watchdog != 0 && next - s.host.heartbeat > s.host.watchdog;
        circuit_.memory_is_stalled =
            is_stalled(s.memory, device_.config, next) || is_stalled(s.ring, device_.config, next);
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
        const CoprocessorState& s = device_.state;
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

    std::mt19937 rng_;
    TestDevice device_;
    PermitUnitCircuit circuit_;
    std::vector<uint32_t> headers_; // of the models of tool and work
    uint32_t sequence_ = 1;         // of the next segment, as far as the host knows
    bool was_stopped_ = false;
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
        for (size_t i = 0; i < stops.size(); ++i) stops[i] += both.stops[i];
    }
    EXPECT_GT(permits, 10'000U);
    for (const Stop stop : {Stop::violation, Stop::out_of_range, Stop::sequence,
                            Stop::model_missing, Stop::model_changed, Stop::bad_check,
                            Stop::memory_stalled, Stop::host_silent, Stop::bad_descriptor})
        EXPECT_GT(stops[static_cast<size_t>(stop)], 10) << name_of(stop);
}

} // namespace
} // namespace hwsim::rtl
