#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace app {

struct SetupFile;

/// A set-up file with what its program says now.
struct SetupUpdate {
    std::string text;                // of the file
    std::vector<std::string> added;  // in words, such as "tool 4"
    std::vector<std::string> unused; // stated, and not used by the program: "tool 7", "G56"
};

/// Adds to the text of a set-up what the program says and the text lacks: the tools that it calls,
/// as far as they are described; the stock that it states; its work offsets, commented out. All
/// that is in the text stays as it is. An update of the result adds nothing.
///
/// `file`: the set-up of this text as a partial one, completed with the program.
/// Errors: syntax of the text; unsupported if it has a form to which nothing can be added.
core::Result<SetupUpdate> updated_setup(const std::string& text, const SetupFile& file);

} // namespace app
