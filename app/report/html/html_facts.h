#pragma once

#include <string>

namespace app {

struct CheckRun;

/// The CSS class of the headline: the name of a verdict, "error" or "partly". "clear" only if the
/// check is clear and the set-up describes all that it rests on.
const char* verdict_class(const CheckRun& run);

/// What was not checked, for a place above everything else; empty if the set-up describes all of
/// it.
std::string uncovered_html(const CheckRun& run);

/// A row of a table of facts. `html` must be HTML already.
std::string fact_row(const std::string& name, const std::string& html);

/// Facts about a check as a whole, as rows of an HTML table.
std::string html_summary(const CheckRun& run);

/// The causes of the difference between lower and upper bound, as rows of an HTML table.
std::string html_bound_terms(const CheckRun& run);

/// The section with the tolerances of the set-up; empty if they were not requested.
std::string html_tolerances(const CheckRun& run);

} // namespace app
