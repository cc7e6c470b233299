#pragma once

#include <string>

#include "app/library/result/batch_result.h"

namespace app {

/// A batch as one JSON object, schema 1: its programs as json_of has them, the files that were
/// skipped, and the programs that were not checked.
std::string batch_json_report(const BatchResult& batch);

/// A JSON object to a line for each program; `{"program": ..., "checked": false}` for one that was
/// not checked.
std::string batch_lines_report(const BatchResult& batch);

/// A row for each program as comma-separated values; `verdict` is "not checked" for one that was
/// not.
std::string batch_csv_report(const BatchResult& batch);

} // namespace app
