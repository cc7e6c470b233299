#pragma once

#include <string>
#include <vector>

#include "app/check/check_job.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace session_test {

/// A program and its set-up as files that exist as long as the object.
struct ProgramFiles {
    test_support::ScopedFolder folder;
    std::string program, setup;

    ProgramFiles(const std::string& name, const std::string& text,
                 const test_support::SetupWriter& writer);
    app::CheckJob job() const;
};

/// Subprograms in loops, parameters, two tools, cuts, a dwell, a collision with the clamp near the
/// end: about 430 blocks. LinuxCNC's dialect.
std::string walked_program();
test_support::SetupWriter walked_setup();

/// The digest of the state at each block of a program, run once from its start without keyframes.
std::vector<uint64_t> digests_of(const app::CheckJob& job);

/// The record as JSON, without times.
std::string report_of(const app::CheckRun& run);

/// The record of the blocks before `block` as JSON, with their findings and without times.
std::string report_before(const app::CheckRun& run, size_t block);

} // namespace session_test
