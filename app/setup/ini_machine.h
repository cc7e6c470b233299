#pragma once

#include <string>

#include "core/sim/machine.h"
#include "gcode/environment.h"

namespace app {

/// Gives the axes of a machine the limits, speeds, accelerations and homes that LinuxCNC's ini file
/// states and nobody else did: [AXIS_X], or [AXIS_0] of older files, and [JOINT_0] of a machine
/// whose joints are its axes, in the order of X Y Z A B C U V W.
///
/// `places`: limits and homes, too; they mean nothing where work offsets are made up.
///
/// Result: what a user should know of it; empty where nothing was taken.
std::string complete_machine(core::Machine& machine, const gcode::Environment& environment,
                             bool places);

} // namespace app
