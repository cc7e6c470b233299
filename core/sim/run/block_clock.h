#pragma once

#include <deque>
#include <vector>

#include "core/base/ids.h"
#include "core/motion/machine.h"
#include "core/motion/timing.h"

namespace core {

struct BlockEvents;
struct BlockResult;

/// A part of a block in which one motion takes place, or none.
struct BlockStretch {
    double at_full_speed = 0.0; // seconds it would take without accelerations
    MotionTime time;            // of no length when the machine stands still
    bool final = false;
};

/// When a block takes place, under the speeds and accelerations of the machine.
struct BlockTime {
    BlockIndex block{};
    double start = 0.0, duration = 0.0; // seconds
    std::vector<BlockStretch> stretches;

    /// The time after its start of what would happen after this share of its time at full speed.
    double moment(double share) const;
};

/// Blocks on their way to a place in time. A plain value: copy it to go back.
struct BlockClock {
    Machine machine;
    TimePlan plan;
    std::deque<BlockTime> open; // blocks without their duration yet, in order
    uint32_t first_open = 0;    // how many came before them
    double time = 0.0;          // seconds, when the first of them starts
};

/// A clock at 0, for this machine.
BlockClock start_clock(const Machine& machine);

/// Adds a block and appends the blocks whose time has become final to `done`, in order:
/// when it has become so for the planner (see TimePlan). Changes of tool and spindle bring the
/// machine to rest; the time they take by themselves is not known and not counted.
void add_block(BlockClock& clock, const BlockEvents& block, std::vector<BlockTime>& done);

/// The end of the program: everything becomes final.
void stop_clock(BlockClock& clock, std::vector<BlockTime>& done);

/// Puts a block in its place in time. The times of its pairs keep their places on the path, except
/// that those of dog-leg rapids keep their share of the motion's time.
void settle_time(BlockResult& result, const BlockTime& time);

} // namespace core
