#include "app/session/coprocessor_result.h"

namespace app {
namespace {

std::optional<double> share(uint64_t part, uint64_t whole) {
    if (whole == 0) return {};
    return static_cast<double>(part) / static_cast<double>(whole);
}

} // namespace

CoprocessorResult in_time(CoprocessorRun run, const DeviceFile& file, bool past_refusals) {
    CoprocessorResult result;
    result.timing = timed_with_permits(run.plan, services_of(run, file.device.clock_mhz),
                                       file.control, past_refusals);
    result.fits = least_clocks(run, file.control);
    result.file = file;
    result.run = std::move(run);
    return result;
}

DeviceShares shares_between(const DeviceTotals& before, const DeviceTotals& after,
                            const hwsim::DeviceConfig& device) {
    using hwsim::Counter;
    const auto counted = [&](Counter counter) { return after[counter] - before[counter]; };
    const uint64_t threads = counted(Counter::busy) * device.threads;
    const auto hits = [&](Counter hit, Counter miss) {
        return share(counted(hit), counted(hit) + counted(miss));
    };
    return {share(counted(Counter::busy), counted(Counter::cycles) * device.elements).value_or(0.0),
            share(counted(Counter::wait_memory), threads).value_or(0.0),
            share(counted(Counter::wait_port), threads).value_or(0.0),
            share(counted(Counter::wait_retire), threads).value_or(0.0),
            hits(Counter::node_hits, Counter::node_misses),
            hits(Counter::record_hits, Counter::record_misses)};
}

} // namespace app
