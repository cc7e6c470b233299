#include "tests/bench/scene_device.h"

#include <algorithm>

namespace bench {

using hwsim::Counter;

SceneDevice::SceneDevice(const hwsim::DeviceConfig& config)
    : device(hwsim::emulated_device(config).value()) {
    device.bus_cycles = 1;
    driver = hwsim::open_device(port_of(device)).value();
    write(device.state, device.config, address_of(hwsim::Register::watchdog), 0);
}

double SceneDevice::counted(Counter counter) {
    const uint64_t low = read(device.state, device.config, address_of(counter));
    const uint64_t high = read(device.state, device.config, address_of(counter) + 4);
    return static_cast<double>(low | high << 32);
}

SearchWork SceneDevice::work() {
    const double queries = counted(Counter::queries);
    return {counted(Counter::nodes) / queries, counted(Counter::pair_tests) / queries,
            counted(Counter::lines_read) / queries};
}

double SceneDevice::run() {
    const uint64_t before = cycle();
    for (const hwsim::PathSegment& s : segments) push(driver, s).value();
    wait_for_all(driver);
    return static_cast<double>(cycle() - before) / static_cast<double>(segments.size());
}

double SceneDevice::run_alone() {
    uint64_t cycles = 0;
    for (const hwsim::PathSegment& s : segments) {
        const uint32_t number = push(driver, s).value();
        const uint64_t pushed = cycle();
        while (device.state.permits.permit_sequence != number
               && device.state.permits.stopped == hwsim::Stop::none)
            tick(device.state, device.config);
        cycles += cycle() - pushed;
    }
    return static_cast<double>(cycles) / static_cast<double>(segments.size());
}

std::vector<uint64_t> SceneDevice::measure_all(uint64_t& cycles) {
    std::vector<uint64_t> squares;
    for (hwsim::PathSegment s : segments) {
        s.pairs[0].distance = 0.0; // no limit
        const uint64_t before = cycle();
        squares.push_back(measure(driver, s).value().value().squared);
        cycles += cycle() - before;
    }
    return squares;
}

std::vector<hwsim::PathSegment> load(hwsim::Driver& driver, const MachiningScene& scene,
                                     uint32_t leaf_size) {
    const auto tool = load_tool(driver, scene.body).value();
    driver.leaf_size = leaf_size;
    const auto work = load_stock(driver, scene.stock).value();
    return with_pair(driver, scene.segments, {tool, work, scene.keep});
}

std::vector<hwsim::PathSegment> with_pair(hwsim::Driver& driver,
                                          std::vector<hwsim::PathSegment> segments,
                                          const hwsim::RequiredPair& pair) {
    wait_for_all(driver);
    for (hwsim::PathSegment& s : segments) s.pairs = {pair};
    return segments;
}

} // namespace bench
