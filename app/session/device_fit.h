#pragma once

#include "app/session/coprocessor_run.h"
#include "app/session/permit_timing.h"

namespace app {

/// A device that would have been fast enough.
struct DeviceFit {
    uint32_t elements = 0;
    std::optional<uint32_t> clock_mhz; // the least of `clocks`; empty: none of them
};

/// What clocks are tried, MHz.
constexpr std::array<uint32_t, 12> clocks = {1, 2, 5, 10, 20, 25, 50, 75, 100, 150, 200, 300};

/// What numbers of elements are.
constexpr std::array<uint32_t, 5> tried_elements = {1, 2, 4, 8, 16};

/// How long a device at this clock takes for each block.
std::vector<BlockService> services_of(const CoprocessorRun& run, uint32_t clock_mhz);

/// For each number of elements that was emulated the least clock with which no permit would have
/// been late.
std::vector<DeviceFit> least_clocks(const CoprocessorRun& run, const ControlConfig& control);

/// The one of them that needs the fewest elements times clock.
std::optional<DeviceFit> smallest(const std::vector<DeviceFit>& fits);

} // namespace app
