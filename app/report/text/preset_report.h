#pragma once

#include <string>

#include "app/setup/presets/preset.h"

namespace app {

struct MachinePreset;

/// The list of all presets: fixtures, holders and machines, by kind.
std::string presets_text();
/// The same with their parameters, as JSON.
std::string presets_json();

/// A preset with these values: what it is, its parameters with their ranges, its box, and how a
/// set-up names it.
///
/// Errors: those of preset_mesh.
core::Result<std::string> preset_text(const Preset& preset, const PresetValues& values);
core::Result<std::string> preset_json(const Preset& preset, const PresetValues& values);

/// A machine with these sizes: where they come from, and how a set-up names it. The JSON also has
/// the machine file.
///
/// Errors: those of machine_text.
core::Result<std::string> machine_report(const MachinePreset& machine, const PresetValues& values);
core::Result<std::string> machine_json(const MachinePreset& machine, const PresetValues& values);

} // namespace app
