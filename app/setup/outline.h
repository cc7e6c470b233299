#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/geom/profile.h"
#include "core/sim/tool_description.h"

namespace app {

/// The part of a tool that an outline describes, [r, z] from its lower end up.
///
/// Errors: invalid_value when it does not begin at z = 0, does not go up, or encloses nothing.
core::Result<std::vector<core::ConeStep>>
cones_of_outline(const std::vector<std::vector<double>>& points);

/// Cones that stand one upon the other.
std::vector<core::ConeStep> cones_of_profile(const core::RevolvedProfile& profile);

} // namespace app
