#pragma once

#include <string>

#include "app/batch/program_diff.h"

namespace app {

/// What became other between two versions, for a person: what came nearer, the worst first, then
/// findings that are new and gone. `all` gives every block, not the worst dozen.
std::string diff_text(const ProgramDiff& diff, bool all);

/// The same as one JSON object, schema 1, with every block.
std::string diff_json(const ProgramDiff& diff);

} // namespace app
