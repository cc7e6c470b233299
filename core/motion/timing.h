#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "core/motion/event.h"

namespace core {

struct Machine;

/// How fast an axis may go and how soon it may get there; without a limit unless said. mm/s and
/// mm/s2, or degrees.
struct AxisLimits {
    double speed = infinity;
    double acceleration = infinity;
};

using MachineLimits = std::array<AxisLimits, axis_count>;

/// What a corner may be rounded by where no tolerance is stated, mm.
constexpr double default_blend_tolerance = 0.05;

/// The control sets speeds anew this often, seconds: a jump in an axis's speed that its
/// acceleration makes up for within it is none.
constexpr double control_cycle = 0.001;

/// Motions of which the planner knows no more than this many ahead.
constexpr size_t look_ahead = 512;

/// One motion along its path. Rates are changes of the axes per unit of the path's length.
struct PathMotion {
    double length = 0.0; // above 0, in the unit the speed is programmed in
    double speed = 0.0; // wanted along the path, per second; infinity if axes with a speed limit it
    AxisValues start{}, end{}; // rates where it begins and ends
    AxisValues fastest{};      // the greatest rate of each axis on the way, not negative
    AxisValues bend{};         // the greatest change of its rate per unit of length, not negative
};

/// When a motion takes place and how its speed changes: up, on, and down, at one acceleration.
struct MotionTime {
    uint32_t tag = 0;
    double duration = 0.0; // seconds
    double length = 0.0;
    double enter = 0.0, cruise = 0.0, leave = 0.0; // speeds
    double acceleration = infinity;

    /// The time after its start at which this much of the length lies behind, seconds.
    double moment(double travelled) const;
};

/// A motion that waits for what comes after it.
struct WaitingMotion {
    uint32_t tag;
    double length;
    double acceleration;   // along the path
    double cruise_squared; // of the greatest speed
    double corner_squared; // of the greatest speed at the corner before it
    double entry_squared;  // of the greatest speed there from which the known end can be kept
};

/// Motions in order, as far as they are known. A plain value: copy it to go back.
///
/// A motion becomes final when `look_ahead` more have come, or one that stands still: its speed at
/// the end is one from which all that is known can be kept, the last known motion ending at rest.
/// Nothing else hangs on when or in which portions motions are given.
struct TimePlan {
    MachineLimits limits;
    Blending blending = Blending::continuous;
    double tolerance = default_blend_tolerance;
    std::deque<WaitingMotion> waiting;
    std::optional<PathMotion> last; // the motion before a corner that may come; empty: at rest
    double enter = 0.0;             // speed at the start of the first that waits
};

/// Adds a motion and appends to `done` what has become final.
void add_motion(TimePlan& plan, const PathMotion& motion, uint32_t tag,
                std::vector<MotionTime>& done);

/// The machine comes to rest: everything that waits becomes final.
void come_to_rest(TimePlan& plan, std::vector<MotionTime>& done);

/// The greatest speed along a path that its axes and the programmed speed allow.
///
/// A path that bends uses at most sqrt(3)/2 of an axis's acceleration to do so, and leaves half of
/// it to change speed: at a right angle they make up the whole.
double cruise_speed(const MachineLimits& limits, const PathMotion& motion);

/// The greatest acceleration along a path that its axes allow.
double path_acceleration(const MachineLimits& limits, const PathMotion& motion);

/// The greatest speed at the corner between two motions.
///
/// A rounded corner is a parabola: while it lasts, the axes change from one rate to the other at a
/// constant acceleration. It departs from the corner by no more than the tolerance and takes no
/// more than half of either motion. Beside a path that bends it has half of the acceleration, and
/// the bend the other. Without rounding, or where that is faster, the speeds of the axes jump by
/// what they can make up for in one control cycle.
double corner_speed(const TimePlan& plan, const PathMotion& before, const PathMotion& after);

/// What the machine states of its axes; a speed that it does not state is no limit.
MachineLimits limits_of(const Machine& machine);

/// A motion along its path, for the planner.
///
/// Units:  the speed of a feed is along X, Y and Z if one of these moves, else along U, V and W,
///         else along the rotary axes, degrees.
///         Where the control follows the tip, along the tip's way.
/// Result: empty when nothing moves, when nobody knows how far it goes, for a feed of 0, and for a
///         dog-leg rapid, whose axes do not move along one path.
std::optional<PathMotion> path_motion(const Motion& motion, const Machine& machine);

/// Whether the axes move on their own, each from rest to rest.
bool is_dogleg(const Motion& motion, const Machine& machine);

/// How long the slowest axis of a dog-leg rapid needs, seconds: with its acceleration, and at full
/// speed all the way.
struct DoglegTime {
    double duration = 0.0;
    double at_full_speed = 0.0;
};

DoglegTime dogleg_time(const Motion& motion, const Machine& machine);

} // namespace core
