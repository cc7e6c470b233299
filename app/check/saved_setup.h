#pragma once

#include <functional>
#include <string>

#include "core/base/result.h"

namespace app {

struct CheckJob;

/// The set-up of a job as a file for `check --setup`: the file that the job names, with the job's
/// edits; or all inferred and edited values, with the assumptions as comments.
///
/// Errors: as run_check and rewritten_setup.
core::Result<std::string> setup_file_text(const CheckJob& job);

/// The default path of a saved set-up: next to the program, or next to the set-up that was edited.
std::string proposed_setup_path(const CheckJob& job);

/// Writes a file completely or not at all.
using FileWriter =
    std::function<core::Result<void>(const std::string& path, const std::string& text)>;

/// Saves the set-up of a job.
///
/// Errors: as setup_file_text and `write`; invalid_value for an existing file unless it may be
///         replaced, for the program itself, and for a folder in which relative paths of the set-up
///         would be invalid.
core::Result<void> save_setup(const CheckJob& job, const std::string& path, bool may_replace,
                              const FileWriter& write);

} // namespace app
