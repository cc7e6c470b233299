#pragma once

#include <filesystem>

#include "app/setup/program_settings.h"
#include "app/setup/table_reader.h"

namespace app {

/// Reads `[program]` of a set-up; relative paths start from `folder`.
ProgramSettings read_program_table(TableReader& table, const std::filesystem::path& folder);

} // namespace app
