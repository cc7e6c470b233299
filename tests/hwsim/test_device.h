#pragma once

#include <gtest/gtest.h>

#include "hwsim/coprocessor.h"
#include "hwsim/search.h"
#include "tests/hwsim/companion.h"
#include "tests/hwsim/random_models.h"

namespace hwsim {

/// A small device, so that caches, queues and threads are short of everything.
inline DeviceConfig small_config() {
    return {.elements = 3,
            .threads = 2,
            .node_cache_lines = 8,
            .record_cache_lines = 4,
            .fifo_depth = 8,
            .memory_lines = 4096,
            .memory_latency = 11,
            .memory_queue = 4,
            .write_queue = 4,
            .host_latency = 7,
            .host_cycles_per_line = 2,
            .host_queue = 3,
            .memory_limit = 1000};
}

/// A device on a test bench: registers, the memory of the host, and the clock. A write takes a
/// cycle.
struct TestDevice {
    static constexpr uint32_t log2_ring_size = 6, ring_size = 1U << log2_ring_size;

    DeviceConfig config = small_config();
    CoprocessorState state;
    MaybeCompanion companion;
    LineSpace space;
    std::vector<Retired> retired; // all that was
    uint32_t tail = 0;            // of the ring

    explicit TestDevice(const DeviceConfig& with = small_config())
        : config(checked(with).value()),
          state(power_up(config)),
          companion(config),
          space{.end = with.memory_lines} {
        open();
    }
    void open() {
        constexpr uint64_t base = HostMemory::address_of(0);
        write(Register::ring_base_low, static_cast<uint32_t>(base));
        write(Register::ring_base_high, static_cast<uint32_t>(base >> 32));
        write(Register::ring_log2_size, log2_ring_size);
        // The ring, and behind it what is copied to each line of the memory.
        state.shared.lines.resize(ring_size + config.memory_lines);
        tail = 0;
        write(Register::control, control_enable);
    }
    void reset() {
        write(Register::control, control_reset);
        open();
    }

    uint32_t read(Register r) {
        const uint32_t value = hwsim::read(state, config, address_of(r));
        // A high word comes in the cycle after the low one.
        if (r != Register::found_high) companion.expect(address_of(r), value);
        return value;
    }
    uint64_t read(Counter c) {
        const uint32_t low = hwsim::read(state, config, address_of(c));
        companion.expect(address_of(c), low);
        return low | uint64_t{hwsim::read(state, config, address_of(c) + 4)} << 32;
    }
    void write(Register r, uint32_t value) {
        hwsim::write(state, config, address_of(r), value);
        companion.write(address_of(r), value);
        clock();
    }
    Stop reason() { return static_cast<Stop>(read(Register::stop)); }
    uint32_t permitted() { return read(Register::permit_seq); }
    bool has_status(StatusBit bit) { return (read(Register::status) & bit) != 0; }

    void clock(uint64_t cycles = 1) {
        for (; cycles > 0; --cycles) {
            tick(state, config);
            companion.clock(state);
            if (state.retired.valid) retired.push_back(state.retired);
        }
    }
    /// Until the device is idle or has stopped; false if it never is.
    bool finish(uint64_t most = 3'000'000) {
        for (; most > 0; --most) {
            if (has_status(status_idle)) return true;
            clock();
        }
        return false;
    }

    /// Writes lines to the ring.
    void put(std::vector<Line> lines) {
        for (Line& line : lines) {
            seal(line, tail);
            state.shared.lines[tail++ % ring_size] = line;
        }
    }
    /// Writes lines to the ring, and rings the doorbell.
    void post(std::vector<Line> lines) {
        put(std::move(lines));
        write(Register::ring_tail, tail);
    }
    void post(const Segment& entry) { post(descriptor_of({&entry, 1})); }
    /// Until all that was posted is carried out, or the device is stopped.
    void wait_for_ring() {
        for (int patience = 1'000'000; patience > 0 && !is_idle(state.ring); --patience) {
            if (has_status(status_stopped)) return;
            clock();
        }
    }
    void push(std::span<const Segment> entries) {
        post(descriptor_of(entries));
        wait_for_ring();
    }
    void push(const Segment& entry) { push({&entry, 1}); }

    /// What is copied to a line of the memory.
    Line& image_of(uint32_t line) { return state.shared.lines[ring_size + line]; }
    Line copy_of(uint32_t line, uint32_t count) const {
        return descriptor_of(LineCopy{HostMemory::address_of(ring_size + line), line, count});
    }
    void post_copy(uint32_t line, uint32_t count) { post({copy_of(line, count)}); }
    void store(const std::vector<AddressedLine>& lines) {
        for (const AddressedLine& line : lines) {
            image_of(line.address) = line.line;
            post_copy(line.address, 1);
            wait_for_ring();
        }
    }

    /// The lines of a model, the last of which is its header.
    std::vector<AddressedLine> lines_of(Side side, const std::vector<Record>& records,
                                        uint32_t leaf_size = 8, uint32_t epoch = 1) {
        ModelWriter writer{.space = &space, .side = side, .epoch = epoch};
        Branch root;
        if (!records.empty()) root = add_tree(writer, records, leaf_size).value();
        EXPECT_TRUE(add_header(writer, root));
        return writer.lines;
    }
    /// Brings a model into the memory, and returns its header.
    uint32_t load(Side side, const std::vector<Record>& records, uint32_t leaf_size = 8,
                  uint32_t epoch = 1) {
        const std::vector<AddressedLine> lines = lines_of(side, records, leaf_size, epoch);
        store(lines);
        return lines.back().address;
    }
    /// Puts a model into a slot, after the lines that were stored before.
    void set_model(uint8_t slot, uint32_t header, uint32_t epoch = 1) {
        push({.sequence = read(Register::next_seq),
              .kind = SegmentKind::model,
              .work_slot = slot,
              .last = false,
              .work_epoch = epoch,
              .model_header = header});
    }
    void set_models(const std::vector<Record>& tools, const std::vector<Record>& works) {
        set_model(0, load(Side::tool, tools));
        set_model(1, load(Side::work, works));
    }
};

/// A question to the models in slots 0 and 1.
inline Segment question(uint32_t sequence, Segment way, uint32_t threshold,
                        SegmentKind kind = SegmentKind::permit) {
    way.sequence = sequence;
    way.kind = kind;
    way.last = kind == SegmentKind::permit;
    way.tool_slot = 0;
    way.work_slot = 1;
    way.threshold = threshold;
    way.work_epoch = 1;
    return way;
}

} // namespace hwsim
