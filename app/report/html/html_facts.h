#pragma once

#include <string>

namespace app {

struct CheckRun;

/// A row of a table of facts: a name, and what is HTML already.
std::string fact_row(const std::string& name, const std::string& html);

/// What is said of a check as a whole, as rows of an HTML table.
std::string html_summary(const CheckRun& run);

/// What stands between a lower bound and the upper one, term by term, as rows of an HTML table.
std::string html_bound_terms(const CheckRun& run);

} // namespace app
