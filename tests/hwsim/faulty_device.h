#pragma once

#include <gtest/gtest.h>

#include "tests/hwsim/test_device.h"

namespace hwsim {

inline const Record tool{{0, 0, 0}, 100, 50};
inline const Record far_away{{5'000, 0, 0}, 0, 0};

/// Posts in a slanted row, beside which boxes tell little: a search has something to read.
inline std::vector<Record> row_of_posts() {
    std::vector<Record> posts;
    for (int32_t i = 0; i < 64; ++i) posts.push_back({{i * 100, 3'000 + i * 60, 0}, 500, 40});
    return posts;
}

/// Keeps some 2450 from the row.
inline Segment along_the_row(uint32_t sequence) {
    return question(sequence, {.log2_steps = 6, .start = {0, 0, 0}, .end = {6'300, 3'780, 0}},
                    2'300);
}

/// A device with models, of which the first segment has been permitted.
inline TestDevice working_device(const DeviceConfig& config = small_config()) {
    TestDevice device(config);
    device.set_models({tool}, row_of_posts());
    device.push(along_the_row(1));
    EXPECT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 1U);
    EXPECT_EQ(device.reason(), Stop::none);
    return device;
}

/// The device has stopped for this reason at this segment, and does nothing whatever comes.
inline void expect_stopped(TestDevice& device, Stop reason, uint32_t permitted = 1) {
    EXPECT_TRUE(device.has_status(status_stopped));
    EXPECT_EQ(device.reason(), reason);
    EXPECT_EQ(device.permitted(), permitted);
    EXPECT_EQ(device.read(Register::stop_seq), permitted + 1);
    EXPECT_NE(device.read(Register::irq_pending) & irq_stop, 0U);
    device.push(along_the_row(permitted + 1));
    device.clock(3'000);
    EXPECT_EQ(device.permitted(), permitted);
    EXPECT_EQ(device.reason(), reason);
}

/// Once its reason is cleared the device takes its models anew and goes on behind its last permit.
inline void expect_recovers(TestDevice& device) {
    const uint32_t permitted = device.permitted();
    device.write(Register::control, control_clear | control_enable);
    EXPECT_EQ(device.reason(), Stop::none);
    EXPECT_FALSE(device.has_status(status_stopped));
    for (const ModelSlot& slot : device.state.slots) EXPECT_FALSE(slot.valid);
    device.clock(3'000);
    EXPECT_EQ(device.permitted(), permitted);
    EXPECT_EQ(device.read(Register::next_seq), permitted + 1);
    device.set_models({tool}, row_of_posts());
    device.push(along_the_row(permitted + 1));
    EXPECT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), permitted + 1);
    EXPECT_EQ(device.reason(), Stop::none);
}

} // namespace hwsim
