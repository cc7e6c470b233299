#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
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

} // namespace app
