#pragma once

#include <string>
#include <vector>

#include "app/setup/presets/preset.h"

namespace app {

/// A preset as an argument gives it.
struct ChosenPreset {
    const Preset* preset = nullptr;
    PresetValues values;
};

/// Reads the name of a preset.
///
/// Errors: invalid_value, with the nearest name.
core::Result<const Preset*> named_preset(const std::string& name);

/// Reads values written as `opening=50`, in mm.
///
/// Errors: invalid_value: another form, a key given twice; those of check_preset_value.
core::Result<PresetValues> preset_values(const Preset& preset,
                                         const std::vector<std::string>& assignments);

/// Reads `vise-6` or `vise-6,opening=50,jaw_height=40`.
///
/// Errors: those of named_preset and preset_values.
core::Result<ChosenPreset> preset_argument(const std::string& argument);

} // namespace app
