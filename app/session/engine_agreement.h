#pragma once

#include "app/session/coprocessor_check.h"

namespace app {

/// How the answers of a coprocessor stand to those of the exact engine, in blocks.
struct EngineAgreement {
    size_t blocks = 0;
    size_t violations = 0;   // violations and collisions by the exact engine
    size_t refused = 0;      // by the device
    size_t not_asked = 0;    // of these, motions that the device cannot be asked
    size_t missed = 0;       // violations that the device permitted
    size_t undecided = 0;    // refused, and undecided by the exact engine
    size_t false_alarms = 0; // refused, and clear by the exact engine

    bool operator==(const EngineAgreement&) const = default;
};

/// Counts a block.
void add(EngineAgreement& agreement, const BlockPermit& permit, const core::BlockResult& exact);

} // namespace app
