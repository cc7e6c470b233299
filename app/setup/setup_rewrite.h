#pragma once

#include <string>

#include "app/setup/setup_edits.h"

namespace app {

/// The text of a set-up file with edits made in it: the tables of the stock and of tools that were
/// edited are written anew, everything else stays as somebody wrote it, comments and all.
///
/// Result: read again, it is the set-up with the edits. Where the file has its tables in a form
///         that cannot be cut out (`stock = { ... }`), all of it is written anew.
/// Errors: syntax; unsupported when the frame of other bodies would move with the stock.
core::Result<std::string> rewritten_setup(const std::string& text, const SetupEdits& edits);

/// Whether a set-up names files by paths that count from its own folder.
bool names_relative_files(const std::string& text);

} // namespace app
