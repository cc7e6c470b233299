#pragma once

#include <cstdint>
#include <vector>

#include "core/motion/timing.h"

namespace core {

/// A planned motion of a program, and the permit that it needs.
struct PermitMotion {
    MotionTime time;      // if its length is 0, the machine rests for its duration
    uint32_t segment = 0; // must be permitted before the motion; never decreases
};

/// Timing of the control's servo loop.
struct ServoTiming {
    double period = 0.001;  // time between two set points, seconds
    double latency = 0.001; // from the device's answer to the drives, seconds
    double feed = 1.0;      // override, above 0: factor on the speed of the whole plan
};

/// Times at which a motion was permitted and entered, seconds.
struct MotionEntry {
    double due = infinity; // latest time for its permit; infinite for the first motion, which waits
    double seen = infinity;    // when the control received the permit
    double entered = infinity; // when the machine began the motion
};

/// A machine that follows its plan and enters no motion without a permit. A plain value: copy it to
/// step back.
///
/// A permit is due when the distance left to its motion falls below v^2 / 2a + v (3 periods +
/// latency): until then the machine can still stop before it. If the permit is missing, the machine
/// brakes to a stop at the start of that motion, waits there, and continues once the permit
/// arrives.
struct PermitRun {
    ServoTiming servo;
    std::vector<PermitMotion> motions;
    std::vector<double> starts; // path lengths at which the motions start; plus one for the end
    std::vector<double> times;  // planned start times, seconds; plus one for the end
    double weakest = infinity;  // lowest acceleration of all motions
    std::vector<MotionEntry> entries; // one for each motion

    uint64_t ticks = 0;      // number of set points so far
    size_t motion = 0;       // current motion, or the next one if the machine waits
    bool is_delayed = false; // it had to brake and is still below the planned speed
    double into = 0.0;       // planned time since the motion's start, seconds, unless behind
    double along = 0.0;      // distance from the motion's start, if behind
    double speed = 0.0;      // speed along the path, if behind
    size_t seen = 0;         // number of motions that have their permits
    size_t due = 0;          // number of motions whose permits have become due

    double time() const { return static_cast<double>(ticks) * servo.period; }
    bool is_done() const { return motion == motions.size(); }
    /// Whether the machine waits for the permit of the next motion.
    bool is_held() const { return motion == seen && !is_done(); }
    /// Position along the path, as a length.
    double position() const;
    double speed_now() const;
    /// Delay against the plan so far, seconds.
    double waited() const;
};

/// A machine before its first motion.
PermitRun permit_run(std::vector<PermitMotion> motions, const ServoTiming& servo);

/// Advances by one set point. Segments with numbers below `permitted` may be entered.
///
/// Guarantee: no motion is entered without a permit. If permits arrive by their due times, the
/// machine follows its plan. Cost:      proportional to the number of motions within the braking
/// distance.
void step(PermitRun& run, uint32_t permitted);

} // namespace core
