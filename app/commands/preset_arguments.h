#pragma once

#include <string>
#include <vector>

#include "app/setup/presets/preset.h"

namespace app {

struct MachinePreset;

/// A preset as an argument gives it.
struct ChosenPreset {
    const Preset* preset = nullptr;
    PresetValues values;
};

/// Reads the name of a fixture or of a holder, which may end with its length.
///
/// Errors: invalid_value, with the nearest name; those of holder_named.
core::Result<ChosenPreset> named_preset(const std::string& name);

/// Reads sizes of a machine written as `x_min=-500`: mm, degrees, per minute or per s2.
///
/// Errors: invalid_value: another form, a key given twice, a size that it does not have.
core::Result<PresetValues> machine_values(const MachinePreset& machine,
                                          const std::vector<std::string>& assignments);

/// Reads values written as `opening=50`, in mm.
///
/// Errors: invalid_value: another form, a key given twice; those of check_preset_value.
core::Result<PresetValues> preset_values(const Preset& preset,
                                         const std::vector<std::string>& assignments);

/// Reads `vise-6`, `vise-6,opening=50,jaw_height=40` or `BT40-ER32-100`.
///
/// Errors: those of named_preset and preset_values.
core::Result<ChosenPreset> preset_argument(const std::string& argument);

} // namespace app
