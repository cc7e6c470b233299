#pragma once

#include "hwsim/coprocessor.h"
#include "hwsim/search.h"
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
            .memory_limit = 1000};
}

/// A device on a test bench: registers and memory, and the clock.
struct TestDevice {
    DeviceConfig config = small_config();
    CoprocessorState state;
    LineSpace space;
    std::vector<Retired> retired; // all that was

    explicit TestDevice(const DeviceConfig& with = small_config())
        : config(checked(with).value()), state(power_up(config)), space{.end = with.memory_lines} {
        write(Register::control, control_enable);
    }

    uint32_t read(Register r) { return hwsim::read(state, config, address_of(r)); }
    uint64_t read(Counter c) {
        const uint64_t low = hwsim::read(state, config, address_of(c));
        return low | uint64_t{hwsim::read(state, config, address_of(c) + 4)} << 32;
    }
    void write(Register r, uint32_t value) { hwsim::write(state, config, address_of(r), value); }
    Stop reason() { return static_cast<Stop>(read(Register::stop)); }
    uint32_t permitted() { return read(Register::permit_seq); }
    bool has_status(StatusBit bit) { return (read(Register::status) & bit) != 0; }

    void clock(uint64_t cycles = 1) {
        for (; cycles > 0; --cycles) {
            tick(state, config);
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

    void push(const Segment& segment) {
        const SegmentWords words = words_of(segment);
        for (uint32_t i = 0; i < segment_words; ++i)
            hwsim::write(state, config, address_of(Register::segment) + 4 * i, words[i]);
        write(Register::segment_push, 0);
    }
    /// The same when there is room for it.
    void push_in_time(const Segment& segment) {
        while (has_status(status_fifo_full)) clock();
        push(segment);
    }

    void store(const std::vector<AddressedLine>& lines) {
        for (const AddressedLine& line : lines)
            while (!hwsim::store(state, line.address, line.line)) clock();
    }

    /// Brings a model into the memory, and returns its header.
    uint32_t load(Side side, const std::vector<Record>& records, uint32_t leaf_size = 8,
                  uint32_t epoch = 1) {
        ModelWriter writer{.space = &space, .side = side, .epoch = epoch};
        Branch root;
        if (!records.empty()) root = add_tree(writer, records, leaf_size).value();
        const uint32_t header = add_header(writer, root).value();
        store(writer.lines);
        return header;
    }
    /// Puts a model into a slot, by the FIFO.
    void set_model(uint8_t slot, uint32_t header, uint32_t epoch = 1) {
        push_in_time({.sequence = read(Register::next_seq),
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
