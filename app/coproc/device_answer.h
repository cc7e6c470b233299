#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/sim/clearance.h"
#include "hwsim/registers.h"

namespace app {

/// A pair of bodies that the coprocessor checked in a block.
struct QueriedPair {
    core::Pair pair;
    core::Allowance allowance;
    bool refused = false;
    double lower = core::infinity; // lower bound of the clearance, if it was measured
    bool may_overlap = false;      // their models overlapped
};

/// The answer of the coprocessor for a block.
struct BlockPermit {
    bool permitted = true; // also if nothing moves
    size_t segments = 0;   // number of questions
    hwsim::Stop stop = hwsim::Stop::none;
    std::optional<core::Pair> pair; // the refused pair
    std::string not_queried;        // why a motion could not be checked; it is then not permitted
    bool is_reported = false;       // a finding of the run gives the same reason
    std::string doubt; // why nothing is proven, as the run reports; it is then not permitted
    std::vector<QueriedPair> pairs; // every pair once
    hwsim::DeviceReport report;     // of the device, before a stop is cleared

    bool is_checked() const { return not_queried.empty() && doubt.empty(); }
};

/// A block whose questions are in the device.
struct PushedBlock {
    BlockPermit permit = {};            // results before the answers
    uint32_t first = 0;                 // number of its first segment
    std::vector<core::Pair> asked = {}; // by segment, in order
};

/// Sums since reset, in the device's own counters.
struct DeviceTotals {
    std::array<uint64_t, hwsim::counter_count> counters{};

    uint64_t operator[](hwsim::Counter counter) const {
        return counters[static_cast<size_t>(counter)];
    }
};

/// What the coprocessor did for a block.
struct DeviceBlock {
    BlockPermit permit;
    uint64_t cycles = 0;   // from the first word of the stock or the block to its permit
    uint64_t interval = 0; // of these, those after the permit of the previous block
    uint64_t nodes = 0;    // visited in both trees
    uint64_t pairs = 0;    // of records compared
    uint64_t lines = 0;    // that the host made for it
    DeviceTotals after;    // at its permit; those of the previous block if nothing was asked
};

/// The blocks in a device: the oldest without an answer, and the newest.
struct BlocksInDevice {
    size_t oldest = 0, newest = 0;
};

} // namespace app
