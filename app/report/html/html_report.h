#pragma once

#include <string>

#include "app/report/html/html_cards.h"

namespace app {

struct CheckRun;

/// The report of a check as one HTML file that needs nothing else: no network, no other file.
///
/// Result: verdict, findings with what `views` has of their blocks, charts, a table of all blocks,
///         assumptions, and how near the bounds are to each other and why.
std::string html_report(const CheckRun& run, const ReportViews& views);

/// All blocks of a check as columns of numbers, for the script of the page: a JSON object.
///
/// Units:  um, 0.1 ms and 0.01 mm3, as integers. A lower bound is rounded down and an upper one up:
///         what is shown encloses what is known.
/// Result: `lower` is -1 where nothing is known, `width` (upper less lower) -1 beyond the search
///         limit. Columns with many equal values are runs (NumberRuns, StepRuns).
/// Cost:   linear; some 20 bytes for a block, and each different text once.
std::string blocks_json(const CheckRun& run);

} // namespace app
