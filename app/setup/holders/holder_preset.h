#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/setup/holders/holder_parts.h"
#include "app/setup/presets/preset.h"
#include "core/base/result.h"
#include "core/sim/tool_description.h"

namespace app {

/// A holder that is made from its sizes.
struct HolderPreset {
    Preset preset; // its mesh has its origin in the lower face, Z up to the gauge line
    const HolderTaper* taper;
    const HolderAttachment* attachment;
};

/// All holders, by taper, then by attachment.
std::span<const HolderPreset> holder_presets();

/// A holder as a name gives it, such as "BT40-ER32-100".
struct NamedHolder {
    const HolderPreset* holder = nullptr;
    PresetValues values; // the length, if the name has one
};

/// Reads the name of a holder: that of a preset, which has the usual length, or with a length in
/// mm, from the gauge line to the lower face.
///
/// Errors: invalid_value: says what is wrong with the name, with the nearest one.
core::Result<NamedHolder> holder_named(std::string_view name);

/// The truncated cones of a holder, from its lower face up.
///
/// Result: with the sizes of standards, they contain the true body. Lengths are multiples of 1e-6.
/// Errors: those of check_preset_value; invalid_value for sizes that make no holder together.
core::Result<std::vector<core::ConeStep>> holder_cones(const HolderPreset& holder,
                                                       const PresetValues& values = {});

/// The cones of the holder of this name.
///
/// Errors: those of holder_named and holder_cones.
core::Result<std::vector<core::ConeStep>> holder_cones(std::string_view name);

/// The name of the holder with these cones, with its length unless it is the usual one; empty if
/// there is none. Lengths in names are in mm.
std::string name_of_holder(const std::vector<core::ConeStep>& cones);

} // namespace app
