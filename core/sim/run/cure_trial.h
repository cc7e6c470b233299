#pragma once

#include <memory>
#include <optional>

#include "core/motion/event.h"
#include "core/sim/clearance.h"
#include "core/sim/finding.h"

namespace core {

struct BlockEvents;
struct CutModel;
struct Setup;
struct SimulatorState;

/// A shift of a block's path along a machine axis, after which the block was checked again and was
/// clear.
struct TriedShift {
    size_t axis = 2;
    double by = 0.0;    // mm, with its sign
    double keeps = 0.0; // lower bound of the pair's clearance after it, mm
};

/// What was found out about a pair that is not clear in a block.
struct PairStudy {
    std::optional<Overlap> overlap;
    bool starts_inside = false; // the pair overlaps where the block begins
    bool tried = false;         // shifts of the block were tried
    bool cuts = false;          // the block removes material, so only shifts count that also do
    std::optional<TriedShift> shift; // that makes the block clear; empty: none was found
};

/// The stock as it was when `moves` of its moves were logged; null if it cannot be had at
/// reasonable cost.
///
/// Cost: cuts again what was cut since the last call, or where the moves since then have cut.
std::shared_ptr<const CutModel> stock_after(const Setup& setup, SimulatorState& state,
                                            size_t moves);

/// A block that can be run again with a shifted path.
struct BlockTrial {
    const Setup& setup;
    const BlockEvents& block;
    const SimulatorState&
        state;              // after the block, with a tool of the set-up, with a tool of the set-up
    const CutModel& stock;  // before the block
    RoundedCorners corners; // before the block
    bool must_cut = false;  // only shifts count with which the block still removes material
};

/// Whether the block consists of motions that can be shifted as a whole.
bool can_shift(const BlockEvents& block);

/// A direction along an axis in which a shift is tried, and the first amount, mm.
struct ShiftStart {
    size_t axis = 2;
    double sign = 1.0;
    double first = 0.0;
};

/// The shift by which the whole block is clear and the pair keeps `room`, found by running the
/// block again: the first start with its first amount, else about the smallest in all directions.
///
/// Result: an amount that was itself tried, a multiple of 0.001 mm; empty if there is none up to
///         100 mm. `work` grows by the tests made.
/// Cost:   that of the block, 1 to some 60 times.
std::optional<TriedShift> find_shift(const BlockTrial& trial, const Pair& pair,
                                     const std::vector<ShiftStart>& starts, double room,
                                     size_t& work);

} // namespace core
