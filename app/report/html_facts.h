#pragma once

#include <string>

#include "app/session/check_run.h"

namespace app {

/// What is said of a check as a whole, as rows of an HTML table.
std::string html_summary(const CheckRun& run);

/// What stands between a lower bound and the upper one, term by term, as rows of an HTML table.
std::string html_bound_terms(const CheckRun& run);

} // namespace app
