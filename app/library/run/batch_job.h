#pragma once

#include <string>
#include <vector>

#include "app/library/find/folder_walk.h"

namespace app {

struct CheckJob;

/// The checks of a batch.
struct BatchPlan {
    std::vector<CheckJob> jobs;        // each program once, in the order of the command line
    std::vector<SkippedFile> skipped;  // found, but not NC programs
    std::vector<core::Error> failures; // arguments without a match, files that cannot be read
};

/// Whether the arguments are a single program file: no folder, pattern or project file.
bool is_one_program(const std::vector<std::string>& words);

/// The checks for arguments of a command line: files, folders, patterns and project files. Settings
/// in `asked` take precedence, then those of project files (later tables over earlier ones), then a
/// set-up next to the program. A program found in the folder of a project is checked as that
/// project states, and skipped if the project does not name it.
///
/// Errors: those of project files given as arguments; those of others are failures in the plan.
core::Result<BatchPlan> plan_batch(const std::vector<std::string>& words, const CheckJob& asked);

} // namespace app
