#pragma once

#include <deque>
#include <vector>

#include "core/base/ids.h"
#include "core/motion/machine.h"
#include "core/motion/timing.h"

namespace core {

struct BlockEvents;
struct BlockResult;

/// A part of a block: one motion, or a dwell.
struct BlockStretch {
    double at_full_speed = 0.0; // duration without accelerations, seconds
    MotionTime time;            // its length is 0 if the machine does not move
    bool final = false;
};

/// Start and duration of a block, with the speeds and accelerations of the machine.
struct BlockTime {
    BlockIndex block{};
    double start = 0.0, duration = 0.0; // seconds
    std::vector<BlockStretch> stretches;

    /// Time from the block's start, seconds, of the event that occurs after this fraction of the
    /// block's time without accelerations.
    double moment(double fraction) const;
};

/// Blocks whose times are being computed. A plain value: copy it to step back.
struct BlockClock {
    Machine machine;
    TimePlan plan;
    std::deque<BlockTime> open; // blocks without a final duration, in order
    uint32_t first_open = 0;    // number of blocks before them
    double time = 0.0;          // start of the first of them, seconds
};

/// A clock at time 0 for this machine.
BlockClock start_clock(const Machine& machine);

/// Adds a block and appends the blocks whose times have become final (see TimePlan) to `done`, in
/// order. Changes of tool and spindle bring the machine to rest; their own duration is unknown and
/// not counted.
void add_block(BlockClock& clock, const BlockEvents& block, std::vector<BlockTime>& done);

/// Ends the program: makes the times of all blocks final.
void stop_clock(BlockClock& clock, std::vector<BlockTime>& done);

/// Sets the times of a block. The times of its pairs keep their positions on the path, but in
/// dog-leg rapids they keep their fraction of the motion's time.
void settle_time(BlockResult& result, const BlockTime& time);

} // namespace core
