#pragma once

#include "core/sim/block_result.h"

namespace core {

struct Setup;
struct SimulatorState;

/// What a motion is a part of, if its block has several.
enum class MoveWithin : uint8_t { nothing, block, cycle, way_home };

/// What a block moves, as far as it names what came of it.
struct BlockMove {
    BlockMotion motion = BlockMotion::none; // of several: rapid if that is the one in question
    bool turns = false;                     // rotary axes move
    double duration = 0.0;                  // seconds
    bool only_dog_leg = false;              // straight, the rapid would keep every allowance
    MoveWithin within = MoveWithin::nothing;
};

/// The finding for a pair that did not keep its allowance in a block, with its cure.
Finding finding_of(const Setup& setup, const PairClearance& pair, const BlockMove& move,
                   const SimulatorState& state);

/// The finding for a tool that is changed in where it does not keep an allowance.
Finding unsafe_change(const Setup& setup, const PairClearance& pair, ToolNumber tool);

} // namespace core
