#include "tests/hwsim/faulty_device.h"

namespace hwsim {
namespace {

TEST(MemoryFault, AMemoryThatDoesNotAnswerStopsTheDevice) {
    for (const uint32_t delay : {0U, 1U, 20U, 50U}) {
        TestDevice device;
        device.set_models({tool}, row_of_posts());
        device.clock(200);
        for (uint32_t k = 1; k < 5; ++k) device.push(along_the_row(k));
        device.clock(delay);
        device.state.memory.stalled = true;
        device.clock(900);
        EXPECT_EQ(device.reason(), Stop::none);
        device.clock(300);
        expect_stopped(device, Stop::memory_stalled, 0);
        device.state.memory.stalled = false;
        // Whether the old requests are answered by now, or still to come.
        device.clock(delay == 1 ? 0 : 100);
        expect_recovers(device);
    }
}

TEST(MemoryFault, AMemoryThatTakesNoLinesStopsTheDevice) {
    TestDevice device = working_device();
    device.clock(5'000);
    device.state.memory.stalled = true;
    device.post_copy(4'000, 1);
    device.clock(1'000);
    EXPECT_EQ(device.reason(), Stop::none);
    device.clock(25);
    expect_stopped(device, Stop::memory_stalled);
    device.state.memory.stalled = false;
    expect_recovers(device);
}

TEST(MemoryFault, ALineThatWaitsForReadsIsNoStall) {
    DeviceConfig config = small_config();
    config.memory_limit = 400;
    config.cycles_per_line = 40;
    TestDevice device(config);
    device.companion.leave();
    device.post_copy(4'000, 1);
    for (int cycle = 0; cycle < 2'000; ++cycle) {
        if (accepts(device.state.memory))
            device.state.memory.asked.push({.valid = true, .run = 99});
        device.clock();
    }
    EXPECT_FALSE(device.state.memory.writes.empty());
    EXPECT_EQ(device.reason(), Stop::none);
    device.clock(500);
    EXPECT_TRUE(device.state.memory.writes.empty());
    EXPECT_EQ(device.reason(), Stop::none);
}

TEST(DeviceMemory, IsZeroAndAlignedWhereOthersWroteBefore) {
    for (int round = 0; round < 20; ++round)
        for (const size_t count : {size_t{1}, size_t{16}, size_t{4096}}) {
            DeviceMemory memory(count);
            ASSERT_EQ(reinterpret_cast<uintptr_t>(memory.data()) % alignof(Line), 0U);
            for (Line& line : memory) {
                ASSERT_EQ(line, Line());
                line.word.fill(0xffffffff);
            }
        }
}

} // namespace
} // namespace hwsim
