#pragma once

#include <string>
#include <vector>

#include "app/library/find/folder_walk.h"

namespace app {

struct CheckJob;

/// The checks of a batch.
struct BatchPlan {
    std::vector<CheckJob> jobs;        // each program once, in the order of the command line
    std::vector<SkippedFile> skipped;  // found, but no NC programs
    std::vector<core::Error> failures; // words without a match, files that cannot be read
};

/// Whether words name a single program file: no folder, pattern or project file.
bool is_one_program(const std::vector<std::string>& words);

/// The checks that words of a command line ask for: files, folders, patterns and project files.
/// Settings in `asked` take precedence, then those of project files (later tables over earlier
/// ones), then a set-up beside the program. A program found in the folder of a project is checked
/// as that project states, and skipped if the project does not name it.
///
/// Errors: those of project files that words name; those of others are failures in the plan.
core::Result<BatchPlan> plan_batch(const std::vector<std::string>& words, const CheckJob& asked);

} // namespace app
