#pragma once

#include <string>
#include <vector>

#include "app/library/find/folder_walk.h"

namespace app {

struct CheckJob;

/// What a batch has to do.
struct BatchPlan {
    std::vector<CheckJob> jobs;        // each program once, in the order in which it was named
    std::vector<SkippedFile> skipped;  // found, but no NC programs
    std::vector<core::Error> failures; // words that stand for nothing, files that cannot be read
};

/// Whether words stand for one program by its name: no folder, no pattern, no project file.
bool is_one_program(const std::vector<std::string>& words);

/// The checks that words of a command line ask for: files, folders, patterns, project files and
/// folders that hold one. `asked` counts for all; then what a project says, later tables before
/// earlier ones; then a set-up beside the program. What is found in the folder of a project is
/// checked as that project says, and skipped if it does not name it.
///
/// Errors: those of project files that words stand for; those of others are failures in the plan.
core::Result<BatchPlan> plan_batch(const std::vector<std::string>& words, const CheckJob& asked);

} // namespace app
