#include <map>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/coproc/device_judge.h"
#include "app/coproc/study/coprocessor_report.h"
#include "hwsim/coprocessor.h"
#include "hwsim/driver.h"
#include "hwsim/vcd_trace.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

const std::string assets = FEELER_SOURCE_DIR "/assets/";

core::MotionTime hop(double seconds, double length) {
    const double peak = 2.0 * length / seconds;
    return {.duration = seconds,
            .length = length,
            .cruise = peak,
            .acceleration = 2.0 * peak / seconds};
}

TEST(PermitTiming, RequestsABlockWhenTheControlHasMadeItsLines) {
    const std::vector<core::PermitMotion> plan = {
        {hop(1.0, 10), 0}, {hop(1.0, 10), 1}, {hop(1.0, 10), 2}};
    const PermitTiming timing =
        timed_with_permits(plan, std::vector<BlockService>(3, {.seconds = 0.1, .making = 0.5}), {});
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(timing.blocks[i].asked, 0.5 + 0.5 * static_cast<double>(i), 0.002);
        EXPECT_NEAR(timing.blocks[i].permitted, timing.blocks[i].asked + 0.1, 1e-9);
    }
    EXPECT_NEAR(timing.making, 1.5, 1e-9);
    EXPECT_GT(timing.taken, 3.5); // the first block waits for the control
}

TEST(PermitTiming, WaitsForALateDeviceAndContinues) {
    const std::vector<core::PermitMotion> plan = {
        {hop(1.0, 10), 0}, {hop(1.0, 10), 1}, {hop(1.0, 10), 2}};
    const PermitTiming quick = timed_with_permits(plan, {{1e-6}, {1e-6}, {1e-6}}, {});
    EXPECT_NEAR(quick.planned, 3.0, 1e-9);
    EXPECT_NEAR(quick.taken, 3.0, 0.003);
    EXPECT_EQ(quick.missed, 0U);
    EXPECT_FALSE(quick.refused);
    const PermitTiming slow =
        timed_with_permits(plan, {{0.5, false, 0.5}, {2.0, false, 2.0}, {0.1, false, 0.1}}, {});
    EXPECT_EQ(slow.missed, 1U);
    EXPECT_EQ(slow.tightest, 1U);
    EXPECT_NEAR(slow.taken, 2.5 + 2.0, 0.005) << "the second begins at 2.5 s";
    EXPECT_NEAR(slow.blocks[1].permitted, 2.5, 0.002);
}

TEST(PermitTiming, TakesBlocksThatOverlapInTheDeviceForNoLongerThanTheyDid) {
    const std::vector<core::PermitMotion> plan = {
        {hop(1.0, 10), 0}, {hop(1.0, 10), 1}, {hop(1.0, 10), 2}};
    const PermitTiming made =
        timed_with_permits(plan, {{0.5, false, 0.5}, {0.6, false, 0.1}, {1.5, false, 0.1}}, {});
    EXPECT_NEAR(made.blocks[0].permitted, 0.5, 1e-9);
    EXPECT_NEAR(made.blocks[1].permitted, 0.6, 1e-9);
    EXPECT_NEAR(made.blocks[2].permitted, 1.5, 1e-9) << "the time that it spends in the device";
    EXPECT_NEAR(made.busy, 0.7, 1e-9);
    EXPECT_EQ(made.missed, 0U);
}

TEST(PermitTiming, RequestsNoFartherAheadThanTheControlReads) {
    std::vector<core::PermitMotion> plan;
    for (uint32_t i = 0; i < 20; ++i) plan.push_back({hop(1.0, 10), i});
    const PermitTiming timing =
        timed_with_permits(plan, std::vector<BlockService>(20), {.look_ahead = 4});
    for (size_t i = 0; i < 5; ++i) EXPECT_EQ(timing.blocks[i].asked, 0.0);
    for (size_t i = 5; i < 20; ++i)
        EXPECT_NEAR(timing.blocks[i].asked, timing.blocks[i - 4].entered, 0.0021) << i;
}

TEST(PermitTiming, StopsBeforeARefusedBlockUnlessTheOperatorAllowsIt) {
    const std::vector<core::PermitMotion> plan = {{hop(1.0, 10), 0}, {hop(1.0, 10), 2}};
    const std::vector<BlockService> services = {{1e-6}, {1e-6}, {1e-6, true}};
    const PermitTiming stands = timed_with_permits(plan, services, {});
    EXPECT_EQ(stands.refused, 2U);
    EXPECT_NEAR(stands.taken, 1.0, 0.1) << "it brakes before the block";
    EXPECT_EQ(stands.blocks[2].entered, core::infinity);
    EXPECT_FALSE(timed_with_permits(plan, services, {}, true).refused);
}

TEST(PermitTiming, RequestsBlocksWithoutMotionAfterTheLastMotion) {
    const std::vector<core::PermitMotion> plan = {{hop(1.0, 10), 0}};
    const ControlConfig short_sighted{.look_ahead = 1};
    std::vector<BlockService> services(5, {1e-6, false, 1e-6});
    const PermitTiming all = timed_with_permits(plan, services, short_sighted);
    EXPECT_FALSE(all.refused);
    EXPECT_LT(all.blocks[4].permitted, 1.1);
    EXPECT_NEAR(all.busy, 5e-6, 1e-12);
    services[3].refused = true;
    EXPECT_EQ(timed_with_permits(plan, services, short_sighted).refused, 3U);
    EXPECT_FALSE(timed_with_permits(plan, services, short_sighted, true).refused);
    const PermitTiming nothing_moves = timed_with_permits({}, services, short_sighted);
    EXPECT_EQ(nothing_moves.taken, 0.0);
    EXPECT_EQ(nothing_moves.refused, 3U);
}

CoprocessorJob plate(const std::string& program) {
    CoprocessorJob job;
    job.check.program = assets + "programs/" + program;
    job.check.setup = assets + "setups/clamped_plate.toml";
    job.check.detail = core::Detail::every_pair;
    return job;
}

TEST(TimeText, HasASuitableUnit) {
    EXPECT_EQ(time_text(31.5e-6), "31.5 us");
    EXPECT_EQ(time_text(-2.1e-3), "-2.1 ms");
    EXPECT_EQ(time_text(3.4), "3.40 s");
    EXPECT_EQ(time_text(179.7), "3 min 00 s");
    EXPECT_EQ(time_text(-725.0), "-12 min 05 s");
}

TEST(CoprocessorRun, RefusesWhatTheExactEngineDoesAndCountsTheSameEachTime) {
    CoprocessorJob job = plate("clamped_plate_low.nc");
    job.other_elements = {1};
    const auto run = run_with_coprocessor(job);
    ASSERT_TRUE(run.has_value());
    ASSERT_EQ(run->blocks.size(), run->check.blocks.size());
    EXPECT_EQ(agreement(*run).missed, 0U);
    EXPECT_EQ(agreement(*run).not_queried, 0U);
    for (const size_t block : {38U, 39U, 41U, 42U})
        EXPECT_FALSE(run->blocks[block].permit.permitted) << block;
    EXPECT_TRUE(run->blocks[20].permit.permitted);
    double planned = 0.0;
    for (const core::PermitMotion& motion : run->plan) planned += motion.time.duration;
    EXPECT_NEAR(planned, run->check.cycle_time, 1e-6);
    const auto again = run_with_coprocessor(job);
    ASSERT_TRUE(again.has_value());
    for (size_t i = 0; i < run->blocks.size(); ++i)
        EXPECT_EQ(again->blocks[i].cycles, run->blocks[i].cycles) << i;
    EXPECT_EQ(again->totals.counters, run->totals.counters);
}

/// The device's results for a short program on a bare machine with one tool.
CoprocessorRun beside_a_block(const test_support::ScopedFolder& folder, const std::string& lines) {
    CoprocessorJob job;
    job.check.setup = folder.write("setup.toml", R"(
[program]
dialect = "fanuc"
start = { X = 0, Y = 0, Z = 100 }
[stock]
box = [[-20, -20, -20], [20, 20, 0]]
frame = "machine"
[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 15
shank = [[10, 10, 25]]
spindle = "clockwise"
cuts_at_centre = false
)");
    job.check.program = folder.write("program.nc", "G21 G90 G17\n" + lines + "M2\n");
    job.check.detail = core::Detail::every_pair;
    auto run = run_with_coprocessor(job);
    EXPECT_TRUE(run.has_value());
    return run ? *std::move(run) : CoprocessorRun{};
}

TEST(CoprocessorRun, RefusesToPushAToolsCentreIntoTheStock) {
    const test_support::ScopedFolder folder;
    const CoprocessorRun down =
        beside_a_block(folder, "T1 M6\nG43 H1\nS1000 M3\nG0 X0 Y0 Z5\nG1 Z-5 F100\nG0 Z20\n");
    EXPECT_EQ(agreement(down).violations, 1U);
    EXPECT_EQ(agreement(down).missed, 0U);
    EXPECT_EQ(agreement(down).refused, 1U);
    const CoprocessorRun ramp = beside_a_block(
        folder, "T1 M6\nG43 H1\nS1000 M3\nG0 X0 Y0 Z5\nG1 Z0 F100\nX14 Z-0.5\nX0\nG0 Z20\n");
    EXPECT_EQ(agreement(ramp).violations, 0U);
    EXPECT_EQ(agreement(ramp).refused, 0U);
}

TEST(CoprocessorRun, PermitsNothingToAnUnknownTool) {
    const test_support::ScopedFolder folder;
    const CoprocessorRun run =
        beside_a_block(folder, "T7 M6\nG0 X0 Y0 Z50\nG1 Z40 F100\nT1 M6\nG0 Z60\n");
    std::vector<bool> permitted;
    for (const DeviceBlock& block : run.blocks) permitted.push_back(block.permit.permitted);
    EXPECT_EQ(permitted, (std::vector<bool>{true, true, false, false, true, true, true}));
}

TEST(CoprocessorRun, RefusesToTouchWhereRoundedCornersLeaveTheWayOpen) {
    const test_support::ScopedFolder folder;
    const std::string cut = "T1 M6\nG43 H1\nS1000 M3\nG64 P0.5\nG0 X-30 Y0 Z5\nZ-2\nG1 X0 F100\n";
    const CoprocessorRun back_in_its_slot = beside_a_block(folder, cut + "G0 X-20\nZ5\n");
    const CoprocessorRun back_as_it_cut = beside_a_block(folder, cut + "G1 X-20\nG0 Z5\n");
    constexpr size_t back = 8;
    ASSERT_EQ(back_in_its_slot.blocks.size(), 11U);
    EXPECT_EQ(back_in_its_slot.check.blocks[back].result.verdict, core::Verdict::undecided);
    EXPECT_FALSE(back_in_its_slot.blocks[back].permit.permitted);
    EXPECT_EQ(agreement(back_in_its_slot).refused, 1U);
    EXPECT_EQ(back_as_it_cut.check.blocks[back].result.verdict, core::Verdict::clear);
    EXPECT_EQ(agreement(back_as_it_cut).refused, 0U);
}

TEST(CoprocessorRun, AFasterDeviceKeepsUpWhereASlowOneDoesNot) {
    const auto run = run_with_coprocessor(plate("clamped_plate.nc"));
    ASSERT_TRUE(run.has_value());
    const PermitTiming fast = timed_with_permits(run->plan, services_of(*run, 100, {}), {}, true);
    EXPECT_EQ(fast.missed, 0U);
    EXPECT_NEAR(fast.taken, fast.planned, 0.01);
    std::vector<BlockService> slow = services_of(*run, 1, {});
    for (BlockService& service : slow) {
        service.seconds *= 1e4;
        service.interval *= 1e4;
    }
    const PermitTiming late = timed_with_permits(run->plan, slow, {}, true);
    EXPECT_GT(late.missed, 0U);
    EXPECT_GT(late.taken, late.planned + 1.0);
    ASSERT_TRUE(late.tightest);
    EXPECT_LT(late.blocks[*late.tightest].slack(), 0.0);
}

TEST(CoprocessorRun, KeepsWhatTheDeviceHadCountedAfterEachBlock) {
    const auto run = run_with_coprocessor(plate("clamped_plate_low.nc"));
    ASSERT_TRUE(run.has_value());
    DeviceTotals before;
    for (const DeviceBlock& block : run->blocks) {
        const auto counted = [&](hwsim::Counter c) { return block.after[c] - before[c]; };
        EXPECT_EQ(counted(hwsim::Counter::nodes), block.nodes);
        EXPECT_EQ(counted(hwsim::Counter::pair_tests), block.pairs);
        const DeviceUse shares = use_between(before, block.after, {});
        EXPECT_GE(shares.busy, 0.0);
        EXPECT_LE(shares.busy, 1.0);
        EXPECT_LE(shares.memory + shares.ports + shares.order, 1.0);
        EXPECT_EQ(block.permit.report.stop, block.permit.stop);
        before = block.after;
    }
    EXPECT_EQ(run->blocks[38].permit.report.stop, hwsim::Stop::violation);
    EXPECT_GT(run->blocks[38].permit.report.stop_sequence, run->blocks[38].permit.report.permitted);
    EXPECT_EQ(run->blocks.back().after[hwsim::Counter::nodes], run->totals[hwsim::Counter::nodes]);
}

TEST(CoprocessorRun, BeginsInTheMiddleAsACheckDoes) {
    CoprocessorJob job = plate("clamped_plate_low.nc");
    job.check.start_line = "38";
    const auto run = run_with_coprocessor(job);
    ASSERT_TRUE(run.has_value());
    EXPECT_EQ(run->check.blocks.front().line, 38U);
    EXPECT_EQ(run->blocks.size(), run->check.blocks.size());
    EXPECT_EQ(agreement(*run).missed, 0U);
    EXPECT_GT(agreement(*run).violations, 0U);
    job.check.start_line = "9999";
    EXPECT_FALSE(run_with_coprocessor(job));
}

TEST(CoprocessorRun, EndsEarlyOnRequest) {
    CoprocessorJob job = plate("clamped_plate.nc");
    job.check.after_block = [](const CheckProgress& progress) { return progress.blocks < 7; };
    const auto run = run_with_coprocessor(job);
    ASSERT_TRUE(run.has_value());
    EXPECT_EQ(run->check.blocks.size(), 7U);
    EXPECT_EQ(run->blocks.size(), 7U);
}

TEST(VcdTrace, IsAFileOfChanges) {
    hwsim::DeviceConfig config;
    config.elements = 1;
    auto device = hwsim::emulated_device(config);
    ASSERT_TRUE(device.has_value());
    hwsim::VcdTrace trace(config);
    const hwsim::DevicePort port =
        port_of(*device, [&](const hwsim::CoprocessorState& state) { trace.note(state); });
    port.write(hwsim::address_of(hwsim::Register::control), hwsim::control_enable);
    port.wait();
    const std::string& text = trace.text();
    EXPECT_NE(text.find("$enddefinitions $end\n#10000\n"), std::string::npos) << text;
    EXPECT_NE(text.find("\n1!\n"), std::string::npos) << "enabled";
    size_t times = 0;
    for (size_t at = 0; (at = text.find("\n#", at)) != std::string::npos; ++at) ++times;
    EXPECT_EQ(times, 2U) << "the first cycle, and that of the change";
}

TEST(VcdTrace, WritesNoValueWiderThanItsSignal) {
    hwsim::DeviceConfig config;
    config.fifo_depth = config.memory_queue = config.write_queue = 4096;
    config.host_queue = 256;
    config.elements = 64;
    config.threads = 16;
    hwsim::CoprocessorState state = power_up(config);
    for (int i = 0; i < 4096; ++i) {
        state.fifo.entries.push({});
        state.memory.asked.push({});
        state.memory.under_way.push({});
        state.memory.writes.push({});
    }
    while (!state.permits.in_order.full()) state.permits.in_order.push({});
    state.searching = 1024;
    state.permits.stopped = hwsim::Stop::bad_descriptor;
    state.ring.tail = 0xFFFF'FFFF;
    while (!state.ring.under_way.full()) state.ring.under_way.push({});
    for (hwsim::SearchElement& element : state.elements)
        element.busy = element.waiting = element.done = 0xFFFF;
    hwsim::VcdTrace trace(config);
    trace.note(state);
    std::istringstream lines(trace.text());
    std::map<std::string, size_t> bits;
    size_t values = 0;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string first, kind, name;
        size_t width = 0;
        words >> first;
        if (first == "$var" && words >> kind >> width >> name) bits[name] = width;
        if (first[0] != 'b') continue;
        words >> name;
        EXPECT_LE(first.size() - 1, bits.at(name)) << line;
        ++values;
    }
    EXPECT_EQ(bits.size(), 17U + 3 * 64);
    EXPECT_GT(values, 3U * 64);
}

TEST(VcdTrace, KeepsToTheClock) {
    hwsim::DeviceConfig config;
    config.clock_mhz = 300;
    config.elements = 1;
    hwsim::CoprocessorState state = power_up(config);
    state.cycle = 3'000'000'000;
    hwsim::VcdTrace trace(config);
    trace.note(state);
    EXPECT_NE(trace.text().find("\n#10000000000000\n"), std::string::npos) << "ten seconds";
}

TEST(CoprocessorReport, NamesALatencyThatNinetyNineOfAHundredBlocksKeep) {
    CoprocessorResult result;
    result.file.device.clock_mhz = 1;
    for (uint64_t i = 1; i <= 50; ++i) {
        DeviceBlock block;
        block.permit.segments = 1;
        block.cycles = i;
        result.run.blocks.push_back(block);
    }
    const DeviceFigures of_fifty = figures(result);
    EXPECT_NEAR(of_fifty.p50, 25e-6, 1e-12);
    EXPECT_NEAR(of_fifty.p99, 50e-6, 1e-12) << "49 of 50 are less than 99 of 100";
    result.run.blocks.insert(result.run.blocks.end(), 150, result.run.blocks[0]);
    EXPECT_NEAR(figures(result).p99, 48e-6, 1e-12) << "two of 200 are slower";
}

TEST(CoprocessorReport, SaysWhyABlockIsRefused) {
    CoprocessorJob job = plate("clamped_plate_low.nc");
    job.device.search_limit = 1;
    CoprocessorResult result;
    auto run = run_with_coprocessor(job);
    ASSERT_TRUE(run.has_value());
    result.run = *std::move(run);
    result.timing = timed_with_permits(result.run.plan, services_of(result.run, 100, {}), {});
    EXPECT_NE(coprocessor_csv(result).find("too-long: "), std::string::npos);
}

TEST(DeviceFile, ReportsMistakesWithTheirLine) {
    const test_support::ScopedFolder folder;
    const auto error_of = [&](const std::string& text) {
        const auto file = read_device_file(folder.write("device.toml", text));
        return file ? std::string("none") : file.error().message;
    };
    EXPECT_EQ(error_of("[device]\nelements = 4\nclock_mhz = 50\n[control]\nlook_ahead = 8\n"),
              "none");
    EXPECT_NE(error_of("[device]\nelement = 4\n").find("element"), std::string::npos);
    EXPECT_NE(error_of("[device]\nelements = 0\n").find("above 0"), std::string::npos);
    EXPECT_NE(error_of("[device]\nelements = 1000\n"), "none");
    const auto spheres =
        read_device_file(folder.write("device.toml", "[device]\nvolumes = \"spheres\"\n"));
    ASSERT_TRUE(spheres.has_value());
    EXPECT_EQ(spheres->device.volumes, hwsim::Volumes::spheres);
    EXPECT_NE(error_of("[device]\nvolumes = \"cones\"\n").find("spheres"), std::string::npos);
    for (const char* line : {"servo_period = -1", "servo_period = 1e-9", "feed_override = 0",
                             "feed_override = 1e-9", "io_latency = -0.1"})
        EXPECT_NE(error_of(fmt::format("[control]\n{}\n", line)).find("must be from"),
                  std::string::npos)
            << line;
    EXPECT_EQ(error_of("[control]\nio_latency = 0\n[energy]\nidle_watts = 0\n"), "none");
    EXPECT_NE(error_of("[energy]\nidle_watts = -1\n").find("must be from"), std::string::npos);
    EXPECT_NE(error_of("[device]\nnode_cache_lines = 1073741824\n").find("caches"),
              std::string::npos);
    EXPECT_NE(error_of("device\n"), "none");
}

} // namespace
} // namespace app
