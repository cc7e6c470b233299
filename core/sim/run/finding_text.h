#pragma once

#include "core/sim/block_result.h"

namespace core {

struct PairStudy;
struct Setup;
struct SimulatorState;

/// The context of a motion in a block with several motions.
enum class MoveWithin : uint8_t { nothing, block, cycle, way_home };

/// The properties of a block's motion that affect the rule and message of a finding.
struct BlockMove {
    BlockMotion motion =
        BlockMotion::none;     // `rapid` if the pair was worst in a rapid of several motions
    bool turns = false;        // rotary axes move
    double duration = 0.0;     // seconds
    bool only_dog_leg = false; // the rapid would be clear if it were straight
    MoveWithin within = MoveWithin::nothing;
    bool leaves_contact = false; // by probing (G38.4)
    bool shifts = false;         // a cycle that shifts the tool sideways in the hole, such as G76
};

/// When in a block something happens, after a fraction of its duration.
std::string moment_text(double fraction);

/// The finding for a pair below its allowance in a block, with its cure. Millimetres in the cure
/// were tried.
Finding finding_of(const Setup& setup, const PairClearance& pair, const BlockMove& move,
                   const SimulatorState& state, const PairStudy& study);

/// The finding for a tool change at a position where a pair of the new tool is below its allowance.
Finding unsafe_change(const Setup& setup, const PairClearance& pair, ToolNumber tool);

} // namespace core
