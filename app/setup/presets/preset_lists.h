#pragma once

#include <string>
#include <vector>

#include "app/setup/presets/preset.h"

namespace app {

/// The presets of each file, in any order.
std::vector<Preset> vise_presets();
std::vector<Preset> clamp_presets();
std::vector<Preset> block_presets();
std::vector<Preset> plate_presets();
std::vector<Preset> chuck_presets();

/// An error about sizes that make no body together: `why` names the keys.
tl::unexpected<core::Error> unfit_sizes(std::string why);

} // namespace app
