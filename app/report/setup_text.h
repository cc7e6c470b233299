#pragma once

#include <string>

#include "app/setup/setup_file.h"

namespace app {

/// A set-up as a file that `check --setup` takes, with what was assumed as comments.
///
/// Result: every number to its last bit, so that the file means what the set-up means.
std::string setup_text(const SetupFile& setup, const std::string& program);

} // namespace app
