#include <gtest/gtest.h>

#include "tests/hwsim/search_oracle.h"
#include "tests/hwsim/test_device.h"

namespace hwsim {
namespace {

/// A device whose memories fail at random moments, while faults are on.
class FailingDevice {
public:
    FailingDevice(uint32_t seed, const DeviceConfig& config)
        : random_(seed), device_(emulated_device(config).value()) {}

    DevicePort port() {
        return port_with_companion(device_, [this](const CoprocessorState&) {
            if (is_failing_) fail();
        });
    }
    void set_failing(bool is_failing) {
        is_failing_ = is_failing;
        device_.state.memory.stalled = device_.state.ring.stalled = false;
    }
    bool is_failing() const { return is_failing_; }

private:
    void fail() {
        CoprocessorState& s = device_.state;
        if (random_() % 2'000 == 0)
            s.memory.lines[random_() % 400].word[random_() % 16] ^= 1U << (random_() % 32);
        if (random_() % 10'000 == 0) s.memory.stalled = true;
        if (s.memory.stalled && random_() % 3'000 == 0) s.memory.stalled = false;
        // In the ring, near its end; what is wrong in the images of lines stays wrong.
        const uint32_t number = s.ring.tail + random_() % 3 - 2;
        if (random_() % 1'000 == 0)
            s.shared.lines[number % (1U << Driver::log2_ring_size)].word[random_() % 16] ^=
                1U << (random_() % 32);
        if (random_() % 20'000 == 0) s.ring.stalled = true;
    }

    std::mt19937 random_;
    EmulatedDevice device_;
    bool is_failing_ = false;
};

DeviceConfig random_config(std::mt19937& rng) {
    const auto one_of = [&](std::initializer_list<uint32_t> values) {
        return *(values.begin() + rng() % values.size());
    };
    if (rng() % 3 == 0) {
        DeviceConfig config = small_config();
        config.memory_latency = one_of({1, 2, 30});
        config.cycles_per_line = one_of({1, 2, 7});
        config.host_latency = one_of({1, 3, 60});
        config.host_cycles_per_line = one_of({1, 4});
        return config;
    }
    return {.elements = one_of({1, 2, 5}),
            .threads = one_of({1, 2, 7}),
            .node_cache_lines = one_of({1, 2, 16}),
            .record_cache_lines = one_of({1, 4}),
            .fifo_depth = one_of({1, 2, 3, 32}),
            .memory_lines = 1U << 12,
            .memory_latency = one_of({1, 2, 30}),
            .cycles_per_line = one_of({1, 2, 7}),
            .memory_queue = one_of({1, 2, 64}),
            .write_queue = one_of({1, 3, 16}),
            .host_latency = one_of({1, 3, 60}),
            .host_cycles_per_line = one_of({1, 4}),
            .host_queue = one_of({1, 2, 16}),
            .memory_limit = 2'000};
}

std::vector<Record> cloud(std::mt19937& rng) {
    std::vector<Record> records(1 + rng() % 30);
    for (Record& record : records) {
        record = random_record(rng, 1'000);
        record.run /= 20;
        record.half /= 20;
    }
    return records;
}

/// A job on a device that fails, and what came of it.
struct FailingJob {
    std::mt19937 rng;
    FailingDevice device;
    Driver driver;
    std::vector<Record> tool_records, work_records;
    SlotNumber tool, work;
    std::array<size_t, stop_count> stops{};
    size_t permitted = 0;

    explicit FailingJob(uint32_t seed)
        : rng(seed),
          device(seed, random_config(rng)),
          driver(open_device(device.port()).value()),
          tool_records(cloud(rng)),
          work_records(cloud(rng)),
          tool(load_records(driver, Side::tool, tool_records).value()),
          work(load_records(driver, Side::work, work_records).value()) {
        set_failing(false);
    }

    void set_failing(bool is_failing) {
        device.set_failing(is_failing);
        driver.port.write(address_of(Register::watchdog), 100'000);
    }

    /// Pushes a short way from anywhere to near it.
    Segment push_any() {
        const FixedVec start = random_place(rng, 1'500), by = random_place(rng, 300);
        Segment s{.log2_steps = 2, .start = start, .end = start};
        PathSegment path;
        for (size_t axis = 0; axis < 3; ++axis) {
            s.end[axis] += by[axis];
            path.from[static_cast<int>(axis)] = length_of(s.start[axis]);
            path.to[static_cast<int>(axis)] = length_of(s.end[axis]);
        }
        const double length = glm::length(path.to - path.from);
        path.sample_step = 0.2501 * length + lsb;
        while (s.log2_steps > 0 && length <= path.sample_step * (1 << (s.log2_steps - 1)))
            --s.log2_steps;
        path.pairs = {{tool, work, length_of(static_cast<int32_t>(rng() % 60))}};
        s.threshold = threshold(path.pairs[0].distance, length / (1 << s.log2_steps)).value();
        EXPECT_TRUE(push(driver, path));
        return s;
    }

    /// Some segments; true if the device answered them as far as it should.
    bool ask() {
        if (report(driver).stop != Stop::none) recover(driver);
        const uint32_t first = driver.next_sequence;
        std::vector<Segment> asked;
        do {
            asked.push_back(push_any());
            if (rng() % 5 == 0) recover(driver);
            // The host is silent for a moment.
            if (device.is_failing() && rng() % 50 == 0)
                driver.port.write(address_of(Register::watchdog), 1);
        } while (asked.size() < 4 && driver.next_sequence == first + asked.size());
        const DeviceReport now = wait_for_all(driver);
        EXPECT_GE(now.permitted + 1, first) << "permits never fall";
        EXPECT_LE(now.permitted + 1 - first, asked.size());
        for (size_t i = 0; i < now.permitted + 1 - first; ++i, ++permitted) {
            const uint64_t limit = squared_limit(asked[i].threshold);
            EXPECT_EQ(least_of_all(tool_records, work_records, asked[i], limit), limit);
        }
        ++stops[static_cast<size_t>(now.stop)];
        return now.stop == Stop::none || now.stop == Stop::violation;
    }
};

TEST(DriverFault, RecoversFromAnyFaultAtAnyMomentAndPermitsNothingTooNear) {
    std::array<size_t, stop_count> stops{};
    size_t permitted = 0;
    for (uint32_t seed = 0; seed < 150; ++seed) {
        FailingJob job(seed);
        for (int round = 0; round < 20; ++round) {
            job.set_failing(true);
            for (int i = 0; i < 3; ++i) job.ask();
            job.set_failing(false);
            int tries = 0;
            while (!job.ask() && tries < 200) ++tries;
            ASSERT_LT(tries, 200) << seed;
        }
        for (size_t i = 0; i < stops.size(); ++i) stops[i] += job.stops[i];
        permitted += job.permitted;
    }
    EXPECT_GT(permitted, 1'000U);
    for (const Stop stop : {Stop::violation, Stop::bad_check, Stop::memory_stalled,
                            Stop::host_silent, Stop::bad_descriptor})
        EXPECT_GT(stops[static_cast<size_t>(stop)], 20U) << static_cast<int>(stop);
}

} // namespace
} // namespace hwsim
