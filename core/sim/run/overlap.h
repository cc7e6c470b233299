#pragma once

#include <optional>
#include <span>

#include "core/motion/path.h"
#include "core/sim/finding.h"
#include "core/sim/leg/leg_context.h"

namespace core {

struct CutModel;
struct Pair;

/// A leg of a block, with the start of its motion.
struct TimedLeg {
    Leg leg;
    double start = 0.0; // seconds from the block's start
    FluteUse use = FluteUse::not_cutting;
    bool is_rapid = false;
};

/// A block in which bodies overlap.
struct OverlapQuery {
    const Setup& setup;
    const ToolAssembly& tool;
    BlockIndex block;
    std::span<const TimedLeg> legs;
    const CutModel* stock = nullptr; // before the first leg; null: unknown
    bool only_rapids = false;        // the finding is about a rapid of the block
};

/// How deep a pair overlaps in a block; empty if the path is not known well enough, or the stock is
/// not known.
///
/// Result: both bounds are proven for the bodies and the stock as the check models them, over the
///         legs on which the check does not find the pair clear. While the flutes cut, `least`
///         refers to the material left after the leg, `most` to that before.
/// Cost:   some milliseconds for a fixture, some ten for the stock; more for many legs.
std::optional<Overlap> overlap_of(const OverlapQuery& query, const Pair& pair);

} // namespace core
