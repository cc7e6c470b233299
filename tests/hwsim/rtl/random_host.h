#pragma once

#include <deque>
#include <optional>
#include <random>

#include "tests/hwsim/faulty_device.h"

namespace hwsim::rtl {

/// A device whose host does anything, also what is wrong, and whose memories fail.
class RandomHost {
public:
    struct Write {
        Register which;
        uint32_t value;

        bool has(ControlBit bit) const { return which == Register::control && (value & bit) != 0; }
    };

    TestDevice device;
    std::array<int, stop_count> stops{};

    explicit RandomHost(uint32_t seed) : device(config_for(seed)), rng_(seed) {
        std::vector<Record> posts = row_of_posts();
        posts.resize(4); // so that searches are short
        for (const auto& lines :
             {device.lines_of(Side::tool, {tool}), device.lines_of(Side::work, posts)}) {
            for (const AddressedLine& line : lines) device.image_of(line.address) = line.line;
            headers_.push_back(lines.back().address);
        }
        hwsim::write(device.state, device.config, address_of(Register::control), control_reset);
        begin_anew();
    }

    /// What happens before the next edge; at most one write on the bus, which the device has got.
    std::optional<Write> act() {
        CoprocessorState& s = device.state;
        const bool is_stopped = s.permits.stopped != Stop::none;
        if (is_stopped != was_stopped_ && is_stopped)
            ++stops[static_cast<size_t>(s.permits.stopped)];
        was_stopped_ = is_stopped;
        fail();
        if (bus_.empty()) use_bus(is_stopped);
        if (bus_.empty()) return {};
        const Write write = bus_.front();
        bus_.pop_front();
        hwsim::write(device.state, device.config, address_of(write.which), write.value);
        if (write.has(control_reset)) begin_anew();
        if (write.has(control_clear)) go_on();
        return write;
    }

private:
    /// With every other one, copies can take longer than the memory may do nothing.
    static DeviceConfig config_for(uint32_t seed) {
        DeviceConfig config = small_config();
        if (seed % 2 == 1) {
            config.cycles_per_line = 4;
            config.memory_limit = 150;
        }
        return config;
    }

    uint32_t below(uint32_t n) { return static_cast<uint32_t>(rng_() % n); }
    bool one_in(uint32_t n) { return below(n) == 0; }
    bool has_room() const { return device.tail - device.state.ring.head < 50; }

    void fail() {
        CoprocessorState& s = device.state;
        const auto stall = [&](bool& stalled, uint32_t& cycles) {
            if (!stalled && one_in(1'000)) cycles = one_in(15) ? below(3'000) : 1 + below(60);
            stalled = cycles > 0;
            if (stalled) --cycles;
        };
        stall(s.memory.stalled, memory_stall_);
        stall(s.ring.stalled, host_stall_);
        if (one_in(5'000))
            s.shared.lines[(device.tail - rng_() % 3) % TestDevice::ring_size].word[rng_() % 16] ^=
                1U << rng_() % 32;
        if (one_in(10'000))
            s.memory.lines[rng_() % device.space.next].word[rng_() % 16] ^= 1U << rng_() % 32;
    }

    void use_bus(bool is_stopped) {
        const bool is_enabled = device.state.host.enabled;
        if (one_in(is_stopped ? 40 : 5'000))
            bus_.push_back({Register::control, control_clear | control_enable});
        if (one_in(8) && has_room()) order();
        if (one_in(30)) bus_.push_back({Register::heartbeat, 1});
        if (one_in(20'000)) bus_.push_back({Register::watchdog, 20});
        if (one_in(500)) bus_.push_back({Register::watchdog, 100'000});
        if (one_in(is_enabled ? 3'000 : 100))
            bus_.push_back({Register::control, is_enabled ? 0U : uint32_t{control_enable}});
        if (one_in(300)) bus_.push_back({Register::irq_pending, below(8)});
        if (one_in(3'000)) bus_.push_back({Register::irq_enable, below(8)});
        if (one_in(3'000)) bus_.push_back({Register::ring_log2_size, below(40)}); // is ignored
        if (one_in(3'000)) bus_.push_back({Register::ring_tail, device.tail + below(100)});
        if (one_in(20'000)) bus_.push_back({Register::control, control_reset});
    }

    void begin_anew() {
        constexpr uint64_t base = HostMemory::address_of(0);
        bus_ = {{Register::ring_base_low, static_cast<uint32_t>(base)},
                {Register::ring_base_high, static_cast<uint32_t>(base >> 32)},
                {Register::ring_log2_size, TestDevice::log2_ring_size},
                {Register::control, control_enable}};
        device.tail = 0;
        sequence_ = 1;
        order_models();
    }

    /// After a stop. Orders that wait are skipped.
    void go_on() {
        device.tail = device.state.ring.tail;
        sequence_ = device.state.fifo.next_sequence;
        if (has_room() && !one_in(8)) order_models();
    }

    void post(std::vector<Line> lines) {
        device.put(std::move(lines));
        bus_.push_back({Register::ring_tail, device.tail});
    }

    /// Copies all lines again, and loads both models.
    void order_models() {
        const uint32_t more = one_in(3) ? below(300) : 0;
        Line copy = device.copy_of(0, device.space.next + more);
        if (one_in(50)) copy.word[2] = 1U << rng_() % 32;  // lines that are not there
        if (one_in(50)) copy.word[4] += 1U << rng_() % 32; // from where no memory is
        if (one_in(100)) copy.word[rng_() % 5] ^= 1U << rng_() % 32;
        post({copy});
        for (const uint8_t slot : {uint8_t{0}, uint8_t{1}}) {
            Segment model{.sequence = sequence_, .kind = SegmentKind::model, .work_slot = slot};
            model.last = one_in(100);
            model.work_epoch = one_in(50) ? 2 : 1;
            model.model_header = one_in(100) ? below(1U << 31) : headers_[slot];
            post(descriptor_of({&model, 1}));
        }
    }

    void order() {
        if (one_in(30)) return order_models();
        const size_t count = one_in(3) ? 1 + rng_() % 13 : 1;
        std::vector<Segment> list(count, along_the_row(sequence_));
        const SegmentKind kind = one_in(5) ? SegmentKind::measure : SegmentKind::permit;
        const bool is_last = kind == SegmentKind::permit && !one_in(6);
        for (Segment& s : list) {
            s.kind = kind;
            s.last = false;
            if (one_in(300)) s.work_slot = 7;
            if (one_in(300)) s.work_epoch = 2;
            if (one_in(40)) s.threshold = 4'000;
            if (one_in(400)) s.threshold = 1U << rng_() % 32;
            if (kind == SegmentKind::measure && one_in(2)) s.threshold = 0;
            if (!one_in(6)) s.start = s.end = {0, 0, 800'000};
            s.is_timed = list[0].is_timed;
        }
        list[0].is_timed = !one_in(3);
        list[0].deadline = static_cast<uint32_t>(device.state.cycle) + rng_() % 3'000;
        list.back().last = is_last;
        if (one_in(200)) list[0].sequence += rng_() % 3 - 1;
        if (one_in(400)) list[0].end[1] = greatest_coordinate + 1;
        std::vector<Line> lines = descriptor_of(list);
        if (one_in(200)) lines[0].word[0] ^= 1U << rng_() % 32;
        post(std::move(lines));
        if (is_last) ++sequence_;
    }

    std::mt19937 rng_;
    std::deque<Write> bus_;         // still to be written
    std::vector<uint32_t> headers_; // of the models of tool and work
    uint32_t sequence_ = 1;         // of the next segment, as far as the host knows
    bool was_stopped_ = false;
    uint32_t memory_stall_ = 0, host_stall_ = 0; // cycles
};

} // namespace hwsim::rtl
