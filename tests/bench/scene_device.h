#pragma once

#include "hwsim/coprocessor.h"
#include "tests/bench/machining_scenes.h"

namespace bench {

/// Means over all searches of a device since its reset.
struct SearchWork {
    double nodes = 0.0, pairs = 0.0, lines = 0.0; // lines from memory
};

/// An emulated device with a tool, a work, and the segments of a path. It must not move.
struct SceneDevice {
    hwsim::EmulatedDevice device;
    hwsim::Driver driver;
    std::vector<hwsim::PathSegment> segments;

    explicit SceneDevice(const hwsim::DeviceConfig& config);
    SceneDevice(const SceneDevice&) = delete;
    SceneDevice& operator=(const SceneDevice&) = delete;

    uint64_t cycle() const { return device.state.cycle; }
    double counted(hwsim::Counter counter);
    SearchWork work();

    /// Cycles per segment from the first push to the last permit.
    double run();

    /// Cycles per segment from its push to its permit, one after the other.
    double run_alone();

    /// Squared distances of all segments, without a limit; adds the cycles from push to answer.
    std::vector<uint64_t> measure_all(uint64_t& cycles);
};

/// Loads the bodies of a scene as records, with `leaf_size` of them to a leaf of the work. Returns
/// the segments with their pair.
std::vector<hwsim::PathSegment> load(hwsim::Driver& driver, const MachiningScene& scene,
                                     uint32_t leaf_size);

/// These segments with a pair that keeps a distance; waits until the models are loaded.
std::vector<hwsim::PathSegment> with_pair(hwsim::Driver& driver,
                                          std::vector<hwsim::PathSegment> segments,
                                          const hwsim::RequiredPair& pair);

} // namespace bench
