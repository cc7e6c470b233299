#include <gtest/gtest.h>

#include "core/dbm/cut_model.h"
#include "tests/hwsim/judged_queries.h"
#include "tests/hwsim/test_device.h"

namespace hwsim {
namespace {

const core::RevolvedProfile holder{{{4, 3, 14, 3, 0}, {14, 7, 18, 9, 0}, {18, 9, 40, 9, 0}}};
const test_support::CutBox raw{{{-30, -25, -15}, {30, 25, 0}}, 0.0, {}};

DeviceConfig bench_config() {
    DeviceConfig config = small_config();
    config.memory_lines = 1U << 15;
    config.memory_limit = 100'000;
    return config;
}

/// A job as a control would see it: segments, and cuts between them.
struct Job {
    struct Step {
        PathSegment segment;
        core::CutModel stock; // as it is when the machine gets there
    };
    std::vector<Step> steps;
};

Job random_job(uint32_t seed, SlotNumber tool, SlotNumber work, size_t count) {
    std::mt19937 rng(seed);
    Job job;
    core::CutModel stock = raw.uncut(1.0);
    const auto cutter = std::make_shared<core::Cutter>(
        core::make_cutter(core::RevolvedProfile{{{0, 5, 12, 5, 0}}}, 0.0));
    core::Vec3 at(0, 0, -3);
    while (job.steps.size() < count) {
        PathSegment segment{.from = at};
        at += test_support::random_point({{-4, -4, -0.6}, {4, 4, 0.55}}, rng);
        at = glm::clamp(at, core::Vec3(-28, -23, -9), core::Vec3(28, 23, 3));
        segment.to = at;
        segment.pairs = {{tool, work, 1.0}};
        job.steps.push_back({segment, stock});
        core::cut(stock, {cutter, segment.from, segment.to});
    }
    return job;
}

/// Whether the functional model permits a step, on a stock made afresh.
bool is_permitted(const Job::Step& step) {
    DeviceStock device(step.stock);
    Question q{holder, step.segment.from, step.segment.to, step.segment.pairs[0].distance, 0};
    for (double s = glm::length(q.to - q.from); s > step.segment.sample_step; s *= 0.5)
        ++q.log2_steps;
    const Answer answer = device.ask(q);
    EXPECT_EQ(answer.stop, Stop::none);
    return !answer.found;
}

struct Outcome {
    std::vector<bool> permitted;
    std::vector<uint64_t> squared; // of violations
    bool operator==(const Outcome&) const = default;
};

/// Drives a job, always some segments ahead of the answers; a step that is refused is left out.
Outcome drive(Driver& driver, SlotNumber work, const Job& job) {
    Outcome outcome;
    size_t step = 0;
    while (step < job.steps.size()) {
        const size_t first = step;
        const uint32_t base = driver.next_sequence;
        for (; step < job.steps.size() && step < first + 12; ++step) {
            EXPECT_TRUE(update_stock(driver, work, job.steps[step].stock));
            EXPECT_EQ(push(driver, job.steps[step].segment).value(), base + (step - first));
        }
        const DeviceReport now = wait_for_all(driver);
        const uint32_t count = now.permitted + 1 - base;
        outcome.permitted.insert(outcome.permitted.end(), count, true);
        step = first + count;
        if (now.stop == Stop::none) continue;
        EXPECT_EQ(now.stop, Stop::violation);
        EXPECT_EQ(now.stop_sequence, now.permitted + 1);
        outcome.permitted.push_back(false);
        outcome.squared.push_back(found_pair(driver).value().squared);
        ++step;
        recover(driver);
    }
    return outcome;
}

Outcome drive_on(DevicePort port, uint32_t seed, size_t count) {
    Driver driver = open_device(std::move(port)).value();
    const SlotNumber tool = load_tool(driver, holder, 0.05).value();
    const SlotNumber work = load_stock(driver, raw.uncut(1.0)).value();
    return drive(driver, work, random_job(seed, tool, work, count));
}

TEST(Driver, PermitsASegmentIfTheStockAsItIsThenAllowsIt) {
    FunctionalDevice device = functional_device(bench_config()).value();
    const Outcome outcome = drive_on(port_of(device), 1, 300);
    const Job job = random_job(1, SlotNumber{0}, SlotNumber{1}, 300);
    ASSERT_EQ(outcome.permitted.size(), job.steps.size());
    int refused = 0;
    for (size_t i = 0; i < job.steps.size(); ++i) {
        ASSERT_EQ(outcome.permitted[i], is_permitted(job.steps[i])) << i;
        refused += outcome.permitted[i] ? 0 : 1;
    }
    EXPECT_GT(refused, 20);
    EXPECT_LT(refused, 280);
}

TEST(Driver, GetsTheSameFromTheEmulatorAsFromTheFunctionalModel) {
    for (uint32_t seed = 2; seed < 4; ++seed) {
        FunctionalDevice functional = functional_device(bench_config()).value();
        EmulatedDevice emulated = emulated_device(bench_config()).value();
        const Outcome expected = drive_on(port_of(functional), seed, 200);
        EXPECT_EQ(drive_on(port_with_companion(emulated), seed, 200), expected);
        EXPECT_GT(emulated.state.cycle, 10'000U);
    }
}

TEST(Driver, MeasuresWhatTheExactEngineDoes) {
    FunctionalDevice device = functional_device(bench_config()).value();
    Driver driver = open_device(port_of(device)).value();
    const core::CutModel stock = raw.uncut(1.0);
    const core::RevolvedProfile cylinder{{{0, 5, 12, 5, 0}}};
    const SlotNumber tool = load_tool(driver, cylinder).value();
    const SlotNumber work = load_stock(driver, stock).value();
    std::mt19937 rng(5);
    for (int i = 0; i < 200; ++i) {
        const core::Vec3 from = test_support::random_point({{-60, -60, 1}, {60, 60, 30}}, rng);
        const core::Vec3 to = test_support::random_point({{-60, -60, 1}, {60, 60, 30}}, rng);
        const Question q{cylinder, from, to, 100.0, 0};
        const double exact = exact_distance(q, stock).separation.lower;
        const auto found = measure(driver, {from, to, {{tool, work, 0.0}}, 0.05}).value();
        ASSERT_TRUE(found);
        ASSERT_NEAR(found->distance(), std::max(exact, 0.0), 8 * lsb + 0.05 * 0.5);
        EXPECT_LE(least_clearance(*found), exact);
        EXPECT_GE(least_clearance(*found), exact - 11 * lsb);
        // Looking less far, it says as much of what it sees, and nothing of the rest.
        const auto near = measure(driver, {from, to, {{tool, work, 10.0}}, 0.05}).value();
        if (exact > 10.01) {
            EXPECT_FALSE(near);
        }
        if (exact < 10.0) {
            ASSERT_TRUE(near);
            EXPECT_EQ(near->squared, found->squared);
        }
    }
}

TEST(Driver, GivesLinesBackWhenNothingReadsThemAnyMore) {
    EmulatedDevice device = emulated_device(bench_config()).value();
    Driver driver = open_device(port_with_companion(device)).value();
    const SlotNumber tool = load_tool(driver, holder).value();
    const SlotNumber work = load_stock(driver, raw.uncut(1.0)).value();
    drive(driver, work, random_job(6, tool, work, 200));
    const uint32_t before = driver.space.next;
    drive(driver, work, random_job(7, tool, work, 400));
    EXPECT_LT(driver.space.next, before + before / 2);
    EXPECT_LT(driver.released.size(), 20U);
}

TEST(Driver, SendsNoSegmentBeforeItsLinesAreWritten) {
    DeviceConfig config = bench_config();
    config.cycles_per_line = 60;
    EmulatedDevice device = emulated_device(config).value();
    device.bus_cycles = 1;
    Driver driver = open_device(port_with_companion(device)).value();
    const SlotNumber tool = load_tool(driver, holder).value();
    const auto wait_until_written = [&] {
        for (int i = 0; i < 40'000; ++i) driver.port.wait();
        ASSERT_TRUE(device.state.memory.writes.empty());
    };
    core::CutModel stock = raw.uncut(1.0);
    wait_until_written();
    const SlotNumber work = load_stock(driver, stock).value();
    const auto cutter = std::make_shared<core::Cutter>(
        core::make_cutter(core::RevolvedProfile{{{0, 5, 12, 5, 0}}}, 0.0));
    for (uint32_t i = 1; i < 20; ++i) {
        EXPECT_FALSE(is_idle(device.state.ring)); // lines are still to come
        EXPECT_EQ(push(driver, {{0, 0, 2}, {9, 9, 2}, {{tool, work, 1.0}}}).value(), i);
        const DeviceReport now = wait_for_all(driver);
        ASSERT_EQ(now.stop, Stop::none);
        ASSERT_EQ(now.permitted, i);
        wait_until_written();
        core::cut(stock, {cutter, {1.0 * i, 0, -4}, {1.0 * i, 9, -4}});
        EXPECT_TRUE(update_stock(driver, work, stock));
    }
}

TEST(Driver, PermitsASegmentWhenAllOfItsPairsAreKeptApart) {
    EmulatedDevice device = emulated_device(bench_config()).value();
    Driver driver = open_device(port_with_companion(device)).value();
    const SlotNumber tool = load_tool(driver, holder).value();
    const SlotNumber stock = load_stock(driver, raw.uncut(1.0)).value();
    const SlotNumber clamp =
        load_records(driver, Side::work, {{{40 * 4096, 0, 0}, 20 * 4096, 4096}}).value();
    PathSegment way{{0, 0, 2}, {9, 0, 2}, {{tool, stock, 1.0}, {tool, clamp, 2.0}}};
    EXPECT_EQ(push(driver, way).value(), 1U);
    EXPECT_EQ(wait_for_all(driver).permitted, 1U);
    way.to.x = 40.0;
    EXPECT_EQ(push(driver, way).value(), 2U);
    EXPECT_EQ(wait_for_all(driver).permitted, 1U);
    EXPECT_EQ(report(driver).stop, Stop::violation);
}

TEST(Driver, CountsTheLinesThatItMakes) {
    EmulatedDevice device = emulated_device(bench_config()).value();
    Driver driver = open_device(port_with_companion(device)).value();
    const SlotNumber tool = load_tool(driver, holder).value();
    core::CutModel stock = raw.uncut(1.0);
    const SlotNumber work = load_stock(driver, stock).value();
    const auto cutter = std::make_shared<core::Cutter>(
        core::make_cutter(core::RevolvedProfile{{{0, 5, 12, 5, 0}}}, 0.0));
    for (int i = 0; i < 5; ++i) {
        core::cut(stock, {cutter, {2.0 * i, 0, -4}, {2.0 * i, 9, -4}});
        EXPECT_TRUE(update_stock(driver, work, stock));
        EXPECT_TRUE(push(driver, {{0, 0, 2}, {9, 9, 2}, {{tool, work, 1.0}}}));
    }
    ASSERT_EQ(wait_for_all(driver).permitted, 5U);
    // The device has read each of them once.
    const uint32_t read = hwsim::read(device.state, device.config, address_of(Counter::host_lines));
    EXPECT_EQ(driver.lines_made, read);
    EXPECT_GT(read, 500U);
}

TEST(Driver, RefusesWhatItCannotSay) {
    FunctionalDevice device = functional_device(bench_config()).value();
    Driver driver = open_device(port_of(device)).value();
    const SlotNumber tool = load_tool(driver, holder).value();
    const SlotNumber work = load_stock(driver, raw.uncut(1.0)).value();
    const PathSegment good{{0, 0, 9}, {1, 0, 9}, {{tool, work, 1.0}}};
    PathSegment bad = good;
    bad.pairs.clear();
    EXPECT_FALSE(push(driver, bad));
    bad = good;
    bad.to.x = 3000.0;
    EXPECT_FALSE(push(driver, bad));
    bad = good;
    bad.to.x = std::nan("");
    EXPECT_FALSE(push(driver, bad));
    bad = good;
    bad.pairs[0].distance = -1.0;
    EXPECT_FALSE(push(driver, bad));
    bad = good;
    std::swap(bad.pairs[0].tool, bad.pairs[0].work);
    EXPECT_FALSE(push(driver, bad));
    bad = good;
    bad.sample_step = 0.0;
    EXPECT_FALSE(push(driver, bad));
    EXPECT_EQ(report(driver).permitted, 0U);
    EXPECT_EQ(push(driver, good).value(), 1U);
    EXPECT_EQ(wait_for_all(driver).permitted, 1U);
}

TEST(Driver, KeepsAsManyModelsAsThereAreSlots) {
    FunctionalDevice device = functional_device(bench_config()).value();
    Driver driver = open_device(port_of(device)).value();
    for (uint32_t i = 0; i < model_slots; ++i) EXPECT_TRUE(load_tool(driver, holder));
    const uint32_t used = driver.space.next;
    EXPECT_FALSE(load_tool(driver, holder));
    EXPECT_EQ(driver.space.next, used);
    unload(driver, SlotNumber{25});
    EXPECT_EQ(load_tool(driver, holder).value(), SlotNumber{25});
    EXPECT_EQ(driver.space.next, used);
}

TEST(Driver, ChecksSegmentsAgainstAModelThatIsRemovedAfterThem) {
    EmulatedDevice device = emulated_device(bench_config()).value();
    Driver driver = open_device(port_with_companion(device)).value();
    const SlotNumber work = load_stock(driver, raw.uncut(1.0)).value();
    const core::RevolvedProfile slim{{{9, 1, 20, 1, 0}}}, long_one{{{2, 1, 20, 1, 0}}};
    for (uint32_t i = 0; i < 30; ++i) {
        const bool is_last = i == 29;
        const SlotNumber tool = load_tool(driver, is_last ? long_one : slim).value();
        const PathSegment way{{-20, 0, -3}, {20, 0, -3}, {{tool, work, 1.0}}};
        EXPECT_EQ(push(driver, way).value(), i + 1);
        unload(driver, tool);
        EXPECT_FALSE(push(driver, way));
    }
    const DeviceReport now = wait_for_all(driver);
    EXPECT_EQ(now.permitted, 29U);
    EXPECT_EQ(now.stop, Stop::violation);
}

TEST(Driver, DoesNotTakeAnythingForACoprocessor) {
    EXPECT_FALSE(open_device(
        {.read = [](Register) { return 0U; }, .write = [](uint32_t, uint32_t) {}, .wait = [] {}}));
}

TEST(Driver, SaysWhenTheMemoryIsTooSmall) {
    DeviceConfig config = bench_config();
    config.memory_lines = 16;
    FunctionalDevice device = functional_device(config).value();
    Driver driver = open_device(port_of(device)).value();
    const auto slot = load_stock(driver, raw.uncut(1.0));
    ASSERT_FALSE(slot);
    EXPECT_NE(slot.error().message.find("memory of 16 lines"), std::string::npos);
    EXPECT_TRUE(driver.slots.empty());
}

/// A wrong bit while a job runs: nothing is permitted that should not be, and the job goes on.
TEST(Driver, RecoversFromAWrongBit) {
    std::mt19937 rng(8);
    for (int round = 0; round < 30; ++round) {
        EmulatedDevice device = emulated_device(bench_config()).value();
        Driver driver = open_device(port_with_companion(device)).value();
        const SlotNumber tool = load_tool(driver, holder, 0.05).value();
        const SlotNumber work = load_stock(driver, raw.uncut(1.0)).value();
        const PathSegment above{{-20, 0, 1.2}, {20, 0, 1.2}, {{tool, work, 1.0}}};
        const size_t hit = rng() % 2;
        const uint32_t line = driver.slots[hit].header, bit = rng() % 512;
        for (int wait = 0; wait < 2'000; ++wait) driver.port.wait(); // all lines are written
        device.state.memory.lines[line].word[bit / 32] ^= 1U << (bit % 32);
        EXPECT_EQ(push(driver, above).value(), 1U);
        const DeviceReport now = wait_for_all(driver);
        EXPECT_EQ(now.stop, Stop::bad_check);
        EXPECT_EQ(now.stop_line, line);
        EXPECT_EQ(now.permitted, 0U);
        recover(driver);
        EXPECT_EQ(push(driver, above).value(), 1U);
        EXPECT_EQ(wait_for_all(driver).permitted, 1U);
    }
}

TEST(Driver, GivesLinesBackThatAStopHeld) {
    EmulatedDevice device = emulated_device(bench_config()).value();
    Driver driver = open_device(port_with_companion(device)).value();
    const SlotNumber tool = load_tool(driver, holder).value();
    const SlotNumber work = load_stock(driver, raw.uncut(1.0)).value();
    const uint32_t lines = driver.space.next;
    for (int i = 0; i < 400; ++i) {
        const SlotNumber clamp =
            load_records(driver, Side::work, {{{400'000, 0, 0}, 1'000, 1'000}}).value();
        // The first is refused, and what was pushed behind it is forgotten.
        for (const double z : {-4.0, 30.0, 30.0})
            ASSERT_TRUE(push(driver, {{0, 0, z}, {1, 0, z}, {{tool, work, 1.0}}}));
        unload(driver, clamp);
        ASSERT_EQ(wait_for_all(driver).stop, Stop::violation);
        recover(driver);
        EXPECT_TRUE(driver.released.empty());
    }
    EXPECT_LT(driver.space.next, lines + 10);
}

TEST(Driver, RecoversFromAMemoryThatStoredNoLines) {
    EmulatedDevice device = emulated_device(bench_config()).value();
    Driver driver = open_device(port_with_companion(device)).value();
    const SlotNumber tool = load_tool(driver, holder).value();
    core::CutModel stock = raw.uncut(1.0);
    const SlotNumber work = load_stock(driver, stock).value();
    const PathSegment above{{-20, 0, 1.2}, {20, 0, 1.2}, {{tool, work, 1.0}}};
    const auto cutter = std::make_shared<core::Cutter>(
        core::make_cutter(core::RevolvedProfile{{{0, 5, 12, 5, 0}}}, 0.0));
    core::cut(stock, {cutter, {-20, 0, -4}, {20, 0, -4}});
    wait_for_all(driver);
    device.state.memory.stalled = true;
    EXPECT_TRUE(update_stock(driver, work, stock));
    const SlotNumber other = load_tool(driver, holder).value();
    EXPECT_TRUE(push(driver, above));
    const DeviceReport now = wait_for_all(driver);
    EXPECT_EQ(now.stop, Stop::memory_stalled);
    EXPECT_EQ(now.permitted, 0U);
    // What is ordered while the device is stopped is not lost either.
    const SlotNumber third = load_tool(driver, holder).value();
    device.state.memory.stalled = false;
    recover(driver);
    uint32_t permitted = 0;
    for (const SlotNumber number : {tool, other, third})
        EXPECT_EQ(push(driver, {{-20, 0, 1.2}, {20, 0, 1.2}, {{number, work, 1.0}}}).value(),
                  ++permitted);
    EXPECT_EQ(wait_for_all(driver).permitted, permitted);
    EXPECT_EQ(report(driver).stop, Stop::none);
}

/// Whatever was copied when the device stopped, the job goes on after one recovery.
TEST(Driver, OrdersTheCopiesAgainThatAStopCutOff) {
    for (uint32_t delay = 0; delay < 3'000; delay += 7) {
        EmulatedDevice device = emulated_device(bench_config()).value();
        device.bus_cycles = 1;
        Driver driver = open_device(port_of(device)).value();
        const SlotNumber tool = load_tool(driver, holder).value();
        core::CutModel stock = raw.uncut(1.0);
        const SlotNumber work = load_stock(driver, stock).value();
        for (uint32_t i = 0; i < delay; ++i) driver.port.wait();
        halt(device.state, Stop::host_silent, 1);
        recover(driver);
        EXPECT_EQ(push(driver, {{-20, 0, 1.2}, {20, 0, 1.2}, {{tool, work, 1.0}}}).value(), 1U);
        const DeviceReport now = wait_for_all(driver);
        ASSERT_EQ(now.stop, Stop::none) << delay;
        ASSERT_EQ(now.permitted, 1U);
    }
}

/// Models that come and go, more than the memory holds, on a device that works slowly, and on one
/// that has stopped.
TEST(Driver, WaitsForMemoryThatSearchesStillNeed) {
    std::mt19937 rng(31);
    std::vector<Record> records;
    for (int i = 0; i < 400; ++i) records.push_back(random_record(rng, 100'000));
    for (const bool is_stopped : {false, true}) {
        DeviceConfig config = bench_config();
        config.memory_lines = 1'000;
        config.cycles_per_line = 20;
        EmulatedDevice device = emulated_device(config).value();
        Driver driver = open_device(port_with_companion(device)).value();
        const SlotNumber tool = load_tool(driver, holder).value();
        if (is_stopped) driver.port.write(address_of(Register::watchdog), 1);
        uint32_t count = 0;
        for (; count < 20; ++count) {
            const auto work = load_records(driver, Side::work, records);
            ASSERT_TRUE(work) << count;
            EXPECT_TRUE(push(driver, {{0, 0, 900}, {9, 9, 900}, {{tool, *work, 1.0}}}));
            unload(driver, *work);
        }
        if (is_stopped) {
            driver.port.write(address_of(Register::watchdog), 0);
            recover(driver);
            const SlotNumber work = load_records(driver, Side::work, records).value();
            EXPECT_EQ(push(driver, {{0, 0, 900}, {9, 9, 900}, {{tool, work, 1.0}}}).value(), 1U);
            count = 1;
        }
        EXPECT_EQ(wait_for_all(driver).permitted, count);
    }
}

TEST(Driver, FeelsForTheHostWhileASlowMemoryTakesItsLines) {
    DeviceConfig config = bench_config();
    config.cycles_per_line = 1'000;
    EmulatedDevice device = emulated_device(config).value();
    Driver driver = open_device(port_with_companion(device)).value();
    driver.port.write(address_of(Register::watchdog), 50'000);
    const SlotNumber tool = load_tool(driver, holder).value();
    const SlotNumber work = load_stock(driver, raw.uncut(1.0)).value();
    EXPECT_EQ(push(driver, {{0, 0, 2}, {9, 9, 2}, {{tool, work, 1.0}}}).value(), 1U);
    EXPECT_EQ(wait_for_all(driver).permitted, 1U);
    EXPECT_GT(device.state.cycle, 100'000U);
}

TEST(Driver, GivesTheLinesOfAStockBackWhenItIsTakenOut) {
    FunctionalDevice device = functional_device(bench_config()).value();
    Driver driver = open_device(port_of(device)).value();
    const SlotNumber tool = load_tool(driver, holder).value();
    for (int i = 0; i < 500; ++i) {
        const auto stock = load_stock(driver, raw.uncut(1.0));
        ASSERT_TRUE(stock) << i;
        unload(driver, *stock);
        EXPECT_FALSE(update_stock(driver, *stock, raw.uncut(1.0)));
    }
    EXPECT_FALSE(update_stock(driver, tool, raw.uncut(1.0)));
    EXPECT_FALSE(update_stock(driver, SlotNumber{30}, raw.uncut(1.0)));
    unload(driver, SlotNumber{30});
    EXPECT_EQ(driver.slots.size(), 2U);
}

} // namespace
} // namespace hwsim
