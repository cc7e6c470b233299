#pragma once

#include <string>

namespace app {

/// The version of this program, and which build of it: programs that were built from other sources
/// have another. The build is what the linker's build-id says, else a SHA-256 of the program's
/// file.
const std::string& build_version();

} // namespace app
