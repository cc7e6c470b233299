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

/// Limits of an axis; infinite if not stated. mm/s and mm/s2, or degrees.
struct AxisLimits {
    double speed = infinity;
    double acceleration = infinity;
};

using MachineLimits = std::array<AxisLimits, axis_count>;

/// Tolerance of corner rounding if none is stated, mm.
constexpr double default_blend_tolerance = 0.05;

/// Cycle time of the control, seconds. A jump in the speed of an axis that its acceleration can
/// produce within one cycle does not count as a corner.
constexpr double control_cycle = 0.001;

/// The number of motions that the planner knows ahead.
constexpr size_t look_ahead = 512;

/// One motion along its path. Rates are axis changes per unit of path length.
struct PathMotion {
    double length = 0.0; // above 0, in the unit the speed is programmed in
    double speed = 0.0;  // programmed, along the path, per second; infinity if axis speeds limit it
    AxisValues start{}, end{}; // rates at its start and end
    AxisValues fastest{};      // the greatest rate of each axis along the path, not negative
    AxisValues bend{};         // the greatest change of its rate per unit of length, not negative
};

/// The duration of a motion and its speed profile: accelerate, cruise, decelerate, with one
/// acceleration.
struct MotionTime {
    uint32_t tag = 0;
    double duration = 0.0; // seconds
    double length = 0.0;
    double enter = 0.0, cruise = 0.0, leave = 0.0; // speeds
    double acceleration = infinity;

    /// The time after its start at which this much of the length has been travelled, seconds.
    double moment(double travelled) const;
};

/// A motion whose end speed is not final yet.
struct WaitingMotion {
    uint32_t tag;
    double length;
    double acceleration;   // along the path
    double cruise_squared; // square of the greatest speed
    double corner_squared; // square of the greatest speed at the corner before it
    double
        entry_squared; // square of the greatest speed there from which the known end can be reached
};

/// The motions known so far, in order. A plain value: copy it to step back.
///
/// A motion becomes final when `look_ahead` more motions have been added, or when the machine
/// stops. Its end speed is then one from which all known motions can be executed with the last one
/// ending at rest. The result does not depend on when or in which portions motions are added.
struct TimePlan {
    MachineLimits limits;
    Blending blending = Blending::continuous;
    double tolerance = default_blend_tolerance;
    std::deque<WaitingMotion> waiting;
    std::optional<PathMotion> last; // the motion before the next corner; empty: at rest
    double enter = 0.0;             // speed at the start of the first waiting motion
};

/// Adds a motion and appends the motions that became final to `done`.
void add_motion(TimePlan& plan, const PathMotion& motion, uint32_t tag,
                std::vector<MotionTime>& done);

/// The machine stops: all waiting motions become final.
void plan_stop(TimePlan& plan, std::vector<MotionTime>& done);

/// The greatest speed along a path that the axes and the programmed speed allow.
///
/// On a curved path, curvature uses at most sqrt(3)/2 of the acceleration of an axis and leaves
/// half of it for changes of speed: at right angles they add up to the whole.
double cruise_speed(const MachineLimits& limits, const PathMotion& motion);

/// The greatest acceleration along a path that the axes allow.
double path_acceleration(const MachineLimits& limits, const PathMotion& motion);

/// The greatest speed at the corner between two motions.
///
/// A rounded corner is a parabola: the axes change from one rate to the other at constant
/// acceleration. It stays within the tolerance of the corner and uses at most half of either
/// motion. Next to a curved path it gets half of the acceleration and the curvature the other half.
/// Without rounding, or where that is faster, axis speeds jump by as much as the axes can
/// accelerate in one control cycle.
double corner_speed(const TimePlan& plan, const PathMotion& before, const PathMotion& after);

/// The limits stated for the machine; a speed that is not stated is unlimited.
MachineLimits limits_of(const Machine& machine);

/// A motion in the form that the planner needs.
///
/// Units:   the speed of a feed is along X, Y and Z if one of these moves, else along U, V and W,
///          else along the rotary axes, in degrees. Where the control follows the tip, it is along
///          the path of the tip.
/// Result:  empty if nothing moves, if the length is unknown, for a feed of 0, and for a dog-leg
///          rapid, whose axes do not move along one path.
std::optional<PathMotion> path_motion(const Motion& motion, const Machine& machine);

/// Duration of a dog-leg rapid, that of its slowest axis, seconds: with and without accelerations.
struct DoglegTime {
    double duration = 0.0;
    double at_full_speed = 0.0;
};

DoglegTime dogleg_time(const Motion& motion, const Machine& machine);

} // namespace core
