#pragma once

#include <memory>
#include <optional>
#include <string>

#include "assets/linuxcnc/feeler_tp/feeler_ring.h"
#include "core/motion/event.h"
#include "core/motion/machine.h"
#include "gcode/language/environment.h"

namespace app {

/// A motion that the control has queued, in mm and degrees.
struct LiveMotion : feeler_segment {
    core::AxisValues axes_from{}, axes_to{}; // of the machine; `from` and `to` are the planner's
    bool follows_tip = false; // its path is a line or an arc of the tip, as seen from the work
    // Where axes besides X, Y and Z move, and the planner may blend the motion: how far the tip may
    // be from its path, mm, and the rotary axes in all from where they are there, radians.
    double path_error = 0.0, turn_error = 0.0;
    std::string problem; // why it cannot be checked; empty if it can
};

inline bool is_probing(const feeler_segment& motion) {
    return motion.purpose == FEELER_PROBE || motion.purpose == FEELER_PROBE_AWAY;
}

/// Whether axes besides X, Y and Z move.
bool moves_others(const feeler_segment& motion);

core::AxisValues axis_values(const double (&numbers)[core::axis_count]);

/// Whether the control has dropped motions before this one, so that it does not begin where the one
/// with the number before it would end.
bool is_after_drop(const feeler_segment& motion);

/// What the positions of LinuxCNC's planner mean for the axes of the machine.
class ControlKinematics {
public:
    /// They are those of the axes, and nothing is compared. `unit`: mm per unit of the machine's
    /// lengths.
    explicit ControlKinematics(double unit) : unit_(unit) {}
    /// As `kinematics` of the environment has it, with the rotary axes of this machine. Each motion
    /// is compared with what the control's own kinematics make of it: joints may differ by
    /// `tolerance`, mm or degrees.
    ControlKinematics(double unit, gcode::SwitchableKinematics kinematics,
                      const core::Machine& machine, double tolerance);

    /// The motion in mm, and what the axes do.
    LiveMotion read(const feeler_segment& motion) const;

    /// The axes at a position of the planner, in mm, in the mode of a motion. Where the linear axes
    /// cannot reach it, the position itself.
    core::AxisValues axes_at(const core::AxisValues& position, const LiveMotion& motion) const;

    /// The path of the tip from one place of the axes to another, if the control keeps it straight.
    std::optional<core::TipPath> tip_path(const core::AxisValues& from, const core::AxisValues& to,
                                          const LiveMotion& motion) const;

private:
    /// Where a joint is farthest from where it would be.
    struct Difference {
        double most = -1.0; // mm or degrees; below 0: no joint is known
        char letter = 0;
        double on_control = 0.0, in_setup = 0.0;
    };
    Difference difference_of(const LiveMotion& motion) const;
    void compare(LiveMotion& motion) const;

    double unit_ = 1.0, tolerance_ = 0.0;
    std::optional<gcode::SwitchableKinematics> kinematics_;
    std::shared_ptr<const core::Machine> machine_;
};

} // namespace app
