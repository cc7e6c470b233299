#include "app/session/device_fit.h"

#include <algorithm>

namespace app {
namespace {

BlockService service_of(const BlockCycles& cycles, uint32_t clock_mhz) {
    const auto seconds = [&](uint64_t count) {
        return static_cast<double>(count) / (1e6 * clock_mhz);
    };
    return {.seconds = seconds(cycles.latency), .interval = seconds(cycles.interval)};
}

/// Whether no permit is late, where the machine never has to wait.
bool keeps_up(const std::vector<BlockTiming>& undisturbed, const std::vector<BlockCycles>& cycles,
              uint32_t clock_mhz) {
    double permitted = 0.0;
    for (size_t i = 0; i < undisturbed.size(); ++i) {
        permitted = permit_time(service_of(cycles[i], clock_mhz), undisturbed[i].asked, permitted);
        if (permitted > undisturbed[i].due) return false;
    }
    return true;
}

} // namespace

std::vector<BlockService> services_of(const CoprocessorRun& run, uint32_t clock_mhz) {
    std::vector<BlockService> services;
    for (const DeviceBlock& block : run.blocks) {
        services.push_back(service_of({block.cycles, block.interval}, clock_mhz));
        services.back().refused = !block.permit.permitted;
    }
    return services;
}

std::vector<DeviceFit> least_clocks(const CoprocessorRun& run, const ControlConfig& control) {
    if (run.cycles_by_elements.empty()) return {};
    const std::vector<BlockService> at_once(run.blocks.size());
    const std::vector<BlockTiming> undisturbed =
        timed_with_permits(run.plan, at_once, control).blocks;
    std::vector<DeviceFit> fits;
    for (const auto& [elements, cycles] : run.cycles_by_elements) {
        const auto enough = std::find_if(clocks.begin(), clocks.end(), [&](uint32_t clock) {
            return keeps_up(undisturbed, cycles, clock);
        });
        fits.push_back({elements, enough == clocks.end() ? std::nullopt : std::optional(*enough)});
    }
    return fits;
}

std::optional<DeviceFit> smallest(const std::vector<DeviceFit>& fits) {
    std::optional<DeviceFit> best;
    for (const DeviceFit& fit : fits) {
        if (!fit.clock_mhz) continue;
        if (!best || fit.elements * *fit.clock_mhz < best->elements * *best->clock_mhz) best = fit;
    }
    return best;
}

} // namespace app
