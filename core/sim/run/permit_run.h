#pragma once

#include <cstdint>
#include <vector>

#include "core/motion/timing.h"

namespace core {

/// A stretch of a program as the control has planned it, and the permit that it needs.
struct PermitMotion {
    MotionTime time;      // without length the machine stands still for its duration
    uint32_t segment = 0; // must be permitted before the machine enters it; never falls
};

/// What a control knows of itself.
struct ServoTiming {
    double period = 0.001;  // seconds between two set points
    double latency = 0.001; // from the device's word to the drives, seconds
    double feed = 1.0;      // the override, above 0: the whole plan is run so much faster
};

/// How a motion came to be entered, seconds.
struct MotionEntry {
    double due = infinity;  // when its permit had to be there; the first motion waits for its own
    double seen = infinity; // when the control saw the permit
    double entered = infinity; // when the machine began it

    bool was_late() const { return seen > due; }
};

/// A machine that follows its plan and enters nothing without a permit. A plain value: copy it to
/// come back.
///
/// A permit is due when the way left to its motion falls below v^2 / 2a + v (3 periods + latency):
/// the machine can still stop before it then. One that is not there makes it brake towards that
/// place, wait there, and go on by itself once the permit comes.
struct PermitRun {
    ServoTiming servo;
    std::vector<PermitMotion> motions;
    std::vector<double> starts;       // of the motions along the path; one more for the end
    std::vector<double> times;        // of their starts by plan, seconds; one more for the end
    double weakest = infinity;        // acceleration of all motions
    std::vector<MotionEntry> entries; // of the motions

    uint64_t ticks = 0;     // set points that were given
    size_t motion = 0;      // that the machine is in, or stands before
    bool is_behind = false; // it had to brake, and is not back at the planned speed
    double into = 0.0;      // the motion by plan, seconds, unless it is behind
    double along = 0.0;     // the motion, where it is behind
    double speed = 0.0;     // along the path, where it is behind
    size_t seen = 0;        // motions before it have their permits
    size_t due = 0;         // permits of motions before it have been due

    double time() const { return static_cast<double>(ticks) * servo.period; }
    bool is_done() const { return motion == motions.size(); }
    /// Whether it stands before a motion without a permit.
    bool is_held() const { return motion == seen && !is_done(); }
    /// Where it is along the path.
    double place() const;
    double speed_now() const;
    /// How much longer than by plan it has taken so far, seconds.
    double waited() const;
};

/// A machine before the first of its motions.
PermitRun permit_run(std::vector<PermitMotion> motions, const ServoTiming& servo);

/// Goes on by a set point. Segments with numbers below `permitted` may be entered.
///
/// Guarantee: no motion is entered without a permit. While permits come by their due times the
///            machine keeps to its plan.
/// Cost:      the motions within its braking distance.
void step(PermitRun& run, uint32_t permitted);

} // namespace core
