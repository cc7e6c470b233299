#pragma once

#include <string>

#include "core/base/result.h"

namespace app {

/// Writes a result to a file, or to standard output when `path` is empty. A file is replaced only
/// once all of the new one is on disk; the old one stays when something goes wrong. A device or
/// pipe is written to as it is, a link is followed.
///
/// Errors: io, with the path.
core::Result<void> write_output(const std::string& path, const std::string& text);

/// Prints an error to standard error.
void print_error(const core::Error& error);

} // namespace app
