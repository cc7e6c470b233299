#pragma once

#include <string>

namespace app {

struct CheckRun;

/// The blocks of a check as comma-separated values (RFC 4180), a row to each, under a row of names.
/// Columns are those of a block in JSON; a cell is empty where JSON says null. `rules` names the
/// findings of the block, the worst first, with blanks between.
std::string csv_report(const CheckRun& run);

} // namespace app
