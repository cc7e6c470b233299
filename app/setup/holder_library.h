#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geom/profile.h"
#include "core/sim/tool_description.h"

namespace app {

/// Holders by name, from the end where the tool comes out up to the gauge line.
using HolderLibrary = std::map<std::string, std::vector<core::ConeStep>>;

/// Reads a library: `[[holder]]` with `name`, `description` and either `cones`, rows of lower
/// diameter, upper diameter and length, or `profile`, rows of r and z.
///
/// Errors: with file, line and column: no file, no TOML, an unknown key, sizes that make no holder,
///         a name that was there before.
core::Result<HolderLibrary> read_holder_library(const std::string& path);

/// The holders that come with the program.
const HolderLibrary& shipped_holder_library();

/// The names in a library that begin like `name`, else all of them: what a message offers.
std::string names_like(const HolderLibrary& library, const std::string& name);

/// The part of a tool that an outline describes, [r, z] from its lower end up.
///
/// Errors: invalid_value when it does not begin at z = 0, does not go up, or encloses nothing.
core::Result<std::vector<core::ConeStep>>
cones_of_outline(const std::vector<std::vector<double>>& points);

/// Cones that stand one upon the other.
std::vector<core::ConeStep> cones_of_profile(const core::RevolvedProfile& profile);

/// A file that is part of the program.
struct ShippedFile {
    const char* name;
    const char* text;
};

/// The holder libraries of assets/holders, as they were when the program was built.
std::span<const ShippedFile> shipped_holders();

} // namespace app
