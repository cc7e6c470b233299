#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gcode/language/environment.h"

namespace app {

class HalSettings;

/// The machine behind a kinematics module of LinuxCNC.
struct LinuxcncKinematics {
    gcode::SwitchableKinematics switches; // with the rotary axes, if their places are known
    std::vector<std::string> notes;       // for the user
};

/// Whether `linuxcnc_kinematics` knows a module.
bool is_known_kinematics(const std::string& module);

/// The machine of xyzac-trt-kins, xyzbc-trt-kins, xyzab_tdr_kins, xyzacb_trsrn, xyzbca_trsrn or
/// 5axiskins; empty for any other module.
///
/// `settings`: the value of KINEMATICS after the name of the module, such as sparm=identityfirst.
/// `stated`: values of pins that the user states, by names such as _hal[5axiskins.pivot-length];
///           they count more than the HAL commands.
/// `unit`: mm per unit of the machine's lengths, in which the pins are.
///
/// Source: LinuxCNC 2.9, src/emc/kinematics/trtfuncs.c and 5axiskins.c, src/hal/components:
///         xyzab_tdr_kins.comp, xyzacb_trsrn.comp, xyzbca_trsrn.comp.
std::optional<LinuxcncKinematics>
linuxcnc_kinematics(const std::string& module, const std::string& settings, const HalSettings& hal,
                    const std::map<std::string, std::optional<double>, std::less<>>& stated,
                    double unit = 1.0);

} // namespace app
