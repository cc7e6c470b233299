#pragma once

#include <string>
#include <string_view>

#include "app/setup/setup_file.h"
#include "core/base/result.h"

namespace app {

struct ProgramSettings;

/// Why a set-up cannot be that of a machine which is watched while it runs; empty if it can. It
/// must be complete, since there is no program from which anything is inferred. `who` watches: "the
/// guard".
std::string why_incomplete(const SetupFile& setup, std::string_view who);

/// Reads the set-up of a machine that is watched while it runs.
///
/// Errors: as read_setup, and why_incomplete.
core::Result<SetupFile> read_live_setup(const std::string& path, std::string_view who);

} // namespace app
