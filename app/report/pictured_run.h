#pragma once

#include "app/report/report_views.h"
#include "app/session/check_run.h"

namespace app {

/// As run_check, and adds what a report shows of the worst blocks: pictures, if there is OpenGL,
/// and scenes. The program is run once; places are had again from the record.
///
/// Errors: as run_check.
/// Cost:   some 0.2 s for each picture, on top of the check.
core::Result<CheckRun> run_pictured_check(const CheckJob& job, ReportViews& views);

} // namespace app
