#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/motion/event.h"

namespace app {

struct SetupFile;

/// What LinuxCNC says about itself while it runs.
struct ControlState {
    int work_offset = 1;          // in use: 1 is G54, 9 is G59.3
    core::AxisValues origin = {}; // of that work offset, units of the machine and degrees
    double rotation_deg = 0.0;    // about Z
    int tool = 0;                 // in the spindle
    bool is_homed = false;        // all joints
    bool is_mdi = false;          // the operator gives commands by MDI
    double tool_length = 0.0;     // as the tool table has it, units of the machine
};

/// Reads a line that feeler_status.py writes: a JSON object.
///
/// Errors: syntax.
core::Result<ControlState> read_control_state(std::string_view line);

/// How the control differs from the set-up by more than `tolerance`, mm or degrees: the work offset
/// in use, its rotation, or the length of the tool in the spindle; or that its place is not known.
/// A sentence with both values; empty if there is no difference. `unit`: mm per unit of the
/// machine.
std::string difference(const SetupFile& setup, const ControlState& control, double unit,
                       double tolerance);

} // namespace app
