#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/hwsim/functional_answers.h"

namespace hwsim {
namespace {

TEST(Coprocessor, AnswersAsTheFunctionalModel) {
    expect_the_functional_answers(1, small_config(), 100'000, 20);
}

TEST(Coprocessor, AnswersAsTheFunctionalModelOnALattice) {
    expect_the_functional_answers(2, small_config(), 4, 20);
}

TEST(Coprocessor, AnswersTheSameHoweverItIsBuilt) {
    for (const uint32_t threads : {1U, 5U})
        for (const uint32_t latency : {1U, 70U}) {
            DeviceConfig config = small_config();
            config.threads = threads;
            config.memory_latency = latency;
            config.cycles_per_line = latency > 1 ? 4 : 1;
            config.node_cache_lines = latency > 1 ? 1 : 64;
            config.elements = threads == 1 ? 1 : 8;
            expect_the_functional_answers(threads + latency, config, 30, 20);
        }
}

/// The permit goes up segment by segment, and only as far as the functional model allows.
TEST(Coprocessor, PermitsInOrderWhatKeepsItsDistanceAndStopsAtWhatDoesNot) {
    std::mt19937 rng(3);
    int stopped = 0, permitted = 0;
    for (int round = 0; round < 100; ++round) {
        TestDevice device;
        device.set_models(cloud(rng, 20, 1'000), cloud(rng, 20, 1'000));
        std::vector<Segment> segments;
        for (uint32_t k = 1; k <= 30; ++k) {
            Segment way = random_way(rng, 1'000);
            way.start[2] += 5'000, way.end[2] += rng() % 20 ? 5'000 : 1'500;
            segments.push_back(question(k, way, 100));
            if (device.has_status(status_stopped)) break;
            device.push(segments.back());
        }
        ASSERT_TRUE(device.finish());
        uint32_t allowed = 0;
        const auto slots = device.state.slots;
        while (allowed < segments.size() && !expected(device, segments[allowed]).found) ++allowed;
        ASSERT_EQ(device.permitted(), allowed);
        ASSERT_EQ(device.state.slots, slots);
        permitted += static_cast<int>(allowed);
        if (allowed == segments.size()) {
            ASSERT_EQ(device.reason(), Stop::none);
            continue;
        }
        ++stopped;
        ASSERT_EQ(device.reason(), Stop::violation);
        ASSERT_EQ(device.read(Register::stop_seq), allowed + 1);
        const Answer answer = expected(device, segments[allowed]);
        ASSERT_EQ(device.read(Register::found_low), static_cast<uint32_t>(answer.squared));
        ASSERT_EQ(device.read(Register::found_high), answer.squared >> 32);
        ASSERT_EQ(device.read(Register::found_tool), answer.tool_record);
        ASSERT_EQ(device.read(Register::found_work), answer.work_record);
        ASSERT_EQ(device.read(Register::found_sample), answer.sample);
        ASSERT_EQ(device.read(Register::found_seq), allowed + 1);
    }
    EXPECT_GT(stopped, 20);
    EXPECT_GT(permitted, 500);
}

TEST(Coprocessor, PermitsASegmentOnlyWhenItsLastQuerySaysYes) {
    TestDevice device;
    const Record near{{0, 0, 50}, 0, 0}, far{{0, 0, 5'000}, 0, 0};
    device.set_models({{{0, 0, 0}, 0, 0}}, {far});
    device.set_model(2, device.load(Side::work, {near}));
    Segment first = question(1, {}, 100), second = question(1, {}, 100);
    first.last = false;
    second.work_slot = 2;
    device.push(first);
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 0U);
    device.push(second);
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 0U);
    EXPECT_EQ(device.reason(), Stop::violation);
    // The other way round: the refusal comes first.
    device.write(Register::control, control_clear | control_enable);
    device.set_models({{{0, 0, 0}, 0, 0}}, {near});
    device.set_model(2, device.load(Side::work, {far}));
    device.push(first);
    device.push(second);
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 0U);
}

TEST(Coprocessor, RefusesAtOneStepLessThanTheReserveAllows) {
    for (const int32_t apart : {102, 103}) {
        TestDevice device;
        device.set_models({{{0, 0, 0}, 0, 0}}, {{{apart, 0, 0}, 0, 0}});
        device.push(question(1, {}, 100));
        ASSERT_TRUE(device.finish());
        EXPECT_EQ(device.permitted(), apart == 103 ? 1U : 0U);
    }
}

TEST(Coprocessor, PermitsNothingAfterPowerUp) {
    TestDevice device;
    EXPECT_EQ(device.permitted(), 0U);
    device.clock(1'000);
    EXPECT_EQ(device.permitted(), 0U);
    EXPECT_EQ(device.read(Register::identification), identification_word);
}

TEST(Coprocessor, WaitsUntilItIsEnabled) {
    TestDevice device;
    device.write(Register::control, 0);
    device.set_models({{{0, 0, 0}, 0, 0}}, {{{5'000, 0, 0}, 0, 0}});
    device.push(question(1, {}, 100));
    device.clock(5'000);
    EXPECT_EQ(device.permitted(), 0U);
    device.write(Register::control, control_enable);
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 1U);
    // Disabled while a segment is searched.
    device.push(question(2, {}, 100));
    device.clock(3);
    device.write(Register::control, 0);
    device.clock(5'000);
    EXPECT_EQ(device.permitted(), 1U);
    device.write(Register::control, control_enable);
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.permitted(), 2U);
}

TEST(Coprocessor, HoldsEachSegmentAgainstTheModelAsItWillBeThen) {
    TestDevice device;
    const uint32_t before = device.load(Side::work, {{{50, 0, 0}, 0, 0}}, 8, 1);
    device.set_model(0, device.load(Side::tool, {{{0, 0, 0}, 0, 0}}, 8, 1));
    device.set_model(1, before, 1);
    // Two before the cut, two after it, one before the next.
    const auto ask = [&](uint32_t epoch) {
        Segment s = question(1, {}, 0, SegmentKind::measure);
        s.work_epoch = epoch;
        device.push(s);
    };
    ask(1), ask(1);
    const uint32_t after = device.load(Side::work, {{{70, 0, 0}, 0, 0}}, 8, 2);
    device.set_model(1, after, 2);
    ask(2), ask(2);
    device.set_model(1, device.load(Side::work, {{{90, 0, 0}, 0, 0}}, 8, 3), 3);
    ask(3);
    ASSERT_TRUE(device.finish());
    std::vector<uint64_t> squared;
    for (const Retired& r : device.retired)
        if (r.segment.kind == SegmentKind::measure) squared.push_back(r.answer.squared);
    EXPECT_EQ(squared, (std::vector<uint64_t>{2500, 2500, 4900, 4900, 8100}));
}

TEST(Coprocessor, TakesAModelOnlyWhenItsLinesAreWritten) {
    DeviceConfig config = small_config();
    config.cycles_per_line = 40;
    TestDevice device(config);
    std::mt19937 rng(9);
    device.set_models(cloud(rng, 20, 1'000), cloud(rng, 20, 1'000));
    device.push(question(1, {}, 0, SegmentKind::measure));
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.reason(), Stop::none);
    EXPECT_EQ(device.retired.back().answer, expected(device, device.retired.back().segment));
}

/// Cycles of one search alone, and how many lines it reads.
std::pair<uint64_t, uint64_t> one_search(uint32_t latency, uint32_t cycles_per_line) {
    DeviceConfig config = small_config();
    config.memory_latency = latency;
    config.cycles_per_line = cycles_per_line;
    TestDevice device(config);
    std::mt19937 rng(10);
    device.set_models(cloud(rng, 20, 1'000), cloud(rng, 20, 1'000));
    device.clock(5'000);
    device.push(question(1, {}, 0, SegmentKind::measure));
    const uint64_t pushed = device.state.cycle;
    device.finish();
    return {device.state.cycle - pushed, device.read(Counter::lines_read)};
}

TEST(Coprocessor, WaitsForTheMemoryAsLongAsItTakes) {
    const auto [cycles, lines] = one_search(10, 1);
    ASSERT_GT(lines, 5U);
    const auto [later, same] = one_search(25, 1);
    EXPECT_EQ(same, lines);
    EXPECT_EQ(later, cycles + 15 * lines);
    // One search asks for a line at a time, so the bandwidth does not matter to it.
    EXPECT_EQ(one_search(10, 5).first, cycles);
}

TEST(Coprocessor, RaisesItsInterruptsAndTakesThemBack) {
    TestDevice device;
    device.set_models({{{0, 0, 0}, 0, 0}}, {{{5'000, 0, 0}, 0, 0}});
    device.push(question(1, {}, 100));
    ASSERT_TRUE(device.finish());
    EXPECT_FALSE(interrupt(device.state));
    device.write(Register::irq_enable, irq_permit | irq_stop);
    EXPECT_TRUE(interrupt(device.state));
    device.write(Register::irq_pending, irq_permit);
    EXPECT_FALSE(interrupt(device.state));
    device.push(question(2, {}, 6'000));
    ASSERT_TRUE(device.finish());
    EXPECT_EQ(device.read(Register::irq_pending), irq_stop);
}

TEST(Coprocessor, CountsWhatItDid) {
    std::mt19937 rng(4);
    TestDevice device;
    device.set_models(cloud(rng, 50, 10'000), cloud(rng, 50, 10'000));
    SearchCounts sum;
    for (int i = 0; i < 30; ++i)
        device.push(question(1, random_way(rng, 30'000), 0, SegmentKind::measure));
    Segment late = question(1, {.start = {60'000, 0, 0}, .end = {60'000, 0, 0}}, 1);
    late.is_timed = true;
    late.deadline = static_cast<uint32_t>(device.state.cycle) + 5;
    device.push(late);
    ASSERT_TRUE(device.finish());
    for (const Retired& r : device.retired) {
        sum.nodes += r.answer.counts.nodes;
        sum.splits += r.answer.counts.splits;
        sum.pair_tests += r.answer.counts.pair_tests;
        sum.deepest = std::max(sum.deepest, r.answer.counts.deepest);
    }
    EXPECT_EQ(device.read(Counter::cycles), device.state.cycle);
    EXPECT_EQ(device.read(Counter::queries), 31U);
    EXPECT_EQ(device.read(Counter::nodes), sum.nodes);
    EXPECT_EQ(device.read(Counter::splits), sum.splits);
    EXPECT_EQ(device.read(Counter::pair_tests), sum.pair_tests);
    EXPECT_EQ(device.read(Counter::deepest), sum.deepest);
    EXPECT_EQ(device.read(Counter::node_misses) + device.read(Counter::record_misses),
              device.read(Counter::lines_read));
    EXPECT_EQ(device.read(Counter::node_hits) + device.read(Counter::node_misses), sum.nodes);
    EXPECT_EQ(device.read(Counter::lines_written), device.space.next);
    EXPECT_EQ(device.read(Counter::missed), 1U);
    EXPECT_LT(static_cast<int64_t>(device.read(Counter::least_slack)), 0);
}

TEST(Coprocessor, CountsAPermitAsLateFromTheFirstCycleAfterItsDeadline) {
    // From just before the numbers of cycles start again, too.
    for (const uint64_t cycle : {uint64_t{0}, (uint64_t{1} << 32) - 700}) {
        const auto asked = [&](std::optional<uint32_t> deadline) {
            TestDevice device;
            device.companion.leave();
            device.state.cycle += cycle;
            device.write(Register::heartbeat, 1);
            device.set_models({{{0, 0, 0}, 10, 5}}, {{{9'000, 0, 0}, 10, 5}});
            device.clock(500);
            Segment s = question(1, {.end = {100, 0, 0}}, 1);
            s.is_timed = deadline.has_value();
            s.deadline = deadline.value_or(0);
            device.push(s);
            while (device.permitted() == 0) device.clock();
            return device;
        };
        TestDevice free = asked({});
        EXPECT_EQ(free.read(Counter::least_slack), no_slack);
        const auto permitted = static_cast<uint32_t>(free.state.cycle);
        TestDevice in_time = asked(permitted), late = asked(permitted - 1);
        EXPECT_EQ(in_time.read(Counter::missed), 0U);
        EXPECT_EQ(static_cast<int64_t>(in_time.read(Counter::least_slack)), 0);
        EXPECT_EQ(late.read(Counter::missed), 1U);
        EXPECT_EQ(static_cast<int64_t>(late.read(Counter::least_slack)), -1);
    }
}

/// A device at work, one push every so many cycles.
struct Work {
    TestDevice device;
    std::vector<Segment> segments;
    size_t pushed = 0;

    explicit Work(uint32_t seed) {
        std::mt19937 rng(seed);
        device.set_models(cloud(rng, 60, 3'000), cloud(rng, 90, 3'000));
        for (int i = 0; i < 40; ++i)
            segments.push_back(question(1, random_way(rng, 6'000), 0, SegmentKind::measure));
    }
    void step() {
        if (device.state.cycle % 29 == 0 && pushed < segments.size()
            && !device.has_status(status_fifo_full))
            device.push(segments[pushed++]);
        device.clock();
    }
};

TEST(Coprocessor, GetsLinesNoFasterThanTheBandwidth) {
    Work work(11);
    work.device.config.cycles_per_line = 60;
    work.device.companion.leave(); // it has the usual memory
    const auto moved = [&] {
        return work.device.read(Counter::lines_read) + work.device.read(Counter::lines_written);
    };
    const uint64_t lines = moved(), cycle = work.device.state.cycle;
    while (work.device.retired.size() < 42) work.step();
    const uint64_t read = moved() - lines, taken = work.device.state.cycle - cycle;
    EXPECT_LE(60 * read, taken + 60);
    EXPECT_GT(90 * read, taken); // it was short of lines most of the time
}

TEST(Coprocessor, SearchesWhileTheHostWritesWithoutAPause) {
    TestDevice device;
    std::mt19937 rng(12);
    device.set_models(cloud(rng, 20, 1'000), cloud(rng, 20, 1'000));
    device.push(question(1, {}, 0, SegmentKind::measure));
    for (int i = 0; i < 5'000; ++i) {
        if (device.state.ring.tail == device.state.ring.head) device.post_copy(3'000, 500);
        device.clock();
    }
    EXPECT_GT(device.read(Counter::lines_written), 1'000U);
    EXPECT_EQ(device.retired.size(), 3U);
}

TEST(Coprocessor, TakesTheSameCyclesEveryTime) {
    Work a(5), b(5);
    while (a.device.retired.size() < 42) {
        a.step();
        b.step();
    }
    EXPECT_EQ(b.device.retired.size(), 42U);
    EXPECT_EQ(a.device.state, b.device.state);
}

/// Also while lines are written, and through stops.
TEST(Coprocessor, DoesNotDependOnTheOrderInWhichUnitsAreEvaluated) {
    std::mt19937 rng(14);
    Work work(13);
    TestDevice& device = work.device;
    std::vector<size_t> order(device.config.elements + 3);
    std::iota(order.begin(), order.end(), size_t{0});
    CoprocessorState shuffled = device.state;
    int stops = 0;
    for (int cycle = 0; cycle < 30'000; ++cycle) {
        if (rng() % 700 == 0) {
            device.push(question(99, {}, 0));
            ++stops;
        } else if (device.has_status(status_stopped) && rng() % 3 == 0) {
            device.write(Register::control, control_clear | control_enable);
            device.set_models(cloud(rng, 60, 3'000), cloud(rng, 90, 3'000));
            device.space.next = 0;
        } else if (!device.has_status(status_fifo_full)) {
            device.push(question(device.read(Register::next_seq), random_way(rng, 6'000), 0,
                                 SegmentKind::measure));
        }
        if (rng() % 4 == 0 && device.state.ring.tail - device.state.ring.head < 40)
            device.post_copy(rng() % 500, 1 + rng() % 3);
        shuffled = device.state;
        for (int i = 0; i < 4; ++i) {
            std::shuffle(order.begin(), order.end(), rng);
            tick_in_order(shuffled, device.config, order);
            device.clock();
        }
        ASSERT_TRUE(shuffled == device.state) << cycle;
    }
    EXPECT_GT(stops, 20);
}

/// A line that is written while it is read, and while others come in, must not stay in a cache: a
/// later model may use it.
TEST(Coprocessor, ForgetsLinesThatAreWrittenWhileTheyAreRead) {
    int answered = 0, stopped = 0;
    for (uint32_t delay = 0; delay < 900; ++delay) {
        DeviceConfig config = small_config();
        config.elements = 1;
        config.node_cache_lines = config.record_cache_lines = 64;
        config.memory_latency = 20;
        config.cycles_per_line = 1;
        TestDevice device(config);
        std::mt19937 rng(delay);
        device.set_model(0, device.load(Side::tool, cloud(rng, 4, 500), 2));
        const LineSpace before = device.space;
        const uint32_t header = device.load(Side::work, cloud(rng, 6, 3'000), 2);
        device.set_model(1, header);
        device.clock(300);
        for (int i = 0; i < 2; ++i) device.push(question(1, {}, 0, SegmentKind::measure));
        device.clock(delay);
        device.space = before;
        ASSERT_EQ(device.load(Side::work, cloud(rng, 6, 3'000), 2, 2), header);
        ASSERT_TRUE(device.finish());
        ++(device.reason() == Stop::none ? answered : stopped);
        device.write(Register::control, control_clear | control_enable);
        if (!device.state.slots[0].valid) device.set_model(0, before.next - 1);
        device.set_model(1, header, 2);
        Segment later = question(1, {}, 0, SegmentKind::measure);
        later.work_epoch = 2;
        device.push(later);
        ASSERT_TRUE(device.finish());
        ASSERT_EQ(device.reason(), Stop::none);
        ASSERT_EQ(device.retired.back().answer, expected(device, later)) << delay;
    }
    EXPECT_GT(answered, 100);
    EXPECT_GT(stopped, 100);
}

TEST(Coprocessor, ContinuesFromASnapshotAsBefore) {
    std::mt19937 rng(6);
    Work original(7);
    std::vector<std::pair<Work, CoprocessorState>> others;
    uint64_t next = 40;
    while (original.device.retired.size() < 42) {
        if (original.device.state.cycle >= next && others.size() < 40) {
            Work other(8); // has been somewhere else
            for (uint32_t i = rng() % 300; i > 0; --i) other.step();
            others.emplace_back(other, original.device.state);
            others.back().first.device.state = original.device.state;
            others.back().first.device.tail = original.device.tail;
            others.back().first.segments = original.segments;
            others.back().first.pushed = original.pushed;
            next += 1 + rng() % 300;
        }
        original.step();
    }
    ASSERT_GT(others.size(), 10U);
    for (auto& [other, from] : others) {
        while (other.device.state.cycle < original.device.state.cycle) other.step();
        ASSERT_EQ(other.device.state, original.device.state) << from.cycle;
    }
}

TEST(DeviceConfig, IsRefusedWhereItCannotBeBuilt) {
    EXPECT_TRUE(checked(DeviceConfig{}));
    EXPECT_FALSE(checked({.elements = 0}));
    EXPECT_FALSE(checked({.threads = 17}));
    EXPECT_FALSE(checked({.stack_depth = 65}));
    EXPECT_FALSE(checked({.node_cache_lines = 100}));
    EXPECT_TRUE(checked({.node_cache_lines = 1U << 14, .record_cache_lines = 1}));
    EXPECT_FALSE(checked({.node_cache_lines = 1U << 15}));
    EXPECT_FALSE(checked({.record_cache_lines = 1U << 30}));
    EXPECT_FALSE(checked({.record_cache_lines = 0}));
    EXPECT_FALSE(checked({.memory_lines = 0}));
}

} // namespace
} // namespace hwsim
