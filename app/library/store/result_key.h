#pragma once

#include <optional>
#include <string>

namespace app {

struct CheckJob;

/// Everything in a job that determines its result apart from files, as JSON on one line; empty for
/// a job with edits, whose results are not stored.
std::optional<std::string> options_text(const CheckJob& job);

/// The key of the stored result of a job: a SHA-256 over the version of Feeler, the paths as given,
/// the content of the NC program, and the options.
std::string result_key(const std::string& build, const CheckJob& job, const std::string& sha256,
                       const std::string& options);

/// The version and build of this program. Builds from different sources differ. The build is the
/// linker's build-id, or else a SHA-256 of the executable.
const std::string& build_version();

} // namespace app
