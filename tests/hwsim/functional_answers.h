#pragma once

#include <gtest/gtest.h>

#include "tests/hwsim/test_device.h"

namespace hwsim {

inline std::vector<Record> cloud(std::mt19937& rng, uint32_t count, int32_t reach) {
    std::vector<Record> records;
    for (uint32_t i = 0; i < count; ++i) records.push_back(random_record(rng, reach));
    return records;
}

inline Segment random_way(std::mt19937& rng, int32_t reach) {
    return random_segment(rng, reach, static_cast<uint8_t>(rng() % 7));
}

/// What the functional model says to a segment, the memory being as it is.
inline Answer expected(const TestDevice& device, const Segment& segment) {
    const ModelSlot& tool = device.state.slots[segment.tool_slot];
    const ModelSlot& work = device.state.slots[segment.work_slot];
    return search(device.state.memory.lines,
                  {segment, tool.header, work.header, tool.epoch, work.epoch, limit_of(segment)},
                  device.config.stack_depth);
}

/// Asks many segments of some devices, and compares each answer with the functional model's: the
/// squared distance, the witness, and all counts.
inline void expect_the_functional_answers(uint32_t seed, const DeviceConfig& config, int32_t reach,
                                          int rounds) {
    std::mt19937 rng(seed);
    for (int round = 0; round < rounds; ++round) {
        TestDevice device(config);
        device.set_models(cloud(rng, 1 + rng() % 60, reach), cloud(rng, rng() % 120, reach));
        const bool measures = round % 2 == 0;
        for (int i = 0; i < 40; ++i) {
            const SegmentKind kind = measures ? SegmentKind::measure : SegmentKind::permit;
            device.push(question(measures ? 1 : device.read(Register::next_seq),
                                 random_way(rng, 2 * reach), rng() % 20, kind));
            device.clock(rng() % 50);
            if (device.has_status(status_stopped)) break;
        }
        ASSERT_TRUE(device.finish());
        ASSERT_GT(device.retired.size(), 2U);
        // A companion has the same.
        for (const Register r :
             {Register::permit_seq, Register::stop_seq, Register::found_low, Register::found_tool,
              Register::found_work, Register::found_sample, Register::found_seq})
            device.read(r);
        for (uint32_t i = 0; i < counter_count; ++i) device.read(static_cast<Counter>(i));
        for (const Retired& r : device.retired)
            if (r.segment.kind != SegmentKind::model) {
                ASSERT_EQ(r.answer, expected(device, r.segment));
            }
    }
}

} // namespace hwsim
