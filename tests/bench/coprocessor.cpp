// Prints the tables of hwsim/README.md: the performance of devices of various sizes in their own
// cycles, so that the tables are the same on every machine. With --speed the speed of the emulator
// and of the functional model on this machine; with --volumes the comparison with the paper's
// spheres (some minutes).

#include <ctime>
#include <string_view>

#include <fmt/format.h>

#include "tests/bench/scene_device.h"
#include "tests/bench/volume_table.h"

namespace {

using Scene = bench::MachiningScene;
using hwsim::DeviceConfig;

struct Measured {
    double cycles = 0.0;  // from permit to permit, with a full FIFO
    double latency = 0.0; // from push to permit of a single segment
    double nodes = 0.0, pairs = 0.0, hits = 0.0, lines = 0.0; // per segment
    double speed = 0.0; // cycles of the device per second on this processor
};

using hwsim::Counter;

Measured measured(const Scene& scene, const DeviceConfig& config, uint32_t leaf_size = 4) {
    bench::SceneDevice bench(config);
    bench.segments = load(bench.driver, scene, leaf_size);
    Measured result{.latency = bench.run_alone()};
    const uint64_t cycle = bench.cycle();
    const std::clock_t begin = std::clock();
    result.cycles = bench.run();
    result.speed = static_cast<double>(bench.cycle() - cycle) * CLOCKS_PER_SEC
                   / static_cast<double>(std::max<std::clock_t>(std::clock() - begin, 1));
    if (report(bench.driver).stop != hwsim::Stop::none)
        fmt::print(stderr, "{}: a segment was refused, so what follows says nothing\n", scene.name);
    const bench::SearchWork work = bench.work();
    result.nodes = work.nodes;
    result.pairs = work.pairs;
    result.lines = work.lines;
    const double hits = bench.counted(Counter::node_hits);
    result.hits = hits / std::max(hits + bench.counted(Counter::node_misses), 1.0);
    return result;
}

/// One row: a name, then cycles per segment in each scene.
template <typename Value>
void row(const std::string& name, const std::vector<Scene>& scenes, const DeviceConfig& config,
         uint32_t leaf_size, const Value& value) {
    fmt::print("| {} |", name);
    for (const Scene& scene : scenes)
        fmt::print(" {} |", value(measured(scene, config, leaf_size)));
    fmt::print("\n");
}

void head(const char* title, const std::vector<Scene>& scenes) {
    fmt::print("\n| {} |", title);
    for (const Scene& scene : scenes) fmt::print(" {} |", scene.name);
    fmt::print("\n|---|");
    for (size_t i = 0; i < scenes.size(); ++i) fmt::print("---|");
    fmt::print("\n");
}

std::string both(const Measured& m) { return fmt::format("{:.0f} / {:.0f}", m.latency, m.cycles); }

DeviceConfig bench_config() { return {.memory_lines = 1U << 19}; }

void parts_table(const std::vector<Scene>& scenes) {
    head("elements x threads: cycles alone / pipelined", scenes);
    for (const uint32_t elements : {1U, 2U, 4U, 8U, 16U})
        for (const uint32_t threads : {1U, 4U, 8U}) {
            if (threads != 4 && elements != 1 && elements != 8) continue;
            DeviceConfig config = bench_config();
            config.elements = elements;
            config.threads = threads;
            row(fmt::format("{} x {}", elements, threads), scenes, config, 4, both);
        }
}

void memory_table(const std::vector<Scene>& scenes) {
    head("memory: latency, cycles a line", scenes);
    for (const auto& [latency, line] : {std::pair{10U, 1U}, {30U, 2U}, {60U, 2U}, {30U, 8U}}) {
        DeviceConfig config = bench_config();
        config.memory_latency = latency;
        config.cycles_per_line = line;
        row(fmt::format("{}, {}", latency, line), scenes, config, 4, both);
    }
    head("lines of node cache: cycles, hits", scenes);
    for (const uint32_t lines : {16U, 64U, 256U, 1024U}) {
        DeviceConfig config = bench_config();
        config.node_cache_lines = lines;
        row(fmt::format("{}", lines), scenes, config, 4, [](const Measured& m) {
            return fmt::format("{:.0f}, {:.0f} %", m.cycles, 100.0 * m.hits);
        });
    }
}

/// Memory latency and time per line in nanoseconds: given by the board, whatever the clock of the
/// device.
constexpr uint32_t memory_ns = 300, line_ns = 20, host_ns = 600, host_line_ns = 40;

/// A device with memory times in nanoseconds.
DeviceConfig clocked(uint32_t elements, uint32_t clock_mhz) {
    const auto cycles = [clock_mhz](uint32_t ns) { return (ns * clock_mhz + 999) / 1000; };
    DeviceConfig config = bench_config();
    config.elements = elements;
    config.clock_mhz = clock_mhz;
    config.memory_latency = cycles(memory_ns);
    config.cycles_per_line = cycles(line_ns);
    config.host_latency = cycles(host_ns);
    config.host_cycles_per_line = cycles(host_line_ns);
    return config;
}

/// Million segments per second in each scene, by elements and clock.
void clock_table(const std::vector<Scene>& scenes) {
    constexpr std::array<uint32_t, 4> clocks{50, 100, 150, 200};
    fmt::print("\n| elements: {}", scenes[0].name);
    for (size_t i = 1; i < scenes.size(); ++i) fmt::print(" / {}", scenes[i].name);
    for (const uint32_t clock : clocks) fmt::print(" | {} MHz", clock);
    fmt::print(" |\n|---|---|---|---|---|\n");
    for (const uint32_t elements : {1U, 2U, 4U, 8U, 16U}) {
        fmt::print("| {} |", elements);
        for (const uint32_t clock : clocks) {
            const DeviceConfig config = clocked(elements, clock);
            const char* between = " ";
            for (const Scene& scene : scenes) {
                fmt::print("{}{:.2f}", between, clock / measured(scene, config).cycles);
                between = " / ";
            }
            fmt::print(" |");
        }
        fmt::print("\n");
    }
}

void leaf_table(const std::vector<Scene>& scenes) {
    head("records to a leaf of the work: cycles, nodes, pairs", scenes);
    for (const uint32_t leaf : {1U, 2U, 4U, 8U, 16U})
        row(fmt::format("{}", leaf), scenes, bench_config(), leaf, [](const Measured& m) {
            return fmt::format("{:.0f}, {:.0f}, {:.0f}", m.cycles, m.nodes, m.pairs);
        });
}

void speed_table(const std::vector<Scene>& scenes) {
    head("elements: million cycles a second emulated", scenes);
    for (const uint32_t elements : {1U, 4U, 8U}) {
        DeviceConfig config = bench_config();
        config.elements = elements;
        row(fmt::format("{}", elements), scenes, config, 4,
            [](const Measured& m) { return fmt::format("{:.1f}", m.speed / 1e6); });
    }
}

/// Microseconds per segment that the functional model takes on this processor.
double time_on_a_core(const Scene& scene) {
    auto device = hwsim::functional_device(bench_config()).value();
    hwsim::Driver driver = hwsim::open_device(port_of(device)).value();
    const auto segments = bench::load(driver, scene, 4);
    size_t count = 0;
    const std::clock_t begin = std::clock();
    for (; std::clock() - begin < CLOCKS_PER_SEC; count += segments.size())
        for (const hwsim::PathSegment& s : segments) push(driver, s).value();
    return 1e6 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC
           / static_cast<double>(count);
}

void core_table(const std::vector<Scene>& scenes) {
    head("microseconds a segment", scenes);
    fmt::print("| one core, functional model |");
    for (const Scene& scene : scenes) fmt::print(" {:.2f} |", time_on_a_core(scene));
    fmt::print("\n");
}

} // namespace

int main(int count, char** words) {
    const std::vector<Scene> scenes = bench::machining_scenes();
    if (count > 1 && std::string_view(words[1]) == "--speed") {
        speed_table(scenes);
        core_table(scenes);
        return 0;
    }
    if (count > 1 && std::string_view(words[1]) == "--volumes")
        return bench::print_volumes(scenes) ? 0 : 1;
    head("work", scenes);
    row("nodes, pairs, lines from memory per segment", scenes, bench_config(), 4,
        [](const Measured& m) {
            return fmt::format("{:.0f}, {:.0f}, {:.1f}", m.nodes, m.pairs, m.lines);
        });
    parts_table(scenes);
    memory_table(scenes);
    leaf_table(scenes);
    clock_table(scenes);
    return 0;
}
