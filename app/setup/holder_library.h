#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geom/profile.h"
#include "core/sim/tool_description.h"

namespace gcode {
enum class LengthUnit : uint8_t;
}

namespace app {

/// Holders by name. Each is a list of cones from the lower face to the gauge line.
using HolderLibrary = std::map<std::string, std::vector<core::ConeStep>>;

/// Reads a library: `[[holder]]` with `name`, `description` and either `cones`, rows of lower
/// diameter, upper diameter and length, or `profile`, rows of r and z.
///
/// Errors: with file, line and column: a missing file, invalid TOML, an unknown key, impossible
///         sizes, a duplicate name.
core::Result<HolderLibrary> read_holder_library(const std::string& path);

/// The names in a library that begin like `name`, else all names, for error messages.
std::string names_like(const HolderLibrary& library, const std::string& name);

/// The cones of an outline, given as [r, z] points from the lower end up, in mm.
///
/// `unit`: of the file, for errors.
/// Errors: invalid_value if it does not begin at z = 0, z decreases, or it encloses no volume.
core::Result<std::vector<core::ConeStep>>
cones_of_outline(const std::vector<std::vector<double>>& points, gcode::LengthUnit unit);

/// The cones of a profile, stacked from the lower end up.
std::vector<core::ConeStep> cones_of_profile(const core::RevolvedProfile& profile);

} // namespace app
