#include "hwsim/coprocessor.h"
#include "tests/hwsim/faulty_device.h"

namespace hwsim {
namespace {

TEST(Fault, AViolationIsLatched) {
    TestDevice device = working_device();
    Segment close = along_the_row(2);
    close.threshold = 4'000;
    device.push(close);
    device.push(along_the_row(3));
    device.finish();
    expect_stopped(device, Stop::violation);
    EXPECT_EQ(device.read(Register::found_valid), 1U);
    expect_recovers(device);
}

TEST(Fault, ASegmentOutOfRangeIsRefusedWhenItIsTaken) {
    for (const FixedVec& end :
         {FixedVec{greatest_coordinate + 1, 0, 0}, FixedVec{0, least_coordinate - 1, 0}}) {
        TestDevice device = working_device();
        Segment s = along_the_row(2);
        s.end = end;
        device.push(s);
        expect_stopped(device, Stop::out_of_range);
        expect_recovers(device);
    }
}

TEST(Fault, AToolThatLeavesTheRangeIsRefusedWhenItIsSearched) {
    TestDevice device = working_device();
    Segment s = along_the_row(2);
    s.end = {greatest_coordinate - 49, 0, 0};
    device.push(s);
    device.finish();
    expect_stopped(device, Stop::out_of_range);
    expect_recovers(device);
}

TEST(Fault, AWordThatSaysNothingIsRefused) {
    for (const SegmentKind kind : {SegmentKind::measure, SegmentKind::model}) {
        TestDevice device = working_device();
        Segment s = along_the_row(2);
        s.kind = kind; // and says that it is the last
        device.push(s);
        expect_stopped(device, Stop::out_of_range);
        expect_recovers(device);
    }
}

TEST(Fault, ASegmentOutOfTurnIsRefused) {
    for (const uint32_t sequence : {0U, 1U, 3U, 0xFFFF'FFFFU}) {
        TestDevice device = working_device();
        device.push(along_the_row(sequence));
        EXPECT_EQ(device.read(Register::stop_seq), sequence);
        device.companion.leave();
        device.state.permits.stop_sequence = 2;
        expect_stopped(device, Stop::sequence);
        expect_recovers(device);
    }
}

TEST(Fault, ADoorbellBeyondTheRingStopsTheDevice) {
    TestDevice device = working_device();
    device.state.ring.stalled = true; // so that no line is taken
    device.write(Register::ring_tail, device.tail + TestDevice::ring_size);
    device.clock(50);
    EXPECT_EQ(device.reason(), Stop::none);
    device.write(Register::ring_tail, device.tail + TestDevice::ring_size + 1);
    device.clock(2);
    device.state.ring.stalled = false;
    EXPECT_EQ(device.read(Register::fifo_used), 0U);
    expect_stopped(device, Stop::fifo_overrun);
    expect_recovers(device);
}

TEST(Fault, ASlotWithoutAModelPermitsNothing) {
    for (const bool of_tool : {true, false}) {
        TestDevice device = working_device();
        Segment s = along_the_row(2);
        (of_tool ? s.tool_slot : s.work_slot) = 9;
        device.push(s);
        device.finish();
        expect_stopped(device, Stop::model_missing);
        expect_recovers(device);
    }
}

TEST(Fault, AModelOfAnotherEpochPermitsNothing) {
    for (const uint32_t epoch : {0U, 2U}) {
        TestDevice device = working_device();
        Segment s = along_the_row(2);
        s.work_epoch = epoch;
        device.push(s);
        device.finish();
        expect_stopped(device, Stop::model_changed);
        expect_recovers(device);
    }
}

TEST(Fault, AModelChangedInPlaceWhileSegmentsAreQueuedPermitsNothing) {
    // A host that writes the new stock over the old one, at any time while a segment is searched.
    int stopped = 0, in_time = 0;
    for (uint32_t delay = 0; delay < 40'000; delay += 199) {
        TestDevice device = working_device();
        for (uint32_t k = 2; k < 6; ++k) device.push(along_the_row(k));
        device.clock(delay);
        const uint32_t before = device.permitted();
        device.space.next = 0;
        device.load(Side::tool, {tool}, 8, 2);
        device.load(Side::work, row_of_posts(), 8, 2);
        ASSERT_TRUE(device.finish());
        if (device.reason() == Stop::none) {
            EXPECT_EQ(device.permitted(), 5U); // from what the caches still hold of the old one
            ++in_time;
            continue;
        }
        ++stopped;
        EXPECT_GE(device.permitted(), before);
        EXPECT_EQ(device.reason(), Stop::model_changed);
        EXPECT_EQ(device.read(Register::stop_seq), device.permitted() + 1);
    }
    EXPECT_GT(stopped, 20);
    EXPECT_GT(in_time, 20);
}

TEST(Fault, AWrongBitInAnyLineThatIsReadStopsTheDevice) {
    int stopped = 0;
    for (uint32_t line = 0; line < 40; ++line)
        for (uint32_t bit = line % 16; bit < 512; bit += 16) {
            TestDevice device;
            device.set_models({tool}, row_of_posts());
            device.clock(2'000);
            if (line >= device.space.next) continue;
            device.state.memory.lines[line].word[bit / 32] ^= 1U << (bit % 32);
            device.push(along_the_row(1));
            ASSERT_TRUE(device.finish());
            if (device.reason() == Stop::none) {
                EXPECT_EQ(device.permitted(), 1U); // not a line that this search reads
                continue;
            }
            ++stopped;
            ASSERT_EQ(device.reason(), Stop::bad_check);
            ASSERT_EQ(device.read(Register::stop_line), line);
            ASSERT_EQ(device.permitted(), 0U);
        }
    EXPECT_GT(stopped, 200);
}

TEST(Fault, AWrongBitAtAnyTimeNeverPermitsWhatTheGoodMemoryWouldNot) {
    std::mt19937 rng(1);
    int stopped = 0, violations = 0;
    for (int round = 0; round < 400; ++round) {
        TestDevice device;
        device.set_models({tool, {{30, 0, 500}, 100, 100}}, row_of_posts());
        device.clock(500);
        const uint32_t close = 2 + rng() % 6;
        for (uint32_t k = 1; k <= 8; ++k) {
            Segment s = along_the_row(k);
            s.threshold = k == close ? 2'600 : 2'300;
            device.push(s);
        }
        device.clock(rng() % 3'000);
        const uint32_t line = rng() % device.space.next;
        device.state.memory.lines[line].word[rng() % 16] ^= 1U << (rng() % 32);
        ASSERT_TRUE(device.finish());
        ASSERT_LT(device.permitted(), close);
        ASSERT_NE(device.reason(), Stop::none);
        stopped += device.reason() == Stop::bad_check ? 1 : 0;
        violations += device.reason() == Stop::violation ? 1 : 0;
    }
    EXPECT_GT(stopped, 30);
    EXPECT_GT(violations, 30);
}

TEST(Fault, AfterAWrongBitTheDeviceRecoversWithNewLines) {
    TestDevice device = working_device();
    device.reset();
    device.set_models({tool}, row_of_posts());
    device.push(along_the_row(1));
    ASSERT_TRUE(device.finish());
    for (Line& line : device.state.memory.lines) line.word[3] ^= 4;
    for (SearchElement& e : device.state.elements) e.nodes = search_element(device.config).nodes;
    device.push(along_the_row(2));
    device.finish();
    expect_stopped(device, Stop::bad_check);
    expect_recovers(device);
}

TEST(Fault, AnAddressBeyondTheMemoryStopsTheDevice) {
    TestDevice device = working_device();
    device.set_model(1, device.config.memory_lines);
    device.push(along_the_row(2));
    device.finish();
    EXPECT_EQ(device.read(Register::stop_line), device.config.memory_lines);
    expect_stopped(device, Stop::bad_address);
    expect_recovers(device);
    // In a node.
    const uint32_t line = take(device.space, 1)->first, beyond = device.config.memory_lines + 7;
    const Volume box{{{0, 0, 0}, {9'000, 100, 0}}, 0};
    device.store({{line, packed(Node{{box, box}, {Reference::node(beyond), {}}}, 1, line)}});
    device.set_model(1, line);
    device.push(along_the_row(3));
    device.finish();
    EXPECT_EQ(device.read(Register::stop_line), beyond);
    expect_stopped(device, Stop::bad_address, 2);
    expect_recovers(device);
}

TEST(Fault, AFullStackStopsTheDevice) {
    DeviceConfig config = small_config();
    config.stack_depth = 1;
    TestDevice device(config);
    device.set_models({tool}, row_of_posts());
    device.push(along_the_row(1));
    ASSERT_TRUE(device.finish());
    expect_stopped(device, Stop::stack_overflow, 0);
    // What needs no stack is still answered.
    device.write(Register::control, control_clear | control_enable);
    device.set_models({tool}, {far_away});
    device.push(question(1, {}, 100));
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 1U);
}

TEST(Fault, AStackAsDeepAsTheSearchIsEnoughAndNoLess) {
    TestDevice device = working_device();
    const auto depth = static_cast<uint32_t>(device.read(Counter::deepest));
    ASSERT_GT(depth, 2U);
    for (const uint32_t less : {0U, 1U}) {
        DeviceConfig config = small_config();
        config.stack_depth = depth - less;
        TestDevice other(config);
        other.set_models({tool}, row_of_posts());
        other.push(along_the_row(1));
        ASSERT_TRUE(other.finish());
        EXPECT_EQ(other.permitted(), 1U - less);
        EXPECT_EQ(other.reason(), less == 0 ? Stop::none : Stop::stack_overflow);
    }
}

TEST(Fault, ATreeWithoutAnEndStopsTheDevice) {
    DeviceConfig config = small_config();
    config.search_limit = 50'000;
    TestDevice device = working_device(config);
    // A node that is its own child, with a good check word.
    const uint32_t line = take(device.space, 1)->first;
    const Volume box{{{0, 0, 0}, {9'000, 100, 0}}, 0};
    device.store({{line, packed(Node{{box, box}, {Reference::node(line), {}}}, 1, line)}});
    device.set_model(1, line);
    device.push(along_the_row(2));
    ASSERT_TRUE(device.finish(60'000));
    expect_stopped(device, Stop::too_long);
    expect_recovers(device);
}

TEST(Fault, NothingIsAcceptedAfterTheLastSequenceNumber) {
    constexpr uint32_t last = 0xFFFF'FFFF;
    TestDevice device = working_device();
    device.companion.leave();
    device.state.permits.permit_sequence = last - 1;
    device.state.fifo.next_sequence = last;
    device.push(along_the_row(last));
    EXPECT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), last);
    for (int again = 0; again < 2; ++again) {
        device.push(along_the_row(0));
        device.clock(3'000);
        EXPECT_EQ(device.permitted(), last);
        EXPECT_EQ(device.reason(), Stop::sequence);
        device.write(Register::control, control_clear | control_enable);
    }
    device.write(Register::control, control_reset);
    EXPECT_EQ(device.permitted(), 0U);
    EXPECT_EQ(device.read(Register::next_seq), 1U);
}

TEST(Fault, AHostWithoutHeartbeatGetsNoMorePermits) {
    TestDevice device = working_device();
    device.write(Register::heartbeat, 1);
    device.write(Register::watchdog, 500);
    for (int i = 0; i < 10; ++i) {
        device.clock(450);
        EXPECT_EQ(device.reason(), Stop::none);
        device.write(Register::heartbeat, 1);
    }
    device.clock(498);
    EXPECT_EQ(device.reason(), Stop::none);
    device.clock(2);
    expect_stopped(device, Stop::host_silent);
    device.write(Register::watchdog, 100'000);
    expect_recovers(device);
}

TEST(Fault, EveryReasonToStopHasItsTest) {
    // None, the eleven of this file, memory_stalled and bad_descriptor: a new one asks for a test
    // of its own.
    EXPECT_EQ(stop_count, 14);
}

TEST(Fault, AStopForgetsWhatWasUnderWay) {
    // Answers and lines from before the stop come in while the next segments are searched.
    for (uint32_t delay = 0; delay < 400; ++delay) {
        TestDevice device;
        device.set_models({tool}, row_of_posts());
        for (uint32_t k = 1; k < 5; ++k) device.push(along_the_row(k));
        device.clock(delay);
        device.push(along_the_row(99));
        ASSERT_EQ(device.reason(), Stop::sequence);
        const uint32_t permitted = device.permitted();
        device.write(Register::control, control_clear | control_enable);
        device.set_models({tool}, {{{0, -2'000, 0}, 0, 0}});
        Segment close = along_the_row(permitted + 1);
        device.push(close);
        ASSERT_TRUE(device.finish());
        ASSERT_EQ(device.permitted(), permitted);
        ASSERT_EQ(device.reason(), Stop::violation);
        ASSERT_EQ(device.read(Register::found_low), 1'950U * 1'950U);
    }
}

TEST(Fault, ManyStopsLeaveEveryThreadFree) {
    TestDevice device;
    for (int round = 0; round < 10; ++round) {
        device.set_models({tool}, row_of_posts());
        for (uint32_t k = 1; k < 5; ++k) device.push(along_the_row(k));
        device.clock(60);
        device.push(along_the_row(99));
        ASSERT_EQ(device.reason(), Stop::sequence);
        device.clock();
        for (const SearchElement& element : device.state.elements) ASSERT_EQ(element.busy, 0U);
        device.write(Register::control, control_clear | control_enable);
    }
    device.set_models({tool}, row_of_posts());
    device.push(along_the_row(1));
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 1U);
}

TEST(Fault, ResetIsAsAfterPowerUp) {
    TestDevice device = working_device();
    device.write(Register::irq_enable, 7);
    device.write(Register::control, control_reset);
    CoprocessorState fresh = power_up(device.config);
    fresh.memory.lines = device.state.memory.lines;
    fresh.shared = device.state.shared;
    tick(fresh, device.config);
    EXPECT_EQ(device.state, fresh);
    EXPECT_EQ(device.permitted(), 0U);
}

} // namespace
} // namespace hwsim
