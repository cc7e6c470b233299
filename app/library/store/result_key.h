#pragma once

#include <optional>
#include <string>

namespace app {

struct CheckJob;

/// Everything in a job that its result hangs on beside files, as JSON on one line; empty for a job
/// with edits, whose results are not kept.
std::optional<std::string> options_text(const CheckJob& job);

/// Under what the result of a job is kept: a SHA-256 over the version of the program that checks,
/// the paths as they were given, what is in the NC program, and the options.
std::string result_key(const std::string& build, const CheckJob& job, const std::string& sha256,
                       const std::string& options);

/// The version of this program, and which build of it: programs that were built from other sources
/// have another. The build is what the linker's build-id says, else a SHA-256 of the program's
/// file.
const std::string& build_version();

} // namespace app
