#pragma once

#include <string>

#include "app/report/report_views.h"
#include "app/session/check_run.h"

namespace app {

/// The report of a check as one HTML file that needs nothing else: no network, no other file.
///
/// Result: verdict, findings with what `views` has of their blocks, charts, a table of all blocks,
///         assumptions, and how near the bounds are to each other and why.
std::string html_report(const CheckRun& run, const ReportViews& views);

} // namespace app
