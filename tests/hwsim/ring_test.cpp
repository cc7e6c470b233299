#include "tests/hwsim/faulty_device.h"

namespace hwsim {
namespace {

const Segment example{.sequence = 0xFFFF'FFFFU,
                      .kind = SegmentKind::measure,
                      .tool_slot = 31,
                      .work_slot = 30,
                      .log2_steps = 12,
                      .last = false,
                      .start = {least_coordinate, 0, -1},
                      .end = {greatest_coordinate, 5, 1},
                      .threshold = static_cast<uint32_t>(greatest_coordinate),
                      .work_epoch = 77,
                      .is_timed = true,
                      .deadline = 0xFFFF'FFFFU};

Segment pair_of(uint32_t i) {
    Segment s = example;
    s.tool_slot = static_cast<uint8_t>(i % 32);
    s.work_slot = static_cast<uint8_t>(i * 7 % 32);
    s.threshold = i * 1'000;
    s.work_epoch = 0xFFFF'FF00U + i;
    return s;
}

/// All entries of a descriptor, taken as the device takes them.
std::vector<Segment> entries_in(const std::vector<Line>& lines) {
    RingUnit unit = ring_unit({});
    std::vector<Segment> entries;
    for (const Line& line : lines) {
        EXPECT_TRUE(needs_line(unit));
        take_line(unit, {.valid = true, .is_intact = true, .line = line}, {});
        while (has_entry(unit)) entries.push_back(take_entry(unit, 0).segment);
    }
    EXPECT_FALSE(unit.fault.valid);
    EXPECT_TRUE(needs_line(unit));
    EXPECT_EQ(unit.current.pairs, 0U);
    return entries;
}

TEST(Descriptor, GivesBackThePairsThatWerePutIn) {
    for (const uint32_t count : {1U, 2U, 3U, 7U, 8U, 12U, 13U, 255U})
        for (const bool is_last : {false, true}) {
            std::vector<Segment> pairs;
            for (uint32_t i = 0; i < count; ++i) pairs.push_back(pair_of(i));
            for (Segment& s : pairs) s.kind = is_last ? SegmentKind::permit : s.kind;
            pairs.back().last = is_last;
            const std::vector<Line> lines = descriptor_of(pairs);
            EXPECT_EQ(lines.size(), count <= 2 ? 1 : 1 + (count - 2 + 4) / 5);
            EXPECT_EQ(entries_in(lines), pairs) << count;
        }
}

TEST(Descriptor, GivesBackAModelAndACopy) {
    const Segment model{.sequence = 9,
                        .kind = SegmentKind::model,
                        .work_slot = 31,
                        .last = false,
                        .work_epoch = 0xFFFF'FFFFU,
                        .model_header = 1234};
    EXPECT_EQ(entries_in(descriptor_of({&model, 1})), std::vector<Segment>{model});
    const LineCopy copy{0xFFFF'1234'5678'9A40U, 17, 1000};
    EXPECT_EQ(descriptor_in(descriptor_of(copy), {}).descriptor.copy, copy);
    EXPECT_EQ(descriptor_in(descriptor_of(copy), {}).fault, Stop::none);
}

TEST(Descriptor, IsOutOfRangeWhereAWordDoesNotFit) {
    const Line good = descriptor_of({&example, 1})[0];
    ASSERT_EQ(descriptor_in(good, {}).fault, Stop::none);
    for (size_t word = 2; word < 8; ++word)
        for (const int32_t value : {least_coordinate - 1, greatest_coordinate + 1}) {
            Line line = good;
            line.word[word] = static_cast<uint32_t>(value);
            EXPECT_EQ(descriptor_in(line, {}).fault, Stop::out_of_range) << word;
        }
    Line steps = good;
    steps.word[0] += 1U << 8;
    EXPECT_EQ(descriptor_in(steps, {}).fault, Stop::out_of_range);
    Line last_measurement = good;
    last_measurement.word[0] |= 1U << 31;
    EXPECT_EQ(descriptor_in(last_measurement, {}).fault, Stop::out_of_range);
}

TEST(Descriptor, OrdersNothingWhereItIsNone) {
    Line line;
    EXPECT_EQ(descriptor_in(line, {}).fault, Stop::bad_descriptor);
    line.word[0] = 5;
    EXPECT_EQ(descriptor_in(line, {}).fault, Stop::bad_descriptor);
    line = descriptor_of({&example, 1})[0];
    line.word[0] &= ~(0xFFU << 16); // no pairs
    EXPECT_EQ(descriptor_in(line, {}).fault, Stop::bad_descriptor);
    EXPECT_EQ(descriptor_in(descriptor_of(LineCopy{32, 0, 1}), {}).fault, Stop::bad_descriptor);
}

TEST(Descriptor, CopiesNothingBeyondTheMemory) {
    const DeviceConfig config{.memory_lines = 100};
    const auto fault = [&](uint32_t line, uint32_t count) {
        return descriptor_in(descriptor_of(LineCopy{0, line, count}), config).fault;
    };
    EXPECT_EQ(fault(0, 100), Stop::none);
    EXPECT_EQ(fault(99, 1), Stop::none);
    EXPECT_EQ(fault(0, 101), Stop::bad_address);
    EXPECT_EQ(fault(100, 0), Stop::bad_address);
    EXPECT_EQ(fault(1, 0xFFFF'FFFFU), Stop::bad_address);
}

/// Pairs with posts of which one comes nearer to the tool than it may.
TEST(Ring, PermitsAPathOnlyIfEveryPairOfItsListKeepsItsDistance) {
    constexpr uint32_t pairs = 13;
    for (uint32_t close = 0; close <= pairs; ++close) {
        TestDevice device;
        device.set_model(0, device.load(Side::tool, {{{0, 0, 0}, 0, 0}}));
        device.set_model(1, device.load(Side::work, {{{1'000, 0, 0}, 0, 0}}));
        std::vector<Segment> list(pairs, question(1, {}, 900));
        for (Segment& s : list) s.last = false;
        list.back().last = true;
        if (close < pairs) list[close].threshold = 1'100;
        device.push(list);
        ASSERT_TRUE(device.finish());
        EXPECT_EQ(device.permitted(), close < pairs ? 0U : 1U);
        EXPECT_EQ(device.reason(), close < pairs ? Stop::violation : Stop::none);
    }
}

TEST(Ring, AWrongBitInADescriptorPermitsNothing) {
    for (uint32_t bit = 0; bit < 512; ++bit) {
        TestDevice device = working_device();
        const Segment second = along_the_row(2);
        Line line = descriptor_of({&second, 1})[0];
        seal(line, device.tail);
        line.word[bit / 32] ^= 1U << (bit % 32);
        device.state.shared.lines[device.tail++ % TestDevice::ring_size] = line;
        device.write(Register::ring_tail, device.tail);
        device.finish();
        ASSERT_EQ(device.read(Register::stop_line), device.tail - 1);
        expect_stopped(device, Stop::bad_descriptor);
        if (bit % 50 == 0) expect_recovers(device);
    }
}

TEST(Ring, AWrongBitInALineOfPairsPermitsNothing) {
    for (uint32_t bit = 0; bit < 512; bit += 3) {
        TestDevice device = working_device();
        std::vector<Segment> list(5, along_the_row(2));
        for (Segment& s : list) s.last = false;
        list.back().last = true;
        std::vector<Line> lines = descriptor_of(list);
        ASSERT_EQ(lines.size(), 2U);
        for (Line& line : lines) {
            seal(line, device.tail);
            device.state.shared.lines[device.tail++ % TestDevice::ring_size] = line;
        }
        device.state.shared.lines[(device.tail - 1) % TestDevice::ring_size].word[bit / 32] ^=
            1U << (bit % 32);
        device.write(Register::ring_tail, device.tail);
        device.finish();
        expect_stopped(device, Stop::bad_descriptor);
    }
}

/// A doorbell before the lines are there: the device finds those of an earlier round.
TEST(Ring, ALineOfAnEarlierRoundOrdersNothing) {
    TestDevice device = working_device();
    uint32_t sequence = 2;
    while (device.tail < TestDevice::ring_size) {
        device.push(along_the_row(sequence++));
        ASSERT_EQ(device.reason(), Stop::none);
    }
    ASSERT_TRUE(device.finish());
    ASSERT_EQ(device.permitted(), sequence - 1);
    // Of a path that would be permitted.
    device.push(question(sequence, {.start = {0, 0, 900'000}, .end = {0, 0, 900'000}}, 1));
    ASSERT_TRUE(device.finish());
    device.write(Register::ring_tail, ++device.tail);
    device.finish();
    expect_stopped(device, Stop::bad_descriptor, sequence);
    expect_recovers(device);
}

TEST(Ring, AModelWaitsForAllCopiesBeforeIt) {
    DeviceConfig config = small_config();
    config.cycles_per_line = 50;
    TestDevice device(config);
    const std::vector<AddressedLine> lines = device.lines_of(Side::work, row_of_posts(), 4);
    const uint32_t header = lines.back().address;
    for (const AddressedLine& line : lines) device.image_of(line.address) = line.line;
    device.set_model(0, device.load(Side::tool, {tool}));
    ASSERT_TRUE(device.finish());
    const uint64_t before = device.read(Counter::lines_written);
    device.post_copy(0, header + 1);
    device.set_model(1, header);
    device.push(along_the_row(1));
    EXPECT_LT(device.read(Counter::lines_written), before + header);
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 1U);
    EXPECT_EQ(device.read(Counter::lines_written), before + header + 1);
}

TEST(Ring, ACopyFromBeyondTheHostsMemoryStopsTheDevice) {
    TestDevice device = working_device();
    device.post({descriptor_of(
        LineCopy{HostMemory::address_of(device.state.shared.lines.size() - 1), 4'000, 3})});
    device.clock(100);
    EXPECT_EQ(device.read(Register::stop_line), 4'001U);
    expect_stopped(device, Stop::bad_address);
    expect_recovers(device);
}

TEST(Ring, ARingThatIsNotThereStopsTheDevice) {
    TestDevice device = working_device();
    device.write(Register::control, 0);
    device.write(Register::ring_base_high, 0);
    device.write(Register::control, control_enable);
    device.push(along_the_row(2));
    expect_stopped(device, Stop::bad_address);
}

TEST(Ring, StaysWhereItIsWhileTheDeviceIsEnabled) {
    TestDevice device = working_device();
    const uint32_t low = device.read(Register::ring_base_low);
    device.write(Register::ring_base_low, low + 64);
    device.write(Register::ring_base_high, 3);
    device.write(Register::ring_log2_size, 3);
    EXPECT_EQ(device.read(Register::ring_base_low), low);
    EXPECT_EQ(device.read(Register::ring_base_high), HostMemory::base >> 32);
    EXPECT_EQ(device.read(Register::ring_log2_size), TestDevice::log2_ring_size);
    device.write(Register::control, 0);
    device.write(Register::ring_base_low, low + 64 + 63);
    EXPECT_EQ(device.read(Register::ring_base_low), low + 64);
    device.write(Register::ring_log2_size, 40);
    EXPECT_EQ(device.read(Register::ring_log2_size), most_log2_ring_size);
}

TEST(Ring, AHostThatDoesNotAnswerStopsTheDevice) {
    for (const bool of_copy : {false, true}) {
        TestDevice device = working_device();
        device.state.ring.stalled = true;
        if (of_copy) {
            device.state.ring.stalled = false;
            device.post_copy(3'000, 200);
            device.clock(30);
            device.state.ring.stalled = true;
        } else {
            device.post(along_the_row(2));
        }
        device.clock(900);
        EXPECT_EQ(device.reason(), Stop::none);
        device.clock(200);
        EXPECT_EQ(device.reason(), Stop::memory_stalled);
        EXPECT_EQ(device.permitted(), 1U);
        device.state.ring.stalled = false;
        expect_recovers(device);
    }
}

TEST(Ring, WaitsWhileTheFifoIsFull) {
    TestDevice device = working_device();
    device.write(Register::control, 0);
    const uint32_t count = device.config.fifo_depth + 20;
    for (uint32_t k = 0; k < count; ++k) device.post(along_the_row(2 + k));
    device.clock(5'000);
    EXPECT_EQ(device.read(Register::fifo_used), device.config.fifo_depth);
    EXPECT_EQ(device.reason(), Stop::none);
    EXPECT_LT(device.read(Register::ring_head), device.tail);
    device.write(Register::control, control_enable);
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 1 + count);
    EXPECT_EQ(device.read(Register::ring_head), device.tail);
}

/// What was ordered before a stop, at any time before it, is not carried out after it, except for
/// the copies before the last descriptor that was taken.
TEST(Ring, AStopDropsWhatWasOrdered) {
    for (uint32_t delay = 0; delay < 120; ++delay) {
        TestDevice device;
        device.set_models({tool}, row_of_posts());
        device.clock(300);
        device.post(along_the_row(1));
        device.post(along_the_row(99)); // stops it
        for (uint32_t k = 2; k < 9; ++k) device.post(along_the_row(k));
        device.clock(delay);
        device.write(Register::control, control_clear | control_enable);
        device.clock(200);
        if (device.reason() != Stop::none) {
            // It was not stopped yet when it was cleared.
            ASSERT_EQ(device.reason(), Stop::sequence);
            device.write(Register::control, control_clear | control_enable);
        }
        ASSERT_TRUE(device.finish());
        const uint32_t permitted = device.permitted();
        ASSERT_LE(permitted, 1U);
        ASSERT_EQ(device.read(Register::ring_head), device.tail);
        device.set_models({tool}, row_of_posts());
        device.push(along_the_row(permitted + 1));
        ASSERT_TRUE(device.finish());
        ASSERT_EQ(device.permitted(), permitted + 1) << delay;
    }
}

TEST(Ring, NumbersOfItsLinesStartAgain) {
    TestDevice device = working_device();
    device.write(Register::control, 0);
    // As after 2^32 - 5 lines; the emulator has no other way to get there.
    device.companion.leave();
    device.tail = device.state.ring.tail = device.state.ring.fetched = device.state.ring.head =
        0xFFFF'FFFBU;
    device.write(Register::control, control_enable);
    for (uint32_t k = 2; k < 20; ++k) device.push(along_the_row(k));
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 19U);
    EXPECT_LT(device.tail, 100U);
}

TEST(Ring, ReadsAheadAsFastAsTheHostAnswers) {
    DeviceConfig config = small_config();
    config.host_latency = 60;
    config.host_cycles_per_line = 4;
    config.host_queue = 20;
    config.elements = config.threads = 8;
    TestDevice device(config);
    device.set_models({tool}, {far_away});
    device.clock(300);
    for (uint32_t k = 1; k <= 60; ++k)
        device.post(question(k, {.start = {0, 0, 900'000}, .end = {0, 0, 900'000}}, 1));
    const uint64_t before = device.state.cycle;
    while (device.state.ring.head != device.tail) device.clock();
    EXPECT_LT(device.state.cycle - before, 60U * 4 + 60 + 40);
}

} // namespace
} // namespace hwsim
