#pragma once

#include <string>
#include <vector>

#include "app/session/check_run.h"

namespace app {

/// Holds what is left of the stock against the part of the set-up, if there is one: fills
/// `run.comparison`, and adds a finding for each of the worst regions, `gouge` or `rest-material`.
void check_part(CheckRun& run);

/// What came of it in a line of text.
std::string facts_of(const core::PartComparison& comparison, double tolerance);

/// The surface of what is left as a PLY file, coloured by its deviation from the part; the header
/// says what the colours mean.
///
/// Errors: invalid_value when the set-up has no part, and for a name that does not end in .ply.
core::Result<std::string> comparison_file(const CheckRun& run, const std::string& path);

} // namespace app
